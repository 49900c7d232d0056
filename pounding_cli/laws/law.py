"""What a law declares: its parameters, its branches, where each ends and what follows; what a law of links adds.

A link acts on the closing v of its two floors, less the gap where the law says so. On one branch its force is
    F = linear v + cubic v^3 + offset + (dashpot + root sqrt(linear + 3 cubic v^2)) v',
or any other smooth force, written as an expression (`laws.program`). A branch ends at a *guard*: where the closing,
its rate, the acceleration between the floors or the force passes a value. Everything else that the program needs of a
law (its series, tangent, events, stored energy, histories) follows from this."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import MISSING, Field, dataclass, field, fields, replace
from enum import IntEnum
from functools import cache, cached_property
from typing import Any, ClassVar

import numpy as np

from pounding_cli.laws.program import CLOSING, RATE, Expression, work

PRESSED = 0.01
"""Closing [m] at which the slope of a force that stiffens without end is taken: floors press each other by
millimetres."""

ROUNDING = 1e-11
"""Part of a yield closing by which a turning point is kept apart from the line that it lies on [-]: in numbers with
rounding it would lie beyond it half of the time."""


class Quantity(IntEnum):
    """What a guard looks at."""

    NOTHING = 0
    CLOSING = 1
    FORCE = 2
    RATE = 3
    ACCELERATION = 4
    FLOWING = 5


@dataclass(frozen=True)
class Guard:
    """Where a branch ends.

    Parameters
    ----------
    quantity : the closing v of a link or the drift of a storey, its rate, the acceleration v'' between the floors of a
        link, the force F, or what a storey remembers that flows
    at : value that it passes [m, m/s, or that of the memory]; an acceleration and a force pass zero
    side : 1 where it falls below that value, -1 where it rises above
    to : name of the branch that follows
    impact : counted as a blow
    once : an event that undoes itself at the same instant is numerical error (floors that part from rest, for
        example): after two of them the link stays as it is until time goes on
    of_memory : times a memory, is added to `at` [-]
    memory : the number of that memory
    sets : what is remembered from the event on: (number of a memory, what goes there), ... of the closing (or drift)
        and rate at the event and of the memories before it. Links have memory 0 alone
    """

    quantity: Quantity
    at: float
    side: float
    to: str
    impact: bool = False
    once: bool = False
    of_memory: float = 0.0
    memory: int = 0
    sets: tuple[tuple[int, Expression], ...] = ()


def falls_below(at: float, to: str, of_memory: float = 0.0) -> Guard:
    """The closing falls below `at` [m] plus a multiple of the memory."""
    return Guard(Quantity.CLOSING, at, 1.0, to, of_memory=of_memory)


def rises_above(at: float, to: str, impact: bool = False, once: bool = False, of_memory: float = 0.0) -> Guard:
    """The closing rises above it."""
    return Guard(Quantity.CLOSING, at, -1.0, to, impact, once, of_memory)


def begins_to_pull(to: str) -> Guard:
    """The force falls below zero."""
    return Guard(Quantity.FORCE, 0.0, 1.0, to, once=True)  # fault: tension-guard


def begins_to_push(to: str) -> Guard:
    """The force rises above zero."""
    return Guard(Quantity.FORCE, 0.0, -1.0, to, once=True)


@dataclass(frozen=True)
class Branch:
    """One smooth piece of a law.

    Parameters
    ----------
    name : in words
    linear, cubic, offset, dashpot, root : of the force above [N/m, N/m3, N, N s/m, sqrt(kg)]
    guards : where it ends, in the order in which they are asked
    closed : whether its force is followed; without it the branch has none
    acts : whether the force acts on the floors; a force that would pull where the law cuts it off does not
    force : a smooth force that the coefficients cannot say [N]; they are zero then
    regular : b where `force` holds powers of v that are whole powers of v^(1/b) [-]
    flow : rate at which the memory changes while the branch holds [its unit / s], as an expression; None where events
        alone change it
    holds : energy [J] that the link holds on it, where that does not follow from the closing alone
    """

    name: str
    linear: float = 0.0
    cubic: float = 0.0
    offset: float = 0.0
    dashpot: float = 0.0
    root: float = 0.0
    guards: tuple[Guard, ...] = ()
    closed: bool = True
    acts: bool = True
    force: Expression | None = None
    regular: int = 1
    flow: Expression | None = None
    holds: Expression | float | None = None

    @cached_property
    def expression(self) -> Expression:
        """Its force, however it is given."""
        if self.force is not None:
            return self.force
        force = self.linear * CLOSING + self.offset
        dashpot: Expression | float = self.dashpot
        if self.cubic:
            force = force + self.cubic * CLOSING**3
        if self.root:
            dashpot = self.root * (self.linear + 3 * self.cubic * CLOSING**2) ** 0.5 + self.dashpot
        return force + dashpot * RATE if self.damps else force

    @property
    def damps(self) -> bool:
        """Whether its force depends on the rate."""
        return bool(self.dashpot or self.root) or (self.force is not None and self.force.holds(RATE))

    @cached_property
    def general(self) -> bool:
        """Whether only program steps (`kernels.program_step`) can follow it: its force is an expression, or a guard
        looks at more than closing and force."""
        plain = Quantity.CLOSING, Quantity.FORCE
        return self.force is not None or any(g.quantity not in plain or g.of_memory for g in self.guards)

    @cached_property
    def interval(self) -> tuple[float, float]:
        """The closings between which it holds [m]."""
        closings = [guard for guard in self.guards if guard.quantity is Quantity.CLOSING and not guard.of_memory]
        low = max((guard.at for guard in closings if guard.side > 0), default=-math.inf)
        return low, min((guard.at for guard in closings if guard.side < 0), default=math.inf)

    @property
    def cut(self) -> bool:
        """Whether a force that would pull ends it."""
        return any(guard.quantity is Quantity.FORCE for guard in self.guards)

    def stored(self, closing: float) -> float:
        """Energy in the spring [J] at a closing [m], but for a constant."""
        if self.force is not None:
            force = self.force
            rest = self.interval[0] if math.isfinite(self.interval[0]) else 0.0
            return work(lambda v: force.at(v, 0.0), rest, closing)
        return 0.5 * self.linear * closing**2 + 0.25 * self.cubic * closing**4 + self.offset * closing

    @cached_property
    def steepest(self) -> tuple[float, float]:
        """(stiffness [N/m], dashpot [N s/m]) at its largest closing, where it is stiffest; of a force that is given as
        an expression at `PRESSED`, its dashpot at rest, or up to 1 m/s where that is more."""
        high = self.interval[1]
        if self.force is not None:
            v = min(high, PRESSED)
            here, before, moving = (float(self.force.at(*at, 1.0)) for at in ((v, 0.0), (0.999 * v, 0.0), (v, 1.0)))
            at_rest = float(np.imag(self.force.at(v, 1e-20j, 1.0)) * 1e20)  # the derivative by a complex step
            return (here - before) / (0.001 * v), max(moving - here, at_rest, 0.0)
        slope = self.linear + (3 * self.cubic * high**2 if self.cubic and math.isfinite(high) else 0.0)
        return slope, self.dashpot + self.root * math.sqrt(slope)


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

    Raises
    ------
    ValueError : a parameter is outside its range
    """

    name: ClassVar[str]
    citation: ClassVar[tuple[tuple[str, str], ...]] = ()
    acts_on: ClassVar[str] = ""

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
        return self.gap if self.subtracts_gap else 0.0  # fault: gap-in-closing

    @cached_property
    def _sample(self) -> tuple[Branch, ...]:
        """The branches between floors of some mass: what does not depend on it is read from them."""
        return self.branches(1.0, 1.0)

    @cached_property
    def free_below(self) -> float:
        """The closing u_left - u_right [m] below which no force acts; -inf where one always does."""
        return -math.inf if self._sample[0].closed else self.offset + self._sample[0].interval[1]

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


def remembering(what: Expression) -> tuple[tuple[int, Expression], ...]:
    """`Guard.sets` of what `MEMORY` is from then on."""
    return ((0, what),)


def opening(
    *closed: Branch, at: float = 0.0, tension_cut: bool = False, remembers: Expression | None = None
) -> tuple[Branch, ...]:
    """All branches of a law that is open below a closing, from its closed ones in the order of their closings.

    at : the closing v at which it closes [m]
    tension_cut : each branch ends where its force would pull, and goes on without force until it would push again
    remembers : what the link remembers of the instant at which it closes
    """
    sets = () if remembers is None else remembering(remembers)
    first = replace(rises_above(at, closed[0].name, impact=True, once=True), sets=sets)
    opened = Branch("open", guards=(first,), closed=False, acts=False)
    if not tension_cut:
        return opened, *closed
    pushing = (replace(b, guards=(*b.guards, begins_to_pull(_pulling(b.name)))) for b in closed)
    return opened, *pushing, *map(_without_force, closed)


def _pulling(name: str) -> str:
    return name if name == "open" else f"{name}, pulling"


def _without_force(branch: Branch) -> Branch:
    guards = (replace(guard, to=_pulling(guard.to)) for guard in branch.guards)
    return replace(branch, name=_pulling(branch.name), guards=(*guards, begins_to_push(branch.name)), acts=False)
