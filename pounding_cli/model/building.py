"""A shear building on a fixed base or on a foundation: what the equations of motion need and no more."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass, field, fields
from functools import cached_property
from typing import ClassVar

import numpy as np

from pounding_cli.laws.bilinear import Bilinear
from pounding_cli.laws.foundation import Bearings, FrictionPendulum, Rocking, Rubber, Sway
from pounding_cli.laws.slider import Slider
from pounding_cli.laws.storey import StoreyLaw
from pounding_cli.model.plan import FloorPlan, FrameLine
from pounding_cli.numbers import pluralize
from pounding_cli.units import GRAVITY

NO_RESISTANCE = 1e-12
"""Part of the product of the stiffnesses in drift and twist [-] below which their determinant is rounding."""

DEFAULT_COLLAPSE_RATIO = 0.10
"""Drift over storey height at which a storey counts as collapsed, where a building does not say it [-]."""


class UnstableError(ValueError):
    """A building that its own weight overturns from rest."""


def weight_above(mass: np.ndarray) -> np.ndarray:
    """Weight [N] of the floors that every storey carries, from the floor masses [kg], shape (n,)."""
    return GRAVITY * np.cumsum(mass[::-1])[::-1]


@dataclass(frozen=True)
class Foundation:
    """Sway and rocking of the base; without `sways` it does not translate, without `rocks` it does not turn.

    Parameters
    ----------
    mass : [kg], > 0 where the base sways
    sway_stiffness : [N/m], > 0 where the base sways
    sway_damping : [N s/m], >= 0
    inertia : rotary inertia of the foundation alone [kg m2], > 0 where the base rocks
    rocking_stiffness : [N m/rad], > 0 where the base rocks
    rocking_damping : [N m s/rad], >= 0
    isolation : isolators under the base, in place of the spring of its sway; they act in elastic analyses too

    Raises
    ------
    ValueError : a value is outside its range
    """

    mass: float = 0.0
    sway_stiffness: float = 0.0
    sway_damping: float = 0.0
    inertia: float = 0.0
    rocking_stiffness: float = 0.0
    rocking_damping: float = 0.0
    sways: bool = True
    rocks: bool = True
    isolation: FrictionPendulum | Bearings | Rubber | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        if self.isolation is not None and not (self.mass > 0 and self.sways):
            raise ValueError("foundation: a base on isolators sways, and its mass is above zero")
        for law, switch in (("sway", "sways"), ("rocking", "rocks")):
            try:
                getattr(self, law)
            except ValueError as error:
                raise ValueError(f"{error}, or set {switch} to False") from None

    @cached_property
    def sway(self) -> Sway | None:
        """The spring and dashpot of its translation; None where it does not sway, or on isolators."""
        is_spring = self.sways and self.isolation is None
        return Sway(self.mass, self.sway_stiffness, self.sway_damping) if is_spring else None

    @cached_property
    def rocking(self) -> Rocking | None:
        """Those of its rotation."""
        return Rocking(self.inertia, self.rocking_stiffness, self.rocking_damping) if self.rocks else None


@dataclass(frozen=True, eq=False)
class Building:
    """n floors on n storeys (paper, Fig. 1 and eqs 1-4); arrays run from the ground up, shape (n,).

    Parameters
    ----------
    name : what tables and figures call it
    mass : floor masses [kg], > 0
    height : storey heights [m], > 0
    stiffness : initial storey stiffnesses [N/m], > 0
    yield_shear : storey yield shears [N], > 0; inf for a storey that cannot yield
    hardening : post-yield over initial stiffness [-], 0 <= a < 1, shape (n,)
    alpha, beta : Rayleigh factors of the fixed-base building, C = alpha M + beta K0 [1/s], [s], >= 0
    foundation : None for a fixed base
    storey_law : how storeys yield, of `laws.storey_laws()`
    law_parameters : (name, value) of the parameters it has beyond stiffness, yield shear and hardening [SI]
    gravity_load : P of P-Delta [N], what every storey carries, >= 0, shape (n,): as its floors move apart by v, P v / h
        pushes them on; None without P-Delta
    slab : thickness of the floor slabs [m], >= 0, below every storey height; says which floors of neighbours meet
    columns : part of a storey's stiffness and yield shear in the columns that a neighbour's slab strikes [-],
        0 <= columns <= 1, 0 where it has walls and no columns; None: not known
    plan : of floors that twist; its lines add up to `stiffness` and `yield_shear`; None for floors that do not
    collapse : drift over storey height at which a storey counts as collapsed [-], > 0, inf for never; None: 0.10 where
        storeys that yield may lose all resistance, never elsewhere

    Raises
    ------
    ValueError : an array has another shape, a value is outside its range, or the law has no such parameter
    UnstableError : P-Delta leaves it no stiffness at rest
    """

    name: str
    mass: np.ndarray
    height: np.ndarray
    stiffness: np.ndarray
    yield_shear: np.ndarray
    hardening: np.ndarray
    alpha: float
    beta: float
    foundation: Foundation | None = None
    storey_law: type[StoreyLaw] = Bilinear
    law_parameters: tuple[tuple[str, float], ...] = ()
    gravity_load: np.ndarray | None = None
    collapse: float | None = None
    slab: float = 0.0
    columns: float | None = None
    plan: FloorPlan | None = None

    meeting_fields: ClassVar[tuple[str, ...]] = ("slab", "columns")
    """Fields that say what neighbours strike; they move no building by themselves, and links carry what follows."""

    def __post_init__(self) -> None:
        loads = () if self.gravity_load is None else ("gravity_load",)
        for key in ("mass", "height", "stiffness", "yield_shear", "hardening", *loads):
            array = np.array(getattr(self, key), dtype=float)
            array.setflags(write=False)
            object.__setattr__(self, key, array)
            if array.shape != (self.storeys,):
                raise ValueError(f"{self.name}: {key} has shape {array.shape}, expected ({self.storeys},)")
        if self.storeys == 0:
            raise ValueError(f"{self.name}: no storeys; give at least one floor mass")
        for key in ("mass", "height", "stiffness"):
            self._check(key, lambda x: np.isfinite(x) & (x > 0), "must be finite and above zero")
        self._check("yield_shear", lambda x: x > 0, "must be above zero; inf for a storey that cannot yield")
        self._check("hardening", lambda x: (x >= 0) & (x < 1), "must be at least 0 and below 1")
        for key in ("alpha", "beta", *loads):
            self._check(key, lambda x: np.isfinite(x) & (x >= 0), "must be finite and not negative")
        if self.collapse is not None and not self.collapse > 0:
            raise ValueError(f"{self.name}: collapse is {self.collapse:g}; it must be above zero, or inf for never")
        if not 0 <= self.slab < self.height.min():
            raise ValueError(f"{self.name}: slab is {self.slab:g} m; it must be thinner than its storeys are high")
        if self.columns is not None and not 0 <= self.columns <= 1:
            raise ValueError(f"{self.name}: columns is {self.columns:g}; it must be from 0 to 1")
        unknown = [key for key, _ in self.law_parameters if key not in self.storey_law.parameters()]
        if unknown:
            raise ValueError(f"{self.name}: the storey law '{self.storey_law.name}' has no parameter '{unknown[0]}'")
        if self.plan is not None:
            self._check_plan(self.plan)
        if self.gravity_load is not None:
            self._check_stability()

    def _check_plan(self, plan: FloorPlan) -> None:
        """Refuse a plan of another building, and one whose floors can turn without resistance."""
        if plan.storeys != self.storeys:
            storeys = pluralize(plan.storeys, "storey")
            raise ValueError(f"{self.name}: its plan has {storeys}, not {self.storeys}")
        for key in ("stiffness", "yield_shear"):
            sums = getattr(plan, key)
            wrong = np.flatnonzero(~np.isclose(getattr(self, key), sums, rtol=1e-9))
            if wrong.size:
                j = wrong[0]
                own = getattr(self, key)[j]
                given = f"{key} of storey {j + 1} is {own:g}"
                raise ValueError(f"{self.name}: {given}; its lines add up to {sums[j]:g}")
        matrices = plan.storey_matrices()
        resistance = np.linalg.det(matrices)
        rounding = NO_RESISTANCE * matrices[:, 0, 0] * matrices[:, 1, 1]
        wrong = np.flatnonzero(~(resistance > rounding))
        if wrong.size:
            raise ValueError(
                f"{self.name}: nothing keeps the floors of storey {wrong[0] + 1} from turning; "
                "give torsional_stiffness, lines across, or lines along the row at two places"
            )

    def _check_stability(self) -> None:
        """Refuse a building without stiffness at rest: the least energy of the storeys at a rocking angle phi is
        -sum P h / (1 - theta) phi^2 / 2, which the rocking spring must outweigh."""
        theta = self.stability_coefficient
        wrong = np.flatnonzero(theta >= 1)
        if not wrong.size and self.plan is not None:
            theta = self._twisting_stability(self.plan)
        if wrong.size:
            raise UnstableError(
                f"{self.name}: P-Delta leaves storey {wrong[0] + 1} no stiffness: theta = P / (k h) is "
                f"{theta[wrong[0]]:.3g}; it must be below 1"
            )
        if self.foundation is not None and self.foundation.rocks:
            moment = float(np.sum(self.gravity_load * self.height / (1 - theta)))
            if moment >= self.foundation.rocking_stiffness:
                raise UnstableError(
                    f"{self.name}: its weight overturns it on its rocking foundation: rocking_stiffness is "
                    f"{self.foundation.rocking_stiffness:.3g} N m; it must be above {moment:.3g} N m, "
                    "the sum of P h / (1 - theta)"
                )

    def _twisting_stability(self, plan: FloorPlan) -> np.ndarray:
        """Return theta = P / (k h) of floors that turn as their own weight makes them, shape (n,).

        Then k is the stiffness along the row with the twist left free: what turning takes away from it included.

        Raises
        ------
        UnstableError : P-Delta turns the floors of a storey from rest
        """
        loads = self._load_matrices(plan)
        matrices = plan.storey_matrices() - loads
        torsion = matrices[:, 1, 1]
        resistance = np.linalg.det(matrices)
        wrong = np.flatnonzero(~((torsion > 0) & (resistance > 0)))
        if wrong.size:
            j = wrong[0]
            load = loads[j, 1, 1]
            raise UnstableError(
                f"{self.name}: P-Delta turns the floors of storey {j + 1} from rest: their torsional stiffness about "
                f"the centre of mass is {torsion[j] + load:.3g} N m, of which P r^2 / h takes {load:.3g} N m, and what "
                "is left does not outweigh the eccentricity of the lines"
            )
        free = matrices[:, 0, 0] - matrices[:, 0, 1] ** 2 / torsion + loads[:, 0, 0]
        return np.asarray(loads[:, 0, 0] / free)

    def _load_matrices(self, plan: FloorPlan) -> np.ndarray:
        """Return what P-Delta takes away from the stiffnesses of its storeys in drift and twist, shape (n, 2, 2)."""
        loads = np.zeros(self.storeys) if self.gravity_load is None else self.gravity_load
        return plan.load_matrices(self.mass, loads / self.height)

    def _check(self, key: str, holds: Callable[[np.ndarray], np.ndarray], rule: str) -> None:
        values = np.atleast_1d(getattr(self, key))
        wrong = np.flatnonzero(~holds(values))
        if wrong.size:
            place = f" of storey {wrong[0] + 1}" if key not in ("alpha", "beta") else ""
            raise ValueError(f"{self.name}: {key}{place} is {values[wrong[0]]:g}; it {rule}")

    def __repr__(self) -> str:
        return f"Building({self.name!r}, {pluralize(self.storeys, 'storey')}, T = {self.periods[0]:.4g} s)"

    @property
    def storeys(self) -> int:
        """Number of storeys n."""
        return self.mass.size

    @property
    def lines(self) -> int:
        """Number of frame lines of its plan, those across the row too; 0 without a plan."""
        return 0 if self.plan is None else len(self.plan.all_lines)

    @property
    def elevation(self) -> np.ndarray:
        """Floor elevations above the base [m], shape (n,)."""
        return np.cumsum(self.height)

    def level(self, floor: int) -> float:
        """Elevation of a floor above the base [m]; floor 0 is the base."""
        return float(self.elevation[floor - 1]) if floor else 0.0

    def has_floor(self, floor: int) -> bool:
        """Return whether a link may end there: at a floor, or at a base that moves (0)."""
        return 1 <= floor <= self.storeys or (floor == 0 and self.foundation is not None and self.foundation.sways)

    @cached_property
    def yield_drift(self) -> np.ndarray:
        """Storey drift at first yield [m], shape (n,)."""
        return self.yield_shear / self.stiffness

    @property
    def collapse_drift(self) -> np.ndarray:
        """Drift at which every storey counts as collapsed [m], inf where that is not looked for, shape (n,)."""
        if self.collapse is not None:
            return self.collapse * self.height
        softest = np.array([law.min_slope_ratio for law in self.laws])
        softens = self._may_soften(softest)
        return (DEFAULT_COLLAPSE_RATIO if softens.any() else np.inf) * self.height

    @property
    def can_yield(self) -> np.ndarray:
        """True for every storey that can leave its elastic branch, itself or one of its frame lines, shape (n,)."""
        if self.plan is None:
            return np.isfinite(self.yield_shear)
        return np.any([np.isfinite(line.yield_shear) for line in self.plan.all_lines], axis=0)

    def _may_soften(self, slope_ratio: np.ndarray) -> np.ndarray:
        """Return whether every storey may lose all resistance as it yields, shape (n,).

        slope_ratio : least slope of what yields over its initial stiffness [-], shape (n,)
        """
        if self.plan is None:
            return np.asarray(self.can_yield & (self.stability_coefficient > slope_ratio))
        left = self.plan.storey_matrices(slope_ratio) - self._load_matrices(self.plan)
        rounding = NO_RESISTANCE * np.trace(self.plan.storey_matrices(), axis1=1, axis2=2)
        return np.asarray(self.can_yield & (np.linalg.eigvalsh(left)[:, 0] < -rounding))

    @property
    def stability_coefficient(self) -> np.ndarray:
        """theta = P / (k h) of P-Delta [-], 0 without it, shape (n,)."""
        loads = np.zeros(self.storeys) if self.gravity_load is None else self.gravity_load
        return loads / (self.stiffness * self.height)

    @cached_property
    def laws(self) -> tuple[StoreyLaw, ...]:
        """The law of every storey, from the ground up.

        Raises
        ------
        ValueError : a parameter of the law is outside its range
        """
        each = zip(self.stiffness.tolist(), self.yield_shear.tolist(), self.hardening.tolist(), strict=True)
        return tuple(self.storey_law(*values, **dict(self.law_parameters)) for values in each)

    def laws_of_line(self, line: FrameLine) -> tuple[StoreyLaw, ...]:
        """Return the law of every storey of one of its frame lines, from the ground up."""
        each = zip(line.stiffness.tolist(), line.yield_shear.tolist(), self.hardening.tolist(), strict=True)
        return tuple(self.storey_law(*values, **dict(self.law_parameters)) for values in each)

    @cached_property
    def isolators(self) -> Bilinear | Slider | None:
        """Law of the isolators under its weight; None where it has none, or linear ones."""
        base = self.foundation
        return None if base is None or base.isolation is None else base.isolation.law_under(self.weight)

    @property
    def base_spring(self) -> tuple[float, float]:
        """Stiffness [N/m] and dashpot [N s/m] below a base that sways, where they are linear."""
        base = self.foundation
        assert base is not None
        if isinstance(base.isolation, Rubber):
            return base.isolation.stiffness, base.isolation.dashpot(self.weight) + base.sway_damping
        return base.sway_stiffness, base.sway_damping

    @property
    def weight(self) -> float:
        """Weight of the floors and of a base that sways [N]."""
        base = self.foundation.mass if self.foundation is not None and self.foundation.sways else 0.0
        return GRAVITY * (base + float(self.mass.sum()))

    @property
    def base_shear_ratio(self) -> float:
        """Yield shear of the lowest storey over the weight, V/W [-]; inf where it cannot yield."""
        return float(self.yield_shear[0] / (GRAVITY * self.mass.sum()))

    @cached_property
    def stiffness_matrix(self) -> np.ndarray:
        """Fixed-base initial stiffness matrix K0 [N/m], shape (n, n)."""
        above = np.append(self.stiffness[1:], 0.0)
        return np.diag(self.stiffness + above) - np.diag(above[:-1], 1) - np.diag(above[:-1], -1)

    @cached_property
    def periods(self) -> np.ndarray:
        """Natural periods of the fixed-base building [s], longest first, shape (n,)."""
        root = np.sqrt(self.mass)
        squares = np.linalg.eigvalsh(self.stiffness_matrix / np.outer(root, root))
        return 2 * np.pi / np.sqrt(squares)

    @cached_property
    def digest(self) -> str:
        """SHA-256 over everything that moves the building; the name is left out."""
        sha = hashlib.sha256()
        for each in fields(self):
            if each.name in ("name", *self.meeting_fields):
                continue
            value = getattr(self, each.name)
            if isinstance(value, FloorPlan):
                value = value.identity
            elif each.name == "storey_law":
                value = self.storey_law.name
            sha.update(f"{each.name}: ".encode())
            sha.update(value.tobytes() if isinstance(value, np.ndarray) else repr(value).encode())
        if self.foundation is not None and self.foundation.isolation is not None:
            sha.update(self.foundation.isolation.identity.encode())
        return sha.hexdigest()
