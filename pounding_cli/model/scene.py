"""A scene: a row of buildings, the links between them, one motion, elastic or inelastic storeys."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property

from pounding_cli.model.building import Building
from pounding_cli.model.links import Link
from pounding_cli.records.motion import Motion


class Analysis(StrEnum):
    """Whether storeys may yield; contact is the same in both."""

    ELASTIC = "elastic"
    INELASTIC = "inelastic"


@dataclass(frozen=True, eq=False)
class Scene:
    """Everything one time-history run needs, in SI units.

    Parameters
    ----------
    buildings : left to right
    links : at most one between any two floors
    motion : already windowed and scaled
    analysis : Analysis
    tail : free vibration after the motion [s]
    """

    buildings: tuple[Building, ...]
    links: tuple[Link, ...]
    motion: Motion
    analysis: Analysis
    tail: float = 0.0

    @cached_property
    def digest(self) -> str:
        """SHA-256 of the scene: two scenes with one digest have the same response (names are left out)."""
        parts = [b.digest for b in self.buildings]
        parts += [repr(link) for link in self.links]
        parts += [self.motion.digest, str(self.analysis), repr(float(self.tail))]
        return hashlib.sha256("\n".join(parts).encode()).hexdigest()

    def alone(self, place: int) -> Scene:
        """The baseline of the building at `place`: the same motion, no neighbours, no links."""
        return Scene((self.buildings[place],), (), self.motion, self.analysis, self.tail)
