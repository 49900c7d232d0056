"""A study at some of the points of its sweep, so that what a large one will run is known soon."""

from __future__ import annotations

import copy
import math

import numpy as np

from pounding_cli.study.study import Study


def thinned(study: Study, most: int) -> Study:
    """The study with at most `most` points: fewer values on its longest axes, spread evenly, the ends among them."""
    sizes = [len(axis.values) for axis in study.axes]
    while math.prod(sizes) > most:
        sizes[sizes.index(max(sizes))] -= 1
    places = [
        np.linspace(0, len(axis.values) - 1, size).round().astype(int).tolist()
        for axis, size in zip(study.axes, sizes, strict=True)
    ]
    found = copy.copy(study)
    found.narrow([axis.some(some) for axis, some in zip(study.swept, places, strict=True)])
    return found


def times(study: Study, some: Study, *subjects: str | tuple[str, str]) -> float:
    """How often a thing that depends on these sections of the file stands in a study for every one in the thinned study
    `some`, if it differs from point to point."""
    axes = zip(study.axes, some.axes, study.touches(*subjects), strict=True)
    return math.prod(len(axis.values) / len(few.values) for axis, few, touches in axes if touches)
