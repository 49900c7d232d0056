"""The force of a link from its tables, at one closing and rate: what one-step methods call.

The Taylor integrator works on series instead (`link_series`), from the same tables."""

from __future__ import annotations

import math

from numba import njit

from pounding_cli.kernels import law_table as t
from pounding_cli.kernels.law_table import branch
from pounding_cli.kernels.layout import INLINE
from pounding_cli.kernels.program import force_and_slope


@njit(**INLINE)
def branch_at(links, e, v):
    """The branch of link e that acts at closing v [m]; -1 if none does."""
    for b in range(links.first[e], links.last[e]):
        if branch(links, b, t.ACTS) != 0.0 and branch(links, b, t.FROM) < v <= branch(links, b, t.TO):
            return b
    return -1


@njit(**INLINE)
def is_curved(links, b):
    """Whether branch b is more than a spring and a dashpot."""
    return branch(links, b, t.CUBIC) != 0.0 or branch(links, b, t.ROOT) != 0.0


@njit(**INLINE)
def stiffness_and_dashpot(links, b, v):
    """Slope [N/m] and dashpot constant [N s/m] of branch b at closing v [m]."""
    if branch(links, b, t.WRITTEN) != 0.0:
        slope = force_and_slope(links, b, v, 1.0, 0.0, 0.0)[1]
        return max(slope, 0.0), max(force_and_slope(links, b, v, 0.0, 0.0, 1.0)[1], 0.0)
    slope = branch(links, b, t.LINEAR)
    dashpot = branch(links, b, t.DASHPOT)
    if is_curved(links, b):
        slope = max(slope + 3.0 * branch(links, b, t.CUBIC) * v * v, 0.0)
        dashpot += branch(links, b, t.ROOT) * math.sqrt(slope)
    return slope, dashpot


@njit(**INLINE)
def held_force(links, b, v, rate):
    """Force of branch b [N], whatever v [m], and whether or not it acts."""
    if branch(links, b, t.WRITTEN) != 0.0:
        return force_and_slope(links, b, v, rate, rate, 0.0)[0]
    elastic = branch(links, b, t.LINEAR) * v + branch(links, b, t.OFFSET)
    if is_curved(links, b):
        elastic += branch(links, b, t.CUBIC) * v**3
    return elastic + stiffness_and_dashpot(links, b, v)[1] * rate


@njit(**INLINE)
def held_force_rate(links, b, v, rate, acceleration):
    """Time derivative of `held_force` [N/s]."""
    if branch(links, b, t.WRITTEN) != 0.0:
        return force_and_slope(links, b, v, rate, rate, acceleration)[1]
    slope, dashpot = stiffness_and_dashpot(links, b, v)
    dashpot_rate = 0.0
    if is_curved(links, b) and slope > 0.0:
        dashpot_rate = branch(links, b, t.ROOT) * 3.0 * branch(links, b, t.CUBIC) * v * rate / math.sqrt(slope)
    return slope * rate + dashpot_rate * rate + dashpot * acceleration


@njit(**INLINE)
def link_force(links, e, v, rate):
    """Force of link e [N] at closing v [m] and its rate [m/s], on whatever branch holds there; 0 when it is open."""
    b = branch_at(links, e, v)
    if b < 0:
        return 0.0
    force = held_force(links, b, v, rate)
    return max(force, 0.0) if branch(links, b, t.CUTS) != 0.0 else force
