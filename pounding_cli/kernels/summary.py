"""What one step's series say about the whole step: its end, and bounds that exclude events and new peaks cheaply.

A function on [0, 1] strays from the straight line between its ends by at most max |p''| / 8, and |p''| is at most
sum k (k - 1) |c_k|: that sum, an eighth of it, is the *stray* of a quantity. A quantity whose rate has one sign at
both ends, and there exceeds the rate's stray, is monotone: its largest value stands at an end."""

from __future__ import annotations

from numba import njit

from pounding_cli.kernels import cells as c
from pounding_cli.kernels.cells import at, of
from pounding_cli.kernels.clock import CHANGE, END, GROUND, PER_H, H
from pounding_cli.kernels.foundations import end_feet
from pounding_cli.kernels.layout import CALLED, PART
from pounding_cli.kernels.simd import from_left, fused, greater, load, magnitude, minimum, splat, stand_alone, store


@njit(**CALLED)
def summarise(run, feet, order, founded):
    """Displacement, velocity, drift, drift rate and total acceleration (pull) of every slot at the step's end, the last
    three at its start too, and strays."""
    stand_alone()
    padded = run.padded
    slots = run.slots
    h = splat(run.clock[H])
    per_h = splat(run.clock[PER_H])
    ground = splat(run.clock[GROUND])
    ground_end = ground + splat(run.clock[CHANGE])  # fault: acceleration-is-total
    eighth = h * 0.125
    for b in range(run.low, run.high, 8):
        travel = splat(0.0)
        v = splat(0.0)
        pull = splat(0.0)
        bend = splat(0.0)
        v_stray = splat(0.0)
        pull_stray = splat(0.0)
        before = splat(-2.0)  # k - 2, k - 1 and k in every lane
        last = splat(-1.0)
        number = splat(0.0)
        for k in range(order + 1):
            w = load(run.W, k * padded + b)
            travel = fused(w, run.reciprocal[k + 1], travel)
            v = v + w
            term = w * number
            pull = pull + term
            size = magnitude(term)
            bend = bend + size
            size = size * last
            v_stray = v_stray + size
            pull_stray = fused(size, before, pull_stray)
            before = last
            last = number
            number = number + 1.0
        store(run.ends, b, fused(travel, h, load(run.W, b - padded)))
        store(slots, at(b, c.V_END), v)
        store(slots, at(b, c.PULL0), fused(load(run.W, padded + b), per_h, ground))
        store(slots, at(b, c.PULL), fused(pull, per_h, ground_end))
        store(run.ends, padded + b, bend * eighth)
        store(slots, at(b, c.V_STRAY), v_stray * 0.125)
        store(slots, at(b, c.PULL_STRAY), pull_stray * (per_h * 0.125))
    drifts(run)
    if founded:
        _drift_strays(run, order)
        end_feet(run, feet, 1.0)
    else:
        _sum_strays(run)


@njit(**PART)
def _sum_strays(run):
    """Strays of drifts and their rates: at most those of both slots together."""
    slots = run.slots
    bend_left = splat(0.0)
    v_left = splat(0.0)
    for b in range(run.low, run.high, 8):
        couple = load(slots, at(b, c.COUPLE))
        bend = load(run.ends, run.padded + b)
        v = load(slots, at(b, c.V_STRAY))
        store(slots, at(b, c.DRIFT_STRAY), fused(couple, from_left(bend_left, bend), bend))
        store(slots, at(b, c.RATE_STRAY), fused(couple, from_left(v_left, v), v))
        bend_left = bend
        v_left = v


@njit(**CALLED)
def _drift_strays(run, order):
    """The same where rocking takes its part."""
    stand_alone()
    for b in range(run.low, run.high, 8):
        couple = load(run.slots, at(b, c.COUPLE))
        bend = splat(0.0)
        stray = splat(0.0)
        number = 0.0
        for k in range(order + 1):
            row = k * run.padded + b
            w = load(run.W, row)
            rate = w - couple * from_left(load(run.W, row - 8), w) - load(run.tilt, row + run.padded)
            size = magnitude(rate * number)
            bend = bend + size
            stray = fused(size, number - 1.0, stray)
            number += 1.0
        store(run.slots, at(b, c.DRIFT_STRAY), bend * (0.125 * run.clock[H]))
        store(run.slots, at(b, c.RATE_STRAY), stray * 0.125)


@njit(**PART)
def drifts(run):
    """Differences of displacement and velocity between each slot and the one below it, at both ends of the step."""
    slots = run.slots
    zero = splat(0.0)
    u0_left, v0_left, u_left, v_left = zero, zero, zero, zero
    for b in range(run.low, run.high, 8):
        couple = load(slots, at(b, c.COUPLE))
        u0 = load(run.W, b - run.padded)
        v0 = load(run.W, b)
        u = load(run.ends, b)
        v = load(slots, at(b, c.V_END))
        store(slots, at(b, c.DRIFT0), u0 - couple * from_left(u0_left, u0))
        store(slots, at(b, c.RATE0), v0 - couple * from_left(v0_left, v0))
        store(slots, at(b, c.DRIFT), u - couple * from_left(u_left, u))
        store(slots, at(b, c.RATE), v - couple * from_left(v_left, v))
        u0_left, v0_left, u_left, v_left = u0, v0, u, v


@njit(**CALLED)
def stop_at(run, feet, order, founded):
    """Replace what stands for s = 1 by the values at END, where an event was found; the strays stay bounds."""
    stand_alone()
    padded = run.padded
    slots = run.slots
    s = splat(run.clock[END])
    hs = splat(run.clock[H]) * s
    per_h = splat(run.clock[PER_H])
    ground = fused(splat(run.clock[CHANGE]), s, splat(run.clock[GROUND]))
    for b in range(run.low, run.high, 8):
        travel = splat(0.0)
        v = splat(0.0)
        pull = splat(0.0)
        number = 1.0 * order
        for k in range(order, 0, -1):
            w = load(run.W, k * padded + b)
            travel = fused(travel, s, w * run.reciprocal[k + 1])
            v = fused(v, s, w)
            pull = fused(pull, s, w * number)
            number -= 1.0
        w = load(run.W, b)
        travel = fused(travel, s, w)
        v = fused(v, s, w)
        u = fused(travel, hs, load(run.W, b - padded))
        store(run.ends, b, u)
        store(slots, at(b, c.V_END), v)
        store(slots, at(b, c.PULL), fused(pull, per_h, ground))
    drifts(run)
    if founded:
        end_feet(run, feet, run.clock[END])


@njit(**PART)
def turns(rate0, rate, stray):
    """Lanes whose quantity may have a largest value inside the step, by its rate at both ends and that one's stray."""
    same = greater(rate0 * rate, splat(0.0))
    return ~(same & greater(minimum(magnitude(rate0), magnitude(rate)), stray))


@njit(**PART)
def bends(first, last, stray):
    """Lanes whose quantity may have a largest value inside the step, by its ends and its stray: its slope differs from
    the mean by half the largest second derivative at most, which is eight strays."""
    return ~greater(magnitude(last - first), stray * 4.0)


@njit(**PART)
def rate_term(run, k, i, founded):
    """Coefficient k of the drift rate of storey i [m/s]."""
    row = k * run.padded + i
    term = run.W[row]
    if run.slots[of(i, c.COUPLE)] != 0.0:
        term -= run.W[row - 1]
    if founded:
        term -= run.tilt[row + run.padded]
    return term


@njit(**PART)
def drift_series(run, h, i, order, factor, founded):
    """`factor` times the coefficients of storey i's drift, into `scratch`."""
    run.scratch[0] = factor * run.slots[of(i, c.DRIFT0)]
    for k in range(1, order + 1):
        run.scratch[k] = factor * h * run.reciprocal[k] * rate_term(run, k - 1, i, founded)
