"""The flat arrays that every kernel works on, and their names.

A *slot* is a degree of freedom, or a point, with the spring below it. Degrees of freedom are the floors, a base that
sways, and the rocking of a base, told by the displacement of the roof that it causes. A *point* is a place of a
building whose motion is a weighted sum of degrees of freedom, and which hands a force on to them by the same weights:
the lower end of a storey that leans with its base, say.

A building takes consecutive slots: rocking and base first, then its floors from the ground up, each with the point
below it if it has one; buildings follow one another from left to right and zeros pad the row to a multiple of eight.
`couple` is 1 where the spring's lower end is the slot before, 0 where it is the ground. Displacements are relative to
the ground, so the spring of slot i carries u_i - couple_i u_(i-1)."""

from __future__ import annotations

from collections import namedtuple
from typing import Any

from numba import njit

from pounding_cli.kernels.kept import FOLDER
from pounding_cli.kernels.pipelines import KERNEL, PIECE
from pounding_cli.kernels.simd import pointer

OPTIONS: dict[str, Any] = {
    "cache": FOLDER is not None, "error_model": "numpy", "nogil": True, "fastmath": {"contract"}, **KERNEL,
}  # fmt: skip
"""How every kernel is compiled; only fused multiply-add is allowed beyond IEEE arithmetic."""

INLINE: dict[str, Any] = {**OPTIONS, "cache": False, "forceinline": True, **PIECE}
"""The same for a piece of a kernel that stands in a file of its own; it is kept as part of the kernel, not by
itself."""

PLAIN: dict[str, Any] = {**OPTIONS, "fastmath": False, "forceinline": False}
"""Without even that: the Taylor kernel fuses where it says so (`simd.fused`), so that one text gives the same bits
wherever it is used. Written out, since what is not said is inherited from whoever calls first."""

PART: dict[str, Any] = {**PLAIN, "cache": False, "forceinline": True, **PIECE}
"""A piece of such a kernel that stands in a file of its own."""

CALLED: dict[str, Any] = {**PLAIN, "cache": False, **PIECE}
"""A piece that is called, not copied: large, and rarely needed (with `simd.no_inline`)."""

DONE, EVENT_BOUND, STEP_BOUND, NOT_FINITE, STALLED, COLLAPSED = 0, 1, 2, 3, 4, 5
"""How a run ended."""

Slots = namedtuple(
    "Slots",
    "size couple couple_right stiffness dashpot inverse_mass mass alpha loaded geometric collapse branch "
    "memories branches guards operations",
)
"""size, the number of slots with padding; per slot, shape (size,): stiffness [N/m], dashpot [N s/m] (beta k, or the
foundation's), inverse_mass [1/kg] and mass [kg] (0 of points and padding), alpha [1/s] (0 over a foundation), loaded
(1 where the ground's acceleration loads it, else 0), geometric (P / h of P-Delta, what it takes from the stiffness
[N/m]), collapse (drift at which a storey counts as collapsed [m], inf where that is not looked for), the first branch
of its law (`law_table.NO_BRANCH` for a storey that stays elastic), and how many memories these laws use; the tables of
branches, guards and operations (`law_table`)."""

Shears = namedtuple("Shears", "number slot storey share first link weight")
"""Shears in columns that slabs strike (`column_shears`): how many; per shear the slot that holds its peak, the slot of
the storey, the columns' part of its shear [-], and, one more, the first of its links; per entry of these the link and
what its force adds, over that force [-]."""

Points = namedtuple("Points", "number size terms slot mass freedom weight handed shears")
"""number of points, the same padded to a multiple of eight, and the most terms that one has; per point its slot and the
mass [kg] that a force on it moves; per term and point, shape (terms, size): the slot of a degree of freedom, its weight
(0: no term) and the acceleration there over that of the mass [-]; `Shears`."""

Springs = namedtuple("Springs", "number size terms stiff stiffness dashpot freedom weight")
"""Springs and dashpots between any degrees of freedom, which no slot carries: numbers as in `Points`, whether one has a
stiffness (1 or 0); per spring stiffness [N/m] and dashpot [N s/m]; per term and spring as in `Points`."""

Links = namedtuple("Links", "number size registers left right offset first last branches guards operations")
"""number of links, the same padded to a multiple of eight, and the most registers that a force written as operations
has; per link, shape (size,): slots left and right; offset,
what its closing v leaves out of u_l - u_r [m]; its branches in the table of them, the first and one more than the last;
the same tables."""

Elements = namedtuple(
    "Elements",
    "number freedoms springs one other weight_one weight_other more first freedom weight stiffness dashpot unknown "
    "inverse_mass drag loaded shears",
)
"""Everything that acts between degrees of freedom, points told by their terms: springs of the slots (as many as slots),
`Springs`, then the links. An element acts on v, the sum of weight x displacement over its terms, and its force goes
back through the same weights.

number of elements; freedoms: as many as slots; springs: elements before the links; by element the freedoms
and weights of its first two terms (weight 0: none); whether some element has more, and then by element, and one more,
the first of the others, and by term its freedom and weight; by element before the links stiffness [N/m] and dashpot
[N s/m]; by freedom its place among those that move (-1: a point or padding), inverse mass [1/kg] (0 likewise), dashpot
to the ground [N s/m], and 1 where the ground's acceleration loads it, else 0; `Shears`."""

Row = namedtuple("Row", "number slots links links_per_side first_slot first_link slot_places link_places")
"""How the Taylor kernel lines the buildings of a scene up, so that each can be run by itself: every building begins at
a multiple of eight *places*, and so do the links between each two (of a few buildings that would take more places so,
one follows the other). number of buildings, slots and links; links_per_side: the most links that a slot has on one
side, or 0 where the links of two neighbours stand like the places they join; by building: the place of its first slot
(and, one more, the number of places), the place of the first link to its right neighbour (the last is the number of
these places); by slot and by link of the arrays: their places."""

State = namedtuple(
    "State",
    "u v storey_branch storey_memory pinned_storey link_branch pinned_link pinned_closing link_memory",
)
"""What evolves: u [m], v [m/s]; per storey: its branch, what its law remembers, shape (MEMORIES, slots), the
guard that it stands at exactly and at rest (0: none); of a link its branch, what
the last event pinned (its closing, or that its force is zero), that closing [m] and what it remembers. Points are
filled in by the Taylor kernel alone."""

Peaks = namedtuple(
    "Peaks",
    "watched drift shear acceleration displacement_max displacement_min "
    "closing force impulse contact_time tangent samples impacts",
)
"""Largest values so far, per slot and link (SI); of the tangent as `tangent.give_tangent` has it, zeros where none is
carried. Where displacements are `watched` (1, else 0), samples are
those at the end of every segment of the ground motion, shape (segments, slots) [m]."""


# The same tuples hold numpy arrays where a kernel is called and pointers to their data inside it.


@njit(**INLINE)
def slot_pointers(a):
    """Slots of pointers from Slots of arrays."""
    return Slots(
        a.size, pointer(a.couple), pointer(a.couple_right), pointer(a.stiffness), pointer(a.dashpot),
        pointer(a.inverse_mass), pointer(a.mass), pointer(a.alpha), pointer(a.loaded), pointer(a.geometric),
        pointer(a.collapse), pointer(a.branch), a.memories, pointer(a.branches), pointer(a.guards),
        pointer(a.operations),
    )  # fmt: skip


@njit(**INLINE)
def shear_pointers(a):
    """Shears of pointers from Shears of arrays."""
    return Shears(
        a.number, pointer(a.slot), pointer(a.storey), pointer(a.share), pointer(a.first), pointer(a.link),
        pointer(a.weight),
    )  # fmt: skip


@njit(**INLINE)
def point_pointers(a):
    """Points of pointers from Points of arrays."""
    return Points(
        a.number, a.size, a.terms, pointer(a.slot), pointer(a.mass), pointer(a.freedom), pointer(a.weight),
        pointer(a.handed), shear_pointers(a.shears),
    )  # fmt: skip


@njit(**INLINE)
def spring_pointers(a):
    """Springs of pointers from Springs of arrays."""
    return Springs(
        a.number, a.size, a.terms, a.stiff, pointer(a.stiffness), pointer(a.dashpot), pointer(a.freedom),
        pointer(a.weight),
    )  # fmt: skip


@njit(**INLINE)
def element_pointers(a):
    """Elements of pointers from Elements of arrays."""
    return Elements(
        a.number, a.freedoms, a.springs, pointer(a.one), pointer(a.other), pointer(a.weight_one),
        pointer(a.weight_other), a.more, pointer(a.first), pointer(a.freedom), pointer(a.weight), pointer(a.stiffness),
        pointer(a.dashpot), pointer(a.unknown), pointer(a.inverse_mass), pointer(a.drag), pointer(a.loaded),
        shear_pointers(a.shears),
    )  # fmt: skip


@njit(**INLINE)
def link_pointers(a):
    """Links of pointers from Links of arrays."""
    return Links(
        a.number, a.size, a.registers, pointer(a.left), pointer(a.right), pointer(a.offset), pointer(a.first),
        pointer(a.last), pointer(a.branches), pointer(a.guards), pointer(a.operations),
    )  # fmt: skip


@njit(**INLINE)
def row_pointers(a):
    """Row of pointers from Row of arrays."""
    return Row(
        a.number, a.slots, a.links, a.links_per_side, pointer(a.first_slot), pointer(a.first_link),
        pointer(a.slot_places), pointer(a.link_places),
    )  # fmt: skip


@njit(**INLINE)
def state_pointers(a):
    """State of pointers from State of arrays."""
    return State(
        pointer(a.u), pointer(a.v), pointer(a.storey_branch), pointer(a.storey_memory), pointer(a.pinned_storey),
        pointer(a.link_branch), pointer(a.pinned_link), pointer(a.pinned_closing), pointer(a.link_memory),
    )  # fmt: skip


@njit(**INLINE)
def peak_pointers(a):
    """Peaks of pointers from Peaks of arrays."""
    return Peaks(
        a.watched, pointer(a.drift), pointer(a.shear), pointer(a.acceleration), pointer(a.displacement_max),
        pointer(a.displacement_min), pointer(a.closing), pointer(a.force), pointer(a.impulse),
        pointer(a.contact_time), pointer(a.tangent), pointer(a.samples), pointer(a.impacts),
    )  # fmt: skip
