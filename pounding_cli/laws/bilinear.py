"""A storey that is elastic up to its yield shear and then hardens kinematically (bilinear; paper, section 2)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from pounding_cli.laws.program import DRIFT, memory
from pounding_cli.laws.storey import (
    StoreyBranch,
    StoreyLaw,
    drift_falls_below,
    drift_rises_above,
    turns_down,
    turns_up,
)

PLASTIC_DRIFT = memory(0)
"""Plastic drift Dp of the last unloading [m]."""


@dataclass(frozen=True)
class Bilinear(StoreyLaw):
    """k D - (1 - a) k Dp between the yield lines, a k D +- (1 - a) Vy on them."""

    name: ClassVar[str] = "bilinear"
    citation: ClassVar[tuple[tuple[str, str], ...]] = (("spiliopoulos1996", "bilinear storeys, section 2"),)

    def branches(self) -> tuple[StoreyBranch, ...]:
        """Between the yield lines, on the upper one, on the lower one."""
        k, a = self.stiffness, self.hardening
        if not self.can_yield:
            return (StoreyBranch("elastic", k, lost=0.0, stored=0.5 * k * DRIFT * DRIFT),)
        limit, plateau = self.yield_drift, self.plateau
        elastic_part = DRIFT - PLASTIC_DRIFT
        between = 0.5 * k * (a * DRIFT * DRIFT + (1.0 - a) * elastic_part * elastic_part)
        on_line = 0.5 * k * (a * DRIFT * DRIFT + (1.0 - a) * limit * limit)
        yields = drift_rises_above(limit, "upper", 1.0), drift_falls_below(-limit, "lower", 1.0)
        back_down = turns_down("elastic", (0, DRIFT - limit))
        back_up = turns_up("elastic", (0, DRIFT + limit))
        offset = (-(1.0 - a) * k) * PLASTIC_DRIFT
        return (
            StoreyBranch("elastic", k, offset, yields, lost=0.0, stored=between),
            StoreyBranch("upper", a * k, plateau, (back_down,), lost=plateau, stored=on_line),
            StoreyBranch("lower", a * k, -plateau, (back_up,), lost=-plateau, stored=on_line),
        )
