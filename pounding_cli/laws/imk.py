"""Storeys that lose strength: a backbone with capping drift, post-capping slope and residual strength, peak-oriented or
pinched reloading, and deterioration with the energy dissipated (Ibarra, Medina & Krawinkler 2005)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

from pounding_cli.laws.law import Guard, parameter
from pounding_cli.laws.program import DRIFT, Expression, above_zero, larger, memory, positive_part, smaller
from pounding_cli.laws.storey import (
    StoreyBranch,
    StoreyLaw,
    drift_falls_below,
    drift_rises_above,
    shear_falls_below_zero,
    shear_rises_above_zero,
    turns_down,
    turns_up,
)

(
    STRENGTH, _, CAP, _, TARGET, _, UNLOADING_STIFFNESS, SLOPE, OFFSET, END, TURNED, UNLOADING_OFFSET, WORK, DISSIPATED,
) = range(14)  # fmt: skip
"""Memories. Of each side, up and then down: what is left of the yield shear [-], of the shear at which the post-capping
line meets zero drift [-], and the drift that reloading aims at [m]. Unloading stiffness [N/m]. Stiffness [N/m] and
offset [N] of the line that the storey loads on, and the drift at which it ends [m]; drift at which it last turned back
[m]; offset of the unloading line [N]. Work done on the storey in this excursion, less that of the line it is on [J];
energy dissipated in the excursions before [J]."""

FAR = 1e100
"""A drift that no storey reaches [m]: where the residual strength ends."""

Sets = tuple[tuple[int, Expression], ...]

LEAST_UNLOADING = 0.05
"""Where the unloading stiffness stops to deteriorate, between the hardening stiffness (0) and the initial one (1)."""


@dataclass(frozen=True)
class _Side:
    """Loading up (1) or down (-1). Drifts and shears are counted positive to this side."""

    sign: float

    @property
    def drift(self) -> Expression:
        return self.sign * DRIFT

    @property
    def strength(self) -> int:
        return STRENGTH + (self.sign < 0)

    @property
    def cap(self) -> int:
        return CAP + (self.sign < 0)

    @property
    def target(self) -> int:
        return TARGET + (self.sign < 0)

    @property
    def word(self) -> str:
        return "up" if self.sign > 0 else "down"

    def reaches(self, number: int, to: str, sets: Sets = ()) -> Guard:
        """The drift passes one that is remembered."""
        return (drift_rises_above if self.sign > 0 else drift_falls_below)(0.0, f"{to} {self.word}", 1.0, number, *sets)

    def turns(self, to: str, sets: Sets) -> Guard:
        """The drift turns back."""
        return (turns_down if self.sign > 0 else turns_up)(f"{to} {self.word}", *sets)

    def crosses(self, to: str, sets: Sets) -> Guard:
        """The shear takes the sign of this side."""
        return (shear_rises_above_zero if self.sign > 0 else shear_falls_below_zero)(f"{to} {self.word}", *sets)


UP, DOWN = _Side(1.0), _Side(-1.0)


@dataclass(frozen=True)
class Line:
    """A straight piece of the law: stiffness [N/m] and offset [N]."""

    stiffness: Expression
    offset: Expression


STEEPEST = 1e6
"""Largest post-capping slope over initial stiffness [-]: a storey of that slope is brittle. A steeper one multiplies
the rounding of its drift until the energy does not close."""

LOADING = Line(memory(SLOPE), memory(OFFSET))
UNLOADING = Line(memory(UNLOADING_STIFFNESS), memory(UNLOADING_OFFSET))


def _constant(value: float) -> Expression:
    return 0.0 * DRIFT + value


def _capacity(of: str) -> float:
    doc = f"energy capacity of {of}, over Vy Dy; default: no deterioration"
    return parameter(doc, open_low=True, default=math.inf)


@dataclass(frozen=True)
class PeakOrientedImk(StoreyLaw):
    """Reloading in a straight line towards the largest drift so far on that side."""

    name: ClassVar[str] = "imk-peak-oriented"
    citation: ClassVar[tuple[tuple[str, str], ...]] = (
        ("ibarra2005", "backbone with capping and residual strength, deterioration with the energy dissipated"),
    )

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

    def may_be_endless(self, name: str) -> bool:
        """Capacities may."""
        return name.endswith("_capacity") or super().may_be_endless(name)

    @property
    def softest(self) -> float:
        """The post-capping slope."""
        return -self.post_capping_slope

    @property
    def memories_at_rest(self) -> tuple[float, ...]:
        """Full strength, the yield drifts, the initial stiffness."""
        if not self.can_yield:
            return ()
        return 1.0, 1.0, 1.0, 1.0, self.yield_drift, -self.yield_drift, self.stiffness

    @cached_property
    def deteriorates(self) -> bool:
        """Whether anything is lost with the energy dissipated."""
        return any(math.isfinite(getattr(self, name)) for name in self.parameters() if name.endswith("_capacity"))

    @property
    def residual(self) -> float:
        """Residual strength [N]."""
        return self.residual_strength * self.yield_shear

    @property
    def cap_shear(self) -> float:
        """Shear at which the first post-capping line meets zero drift [N]."""
        capping = self.yield_shear * (1.0 + self.hardening * (self.capping_ductility - 1.0))
        return capping + self.post_capping_slope * self.yield_shear * self.capping_ductility

    # Branches

    def branches(self) -> tuple[StoreyBranch, ...]:
        """Elastic; then, up and down, the backbone, the lines of reloading, and the unloading from each."""
        if not self.can_yield:
            return (StoreyBranch("elastic", self.stiffness),)
        yields = tuple(side.reaches(side.target, "backbone", self._yields(side)) for side in (UP, DOWN))
        return (
            StoreyBranch("elastic", self.stiffness, guards=yields),
            *(branch for side in (UP, DOWN) for branch in self._side(side)),
        )

    def _side(self, side: _Side) -> list[StoreyBranch]:
        """The branches of one side."""
        branches = []
        goes_on, arrives = (self._takes_backbone(side, side.sign * memory(at)) for at in (END, side.target))
        for name, ends in (
            ("backbone", side.reaches(END, "backbone", goes_on)),
            ("reloading", side.reaches(side.target, "backbone", arrives)),
            *self._pinched(side),
        ):
            turns = side.turns(f"from {name}", self._turns(side, name == "backbone"))
            branches.append(StoreyBranch(f"{name} {side.word}", LOADING.stiffness, LOADING.offset, (ends, turns)))
            branches.append(self._unloading(side, name))
        return branches

    def _pinched(self, side: _Side) -> list[tuple[str, Guard]]:
        """The line of reloading before the one towards the target, where there is one, and where it ends."""
        return []

    def _unloading(self, side: _Side, name: str) -> StoreyBranch:
        other = DOWN if side is UP else UP
        guards = (
            side.reaches(TURNED, name, self._goes_on(UNLOADING, LOADING)),
            other.crosses(self._first_line, self._begins(other)),
        )
        return StoreyBranch(f"from {name} {side.word}", UNLOADING.stiffness, UNLOADING.offset, guards)

    # What is remembered

    def _goes_on(self, before: Line, after: Line) -> Sets:
        """The work done, where one line ends and another begins."""
        if not self.deteriorates:
            return ()
        stiffer = before.stiffness - after.stiffness
        return ((WORK, memory(WORK) + (0.5 * stiffer * DRIFT + (before.offset - after.offset)) * DRIFT),)

    def _loads_on(self, before: Line, after: Line, end: Expression) -> Sets:
        """Another line to load on."""
        return (SLOPE, after.stiffness), (OFFSET, after.offset), (END, end), *self._goes_on(before, after)

    def _yields(self, side: _Side) -> Sets:
        """The first yield."""
        full = _constant(1.0)
        line, end = self._backbone_line(side, full, full, _constant(self.yield_drift))
        return self._loads_on(Line(_constant(self.stiffness), _constant(0.0)), line, end)

    def _takes_backbone(self, side: _Side, drift: Expression) -> Sets:
        """The line of the backbone that begins at a drift, or goes on beyond it."""
        line, end = self._backbone_line(side, memory(side.strength), memory(side.cap), drift)
        return self._loads_on(LOADING, line, end)

    def _backbone_line(
        self, side: _Side, strength: Expression, cap: Expression, drift: Expression
    ) -> tuple[Line, Expression]:
        """The line of the backbone beyond a drift, and where it ends."""
        capping, residual = self._capping_drift(strength, cap), self._residual_drift(cap)
        hardens = above_zero(capping - drift)
        falls = above_zero(residual - drift) * (1.0 - hardens)
        level = 1.0 - hardens - falls
        stiffness = (self.hardening * self.stiffness) * (
            hardens * strength
        ) - self.post_capping_slope * self.stiffness * falls
        offset = hardens * self._plateau(strength) + falls * (self.cap_shear * cap) + level * self.residual
        end = hardens * capping + falls * residual + level * FAR
        return Line(stiffness, side.sign * offset), side.sign * end

    def _turns(self, side: _Side, on_backbone: bool) -> Sets:
        """A reversal: the unloading stiffness deteriorates."""
        shear = LOADING.stiffness * DRIFT + LOADING.offset
        unloading = memory(UNLOADING_STIFFNESS)
        sets: Sets = ()
        if math.isfinite(self.unloading_capacity):
            done = memory(WORK) + (0.5 * LOADING.stiffness * DRIFT + LOADING.offset) * DRIFT
            spent = positive_part(done - 0.5 * shear * shear / unloading)
            left = 1.0 - self._loss(self.unloading_capacity, spent, memory(DISSIPATED) + spent)
            least = self.hardening + LEAST_UNLOADING * (1.0 - self.hardening)
            unloading = larger(left * unloading, least * self.stiffness)
            if not on_backbone:  # unloading with less than the line gave would give back more than was put in
                unloading = larger(unloading, LOADING.stiffness)
            sets = ((UNLOADING_STIFFNESS, unloading),)
        after = Line(unloading, shear - unloading * DRIFT)
        sets += (TURNED, DRIFT), (UNLOADING_OFFSET, after.offset), *self._goes_on(LOADING, after)
        return (*sets, (side.target, DRIFT)) if on_backbone else sets

    def _loss(self, capacity: float, energy: Expression, dissipated: Expression) -> Expression:
        """beta = (E / (Et - sum E))^c, 1 where no more than E is left."""
        left = capacity * self.yield_shear * self.yield_drift - dissipated
        return (energy / larger(left, energy)) ** self.deterioration_exponent

    def _backbone(self, strength: Expression, cap: Expression, drift: Expression) -> Expression:
        """Shear of the backbone [N] at drifts beyond the yield."""
        capping = self.cap_shear * cap - self.post_capping_slope * self.stiffness * drift
        return larger(smaller(self._hardening_shear(strength, drift), capping), self.residual)

    def _hardening_shear(self, strength: Expression, drift: Expression) -> Expression:
        return self._plateau(strength) + (self.hardening * self.stiffness) * strength * drift

    def _plateau(self, strength: Expression) -> Expression:
        """The hardening line at zero drift [N]: it begins at the yield drift that belongs to its strength."""
        return self.yield_shear * strength * (1.0 - self.hardening * strength)

    def _capping_drift(self, strength: Expression, cap: Expression) -> Expression:
        """Where the hardening line meets the post-capping line [m]."""
        slope = (self.hardening * self.stiffness) * strength + self.post_capping_slope * self.stiffness
        return (self.cap_shear * cap - self._plateau(strength)) / slope

    def _residual_drift(self, cap: Expression) -> Expression:
        """Where the post-capping line meets the residual strength [m]."""
        return (self.cap_shear * cap - self.residual) / (self.post_capping_slope * self.stiffness)

    def _begins(self, side: _Side) -> Sets:
        """An excursion to this side begins at zero shear: its backbone, and the line towards the target."""
        strength, cap, target = memory(side.strength), memory(side.cap), side.sign * memory(side.target)
        sets: Sets = ()
        if self.deteriorates:
            energy = positive_part(memory(WORK) + (0.5 * UNLOADING.stiffness * DRIFT + UNLOADING.offset) * DRIFT)
            dissipated = memory(DISSIPATED) + energy
            strength, cap, target = self._deteriorated(side, energy, dissipated)
            sets = (
                (side.strength, strength), (side.cap, cap), (side.target, side.sign * target), (DISSIPATED, dissipated),
            )  # fmt: skip
        shear = self._backbone(strength, cap, target)
        slope = self._first_slope(side, shear, target)
        sets += (SLOPE, slope), (OFFSET, -slope * DRIFT), *self._first_end(side, shear, target)
        return (*sets, (WORK, 0.5 * slope * DRIFT * DRIFT)) if self.deteriorates else sets

    def _deteriorated(
        self, side: _Side, energy: Expression, dissipated: Expression
    ) -> tuple[Expression, Expression, Expression]:
        """What an excursion that dissipated `energy` leaves of strength and post-capping line, and the target."""
        strength, cap, target = memory(side.strength), memory(side.cap), side.sign * memory(side.target)
        if math.isfinite(self.strength_capacity):
            left = 1.0 - self._loss(self.strength_capacity, energy, dissipated)
            strength = larger(left * strength, self.residual_strength)
        if math.isfinite(self.capping_capacity):
            cap = (1.0 - self._loss(self.capping_capacity, energy, dissipated)) * cap
        # The post-capping line does not fall below the yield point.
        cap = larger(cap, (self.yield_shear * (1.0 + self.post_capping_slope) / self.cap_shear) * strength)
        if math.isfinite(self.reloading_capacity):
            unspent = above_zero(self.reloading_capacity * self.yield_shear * self.yield_drift - dissipated)
            target = (1.0 + unspent * self._loss(self.reloading_capacity, energy, dissipated)) * target
        if math.isfinite(self.unloading_capacity):
            target = larger(target, self._nearest_target(side, strength, cap))
        return strength, cap, target

    def _nearest_target(self, side: _Side, strength: Expression, cap: Expression) -> Expression:
        """Where the backbone is met by a line with the unloading stiffness: reloading is no stiffer."""
        k, unloading = self.stiffness, memory(UNLOADING_STIFFNESS)
        reach = unloading * self._reloads_from(side)
        hardening = (self._plateau(strength) + reach) / (unloading - (self.hardening * k) * strength)
        capping = (self.cap_shear * cap + reach) / (unloading + self.post_capping_slope * k)
        return larger(smaller(hardening, capping), (reach + self.residual) / unloading)

    def _reloads_from(self, side: _Side) -> Expression:
        return side.drift

    _first_line: ClassVar[str] = "reloading"

    def _first_slope(self, side: _Side, shear: Expression, target: Expression) -> Expression:
        return shear / (target - side.drift)

    def _first_end(self, side: _Side, shear: Expression, target: Expression) -> Sets:
        return ()


@dataclass(frozen=True, kw_only=True)
class PinchingImk(PeakOrientedImk):
    """Reloading in two straight lines: a soft one up to the break drift, then towards the largest drift so far."""

    name: ClassVar[str] = "imk-pinching"
    citation: ClassVar[tuple[tuple[str, str], ...]] = (
        ("ibarra2005", "pinching; backbone with capping and residual strength, deterioration"),
    )

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

    _first_line: ClassVar[str] = "pinched"

    def _pinched(self, side: _Side) -> list[tuple[str, Guard]]:
        target = side.sign * memory(side.target)
        shear = LOADING.stiffness * DRIFT + LOADING.offset
        aim = self._backbone(memory(side.strength), memory(side.cap), target)
        slope = (aim - side.sign * shear) / (target - side.drift)
        line = Line(slope, shear - slope * DRIFT)
        return [("pinched", side.reaches(END, "reloading", self._loads_on(LOADING, line, memory(side.target))))]

    def _reloads_from(self, side: _Side) -> Expression:
        return positive_part(side.drift)

    def _first_slope(self, side: _Side, shear: Expression, target: Expression) -> Expression:
        return self.pinching_force * super()._first_slope(side, shear, target)

    def _first_end(self, side: _Side, shear: Expression, target: Expression) -> Sets:
        plastic = positive_part(target - shear / memory(UNLOADING_STIFFNESS))
        return ((END, side.sign * larger((1.0 - self.pinching_drift) * plastic, side.drift)),)
