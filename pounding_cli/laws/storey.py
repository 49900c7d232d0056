"""What a law of storeys declares: branches that are straight in the drift, where each ends, what is remembered.

A storey acts on its drift D. On one branch its shear is
    F = stiffness D + offset,
each coefficient a number plus a multiple of one of `program.MEMORIES` memories. A branch ends at a `Guard`: where the
drift passes a value, its rate changes sign, or the shear does. What is remembered of an event may be any expression of
the drift, the rate and the memories, so that a reloading line can aim at the largest drift so far. On a branch with a
`flow` the first memory changes all the time, so that the shear need not be straight in the drift."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

from pounding_cli.laws.law import Guard, Law, Quantity, parameter
from pounding_cli.laws.program import DRIFT, Expression


@dataclass(frozen=True)
class StoreyBranch:
    """One straight piece of a law.

    Parameters
    ----------
    name : in words
    stiffness, offset : of the shear above [N/m, N]
    guards : where it ends, in the order in which they are asked
    lost : part of the shear whose work is lost [N], a number; None for what an unloading with the initial stiffness
        would not give back
    stored : energy that the storey holds [J], of drift and memories; None likewise: F^2 / (2 k)
    flow : rate at which the first memory changes while the branch holds [1/s], of drift, rate and memories; None where
        events alone change it. A memory that flows has no unit and is of order one; the stiffness does not hold it, nor
        does a guard of the drift. What is lost then is the work done less what is `stored` more
    """

    name: str
    stiffness: Expression | float
    offset: Expression | float = 0.0
    guards: tuple[Guard, ...] = ()
    lost: float | None = None
    stored: Expression | None = None
    flow: Expression | None = None

    @property
    def shear(self) -> Expression:
        """F [N], of `DRIFT` and memories."""
        return DRIFT * self.stiffness + self.offset

    def at(self, drift: Any, *memory: Any) -> Any:
        """Its shear [N] at drifts [m] with these memories; numbers or arrays of one shape."""
        stiffness, offset = (
            value.at(drift, 0.0, *memory) if isinstance(value, Expression) else value
            for value in (self.stiffness, self.offset)
        )
        return stiffness * drift + offset


@dataclass(frozen=True)
class StoreyLaw(Law):
    """What holds a floor to the floor below.

    Raises
    ------
    ValueError : a parameter is outside its range
    """

    acts_on: ClassVar[str] = "storey"

    stiffness: float = parameter("initial stiffness k", "N/m", open_low=True)
    yield_shear: float = parameter("yield shear Vy; inf for a storey that cannot yield", "N", open_low=True)
    hardening: float = parameter("post-yield over initial stiffness a", high=1.0)

    def may_be_endless(self, name: str) -> bool:
        """The yield shear may."""
        return name == "yield_shear"

    @property
    def yield_drift(self) -> float:
        """Vy / k [m]."""
        return self.yield_shear / self.stiffness

    @property
    def plateau(self) -> float:
        """(1 - a) Vy [N]: where the line after the yield meets zero drift."""
        return (1 - self.hardening) * self.yield_shear

    @property
    def can_yield(self) -> bool:
        """Whether it may leave its first branch."""
        return math.isfinite(self.yield_shear)

    @cached_property
    def flows(self) -> bool:
        """Whether a memory changes between events too, which only program steps (`kernels.program_step`) follow."""
        return any(branch.flow is not None for branch in self._branches)

    @property
    def softest(self) -> float:
        """The least slope of its shear beyond the yield, over k [-]."""
        return self.hardening

    @property
    def memories_at_rest(self) -> tuple[float, ...]:
        """What it remembers before anything has moved; memories not named are zero."""
        return ()

    def branches(self) -> tuple[StoreyBranch, ...]:
        """The branches; the first is the one at rest."""
        raise NotImplementedError

    @cached_property
    def _branches(self) -> tuple[StoreyBranch, ...]:
        return self.branches()

    def shear(self, branch: int, drift: Any, *memory: Any) -> Any:
        """Shear [N] on a branch, by its place, at drifts [m] with these memories; numbers or arrays of one shape."""
        return self._branches[branch].at(drift, *memory)

    def stored(self, branch: int, drift: Any, *memory: Any) -> Any:
        """Energy that the storey holds [J] on a branch at drifts [m] with these memories."""
        stored = self._branches[branch].stored
        if stored is not None:
            return stored.at(drift, 0.0, *memory)
        return 0.5 * self.shear(branch, drift, *memory) ** 2 / self.stiffness


def drift_rises_above(
    at: float, to: str, of_memory: float = 0.0, memory: int = 0, *sets: tuple[int, Expression]
) -> Guard:
    """The drift rises above `at` [m] plus a multiple of a memory."""
    return Guard(Quantity.CLOSING, at, -1.0, to, of_memory=of_memory, memory=memory, sets=sets)


def drift_falls_below(
    at: float, to: str, of_memory: float = 0.0, memory: int = 0, *sets: tuple[int, Expression]
) -> Guard:
    """The drift falls below it."""
    return Guard(Quantity.CLOSING, at, 1.0, to, of_memory=of_memory, memory=memory, sets=sets)


def turns_down(to: str, *sets: tuple[int, Expression]) -> Guard:
    """The drift turns back from growing."""
    return Guard(Quantity.RATE, 0.0, 1.0, to, sets=sets)


def turns_up(to: str, *sets: tuple[int, Expression]) -> Guard:
    """The drift turns back from falling."""
    return Guard(Quantity.RATE, 0.0, -1.0, to, sets=sets)


def flowing_rises_above(at: float, to: str, *sets: tuple[int, Expression]) -> Guard:
    """The memory that flows rises above `at`."""
    return Guard(Quantity.FLOWING, at, -1.0, to, sets=sets)


def flowing_falls_below(at: float, to: str, *sets: tuple[int, Expression]) -> Guard:
    """The memory that flows falls below `at`."""
    return Guard(Quantity.FLOWING, at, 1.0, to, sets=sets)


def shear_falls_below_zero(to: str, *sets: tuple[int, Expression]) -> Guard:
    """The shear changes its sign to minus."""
    return Guard(Quantity.FORCE, 0.0, 1.0, to, sets=sets)


def shear_rises_above_zero(to: str, *sets: tuple[int, Expression]) -> Guard:
    """The shear changes its sign to plus."""
    return Guard(Quantity.FORCE, 0.0, -1.0, to, sets=sets)
