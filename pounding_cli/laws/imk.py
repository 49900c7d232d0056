"""Storeys that lose strength (Ibarra, Medina & Krawinkler 2005).

Their backbone has a capping drift, a post-capping slope and a residual strength; reloading is peak-oriented or pinched,
and all deteriorate with the energy dissipated.
"""

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
        e.h[_TARGET] = limit
        e.h[_TARGET + 1] = -limit
        e.h[_UNLOADING] = e.p[_K]
        e.branch = _ELASTIC
        set_line(e, e.p[_K], e.c, 0.0, -limit, limit)
        return
    side = 1 if e.branch > 0 or (e.branch == _ELASTIC and guard == HIGH) else -1
    branch = abs(e.branch)
    is_outward = guard == (HIGH if side > 0 else LOW)
    if branch >= _UNLOADS:
        if is_outward:  # back on the line that it came from
            _load(e, side * (branch - _UNLOADS + 1), e.h[_SLOPE], e.h[_OFFSET], e.h[_END])
        else:  # the shear has come to zero
            _begin_excursion(e, -side)
    elif branch != _ELASTIC and not is_outward:
        _turn_back(e, side, branch)
    elif branch == _PINCHED:
        _load_towards_target(e, side)
    else:
        _take_backbone(e, side)


def _load(e: Any, branch: int, k: float, f0: float, end: float) -> None:
    """Go on along a line of stiffness k and offset f0, until the drift turns back or reaches its end."""
    _leave_line(e, k, f0)
    e.h[_SLOPE] = k
    e.h[_OFFSET] = f0
    e.h[_END] = end
    e.branch = branch
    if branch > 0:
        set_line(e, k, e.c, f0, -math.inf, end, 1)
    else:
        set_line(e, k, e.c, f0, end, math.inf, -1)


def _leave_line(e: Any, k: float, f0: float) -> None:
    """Update the work done where the present line ends and one of stiffness k and offset f0 begins."""
    e.h[_WORK] += (0.5 * (e.k - k) * e.v1 + (e.f0 - f0)) * e.v1


def _backbone(e: Any, side: int) -> tuple[float, float, float, float]:
    """Return shear at zero drift [N] and slope [N/m] of the hardening and of the post-capping line of a side.

    The slope of the post-capping line is downwards. The hardening line begins at the yield drift that belongs to its
    strength.
    """
    strength = e.h[_STRENGTH + (side < 0)]
    cap = e.h[_CAP + (side < 0)]
    plateau = e.p[_K] * e.p[_LIMIT] * strength * (1.0 - e.p[_A] * strength)
    hardening = e.p[_A] * e.p[_K] * strength
    return plateau, hardening, e.p[_CAP_SHEAR] * cap, e.p[_POST] * e.p[_K]


def _shear_at(e: Any, side: int, drift: float) -> float:
    """Return the shear of the backbone of a side [N] at a drift beyond the yield."""
    plateau, hardening, cap, falling = _backbone(e, side)
    return max(min(plateau + hardening * drift, cap - falling * drift), e.p[_RESIDUAL])


def _take_backbone(e: Any, side: int) -> None:
    """Load along the backbone of a side: hardening, falling, or at the residual strength."""
    plateau, hardening, cap, falling = _backbone(e, side)
    capping_drift = (cap - plateau) / (hardening + falling)
    residual_drift = (cap - e.p[_RESIDUAL]) / falling
    branch = side * _BACKBONE
    if side * e.v1 < capping_drift:
        _load(e, branch, hardening, side * plateau, side * capping_drift)
    elif side * e.v1 < residual_drift:
        _load(e, branch, -falling, side * cap, side * residual_drift)
    else:
        _load(e, branch, 0.0, side * e.p[_RESIDUAL], side * math.inf)


def _turn_back(e: Any, side: int, branch: int) -> None:
    """Unload from a loading branch, with the unloading stiffness that deteriorates at every reversal."""
    drift = e.v1
    unloading = e.h[_UNLOADING]
    shear = e.k * drift + e.f0
    if e.p[_BY_UNLOADING] < math.inf:
        work = e.h[_WORK] + (0.5 * e.k * drift + e.f0) * drift
        dissipated = max(work - 0.5 * shear * shear / unloading, 0.0)
        min_share = e.p[_A] + MIN_UNLOADING_SHARE * (1.0 - e.p[_A])
        loss = _loss(e, e.p[_BY_UNLOADING], dissipated)
        unloading = max((1.0 - loss) * unloading, min_share * e.p[_K])
        if branch != _BACKBONE:  # unloading with less than the line gave would give back more than was put in
            unloading = max(unloading, e.k)
        e.h[_UNLOADING] = unloading
    offset = shear - unloading * drift
    _leave_line(e, unloading, offset)
    if branch == _BACKBONE:
        e.h[_TARGET + (side < 0)] = drift
    e.branch = side * (branch + _UNLOADS - 1)
    end = -offset / unloading
    set_line(e, unloading, e.c, offset, min(drift, end), max(drift, end))


def _loss(e: Any, capacity: float, energy: float) -> float:
    """Return beta = (E / (Et - sum E))^c of an energy E that comes to those before; 1 where no more than E is left."""
    left = max(capacity - e.h[_DISSIPATED] - energy, energy)
    return (energy / left) ** e.p[_EXPONENT] if energy > 0.0 else 0.0


def _begin_excursion(e: Any, side: int) -> None:
    """Begin an excursion to this side at zero shear: deteriorate its backbone, and load towards its target."""
    drift = e.v1
    work_of_line = (0.5 * e.k * drift + e.f0) * drift
    if e.p[_DETERIORATES] > 0.0:
        _deteriorate(e, side, max(e.h[_WORK] + work_of_line, 0.0))
    e.h[_WORK] = -work_of_line
    target = side * e.h[_TARGET + (side < 0)]
    shear = _shear_at(e, side, target)
    slope = _slope(shear, target - side * drift)
    branch = _RELOADING
    end = target
    if e.p[_PINCHED_FORCE] > 0.0:
        slope = slope * e.p[_PINCHED_FORCE]
        branch = _PINCHED
        plastic_drift = max(target - shear / e.h[_UNLOADING], 0.0)
        end = max((1.0 - e.p[_PINCHED_DRIFT]) * plastic_drift, side * drift)
    _load(e, side * branch, slope, -slope * drift, side * end)


def _load_towards_target(e: Any, side: int) -> None:
    """Load along the second line of reloading, from here towards the target."""
    target = side * e.h[_TARGET + (side < 0)]
    shear = e.k * e.v1 + e.f0
    slope = _slope(_shear_at(e, side, target) - side * shear, target - side * e.v1)
    _load(e, side * _RELOADING, slope, shear - slope * e.v1, side * target)


def _slope(rise: float, run: float) -> float:
    """Return rise / run; 0 where no strength is left to aim at, wherever that is."""
    return rise / run if rise != 0.0 else 0.0


def _deteriorate(e: Any, side: int, energy: float) -> None:
    """Deteriorate strength, post-capping line and target by an excursion that dissipated `energy` [J]."""
    index = 1 if side < 0 else 0
    yield_shear = e.p[_K] * e.p[_LIMIT]
    strength_loss = _loss(e, e.p[_BY_STRENGTH], energy)
    min_strength = e.p[_RESIDUAL] / yield_shear
    strength = max((1.0 - strength_loss) * e.h[_STRENGTH + index], min_strength)
    # The post-capping line does not fall below the yield point.
    min_cap = yield_shear * (1.0 + e.p[_POST]) / e.p[_CAP_SHEAR] * strength
    cap = max((1.0 - _loss(e, e.p[_BY_CAPPING], energy)) * e.h[_CAP + index], min_cap)
    target = side * e.h[_TARGET + index]
    reloading_loss = _loss(e, e.p[_BY_RELOADING], energy)
    e.h[_STRENGTH + index] = strength
    e.h[_CAP + index] = cap
    e.h[_DISSIPATED] += energy
    if e.h[_DISSIPATED] < e.p[_BY_RELOADING]:
        target *= 1.0 + reloading_loss
    if e.p[_BY_UNLOADING] < math.inf:
        target = max(target, _nearest_target(e, side))
    e.h[_TARGET + index] = side * target


def _nearest_target(e: Any, side: int) -> float:
    """Return the drift at which a line with the unloading stiffness meets the backbone: reloading is no stiffer."""
    plateau, hardening, cap, falling = _backbone(e, side)
    start = side * e.v1
    unloading = e.h[_UNLOADING]
    if e.p[_PINCHED_FORCE] > 0.0:
        start = max(start, 0.0)
    offset = unloading * start
    on_hardening = (plateau + offset) / (unloading - hardening)
    on_post_capping = (cap + offset) / (unloading + falling)
    on_residual = (offset + e.p[_RESIDUAL]) / unloading
    return max(min(on_hardening, on_post_capping), on_residual)


NO_DETERIORATION = (1.0, 0.0, math.inf, *(math.inf,) * 4, 1.0, 0.0, 0.0, 0.0)
"""Parameters from the post-capping slope on of a storey that neither caps nor deteriorates nor pinches."""


@dataclass(frozen=True)
class PeakOrientedLaw(StoreyLaw):
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


def _capacity(owner: str) -> float:
    """Return the parameter of the energy capacity of `owner` [-]."""
    doc = f"energy capacity of {owner}, over Vy Dy; default: no deterioration"
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
        (
            "ibarra2005",
            "backbone with capping and residual strength, deterioration with the energy dissipated",
        ),
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
        """Post-capping slope over initial stiffness, negative [-]."""
        return -self.post_capping_slope

    def element_parameters(self) -> tuple[float, ...]:
        """As the parameters above."""
        unit = self.yield_shear * self.yield_drift
        relative_capacities = (
            self.strength_capacity,
            self.capping_capacity,
            self.unloading_capacity,
            self.reloading_capacity,
        )
        capacities = [unit * each if each < math.inf else math.inf for each in relative_capacities]
        capping_shear = self.yield_shear * (1.0 + self.hardening * (self.capping_ductility - 1.0))
        return (
            self.stiffness,
            self.yield_drift,
            self.hardening,
            self.post_capping_slope,
            self.residual_strength * self.yield_shear,
            capping_shear + self.post_capping_slope * self.yield_shear * self.capping_ductility,
            *capacities,
            self.deterioration_exponent,
            float(min(capacities) < math.inf),
            getattr(self, "pinching_force", 0.0),
            getattr(self, "pinching_drift", 0.0),
        )


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
