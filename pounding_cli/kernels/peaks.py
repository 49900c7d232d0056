"""Largest values over a step: nothing is looked at closely unless its bound exceeds the peak so far."""

from __future__ import annotations

from numba import njit

from pounding_cli.kernels import cells as c
from pounding_cli.kernels.cells import at, at_link, at_term, of, of_link, of_term, of_tie
from pounding_cli.kernels.clock import CHANGE, END, GROUND, ORDER, PER_H, SEGMENT, H
from pounding_cli.kernels.foundations import rocking_peaks
from pounding_cli.kernels.from_rest import count_from_rest
from pounding_cli.kernels.layout import CALLED, PART
from pounding_cli.kernels.link_series import apart, closed_at, link_end
from pounding_cli.kernels.polynomial import highest
from pounding_cli.kernels.simd import (
    fused,
    greater,
    load,
    lowest,
    magnitude,
    maximum,
    minimum,
    splat,
    stand_alone,
    store,
)
from pounding_cli.kernels.summary import bends, drift_series, turns


@njit(**PART)
def drift_turns(slots, b):
    return turns(load(slots, at(b, c.RATE0)), load(slots, at(b, c.RATE)), load(slots, at(b, c.RATE_STRAY)))


@njit(**CALLED)
def _drift_peak(run, i, factor, offset, best, founded):
    """Largest |factor x drift + offset| of storey i inside the step, at least `best`."""
    stand_alone()
    order = run.tally[ORDER]
    drift_series(run, run.clock[H], i, order, factor, founded)
    run.scratch[0] += offset
    return highest(run.scratch, order, run.clock[END], best, True)


@njit(**PART)
def _drift_peaks(run, founded):
    slots = run.slots
    for b in range(run.low, run.high, 8):
        peak = load(slots, at(b, c.MOST_DRIFT))
        reach = maximum(magnitude(load(slots, at(b, c.DRIFT0))), magnitude(load(slots, at(b, c.DRIFT))))
        suspects = greater(reach + load(slots, at(b, c.DRIFT_STRAY)), peak)
        if suspects != 0:
            store(slots, at(b, c.MOST_DRIFT), maximum(peak, reach))
            suspects &= drift_turns(slots, b)
            while suspects != 0:
                i = b + lowest(suspects)
                suspects &= suspects - 1
                best = slots[of(i, c.MOST_DRIFT)]
                slots[of(i, c.MOST_DRIFT)] = _drift_peak(run, i, 1.0, 0.0, best, founded)


@njit(**PART)
def _shear_peaks(run, founded):
    slots = run.slots
    for b in range(run.low, run.high, 8):
        peak = load(slots, at(b, c.MOST_SHEAR))
        tangent = load(slots, at(b, c.TANGENT))
        offset = load(slots, at(b, c.OFFSET))
        first = magnitude(fused(tangent, load(slots, at(b, c.DRIFT0)), offset))
        reach = maximum(first, magnitude(fused(tangent, load(slots, at(b, c.DRIFT)), offset)))
        suspects = greater(fused(tangent, load(slots, at(b, c.DRIFT_STRAY)), reach), peak)
        if suspects != 0:
            store(slots, at(b, c.MOST_SHEAR), maximum(peak, reach))
            suspects &= drift_turns(slots, b)
            while suspects != 0:
                i = b + lowest(suspects)
                suspects &= suspects - 1
                best = slots[of(i, c.MOST_SHEAR)]
                slots[of(i, c.MOST_SHEAR)] = _drift_peak(
                    run, i, slots[of(i, c.TANGENT)], slots[of(i, c.OFFSET)], best, founded
                )


@njit(**CALLED)
def _displacement_peak(run, i, sign, best):
    """Largest displacement of slot i times `sign` inside the step, at least `best`."""
    stand_alone()
    order = run.tally[ORDER]
    step = sign * run.clock[H]
    run.scratch[0] = sign * run.W[i - run.padded]
    for k in range(1, order + 1):
        run.scratch[k] = step * run.reciprocal[k] * run.W[(k - 1) * run.padded + i]
    return highest(run.scratch, order, run.clock[END], best, False)


@njit(**PART)
def _displacement_peaks(run):
    slots = run.slots
    minus = splat(-1.0)
    for b in range(run.low, run.high, 8):
        first = load(run.W, b - run.padded)
        last = load(run.ends, b)
        stray = load(run.ends, run.padded + b)
        top = load(slots, at(b, c.TOP))
        bottom = load(slots, at(b, c.BOTTOM))
        above = greater(maximum(first, last) + stray, top)
        below = greater(minus * minimum(first, last) + stray, minus * bottom)
        if above | below != 0:
            store(slots, at(b, c.TOP), maximum(top, maximum(first, last)))
            store(slots, at(b, c.BOTTOM), minimum(bottom, minimum(first, last)))
            turning = turns(load(run.W, b), load(slots, at(b, c.V_END)), load(slots, at(b, c.V_STRAY)))
            above &= turning
            below &= turning
            while above != 0:
                i = b + lowest(above)
                above &= above - 1
                slots[of(i, c.TOP)] = _displacement_peak(run, i, 1.0, slots[of(i, c.TOP)])
            while below != 0:
                i = b + lowest(below)
                below &= below - 1
                low = _displacement_peak(run, i, -1.0, -slots[of(i, c.BOTTOM)])
                slots[of(i, c.BOTTOM)] = -low


@njit(**CALLED)
def _acceleration_peak(run, i, best):
    """Largest |total acceleration| of slot i inside the step, at least `best`."""
    stand_alone()
    order = run.tally[ORDER]
    per_h = run.clock[PER_H]
    number = per_h
    for k in range(order):
        run.scratch[k] = number * run.W[(k + 1) * run.padded + i]
        number += per_h
    run.scratch[0] += run.clock[GROUND]
    run.scratch[1] += run.clock[CHANGE]
    return highest(run.scratch, order - 1, run.clock[END], best, True)


@njit(**PART)
def _acceleration_peaks(run):
    slots = run.slots
    for b in range(run.low, run.high, 8):
        peak = load(slots, at(b, c.MOST_PULL))
        reach = maximum(magnitude(load(slots, at(b, c.PULL0))), magnitude(load(slots, at(b, c.PULL))))
        stray = load(slots, at(b, c.PULL_STRAY))
        suspects = greater(reach + stray, peak)
        if suspects != 0:
            store(slots, at(b, c.MOST_PULL), maximum(peak, reach))
            suspects &= bends(load(slots, at(b, c.PULL0)), load(slots, at(b, c.PULL)), stray)
            while suspects != 0:
                i = b + lowest(suspects)
                suspects &= suspects - 1
                best = slots[of(i, c.MOST_PULL)]
                slots[of(i, c.MOST_PULL)] = _acceleration_peak(run, i, best)


@njit(**PART)
def widen(run):
    """Widen what the displacements stay between in this segment by what this step may reach."""
    for b in range(run.low, run.high, 8):
        first = load(run.W, b - run.padded)
        last = load(run.ends, b)
        stray = load(run.ends, run.padded + b)
        top = 2 * run.padded + b
        bottom = top + run.padded
        store(run.ends, top, maximum(load(run.ends, top), maximum(first, last) + stray))
        store(run.ends, bottom, minimum(load(run.ends, bottom), minimum(first, last) - stray))


@njit(**CALLED)
def sample(run, row, slots, samples):
    """Enter the displacements at the end of this segment, by slot."""
    stand_alone()
    line = run.tally[SEGMENT] * slots
    for slot in range(row.slots):
        samples[line + slot] = run.W[row.spots[slot] - run.padded]


@njit(**CALLED)
def _closing_peak(run, e, best):
    """Largest closing of link e inside the step, at least `best`."""
    stand_alone()
    order = run.tally[ORDER]
    h = run.clock[H]
    left = run.ties[of_tie(e, c.LEFT_SLOT)]
    right = run.ties[of_tie(e, c.RIGHT_SLOT)]
    run.scratch[0] = run.W[left - run.padded] - run.W[right - run.padded]
    for k in range(1, order + 1):
        row = (k - 1) * run.padded
        run.scratch[k] = h * run.reciprocal[k] * (run.W[row + left] - run.W[row + right])
    return highest(run.scratch, order, run.clock[END], best, False)


@njit(**CALLED)
def _force_peak(run, e, best):
    """Largest |force| of link e inside the step, at least `best`."""
    stand_alone()
    order = run.tally[ORDER]
    end = run.clock[END]
    for k in range(order):
        run.scratch[k] = run.series[of_term(run, k, e, c.F_TERM)]
    return highest(run.scratch, order - 1, end, best, True)


@njit(**PART)
def _link_peaks(run, order, busy):
    links = run.links
    end = splat(run.clock[END])
    duration = splat(run.clock[H]) * end
    for b in range(run.first, run.last, 8):
        first = apart(run, run.W, -run.padded, b)
        last, stray = link_end(run, b)
        peak = load(links, at_link(b, c.MOST_CLOSING))
        reach = maximum(first, last)
        suspects = greater(reach + stray, peak)
        if suspects != 0:
            store(links, at_link(b, c.MOST_CLOSING), maximum(peak, reach))
            suspects &= bends(first, last, stray)
            while suspects != 0:
                e = b + lowest(suspects)
                suspects &= suspects - 1
                best = links[of_link(e, c.MOST_CLOSING)]
                links[of_link(e, c.MOST_CLOSING)] = _closing_peak(run, e, best)
        if busy == 0 or closed_at(run, b) == 0:
            continue
        applied = load(links, at_link(b, c.APPLIED))
        impulse = splat(0.0)
        last = splat(0.0)
        stray = splat(0.0)
        number = order - 1.0
        for k in range(order - 1, -1, -1):
            force = load(run.series, at_term(run, k, b, c.F_TERM))
            impulse = fused(impulse, end, force * run.reciprocal[k + 1])
            last = fused(last, end, force)
            stray = fused(magnitude(force), number * (number - 1.0), stray)
            number -= 1.0
        first = load(run.series, at_term(run, 0, b, c.F_TERM))
        stray = 0.125 * stray
        reach = maximum(magnitude(first), magnitude(last))
        peak = load(links, at_link(b, c.MOST_FORCE))
        held = duration * applied
        store(links, at_link(b, c.IMPULSE), fused(impulse, held, load(links, at_link(b, c.IMPULSE))))  # fault: impulse
        store(links, at_link(b, c.CONTACT), load(links, at_link(b, c.CONTACT)) + held)
        suspects = greater((reach + stray) * applied, peak)
        if suspects != 0:
            store(links, at_link(b, c.MOST_FORCE), maximum(peak, reach * applied))
            suspects &= bends(first, last, stray)
        while suspects != 0:
            e = b + lowest(suspects)
            suspects &= suspects - 1
            best = links[of_link(e, c.MOST_FORCE)]
            links[of_link(e, c.MOST_FORCE)] = _force_peak(run, e, best)


@njit(**CALLED)
def track(run, feet, order, busy, inelastic, founded):
    """Raise every peak that this step, up to s = END, exceeds; `order` is the series'."""
    stand_alone()
    _drift_peaks(run, founded)
    if inelastic:
        _shear_peaks(run, founded)
    _displacement_peaks(run)
    _acceleration_peaks(run)
    if founded:
        rocking_peaks(run, feet)
    if run.last > run.first:
        _link_peaks(run, order, busy)
        count_from_rest(run)
