"""The flat arrays that every kernel works on, and their names.

A *slot* is one translational degree of freedom with the spring below it. A building takes consecutive slots: its base
first, if the foundation sways, then its floors from the ground up; buildings follow one another from left to right and
zeros pad the row to a multiple of eight. `couple` is 1 where the spring's lower end is the slot before, 0 where it is the ground.
Displacements are relative to the ground, so slot i carries D_i = u_i - couple_i u_(i-1) - rise_i phi.
"""

from __future__ import annotations

from collections import namedtuple

OPTIONS = {"cache": True, "error_model": "numpy", "nogil": True, "fastmath": {"contract"}}
"""How every kernel is compiled; only fused multiply-add is allowed beyond IEEE arithmetic."""

INLINE = {**OPTIONS, "forceinline": True}
"""The same for a piece of a kernel that stands in a file of its own."""

ELASTIC, UPWARD, DOWNWARD = 0, 1, -1
"""Storey branches: between the yield lines, on the upper line, on the lower one."""

OPEN, LINEAR, CUBIC = 0, 1, 2
"""Link branches: no contact; F = s v + F0 + c v'; the infill's cubic with its square-root dashpot."""

POUNDING, INFILL, CONNECTOR = 0, 1, 2
"""Link kinds."""

NOTHING, AT_ZERO, AT_GAP, NO_FORCE = 0, 1, 2, 3
"""What is known to be exactly zero after a link event: v, v - d, or the force."""

DONE, EVENT_BOUND, STEP_BOUND, NOT_FINITE, STALLED = 0, 1, 2, 3, 4
"""How a run ended."""

LINKS_NONE, LINKS_LINEAR, LINKS_CUBIC = 0, 1, 2
"""Which link laws a compiled kernel contains."""

Slots = namedtuple(
    "Slots",
    "couple couple_right stiffness dashpot inverse_mass mass alpha real yield_drift hardening rise elevation",
)
"""Per slot, shape (padded,): stiffness [N/m], dashpot [N s/m] (beta k, or the foundation's), inverse_mass [1/kg], mass [kg],
alpha [1/s] (0 over a foundation), real (1, padding 0), yield_drift [m] (inf: never), hardening [-], rise [m] (storey height
where the building rocks, else 0), elevation [m]."""

Feet = namedtuple("Feet", "first stop base inertia stiffness dashpot alpha")
"""Per foundation: its floors' slots [first, stop), the slot of its base (-1: no sway), inertia [kg m2] (inf: no rocking),
rocking stiffness [N m/rad], rocking dashpot [N m s/rad], alpha [1/s]."""

Links = namedtuple(
    "Links",
    "left right kind gap stiffness dashpot beyond beyond_force beyond_dashpot cubic root_dashpot tension_cut",
)
"""Per link: slots left and right, kind, gap d [m], stiffness s [N/m] (infill: s_mat), dashpot [N s/m]; for an infill beyond its
thickness F = beyond v + beyond_force + beyond_dashpot v'; cubic p = (s_imp - s_mat) / (3 d^2) [N/m3];
root_dashpot 2 xi sqrt(m') so that c_cur = root_dashpot sqrt(s_cur); tension_cut 0 or 1."""

State = namedtuple("State", "u v branch plastic snapped_storey link_branch link_cut snapped_link phi phi_v")
"""What evolves: u [m], v [m/s], storey branch, plastic drift [m], storeys exactly on a yield line (+1, -1), link branch,
link cut (1: pulling, so no force), what is exactly zero of a link, rocking angle [rad] and its rate."""

Peaks = namedtuple(
    "Peaks",
    "drift shear acceleration displacement_max displacement_min sway rocking closing force impulse contact_time impacts",
)
"""Largest values so far, per slot, foundation and link (SI)."""
