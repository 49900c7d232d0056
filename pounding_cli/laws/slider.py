"""A slider on a curved surface, as friction pendulums have it: it sticks until its friction is overcome."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from pounding_cli.laws.guards import SLIPS_RIGHT, START
from pounding_cli.laws.law import Behaviour, parameter, set_line
from pounding_cli.laws.storey import StoreyLaw

_K, FRICTION = range(2)
"""Parameters: stiffness of the surface W / R [N/m], friction mu W [N]."""

_LEFTWARDS = -1
"""Branch of sliding to the left."""

_STUCK = 0
"""Branch of a slider that is held where it is."""

_RIGHTWARDS = 1
"""Branch of sliding to the right."""


def next_slider_branch(e: Any, guard: int) -> None:
    """Stuck from the start and whenever the sliding stops; sliding once the friction is overcome. A slider that turns
    sticks first, and leaves that branch at the same instant where its friction does not hold it."""
    if guard == START:
        e.branch = _STUCK if e.r1 == 0.0 else (_RIGHTWARDS if e.r1 > 0.0 else _LEFTWARDS)
    elif e.branch != _STUCK:
        e.branch = _STUCK
    else:
        e.branch = _RIGHTWARDS if guard == SLIPS_RIGHT else _LEFTWARDS
    set_line(e, e.p[_K], e.c, e.branch * e.p[FRICTION], -math.inf, math.inf, e.branch)
    e.holds = 1 if e.branch == _STUCK else 0


@dataclass(frozen=True)
class Slider(StoreyLaw):
    """F = K u + friction sgn(u') while it slides. While it sticks it takes whatever force holds its base, up to where
    this differs from K u by more than the friction.

    `yield_shear` is the friction; there is no stiffness before it slides, and no hardening.
    """

    name = "slider"
    citation = (("zayas1990", "friction pendulums"),)
    behaviour = Behaviour(next_slider_branch)

    hardening: float = parameter("none", default=0.0)

    @property
    def yield_drift(self) -> float:
        """It sticks without any [m]."""
        return 0.0

    def element_parameters(self) -> tuple[float, ...]:
        """K [N/m], friction [N]."""
        return self.stiffness, self.yield_shear

    def stored_energy(self, drift: Any, shear: Any) -> Any:
        """Return the energy that the surface gives back [J]."""
        return 0.5 * self.stiffness * drift**2
