"""A storey whose shear turns smoothly from its initial to its post-yield stiffness (Bouc 1967, Wen 1976)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from pounding_cli.laws.law import parameter
from pounding_cli.laws.program import DRIFT, RATE, Expression, memory, whole_power
from pounding_cli.laws.storey import (
    StoreyBranch,
    StoreyLaw,
    flowing_falls_below,
    flowing_rises_above,
    turns_down,
    turns_up,
)

Z = memory(0)
"""Hysteretic part of the shear over its largest value [-], -1 to 1."""

FULL = 1.0 - 1e-14
"""From here on z counts as 1: what is left of it decays without end, ever faster compared with a step."""


@dataclass(frozen=True)
class BoucWen(StoreyLaw):
    """F = a k D + (1 - a) Vy z with Dy z' = D' (1 - |z|^n (beta sgn(z D') + gamma)), beta + gamma = 1."""

    name: ClassVar[str] = "bouc-wen"
    citation: ClassVar[tuple[tuple[str, str], ...]] = (
        ("bouc1967", "smooth hysteresis of storeys"),
        ("wen1976", "smooth hysteresis of storeys, with the exponent n"),
    )

    instead: ClassVar[Mapping[str, str]] = {
        "wen_beta": "beta = 1 - gamma, so that the storey's stiffness and strength stay its own: write `wen_gamma`"
    }

    wen_exponent: int = parameter(
        "exponent n, 1 to 20: how sharply the storey turns from the initial to the post-yield stiffness",
        low=1.0,
        high=20.0,
        open_high=False,
        default=2,
    )
    wen_gamma: float = parameter(
        "gamma; beta = 1 - gamma. Unloading is straight at 0.5, stiffer below, softer above",
        low=-1.0,
        high=0.99,
        open_high=False,
        default=0.5,
    )

    def branches(self) -> tuple[StoreyBranch, ...]:
        """By the ways of drift and shear: rising and falling while z is positive, and while it is negative; rising and
        falling along the line that z = 1 or -1 leaves."""
        k = self.stiffness
        if not self.can_yield:
            return (StoreyBranch("elastic", k, lost=0.0, stored=0.5 * k * DRIFT * DRIFT),)
        return (
            self._bend("rising, z > 0", 1.0, 1.0, turns_down("falling, z > 0"), self._fills(1.0)),
            self._bend("falling, z > 0", 1.0, -1.0, turns_up("rising, z > 0"), self._empties(1.0)),
            self._bend("falling, z < 0", -1.0, -1.0, turns_up("rising, z < 0"), self._fills(-1.0)),
            self._bend("rising, z < 0", -1.0, 1.0, turns_down("falling, z < 0"), self._empties(-1.0)),
            self._line("yields up", 1.0, turns_down("falling, z > 0")),
            self._line("yields down", -1.0, turns_up("rising, z < 0")),
        )

    def _bend(self, name: str, sign: float, way: float, *guards) -> StoreyBranch:
        """A branch on which z flows: its sign, and the way of the drift."""
        factor = (1.0 - self.wen_gamma) * sign * way + self.wen_gamma
        power = whole_power(sign * Z, self.wen_exponent)
        flow = (1.0 / self.yield_drift) * (RATE * (1.0 - factor * power))
        return StoreyBranch(
            name, self.hardening * self.stiffness, self.plateau * Z, guards, lost=0.0, stored=self._stored, flow=flow
        )

    def _line(self, name: str, sign: float, *guards) -> StoreyBranch:
        offset = sign * self.plateau
        return StoreyBranch(name, self.hardening * self.stiffness, offset, guards, lost=offset, stored=self._stored)

    @property
    def _stored(self) -> Expression:
        """In two springs side by side: a k under the drift, (1 - a) k under its elastic part Dy z."""
        k, a = self.stiffness, self.hardening
        return (0.5 * a * k) * DRIFT**2 + (0.5 * self.plateau * self.yield_drift) * Z**2

    def _fills(self, sign: float):
        """z comes to its largest value."""
        guard = flowing_rises_above if sign > 0 else flowing_falls_below
        return guard(sign * FULL, "yields up" if sign > 0 else "yields down", (0, 0.0 * Z + sign))

    def _empties(self, sign: float):
        """z changes its sign."""
        guard = flowing_falls_below if sign > 0 else flowing_rises_above
        return guard(0.0, "falling, z < 0" if sign > 0 else "rising, z > 0", (0, 0.0 * Z))
