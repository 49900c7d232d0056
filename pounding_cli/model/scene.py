"""A scene: a row of buildings, the links between them, one motion, elastic or inelastic storeys."""

from __future__ import annotations

import functools
import hashlib
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cached_property

from pounding_cli.model.building import Building
from pounding_cli.model.links import Link
from pounding_cli.model.twist import drop_plans
from pounding_cli.numbers import pluralize
from pounding_cli.records.motion import Motion


class Analysis(StrEnum):
    """Elastic or yielding storeys; contact is the same in both."""

    ELASTIC = "elastic"
    INELASTIC = "inelastic"


@functools.lru_cache(maxsize=256)  # scenes of a study share buildings and links
def _check_links(buildings: tuple[Building, ...], links: tuple[Link, ...]) -> None:
    """Raises ValueError, see `Scene`."""
    taken = set()
    for link in links:
        if link.left + 1 >= len(buildings):
            raise ValueError(f"link: building {link.left} (from 0) has no neighbour on its right")
        for place, floor in ((link.left, link.left_floor), (link.left + 1, link.right_floor)):
            building = buildings[place]
            if not building.has_floor(floor):
                has = pluralize(building.storeys, "floor") + (", and its base does not move" if floor == 0 else "")
                raise ValueError(f"link: {building.name} has {has}, not {floor}")
        if link in taken:
            raise ValueError(
                f"link: two {link.kind} links alike between floors {link.left_floor} and {link.right_floor}"
                f" of buildings {link.left} and {link.left + 1}; give one"
            )
        taken.add(link)


@dataclass(frozen=True, eq=False)
class Scene:
    """Everything one time-history run needs, in SI units.

    Parameters
    ----------
    buildings : left to right
    links : several may join the same floors (a connector beside pounding, say), each with a law of its own
    motion : already windowed and scaled
    analysis : Analysis
    tail : free vibration after the motion [s], >= 0
    residual_drift : whether the drifts at rest, long after the motion, are asked for

    Raises
    ------
    ValueError : no buildings, a link to a building or floor that is not there, two links alike between the
        same two floors, or a negative tail
    """

    buildings: tuple[Building, ...]
    links: tuple[Link, ...]
    motion: Motion
    analysis: Analysis
    tail: float = 0.0
    residual_drift: bool = True

    def __post_init__(self) -> None:
        if not self.buildings:
            raise ValueError("scene: no buildings; give at least one")
        if not (math.isfinite(self.tail) and self.tail >= 0):
            raise ValueError(f"scene: tail is {self.tail:g} s; it must be finite and not negative")
        object.__setattr__(self, "buildings", tuple(self.buildings))
        object.__setattr__(self, "links", tuple(self.links))
        _check_links(self.buildings, self.links)

    def __repr__(self) -> str:
        names = " | ".join(building.name for building in self.buildings)
        return f"Scene({names}; {pluralize(len(self.links), 'link')}; {self.motion.name}; {self.analysis})"

    @cached_property
    def digest(self) -> str:
        """SHA-256 of the scene: two scenes with one digest have the same response (names are left out)."""
        suffix = Digests.suffix(self.motion.digest, self.analysis, self.tail, self.residual_drift)
        return Digests(self.buildings, self.links).finish(suffix).hex()

    def alone(self, place: int) -> Scene:
        """The baseline of the building at `place`: the same motion, no neighbours, no links."""
        return replace(self, buildings=drop_plans((self.buildings[place],), ()), links=())


class Digests:
    """Digests of the scenes that share buildings and links, without building the scenes.

    buildings, links : as in `Scene`
    """

    def __init__(self, buildings: Sequence[Building], links: Sequence[Link]) -> None:
        parts = [building.digest for building in buildings]
        parts += [link.identity for link in links]
        self._prefix_hash = hashlib.sha256("\n".join(parts).encode())

    @staticmethod
    def suffix(motion_digest: str, analysis: Analysis, tail: float, follows_residual_drift: bool) -> bytes:
        """Return the last part of the hashed text: everything beside buildings and links.

        Parameters
        ----------
        tail : free vibration after the motion [s]
        follows_residual_drift : whether the scene is followed until it is at rest
        """
        last_line = "\nresidual drift" if follows_residual_drift else ""
        return f"\n{motion_digest}\n{analysis}\n{float(tail)!r}{last_line}".encode()

    def finish(self, suffix: bytes) -> bytes:
        """Return the digest of the scene with this `suffix`, 32 bytes."""
        scene_hash = self._prefix_hash.copy()
        scene_hash.update(suffix)
        return scene_hash.digest()
