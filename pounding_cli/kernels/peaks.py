"""Largest values over a step: nothing is looked at closely unless its bound exceeds the peak so far."""

from __future__ import annotations

from numba import njit

from pounding_cli.kernels import cells as c
from pounding_cli.kernels.cells import at, at_link, at_term, of, of_link, of_link_integer, of_term
from pounding_cli.kernels.clock import END, GROUND, GROUND_CHANGE, INVERSE_H, ORDER, SEGMENT, H
from pounding_cli.kernels.from_rest import count_from_rest
from pounding_cli.kernels.layout import CALLED, PART
from pounding_cli.kernels.link_series import closed_lanes, closing_at_end, left_minus_right
from pounding_cli.kernels.polynomial import ABSOLUTE, SIGNED, highest, value
from pounding_cli.kernels.simd import (
    fused,
    greater,
    load,
    lowest,
    magnitude,
    maximum,
    minimum,
    no_inline,
    splat,
    store,
)
from pounding_cli.kernels.summary import drift_series, may_turn_by_ends, may_turn_by_rates


@njit(**CALLED)
def largest(run, order, best, absolute):
    """The larger of `best` and the largest value, or magnitude, of the polynomial in `scratch` up to END."""
    no_inline()
    bound = abs(run.scratch[0]) if absolute else run.scratch[0]
    for k in range(1, order + 1):
        bound += abs(run.scratch[k])
    if not bound > best:
        return best
    end = run.clock[END]
    for place in (0.0, end):
        found = value(run.scratch, order, place)
        best = max(best, abs(found) if absolute else found)
    return highest(run.scratch, order, end, best, absolute)


@njit(**PART)
def drift_may_turn(slots, b):
    return may_turn_by_rates(
        load(slots, at(b, c.DRIFT_RATE0)),
        load(slots, at(b, c.DRIFT_RATE1)),
        load(slots, at(b, c.DRIFT_RATE_CHORD_DEVIATION)),
    )


@njit(**CALLED)
def _drift_peak(run, i, factor, offset, best):
    """Largest |factor x drift + offset| of storey i inside the step, at least `best`."""
    no_inline()
    order = run.tally[ORDER]
    drift_series(run, run.clock[H], i, order, factor)
    run.scratch[0] += offset
    return highest(run.scratch, order, run.clock[END], best, ABSOLUTE)


@njit(**PART)
def _drift_peaks(run):
    slots = run.slots
    for b in range(run.slot_start, run.slot_stop, 8):
        peak = load(slots, at(b, c.PEAK_DRIFT))
        reach = maximum(magnitude(load(slots, at(b, c.DRIFT0))), magnitude(load(slots, at(b, c.DRIFT1))))
        suspects = greater(reach + load(slots, at(b, c.DRIFT_CHORD_DEVIATION)), peak)
        if suspects != 0:
            store(slots, at(b, c.PEAK_DRIFT), maximum(peak, reach))
            suspects &= drift_may_turn(slots, b)
            while suspects != 0:
                i = b + lowest(suspects)
                suspects &= suspects - 1
                best = slots[of(i, c.PEAK_DRIFT)]
                slots[of(i, c.PEAK_DRIFT)] = _drift_peak(run, i, 1.0, 0.0, best)


@njit(**PART)
def _shear_peaks(run):
    slots = run.slots
    for b in range(run.slot_start, run.slot_stop, 8):
        peak = load(slots, at(b, c.PEAK_SHEAR))
        tangent = load(slots, at(b, c.TANGENT))
        offset = load(slots, at(b, c.OFFSET))
        first = magnitude(fused(tangent, load(slots, at(b, c.DRIFT0)), offset))
        reach = maximum(first, magnitude(fused(tangent, load(slots, at(b, c.DRIFT1)), offset)))
        deviation = load(slots, at(b, c.DRIFT_CHORD_DEVIATION))
        suspects = greater(fused(magnitude(tangent), deviation, reach), peak)
        if suspects != 0:
            store(slots, at(b, c.PEAK_SHEAR), maximum(peak, reach))
            suspects &= drift_may_turn(slots, b)
            while suspects != 0:
                i = b + lowest(suspects)
                suspects &= suspects - 1
                best = slots[of(i, c.PEAK_SHEAR)]
                slots[of(i, c.PEAK_SHEAR)] = _drift_peak(run, i, slots[of(i, c.TANGENT)], slots[of(i, c.OFFSET)], best)


@njit(**CALLED)
def _displacement_peak(run, i, sign, best):
    """Largest displacement of slot i times `sign` inside the step, at least `best`."""
    no_inline()
    order = run.tally[ORDER]
    step = sign * run.clock[H]
    run.scratch[0] = sign * run.W[i - run.padded]
    for k in range(1, order + 1):
        run.scratch[k] = step * run.reciprocal[k] * run.W[(k - 1) * run.padded + i]
    return highest(run.scratch, order, run.clock[END], best, SIGNED)


@njit(**PART)
def _displacement_peaks(run):
    slots = run.slots
    minus = splat(-1.0)
    for b in range(run.slot_start, run.slot_stop, 8):
        first = load(run.W, b - run.padded)
        last = load(run.ends, b)
        deviation = load(run.ends, run.padded + b)
        top = load(slots, at(b, c.MAX_DISPLACEMENT))
        bottom = load(slots, at(b, c.MIN_DISPLACEMENT))
        above = greater(maximum(first, last) + deviation, top)
        below = greater(minus * minimum(first, last) + deviation, minus * bottom)
        if above | below != 0:
            store(slots, at(b, c.MAX_DISPLACEMENT), maximum(top, maximum(first, last)))
            store(slots, at(b, c.MIN_DISPLACEMENT), minimum(bottom, minimum(first, last)))
            turning = may_turn_by_rates(
                load(run.W, b), load(slots, at(b, c.V1)), load(slots, at(b, c.V_CHORD_DEVIATION))
            )
            above &= turning
            below &= turning
            while above != 0:
                i = b + lowest(above)
                above &= above - 1
                slots[of(i, c.MAX_DISPLACEMENT)] = _displacement_peak(run, i, 1.0, slots[of(i, c.MAX_DISPLACEMENT)])
            while below != 0:
                i = b + lowest(below)
                below &= below - 1
                low = _displacement_peak(run, i, -1.0, -slots[of(i, c.MIN_DISPLACEMENT)])
                slots[of(i, c.MIN_DISPLACEMENT)] = -low


@njit(**CALLED)
def _acceleration_peak(run, i, best):
    """Largest |total acceleration| of slot i inside the step, at least `best`."""
    no_inline()
    order = run.tally[ORDER]
    per_h = run.clock[INVERSE_H]
    number = per_h
    for k in range(order):
        run.scratch[k] = number * run.W[(k + 1) * run.padded + i]
        number += per_h
    run.scratch[0] += run.clock[GROUND]
    run.scratch[1] += run.clock[GROUND_CHANGE]
    return highest(run.scratch, order - 1, run.clock[END], best, ABSOLUTE)


@njit(**PART)
def _acceleration_peaks(run):
    slots = run.slots
    for b in range(run.slot_start, run.slot_stop, 8):
        peak = load(slots, at(b, c.PEAK_ACCELERATION))
        reach = maximum(
            magnitude(load(slots, at(b, c.TOTAL_ACCELERATION0))), magnitude(load(slots, at(b, c.TOTAL_ACCELERATION1)))
        )
        deviation = load(slots, at(b, c.TOTAL_ACCELERATION_CHORD_DEVIATION))
        suspects = greater(reach + deviation, peak)
        if suspects != 0:
            store(slots, at(b, c.PEAK_ACCELERATION), maximum(peak, reach))
            suspects &= may_turn_by_ends(
                load(slots, at(b, c.TOTAL_ACCELERATION0)), load(slots, at(b, c.TOTAL_ACCELERATION1)), deviation
            )
            while suspects != 0:
                i = b + lowest(suspects)
                suspects &= suspects - 1
                best = slots[of(i, c.PEAK_ACCELERATION)]
                slots[of(i, c.PEAK_ACCELERATION)] = _acceleration_peak(run, i, best)


@njit(**PART)
def widen_ranges(run):
    """Widen what the displacements stay between in this segment by what this step may reach."""
    for b in range(run.slot_start, run.slot_stop, 8):
        first = load(run.W, b - run.padded)
        last = load(run.ends, b)
        deviation = load(run.ends, run.padded + b)
        top = 2 * run.padded + b
        bottom = top + run.padded
        store(run.ends, top, maximum(load(run.ends, top), maximum(first, last) + deviation))
        store(run.ends, bottom, minimum(load(run.ends, bottom), minimum(first, last) - deviation))


@njit(**CALLED)
def sample(run, row, slots, samples):
    """Enter the displacements at the end of this segment, by slot."""
    no_inline()
    line = run.tally[SEGMENT] * slots
    for slot in range(row.slots):
        samples[line + slot] = run.W[row.slot_places[slot] - run.padded]


@njit(**CALLED)
def _closing_peak(run, e, best):
    """Largest closing of link e inside the step, at least `best`."""
    no_inline()
    order = run.tally[ORDER]
    h = run.clock[H]
    left = run.link_integers[of_link_integer(e, c.LEFT_SLOT)]
    right = run.link_integers[of_link_integer(e, c.RIGHT_SLOT)]
    run.scratch[0] = run.W[left - run.padded] - run.W[right - run.padded]
    for k in range(1, order + 1):
        row = (k - 1) * run.padded
        run.scratch[k] = h * run.reciprocal[k] * (run.W[row + left] - run.W[row + right])
    return highest(run.scratch, order, run.clock[END], best, SIGNED)


@njit(**CALLED)
def _force_peak(run, e, best):
    """Largest |force| of link e inside the step, at least `best`."""
    no_inline()
    order = run.tally[ORDER]
    end = run.clock[END]
    for k in range(order):
        run.scratch[k] = run.series[of_term(run, k, e, c.FORCE_TERM)]
    return highest(run.scratch, order - 1, end, best, ABSOLUTE)


@njit(**PART)
def _link_peaks(run, order, any_closed):
    links = run.links
    end = splat(run.clock[END])
    duration = splat(run.clock[H]) * end
    for b in range(run.link_start, run.link_stop, 8):
        first = left_minus_right(run, run.W, -run.padded, b)
        last, deviation = closing_at_end(run, b)
        peak = load(links, at_link(b, c.PEAK_CLOSING))
        reach = maximum(first, last)
        suspects = greater(reach + deviation, peak)
        if suspects != 0:
            store(links, at_link(b, c.PEAK_CLOSING), maximum(peak, reach))
            suspects &= may_turn_by_ends(first, last, deviation)
            while suspects != 0:
                e = b + lowest(suspects)
                suspects &= suspects - 1
                best = links[of_link(e, c.PEAK_CLOSING)]
                links[of_link(e, c.PEAK_CLOSING)] = _closing_peak(run, e, best)
        if any_closed == 0 or closed_lanes(run, b) == 0:
            continue
        applied = load(links, at_link(b, c.ACTS))
        impulse = splat(0.0)
        last = splat(0.0)
        deviation = splat(0.0)
        number = order - 1.0
        for k in range(order - 1, -1, -1):
            force = load(run.series, at_term(run, k, b, c.FORCE_TERM))
            impulse = fused(impulse, end, force * run.reciprocal[k + 1])
            last = fused(last, end, force)
            deviation = fused(magnitude(force), number * (number - 1.0), deviation)
            number -= 1.0
        first = load(run.series, at_term(run, 0, b, c.FORCE_TERM))
        deviation = 0.125 * deviation
        reach = maximum(magnitude(first), magnitude(last))
        peak = load(links, at_link(b, c.PEAK_FORCE))
        held = duration * applied
        store(links, at_link(b, c.IMPULSE), fused(impulse, held, load(links, at_link(b, c.IMPULSE))))
        store(links, at_link(b, c.CONTACT_TIME), load(links, at_link(b, c.CONTACT_TIME)) + held)
        suspects = greater((reach + deviation) * applied, peak)
        if suspects != 0:
            store(links, at_link(b, c.PEAK_FORCE), maximum(peak, reach * applied))
            suspects &= may_turn_by_ends(first, last, deviation)
        while suspects != 0:
            e = b + lowest(suspects)
            suspects &= suspects - 1
            best = links[of_link(e, c.PEAK_FORCE)]
            links[of_link(e, c.PEAK_FORCE)] = _force_peak(run, e, best)


@njit(**CALLED)
def track(run, order, any_closed, inelastic):
    """Raise every peak that this step, up to s = END, exceeds; `order` is the series'."""
    no_inline()
    _drift_peaks(run)
    if inelastic:
        _shear_peaks(run)
    _displacement_peaks(run)
    _acceleration_peaks(run)
    if run.link_stop > run.link_start:
        _link_peaks(run, order, any_closed)
        count_from_rest(run)
