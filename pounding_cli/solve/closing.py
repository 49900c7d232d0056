"""How close two neighbours come with nothing between them: the peak by which a gap is known to close, or never to.

Between floors that never meet no force acts, so their largest closing depends on no gap, stiffness or restitution: one
run serves every gap of a sweep. It is a peak like any other, located within the step it lies in."""

from __future__ import annotations

import dataclasses
from collections.abc import Collection, Sequence

import numpy as np

from pounding_cli.model.building import Building
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Analysis, Scene
from pounding_cli.records.motion import Motion
from pounding_cli.solve.assess import finer
from pounding_cli.solve.run import solve

ACCURACY = 1e-9
"""Accuracy of closings between free neighbours [-], finer than that of a study: a gap a millionth wider than the
closing is known to stay open."""


def free_accuracy(accuracy: float) -> float:
    """Accuracy of the closings of a study with this accuracy [-]."""
    return min(ACCURACY, finer(accuracy))


def kept_apart(scene: Scene, places: Collection[int]) -> Scene:
    """The scene with nothing between the buildings at these places and the next ones; their closings are found all the
    same, once for all links that join the same floors."""
    links = dict.fromkeys(
        Link.apart(link.left, link.left_floor, link.right_floor, link.left_at, link.right_at)
        if link.left in places
        else link
        for link in scene.links
    )
    return dataclasses.replace(scene, links=tuple(links))


def peak_closings(
    left: Building,
    right: Building,
    floors: Sequence[tuple[int, int]],
    motion: Motion,
    analysis: Analysis,
    accuracy: float = ACCURACY,
    tail: float = 0.0,
) -> np.ndarray:
    """Largest closing u_left - u_right of two neighbours with nothing between them [m], shape (len(floors),).

    A gap wider than this never closes; a narrower one does.

    Parameters
    ----------
    left, right : the two buildings
    floors : floors that face each other, (of the left, of the right building), from 1
    motion, analysis, tail : as in `Scene`
    accuracy : relative error of the peaks [-]

    Raises
    ------
    ValueError : a floor that is not there, or a run that does not end: its outcome and advice
    """
    links = tuple(Link.apart(0, *pair) for pair in floors)
    response = solve(Scene((left, right), links, motion, analysis, tail), accuracy)
    if response.status != "done":
        raise ValueError(f"{left.name} | {right.name}: {response.status}; {response.advice}")
    return response.links.max_closing
