"""Gaps that never close: neighbours with nothing between them answer every scene in which no gap closes, since no force
crosses those; of scenes that differ in such gaps alone, one is solved."""

from __future__ import annotations

import math
import threading
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import replace
from typing import Any

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
        self._kept: OrderedDict[tuple[Any, ...], Response] = OrderedDict()
        self._lock = threading.Lock()

    def __call__(self, scene: Scene) -> Response:
        """The response of a scene, without a run of its own where its gaps are known not to close."""
        if not may_stay_open(scene):
            return self._run(scene)
        key = _key(scene)
        known = self._kept.get(key)
        if known is not None:
            found = _of_scene(scene, known)
            ends = [each for b in known.buildings for each in (b.displacement_max, -b.displacement_min)]
            furthest = np.fmax.reduce(np.concatenate(ends), initial=0.0)  # a wall that moves with the ground has none
            if np.all(_widths(scene) > found.links.max_closing + ERRORS * self._accuracy * furthest):
                return replace(found, seconds=0.0)
        response = self._run(scene)
        if response.status != DONE or response.links.impacts.any():
            return response
        if known is None:
            known = self._run(replace(scene, links=tuple(_apart(scene))))
            if known.status != DONE:
                return response
            with self._lock:
                self._kept[key] = known
                while len(self._kept) > MEMORY:
                    self._kept.popitem(last=False)
        return _of_scene(scene, known)


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


def _key(scene: Scene) -> tuple[Any, ...]:
    """What scenes share whose links differ in their laws alone."""
    buildings = tuple(building.digest for building in scene.buildings)
    return buildings, tuple(_apart(scene)), scene.motion.digest, scene.analysis, scene.tail


def _apart(scene: Scene) -> dict[Link, int]:
    """Nothing between the floors that links of a scene join, with its place among them."""
    links = [Link.apart(*_ends(link)) for link in scene.links]
    return {link: place for place, link in enumerate(dict.fromkeys(links))}


def _ends(link: Link) -> tuple[int, int, int, float, float]:
    return link.left, link.left_floor, link.right_floor, link.left_at, link.right_at


def _widths(scene: Scene) -> np.ndarray:
    """The closings [m] below which no link acts, in their order."""
    return np.array([link.law.free_below for link in scene.links])


def _of_scene(scene: Scene, apart: Response) -> Response:
    """The response of a scene whose gaps never close, from that of the neighbours with nothing between them."""
    places, effects = _apart(scene), effects_of(scene)
    of_links = [places[Link.apart(*_ends(link))] for link in scene.links]
    none = np.zeros(len(of_links))
    links = LinkResponse(none.astype(np.int64), none, apart.links.max_closing[of_links], none, none)
    return replace(apart, links=links, effects=effects.kept, dropped=effects.dropped)
