"""The laws of storeys and links as tables: a row for every branch, a row for every guard that ends one.

No kernel knows what kind of storey or link it works on. It knows its branch: the coefficients of the force
    F = linear v + cubic v^3 + offset + (dashpot + root sqrt(linear + 3 cubic v^2)) v'
or its operations (`kernels.program`), and the guards at which it ends (`pounding_cli.laws.law`). Of a storey v is the
drift, and linear and offset may hold a multiple of what it remembers (`storey_law`)."""

from __future__ import annotations

from numba import njit

from pounding_cli.kernels.layout import PART

(
    LINEAR, LINEAR_FACTOR, LINEAR_MEMORY, OFFSET, OFFSET_FACTOR, OFFSET_MEMORY, LOW, LOW_FACTOR, LOW_MEMORY, HIGH,
    HIGH_FACTOR, HIGH_MEMORY, TURNS, CUBIC, DASHPOT, ROOT, CLOSED, ACTS, CUTS, FROM, TO, FIRST_GUARD, LAST_GUARD,
    GENERAL, WRITTEN, FIRST_STEP, LAST_STEP, REGULAR, FIRST_REGULAR, LAST_REGULAR, STEEPEST, STEEPEST_DASHPOT, LOST,
    GIVES_BACK, FIRST_STORED, LAST_STORED, FLOW,
) = range(37)  # fmt: skip
"""The places of a branch in its row: linear [N/m], offset [N], and the closings or drifts [m] between which no guard
has to be asked, each a number, a factor and the memory that it multiplies; of a storey 1 or -1 where it ends as the
drift turns down or up, else 0; cubic, dashpot and root [N/m3, N s/m, sqrt(kg)]; whether the force is followed, acts,
and is cut off where it would pull (1 or 0); the closings [m] between which the branch holds; its guards, the first and
one more than the last; whether program steps alone can follow it, and whether its force is written as operations alone
(1 or 0); the operations of its force, the first and one more than the last; b of q = v^(1/b) (1: the force needs no q),
and the operations in q; stiffness [N/m] and dashpot [N s/m] where it is stiffest. Of a storey: the part of the shear
whose work is lost [N], and the stiffness with which an unloading would give work back [N/m]; 0 where the part that is
lost is the number before, and the energy that the storey holds [J] is made by the operations that follow. The register
that is the rate of the memory, of a storey of its first; 0 where events alone change that."""

QUANTITY, AT, SIDE, NEXT, IMPACT, ONCE, FACTOR, MEMORY, FIRST_SET, FIRST_KEPT, LAST_SET = range(11)
"""The places of a guard in its row: what it looks at (below); the value at which it ends the branch [m, m/s]; 1
where it does so below that, -1 above; the branch that follows; whether that is a blow; whether it is asked no more
after `crossings.MAX_EVENTS_AT_INSTANT` events at one instant (1 or 0); how many times a memory is added to that value,
and which; the operations that make what is remembered of the event: the first, the first that keeps it, and one more
than the last."""

CODE, X, Y, A, B, C = range(6)
"""The places of an operation in its row: `laws.program.Operation`, its registers, its numbers."""

NOTHING, CLOSING, FORCE, RATE, ACCELERATION, FLOWING = range(6)
"""What a guard looks at, and so what is known exactly after its event."""

NO_BRANCH = 0
"""The branch of places without a link, which has no force, and of storeys that stay on their stiffness; no guards."""

BRANCH_ROW, GUARD_ROW, OPERATION_ROW = 37, 11, 6
"""Numbers in a row."""


@njit(**PART)
def branch(links, b, field):
    """A number of branch b; `links` is anything with the tables."""
    return links.branches[b * BRANCH_ROW + field]


@njit(**PART)
def guard(links, g, field):
    """A number of guard g."""
    return links.guards[g * GUARD_ROW + field]
