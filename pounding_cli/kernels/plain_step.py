"""A plain step: the motion as Taylor series in time, from how long the step is to what it leaves.

`program_step` takes the steps that plain ones cannot."""

from __future__ import annotations

import numpy as np
from numba import njit

from pounding_cli.kernels.clock import (
    ELAPSED,
    END,
    GROUND,
    GROUND_CHANGE,
    GROUND_SLOPE,
    INVERSE_H,
    LONGEST_STEP,
    ORDER,
    SEGMENT_GROUND,
    SEGMENT_LENGTH,
    H,
)
from pounding_cli.kernels.collapse import first_collapse
from pounding_cli.kernels.crossings import first_link_event, first_storey_event
from pounding_cli.kernels.layout import NOT_FINITE, PART, STEP_BOUND
from pounding_cli.kernels.ledger import account
from pounding_cli.kernels.link_series import start_closings
from pounding_cli.kernels.peaks import track, widen_ranges
from pounding_cli.kernels.polynomial import NEVER
from pounding_cli.kernels.recurrence import expand, is_finite, rescale, shrink
from pounding_cli.kernels.summary import end_at_event, summarise
from pounding_cli.kernels.terms import rescale_springs

SHORTEST = 1e-14
"""Part of a step, and of a segment, [-] below which shortening a step would not let time go on."""

MOST_TRIES = 6
"""Times that a step whose series leaves the range of doubles is made shorter, by `MUCH_SHORTER` each: what has next to
no mass may be so fast that the powers of its frequency overflow."""

MUCH_SHORTER = 1e-4

FEW_PIECES = 0.1
"""Part of a step [-] above which what is left of it is gone through in equal pieces: of a few, one less than might be
saves nothing, where there are many each is as long as can be."""


@njit(**PART)
def _begin_step(run):
    """The step that is tried next: to the end of the segment, or as far as the last one that had to be shortened."""
    elapsed = run.clock[ELAPSED]
    h = run.clock[SEGMENT_LENGTH] - elapsed
    whole = h <= run.clock[LONGEST_STEP]
    if not whole:
        h /= np.ceil(h / run.clock[LONGEST_STEP] - 1e-9)
    run.clock[H] = h
    run.clock[INVERSE_H] = 1.0 / h
    run.clock[GROUND] = run.clock[SEGMENT_GROUND] + run.clock[GROUND_SLOPE] * elapsed
    run.clock[GROUND_CHANGE] = run.clock[GROUND_SLOPE] * h
    run.clock[END] = NEVER
    return whole


@njit(**PART)
def _scale_step(run, ratio):
    """Make the step `ratio` times as long."""
    run.clock[H] *= ratio
    run.clock[INVERSE_H] /= ratio
    run.clock[GROUND_CHANGE] *= ratio


@njit(**PART)
def _shorten(run, terms, any_closed, cut, order, has_terms):
    """Shorten a step whose series did not become small enough; returns the part of it that is left [-]."""
    ratio = shrink(run, cut)
    if ratio > SHORTEST and ratio < 1.0:
        paced = ratio > FEW_PIECES
        if paced:
            ratio = 1.0 / np.ceil(1.0 / ratio)
        rescale(run, ratio, any_closed, order)
        if has_terms:
            rescale_springs(run, terms, order, ratio)
        _scale_step(run, ratio)
        if paced:
            run.clock[LONGEST_STEP] = run.clock[H]
    return ratio


@njit(**PART)
def plain_step(run, terms, settings, pinned_at_event):
    """A step by time series; as `program_step`."""
    inelastic = settings.inelastic > 0
    has_terms = settings.has_terms > 0
    linked = run.link_stop > run.link_start
    clock = run.clock
    whole = _begin_step(run)
    shortened = False
    for _ in range(MOST_TRIES):
        any_closed = 0
        curved = 0
        cut = 0
        if linked:
            any_closed, curved, cut = start_closings(run, pinned_at_event)
        order, close = expand(
            run, terms, any_closed, curved, cut, pinned_at_event, settings.tolerance, settings.max_order, has_terms
        )
        run.tally[ORDER] = order
        ratio = 1.0 if close and is_finite(run, order) else _shorten(run, terms, any_closed, cut, order, has_terms)
        shortened = shortened or not ratio >= 1.0
        if np.isfinite(ratio):
            break
        _scale_step(run, MUCH_SHORTER)
        clock[LONGEST_STEP] = clock[H]
    if not ratio > SHORTEST or (shortened and not clock[H] > SHORTEST * clock[SEGMENT_LENGTH]):
        return STEP_BOUND if np.isfinite(ratio) else NOT_FINITE, False, False, False
    summarise(run, terms, order)
    storeys = inelastic and first_storey_event(run)
    link = linked and first_link_event(run)
    if settings.watched > 0 and first_collapse(run):
        storeys, link = False, False
    if clock[END] < 1.0:
        end_at_event(run, terms, order)
    else:
        clock[END] = 1.0
    if settings.booked > 0:
        account(run, terms, settings.nodes, settings.weights, order, any_closed, curved, inelastic, has_terms)
    track(run, order, any_closed, inelastic)
    if settings.use_islands > 0:
        widen_ranges(run)
    return -1, storeys, link, whole and not shortened and clock[END] == 1.0
