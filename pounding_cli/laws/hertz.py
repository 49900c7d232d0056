"""Floors that strike with a force that grows as the closing to the power 1.5 (Hertz), with or without damping."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import ClassVar

from scipy.optimize import brentq

from pounding_cli.laws.law import Branch, Guard, LinkLaw, Quantity, falls_below, opening, parameter
from pounding_cli.laws.program import CLOSING, MEMORY, RATE

EXPONENT = 1.5
"""Of the closing."""


@dataclass(frozen=True)
class Hertz(LinkLaw):
    """F = k_h v^1.5 for v > 0; v is the closing less the gap. It takes no energy."""

    name: ClassVar[str] = "hertz"
    citation: ClassVar[tuple[tuple[str, str], ...]] = (("muthukumar2006", "the Hertz contact"),)
    subtracts_gap: ClassVar[bool] = True

    hertz_stiffness: float = parameter("stiffness k_h of the contact", "N/m^1.5", open_low=True)

    def branches(self, left_mass: float, right_mass: float) -> tuple[Branch, ...]:
        """Open and in contact."""
        force = self.hertz_stiffness * CLOSING**EXPONENT
        return opening(Branch("contact", force=force, regular=2, guards=(falls_below(0.0, "open"),)))

    def stored(self, closing: float) -> float:
        """k_h v^2.5 / 2.5 [J]."""
        return self.hertz_stiffness * max(closing - self.offset, 0.0) ** (EXPONENT + 1) / (EXPONENT + 1)
