"""Gaps that never close: neighbours with nothing between them answer every scene in which no gap closes, since no force
crosses those; of scenes that differ in such gaps alone, one is solved."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from pounding_cli.model.effects import effects_of
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Scene
from pounding_cli.solver.response import DONE, NEVER_CLOSES, LinkResponse, Response

MEMORY = 256
"""Responses of neighbours with nothing between them that are kept."""

ERRORS = 10.0
"""By how many times its accuracy a closing may be wrong at most [-]."""


class NeverClosed:
    """The responses of neighbours with nothing between them, solved once a scene was seen to stay open. They answer
    all scenes that do, whatever came first. Threads may share it.

    run : solves a scene; accuracy : to which [-]
    """

    def __init__(self, run: Callable[[Scene], Response], accuracy: float) -> None:
        self._run, self._accuracy = run, accuracy
        self._kept: dict[object, Response] = {}

    def __call__(self, scene: Scene) -> Response:
        """The response of a scene, without a run of its own where its gaps are known not to close."""
        if not may_stay_open(scene):
            return self._run(scene)
        ends = [(link.left, link.left_floor, link.right_floor, link.left_at, link.right_at) for link in scene.links]
        links = tuple(Link.apart(*each) for each in dict.fromkeys(ends))
        numbers = [list(dict.fromkeys(ends)).index(each) for each in ends]
        key = tuple(each.digest for each in scene.buildings), links, scene.motion.digest, scene.analysis, scene.tail
        known = self._kept.get(key)
        if known is not None and self._is_wider(scene, known, known.links.max_closing[numbers]):
            return replace(_of_scene(scene, known, numbers), seconds=0.0)
        response = self._run(scene)
        if response.status != DONE or response.links.impacts.any():
            return response
        known = known or self._run(replace(scene, links=links))
        if known.status != DONE:
            return response
        if len(self._kept) >= MEMORY:
            self._kept.clear()
        self._kept[key] = known
        return _of_scene(scene, known, numbers)

    def _is_wider(self, scene: Scene, known: Response, closings: np.ndarray) -> bool:
        """Whether no link of a scene acts at closings [m] with nothing between, and at the most they may be wrong."""
        moved = [each for b in known.buildings for each in (b.displacement_max, b.displacement_min)]
        furthest = np.nanmax(np.abs(np.concatenate(moved)), initial=0.0)  # a wall that moves with the ground has none
        return bool(np.all(_widths(scene) > closings + ERRORS * self._accuracy * furthest))


def may_stay_open(scene: Scene) -> bool:
    """Whether all links of a scene act across a gap alone, and none asks for the shears of columns."""
    return bool(scene.links) and not any(link.law.joins or link.columns for link in scene.links)


def stays_open(scene: Scene, response: Response) -> list[str]:
    """In words how much of their gap stays open between neighbours, where none of them closed."""
    if not response.has_result or not may_stay_open(scene) or response.links.impacts.any():
        return []
    left_open, said = _widths(scene) - response.links.max_closing, []
    for place in dict.fromkeys(link.left for link in scene.links):
        least = min(width for width, link in zip(left_open.tolist(), scene.links, strict=True) if link.left == place)
        if math.isfinite(least):
            names = f"{scene.buildings[place].name} | {scene.buildings[place + 1].name}"
            said.append(f"links {names}: {NEVER_CLOSES}, {least * 1000:.3g} mm of it stay open")
    return said


def _widths(scene: Scene) -> np.ndarray:
    """The closings [m] below which no link acts, in their order."""
    return np.array([link.law.free_below for link in scene.links])


def _of_scene(scene: Scene, apart: Response, numbers: list[int]) -> Response:
    """The response of a scene whose gaps never close, from that of the neighbours with nothing between them.

    numbers : of every link that of the place of its ends there
    """
    effects, none = effects_of(scene), np.zeros(len(numbers))
    links = LinkResponse(none.astype(np.int64), none, apart.links.max_closing[numbers], none, none)
    return replace(apart, links=links, effects=effects.kept, dropped=effects.dropped)
