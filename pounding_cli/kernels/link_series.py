"""The force of every link, order by order, eight links at a time.

One form serves all branches, its coefficients set place by place when a branch changes (`set_law`):
    F = linear v + cubic v^3 + offset + (dashpot + root sqrt(linear + 3 cubic v^2)) v'.
A cubic with its square-root dashpot (the infill's, eq. 9) needs products of series; where no link is on such a branch,
none of that is done."""

from __future__ import annotations

from numba import njit

from pounding_cli.kernels import cells as c
from pounding_cli.kernels import law_table as t
from pounding_cli.kernels.cells import at_link, at_link_integer, at_term, of_link, of_link_integer, of_term
from pounding_cli.kernels.clock import INVERSE_H
from pounding_cli.kernels.layout import CALLED, PART
from pounding_cli.kernels.simd import (
    choose,
    fused,
    gather,
    greater,
    load,
    magnitude,
    maximum,
    no_inline,
    splat,
    square_root,
    store,
)

ROUNDING = 1e-13
"""Two floors' displacements, or terms of their series, that differ by less than this part of them do not differ: the
series themselves carry errors of this size where the storeys' shears cancel."""

LAST_DIGITS = 1e-15
"""Nor do they where they differ by less than this part of the largest term so far: what is exactly zero comes out as
that."""


@njit(**PART)
def difference(a, b, size):
    """a - b, or exactly 0 where what is left is rounding: floors that move alike do not touch by their last digits.

    `size` is the largest of the terms before them.
    """
    left = a - b
    return left if abs(left) > ROUNDING * (abs(a) + abs(b)) + LAST_DIGITS * size else 0.0


@njit(**PART)
def differences(a, b, size):
    """The same for eight pairs."""
    left = a - b
    rounding = ROUNDING * (magnitude(a) + magnitude(b)) + LAST_DIGITS * size
    return choose(greater(magnitude(left), rounding), left, splat(0.0))


@njit(**PART)
def set_law(run, e):
    """The law of link e's present branch, and the closings between which no guard has to be asked."""
    links = run.links
    b = run.link_integers[of_link_integer(e, c.BRANCH)]
    links[of_link(e, c.LAW_LINEAR)] = t.branch(run, b, t.LINEAR)
    links[of_link(e, c.LAW_CUBIC)] = t.branch(run, b, t.CUBIC)
    links[of_link(e, c.LAW_OFFSET)] = t.branch(run, b, t.OFFSET)
    links[of_link(e, c.LAW_DASHPOT)] = t.branch(run, b, t.DASHPOT)
    links[of_link(e, c.LAW_ROOT)] = t.branch(run, b, t.ROOT)
    links[of_link(e, c.ACTS)] = t.branch(run, b, t.ACTS)
    links[of_link(e, c.CLOSED)] = t.branch(run, b, t.CLOSED)
    links[of_link(e, c.LOW)] = t.branch(run, b, t.LOW)
    links[of_link(e, c.HIGH)] = t.branch(run, b, t.HIGH)


@njit(**PART)
def closed_lanes(run, b):
    """Lanes whose link, from place b on, is not open."""
    return greater(load(run.links, at_link(b, c.CLOSED)), splat(0.0))


@njit(**PART)
def side_values(run, values, row, b, side):
    """The value of the slot on one side (LEFT_SLOT or RIGHT_SLOT) of eight links."""
    place = at_link_integer(b, side)
    if run.links_per_side == 0:
        return load(values, row + run.link_integers[place])
    return gather(values, row, run.link_integers, place)


@njit(**PART)
def left_minus_right(run, values, row, b):
    """Left minus right slot's value, of eight links."""
    return side_values(run, values, row, b, c.LEFT_SLOT) - side_values(run, values, row, b, c.RIGHT_SLOT)


@njit(**PART)
def closing_at_end(run, b):
    """(u_l - u_r at the step's end, its chord deviation) of eight links [m]."""
    left = side_values(run, run.ends, run.padded, b, c.LEFT_SLOT)
    right = side_values(run, run.ends, run.padded, b, c.RIGHT_SLOT)
    return left_minus_right(run, run.ends, 0, b), left + right


@njit(**CALLED)
def start_closings(run, pinned_at_event):
    """Order 0 of the closing v, exact where an event has just pinned it; returns (lanes with some link that is closed,
    on a curved branch, with a force that is cut off)."""
    no_inline()
    any_closed = 0
    curved = 0
    cut = 0
    zero = splat(0.0)
    links = run.links
    start = -run.padded
    for b in range(run.link_start, run.link_stop, 8):
        left = side_values(run, run.W, start, b, c.LEFT_SLOT)
        right = side_values(run, run.W, start, b, c.RIGHT_SLOT)
        v = differences(left - load(links, at_link(b, c.LINK_OFFSET)), right, zero)
        closed = closed_lanes(run, b)
        any_closed |= closed
        cut |= closed & ~greater(load(links, at_link(b, c.ACTS)), zero)
        steep = load(links, at_link(b, c.LAW_ROOT)) + magnitude(load(links, at_link(b, c.LAW_CUBIC)))
        curved |= greater(steep, zero)
        store(links, at_link(b, c.CLOSING), v)
        store(run.series, at_term(run, 0, b, c.CLOSING_TERM), choose(closed, v, zero))
        store(links, at_link(b, c.LARGEST_TERM), maximum(magnitude(left), magnitude(right)) * run.clock[INVERSE_H])
        store(run.link_forces, b, zero)
    if pinned_at_event:
        for e in range(run.link_start, run.link_stop):
            if run.link_integers[of_link_integer(e, c.PINNED_AT_EVENT)] == t.CLOSING:
                v_exact = links[of_link(e, c.PINNED_CLOSING)]
                links[of_link(e, c.CLOSING)] = v_exact
                run.series[of_term(run, 0, e, c.CLOSING_TERM)] = v_exact * links[of_link(e, c.CLOSED)]
    return any_closed, curved, cut


@njit(**PART)
def expand_links(run, k, after, curved, pinned_at_event):
    """Order k of every link's force, kept in the series [N], and in `pushed` where the link pushes or holds.

    `after` is h / (k + 1); `pinned_at_event`: an event has put something exactly at zero, and rounding must not decide
    its sign. What needs order k of the floors' velocities comes last: all else is computed while they are."""
    row = k * run.padded
    for b in range(run.link_start, run.link_stop, 8):
        if closed_lanes(run, b) != 0:
            v = load(run.series, at_term(run, k, b, c.CLOSING_TERM))
            rate = left_minus_right(run, run.W, row, b)
            store(run.link_forces, b, link_force_terms(run, k, b, v, rate, after, curved, pinned_at_event)[0])


@njit(**PART)
def link_force_terms(run, k, b, v, rate, after, curved, pinned_at_event):
    """Order k of the force of eight links, as the series keep it and as it acts, from those of the closing v and of the
    floors' difference in velocity; returns (what acts [N], order k + 1 of v)."""
    links = run.links
    series = run.series
    here = at_term(run, k, b, 0)
    known = load(links, at_link(b, c.LAW_LINEAR)) * v
    if k == 0:
        known = known + load(links, at_link(b, c.LAW_OFFSET))
        store(links, at_link(b, c.DASHPOT_NOW), load(links, at_link(b, c.LAW_DASHPOT)))
    if curved != 0:
        known = _cubic(run, k, b, v, known)
    damping = load(links, at_link(b, c.DASHPOT_NOW))
    applied = load(links, at_link(b, c.ACTS))
    known_applied = known * applied
    damping_applied = damping * applied
    rate = rate * load(links, at_link(b, c.CLOSED))
    if pinned_at_event:
        rate = _exact_rate(run, k * run.padded, b, rate)
    force = fused(damping, rate, known)
    v_next = rate * after
    store(series, here + c.RATE_TERM, rate)
    store(series, here + c.FORCE_TERM, force)
    store(series, at_term(run, k + 1, b, c.CLOSING_TERM), v_next)
    return fused(damping_applied, rate, known_applied), v_next


@njit(**PART)
def _exact_rate(run, row, b, rate):
    """`rate` of eight links, exactly zero where it is rounding (`difference`)."""
    left = magnitude(side_values(run, run.W, row, b, c.LEFT_SLOT))
    right = magnitude(side_values(run, run.W, row, b, c.RIGHT_SLOT))
    size = load(run.links, at_link(b, c.LARGEST_TERM))
    store(run.links, at_link(b, c.LARGEST_TERM), maximum(size, maximum(left, right)))
    rounding = ROUNDING * (left + right) + LAST_DIGITS * size
    return choose(greater(magnitude(rate), rounding), rate, splat(0.0))


@njit(**PART)
def _cubic(run, k, b, v, known):
    """What a cubic and its dashpot add to order k of the force, but for the newest rate: at k = 0 the
    dashpot that multiplies that is set."""
    links = run.links
    series = run.series
    cubic = load(links, at_link(b, c.LAW_CUBIC))
    drop = load(links, at_link(b, c.LAW_ROOT))
    first = at_term(run, 0, b, 0)
    here = at_term(run, k, b, 0)
    drag = splat(0.0)
    if k == 0:
        square = v * v
        third = square * v
        slope = fused(3.0 * cubic, square, load(links, at_link(b, c.LAW_LINEAR)))
        root = square_root(maximum(slope, splat(1e-200)))  # an open link's slope is 0
        store(links, at_link(b, c.HALF_INVERSE_ROOT), 0.5 / root)
        store(links, at_link(b, c.DASHPOT_NOW), fused(drop, root, load(links, at_link(b, c.DASHPOT_NOW))))
    else:
        v_first = load(series, first + c.CLOSING_TERM)
        square = v * v_first
        third = load(series, first + c.SQUARE_TERM) * v
        square = fused(v, v_first, square)
        roots = splat(0.0)
        for i in range(1, k):
            one = at_term(run, i, b, 0)
            other = at_term(run, k - i, b, 0)
            v_other = load(series, other + c.CLOSING_TERM)
            root_i = load(series, one + c.ROOT_TERM)
            square = fused(load(series, one + c.CLOSING_TERM), v_other, square)
            third = fused(load(series, one + c.SQUARE_TERM), v_other, third)
            drag = fused(root_i, load(series, other + c.RATE_TERM), drag)
            roots = fused(root_i, load(series, other + c.ROOT_TERM), roots)
        third = fused(square, v_first, third)
        half = load(links, at_link(b, c.HALF_INVERSE_ROOT))
        root = (3.0 * cubic * square - roots) * half
        drag = fused(root, load(series, first + c.RATE_TERM), drag)
    store(series, here + c.SQUARE_TERM, square)
    store(series, here + c.ROOT_TERM, root)
    return fused(drop, drag, fused(cubic, third, known))


@njit(**PART)
def link_forces_on(run, b):
    """What links do to the slots from place b on [N]."""
    if run.links_per_side == 0:
        return load(run.link_forces, run.left_links[b]) - load(run.link_forces, run.right_links[b])
    total = splat(0.0)
    for row in range(0, run.links_per_side * run.padded, run.padded):
        gain = gather(run.link_forces, 0, run.left_links, row + b)
        total = total + gain - gather(run.link_forces, 0, run.right_links, row + b)
    return total
