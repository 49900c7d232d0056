"""Where the energy of a step goes: what the ground puts in, what dashpots, yielding storeys and links take out.

Powers are integrated over the step by Gauss-Legendre points on the step's own polynomials. A third as many points as
the series has orders, and one, integrate two thirds of it exactly; of what a term beyond that adds, 4^-order is lost,
so where the series leaves 1e-6 of a step the rule leaves less than 1e-9 of its energy. Hysteresis needs no points: the
part of a storey's shear that is lost is straight in the drift."""

from __future__ import annotations

from collections import namedtuple

from numba import njit

from pounding_cli.kernels import cells as c
from pounding_cli.kernels.cells import at, at_link, at_term
from pounding_cli.kernels.clock import END, GROUND, GROUND_CHANGE, H
from pounding_cli.kernels.layout import CALLED, PART
from pounding_cli.kernels.link_series import closed_lanes
from pounding_cli.kernels.simd import from_left, fused, load, no_inline, pointer, splat, store
from pounding_cli.kernels.terms import account_springs

MAX_POINTS = 18
"""Points of the largest rule; rule n stands in row n of the tables, its weights beyond n zero."""

MIN_POINTS = 4
"""Points of the smallest rule: short series are of coarse accuracy, which is no reason to book carelessly."""

Ledger = namedtuple("Ledger", "input dashpots drag hysteresis stored links")
"""Energies so far [J]: per slot the ground's input, what the spring's dashpot, the mass-proportional drag and
hysteresis took, and what its spring holds now; per link the work done on it."""


@njit(**PART)
def ledger_pointers(a):
    """Ledger of pointers from Ledger of arrays."""
    return Ledger(
        pointer(a.input),
        pointer(a.dashpots),
        pointer(a.drag),
        pointer(a.hysteresis),
        pointer(a.stored),
        pointer(a.links),
    )


SHARES = 8 * MAX_POINTS
"""Where the weights begin in `Run.rule`."""

_BLOCK_BEFORE = 16 * MAX_POINTS
"""Where the velocities of the block before begin."""

RULE_SIZE = 24 * MAX_POINTS
"""Doubles of `Run.rule`."""


@njit(**PART)
def _set_rule(run, nodes, weights, order):
    """Points (s of the step) and weights [s] for a series of this order, eight copies of each; returns their number,
    which is even."""
    points = max((order + 8) // 6 * 2, MIN_POINTS)
    row = points * MAX_POINTS
    end = run.clock[END]
    duration = end * run.clock[H]
    for g in range(points):
        store(run.rule, 8 * g, splat(nodes[row + g] * end))
        store(run.rule, SHARES + 8 * g, splat(weights[row + g] * duration))
    return points


@njit(**PART)
def _add_powers(rule, g, s, v, couple, ground, change, pushed, drag, dashed):
    """The three sums with what the velocities v at one point add."""
    share = load(rule, SHARES + g)
    rate = v - couple * from_left(load(rule, _BLOCK_BEFORE + g), v)
    store(rule, _BLOCK_BEFORE + g, v)
    part = v * share
    return fused(part, fused(change, s, ground), pushed), fused(part, v, drag), fused(rate * share, rate, dashed)


@njit(**PART)
def _work_of_linear_links(run, b, points, order):
    """Work done on eight links of straight laws: what springs hold more, and what dashpots take."""
    links = run.links
    rule = run.rule
    first = load(run.series, at_term(run, 0, b, c.CLOSING_TERM))
    end = splat(run.clock[END])
    last = splat(0.0)  # from the series: a stiff spring is pressed by less than the last digits of displacements
    for k in range(order, -1, -1):
        last = fused(last, end, load(run.series, at_term(run, k, b, c.CLOSING_TERM)))
    mean = fused(load(links, at_link(b, c.LAW_LINEAR)), (first + last) * 0.5, load(links, at_link(b, c.LAW_OFFSET)))
    squares = splat(0.0)
    for g in range(0, 8 * points, 16):
        s0 = load(rule, g)
        s1 = load(rule, g + 8)
        rate0, rate1 = splat(0.0), splat(0.0)
        for k in range(order - 1, -1, -1):
            rate = load(run.series, at_term(run, k, b, c.RATE_TERM))
            rate0 = fused(rate0, s0, rate)
            rate1 = fused(rate1, s1, rate)
        squares = fused(rate0 * load(rule, SHARES + g), rate0, squares)
        squares = fused(rate1 * load(rule, SHARES + g + 8), rate1, squares)
    return fused(load(links, at_link(b, c.LAW_DASHPOT)), squares, mean * (last - first))


@njit(**PART)
def _work_by_quadrature(run, b, points, order):
    """Work done on eight links of any law."""
    rule = run.rule
    spent = splat(0.0)
    for g in range(0, 8 * points, 16):
        s0 = load(rule, g)
        s1 = load(rule, g + 8)
        force0, force1, rate0, rate1 = splat(0.0), splat(0.0), splat(0.0), splat(0.0)
        for k in range(order - 1, -1, -1):
            term = at_term(run, k, b, 0)
            force = load(run.series, term + c.FORCE_TERM)
            rate = load(run.series, term + c.RATE_TERM)
            force0 = fused(force0, s0, force)
            force1 = fused(force1, s1, force)
            rate0 = fused(rate0, s0, rate)
            rate1 = fused(rate1, s1, rate)
        spent = fused(force0 * load(rule, SHARES + g), rate0, spent)
        spent = fused(force1 * load(rule, SHARES + g + 8), rate1, spent)
    return spent


@njit(**PART)
def _account_slots(run, order, points):
    """Add what the ground puts in and what the dashpots of the storeys take."""
    padded = run.padded
    slots = run.slots
    rule = run.rule
    ground = splat(run.clock[GROUND])
    change = splat(run.clock[GROUND_CHANGE])
    for g in range(0, 8 * points, 8):
        store(rule, _BLOCK_BEFORE + g, splat(0.0))
    for b in range(run.slot_start, run.slot_stop, 8):
        couple = load(slots, at(b, c.COUPLE))
        pushed = splat(0.0)
        drag = splat(0.0)
        dashed = splat(0.0)
        for g in range(0, 8 * points, 16):  # two at once share what they read
            s0 = load(rule, g)
            s1 = load(rule, g + 8)
            v0 = load(run.W, order * padded + b)
            v1 = v0
            for row in range((order - 1) * padded + b, b - 1, -padded):
                w = load(run.W, row)
                v0 = fused(v0, s0, w)
                v1 = fused(v1, s1, w)
            pushed, drag, dashed = _add_powers(rule, g, s0, v0, couple, ground, change, pushed, drag, dashed)
            pushed, drag, dashed = _add_powers(rule, g + 8, s1, v1, couple, ground, change, pushed, drag, dashed)
        mass = load(slots, at(b, c.MASS)) * load(slots, at(b, c.LOADED))
        store(slots, at(b, c.INPUT_ENERGY), load(slots, at(b, c.INPUT_ENERGY)) - mass * pushed)
        taken = fused(load(slots, at(b, c.DASHPOT)), dashed, load(slots, at(b, c.DASHPOT_ENERGY)))
        store(slots, at(b, c.DASHPOT_ENERGY), taken)
        taken = fused(load(slots, at(b, c.ALPHA)) * mass, drag, load(slots, at(b, c.DRAG_ENERGY)))
        store(slots, at(b, c.DRAG_ENERGY), taken)


@njit(**PART)
def _account_links(run, order, points, curved):
    """Add the work done on links."""
    links = run.links
    for b in range(run.link_start, run.link_stop, 8):
        if closed_lanes(run, b) != 0:
            if curved != 0:
                work = _work_by_quadrature(run, b, points, order)
            else:
                work = _work_of_linear_links(run, b, points, order)
            store(
                links, at_link(b, c.WORK), fused(work, load(links, at_link(b, c.ACTS)), load(links, at_link(b, c.WORK)))
            )


@njit(**PART)
def _account_yielding(run):
    """Add what storeys dissipate: the part of their shear that is lost is straight in the drift."""
    slots = run.slots
    for b in range(run.slot_start, run.slot_stop, 8):
        first, last = load(slots, at(b, c.DRIFT0)), load(slots, at(b, c.DRIFT1))
        mean = fused(load(slots, at(b, c.LOST_SLOPE)), (first + last) * 0.5, load(slots, at(b, c.LOST)))
        spent = mean * (last - first)
        store(slots, at(b, c.HYSTERESIS_ENERGY), load(slots, at(b, c.HYSTERESIS_ENERGY)) + spent)


@njit(**CALLED)
def account(run, terms, nodes, weights, order, any_closed, curved, inelastic, has_terms):
    """Add the energies of the step up to s = END."""
    no_inline()
    points = _set_rule(run, nodes, weights, order)
    _account_slots(run, order, points)
    if has_terms:
        account_springs(run, terms, points, SHARES)
    if any_closed != 0:
        _account_links(run, order, points, curved)
    if inelastic:
        _account_yielding(run)
