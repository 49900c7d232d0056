"""The laws of the links as tables: a row for every branch, a row for every guard that ends one.

No kernel knows what kind of link it works on. It knows a link's branch: the coefficients of its force
    F = linear v + cubic v^3 + offset + (dashpot + root sqrt(linear + 3 cubic v^2)) v'
or its operations (`kernels.program`), and the guards at which it ends (`pounding_cli.laws.law`)."""

from __future__ import annotations

from numba import njit

from pounding_cli.kernels.layout import PART

(
    LINEAR, CUBIC, OFFSET, DASHPOT, ROOT, CLOSED, ACTS, CUTS, LOW, HIGH, FROM, TO, FIRST_GUARD, LAST_GUARD, GENERAL,
    WRITTEN, FIRST_STEP, LAST_STEP, REGULAR, FIRST_REGULAR, LAST_REGULAR, STEEPEST, STEEPEST_DASHPOT,
) = range(23)  # fmt: skip
"""The places of a branch in its row: the coefficients [N/m, N/m3, N, N s/m, sqrt(kg)]; whether the force is
followed, acts, and is cut off where it would pull (1 or 0); the closings [m] between which no guard has to be asked,
and those between which the branch holds; its guards, the first and one more than the last; whether program steps
alone can follow it, and whether its force is written as operations alone (1 or 0); the operations of its force, the
first and one more than the last; b of q = v^(1/b) (1: the force needs no q), and the operations in q; stiffness
[N/m] and dashpot [N s/m] where it is stiffest."""

QUANTITY, AT, SIDE, NEXT, IMPACT, ONCE, OF_MEMORY, REMEMBERS = range(8)
"""The places of a guard in its row: what it looks at (below); the value at which it ends the branch [m, m/s]; 1
where it does so below that, -1 above; the branch that follows; whether that is a blow; whether it is asked no more
after `crossings.MAX_EVENTS_AT_INSTANT` events at one instant (1 or 0); how many times what the link remembers is
added to that value; what the link remembers of the event."""

CODE, X, Y, A, B, C = range(6)
"""The places of an operation in its row: `laws.program.Operation`, its registers, its numbers."""

NOTHING, CLOSING, FORCE, RATE, ACCELERATION = range(5)
"""What a guard looks at, and so what is known exactly after its event."""

NO_LINK = 0
"""The branch of places without a link: no force, no guards."""

BRANCH_ROW, GUARD_ROW, OPERATION_ROW = 23, 8, 6
"""Numbers in a row."""


@njit(**PART)
def branch(links, b, field):
    """A number of branch b; `links` is anything with the tables."""
    return links.branches[b * BRANCH_ROW + field]


@njit(**PART)
def guard(links, g, field):
    """A number of guard g."""
    return links.guards[g * GUARD_ROW + field]
