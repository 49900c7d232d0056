"""Answer scenes in which no gap closes by the response of their neighbours with nothing between them.

No force crosses a gap that stays open: of scenes that differ in such gaps alone, one is solved.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from pounding_cli.model.effects import DroppedEffect, effects_of
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Scene
from pounding_cli.solver.response import (
    DONE,
    LINKS,
    Response,
    building_names,
    count_lines,
    no_peaks,
)

MAX_REMEMBERED = 4096
"""Largest number of responses that `ApartResponses` holds."""

MAX_CLOSING_ERROR = 10.0
"""Largest error of a closing over the accuracy of its run [-]."""


class ApartScene(NamedTuple):
    """Neighbours of a scene with nothing between them.

    scene : these neighbours; its links exert no force
    link_numbers : for every link of the first scene, the number of the link between the same ends in `scene`
    """

    scene: Scene
    link_numbers: tuple[int, ...]


class ApartResponses:
    """Responses of neighbours with nothing between them, by the digest of the scene that they are.

    The solver of a run holds them, so that groups of scenes that share neighbours do not solve these again. Threads
    share one object. Other processes get those of their group, and give back the new ones.
    """

    def __init__(self) -> None:
        self._responses: dict[str, Response] = {}

    def find(self, digest: str) -> Response | None:
        """Return the response of the neighbours with this digest; None where it is not there."""
        return self._responses.get(digest)

    def select(self, scenes: Iterable[Scene]) -> ApartResponses:
        """Return those of some neighbours alone."""
        selection = ApartResponses()
        for scene in scenes:
            response = self.find(scene.digest)
            if response is not None:
                selection.add({scene.digest: response})
        return selection

    def add(self, responses: Mapping[str, Response]) -> None:
        """Take in responses by digest; where they become too many, those before are forgotten."""
        if len(self._responses) + len(responses) > MAX_REMEMBERED:
            self._responses.clear()
        self._responses.update(responses)


def can_stay_open(scene: Scene) -> bool:
    """Return whether all links of a scene act across a gap, and none asks for the shears of columns."""
    return bool(scene.links) and not any(link.law.joins or link.columns for link in scene.links)


def build_apart(scene: Scene) -> ApartScene:
    """Return the neighbours of a scene with nothing between them."""
    links = [_build_apart_link(link) for link in scene.links]
    number_by_link = {link: number for number, link in enumerate(dict.fromkeys(links))}
    link_numbers = tuple(number_by_link[link] for link in links)
    return ApartScene(replace(scene, links=tuple(number_by_link)), link_numbers)


def _build_apart_link(link: Link) -> Link:
    """Return the link with nothing between the ends of another."""
    apart = Link.apart(link.left, link.left_floor, link.right_floor, link.left_at, link.right_at)
    if link.left_arm or link.right_arm:
        return replace(apart, left_arm=link.left_arm, right_arm=link.right_arm)
    return apart


def stays_open(scene: Scene, apart: ApartScene, response: Response, accuracy: float) -> bool:
    """Return whether no link of a scene acts before its neighbours are at rest, even if their closings are inexact.

    Parameters
    ----------
    apart, response : the neighbours with nothing between them, and their response
    accuracy : of that response [-]
    """
    if response.status != DONE:
        return False
    displacements = np.concatenate([response.peaks[name].ravel() for name in ("displacement_max", "displacement_min")])
    largest = np.nanmax(np.abs(displacements), initial=0.0)  # a wall that moves with the ground has none
    if count_lines(response.peaks):
        arms = [abs(arm) for link in scene.links for arm in (link.left_arm, link.right_arm)]
        largest += max(arms, default=0.0) * np.nanmax(response.peaks["twist"], initial=0.0)
    margin = MAX_CLOSING_ERROR * accuracy * largest
    return bool(np.all(_open_gaps_to_rest(scene, apart, response) > margin))


def stays_open_to_rest(scene: Scene, apart: ApartScene, response: Response) -> bool:
    """Return whether no link of a scene acts before its neighbours with nothing between them are at rest.

    Their residual drifts are those of the scene then.
    """
    return response.status == DONE and bool(np.all(_open_gaps_to_rest(scene, apart, response) > 0.0))


def _open_gaps_to_rest(scene: Scene, apart: ApartScene, response: Response) -> np.ndarray:
    """Return how much of the gap of every link stays open until the neighbours are at rest [m]."""
    return _open_gaps(scene, response.closing_to_rest[list(apart.link_numbers)])


def _open_gaps(scene: Scene, closings: np.ndarray) -> np.ndarray:
    """Return how much further than these closings every link may close before it acts [m]."""
    return np.array([link.law.free_below for link in scene.links]) - closings


def answer_from_apart(scene: Scene, apart: ApartScene, response: Response) -> Response:
    """Return the response of a scene in which no gap closes, from that of its neighbours with nothing between them."""
    effects = effects_of(scene)
    peaks = no_peaks(response.storeys, len(scene.links), count_lines(response.peaks))
    for name in building_names(response.peaks):
        peaks[name] = response.peaks[name]
    for name in LINKS:
        peaks[name] = 0.0
    peaks["max_closing"] = response.peaks["max_closing"][list(apart.link_numbers)]
    return replace(response, peaks=peaks, effects=effects.kept, dropped=effects.dropped)


def add_open_gaps(scene: Scene, response: Response) -> Response:
    """Return the response of a scene with the links of every pair of neighbours that never met among what is dropped.

    Each has the part of its gap that stays open.
    """
    if not (response.has_result and can_stay_open(scene)):
        return response
    open_gaps = _open_gaps(scene, response.peaks["max_closing"])
    impacts = response.peaks["impacts"]
    dropped = list(response.dropped)
    for left in dict.fromkeys(link.left for link in scene.links):
        numbers = [number for number, link in enumerate(scene.links) if link.left == left]
        least = float(open_gaps[numbers].min())
        if math.isfinite(least) and not impacts[numbers].any():
            neighbours = f"{scene.buildings[left].name} | {scene.buildings[left + 1].name}"
            dropped.append(DroppedEffect.of_open_gap(neighbours, least))
    return replace(response, dropped=tuple(dropped))
