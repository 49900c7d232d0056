"""Floors that strike with a force that grows as the closing to the power 1.5 (Hertz): without damping, with one that
takes energy all the time (Muthukumar & DesRoches), and with one during the approach (Jankowski)."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from pounding_cli.laws.guards import FASTER, LEVELS, LOW, SLOWER, START
from pounding_cli.laws.law import REFERENCE_CLOSING, Behaviour, LinkLaw, parameter, set_line, set_open
from pounding_cli.laws.pounding import reduced_mass

HERTZ_EXPONENT = 1.5
"""Of the closing [-]."""

MIN_RESTITUTION = 0.01
"""Below this the damping of `HertzDamp` grows as 1 / e, and does not apply to floors of buildings."""

DAMPING_FORMULA = "formula of the damping: `exact` gives the wanted restitution, the others are published formulas"
"""What `damping_formula` is."""


class HertzDamping(StrEnum):
    """Source of the damping of `HertzDamp`: the coefficient of restitution that comes out, or a formula."""

    EXACT = "exact"
    MUTHUKUMAR = "muthukumar"
    YE = "ye"

    def ratio(self, restitution: float) -> float:
        """zeta [-] for a coefficient of restitution e, 0 < e <= 1.

        exact : the root of ln((1 + zeta) / (1 - e zeta)) = zeta (1 + e), so that e comes out
        muthukumar : 3 (1 - e^2) / 4 (Muthukumar & DesRoches 2006)
        ye : 8 (1 - e) / (5 e) (Ye, Li & Zhu 2009)
        """
        if self is HertzDamping.MUTHUKUMAR:
            return 0.75 * (1.0 - restitution**2)
        if self is HertzDamping.YE:
            return 1.6 * (1.0 - restitution) / restitution
        return _exact(restitution)


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    """Return the zero of a function of one sign at `low` and the other at `high`."""
    from scipy.optimize import brentq

    return float(brentq(function, low, high, xtol=1e-300, rtol=1e-14))


@functools.lru_cache(maxsize=256)
def _exact(restitution: float) -> float:
    """The root above zero. With y = -ln(1 - e zeta) it is that of ln(1 + zeta) + y = zeta (1 + e), where nothing is
    lost for a small e; for an e near one, that of its first two powers of zeta."""
    e = restitution
    if 1.0 - e < 1e-4:
        return 1.5 * (1.0 - e) / (1.0 - e + e**2)

    def missing(y: float) -> float:
        zeta = -math.expm1(-y) / e
        return math.log1p(zeta) + y - zeta * (1.0 + e)

    return -math.expm1(-_root(missing, 0.75 * (1.0 - e) * e, (1.0 + e) / e)) / e


_K, _ZETA = range(2)
"""Parameters: k_h [N/m^1.5] and damping factor zeta [-]."""

_FASTEST = 0
"""History variable of a damped contact: largest approach speed so far, v0 [m/s]."""

MIN_APPROACH_SPEED = 1e-12
"""An approach below this speed is rounding: of floors that move alike [m/s]."""

_OPEN, _GAINING, _DAMPED, _CUT = range(4)
"""Branches: floors that approach ever faster, so that v0 is the speed; that do not; whose force would pull."""


def next_hertz_branch(e: Any, guard: int) -> None:
    """Open and in contact."""
    if guard == START or guard == LOW:
        set_open(e)
        return
    e.branch = 1
    set_line(e, 0.0, 0.0, 0.0, 0.0, math.inf)
    e.smooth = 1


def hertz_force(e: Any, v: float, r: float) -> float:
    """k_h v^1.5 [N]."""
    return e.p[_K] * v * math.sqrt(v) if v > 0.0 else 0.0


def next_damped_branch(e: Any, guard: int) -> None:
    """Open; gaining; damped; cut."""
    if guard == START or guard == LOW:
        set_open(e)
        return
    if guard == LEVELS:
        e.h[_FASTEST] = e.r1
    if e.branch == _OPEN or (guard == FASTER and e.branch == _DAMPED):
        e.branch = _GAINING
    elif e.branch == _DAMPED and guard == SLOWER:
        e.branch = _CUT
    else:
        e.branch = _DAMPED
    set_line(e, 0.0, 0.0, 0.0, 0.0, math.inf)
    e.smooth = 1
    if e.branch == _GAINING:
        e.levels = 1
    elif e.branch == _DAMPED:
        e.fast = e.h[_FASTEST]
        if e.p[_ZETA] > 0.0:
            e.slow = -e.h[_FASTEST] / e.p[_ZETA]
    else:
        e.fast = -e.h[_FASTEST] / e.p[_ZETA]
        e.acts = e.smooth = 0


def damped_force(e: Any, v: float, r: float) -> float:
    """k_h v^1.5 (1 + zeta v' / v0) [N]."""
    if v <= 0.0:
        return 0.0
    spring = e.p[_K] * v * math.sqrt(v)
    return spring * (1.0 + e.p[_ZETA] * (1.0 if e.branch == _GAINING else r / max(e.h[_FASTEST], MIN_APPROACH_SPEED)))


@dataclass(frozen=True)
class HertzSpring(LinkLaw):
    """Base of the laws of a Hertz contact: F = k_h v^1.5 for v > 0 but for damping.

    v is the closing less the gap.
    """

    subtracts_gap = True
    scaled_parameters = ("hertz_stiffness",)

    hertz_stiffness: float = parameter("stiffness k_h of the contact", "N/m^1.5", open_low=True)

    def stored_energy(self, closing: float, hertz_force: float) -> float:
        """k_h v^2.5 / 2.5 [J]."""
        return self.hertz_stiffness * max(closing - self.offset, 0.0) ** (HERTZ_EXPONENT + 1) / (HERTZ_EXPONENT + 1)

    @property
    def max_slopes(self) -> tuple[float, float]:
        """1.5 k_h sqrt(v) at a closing of `REFERENCE_CLOSING`."""
        return HERTZ_EXPONENT * self.hertz_stiffness * REFERENCE_CLOSING ** (HERTZ_EXPONENT - 1), 0.0


@dataclass(frozen=True)
class Hertz(HertzSpring):
    """F = k_h v^1.5 for v > 0. It takes no energy."""

    name = "hertz"
    example = "{link: hertz, gap: 2 cm, hertz_stiffness: 2e9 N/m^1.5}"
    citation = (("muthukumar2006", "the Hertz contact"),)
    behaviour = Behaviour(next_hertz_branch, hertz_force)

    def element_parameters(self, left_mass: float, right_mass: float) -> tuple[float, ...]:
        """k_h [N/m^1.5]."""
        return (self.hertz_stiffness,)


@dataclass(frozen=True)
class HertzDamp(HertzSpring):
    """F = k_h v^1.5 (1 + zeta v' / v0), not below zero, for v > 0.

    v0 is the largest approach speed so far in the present contact: for a blow the speed at which it begins, and above
    zero for floors that begin to press from rest.
    """

    name = "hertz-damp"
    example = "{link: hertz-damp, gap: 2 cm, hertz_stiffness: 2e9 N/m^1.5, restitution: 0.6}"
    citation = (
        ("muthukumar2006", "the Hertz contact with damping"),
        ("ye2009", "its damping from the coefficient of restitution"),
    )
    path_dependent = True
    tension_cut = True
    behaviour = Behaviour(next_damped_branch, damped_force)

    restitution: float = parameter("coefficient of restitution e", low=MIN_RESTITUTION, high=1.0, open_high=False)
    damping_formula: HertzDamping = parameter(DAMPING_FORMULA, default=HertzDamping.EXACT)

    @property
    def damping_factor(self) -> float:
        """zeta [-]."""
        return self.damping_formula.ratio(self.restitution)

    def element_parameters(self, left_mass: float, right_mass: float) -> tuple[float, ...]:
        """k_h [N/m^1.5], zeta [-]."""
        return self.hertz_stiffness, self.damping_factor


_DASHPOT = 1
"""Parameter of Jankowski's contact besides k_h: dashpot 2 xi sqrt(k_h m') of v^0.25 v'."""

_APPROACH = 1
"""Branch of floors that press each other further, in Jankowski's contact."""

_RELEASE = 2
"""Branch of floors that move apart again."""


def next_jankowski_branch(e: Any, guard: int) -> None:
    """Open; approach, with the dashpot; release, without."""
    if guard == START or guard == LOW:
        set_open(e)
        return
    e.branch = _RELEASE if guard == SLOWER else _APPROACH
    set_line(e, 0.0, 0.0, 0.0, 0.0, math.inf, 1 if e.branch == _APPROACH else -1)
    e.smooth = 1


def jankowski_force(e: Any, v: float, r: float) -> float:
    """k_h v^1.5, and the dashpot during the approach [N]."""
    if v <= 0.0:
        return 0.0
    root = math.sqrt(v)
    spring = e.p[_K] * v * root
    return spring + e.p[_DASHPOT] * math.sqrt(root) * r if e.branch == _APPROACH else spring


class JankowskiDamping(StrEnum):
    """Source of the damping of `Jankowski`: the coefficient of restitution that comes out, or his formula."""

    EXACT = "exact"
    JANKOWSKI = "jankowski"

    def ratio(self, restitution: float) -> float:
        """xi [-] for a coefficient of restitution e, 0 < e <= 1.

        exact : the root of `loss_of`, so that e comes out
        jankowski : 9 sqrt(5) (1 - e^2) / (2 e (e (9 pi - 16) + 16)) (Jankowski 2006)
        """
        e = restitution
        if self is JankowskiDamping.JANKOWSKI:
            return 4.5 * math.sqrt(5.0) * (1.0 - e**2) / (e * (e * (9.0 * math.pi - 16.0) + 16.0))
        return _exact_jankowski(e)


def restitution_loss(ratio: float) -> float:
    """-ln e of the coefficient of restitution e that a damping ratio xi >= 0 gives two free masses.

    With s = v^1.25 the approach is that of a damped oscillator, m' v' dv' = -0.8 (k s + 2 xi sqrt(k m') v') ds, of the
    damping ratio b = sqrt(0.8) xi, and the release gives back what its spring then holds: e = exp(-p cot p), cos p = b.
    """
    b = math.sqrt(0.8) * ratio
    if b == 1.0:
        return 1.0
    sine = math.sqrt(abs((1.0 - b) * (1.0 + b)))
    return b / sine * (math.acos(b) if b < 1.0 else math.acosh(b))


@functools.lru_cache(maxsize=256)
def _exact_jankowski(restitution: float) -> float:
    """The xi of which `loss_of` is -ln e."""
    loss = -math.log(restitution)
    return _root(lambda ratio: restitution_loss(ratio) - loss, 0.0, math.exp(loss + 1.0)) if loss else 0.0


@dataclass(frozen=True)
class Jankowski(HertzSpring):
    """F = k_h v^1.5 + 2 xi sqrt(k_h sqrt(v) m') v' while the floors approach, k_h v^1.5 while they part, for v > 0.

    m' is the reduced mass of the floors.
    """

    name = "jankowski"
    example = "{link: jankowski, gap: 2 cm, hertz_stiffness: 2e9 N/m^1.5, restitution: 0.6}"
    citation = (
        ("jankowski2005", "the Hertz contact with damping during the approach"),
        ("jankowski2006", "his formula for its damping from the coefficient of restitution"),
    )
    path_dependent = True
    behaviour = Behaviour(next_jankowski_branch, jankowski_force)

    restitution: float = parameter("coefficient of restitution e", low=MIN_RESTITUTION, high=1.0, open_high=False)
    damping_formula: JankowskiDamping = parameter(DAMPING_FORMULA, default=JankowskiDamping.EXACT)

    @property
    def damping_ratio(self) -> float:
        """xi [-]."""
        return self.damping_formula.ratio(self.restitution)

    def element_parameters(self, left_mass: float, right_mass: float) -> tuple[float, ...]:
        """k_h, and 2 xi sqrt(k_h m')."""
        mass = reduced_mass(left_mass, right_mass)
        return self.hertz_stiffness, 2.0 * self.damping_ratio * math.sqrt(self.hertz_stiffness * mass)
