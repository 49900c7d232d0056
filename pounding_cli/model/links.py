"""The laws between two neighbouring floors: pounding, infill, connector (paper, eqs 5-10)."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from enum import StrEnum


class Kind(StrEnum):
    """What stands between two floors."""

    POUNDING = "pounding"
    INFILL = "infill"
    CONNECTOR = "connector"


class InfillLaw(StrEnum):
    """How an infill goes on beyond its thickness: F(d) + s_imp (v - d), or s_imp v as eq. (9) is printed."""

    CONTINUOUS = "continuous"
    PRINTED = "printed"


class DashpotLaw(StrEnum):
    """The mass in eq. (7): m' = m1 m2 / (m1 + m2), or its inverse as eq. (7) is printed (wrong units)."""

    REDUCED_MASS = "reduced-mass"
    PRINTED = "printed"


def damping_ratio(restitution: float) -> float:
    """Damping ratio xi [-] of a dashpot that gives the coefficient of restitution e, 0 < e <= 1.

    xi = -ln e / sqrt(pi^2 + ln^2 e) (Anagnostopoulos 1988).

    Raises
    ------
    ValueError : e outside 0 < e <= 1
    """
    if not 0 < restitution <= 1:
        raise ValueError(f"coefficient of restitution is {restitution:g}; it must be above 0 and at most 1")
    log = math.log(restitution)
    return -log / math.hypot(math.pi, log)  # fault: damping-ratio-of-restitution


@dataclass(frozen=True)
class Link:
    """One link between floor `left_floor` of building `left` and `right_floor` of the building to its right.

    Parameters
    ----------
    left : place of the left building in the group, from 0; the right building is left + 1
    left_floor, right_floor : floors, from 1
    kind : Kind
    gap : initial distance d [m]; 0 allowed for pounding and connector, > 0 for infill; inf for pounding floors that
        never meet (`apart`)
    stiffness : pounding s_imp, infill s_mat, connector s_con [N/m], > 0
    impact_stiffness : s_imp [N/m], what an infill stiffens to at v = d (unused otherwise)
    damping_ratio : xi [-], 0 <= xi < 1
    tension_cut : no force that pulls the floors together (pounding and infill)
    infill_law, dashpot_law : the printed forms of eqs (9) and (7) are selectable by name

    Raises
    ------
    ValueError : a value is outside its range
    """

    left: int
    left_floor: int
    right_floor: int
    kind: Kind
    gap: float
    stiffness: float
    impact_stiffness: float
    damping_ratio: float
    tension_cut: bool = False
    infill_law: InfillLaw = InfillLaw.CONTINUOUS
    dashpot_law: DashpotLaw = DashpotLaw.REDUCED_MASS

    def __post_init__(self) -> None:
        if self.left < 0:
            raise ValueError(f"link: left is {self.left}; places in the group count from 0")
        if self.left_floor < 1 or self.right_floor < 1:
            raise ValueError(f"link: floors {self.left_floor} and {self.right_floor}; floors count from 1")
        if not (self.gap >= 0 and (math.isfinite(self.gap) or self.kind is Kind.POUNDING)):
            raise ValueError(f"link: gap is {self.gap:g} m; it must be finite and not negative")
        if self.kind is Kind.INFILL and self.gap == 0:
            raise ValueError("link: an infill needs a gap above zero to fill; write pounding for a gap of zero")
        names = ("stiffness", "impact_stiffness") if self.kind is Kind.INFILL else ("stiffness",)
        for name in names:
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0):
                raise ValueError(f"link: {name} is {value:g} N/m; it must be finite and above zero")
        if not 0 <= self.damping_ratio < 1:
            raise ValueError(f"link: damping_ratio is {self.damping_ratio:g}; it must be at least 0 and below 1")

    @classmethod
    def apart(cls, left: int, left_floor: int, right_floor: int) -> Link:
        """Nothing between two floors: no force whatever they do; a run finds their largest closing all the same."""
        return cls(left, left_floor, right_floor, Kind.POUNDING, math.inf, 1.0, 1.0, 0.0)

    @property
    def can_close(self) -> bool:
        """Whether a force may ever act."""
        return math.isfinite(self.gap)

    @property
    def words(self) -> str:
        """Every field of the link, in a line: two links with one line act alike."""
        values = (getattr(self, field.name) for field in fields(self))
        return " ".join(repr(value) if isinstance(value, float) else str(value) for value in values)

    def dashpot_mass(self, left_mass: float, right_mass: float) -> float:
        """The mass under the root of eq. (7) [kg]; [1/kg] in the printed form."""
        reduced = left_mass * right_mass / (left_mass + right_mass)  # fault: reduced-mass
        return reduced if self.dashpot_law is DashpotLaw.REDUCED_MASS else 1.0 / reduced  # fault: dashpot-mass

    def dashpot(self, left_mass: float, right_mass: float) -> float:
        """Constant of the dashpot at the link's own stiffness, 2 xi sqrt(s m') [N s/m] (eq. 7)."""
        # fault: dashpot
        return 2 * self.damping_ratio * math.sqrt(self.stiffness * self.dashpot_mass(left_mass, right_mass))
