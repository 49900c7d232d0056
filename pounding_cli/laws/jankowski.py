"""Floors that strike with a Hertz spring and a dashpot that acts while they approach (Jankowski)."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, ClassVar

from pounding_cli.laws.dashpot import reduced_mass
from pounding_cli.laws.guards import LOW, SLOWER, START
from pounding_cli.laws.hertz import DAMPING_FORMULA, LEAST_RESTITUTION, HertzSpring
from pounding_cli.laws.law import PRESSED, Behaviour, line, opened, parameter

K, DASHPOT = range(2)
"""Parameters: k_h [N/m^1.5], dashpot 2 xi sqrt(k_h m') of v^0.25 v'."""

OPEN, APPROACH, RELEASE = range(3)
"""Branches."""


def next_branch(e: Any, guard: int) -> None:
    """Open; approach, with the dashpot; release, without."""
    if guard == START or guard == LOW:
        opened(e)
        return
    e.branch = RELEASE if guard == SLOWER else APPROACH
    line(e, 0.0, 0.0, 0.0, 0.0, math.inf)
    e.smooth = 1
    if e.branch == APPROACH:
        e.slow = 0.0
    else:
        e.fast = 0.0


def force(e: Any, v: float, r: float) -> float:
    """k_h v^1.5, and the dashpot during the approach [N]."""
    if v <= 0.0:
        return 0.0
    root = math.sqrt(v)
    spring = e.p[K] * v * root
    return spring + e.p[DASHPOT] * math.sqrt(root) * r if e.branch == APPROACH else spring


class JankowskiDamping(StrEnum):
    """Where the damping of `Jankowski` comes from: the coefficient of restitution that comes out, or his formula."""

    EXACT = "exact"
    JANKOWSKI = "jankowski"

    def ratio(self, restitution: float) -> float:
        """xi [-] for a coefficient of restitution e, 0 < e <= 1.

        exact : the root of `restitution_of`, so that e comes out
        jankowski : 9 sqrt(5) (1 - e^2) / (2 e (e (9 pi - 16) + 16)) (Jankowski 2006)
        """
        e = restitution
        if self is JankowskiDamping.JANKOWSKI:
            return 4.5 * math.sqrt(5.0) * (1.0 - e**2) / (e * (e * (9.0 * math.pi - 16.0) + 16.0))
        return _exact(e)


def restitution_of(ratio: float) -> float:
    """Coefficient of restitution [-] that a damping ratio xi >= 0 gives two free masses.

    With s = v^1.25 the approach is that of a damped oscillator, m' v' dv' = -0.8 (k s + 2 xi sqrt(k m') v') ds, of the
    damping ratio b = sqrt(0.8) xi, and the release gives back what its spring then holds: e = exp(-p cot p), cos p = b.
    """
    b = math.sqrt(0.8) * ratio
    if b < 1.0:
        p = math.acos(b)
        return math.exp(-p / math.tan(p)) if p > 0.0 else math.exp(-1.0)
    p = math.acosh(b)
    return math.exp(-p / math.tanh(p)) if p > 0.0 else math.exp(-1.0)


@functools.lru_cache(maxsize=256)
def _exact(restitution: float) -> float:
    """The xi of which `restitution_of` is e, with p cot p = -ln e; where that is small, with pi / 2 - p."""
    loss = -math.log(restitution)
    if loss == 0.0:
        return 0.0
    from scipy.optimize import brentq

    def root(excess: Callable[[float], float], most: float) -> float:
        return float(brentq(lambda p: excess(p) - loss, 0.0, most, xtol=1e-300, rtol=1e-15))

    if loss < 0.5:
        ratio = math.sin(root(lambda q: (0.5 * math.pi - q) * math.tan(q), 1.0))
    elif loss < 1.0:
        ratio = math.cos(root(lambda p: p / math.tan(p) if p else 1.0, 0.5 * math.pi))
    else:
        ratio = math.cosh(root(lambda p: p / math.tanh(p) if p else 1.0, loss + 1.0))
    return ratio / math.sqrt(0.8)


@dataclass(frozen=True)
class Jankowski(HertzSpring):
    """F = k_h v^1.5 + 2 xi sqrt(k_h sqrt(v) m') v' while the floors approach, k_h v^1.5 while they part, for v > 0.

    m' is the reduced mass of the floors.
    """

    name: ClassVar[str] = "jankowski"
    example: ClassVar[str] = "{link: jankowski, gap: 2 cm, hertz_stiffness: 2e9 N/m^1.5, restitution: 0.6}"
    citation: ClassVar[tuple[tuple[str, str], ...]] = (
        ("jankowski2005", "the Hertz contact with damping during the approach"),
        ("jankowski2006", "his formula for its damping from the coefficient of restitution"),
    )
    remembers: ClassVar[bool] = True
    behaviour: ClassVar[Behaviour] = Behaviour(next_branch, force)

    restitution: float = parameter("coefficient of restitution e", low=LEAST_RESTITUTION, high=1.0, open_high=False)
    damping_formula: JankowskiDamping = parameter(DAMPING_FORMULA, default=JankowskiDamping.EXACT)

    @property
    def damping_ratio(self) -> float:
        """xi [-]."""
        return self.damping_formula.ratio(self.restitution)

    def numbers(self, left_mass: float, right_mass: float) -> tuple[float, ...]:
        """k_h, and 2 xi sqrt(k_h m')."""
        mass = reduced_mass(left_mass, right_mass)
        return self.hertz_stiffness, 2.0 * self.damping_ratio * math.sqrt(self.hertz_stiffness * mass)

    @property
    def damped(self) -> bool:
        """Below a restitution of 1."""
        return self.damping_ratio > 0.0

    @property
    def steepest(self) -> tuple[float, float]:
        """At a closing of `PRESSED`."""
        return super().steepest[0], self.numbers(1.0, 1.0)[1] * PRESSED**0.25
