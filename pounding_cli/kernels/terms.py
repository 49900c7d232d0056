"""Elements with terms beyond neighbouring slots: points, and springs and dashpots between any degrees of freedom.

A point moves as a weighted sum of degrees of freedom and hands what pushes it on to them by the same weights, so that
a storey or a link that ends at a point needs nothing of its own. Sums are made eight at a time; what is handed on goes
one by one, since several may push one degree of freedom."""

from __future__ import annotations

import numpy as np
from numba import njit, types

from pounding_cli.kernels import cells as c
from pounding_cli.kernels.cells import at, of
from pounding_cli.kernels.clock import ORDER
from pounding_cli.kernels.frame import DOUBLES, INTEGERS, Frame, filler
from pounding_cli.kernels.layout import CALLED, PART
from pounding_cli.kernels.simd import further, fused, gather, greater, load, magnitude, no_inline, splat, store

_COUNTS = ("points", "point_terms", "springs", "spring_places", "spring_terms", "stiff", "shears")
_INTEGERS = ("place", "freedom", "spring_freedom", "shear_slot", "shear_storey", "shear_first", "shear_link")
_DOUBLES = (
    "mass", "weight", "handed", "stiffness", "dashpot", "spring_weight", "shear_share", "shear_weight", "rates", "sums",
)  # fmt: skip
TERMS = Frame(
    "terms",
    dict.fromkeys(_COUNTS, types.int64) | dict.fromkeys(_INTEGERS, INTEGERS) | dict.fromkeys(_DOUBLES, DOUBLES),
)
"""The fields of `layout.Points`, `Shears` and `Springs`, slots and links told by their places; rates: of what
springs act on, by order [m/s]; sums: room for eight."""

_fill = filler(TERMS)


@njit(**PART)
def room_for_terms(springs, rows):
    """Doubles of scratch; `springs` with their padding."""
    return rows * springs + 8


@njit(**PART)
def terms_frame(place, points, springs, memory):
    """The frame at `place`, its rows in `memory`."""
    return _fill(place, (
        points.number, points.terms, springs.number, springs.size, springs.terms, springs.stiff,
        points.shears.number, points.slot, points.freedom, springs.freedom, points.shears.slot, points.shears.storey,
        points.shears.first, points.shears.link, points.mass, points.weight, points.handed, springs.stiffness,
        springs.dashpot, springs.weight, points.shears.share, points.shears.weight, further(memory, 8), memory,
    ))  # fmt: skip


@njit(**PART)
def _in_range(run, i):
    """Whether the building at place i is solved now."""
    return run.slot_start <= i < run.slot_stop


@njit(**CALLED)
def start_points(run, terms):
    """Masses of the points, and where they are and go at the start."""
    no_inline()
    for p in range(terms.points):
        i = terms.place[p]
        run.slots[of(i, c.MASS)] = terms.mass[p]
        run.slots[of(i, c.INVERSE_MASS)] = 1.0 / terms.mass[p]
    follow_points(run, terms, run.W, -run.padded)
    follow_points(run, terms, run.W, np.int64(0))


@njit(**CALLED)
def follow_points(run, terms, values, row):
    """Set what belongs to the points in a row of values by place."""
    no_inline()
    padded = (terms.points + 7) & -8
    for b in range(0, padded, 8):
        total = splat(0.0)
        for j in range(b, terms.point_terms * padded, padded):
            total = fused(load(terms.weight, j), gather(values, row, terms.freedom, j), total)
        store(terms.sums, 0, total)
        for p in range(b, min(b + 8, terms.points)):
            if _in_range(run, terms.place[p]):
                values[row + terms.place[p]] = terms.sums[p - b]


@njit(**PART)
def end_points(run, terms):
    """Displacements and velocities of the points at a step's end, from those of their degrees of freedom: what is known
    exactly of a drift or a closing then, the next step finds unchanged."""
    if terms.points > 0:
        _end_points(run, terms)


@njit(**CALLED)
def _end_points(run, terms):
    no_inline()
    padded = (terms.points + 7) & -8
    for p in range(terms.points):
        i = terms.place[p]
        if _in_range(run, i):
            u, v = 0.0, 0.0
            for j in range(p, terms.point_terms * padded, padded):
                u += terms.weight[j] * run.ends[terms.freedom[j]]
                v += terms.weight[j] * run.slots[of(terms.freedom[j], c.V1)]
            run.ends[i] = u
            run.slots[of(i, c.V1)] = v


@njit(**CALLED)
def hand_on(run, terms, accelerations, row):
    """Pass what pushes the points on to their degrees of freedom, and let the points move as these do.

    accelerations : by place; of a point those of its mass by what pushes it; all of them may be multiples of such
    """
    no_inline()
    padded = (terms.points + 7) & -8
    for p in range(terms.points):
        if _in_range(run, terms.place[p]):
            pushed = accelerations[row + terms.place[p]]
            for j in range(p, terms.point_terms * padded, padded):
                accelerations[row + terms.freedom[j]] += terms.handed[j] * pushed
    follow_points(run, terms, accelerations, row)


@njit(**CALLED)
def exceeding_lanes(run, k, after):
    """Lanes in which order k of an acceleration, times `after` in row k + 1 of W, is more than may be left out."""
    no_inline()
    exceeding = 0
    for b in range(run.slot_start, run.slot_stop, 8):
        term = magnitude(load(run.W, (k + 1) * run.padded + b))
        exceeding |= greater(term, load(run.slots, at(b, c.TERM_TOLERANCE)) * after)
    return exceeding


@njit(**CALLED)
def spring_forces(run, terms, k, displacements, above, before):
    """Order k of what springs do to the slots, into SPRING_FORCE [N].

    Order k of the displacements is `before` times the row of `displacements` that begins at `above`.
    """
    no_inline()
    padded = terms.spring_places
    end = terms.spring_terms * padded
    for b in range(run.slot_start, run.slot_stop, 8):
        store(run.slots, at(b, c.SPRING_FORCE), splat(0.0))
    for b in range(0, padded, 8):
        rate = splat(0.0)
        for j in range(b, end, padded):
            rate = fused(load(terms.spring_weight, j), gather(run.W, k * run.padded, terms.spring_freedom, j), rate)
        force = load(terms.dashpot, b) * rate
        if terms.stiff != 0:
            v = splat(0.0)
            for j in range(b, end, padded):
                v = fused(load(terms.spring_weight, j), gather(displacements, above, terms.spring_freedom, j), v)
            force = fused(load(terms.stiffness, b), v * before, force)
        store(terms.rates, k * padded + b, rate)
        store(terms.sums, 0, force)
        for e in range(b, min(b + 8, terms.springs)):
            if _in_range(run, terms.spring_freedom[e]):
                for j in range(e, end, padded):
                    push = terms.spring_weight[j] * terms.sums[e - b]
                    run.slots[of(terms.spring_freedom[j], c.SPRING_FORCE)] -= push


@njit(**CALLED)
def rescale_springs(run, terms, order, ratio):
    """As `recurrence.rescale`."""
    no_inline()
    power = splat(1.0)
    for k in range(order + 1):
        for b in range(k * terms.spring_places, (k + 1) * terms.spring_places, 8):
            store(terms.rates, b, load(terms.rates, b) * power)
        power = power * ratio


@njit(**CALLED)
def account_springs(run, terms, points, first_share):
    """Energy lost in the dashpots of springs, booked as drag of their first degree of freedom."""
    no_inline()
    padded = terms.spring_places
    order = run.tally[ORDER]
    for b in range(0, padded, 8):
        lost = splat(0.0)
        for g in range(0, 8 * points, 8):
            s = load(run.rule, g)
            rate = splat(0.0)
            for place in range((order - 1) * padded + b, b - 1, -padded):
                rate = fused(rate, s, load(terms.rates, place))
            lost = fused(rate * rate, load(run.rule, first_share + g), lost)
        store(terms.sums, 0, lost * load(terms.dashpot, b))
        for e in range(b, min(b + 8, terms.springs)):
            if _in_range(run, terms.spring_freedom[e]):
                drag = of(terms.spring_freedom[e], c.DRAG_ENERGY)
                run.slots[drag] += terms.sums[e - b]
