"""Where the energy of a step goes: what the ground puts in, what dashpots, yielding storeys and links take out.

Powers are integrated over the step by Gauss-Legendre points on the step's own polynomials; with half as many points
as the series has orders, all terms up to the series' own order are exact. Hysteresis needs no points: on a yield
line the storey dissipates (1 - a) Vy per unit of drift."""

from __future__ import annotations

from collections import namedtuple

from numba import njit

from pounding_cli.kernels.layout import INLINE, LINKS_NONE
from pounding_cli.kernels.simd import from_left, load, pointer, splat, store

MOST_POINTS = 18
"""Points of the largest rule; rule n stands in the flat tables from n (n - 1) / 2 on."""

Ledger = namedtuple("Ledger", "input dashpots drag hysteresis links feet")
"""Energies so far [J]: per slot the ground's input, the spring's dashpot, the mass-proportional drag (fixed base) and
hysteresis; per link the work done on it; per foundation its drag and rocking dashpot."""


@njit(**INLINE)
def ledger_pointers(a):
    """Ledger of pointers from Ledger of arrays."""
    return Ledger(
        pointer(a.input),
        pointer(a.dashpots),
        pointer(a.drag),
        pointer(a.hysteresis),
        pointer(a.links),
        pointer(a.feet),
    )


@njit(**INLINE)
def _feet_powers(slots, feet, work, ledger, order, s, weight, h):
    """Drag of founded buildings and rocking dashpots at one point."""
    padded = slots.size
    for f in range(feet.number):
        turning = 0.0
        sway = 0.0
        base = feet.base[f]
        for k in range(order, -1, -1):
            turning = turning * s + work.phi_W[k * feet.number + f]
            if base >= 0:
                sway = sway * s + work.W[k * padded + base]
        power = feet.dashpot[f] * turning * turning
        for i in range(feet.first[f], feet.stop[f]):
            rate = 0.0
            for k in range(order, -1, -1):
                rate = rate * s + work.W[k * padded + i]
            rate -= sway + slots.elevation[i] * turning
            power += feet.alpha[f] * slots.mass[i] * rate * rate
            lean = slots.rise[i] * turning
            # The storey's dashpot was charged without rocking; put that right.
            below = 0.0
            here = 0.0
            for k in range(order, -1, -1):
                here = here * s + work.W[k * padded + i]
                if slots.couple[i] != 0.0:
                    below = below * s + work.W[k * padded + i - 1]
            bare = here - below
            power += slots.dashpot[i] * ((bare - lean) * (bare - lean) - bare * bare)
        ledger.feet[f] += power * weight / h


@njit(**INLINE)
def account(
    slots, feet, links, state, work, ends, ledger, nodes, weights, order, end, h, ag, slope, busy, inelastic, founded,
    kinds,
):  # fmt: skip
    """Add the energies of the step up to s = `end`."""
    padded = slots.size
    points = min(order // 2 + 1, MOST_POINTS)
    first = points * (points - 1) // 2
    for g in range(first, first + points):
        s = nodes[g] * end
        weight = weights[g] * end
        ground = (ag + slope * h * s) * weight
        share = weight / h
        left = splat(0.0)
        for b in range(0, padded, 8):
            v = load(work.W, order * padded + b)
            for k in range(order - 1, -1, -1):
                v = v * s + load(work.W, k * padded + b)
            rate = v - load(slots.couple, b) * from_left(left, v)
            left = v
            mass = load(slots.mass, b)
            store(ledger.input, b, load(ledger.input, b) - mass * v * ground)
            store(ledger.dashpots, b, load(ledger.dashpots, b) + load(slots.dashpot, b) * rate * rate * share)
            store(ledger.drag, b, load(ledger.drag, b) + load(slots.alpha, b) * mass * v * v * share)
        if founded:
            _feet_powers(slots, feet, work, ledger, order, s, weight, h)
        if kinds != LINKS_NONE and busy > 0:
            count = links.size
            for b in range(0, count, 8):
                force = splat(0.0)
                rate = splat(0.0)
                for k in range(order - 1, -1, -1):
                    force = force * s + load(work.F, k * count + b)
                    rate = rate * s + load(work.rates, k * count + b)
                power = force * rate * load(work.law, 5 * count + b)
                store(ledger.links, b, load(ledger.links, b) + power * (share / h))
    if inelastic:
        for b in range(0, padded, 8):
            moved = load(ends.drift, b) - load(work.D, b)
            spent = load(state.line, b) * load(slots.plateau, b) * moved
            store(ledger.hysteresis, b, load(ledger.hysteresis, b) + spent)
