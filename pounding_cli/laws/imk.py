"""Storeys that lose strength: a backbone with capping drift, post-capping slope and residual strength, peak-oriented or
pinched reloading, and deterioration with the energy dissipated (Ibarra, Medina & Krawinkler 2005)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from pounding_cli.laws.guards import HIGH, LOW, START
from pounding_cli.laws.law import Behaviour, parameter, set_line
from pounding_cli.laws.storey import StoreyLaw

(
    _K, _LIMIT, _A, _POST, _RESIDUAL, _CAP_SHEAR, _BY_STRENGTH, _BY_CAPPING, _BY_UNLOADING, _BY_RELOADING, _EXPONENT,
    _DETERIORATES, _PINCHED_FORCE, _PINCHED_DRIFT,
) = range(14)  # fmt: skip
"""Parameters: stiffness [N/m], yield drift [m], post-yield and post-capping slope over initial stiffness [-], residual
strength [N], shear at which the first post-capping line meets zero drift [N]; energy capacities [J], inf where nothing
deteriorates; exponent c; 1 where anything deteriorates; kappa_F, 0 without pinching, and kappa_D [-]."""

_STRENGTH, _, _CAP, _, _TARGET, _, _UNLOADING, _SLOPE, _OFFSET, _END, _WORK, _DISSIPATED = range(12)
"""History variables. Of each side, up and then down: what is left of the yield shear [-], of the shear at which the
post-capping line meets zero drift [-], and the drift that reloading aims at [m]. Unloading stiffness [N/m]. Stiffness
[N/m] and offset [N] of the line that the storey loads on, and the drift at which it ends [m]. Work done on the storey
in this excursion, less that of the line it is on [J]; energy dissipated in the excursions before [J]."""

_ELASTIC, _BACKBONE, _RELOADING, _PINCHED, _UNLOADS = range(5)
"""Branches, up positive and down negative; unloading from one of the three lines adds `_UNLOADS` - 1 to it."""

MIN_UNLOADING_SHARE = 0.05
"""Where the unloading stiffness stops to deteriorate, between the hardening stiffness (0) and the initial one (1)."""

MAX_POST_CAPPING_SLOPE = 1e6
"""Largest post-capping slope over initial stiffness [-]: a storey of that slope is brittle. A steeper one multiplies
the rounding of its drift until the energy does not close."""


def next_peak_oriented_branch(e: Any, guard: int) -> None:
    """Elastic; then on either side the backbone, one or two lines of reloading, and unloading from each."""
    if guard == START:
        limit = e.p[_LIMIT]
        for i in range(4):
            e.h[_STRENGTH + i] = 1.0
        e.h[_TARGET], e.h[_TARGET + 1], e.h[_UNLOADING] = limit, -limit, e.p[_K]
        e.branch = _ELASTIC
        set_line(e, e.p[_K], e.c, 0.0, -limit, limit)
        return
    side = 1 if e.branch > 0 or (e.branch == _ELASTIC and guard == HIGH) else -1
    was, outward = abs(e.branch), guard == (HIGH if side > 0 else LOW)
    if was >= _UNLOADS:
        if outward:  # back on the line that it came from
            _load(e, side * (was - _UNLOADS + 1), e.h[_SLOPE], e.h[_OFFSET], e.h[_END])
        else:  # the shear has come to zero
            _begin_excursion(e, -side)
    elif was != _ELASTIC and not outward:
        _turn_back(e, side, was)
    elif was == _PINCHED:
        _aim(e, side)
    else:
        _take_backbone(e, side)


def _load(e: Any, branch: int, k: float, f0: float, end: float) -> None:
    """Go on along a line of stiffness k and offset f0, until the drift turns back or reaches its end."""
    _leave_line(e, k, f0)
    e.h[_SLOPE], e.h[_OFFSET], e.h[_END] = k, f0, end
    e.branch = branch
    low, high, way = (-math.inf, end, 1) if branch > 0 else (end, math.inf, -1)
    set_line(e, k, e.c, f0, low, high, way)


def _leave_line(e: Any, k: float, f0: float) -> None:
    """The work done, where the present line ends and one of stiffness k and offset f0 begins."""
    e.h[_WORK] += (0.5 * (e.k - k) * e.v1 + (e.f0 - f0)) * e.v1


def _backbone(e: Any, side: int) -> tuple[float, float, float, float]:
    """Shear at zero drift [N] and slope [N/m] of the hardening line of a side, and of the post-capping line, whose
    slope is downwards. The hardening line begins at the yield drift that belongs to its strength."""
    strength, cap = e.h[_STRENGTH + (side < 0)], e.h[_CAP + (side < 0)]
    plateau = e.p[_K] * e.p[_LIMIT] * strength * (1.0 - e.p[_A] * strength)
    return plateau, e.p[_A] * e.p[_K] * strength, e.p[_CAP_SHEAR] * cap, e.p[_POST] * e.p[_K]


def _shear_at(e: Any, side: int, drift: float) -> float:
    """Shear of the backbone of a side [N] at a drift beyond the yield."""
    plateau, hardening, cap, falling = _backbone(e, side)
    return max(min(plateau + hardening * drift, cap - falling * drift), e.p[_RESIDUAL])


def _take_backbone(e: Any, side: int) -> None:
    """The line of the backbone beyond here to a side: hardening, falling, or at the residual strength."""
    plateau, hardening, cap, falling = _backbone(e, side)
    capping, residual = (cap - plateau) / (hardening + falling), (cap - e.p[_RESIDUAL]) / falling
    if side * e.v1 < capping:
        slope, offset, end = hardening, plateau, capping
    elif side * e.v1 < residual:
        slope, offset, end = -falling, cap, residual
    else:
        slope, offset, end = 0.0, e.p[_RESIDUAL], math.inf
    _load(e, side * _BACKBONE, slope, side * offset, side * end)


def _turn_back(e: Any, side: int, was: int) -> None:
    """A reversal: the unloading stiffness deteriorates."""
    drift = e.v1
    unloading = e.h[_UNLOADING]
    shear = e.k * drift + e.f0
    if e.p[_BY_UNLOADING] < math.inf:
        done = e.h[_WORK] + (0.5 * e.k * drift + e.f0) * drift
        spent = max(done - 0.5 * shear * shear / unloading, 0.0)
        least = e.p[_A] + MIN_UNLOADING_SHARE * (1.0 - e.p[_A])
        unloading = max((1.0 - _loss(e, e.p[_BY_UNLOADING], spent)) * unloading, least * e.p[_K])
        if was != _BACKBONE:  # unloading with less than the line gave would give back more than was put in
            unloading = max(unloading, e.k)
        e.h[_UNLOADING] = unloading
    offset = shear - unloading * drift
    _leave_line(e, unloading, offset)
    if was == _BACKBONE:
        e.h[_TARGET + (side < 0)] = drift
    e.branch = side * (was + _UNLOADS - 1)
    end = -offset / unloading
    set_line(e, unloading, e.c, offset, min(drift, end), max(drift, end))


def _loss(e: Any, capacity: float, energy: float) -> float:
    """beta = (E / (Et - sum E))^c of an energy E that comes to those before, 1 where no more than E is left."""
    left = max(capacity - e.h[_DISSIPATED] - energy, energy)
    return (energy / left) ** e.p[_EXPONENT] if energy > 0.0 else 0.0


def _begin_excursion(e: Any, side: int) -> None:
    """An excursion to this side begins at zero shear: its backbone, and the line towards the target."""
    drift = e.v1
    done = (0.5 * e.k * drift + e.f0) * drift
    if e.p[_DETERIORATES] > 0.0:
        _deteriorate(e, side, max(e.h[_WORK] + done, 0.0))
    e.h[_WORK] = -done
    target = side * e.h[_TARGET + (side < 0)]
    shear = _shear_at(e, side, target)
    slope, branch, end = _slope(shear, target - side * drift), _RELOADING, target
    if e.p[_PINCHED_FORCE] > 0.0:
        slope, branch = slope * e.p[_PINCHED_FORCE], _PINCHED
        plastic = max(target - shear / e.h[_UNLOADING], 0.0)
        end = max((1.0 - e.p[_PINCHED_DRIFT]) * plastic, side * drift)
    _load(e, side * branch, slope, -slope * drift, side * end)


def _aim(e: Any, side: int) -> None:
    """The second line of reloading, from here towards the target."""
    target = side * e.h[_TARGET + (side < 0)]
    shear = e.k * e.v1 + e.f0
    slope = _slope(_shear_at(e, side, target) - side * shear, target - side * e.v1)
    _load(e, side * _RELOADING, slope, shear - slope * e.v1, side * target)


def _slope(rise: float, run: float) -> float:
    """rise / run; 0 where no strength is left to aim at, wherever that is."""
    return rise / run if rise != 0.0 else 0.0


def _deteriorate(e: Any, side: int, energy: float) -> None:
    """Deteriorate strength, post-capping line and target by an excursion that dissipated `energy` [J]."""
    index = 1 if side < 0 else 0
    yields = e.p[_K] * e.p[_LIMIT]
    strength = max((1.0 - _loss(e, e.p[_BY_STRENGTH], energy)) * e.h[_STRENGTH + index], e.p[_RESIDUAL] / yields)
    # The post-capping line does not fall below the yield point.
    least = yields * (1.0 + e.p[_POST]) / e.p[_CAP_SHEAR] * strength
    cap = max((1.0 - _loss(e, e.p[_BY_CAPPING], energy)) * e.h[_CAP + index], least)
    target = side * e.h[_TARGET + index]
    more = _loss(e, e.p[_BY_RELOADING], energy)
    e.h[_STRENGTH + index] = strength
    e.h[_CAP + index] = cap
    e.h[_DISSIPATED] += energy
    if e.h[_DISSIPATED] < e.p[_BY_RELOADING]:
        target *= 1.0 + more
    if e.p[_BY_UNLOADING] < math.inf:
        target = max(target, _nearest_target(e, side))
    e.h[_TARGET + index] = side * target


def _nearest_target(e: Any, side: int) -> float:
    """Return the drift at which a line with the unloading stiffness meets the backbone: reloading is no stiffer."""
    plateau, hardening, cap, falling = _backbone(e, side)
    begins = side * e.v1
    unloading = e.h[_UNLOADING]
    if e.p[_PINCHED_FORCE] > 0.0:
        begins = max(begins, 0.0)
    reach = unloading * begins
    nearest = min((plateau + reach) / (unloading - hardening), (cap + reach) / (unloading + falling))
    return max(nearest, (reach + e.p[_RESIDUAL]) / unloading)


NO_DETERIORATION = 1.0, 0.0, math.inf, math.inf, math.inf, math.inf, math.inf, 1.0, 0.0, 0.0, 0.0
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
    behaviour = Behaviour(next_peak_oriented_branch)

    def element_parameters(self) -> tuple[float, ...]:
        """As the parameters above."""
        return *super().element_parameters(), *NO_DETERIORATION


def _capacity(of: str) -> float:
    doc = f"energy capacity of {of}, over Vy Dy; default: no deterioration"
    return parameter(doc, open_low=True, default=math.inf, can_be_infinite=True)


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
    behaviour = Behaviour(next_peak_oriented_branch)

    capping_ductility: float = parameter("capping drift over yield drift", low=1.0)
    post_capping_slope: float = parameter(
        "post-capping slope over initial stiffness, as a positive number",
        open_low=True, high=MAX_POST_CAPPING_SLOPE, open_high=False,
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
    def min_slope_ratio(self) -> float:
        """The post-capping slope."""
        return -self.post_capping_slope

    def element_parameters(self) -> tuple[float, ...]:
        """As the parameters above."""
        unit = self.yield_shear * self.yield_drift
        each = self.strength_capacity, self.capping_capacity, self.unloading_capacity, self.reloading_capacity
        capacities = [unit * capacity if capacity < math.inf else math.inf for capacity in each]
        capping = self.yield_shear * (1.0 + self.hardening * (self.capping_ductility - 1.0))
        return (
            self.stiffness, self.yield_drift, self.hardening, self.post_capping_slope,
            self.residual_strength * self.yield_shear,
            capping + self.post_capping_slope * self.yield_shear * self.capping_ductility,
            *capacities, self.deterioration_exponent, float(min(capacities) < math.inf),
            getattr(self, "pinching_force", 0.0), getattr(self, "pinching_drift", 0.0),
        )  # fmt: skip


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
