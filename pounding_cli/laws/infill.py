"""Material that fills the gap: soft at first, as stiff as an impact where it is pressed to nothing (paper, eqs 8 and
9)."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any

from pounding_cli.laws.guards import HIGH, LOW, SIGN_CHANGE, START
from pounding_cli.laws.law import Behaviour, LinkLaw, in_series, parameter, set_line, set_open
from pounding_cli.laws.pounding import DASHPOT_CITATION, DashpotLaw, reduced_mass

MIN_THICKNESS = 1e-6
"""Least thickness in a study [m]: the cubic (s_imp - s_mat) / (3 d^2) grows without bound."""

HELD_WIDTH_SHARE = 1e-7
MIN_HELD_WIDTH = 1e-10
"""Width of the jump of eq. (9) as printed, for floors that pass it slowly: part of the thickness, and at least [m].

A push between the two forces at the jump holds the floors there. They would swing through it ever faster, an endless
number of times; a spring across this width holds them instead."""

_K, _CUBIC, _ROOT, _K_BEYOND, _F0_BEYOND, _THICKNESS, _CUTS, _HELD_RATE = range(8)
"""Parameters: spring [N/m], cubic [N/m3] and dashpot over sqrt(stiffness) [sqrt(kg)] of the material; spring [N/m] and
force at v = 0 [N] of the line beyond its thickness [m]; 1 where no force pulls; rate [m/s] below which floors at the
jump are held."""

_OPEN, _INSIDE, _HELD, _BEYOND = range(4)
"""Branches; the last three from 4 on without a force."""

_WITHOUT_FORCE = 3
"""Places from a branch to the same without a force."""


def width_of_jump(thickness: float) -> float:
    """Return the width of the jump of eq. (9) as printed, where it is passed slowly [m]."""
    return max(HELD_WIDTH_SHARE * thickness, MIN_HELD_WIDTH)


def set_inside(e: Any) -> None:
    """Set the force inside the thickness."""
    set_line(e, e.p[_K], 0.0, 0.0, 0.0, e.p[_THICKNESS])
    e.cubic, e.root = e.p[_CUBIC], e.p[_ROOT]


def set_beyond(e: Any) -> None:
    """Set the force beyond the thickness."""
    dashpot = e.p[_ROOT] * math.sqrt(e.p[_K_BEYOND])
    set_line(e, e.p[_K_BEYOND], dashpot, e.p[_F0_BEYOND], e.p[_THICKNESS], math.inf)


def set_held(e: Any) -> None:
    """Set a spring from the force before the jump to that behind it, across the width of the jump."""
    thickness = e.p[_THICKNESS]
    width = width_of_jump(thickness)
    before = e.p[_K] * thickness + e.p[_CUBIC] * thickness**3
    behind = e.p[_K_BEYOND] * thickness + e.p[_F0_BEYOND]
    spring = (behind - before) / width
    force_at_zero = 0.5 * (before + behind) - spring * thickness
    dashpot = e.p[_ROOT] * math.sqrt(e.p[_K_BEYOND])
    set_line(e, spring, dashpot, force_at_zero, thickness - 0.5 * width, thickness + 0.5 * width)


def next_infill_branch(e: Any, guard: int) -> None:
    """Open, inside its thickness, held at a jump there, beyond it; where the tension is cut, the last three without a
    force too."""
    if guard == START or (guard == LOW and e.low == 0.0):
        set_open(e)
        return
    pulls = e.branch > _BEYOND
    branch = e.branch - _WITHOUT_FORCE if pulls else e.branch
    if guard == SIGN_CHANGE:
        pulls = not pulls
    elif branch == _OPEN:
        branch = _INSIDE
    elif branch == _HELD:
        branch = _BEYOND if guard == HIGH else _INSIDE
    elif abs(e.r1) < e.p[_HELD_RATE]:
        branch = _HELD
    else:
        branch = _BEYOND if guard == HIGH else _INSIDE
    if branch == _INSIDE:
        set_inside(e)
    elif branch == _HELD:
        set_held(e)
    else:
        set_beyond(e)
    e.branch = branch + _WITHOUT_FORCE if pulls else branch
    e.cuts = 1 if e.p[_CUTS] > 0.0 else 0
    e.acts = 0 if pulls else 1


class InfillLaw(StrEnum):
    """Force of an infill beyond its thickness: F(d) + s_imp (v - d), or s_imp v as eq. (9) is printed."""

    CONTINUOUS = "continuous"
    PRINTED = "printed"


@dataclass(frozen=True)
class Infill(LinkLaw):
    """F = p v^3 + s_mat v + c_cur v' for 0 < v <= d with p = (s_imp - s_mat) / (3 d^2) and c_cur = 2 xi sqrt(s_cur m'),
    s_cur = s_mat + 3 p v^2; beyond d as stiff as an impact (paper, after eq. 9).
    """

    name = "infill"
    example = "{link: infill, gap: 5 cm, stiffness: 1/5 mean storey}"
    citation = (
        ("spiliopoulos1996", "infill material, eqs (8) and (9)"),
        ("anagnostopoulos1992", "the viscoelastic impact element"),
        DASHPOT_CITATION,
    )
    symbol = "filling"
    stiffness_default = "0.2 x mean storey"
    beyond_gap = "infill compressed beyond its thickness"
    behaviour = Behaviour(next_infill_branch)

    stiffness: float = parameter("spring of the material s_mat where it is not pressed", "N/m", open_low=True)
    impact_stiffness: float = parameter("what it stiffens to at v = d, s_imp", "N/m", open_low=True)
    damping_ratio: float = parameter("damping ratio xi of the dashpot", high=1.0)
    tension_cut: bool = parameter("no force that pulls the floors together", default=False)
    law: InfillLaw = parameter(
        "beyond its thickness: continuous, or eq. (9) as printed, which jumps", default=InfillLaw.CONTINUOUS
    )
    dashpot: DashpotLaw = parameter("mass in eq. (7)", default=DashpotLaw.REDUCED_MASS)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.gap == 0:
            raise ValueError("link: an infill needs a gap above zero to fill; write pounding for a gap of zero")

    @classmethod
    def find_conflict(cls, **values: float) -> tuple[str, str, str] | None:
        """Too thin, or softer when it is pressed."""
        gap, stiffness, impact = (values.get(name, math.nan) for name in ("gap", "stiffness", "impact_stiffness"))
        if gap < MIN_THICKNESS:
            wrong = f"an infill {gap:g} m thick is thinner than the least thickness, {MIN_THICKNESS:g} m"
            return (
                "gap",
                wrong,
                f"write `link: pounding` for buildings in touch, or a gap of {MIN_THICKNESS:g} m or more",
            )
        if stiffness > impact:
            wrong = f"the infill's stiffness {stiffness:.3g} N/m is above the impact stiffness {impact:.3g} N/m"
            hint = "an infill stiffens to impact.stiffness (paper, Fig. 3): lower the one or raise the other"
            return "stiffness", wrong, hint
        return None

    def element_parameters(self, left_mass: float, right_mass: float) -> tuple[float, ...]:
        """As the parameters above."""
        d = self.gap
        cubic = (self.impact_stiffness - self.stiffness) / (3 * d**2)
        root = 2 * self.damping_ratio * math.sqrt(self.dashpot.mass(left_mass, right_mass))
        jump = self.impact_stiffness * d - (cubic * d**3 + self.stiffness * d)
        offset = held_rate = 0.0
        if self.law is InfillLaw.CONTINUOUS:  # F(d) + s_imp (v - d)
            offset = -jump
        else:  # at which floors swing through half the width of the jump
            held_rate = math.sqrt(0.5 * jump * width_of_jump(d) / reduced_mass(left_mass, right_mass))
        return self.stiffness, cubic, root, self.impact_stiffness, offset, d, float(self.cuts_tension), held_rate

    def soften(self, flexibility: float) -> Infill:
        """Return the law with both of its springs in series with another.

        It is exact where it is hardly pressed, and in its slope beyond its thickness; docs/theory.md has the error
        between.
        """
        stiffness = in_series(self.stiffness, flexibility)
        return replace(self, stiffness=stiffness, impact_stiffness=in_series(self.impact_stiffness, flexibility))

    @property
    def max_slopes(self) -> tuple[float, float]:
        """Beyond its thickness."""
        return self.impact_stiffness, 2 * self.damping_ratio * math.sqrt(0.5 * self.impact_stiffness)

    def stored_energy(self, closing: float, force: float) -> float:
        """Its elastic force integrated from zero [J]."""
        k, cubic, _, impact, offset, d, *_ = self.element_parameters(1.0, 1.0)
        inside = min(max(closing, 0.0), d)
        beyond = max(closing - d, 0.0)
        energy = 0.5 * k * inside**2 + 0.25 * cubic * inside**4
        return energy + (impact * d + offset) * beyond + 0.5 * impact * beyond**2
