"""Small studies of every kind, and runs of them that may be killed."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from signal import SIGKILL
from typing import Any
from unittest.mock import patch

import pounding_cli as pound

PAIR = """\
title: Two small buildings
records: {use: [elcentro, taft], duration: 3 s, scale: {pga: 0.3 g}}
buildings:
  A: {storeys: 2, period: 0.3 s}
  B: {like: A, storeys: 1, period: 0.5 s}
group: [A, B]
cases: {near: {link: pounding, gap: 3 mm}}
analyses: [inelastic]
"""

STUDIES = {
    "run": "sweep: {cases.near.gap: {from: 0 mm, to: 30 mm, step: 1 mm}}\n"
    "keep: {histories: {where: {cases.near.gap: 3 mm}}}\n",
    "gap": "sweep: {buildings.B.period: {from: 0.4 s, to: 0.9 s, count: 12}}\ngap: {contact: 10 %}\n",
    "fragility": "sweep: {records.scale.pga: {from: 0.05 g, to: 1 g, step: 0.05 g}}\n"
    "fragility: {limits: [mu > 2, contact], draws: 100}\n",
    "sensitivity": "uncertain:\n  buildings.A.mass: {uniform: {from: 100 t, to: 200 t}}\n"
    "  cases.near.gap: {uniform: {from: 1 mm, to: 5 mm}}\n"
    "sensitivity: {outputs: [largest V_ratio], samples: 8, draws: 100}\n",
    "optimise": "optimise:\n  least: largest V_ratio\n  over: {cases.near.gap: {from: 1 mm, to: 9 mm}}\n"
    "  population: 6\n  generations: 2\n  slice_points: 5\n",
}

THRESHOLDS = {
    "pounding_cli.batch.solve.MIN_PARALLEL_SECONDS": 1e-9,
    "pounding_cli.batch.solve.GROUP_SECONDS": 0.005,
    "pounding_cli.batch.pool.DASK_TIMEOUT": 180.0,
}
"""What the program keeps to one process and off the disk unless it takes long: here nothing, for these studies take no
time; and how long a busy machine may take to answer [s]. Nothing else of the inside is named in these tests."""


class Interrupting:
    """Progress that does something once, when so many scenes are back."""

    def __init__(self, scenes: int, action: Callable[[], Any]) -> None:
        self.left, self.action = scenes, action

    def count_solved(self, done: int, failed: int) -> None:
        before, self.left = self.left, self.left - done - failed
        if before > 0 >= self.left:
            self.action()

    def __getattr__(self, name: str) -> Callable[..., None]:
        return lambda *_, **__: None


def written(workflow: str, folder: Path) -> Path:
    """The study of a question."""
    study = folder / "pair.yaml"
    study.write_text(PAIR + STUDIES[workflow])
    return study


def answered(
    workflow: str, engine: str, study: Path, output: Path, scheduler: str = "", progress: Any = None
) -> pound.Results:
    """The results of a study, solved by two workers however small it is."""
    address = scheduler if engine == "dask" else None
    patches = [patch(name, value) for name, value in THRESHOLDS.items()]
    for each in patches:
        each.start()
    try:
        return pound.run(
            study, output, workflow=workflow, engine=engine, workers=2, scheduler=address, progress=progress
        )
    finally:
        for each in patches:
            each.stop()


def killed(workflow: str, engine: str, study: Path, output: Path, scheduler: str, scenes: int) -> None:
    """A run that kills its process with SIGKILL when so many scenes are back."""
    answered(workflow, engine, study, output, scheduler, Interrupting(scenes, lambda: os.kill(os.getpid(), SIGKILL)))
