"""How close two neighbours come with nothing between them: the peak by which a gap is known to close, or never to.

Between floors that never meet no force acts, so their largest closing depends on no gap, stiffness or restitution: one
run serves every gap of a sweep. It is a peak like any other, located within the step it lies in."""

from __future__ import annotations

import dataclasses
from collections.abc import Collection

from pounding_cli.model.links import Link
from pounding_cli.model.scene import Scene
from pounding_cli.solve.assess import finer

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
