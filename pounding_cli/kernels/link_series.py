"""The force of every link, order by order, eight links at a time.

One law serves all branches, its coefficients set lane by lane when a branch changes (`set_law`; a sixth row tells
whether the force is applied):
    F = linear v + cubic v^3 + offset + (dashpot + root sqrt(linear + 3 cubic v^2)) v'.
The infill's cubic with its square-root dashpot (eq. 9) needs products of series; a scene without infill has none of
that."""

from __future__ import annotations

from numba import njit

from pounding_cli.kernels.layout import AT_GAP, AT_ZERO, CUBIC, INFILL, INLINE, LINKS_CUBIC, OPEN, POUNDING
from pounding_cli.kernels.simd import load, maximum, splat, square_root, store

ROUNDING = 1e-13
"""Two floors' displacements, or terms of their series, that differ by less than this part of them do not differ: the
series themselves carry errors of this size where the storeys' shears cancel."""

LAST_DIGITS = 1e-15
"""Nor do they where they differ by less than this part of the largest term so far: what is exactly zero comes out as
that."""


@njit(**INLINE)
def difference(a, b, size):
    """a - b, or exactly 0 where what is left is rounding: floors that move alike do not touch by their last digits.

    `size` is the largest of the terms before them.
    """
    left = a - b
    return left if abs(left) > ROUNDING * (abs(a) + abs(b)) + LAST_DIGITS * size else 0.0


@njit(**INLINE)
def set_law(links, state, law, e):
    """Coefficients of link e's present branch; zero while it is open."""
    count = links.size
    branch = state.link_branch[e]
    for row in range(5):
        law[row * count + e] = 0.0
    law[5 * count + e] = 0.0 if branch == OPEN or state.link_cut[e] == 1 else 1.0
    if branch == CUBIC:
        law[e] = links.stiffness[e]
        law[count + e] = links.cubic[e]
        law[4 * count + e] = links.root_dashpot[e]
    elif branch != OPEN and links.kind[e] == INFILL:
        law[e] = links.beyond[e]
        law[2 * count + e] = links.beyond_force[e]
        law[3 * count + e] = links.beyond_dashpot[e]
    elif branch != OPEN:
        law[e] = links.stiffness[e]
        law[3 * count + e] = links.dashpot[e]


@njit(**INLINE)
def closings(links, state, work):
    """Order 0 of v, exactly zero (or d) where an event has just put it there; returns the number of links not open."""
    busy = 0
    for e in range(links.number):
        v = 0.0
        if state.link_branch[e] != OPEN:
            busy += 1
            snapped = state.snapped_link[e]
            if snapped == AT_GAP:
                v = links.gap[e]
            elif snapped != AT_ZERO:
                thickness = links.gap[e] if links.kind[e] == POUNDING else 0.0
                v = difference(state.u[links.left[e]] - thickness, state.u[links.right[e]], 0.0)
        work.V[e] = v
        work.sizes[e] = max(abs(state.u[links.left[e]]), abs(state.u[links.right[e]]))
    return busy


@njit(**INLINE)
def add_forces(links, state, work, k, padded, h, kinds):
    """Order k of every link's force, kept in `work.F` (times h^2) and added to `work.force` where the link pushes or
    holds."""
    count = links.size
    row = k * padded
    here = k * count
    for e in range(links.number):
        rate = 0.0
        if state.link_branch[e] != OPEN:
            left = work.W[row + links.left[e]]
            right = work.W[row + links.right[e]]
            rate = difference(left, right, work.sizes[e])
            work.sizes[e] = max(work.sizes[e], abs(left), abs(right))
        work.rates[here + e] = rate
    h2 = h * h
    law = work.law
    for b in range(0, count, 8):
        rate = load(work.rates, here + b)
        v = load(work.V, here + b)
        store(work.V, here + count + b, rate * work.reciprocal[k + 1])
        force = load(law, b) * v * h2 + load(law, 3 * count + b) * rate * h
        if k == 0:
            force = force + load(law, 2 * count + b) * h2
        if kinds == LINKS_CUBIC:
            cubic = load(law, count + b)
            if k == 0:
                square = v * v
                third = square * v
                slope = load(law, b) + 3.0 * cubic * square
                root = square_root(maximum(slope, splat(1e-200)))  # an open link's slope is 0
                store(work.half, b, 0.5 / root)
                drag = root * rate
            else:
                square = splat(0.0)
                third = splat(0.0)
                roots = splat(0.0)
                drag = splat(0.0)
                for i in range(k):  # the four products' terms that need nothing of order k but v
                    other = (k - i) * count + b
                    v_i = load(work.V, i * count + b)
                    root_i = load(work.root, i * count + b)
                    square = square + v_i * load(work.V, other)
                    third = third + load(work.square, i * count + b) * load(work.V, other)
                    drag = drag + root_i * load(work.rates, other)
                    if i > 0:
                        roots = roots + root_i * load(work.root, other)
                square = square + v * load(work.V, b)
                third = third + square * load(work.V, b)
                root = (3.0 * cubic * square - roots) * load(work.half, b)
                drag = drag + root * load(work.rates, b)
            store(work.square, here + b, square)
            store(work.root, here + b, root)
            force = force + cubic * third * h2 + load(law, 4 * count + b) * drag * h
        store(work.F, here + b, force)
    for e in range(links.number):
        if state.link_branch[e] != OPEN and state.link_cut[e] == 0:
            force = work.F[here + e]
            work.force[links.left[e]] -= force
            work.force[links.right[e]] += force
