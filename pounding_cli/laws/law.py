"""What a law declares: its parameters and its branches (`laws.branch`); what a law of links adds.

A link acts on the closing v of its two floors, less the gap where the law says so. On one branch its force is
    F = linear v + cubic v^3 + offset + (dashpot + root sqrt(linear + 3 cubic v^2)) v',
or any other smooth force, written as an expression (`laws.program`). A branch ends at a *guard*: where the closing,
its rate, the acceleration between the floors or the force passes a value. Everything else that the program needs of a
law (its series, tangent, events, stored energy, histories) follows from this."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import MISSING, Field, dataclass, field, fields
from functools import cache, cached_property
from typing import Any, ClassVar

from pounding_cli.laws.branch import (
    Branch,
    Guard,
    Quantity,
    begins_to_pull,
    begins_to_push,
    falls_below,
    opening,
    remembering,
    rises_above,
)
from pounding_cli.laws.program import Expression

__all__ = [
    "ROUNDING", "Branch", "Guard", "Law", "LinkLaw", "Parameter", "Quantity", "begins_to_pull", "begins_to_push",
    "falls_below", "opening", "parameter", "remembering", "rises_above",
]  # fmt: skip
"""What the file of a law imports."""

ROUNDING = 1e-11
"""Part of a yield closing by which a turning point is kept apart from the line that it lies on [-]: in numbers with
rounding it would lie beyond it half of the time."""


def parameter(
    doc: str,
    unit: str = "-",
    *,
    low: float = 0.0,
    high: float = math.inf,
    open_low: bool = False,
    open_high: bool = True,
    default: Any = MISSING,
) -> Any:
    """A field of a law: what it means, its unit, the range of its values and its default."""
    declared = Parameter(doc, unit, low, high, open_low, open_high)
    return field(default=default, metadata={"parameter": declared})


@dataclass(frozen=True)
class Parameter:
    """What `parameter` says of a field of a law."""

    doc: str
    unit: str
    low: float
    high: float
    open_low: bool
    open_high: bool

    def refusal(self, value: float) -> str:
        """What is wrong with a value, or ""."""
        above = value > self.low if self.open_low else value >= self.low
        below = value < self.high if self.open_high else value <= self.high
        if above and below:
            return ""
        return f"it must be {self.range}"

    @property
    def words(self) -> str:
        """What it means, with its unit."""
        return self.doc if self.unit == "-" else f"{self.doc} [{self.unit}]"

    @property
    def range(self) -> str:
        """The values allowed, in words."""
        zero = self.low == 0
        low = ("above zero" if zero else f"above {self.low:g}") if self.open_low else f"at least {self.low:g}"
        if self.high == math.inf:
            return ("finite and not negative" if zero and not self.open_low else f"finite and {low}").strip()
        return f"{low} and {'below' if self.open_high else 'at most'} {self.high:g}"


@dataclass(frozen=True)
class Law:
    """A frozen dataclass of its parameters, each by `parameter`.

    name : what a study file calls it
    citation : (key of `report/references.py`, what it is cited for), ...
    instead : keys that it does not have and others write, and what to write in their place

    Raises
    ------
    ValueError : a parameter is outside its range
    """

    name: ClassVar[str]
    citation: ClassVar[tuple[tuple[str, str], ...]] = ()
    acts_on: ClassVar[str] = ""
    instead: ClassVar[Mapping[str, str]] = {}

    def __post_init__(self) -> None:
        for each in fields(self):
            declared, value = each.metadata.get("parameter"), getattr(self, each.name)
            if declared is None or isinstance(value, str | bool):
                continue
            wrong = "" if value == math.inf and self.may_be_endless(each.name) else declared.refusal(value)
            if each.type in ("int", int) and value != int(value):
                wrong = "it must be a whole number"
            if wrong:
                unit = "" if declared.unit == "-" else f" {declared.unit}"
                raise ValueError(f"{self.acts_on}: {each.name} is {value:g}{unit}; {wrong}")

    def may_be_endless(self, name: str) -> bool:
        """Whether a parameter may be infinite."""
        return False

    @cached_property
    def words(self) -> str:
        """Name and every parameter in a line: two laws with one line act alike."""
        values = (getattr(self, each.name) for each in fields(self))
        return " ".join((self.name, *(repr(v) if isinstance(v, float) else str(v) for v in values)))

    @classmethod
    def parameters(cls) -> Mapping[str, Field]:
        """Fields that are parameters, by name."""
        return _parameters(cls)  # type: ignore[arg-type]  # classes are hashable


@cache
def _parameters(law: type[Law]) -> Mapping[str, Field]:
    return {each.name: each for each in fields(law) if "parameter" in each.metadata}


@dataclass(frozen=True)
class LinkLaw(Law):
    """What stands between two floors.

    drawn : how pictures show it: "gap" (nothing between the floors), "filling" or "bar"
    subtracts_gap : whether v is the closing less the gap
    stiffness_default : spring unless given, as a study file would write it; "" for `impact.stiffness`
    beyond_gap : what a scene is flagged with where the closing exceeds the gap, or ""
    meaningless : whether that takes the meaning from all numbers of the scene

    Raises
    ------
    ValueError : a parameter is outside its range
    """

    acts_on: ClassVar[str] = "link"
    drawn: ClassVar[str] = "gap"
    subtracts_gap: ClassVar[bool] = False
    stiffness_default: ClassVar[str] = ""
    beyond_gap: ClassVar[str] = ""
    meaningless: ClassVar[bool] = False

    gap: float = parameter("initial distance d between the floors", "m")

    def branches(self, left_mass: float, right_mass: float) -> tuple[Branch, ...]:
        """The branches between floors of these masses [kg]; the first is the one at rest, with the floors at v = 0 or
        further apart."""
        raise NotImplementedError

    @classmethod
    def conflict(cls, **values: float) -> tuple[str, str, str] | None:
        """What is wrong with parameters (SI) that are each in their range: (parameter, what is wrong, what to write);
        None if nothing. Not all need be given."""
        return None

    @property
    def can_close(self) -> bool:
        """Whether a force may ever act."""
        return math.isfinite(self.gap)

    @property
    def offset(self) -> float:
        """What v leaves out of the closing u_left - u_right [m]."""
        return self.gap if self.subtracts_gap else 0.0

    @cached_property
    def _sample(self) -> tuple[Branch, ...]:
        """The branches between floors of some mass: what does not depend on it is read from them."""
        return self.branches(1.0, 1.0)

    @cached_property
    def free_below(self) -> float:
        """The closing u_left - u_right [m] below which no force acts; -inf where one always does."""
        return -math.inf if self._sample[0].closed else self.offset + self._sample[0].interval[1]

    @cached_property
    def empty_below(self) -> float:
        """The closing u_left - u_right [m] up to which it holds no energy; -inf where it may always hold some."""
        return -math.inf if any(branch.holds is not None for branch in self._sample) else self.free_below

    @cached_property
    def damped(self) -> bool:
        """Whether a dashpot takes energy."""
        return any(branch.damps for branch in self._sample)

    @cached_property
    def cut(self) -> bool:
        """Whether a force that would pull is cut off."""
        return any(branch.cut for branch in self._sample)

    @cached_property
    def general(self) -> bool:
        """Whether some branch is followed by program steps."""
        return any(branch.general for branch in self._sample)

    @cached_property
    def remembers(self) -> bool:
        """Whether its force does not follow from closing and rate alone, or its branch not from the closing, so that
        only a method that locates events knows it."""
        guards = [guard for branch in self._sample for guard in branch.guards]
        flows = any(branch.flow is not None for branch in self._sample)
        return flows or any(g.sets or g.quantity in (Quantity.RATE, Quantity.ACCELERATION) for g in guards)

    @cached_property
    def is_linear(self) -> bool:
        """Whether its force is linear in closing and rate at all times, as far as it can act at all."""
        first = self._sample[0]
        return not self.can_close or not (first.guards or first.cubic or first.root or first.force)

    @cached_property
    def initial_stiffness(self) -> float:
        """The stiffness as the floors begin to press [N/m]; of a force without one there, its largest."""
        first = next(branch for branch in self._sample if branch.closed)
        return first.linear if first.force is None else first.steepest[0]

    @cached_property
    def stiffest(self) -> float:
        """The largest stiffness of its branches [N/m]."""
        return max(branch.steepest[0] for branch in self._sample)

    def held(self, branch: int, closing: float, memory: float) -> float:
        """Energy in the link [J] on a branch, by its place, at a closing u_left - u_right [m] with what it
        remembers."""
        holds = self._sample[branch].holds
        if holds is None:
            return self.stored(closing)
        return float(holds.at(closing - self.offset, 0.0, memory)) if isinstance(holds, Expression) else holds

    def stored(self, closing: float) -> float:
        """Energy in the spring [J] at a closing u_left - u_right [m]: its elastic force integrated from where it
        begins to act."""
        if closing <= self.free_below:
            return 0.0
        v, energy = closing - self.offset, 0.0
        rest = min(self._sample[0].interval[1], 0.0)
        for branch in self._sample:
            if branch.acts:
                low, high = branch.interval
                begin, end = (min(max(closing, low), high) for closing in (rest, v))
                energy += branch.stored(end) - branch.stored(begin)
        return energy
