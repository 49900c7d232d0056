"""Declaration of a law: its parameters, and its element on each branch (`Behaviour`).

The functions of a law are plain Python on the fields of an element; the solver compiles them. Everything that acts is
one-dimensional: a force F on a deformation v, the drift of a storey or the closing of two floors."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import MISSING, Field, dataclass, field, fields, replace
from functools import cache, cached_property
from typing import Any, ClassVar

PARAMETERS = 16
"""Room in the record of an element for the parameters p of its law."""

HISTORY = 14
"""Room in the record of an element for the history variables h of its law."""

REFERENCE_CLOSING = 0.01
"""Closing [m] at which the slope of a force that stiffens without end is taken: floors press each other by
millimetres."""


@dataclass(frozen=True)
class Parameter:
    """Meaning of a field of a law, its unit and the range of its values."""

    doc: str
    unit: str = "-"
    low: float = 0.0
    high: float = math.inf
    open_low: bool = False
    open_high: bool = True
    can_be_infinite: bool = False

    def describe_issue(self, value: float) -> str:
        """Return what is wrong with a value, or ""."""
        above = value > self.low if self.open_low else value >= self.low
        below = value < self.high if self.open_high else value <= self.high
        if (above and below) or (self.can_be_infinite and value == math.inf):
            return ""
        return f"it must be {self.range}"

    @property
    def description(self) -> str:
        """The meaning, with the unit."""
        return self.doc if self.unit == "-" else f"{self.doc} [{self.unit}]"

    @property
    def range(self) -> str:
        """The values allowed, in words."""
        zero = self.low == 0
        low = ("above zero" if zero else f"above {self.low:g}") if self.open_low else f"at least {self.low:g}"
        if self.high == math.inf:
            return ("finite and not negative" if zero and not self.open_low else f"finite and {low}").strip()
        return f"{low} and {'below' if self.open_high else 'at most'} {self.high:g}"


def parameter(doc: str, unit: str = "-", *, default: Any = MISSING, **limits: Any) -> Any:
    """A field of a law: what `Parameter` says of it, and its default."""
    return field(default=default, metadata={"parameter": Parameter(doc, unit, **limits)})


@dataclass(frozen=True)
class Law:
    """A frozen dataclass of its parameters, each by `parameter`.

    name : what a study file calls it
    example : a case of a study with this link, or a building with this law of its storeys
    citation : (key of `report/references.bib`, what it is cited for), ...

    Raises
    ------
    ValueError : a parameter is outside its range
    """

    name: ClassVar[str]
    example: ClassVar[str] = ""
    citation: ClassVar[tuple[tuple[str, str], ...]] = ()
    acts_on: ClassVar[str] = ""

    def __post_init__(self) -> None:
        for each in fields(self):
            declared = each.metadata.get("parameter")
            value = getattr(self, each.name)
            if declared is None or isinstance(value, str | bool):
                continue
            if wrong := declared.describe_issue(value):
                unit = "" if declared.unit == "-" else f" {declared.unit}"
                raise ValueError(f"{self.acts_on}: {each.name} is {value:g}{unit}; {wrong}")

    @cached_property
    def identity(self) -> str:
        """Name and every parameter in a line: two laws with one line act alike."""
        values = (getattr(self, each.name) for each in fields(self))
        return " ".join((self.name, *(repr(v) if isinstance(v, float) else str(v) for v in values)))

    @classmethod
    @cache  # asked for at every link of every point of a sweep
    def parameters(cls) -> Mapping[str, Field]:
        """Return the fields that are parameters, by name."""
        return {each.name: each for each in fields(cls) if "parameter" in each.metadata}


@dataclass(frozen=True)
class Behaviour:
    """Functions of the record e of an element, which the solver compiles (`solver.dispatch`).

    next_branch : (e, guard) -> None: the element met a guard (`laws.guards`) at the deformation e.v1 [m] with the rate
        e.r1 [m/s]; sets its next branch and its history variables e.h. On a branch the force is
            F = k v + c v' + f0 + cubic v^3 + root sqrt(k + 3 cubic v^2) v'   [N]
        while low < v < high and slow < v' < fast
    force : (e, v, r) -> F [N], added on branches with e.smooth = 1, which DOP853 steps; None where there are none
    history_rate : (e, r, h) -> h', rate of the history variable e.h[0] that changes between events too
    """

    next_branch: Callable[[Any, int], None]
    force: Callable[[Any, float, float], float] | None = None
    history_rate: Callable[[Any, float, float], float] | None = None


def set_line(e: Any, k: float, c: float, f0: float, low: float, high: float, way: int = 0) -> None:
    """Set F = k v + c v' + f0 [N/m, N s/m, N] for low < v < high [m], while v rises (`way` 1), falls (-1), or either
    way (0), with no other guard; the element acts."""
    e.k = k
    e.c = c
    e.f0 = f0
    e.low = low
    e.high = high
    e.slow = 0.0 if way > 0 else -math.inf
    e.fast = 0.0 if way < 0 else math.inf
    e.cubic = e.root = 0.0
    e.levels = e.cuts = e.crosses = e.smooth = 0
    e.closed = e.acts = 1


def set_open(e: Any) -> None:
    """Set the branch of floors apart: no force until v rises to 0."""
    set_line(e, 0.0, 0.0, 0.0, -math.inf, 0.0)
    e.branch = e.closed = e.acts = 0


def _set_joined(e: Any, guard: int) -> None:
    """One branch without end. Parameters: spring [N/m] and dashpot [N s/m]."""
    set_line(e, e.p[0], e.p[1], 0.0, -math.inf, math.inf)


JOINED = Behaviour(_set_joined)
"""A spring and a dashpot at all times: connectors, dampers, storeys that cannot yield, foundation springs."""


def in_series(stiffness: float, flexibility: float) -> float:
    """Return the stiffness of two springs in series [N/m] from the stiffness of one and the flexibility of the other
    [m/N]."""
    return 1.0 / (1.0 / stiffness + flexibility)


@dataclass(frozen=True)
class LinkLaw(Law):
    """Law of a link between two floors. It acts on v, their closing u_left - u_right, less the gap if so declared.

    symbol : how pictures show it: "gap" (nothing between the floors), "filling" or "bar"
    subtracts_gap : whether v is the closing less the gap
    stiffness_default : spring unless given, as a study file would write it; "" for `impact.stiffness`
    beyond_gap : code of the note that a scene is flagged with where the closing exceeds the gap, or ""
    can_act : whether a force may ever act
    joins : whether a force acts at all closings, not only once the floors meet
    path_dependent : whether its force depends on what happened before, so that only methods that locate events know it
    takes_energy : whether it has a dashpot whatever its damping ratio
    scaled_parameters : parameters that grow with the part of a link that stands at one of several places; none of a law
        that cannot be parted
    behaviour : what it does

    Raises
    ------
    ValueError : a parameter is outside its range
    """

    acts_on: ClassVar[str] = "link"
    symbol: ClassVar[str] = "gap"
    subtracts_gap: ClassVar[bool] = False
    stiffness_default: ClassVar[str] = ""
    beyond_gap: ClassVar[str] = ""
    can_act: ClassVar[bool] = True
    joins: ClassVar[bool] = False
    path_dependent: ClassVar[bool] = False
    takes_energy: ClassVar[bool] = False
    scaled_parameters: ClassVar[tuple[str, ...]] = ()
    behaviour: ClassVar[Behaviour]

    gap: float = parameter("initial distance d between the floors", "m")

    def element_parameters(self, left_mass: float, right_mass: float) -> tuple[float, ...]:
        """Return the parameters p of its element between floors of these masses [kg], as `behaviour` reads them."""
        raise NotImplementedError

    @classmethod
    def find_conflict(cls, **values: float) -> tuple[str, str, str] | None:
        """Return (parameter, what is wrong, what to write) of values (SI) that do not fit together; None where they do.

        Each value is in its range; not all need be given.
        """
        return None

    def soften(self, flexibility: float) -> LinkLaw | None:
        """Return the law in series with a spring, such as columns that bend; None where that is not known.

        A law without a spring of its own stays as it is.

        Parameters
        ----------
        flexibility : deformation of that spring per force [m/N], >= 0
        """
        return None

    def scale(self, share: float) -> LinkLaw | None:
        """Return the law of a part of the link; None where it cannot be parted.

        Parameters
        ----------
        share : the part [-], above 0
        """
        if not self.scaled_parameters:
            return None
        return replace(self, **{name: share * getattr(self, name) for name in self.scaled_parameters})

    @property
    def offset(self) -> float:
        """Part of the closing u_left - u_right that v leaves out [m]."""
        return self.gap if self.subtracts_gap else 0.0

    @property
    def free_below(self) -> float:
        """The closing u_left - u_right [m] below which no force acts; -inf where one always does."""
        return -math.inf if self.joins else self.offset

    @property
    def is_damped(self) -> bool:
        """True where it takes energy, by a dashpot or otherwise."""
        return self.takes_energy or getattr(self, "damping_ratio", 0.0) > 0.0 or getattr(self, "restitution", 1.0) < 1.0

    @property
    def cuts_tension(self) -> bool:
        """True where a force that would pull is cut off."""
        return bool(getattr(self, "tension_cut", False)) and self.is_damped

    @property
    def max_slopes(self) -> tuple[float, float]:
        """(stiffness [N/m], dashpot [N s/m]) where it is stiffest, between floors of 1 kg each: the first two of the
        numbers of a law that fixed steps run. A force that stiffens without end is taken where floors press each other
        by `REFERENCE_CLOSING`."""
        k, c, *_ = self.element_parameters(1.0, 1.0)
        return k, c

    def stored_energy(self, closing: float, force: float) -> float:
        """Return the energy that it could give back [J] at a closing u_left - u_right [m] with the force [N]."""
        return 0.0
