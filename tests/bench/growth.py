"""How the cost of a scene grows with its storeys, buildings, duration, accuracy and impact stiffness."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from pounding_cli.model.scene import Scene
from pounding_cli.solve import solve

from . import scenes
from .clock import in_solver, least


@dataclass(frozen=True)
class Growth:
    """One way to grow: `scene` and `accuracy` from a value of `over`; `most` is the steepest slope or, with `whole`,
    the largest ratio of the last time to the first; None only reports."""

    name: str
    over: str
    values: Sequence[float]
    scene: Callable[[float], Scene]
    accuracy: Callable[[float], float] = lambda value: 1e-6
    most: float | None = None
    whole: bool = False


def sorts() -> tuple[Growth, ...]:
    """What is measured. Two buildings of five storeys, 10 s, where nothing else is said; touching, elastic."""
    pair = scenes.touching("elastic")
    return (
        Growth("storeys", "storeys a building", (5, 10, 20, 50, 100), lambda n: scenes.row(storeys=int(n)), most=1.3),
        Growth(
            "buildings", "buildings in a row, 1 cm apart", (2, 3, 5, 10, 20), lambda n: scenes.row(int(n), gap=0.01),
            most=1.2,
        ),
        Growth(
            "touching", "buildings in a row, touching", (2, 3, 5, 10, 20), lambda n: scenes.row(int(n)), most=1.2,
        ),
        Growth("duration", "duration [s]", (5, 10, 20, 40, 80), lambda t: scenes.row(duration=t), most=1.05),
        Growth(
            "accuracy", "accuracy", (1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12), lambda a: pair,
            lambda a: a, most=4.0, whole=True,
        ),
        Growth(
            "impact stiffness", "impact stiffness, times the usual", (1, 10, 100, 1e3, 1e4, 1e5, 1e6),
            lambda x: scenes.row(stiffer=x),
        ),
    )  # fmt: skip


def measure(budget: float = 8.0) -> Iterator[dict]:
    """One result for each sort: values, seconds, steps, slope and whether it keeps what was asked."""
    for sort in sorts():
        built = [(sort.scene(value), sort.accuracy(value)) for value in sort.values]
        runs = [solve(scene, accuracy) for scene, accuracy in built]
        assert all(run.status == "done" for run in runs), [run.status for run in runs]
        seconds = least([in_solver(lambda s=s, a=a: solve(s, a)) for s, a in built], budget=budget, fewest=5)
        yield {
            "name": sort.name, "over": sort.over, "values": list(sort.values), "seconds": seconds,
            "steps": [run.steps for run in runs], "events": [run.events for run in runs],
            **judged(sort.values, seconds, sort.most, sort.whole),
        }  # fmt: skip


def judged(values: Sequence[float], seconds: Sequence[float], most: float | None, whole: bool) -> dict:
    """Slope of the straight line through log time over log value, ratio of the last time to the first, verdict."""
    slope = float(np.polyfit(np.log(values), np.log(seconds), 1)[0])
    ratio = seconds[-1] / seconds[0]
    met = None if most is None else (ratio if whole else slope) <= most
    return {"slope": slope, "ratio": ratio, "most": most, "whole": whole, "met": met}
