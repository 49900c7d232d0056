"""A storey whose shear turns smoothly from its initial to its post-yield stiffness (Bouc 1967, Wen 1976)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from pounding_cli.laws.guards import CROSSES, HIGH, START
from pounding_cli.laws.law import Behaviour, parameter, set_line
from pounding_cli.laws.storey import StoreyLaw, energy_in_two_springs

_K, _LIMIT, _A, _EXPONENT, _GAMMA = range(5)
"""Parameters: stiffness [N/m], yield drift [m], post-yield over initial stiffness, n and gamma [-]."""

_Z = 0
"""History variable: hysteretic part of the shear over its largest value [-], -1 to 1."""

_ELASTIC, _RISING, _RISING_BELOW, _FALLING, _FALLING_BELOW = range(5)
"""Branches: from rest until z counts; then by the way of the drift, BELOW where z is below zero."""

NEGLIGIBLE_SHARE = 1e-14
"""Part of the yield shear that the first, elastic branch leaves out."""


def next_bouc_wen_branch(e: Any, guard: int) -> None:
    """Elastic from rest; then by the signs of the rate and of z, which a branch holds."""
    k = e.p[_K]
    limit = e.p[_LIMIT]
    if guard == START:  # z = D / Dy but for |z|^(n + 1)
        counts = limit * NEGLIGIBLE_SHARE ** (1.0 / (e.p[_EXPONENT] + 1.0))
        e.branch = _ELASTIC
        set_line(e, k, e.c, 0.0, -counts, counts)
        return
    if e.branch == _ELASTIC:
        e.h[_Z] = e.v1 / limit
        e.branch = _RISING if guard == HIGH else _FALLING_BELOW
    elif guard == CROSSES:
        e.branch += 1 if e.branch == _RISING or e.branch == _FALLING else -1
    else:  # the drift turns
        e.branch += 2 if e.branch <= _RISING_BELOW else -2
    set_line(e, e.p[_A] * k, e.c, 0.0, -math.inf, math.inf, 1 if e.branch <= _RISING_BELOW else -1)
    e.smooth = 1
    e.crosses = 1 if e.branch == _RISING or e.branch == _FALLING else -1


def hysteretic_force(e: Any, v: float, r: float) -> float:
    """(1 - a) Vy z [N]."""
    return (1.0 - e.p[_A]) * e.p[_K] * e.p[_LIMIT] * e.h[_Z]


def hysteretic_rate(e: Any, r: float, z: float) -> float:
    """z' [1/s]. The signs are those of the branch: a trial step may go beyond its end."""
    if e.branch == _ELASTIC:
        return r / e.p[_LIMIT]
    rising = 1.0 if e.branch <= _RISING_BELOW else -1.0
    positive = 1.0 if e.branch == _RISING or e.branch == _FALLING else -1.0
    size = positive * z
    power = abs(size) ** e.p[_EXPONENT]
    if size < 0.0 and e.p[_EXPONENT] % 2.0 == 1.0:
        power = -power
    return r / e.p[_LIMIT] * (1.0 - power * ((1.0 - e.p[_GAMMA]) * rising * positive + e.p[_GAMMA]))


@dataclass(frozen=True)
class BoucWen(StoreyLaw):
    """F = a k D + (1 - a) Vy z with Dy z' = D' (1 - |z|^n (beta sgn(z D') + gamma)), beta + gamma = 1."""

    name = "bouc-wen"
    example = "{storeys: 4, period: 0.9 s, storey_law: bouc-wen, wen_exponent: 1, wen_gamma: 0.5}"
    citation = (
        ("bouc1967", "smooth hysteresis of storeys"),
        ("wen1976", "smooth hysteresis of storeys, with the exponent n"),
    )
    behaviour = Behaviour(next_bouc_wen_branch, hysteretic_force, hysteretic_rate)

    wen_exponent: float = parameter(
        "exponent n, 1 to 20: how sharply the storey turns from the initial to the post-yield stiffness",
        low=1.0,
        high=20.0,
        open_high=False,
        default=2.0,
    )
    wen_gamma: float = parameter(
        "gamma; beta = 1 - gamma. Unloading is straight at 0.5, stiffer below, softer above",
        low=-1.0,
        high=0.99,
        open_high=False,
        default=0.5,
    )

    def element_parameters(self) -> tuple[float, ...]:
        """As the parameters above."""
        return self.stiffness, self.yield_drift, self.hardening, self.wen_exponent, self.wen_gamma

    def stored_energy(self, drift: Any, shear: Any) -> Any:
        """In two springs: a k under the drift, (1 - a) k under its elastic part Dy z."""
        return energy_in_two_springs(self, drift, shear)
