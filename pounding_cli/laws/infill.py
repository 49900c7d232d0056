"""Material that fills the gap: soft at first, as stiff as an impact where it is pressed to nothing (paper, eqs 8 and
9); between floors, and between a slab and columns that bend."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields, replace
from enum import StrEnum
from typing import Any

from pounding_cli.laws.guards import HIGH, LOW, SIGN_CHANGE, START
from pounding_cli.laws.law import Behaviour, LinkLaw, in_series, parameter, set_line, set_open
from pounding_cli.laws.pounding import DASHPOT_CITATION, DashpotLaw, reduced_mass

MIN_THICKNESS = 1e-6
"""Least thickness in a study [m]: the cubic (s_imp - s_mat) / (3 d^2) grows without bound."""

NEGLIGIBLE_BENDING = 1e-9
"""Flexibility of a spring in series times the largest stiffness of an infill [-] below which the spring is left out."""

HELD_WIDTH_SHARE = 1e-7
"""Width of the jump of eq. (9) as printed, for floors that pass it slowly, over the thickness [-].

A push between the two forces at the jump holds the floors there. They would swing through it ever faster, an endless
number of times; a spring across this width holds them instead."""

MIN_HELD_WIDTH = 1e-10
"""Least such width [m]."""

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
    e.cubic = e.p[_CUBIC]
    e.root = e.p[_ROOT]


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
    beyond_gap = "crushed"
    behaviour = Behaviour(next_infill_branch)
    scaled_parameters = ("stiffness", "impact_stiffness")

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
        """Return the law in series with a spring; the law itself where that changes no force by a part of
        `NEGLIGIBLE_BENDING`."""
        if flexibility * self.impact_stiffness < NEGLIGIBLE_BENDING:
            return self
        parameters = {each.name: getattr(self, each.name) for each in fields(Infill)}
        return InfillOnColumns(**parameters, flexibility=flexibility)

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


NEGLIGIBLE_TERM = 1e-12
"""Fifth power of the closing in the force of an infill on columns, over its first, up to which the force is that of the
first and third power [-]. So floors in touch at rest have a series, which tells whether they part."""

_PASSES, _FLEXIBILITY, _LIGHTLY, _K_LIGHTLY, _CUBIC_LIGHTLY = range(8, 13)
"""Parameters of an infill on columns beside those of an infill, whose line beyond the thickness is that of the series:
closing v2 [m] beyond which the material is pressed beyond its thickness, behind the jump of the printed law;
flexibility of the columns [m/N]; closing up to which the force is a cubic [m], and its spring [N/m] and cubic [N/m3].
The thickness is the closing v1 at which the material is pressed to its thickness."""

_LIGHT, _CURVED, _JUMP, _PAST = range(1, 5)
"""Branches of an infill on columns; from 5 on without a force."""

_WITHOUT_FORCE_ON_COLUMNS = 4
"""Places from a branch to the same without a force."""


def find_compression(v: float, stiffness: float, cubic: float, flexibility: float) -> float:
    """Return the compression x [m] of a material with the force F = s x + p x^3 in series with a spring.

    It is the one real root of v = x + f F(x). With w^2 = 3 f p / (1 + f s) and x = 2 sinh(t) / w the equation is
    sinh(3 t) = 1.5 w v / (1 + f s).

    Parameters
    ----------
    v : deformation of both [m]
    stiffness, cubic : s [N/m] and p [N/m3] of the material, >= 0
    flexibility : f of the spring [m/N]
    """
    softer = 1.0 + flexibility * stiffness
    scale = math.sqrt(3.0 * flexibility * cubic / softer)
    if scale == 0.0:
        return v / softer
    return 2.0 / scale * math.sinh(math.asinh(1.5 * scale * v / softer) / 3.0)


def series_force(e: Any, v: float, r: float) -> float:
    """Return the force [N] of an infill on columns inside its thickness, with the dashpot of the tangent k_t of both in
    series."""
    x = find_compression(v, e.p[_K], e.p[_CUBIC], e.p[_FLEXIBILITY])
    slope = e.p[_K] + 3.0 * e.p[_CUBIC] * x * x
    tangent = slope / (1.0 + e.p[_FLEXIBILITY] * slope)
    return (e.p[_K] + e.p[_CUBIC] * x * x) * x + e.p[_ROOT] * math.sqrt(tangent) * r


def set_pressed_through(e: Any) -> None:
    """Set the force while the material of the printed law keeps its thickness and columns bend to the force behind its
    jump."""
    stiffness = 1.0 / e.p[_FLEXIBILITY]
    dashpot = e.p[_ROOT] * math.sqrt(stiffness)
    behind = e.p[_K_BEYOND] * e.p[_PASSES] + e.p[_F0_BEYOND]
    set_line(e, stiffness, dashpot, behind - stiffness * e.p[_PASSES], e.p[_THICKNESS], e.p[_PASSES])


def next_branch_on_columns(e: Any, guard: int) -> None:
    """Open, lightly pressed, inside its thickness, at the jump there of the printed law, beyond it; where the tension
    is cut, the last four without a force too."""
    if guard == START or (guard == LOW and e.low == 0.0):
        set_open(e)
        return
    pulls = e.branch > _PAST
    branch = e.branch - _WITHOUT_FORCE_ON_COLUMNS if pulls else e.branch
    has_jump = e.p[_PASSES] > e.p[_THICKNESS]
    if guard == SIGN_CHANGE:
        pulls = not pulls
    elif guard == HIGH:
        branch += 1 if has_jump or branch != _CURVED else 2
    else:
        branch -= 1 if has_jump or branch != _PAST else 2
    if branch == _LIGHT:
        set_line(e, e.p[_K_LIGHTLY], 0.0, 0.0, 0.0, e.p[_LIGHTLY])
        e.cubic = e.p[_CUBIC_LIGHTLY]
        e.root = e.p[_ROOT]
    elif branch == _CURVED:
        set_line(e, 0.0, 0.0, 0.0, e.p[_LIGHTLY], e.p[_THICKNESS])
        e.smooth = 1
    elif branch == _JUMP:
        set_pressed_through(e)
    else:
        set_beyond(e)
        e.low = e.p[_PASSES]
    e.branch = branch + _WITHOUT_FORCE_ON_COLUMNS if pulls else branch
    e.cuts = 1 if e.p[_CUTS] > 0.0 else 0
    e.acts = 0 if pulls else 1


@dataclass(frozen=True)
class InfillOnColumns(Infill):
    """An infill F(x) in series with the bending of columns: v = x + f F(x), with the dashpot 2 xi sqrt(k_t m') v' of
    the tangent k_t of both; `Infill.soften` gives it.

    flexibility : f, deformation of the columns per force [m/N]
    """

    behaviour = Behaviour(next_branch_on_columns, series_force)

    flexibility: float = field(kw_only=True)

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 0.0 < self.flexibility < math.inf:
            raise ValueError(f"link: flexibility is {self.flexibility:g} m/N; it must be finite and above zero")

    @property
    def cubic(self) -> float:
        """p of the material [N/m3]."""
        return (self.impact_stiffness - self.stiffness) / (3 * self.gap**2)

    @property
    def forces_at_thickness(self) -> tuple[float, float]:
        """Forces [N] of the material at its thickness before and behind the jump of the printed law; alike in the
        continuous law."""
        before = self.stiffness * self.gap + self.cubic * self.gap**3
        return before, self.impact_stiffness * self.gap if self.law is InfillLaw.PRINTED else before

    def element_parameters(self, left_mass: float, right_mass: float) -> tuple[float, ...]:
        """As the parameters above."""
        before, behind = self.forces_at_thickness
        reaches = self.gap + self.flexibility * before
        passes = self.gap + self.flexibility * behind
        root = 2 * self.damping_ratio * math.sqrt(self.dashpot.mass(left_mass, right_mass))
        beyond = in_series(self.impact_stiffness, self.flexibility)
        cuts = float(self.cuts_tension)
        line = (beyond, behind - beyond * passes)
        lightly = self._expansion(reaches)
        return self.stiffness, self.cubic, root, *line, reaches, cuts, 0.0, passes, self.flexibility, *lightly

    def _expansion(self, reaches: float) -> tuple[float, float, float]:
        """Return the closing [m] up to which the force is k v + q v^3, k [N/m] and q [N/m3].

        F = (s / a) v + (p / a^4) v^3 - (3 f p^2 / a^7) v^5 + ... with a = 1 + f s

        reaches : closing at which the material is pressed to its thickness [m]
        """
        softer = 1.0 + self.flexibility * self.stiffness
        first = self.stiffness / softer
        third = self.cubic / softer**4
        fifth = 3.0 * self.flexibility * self.cubic**2 / softer**7
        closing = 0.5 * reaches
        if fifth * closing**4 > NEGLIGIBLE_TERM * first:
            closing = (NEGLIGIBLE_TERM * first / fifth) ** 0.25
        return closing, first, third

    def soften(self, flexibility: float) -> InfillOnColumns:
        """Return the law in series with one more spring."""
        return replace(self, flexibility=self.flexibility + flexibility)

    def scale(self, share: float) -> InfillOnColumns:
        """Return the law of a part of the infill, on as much of the columns."""
        part = super().scale(share)
        assert isinstance(part, InfillOnColumns)
        return replace(part, flexibility=self.flexibility / share)

    @property
    def max_slopes(self) -> tuple[float, float]:
        """Beyond its thickness; as printed, at the jump there, where columns alone give way."""
        before, behind = self.forces_at_thickness
        if behind > before:
            stiffness = 1.0 / self.flexibility
        else:
            stiffness = in_series(self.impact_stiffness, self.flexibility)
        return stiffness, 2 * self.damping_ratio * math.sqrt(0.5 * stiffness)

    def stored_energy(self, closing: float, force: float) -> float:
        """The energy in the material and in the columns, f F^2 / 2 [J]."""
        _, _, _, beyond, offset, reaches, _, _, passes, *_ = self.element_parameters(1.0, 1.0)
        closing = max(closing, 0.0)
        if closing <= reaches:
            x = find_compression(closing, self.stiffness, self.cubic, self.flexibility)
            spring_force = self.stiffness * x + self.cubic * x**3
        elif closing < passes:
            x = self.gap
            spring_force = (closing - x) / self.flexibility
        else:
            spring_force = beyond * closing + offset
            x = closing - self.flexibility * spring_force
        inside = min(x, self.gap)
        past = x - inside
        material = 0.5 * self.stiffness * inside**2 + 0.25 * self.cubic * inside**4
        material += (self.forces_at_thickness[1] + 0.5 * self.impact_stiffness * past) * past
        return material + 0.5 * self.flexibility * spring_force**2
