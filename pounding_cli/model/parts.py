"""Parts of a row that nothing links: each moves as if it stood alone."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from pounding_cli.model.building import Building
from pounding_cli.model.links import Link
from pounding_cli.model.wall import Wall

if TYPE_CHECKING:
    from pounding_cli.model.scene import Scene


@dataclass(frozen=True)
class Part:
    """Buildings beside each other that links join, directly or one after the other.

    A wall that moves as the ground does passes nothing on: it ends the parts on both of its sides, and belongs to both.

    first : place of its first building in the row, from 0
    end : place behind its last building
    link_numbers : numbers of its links among those of the row
    """

    first: int
    end: int
    link_numbers: tuple[int, ...]

    @property
    def places(self) -> slice:
        """The places of its buildings in the row."""
        return slice(self.first, self.end)


@dataclass(frozen=True, eq=False)
class PartScene:
    """A part of a scene, as a scene of its own.

    scene : its buildings with their names, the links between them, and the motion
    """

    part: Part
    scene: Scene


def is_divided(buildings: Sequence[Building], links: Iterable[Link]) -> bool:
    """Return whether a row has parts that nothing links."""
    linked_pairs = {link.left for link in links}
    return len(linked_pairs) < len(buildings) - 1 or any(map(_is_fixed_wall, buildings[1:-1]))


def _is_fixed_wall(building: Building) -> bool:
    """Return whether a building is a wall that moves as the ground does."""
    return isinstance(building, Wall) and not building.moves


def find_parts(buildings: Sequence[Building], links: Sequence[Link]) -> tuple[Part, ...]:
    """Return the parts of a row, left to right; a single one of a row that is whole."""
    linked_pairs = {link.left for link in links}
    parts = []
    first = 0
    for place, building in enumerate(buildings):
        is_last = place not in linked_pairs
        is_shared = not is_last and place > first and _is_fixed_wall(building)
        if is_last or is_shared:
            numbers = tuple(number for number, link in enumerate(links) if first <= link.left < place)
            parts.append(Part(first, place + 1, numbers))
            first = place if is_shared else place + 1
    return tuple(parts)


def divide_scene(scene: Scene) -> tuple[PartScene, ...]:
    """Return the parts of a scene as scenes of their own; none of a scene that is whole.

    A link without force joins buildings too: the closing of their floors is recorded where they move together.
    """
    if not is_divided(scene.buildings, scene.links):
        return ()
    parts = find_parts(scene.buildings, scene.links)
    return tuple(PartScene(part, _build_scene(scene, part)) for part in parts)


def _build_scene(scene: Scene, part: Part) -> Scene:
    """Return a part as a scene of its own, whose buildings count from 0."""
    links = (scene.links[number] for number in part.link_numbers)
    return replace(
        scene,
        buildings=scene.buildings[part.places],
        links=tuple(replace(link, left=link.left - part.first) for link in links),
    )


def format_parts(buildings: Sequence[Building], links: Sequence[Link]) -> str:
    """Return the parts of a row in words, "moat-1|hospital|moat-2 and frame"; "" of a row that is whole."""
    if not is_divided(buildings, links):
        return ""
    parts = find_parts(buildings, links)
    *others, last = ("|".join(building.name for building in buildings[part.places]) for part in parts)
    return f"{', '.join(others)} and {last}"
