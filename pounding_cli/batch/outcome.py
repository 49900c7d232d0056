"""What a run came to: how many scenes were solved, reused, failed, and which."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Failure:
    """A scene without a result: where it stands in the study, what happened, what to do about it."""

    place: str
    status: str
    advice: str


@dataclass(frozen=True)
class Outcome:
    """Counts of scenes, each scene once: done now, failed, reused from a former run.

    path : the results file
    failures : the scenes that failed, in the order of the study
    engine, workers : how the scenes were solved
    solver_seconds : time inside the solver now, all workers together [s]
    wall_seconds : from start to file [s]
    """

    path: Path
    done: int
    failed: int
    reused: int
    failures: tuple[Failure, ...]
    engine: str
    workers: int
    solver_seconds: float
    wall_seconds: float
