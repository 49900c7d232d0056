"""Storeys that lose strength: a backbone with capping drift, post-capping slope and residual strength, peak-oriented or
pinched reloading, and deterioration with the energy dissipated (Ibarra, Medina & Krawinkler 2005)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from pounding_cli.laws.guards import HIGH, LOW, START
from pounding_cli.laws.law import Behaviour, line, parameter
from pounding_cli.laws.storey import StoreyLaw

(
    K, LIMIT, A, POST, RESIDUAL, CAP_SHEAR, BY_STRENGTH, BY_CAPPING, BY_UNLOADING, BY_RELOADING, EXPONENT,
    DETERIORATES, PINCHED_FORCE, PINCHED_DRIFT,
) = range(14)  # fmt: skip
"""Parameters: stiffness [N/m], yield drift [m], post-yield and post-capping slope over initial stiffness [-], residual
strength [N], shear at which the first post-capping line meets zero drift [N]; energy capacities [J], inf where nothing
deteriorates; exponent c; 1 where anything deteriorates; kappa_F, 0 without pinching, and kappa_D [-]."""

(
    STRENGTH, _, CAP, _, TARGET, _, UNLOADING, SLOPE, OFFSET, END, TURNED, UNLOADING_OFFSET, WORK, DISSIPATED,
) = range(14)  # fmt: skip
"""History variables. Of each side, up and then down: what is left of the yield shear [-], of the shear at which the
post-capping line meets zero drift [-], and the drift that reloading aims at [m]. Unloading stiffness [N/m]. Stiffness
[N/m] and offset [N] of the line that the storey loads on, and the drift at which it ends [m]; drift at which it last
turned back [m]; offset of the unloading line [N]. Work done on the storey in this excursion, less that of the line it
is on [J]; energy dissipated in the excursions before [J]."""

ELASTIC, BACKBONE, RELOADING, PINCHED, UNLOADS = range(5)
"""Branches, up positive and down negative; unloading from one of the three lines adds `UNLOADS` - 1 to it."""

LEAST_UNLOADING = 0.05
"""Where the unloading stiffness stops to deteriorate, between the hardening stiffness (0) and the initial one (1)."""

STEEPEST = 1e6
"""Largest post-capping slope over initial stiffness [-]: a storey of that slope is brittle. A steeper one multiplies
the rounding of its drift until the energy does not close."""


def next_branch(e: Any, guard: int) -> None:
    """Elastic; then on either side the backbone, one or two lines of reloading, and unloading from each."""
    if guard == START:
        _rest(e)
        return
    side = 1 if e.branch > 0 or (e.branch == ELASTIC and guard == HIGH) else -1
    was = abs(e.branch)
    outward = guard == (HIGH if side > 0 else LOW)
    if was == ELASTIC:
        _take_backbone(e, side, e.p[LIMIT])
    elif was >= UNLOADS:
        if outward:  # back on the line that it came from
            _go_on(e, e.h[SLOPE], e.h[OFFSET])
            _load(e, side * (was - UNLOADS + 1))
        else:  # the shear has come to zero: an excursion to the other side begins
            _begin_excursion(e, -side)
    elif not outward:
        _turn_back(e, side, was)
    elif was == PINCHED:
        _aim(e, side)
    else:
        _take_backbone(e, side, e.high if side > 0 else -e.low)


def _rest(e: Any) -> None:
    """Full strength, the yield drifts, the initial stiffness."""
    k, limit = e.p[K], e.p[LIMIT]
    for i in range(4):
        e.h[STRENGTH + i] = 1.0
    e.h[TARGET], e.h[TARGET + 1], e.h[UNLOADING] = limit, -limit, k
    e.branch = ELASTIC
    line(e, k, e.c, 0.0, -limit, limit)


def _load(e: Any, branch: int) -> None:
    """On the line that is remembered, until the drift turns back or reaches its end."""
    side = 1 if branch > 0 else -1
    end = side * e.h[TARGET + (side < 0)] if abs(branch) == RELOADING else side * e.h[END]
    e.branch = branch
    if side > 0:
        line(e, e.h[SLOPE], e.c, e.h[OFFSET], -math.inf, end, side)
    else:
        line(e, e.h[SLOPE], e.c, e.h[OFFSET], -end, math.inf, side)


def _go_on(e: Any, k: float, f0: float) -> None:
    """The work done, where the present line ends and one of stiffness k and offset f0 begins."""
    if e.p[DETERIORATES] > 0.0:
        e.h[WORK] += (0.5 * (e.k - k) * e.v1 + (e.f0 - f0)) * e.v1


def _take_backbone(e: Any, side: int, drift: float) -> None:
    """The line of the backbone beyond a drift to a side: hardening, falling, or at the residual strength."""
    k, strength, cap = e.p[K], e.h[STRENGTH + (side < 0)], e.h[CAP + (side < 0)]
    capping, residual = _capping_drift(e, strength, cap), _residual_drift(e, cap)
    if drift < capping:
        slope, offset, end = e.p[A] * k * strength, _plateau(e, strength), capping
    elif drift < residual:
        slope, offset, end = -e.p[POST] * k, e.p[CAP_SHEAR] * cap, residual
    else:
        slope, offset, end = 0.0, e.p[RESIDUAL], math.inf
    _go_on(e, slope, side * offset)
    e.h[SLOPE], e.h[OFFSET], e.h[END] = slope, side * offset, side * end
    _load(e, side * BACKBONE)


def _turn_back(e: Any, side: int, was: int) -> None:
    """A reversal: the unloading stiffness deteriorates."""
    k, drift = e.p[K], e.v1
    shear = e.k * drift + e.f0
    unloading = e.h[UNLOADING]
    if e.p[BY_UNLOADING] < math.inf:
        done = e.h[WORK] + (0.5 * e.k * drift + e.f0) * drift
        spent = max(done - 0.5 * shear * shear / unloading, 0.0)
        left = 1.0 - _loss(e, e.p[BY_UNLOADING], spent, e.h[DISSIPATED] + spent)
        least = e.p[A] + LEAST_UNLOADING * (1.0 - e.p[A])
        unloading = max(left * unloading, least * k)
        if was != BACKBONE:  # unloading with less than the line gave would give back more than was put in
            unloading = max(unloading, e.k)
        e.h[UNLOADING] = unloading
    offset = shear - unloading * drift
    _go_on(e, unloading, offset)
    e.h[TURNED], e.h[UNLOADING_OFFSET] = drift, offset
    if was == BACKBONE:
        e.h[TARGET + (side < 0)] = drift
    e.branch = side * (was + UNLOADS - 1)
    if side > 0:
        line(e, unloading, e.c, offset, -offset / unloading, drift)
    else:
        line(e, unloading, e.c, offset, drift, -offset / unloading)


def _loss(e: Any, capacity: float, energy: float, dissipated: float) -> float:
    """beta = (E / (Et - sum E))^c, 1 where no more than E is left."""
    left = max(capacity - dissipated, energy)
    return (energy / left) ** e.p[EXPONENT] if energy > 0.0 else 0.0


def _begin_excursion(e: Any, side: int) -> None:
    """An excursion to this side begins at zero shear: its backbone, and the line towards the target."""
    drift = e.v1
    if e.p[DETERIORATES] > 0.0:
        _deteriorate(e, side, max(e.h[WORK] + (0.5 * e.k * drift + e.f0) * drift, 0.0))
    target = side * e.h[TARGET + (side < 0)]
    shear = _backbone(e, side, target)
    slope = _slope(shear, target - side * drift)
    if e.p[PINCHED_FORCE] > 0.0:
        slope *= e.p[PINCHED_FORCE]
        plastic = max(target - shear / e.h[UNLOADING], 0.0)
        e.h[END] = side * max((1.0 - e.p[PINCHED_DRIFT]) * plastic, side * drift)
    e.h[SLOPE], e.h[OFFSET] = slope, -slope * drift
    if e.p[DETERIORATES] > 0.0:
        e.h[WORK] = 0.5 * slope * drift * drift
    _load(e, side * (PINCHED if e.p[PINCHED_FORCE] > 0.0 else RELOADING))


def _aim(e: Any, side: int) -> None:
    """The second line of reloading, from here towards the target."""
    target = side * e.h[TARGET + (side < 0)]
    shear = e.k * e.v1 + e.f0
    slope = _slope(_backbone(e, side, target) - side * shear, target - side * e.v1)
    offset = shear - slope * e.v1
    _go_on(e, slope, offset)
    e.h[SLOPE], e.h[OFFSET], e.h[END] = slope, offset, side * target
    _load(e, side * RELOADING)


def _slope(rise: float, run: float) -> float:
    """rise / run; 0 where no strength is left to aim at, wherever that is."""
    return rise / run if rise != 0.0 else 0.0


def _deteriorate(e: Any, side: int, energy: float) -> None:
    """What an excursion that dissipated `energy` [J] leaves of strength and post-capping line, and the target."""
    at = 1 if side < 0 else 0
    dissipated = e.h[DISSIPATED] + energy
    strength, cap, target = e.h[STRENGTH + at], e.h[CAP + at], side * e.h[TARGET + at]
    if e.p[BY_STRENGTH] < math.inf:
        limit = e.p[K] * e.p[LIMIT]
        left = 1.0 - _loss(e, e.p[BY_STRENGTH], energy, dissipated)
        strength = max(left * strength, e.p[RESIDUAL] / limit)
    if e.p[BY_CAPPING] < math.inf:
        cap *= 1.0 - _loss(e, e.p[BY_CAPPING], energy, dissipated)
    # The post-capping line does not fall below the yield point.
    cap = max(cap, e.p[K] * e.p[LIMIT] * (1.0 + e.p[POST]) / e.p[CAP_SHEAR] * strength)
    if dissipated < e.p[BY_RELOADING] < math.inf:
        target *= 1.0 + _loss(e, e.p[BY_RELOADING], energy, dissipated)
    if e.p[BY_UNLOADING] < math.inf:
        target = max(target, _nearest_target(e, side, strength, cap))
    e.h[STRENGTH + at], e.h[CAP + at], e.h[TARGET + at] = strength, cap, side * target
    e.h[DISSIPATED] = dissipated


def _nearest_target(e: Any, side: int, strength: float, cap: float) -> float:
    """Where the backbone is met by a line with the unloading stiffness: reloading is no stiffer."""
    k, unloading = e.p[K], e.h[UNLOADING]
    begins = side * e.v1
    if e.p[PINCHED_FORCE] > 0.0:
        begins = max(begins, 0.0)
    reach = unloading * begins
    hardening = (_plateau(e, strength) + reach) / (unloading - e.p[A] * k * strength)
    capping = (e.p[CAP_SHEAR] * cap + reach) / (unloading + e.p[POST] * k)
    return max(min(hardening, capping), (reach + e.p[RESIDUAL]) / unloading)


def _backbone(e: Any, side: int, drift: float) -> float:
    """Shear of the backbone of a side [N] at drifts beyond the yield."""
    strength, cap = e.h[STRENGTH + (side < 0)], e.h[CAP + (side < 0)]
    hardening = _plateau(e, strength) + e.p[A] * e.p[K] * strength * drift
    capping = e.p[CAP_SHEAR] * cap - e.p[POST] * e.p[K] * drift
    return max(min(hardening, capping), e.p[RESIDUAL])


def _plateau(e: Any, strength: float) -> float:
    """The hardening line at zero drift [N]: it begins at the yield drift that belongs to its strength."""
    return e.p[K] * e.p[LIMIT] * strength * (1.0 - e.p[A] * strength)


def _capping_drift(e: Any, strength: float, cap: float) -> float:
    """Where the hardening line meets the post-capping line [m]."""
    return (e.p[CAP_SHEAR] * cap - _plateau(e, strength)) / ((e.p[A] * strength + e.p[POST]) * e.p[K])


def _residual_drift(e: Any, cap: float) -> float:
    """Where the post-capping line meets the residual strength [m]."""
    return (e.p[CAP_SHEAR] * cap - e.p[RESIDUAL]) / (e.p[POST] * e.p[K])


PLAIN = 1.0, 0.0, math.inf, math.inf, math.inf, math.inf, math.inf, 1.0, 0.0, 0.0, 0.0
"""Parameters from the post-capping slope on of a storey that neither caps nor deteriorates nor pinches."""


@dataclass(frozen=True)
class PeakOriented(StoreyLaw):
    """Bilinear backbone, unloading with the initial stiffness to zero shear, reloading in a straight line towards the
    largest drift so far on that side (Clough; stiffness-degrading or peak-oriented)."""

    name = "peak-oriented"
    example = "{storeys: 5, period: 0.6 s, storey_law: peak-oriented}"
    citation = (
        ("clough1966", "stiffness that degrades with the largest drift"),
        ("ibarra2005", "peak-oriented reloading"),
    )
    behaviour = Behaviour(next_branch)

    def numbers(self) -> tuple[float, ...]:
        """As the parameters above."""
        return *super().numbers(), *PLAIN


def _capacity(of: str) -> float:
    doc = f"energy capacity of {of}, over Vy Dy; default: no deterioration"
    return parameter(doc, open_low=True, default=math.inf, endless=True)


@dataclass(frozen=True)
class PeakOrientedImk(StoreyLaw):
    """A backbone with hardening, a capping drift, a falling line beyond it and a residual strength, which deteriorates
    with the energy dissipated; reloading in a straight line towards the largest drift so far on that side.
    """

    name = "imk-peak-oriented"
    example = (
        "{storeys: 4, period: 0.9 s, storey_law: imk-peak-oriented, capping_ductility: 4, post_capping_slope: 0.1}"
    )
    citation = (
        ("ibarra2005", "backbone with capping and residual strength, deterioration with the energy dissipated"),
    )
    behaviour = Behaviour(next_branch)

    capping_ductility: float = parameter("capping drift over yield drift", low=1.0)
    post_capping_slope: float = parameter(
        "post-capping slope over initial stiffness, as a positive number",
        open_low=True, high=STEEPEST, open_high=False,
    )  # fmt: skip
    residual_strength: float = parameter("residual strength over yield shear", high=1.0, default=0.0)
    strength_capacity: float = _capacity("the yield shear and the hardening stiffness")
    capping_capacity: float = _capacity("the post-capping line")
    unloading_capacity: float = _capacity("the unloading stiffness")
    reloading_capacity: float = _capacity("the drift that reloading aims at")
    deterioration_exponent: float = parameter(
        "exponent c of (E / (Et - sum E))^c, the deterioration by an excursion", open_low=True, default=1.0
    )

    @property
    def softest(self) -> float:
        """The post-capping slope."""
        return -self.post_capping_slope

    def numbers(self) -> tuple[float, ...]:
        """As the parameters above."""
        unit = self.yield_shear * self.yield_drift
        each = self.strength_capacity, self.capping_capacity, self.unloading_capacity, self.reloading_capacity
        capacities = [unit * capacity if capacity < math.inf else math.inf for capacity in each]
        capping = self.yield_shear * (1.0 + self.hardening * (self.capping_ductility - 1.0))
        return (
            self.stiffness, self.yield_drift, self.hardening, self.post_capping_slope,
            self.residual_strength * self.yield_shear,
            capping + self.post_capping_slope * self.yield_shear * self.capping_ductility,
            *capacities, self.deterioration_exponent, float(min(capacities) < math.inf), *self._pinching,
        )  # fmt: skip

    @property
    def _pinching(self) -> tuple[float, float]:
        """kappa_F and kappa_D; 0 and 0 without."""
        return 0.0, 0.0


@dataclass(frozen=True, kw_only=True)
class PinchingImk(PeakOrientedImk):
    """As `imk-peak-oriented`, but reloading in two straight lines: a soft one up to the break drift, then towards the
    largest drift so far on that side.
    """

    name = "imk-pinching"
    example = (
        "{storeys: 4, period: 0.9 s, storey_law: imk-pinching, capping_ductility: 4, post_capping_slope: 0.1, "
        "pinching_force: 0.3, pinching_drift: 0.6}"
    )
    citation = (("ibarra2005", "pinching; backbone with capping and residual strength, deterioration"),)

    pinching_force: float = parameter(
        "kappa_F: stiffness of the first reloading line over that of the straight one",
        high=1.0,
        open_low=True,
        open_high=False,
    )
    pinching_drift: float = parameter(
        "kappa_D: the first reloading line ends at (1 - kappa_D) times the plastic drift of the target",
        high=1.0,
        open_high=False,
    )

    @property
    def _pinching(self) -> tuple[float, float]:
        return self.pinching_force, self.pinching_drift
