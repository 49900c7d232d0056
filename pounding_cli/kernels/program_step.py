"""A program step, from its series to what it leaves (`program_start`, `program_series`, `program_length`, then
`program_events`, `program_peaks`).

A scene whose links are all springs, cubics and dashpots takes none; its kernel holds no code of it
(`no_program_step`)."""

from __future__ import annotations

from numba import njit

from pounding_cli.kernels import program_length, program_peaks
from pounding_cli.kernels.clock import ORDER
from pounding_cli.kernels.collapse import first_collapse_on_program
from pounding_cli.kernels.column_shears import track_program
from pounding_cli.kernels.layout import CALLED, NOT_FINITE, PART, STEP_BOUND
from pounding_cli.kernels.program_events import find_end, reach_end
from pounding_cli.kernels.program_frame import SCALE
from pounding_cli.kernels.program_length import part_allowed
from pounding_cli.kernels.program_peaks import account, track
from pounding_cli.kernels.program_series import expand, on_program
from pounding_cli.kernels.program_start import start
from pounding_cli.kernels.recurrence import set_allowed
from pounding_cli.kernels.simd import no_inline
from pounding_cli.kernels.terms import rescale_springs

PLAIN_STEP = -2
"""Said instead of an outcome where a plain step is to be taken."""

MOST_TRIES = 40
"""Times that a step whose numbers leave the range of doubles is made shorter, by SHORTER each."""

SHORTER = 1e-3

SHORTEST = 1e-14
"""As in `plain_step`."""


@njit(**PART)
def no_program_step(run, terms, programs, settings):
    """(PLAIN_STEP, no storey event, no link event, not the segment's end)."""
    return PLAIN_STEP, False, False, False


@njit(**CALLED)
def program_step(run, terms, programs, settings):
    """(outcome, or -1, or PLAIN_STEP; whether a storey event ends the step, whether a link's does, whether it ends the
    segment)."""
    no_inline()
    inelastic = settings.inelastic > 0
    if not on_program(run, inelastic):
        return PLAIN_STEP, False, False, False
    p = programs
    has_terms = settings.has_terms > 0
    tolerance = settings.tolerance
    set_allowed(run, tolerance)
    start(run, p)
    order, close, finite = expand(run, terms, p, tolerance, settings.max_order, has_terms)
    for _ in range(MOST_TRIES):
        if finite:
            break
        shorter = p.numbers[SCALE] * SHORTER
        start(run, p)
        p.numbers[SCALE] = shorter
        order, close, finite = expand(run, terms, p, tolerance, settings.max_order, has_terms)
    if not finite:
        return NOT_FINITE, False, False, False
    run.tally[ORDER] = order
    ratio = 1.0 if close else part_allowed(run, p, order, tolerance)
    if not ratio > SHORTEST:
        return STEP_BOUND, False, False, False
    if ratio < 1.0:
        program_length.rescale(run, p, order, ratio)
        if has_terms:
            rescale_springs(run, terms, order, ratio)
    storeys, link, finished = find_end(run, p, inelastic)
    if settings.watched > 0 and first_collapse_on_program(run, p):
        storeys, link, finished = False, False, False
    reach_end(run, terms, p)
    account(run, terms, p, settings.nodes, settings.weights, inelastic, has_terms)
    track(run, p, inelastic)
    if terms.shears > 0:
        track_program(run, terms, p)
    if settings.use_islands > 0:
        program_peaks.widen_ranges(run, p)
    return -1, storeys, link, finished
