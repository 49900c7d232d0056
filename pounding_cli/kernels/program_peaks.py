"""What a program step adds to peaks, impulses and energies: its series hold the same quantities as those of a plain
step (`peaks`, `ledger`), in s instead of time."""

from __future__ import annotations

from numba import njit

from pounding_cli.kernels import cells as c
from pounding_cli.kernels.cells import at, of, of_link, of_link_integer
from pounding_cli.kernels.clock import END, GROUND, GROUND_SLOPE, ORDER, H
from pounding_cli.kernels.from_rest import count_from_rest
from pounding_cli.kernels.layout import CALLED, PART
from pounding_cli.kernels.ledger import MAX_POINTS, SHARES
from pounding_cli.kernels.peaks import largest
from pounding_cli.kernels.polynomial import ABSOLUTE, SIGNED, value
from pounding_cli.kernels.program import RATE
from pounding_cli.kernels.program_frame import FLOWING, force_register, is_closed, register
from pounding_cli.kernels.program_storeys import account_storeys, drift_terms, shear_terms
from pounding_cli.kernels.simd import from_left, fused, load, no_inline, splat, store
from pounding_cli.kernels.terms import account_springs


@njit(**CALLED)
def _slot_peaks(run, p, i, inelastic):
    """Drift, shear, displacement and total acceleration of slot i."""
    no_inline()
    slots = run.slots
    order = run.tally[ORDER]
    drift_terms(run, p, i, order, 1.0)
    slots[of(i, c.PEAK_DRIFT)] = largest(run, order, slots[of(i, c.PEAK_DRIFT)], ABSOLUTE)
    if inelastic:
        shear_terms(run, p, i, 1.0)
        slots[of(i, c.PEAK_SHEAR)] = largest(run, order, slots[of(i, c.PEAK_SHEAR)], ABSOLUTE)
    for sign in (1.0, -1.0):
        for k in range(order + 1):
            run.scratch[k] = sign * p.U[k * run.padded + i]
        if sign > 0.0:
            slots[of(i, c.MAX_DISPLACEMENT)] = largest(run, order, slots[of(i, c.MAX_DISPLACEMENT)], SIGNED)
        else:
            slots[of(i, c.MIN_DISPLACEMENT)] = -largest(run, order, -slots[of(i, c.MIN_DISPLACEMENT)], SIGNED)
    for k in range(order):
        run.scratch[k] = p.A[k * run.padded + i] + run.clock[GROUND_SLOPE] * p.T[k]
    run.scratch[0] += run.clock[GROUND]
    slots[of(i, c.PEAK_ACCELERATION)] = largest(run, order - 1, slots[of(i, c.PEAK_ACCELERATION)], ABSOLUTE)


@njit(**CALLED)
def _link_peaks(run, p, e):
    """Closing, force, impulse and contact time of link e."""
    no_inline()
    links = run.links
    order = run.tally[ORDER]
    left, right = (
        run.link_integers[of_link_integer(e, c.LEFT_SLOT)],
        run.link_integers[of_link_integer(e, c.RIGHT_SLOT)],
    )
    for k in range(order + 1):
        run.scratch[k] = p.U[k * run.padded + left] - p.U[k * run.padded + right]
    links[of_link(e, c.PEAK_CLOSING)] = largest(run, order, links[of_link(e, c.PEAK_CLOSING)], SIGNED)
    if is_closed(run, e) and links[of_link(e, c.ACTS)] != 0.0:
        force = force_register(run, p, e)
        for k in range(order):
            run.scratch[k] = force[k]
        links[of_link(e, c.PEAK_FORCE)] = largest(run, order - 1, links[of_link(e, c.PEAK_FORCE)], ABSOLUTE)
        links[of_link(e, c.CONTACT_TIME)] += run.clock[H] * run.clock[END]


@njit(**CALLED)
def track(run, p, inelastic):
    """Raise every peak that this step, up to s = END, exceeds."""
    no_inline()
    for b in range(run.slot_start, run.slot_stop):
        if run.slots[of(b, c.MASS)] != 0.0:
            _slot_peaks(run, p, b, inelastic)
    for e in range(run.link_start, run.link_stop):
        _link_peaks(run, p, e)
    count_from_rest(run)


@njit(**CALLED)
def widen_ranges(run, p):
    """Widen what the displacements stay between in this segment by what this step may reach."""
    no_inline()
    order = run.tally[ORDER]
    for i in range(run.slot_start, run.slot_stop):
        reach = 0.0
        for k in range(1, order + 1):
            reach += abs(p.U[k * run.padded + i])
        top = 2 * run.padded + i
        run.ends[top] = max(run.ends[top], p.U[i] + reach)
        run.ends[top + run.padded] = min(run.ends[top + run.padded], p.U[i] - reach)


@njit(**PART)
def _set_rule(run, p, nodes, weights):
    """Points (s of the step) and weights [s], eight copies of each, of a rule that integrates a polynomial of the
    series' order, and four more, exactly; returns their number."""
    order = run.tally[ORDER]
    points = min(order // 2 + 3, MAX_POINTS)
    row = points * MAX_POINTS
    end = run.clock[END]
    for g in range(points):
        s = nodes[row + g] * end
        store(run.rule, 8 * g, splat(s))
        store(run.rule, SHARES + 8 * g, splat(weights[row + g] * end * value(p.B, order - 1, s)))
    return points


@njit(**CALLED)
def _link_work(run, p, e, points):
    """Work done on link e, and its impulse."""
    no_inline()
    order = run.tally[ORDER]
    force, rate = force_register(run, p, e), register(p, e, RATE)
    work, impulse = 0.0, 0.0
    for g in range(0, 8 * points, 8):
        s, share = run.rule[g], run.rule[SHARES + g]
        pushed = value(force, order - 1, s) * share
        impulse += pushed
        work += pushed * value(rate, order - 1, s)
    acting = run.links[of_link(e, c.ACTS)]
    run.links[of_link(e, c.WORK)] += acting * work
    run.links[of_link(e, c.IMPULSE)] += acting * impulse


@njit(**CALLED)
def account(run, terms, p, nodes, weights, inelastic, has_terms):
    """Add the energies of the step up to s = END."""
    no_inline()
    points = _set_rule(run, p, nodes, weights)
    slots = run.slots
    order = run.tally[ORDER]
    for g in range(0, 8 * points, 8):
        s, share = run.rule[g], load(run.rule, SHARES + g)
        ground = splat(run.clock[GROUND] + run.clock[GROUND_SLOPE] * value(p.T, order, s))
        left = splat(0.0)
        for b in range(run.slot_start, run.slot_stop, 8):
            v = splat(0.0)
            for k in range(order, -1, -1):
                v = fused(v, splat(s), load(run.W, k * run.padded + b))
            rate = v - load(slots, at(b, c.COUPLE)) * from_left(left, v)
            left = v
            mass = load(slots, at(b, c.MASS)) * load(slots, at(b, c.LOADED))
            store(slots, at(b, c.INPUT_ENERGY), load(slots, at(b, c.INPUT_ENERGY)) - mass * v * ground * share)
            dashed = load(slots, at(b, c.DASHPOT)) * rate * rate * share
            store(slots, at(b, c.DASHPOT_ENERGY), load(slots, at(b, c.DASHPOT_ENERGY)) + dashed)
            drag = load(slots, at(b, c.ALPHA)) * mass * v * v * share
            store(slots, at(b, c.DRAG_ENERGY), load(slots, at(b, c.DRAG_ENERGY)) + drag)
    if has_terms:
        account_springs(run, terms, points, SHARES)
    for e in range(run.link_start, run.link_stop):
        if is_closed(run, e):
            _link_work(run, p, e, points)
    if inelastic:
        for i in range(run.slot_start, run.slot_stop):
            first, last = slots[of(i, c.DRIFT0)], slots[of(i, c.DRIFT1)]
            mean = slots[of(i, c.LOST)] + slots[of(i, c.LOST_SLOPE)] * 0.5 * (first + last)
            slots[of(i, c.HYSTERESIS_ENERGY)] += mean * (last - first)
        if p.numbers[FLOWING] > 0.0:
            account_storeys(run, p, points)
