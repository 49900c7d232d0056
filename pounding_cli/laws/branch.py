"""The branches of a law: the force on each, the guards at which it ends, and what follows."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import IntEnum
from functools import cached_property

import numpy as np

from pounding_cli.laws.program import CLOSING, RATE, Expression, work

PRESSED = 0.01
"""Closing [m] at which the slope of a force that stiffens without end is taken: floors press each other by
millimetres."""


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
    return Guard(Quantity.FORCE, 0.0, 1.0, to, once=True)


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
        return bool(self.dashpot or self.root) or (self.force is not None and RATE.register in self.force.given)

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
