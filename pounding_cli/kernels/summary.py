"""The end of a step from its series, and bounds that exclude events and new peaks at little cost.

A function on [0, 1] deviates from the chord (the straight line between its ends) by at most max |p''| / 8, and |p''| is
at most sum k (k - 1) |c_k|. An eighth of this sum is the *chord deviation* of a quantity. A quantity is monotone if its
rate has one sign at both ends and exceeds the rate's chord deviation there: its largest value is then at an end."""

from __future__ import annotations

from numba import njit

from pounding_cli.kernels import cells as c
from pounding_cli.kernels.cells import at, of
from pounding_cli.kernels.clock import END, GROUND, GROUND_CHANGE, INVERSE_H, H
from pounding_cli.kernels.layout import CALLED, PART
from pounding_cli.kernels.simd import from_left, fused, greater, load, magnitude, minimum, no_inline, splat, store
from pounding_cli.kernels.terms import end_points


@njit(**CALLED)
def summarise(run, terms, order):
    """Displacement, velocity, drift, drift rate and total acceleration of every slot at the step's end, the last three
    at its start too, and chord deviations."""
    no_inline()
    padded = run.padded
    slots = run.slots
    h = splat(run.clock[H])
    per_h = splat(run.clock[INVERSE_H])
    ground = splat(run.clock[GROUND])
    ground_end = ground + splat(run.clock[GROUND_CHANGE])
    eighth = h * 0.125
    for b in range(run.slot_start, run.slot_stop, 8):
        travel = splat(0.0)
        v = splat(0.0)
        acceleration = splat(0.0)
        bend = splat(0.0)
        v_deviation = splat(0.0)
        acceleration_deviation = splat(0.0)
        before = splat(-2.0)  # k - 2, k - 1 and k in every lane
        last = splat(-1.0)
        number = splat(0.0)
        for k in range(order + 1):
            w = load(run.W, k * padded + b)
            travel = fused(w, run.reciprocal[k + 1], travel)
            v = v + w
            term = w * number
            acceleration = acceleration + term
            size = magnitude(term)
            bend = bend + size
            size = size * last
            v_deviation = v_deviation + size
            acceleration_deviation = fused(size, before, acceleration_deviation)
            before = last
            last = number
            number = number + 1.0
        store(run.ends, b, fused(travel, h, load(run.W, b - padded)))
        store(slots, at(b, c.V1), v)
        store(slots, at(b, c.TOTAL_ACCELERATION0), fused(load(run.W, padded + b), per_h, ground))
        store(slots, at(b, c.TOTAL_ACCELERATION1), fused(acceleration, per_h, ground_end))
        store(run.ends, padded + b, bend * eighth)
        store(slots, at(b, c.V_CHORD_DEVIATION), v_deviation * 0.125)
        store(slots, at(b, c.TOTAL_ACCELERATION_CHORD_DEVIATION), acceleration_deviation * (per_h * 0.125))
    end_points(run, terms)
    drifts(run)
    _sum_chord_deviations(run)


@njit(**PART)
def _sum_chord_deviations(run):
    """Chord deviations of drifts and their rates: at most those of both slots together."""
    slots = run.slots
    bend_left = splat(0.0)
    v_left = splat(0.0)
    for b in range(run.slot_start, run.slot_stop, 8):
        couple = load(slots, at(b, c.COUPLE))
        bend = load(run.ends, run.padded + b)
        v = load(slots, at(b, c.V_CHORD_DEVIATION))
        store(slots, at(b, c.DRIFT_CHORD_DEVIATION), fused(couple, from_left(bend_left, bend), bend))
        store(slots, at(b, c.DRIFT_RATE_CHORD_DEVIATION), fused(couple, from_left(v_left, v), v))
        bend_left = bend
        v_left = v


@njit(**PART)
def drifts(run):
    """Differences of displacement and velocity between each slot and the one below it, at both ends of the step."""
    slots = run.slots
    zero = splat(0.0)
    u0_left, v0_left, u_left, v_left = zero, zero, zero, zero
    for b in range(run.slot_start, run.slot_stop, 8):
        couple = load(slots, at(b, c.COUPLE))
        u0 = load(run.W, b - run.padded)
        v0 = load(run.W, b)
        u = load(run.ends, b)
        v = load(slots, at(b, c.V1))
        store(slots, at(b, c.DRIFT0), u0 - couple * from_left(u0_left, u0))
        store(slots, at(b, c.DRIFT_RATE0), v0 - couple * from_left(v0_left, v0))
        store(slots, at(b, c.DRIFT1), u - couple * from_left(u_left, u))
        store(slots, at(b, c.DRIFT_RATE1), v - couple * from_left(v_left, v))
        u0_left, v0_left, u_left, v_left = u0, v0, u, v


@njit(**CALLED)
def end_at_event(run, terms, order):
    """Replace the values at s = 1 by those at END, where an event was found; the chord deviations stay bounds."""
    no_inline()
    padded = run.padded
    slots = run.slots
    s = splat(run.clock[END])
    hs = splat(run.clock[H]) * s
    per_h = splat(run.clock[INVERSE_H])
    ground = fused(splat(run.clock[GROUND_CHANGE]), s, splat(run.clock[GROUND]))
    for b in range(run.slot_start, run.slot_stop, 8):
        travel = splat(0.0)
        v = splat(0.0)
        acceleration = splat(0.0)
        number = 1.0 * order
        for k in range(order, 0, -1):
            w = load(run.W, k * padded + b)
            travel = fused(travel, s, w * run.reciprocal[k + 1])
            v = fused(v, s, w)
            acceleration = fused(acceleration, s, w * number)
            number -= 1.0
        w = load(run.W, b)
        travel = fused(travel, s, w)
        v = fused(v, s, w)
        u = fused(travel, hs, load(run.W, b - padded))
        store(run.ends, b, u)
        store(slots, at(b, c.V1), v)
        store(slots, at(b, c.TOTAL_ACCELERATION1), fused(acceleration, per_h, ground))
    end_points(run, terms)
    drifts(run)


@njit(**PART)
def may_turn_by_rates(rate0, rate, deviation):
    """Lanes whose quantity may have a largest value inside the step, by its rate at both ends and the chord
    deviation of the rate."""
    same = greater(rate0 * rate, splat(0.0))
    return ~(same & greater(minimum(magnitude(rate0), magnitude(rate)), deviation))


@njit(**PART)
def may_turn_by_ends(first, last, deviation):
    """Lanes whose quantity may have a largest value inside the step, by its ends and its chord deviation: its slope
    differs from the mean by half the largest second derivative at most, which is four deviations."""
    return ~greater(magnitude(last - first), deviation * 4.0)


@njit(**PART)
def rate_term(run, k, i):
    """Coefficient k of the drift rate of storey i [m/s]."""
    row = k * run.padded + i
    term = run.W[row]
    if run.slots[of(i, c.COUPLE)] != 0.0:
        term -= run.W[row - 1]
    return term


@njit(**PART)
def drift_series(run, h, i, order, factor):
    """`factor` times the coefficients of storey i's drift, into `scratch`."""
    run.scratch[0] = factor * run.slots[of(i, c.DRIFT0)]
    for k in range(1, order + 1):
        run.scratch[k] = factor * h * run.reciprocal[k] * rate_term(run, k - 1, i)
