"""A storey that softens as it is cycled: after an unloading it reloads towards the largest drift so far on the other
side (Clough; stiffness-degrading or peak-oriented)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from pounding_cli.laws.law import Guard
from pounding_cli.laws.program import DRIFT, Expression, memory
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

LARGEST, SMALLEST, SLOPE, OFFSET, TURNED, UNLOADING = range(6)
"""Memories: largest and smallest drift so far [m], the yield drifts at first; stiffness [N/m] and offset [N] of the
present reloading line; drift at which it last turned back [m]; offset of the present unloading line [N]."""


@dataclass(frozen=True)
class PeakOriented(StoreyLaw):
    """Bilinear backbone, unloading with the initial stiffness to zero shear, reloading in a straight line towards the
    largest drift so far on that side."""

    name: ClassVar[str] = "peak-oriented"
    citation: ClassVar[tuple[tuple[str, str], ...]] = (
        ("clough1966", "stiffness that degrades with the largest drift"),
        ("ibarra2005", "peak-oriented reloading"),
    )

    @property
    def memories_at_rest(self) -> tuple[float, ...]:
        """The yield drifts."""
        return (self.yield_drift, -self.yield_drift) if self.can_yield else ()

    def branches(self) -> tuple[StoreyBranch, ...]:
        """Elastic; on the backbone; unloading from it; reloading; unloading from a reloading line."""
        k, a = self.stiffness, self.hardening
        if not self.can_yield:
            return (StoreyBranch("elastic", k),)
        limit, plateau = self.yield_drift, self.plateau
        yields = drift_rises_above(limit, "upper"), drift_falls_below(-limit, "lower")
        begins_down = turns_down("from upper", (LARGEST, DRIFT), (UNLOADING, plateau - (1.0 - a) * k * DRIFT))
        begins_up = turns_up("from lower", (SMALLEST, DRIFT), (UNLOADING, -plateau - (1.0 - a) * k * DRIFT))
        turned = (TURNED, DRIFT), (UNLOADING, (memory(SLOPE) - k) * DRIFT + memory(OFFSET))
        return (
            StoreyBranch("elastic", k, guards=yields),
            StoreyBranch("upper", a * k, plateau, (begins_down,)),
            StoreyBranch("lower", a * k, -plateau, (begins_up,)),
            self._unloading("from upper", drift_rises_above(0.0, "upper", 1.0, LARGEST), self._crosses_down()),
            self._unloading("from lower", drift_falls_below(0.0, "lower", 1.0, SMALLEST), self._crosses_up()),
            self._reloading("up", drift_rises_above(0.0, "upper", 1.0, LARGEST), turns_down("from up", *turned)),
            self._reloading("down", drift_falls_below(0.0, "lower", 1.0, SMALLEST), turns_up("from down", *turned)),
            self._unloading("from up", drift_rises_above(0.0, "up", 1.0, TURNED), self._crosses_down()),
            self._unloading("from down", drift_falls_below(0.0, "down", 1.0, TURNED), self._crosses_up()),
        )

    def _unloading(self, name: str, *guards: Guard) -> StoreyBranch:
        return StoreyBranch(name, self.stiffness, memory(UNLOADING), guards)

    def _reloading(self, name: str, *guards: Guard) -> StoreyBranch:
        return StoreyBranch(name, memory(SLOPE), memory(OFFSET), guards)

    def _crosses_down(self) -> Guard:
        return shear_falls_below_zero("down", *self._towards(memory(SMALLEST), -1.0))

    def _crosses_up(self) -> Guard:
        return shear_rises_above_zero("up", *self._towards(memory(LARGEST), 1.0))

    def _towards(self, drift: Expression, side: float) -> tuple[tuple[int, Expression], ...]:
        """The straight line from zero shear here to the backbone at `drift`, on the side above (1) or below (-1)."""
        rise = (self.hardening * self.stiffness * side) * drift + self.plateau
        slope = rise / (side * (drift - DRIFT))
        return (SLOPE, slope), (OFFSET, -slope * DRIFT)
