"""How long a program step may be: its last orders are judged, and its series rescaled to the length that they allow."""

from __future__ import annotations

from numba import njit

from pounding_cli.kernels import cells as c
from pounding_cli.kernels.cells import at
from pounding_cli.kernels.layout import CALLED, PART
from pounding_cli.kernels.polynomial import value
from pounding_cli.kernels.program import CLOSING, MEMORY, RATE, ROOT
from pounding_cli.kernels.program_frame import ALLOWED, CHOSEN, FLOWING, SCALE, SIZES, force_register, register
from pounding_cli.kernels.program_storeys import flows_on, largest_memory_term, part_followed
from pounding_cli.kernels.simd import further, greater, load, magnitude, maximum, no_inline, splat, store

JUDGED = 4
"""Orders at the end of a series by which it is judged. Two, as in a plain step, are too few beside a damper that
sticks: a slip that is an error of the series would stay."""

JUDGED_IN_ROOT = 6
"""The same of a step in q, or with storeys whose memory flows: some orders are empty then."""

MARGIN = 0.9
"""Part of the longest step that the last orders allow which is taken [-]."""


@njit(**PART)
def exceeds_allowed(run, p, k, tolerance, total):
    """Whether order k of an acceleration or a force, or order k + 1 of the time, which is `total` by now [s], is more
    than may be left out."""
    exceeding = 0
    for b in range(run.slot_start, run.slot_stop, 8):
        exceeding |= greater(magnitude(load(p.A, k * run.padded + b)), load(run.slots, at(b, c.TERM_TOLERANCE)))
    # The terms of a memory that flows say nothing until `part_followed` has looked at them.
    exceeds = exceeding != 0 or p.numbers[FLOWING] > 0.0 or abs(p.T[k + 1]) > tolerance * abs(total)
    for n in range(1, p.closed[0] + 1):
        e = p.closed[n]
        exceeds = exceeds or abs(force_register(run, p, e)[k]) > p.sizes[SIZES * e + ALLOWED]
    return exceeds


@njit(**PART)
def judged_orders(p):
    """Orders at the end of a series by which it is judged."""
    return JUDGED_IN_ROOT if p.numbers[CHOSEN] >= 0.0 or p.numbers[FLOWING] > 0.0 else JUDGED


@njit(**PART)
def _term_over_allowed(run, p, k, tolerance):
    """The largest order k of an acceleration, a force or a memory over what may be left out of it [-]."""
    sizes = splat(0.0)
    for b in range(run.slot_start, run.slot_stop, 8):
        sizes = maximum(sizes, magnitude(load(p.A, k * run.padded + b)) / load(run.slots, at(b, c.TERM_TOLERANCE)))
    store(run.scratch, 0, sizes)
    largest = largest_memory_term(run, p, k) / tolerance if p.numbers[FLOWING] > 0.0 else 0.0
    for lane in range(8):
        largest = max(largest, run.scratch[lane])
    for n in range(1, p.closed[0] + 1):
        e = p.closed[n]
        largest = max(largest, abs(force_register(run, p, e)[k]) / p.sizes[SIZES * e + ALLOWED])
    return largest


@njit(**CALLED)
def part_allowed(run, p, order, tolerance):
    """The part of the step over which the last orders stay below what may be left out [-], at most 1."""
    no_inline()
    worst = 0.0
    judged = judged_orders(p)
    for k in range(order - judged, order):
        term = _term_over_allowed(run, p, k, tolerance)
        worst = max(worst, term ** (1.0 / k)) if term > 0.0 else worst
    ratio = MARGIN / worst if worst > MARGIN else 1.0
    for _ in range(3 if p.numbers[CHOSEN] >= 0.0 else 0):  # the time, whose error shifts all, by itself
        allowed = tolerance * abs(value(p.T, order, ratio))
        worst = 1.0
        for k in range(order - judged + 1, order + 1):
            term = abs(p.T[k]) * ratio**k
            worst = max(worst, (term / allowed) ** (1.0 / k)) if term > allowed > 0.0 else worst
        ratio /= worst
    return part_followed(run, p, tolerance, ratio) if p.numbers[FLOWING] > 0.0 else ratio


@njit(**PART)
def _rescale_series(run, series, order):
    """Orders of one series by the powers in `scratch`."""
    for k in range(0, order + 1, 8):
        store(series, k, load(series, k) * load(run.scratch, k))


@njit(**CALLED)
def rescale(run, p, order, ratio):
    """All series that are asked for afterwards for a step `ratio` times as long."""
    no_inline()
    p.numbers[SCALE] *= ratio
    power = 1.0
    for k in range(p.rows):
        run.scratch[k] = power
        power *= ratio
    for k in range(order + 1):
        power = run.scratch[k]
        p.B[k] *= ratio  # it is by s as well
        for i in range(k * run.padded + run.slot_start, k * run.padded + run.slot_stop, 8):
            store(run.W, i, load(run.W, i) * power)
            store(p.U, i, load(p.U, i) * power)
            store(p.A, i, load(p.A, i) * power)
    _rescale_series(run, p.T, order)
    _rescale_series(run, p.B, order)
    for n in range(1, p.closed[0] + 1):
        e = p.closed[n]
        for which in (CLOSING, RATE, MEMORY, ROOT):
            _rescale_series(run, register(p, e, which), order)
        _rescale_series(run, force_register(run, p, e), order)
    if p.numbers[FLOWING] > 0.0:
        for i in range(run.slot_start, run.slot_stop):
            if flows_on(run, i):
                for place in range(0, p.each, p.rows):
                    _rescale_series(run, further(p.storeys, i * p.each + place), order)
