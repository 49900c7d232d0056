"""The force of every link, order by order, eight links at a time.

One form serves all branches, its coefficients set place by place when a branch changes (`set_law`):
    F = linear v + cubic v^3 + offset + (dashpot + root sqrt(linear + 3 cubic v^2)) v'.
A cubic with its square-root dashpot (the infill's, eq. 9) needs products of series; where no link is on such a branch,
none of that is done."""

from __future__ import annotations

from numba import njit

from pounding_cli.kernels import cells as c
from pounding_cli.kernels import link_table as t
from pounding_cli.kernels.cells import at_link, at_term, at_tie, of_link, of_term, of_tie
from pounding_cli.kernels.clock import PER_H
from pounding_cli.kernels.layout import CALLED, PART
from pounding_cli.kernels.simd import (
    choose,
    fused,
    gather,
    greater,
    load,
    magnitude,
    maximum,
    splat,
    square_root,
    stand_alone,
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
    b = run.ties[of_tie(e, c.BRANCH)]
    links[of_link(e, c.LINEAR_LAW)] = t.branch(run, b, t.LINEAR)
    links[of_link(e, c.CUBIC_LAW)] = t.branch(run, b, t.CUBIC)
    links[of_link(e, c.OFFSET_LAW)] = t.branch(run, b, t.OFFSET)
    links[of_link(e, c.RATE_LAW)] = t.branch(run, b, t.DASHPOT)
    links[of_link(e, c.ROOT_LAW)] = t.branch(run, b, t.ROOT)
    links[of_link(e, c.APPLIED)] = t.branch(run, b, t.ACTS)
    links[of_link(e, c.CLOSED)] = t.branch(run, b, t.CLOSED)
    links[of_link(e, c.LOW)] = t.branch(run, b, t.LOW)
    links[of_link(e, c.HIGH)] = t.branch(run, b, t.HIGH)


@njit(**PART)
def closed_at(run, b):
    """Lanes whose link, from place b on, is not open."""
    return greater(load(run.links, at_link(b, c.CLOSED)), splat(0.0))


@njit(**PART)
def beside(run, values, row, b, side):
    """The value of the slot on one side (LEFT_SLOT or RIGHT_SLOT) of eight links."""
    place = at_tie(b, side)
    if run.rounds == 0:
        return load(values, row + run.ties[place])
    return gather(values, row, run.ties, place)


@njit(**PART)
def apart(run, values, row, b):
    """Left minus right slot's value, of eight links."""
    return beside(run, values, row, b, c.LEFT_SLOT) - beside(run, values, row, b, c.RIGHT_SLOT)


@njit(**PART)
def link_end(run, b):
    """(u_l - u_r at the step's end, by how much it may stray from the straight line there) of eight links [m]."""
    left = beside(run, run.ends, run.padded, b, c.LEFT_SLOT)
    right = beside(run, run.ends, run.padded, b, c.RIGHT_SLOT)
    return apart(run, run.ends, 0, b), left + right


@njit(**CALLED)
def closings(run, snapped):
    """Order 0 of v, known exactly where an event has just put it there; returns (which of eight links are not open,
    which on a curved branch, whose force is cut off)."""
    stand_alone()
    busy = 0
    curved = 0
    cut = 0
    zero = splat(0.0)
    links = run.links
    start = -run.padded
    for b in range(run.first, run.last, 8):
        left = beside(run, run.W, start, b, c.LEFT_SLOT)
        right = beside(run, run.W, start, b, c.RIGHT_SLOT)
        v = differences(left - load(links, at_link(b, c.LEAVES_OUT)), right, zero)
        closed = closed_at(run, b)
        busy |= closed
        cut |= closed & ~greater(load(links, at_link(b, c.APPLIED)), zero)
        steep = load(links, at_link(b, c.ROOT_LAW)) + magnitude(load(links, at_link(b, c.CUBIC_LAW)))
        curved |= greater(steep, zero)
        store(links, at_link(b, c.CLOSING), v)
        store(run.series, at_term(run, 0, b, c.V_TERM), choose(closed, v, zero))
        store(links, at_link(b, c.SIZE), maximum(magnitude(left), magnitude(right)) * run.clock[PER_H])
        store(run.pushed, b, zero)
    if snapped:
        for e in range(run.first, run.last):
            if run.ties[of_tie(e, c.SNAPPED)] == t.CLOSING:
                v_exact = links[of_link(e, c.EXACTLY)]
                links[of_link(e, c.CLOSING)] = v_exact
                run.series[of_term(run, 0, e, c.V_TERM)] = v_exact * links[of_link(e, c.CLOSED)]
    return busy, curved, cut


@njit(**PART)
def expand_links(run, k, after, curved, snapped):
    """Order k of every link's force, kept in the series [N], and in `pushed` where the link pushes or holds.

    `after` is h / (k + 1); `snapped`: something may be exactly zero at the step's start, and what is rounding of it
    must not decide its sign. What waits for order k of the floors' velocities comes last: all else is computed while
    they are."""
    row = k * run.padded
    for b in range(run.first, run.last, 8):
        if closed_at(run, b) != 0:
            v = load(run.series, at_term(run, k, b, c.V_TERM))
            store(run.pushed, b, push(run, k, b, v, apart(run, run.W, row, b), after, curved, snapped)[0])


@njit(**PART)
def push(run, k, b, v, rate, after, curved, snapped):
    """Order k of the force of eight links, as the series keep it and as it acts, from those of the closing v and of the
    floors' difference in velocity; returns (what acts [N], order k + 1 of v)."""
    links = run.links
    series = run.series
    here = at_term(run, k, b, 0)
    known = load(links, at_link(b, c.LINEAR_LAW)) * v
    if k == 0:
        known = known + load(links, at_link(b, c.OFFSET_LAW))
        store(links, at_link(b, c.DAMPING), load(links, at_link(b, c.RATE_LAW)))
    if curved != 0:
        known = _cubic(run, k, b, v, known)
    damping = load(links, at_link(b, c.DAMPING))
    applied = load(links, at_link(b, c.APPLIED))
    known_applied = known * applied
    damping_applied = damping * applied
    rate = rate * load(links, at_link(b, c.CLOSED))
    if snapped:
        rate = _exact_rate(run, k * run.padded, b, rate)
    force = fused(damping, rate, known)
    v_next = rate * after
    store(series, here + c.RATE_TERM, rate)
    store(series, here + c.F_TERM, force)
    store(series, at_term(run, k + 1, b, c.V_TERM), v_next)
    return fused(damping_applied, rate, known_applied), v_next


@njit(**PART)
def _exact_rate(run, row, b, rate):
    """`rate` of eight links, exactly zero where it is rounding (`difference`)."""
    left = magnitude(beside(run, run.W, row, b, c.LEFT_SLOT))
    right = magnitude(beside(run, run.W, row, b, c.RIGHT_SLOT))
    size = load(run.links, at_link(b, c.SIZE))
    store(run.links, at_link(b, c.SIZE), maximum(size, maximum(left, right)))
    rounding = ROUNDING * (left + right) + LAST_DIGITS * size
    return choose(greater(magnitude(rate), rounding), rate, splat(0.0))


@njit(**PART)
def _cubic(run, k, b, v, known):
    """What a cubic and its dashpot add to order k of the force, but for the newest rate: at k = 0 the
    dashpot that multiplies that is set."""
    links = run.links
    series = run.series
    cubic = load(links, at_link(b, c.CUBIC_LAW))
    drop = load(links, at_link(b, c.ROOT_LAW))
    first = at_term(run, 0, b, 0)
    here = at_term(run, k, b, 0)
    drag = splat(0.0)
    if k == 0:
        square = v * v
        third = square * v
        slope = fused(3.0 * cubic, square, load(links, at_link(b, c.LINEAR_LAW)))
        root = square_root(maximum(slope, splat(1e-200)))  # an open link's slope is 0
        store(links, at_link(b, c.HALF), 0.5 / root)
        store(links, at_link(b, c.DAMPING), fused(drop, root, load(links, at_link(b, c.DAMPING))))
    else:
        v_first = load(series, first + c.V_TERM)
        square = v * v_first
        third = load(series, first + c.SQUARE_TERM) * v
        square = fused(v, v_first, square)
        roots = splat(0.0)
        for i in range(1, k):
            one = at_term(run, i, b, 0)
            other = at_term(run, k - i, b, 0)
            v_other = load(series, other + c.V_TERM)
            root_i = load(series, one + c.ROOT_TERM)
            square = fused(load(series, one + c.V_TERM), v_other, square)
            third = fused(load(series, one + c.SQUARE_TERM), v_other, third)
            drag = fused(root_i, load(series, other + c.RATE_TERM), drag)
            roots = fused(root_i, load(series, other + c.ROOT_TERM), roots)
        third = fused(square, v_first, third)
        root = (3.0 * cubic * square - roots) * load(links, at_link(b, c.HALF))  # fault: infill-slope-of-root
        drag = fused(root, load(series, first + c.RATE_TERM), drag)
    store(series, here + c.SQUARE_TERM, square)
    store(series, here + c.ROOT_TERM, root)
    return fused(drop, drag, fused(cubic, third, known))


@njit(**PART)
def forces_on(run, b):
    """What links do to the slots from place b on [N]."""
    if run.rounds == 0:
        return load(run.pushed, run.gains[b]) - load(run.pushed, run.losses[b])
    total = splat(0.0)
    for row in range(0, run.rounds * run.padded, run.padded):
        gain = gather(run.pushed, 0, run.gains, row + b)
        total = total + gain - gather(run.pushed, 0, run.losses, row + b)  # fault: link-pushes-floors
    return total
