"""What a long study comes to, kept beside its results until they are whole: a run that goes on need not expand it."""

from __future__ import annotations

import hashlib
import json
import math
import zipfile
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from pounding_cli.outputs import EXPANDED
from pounding_cli.store.keys import solver_version
from pounding_cli.study.expand import expand
from pounding_cli.study.scenes import Expanded, Scenes

if TYPE_CHECKING:
    from pounding_cli.study import Plan, Study
    from pounding_cli.study.plan import Axis

MANY = 20_000
"""Points from which a plan is kept: to expand fewer takes two seconds at most."""

SAMPLE = 20
"""Scenes whose digests are compared with what the study says now."""

_SOURCES = "", "pounding_cli.study.expand", "pounding_cli.records.motion", "pounding_cli.records.columns"
"""What decides what a study comes to, besides the solver: the packages of these modules."""


def expanded_plan(study: Study, folder: Path) -> Plan:
    """The plan of `pound run`; what `folder` keeps of it need not be expanded.  Raises as `expand`."""
    try:
        with np.load(folder / EXPANDED, allow_pickle=False) as kept:
            if kept["key"].tobytes().decode() != _key(study):
                return expand(study)
            plan = expand(study, known=Expanded.of(kept))
    except (OSError, ValueError, KeyError, TypeError, EOFError, zipfile.BadZipFile):  # damaged, or of another study
        return expand(study)
    return plan if _is_sound(plan) else expand(study)


def keep_expanded(plan: Plan, folder: Path) -> None:
    """Keep in a folder what a plan of many points of `pound run` rests on.  Raises `OSError`."""
    path = folder / EXPANDED
    if plan.workflow != "run" or not is_long(plan.axes):
        return
    key = np.frombuffer(_key(plan.study).encode(), np.uint8)
    try:
        with np.load(path, allow_pickle=False) as kept:
            if np.array_equal(kept["key"], key):
                return
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
        pass
    folder.mkdir(parents=True, exist_ok=True)
    hidden = folder / f".{EXPANDED}.tmp"
    try:
        with hidden.open("wb") as stream:
            np.savez(stream, allow_pickle=False, key=key, **plan.rows.expanded.arrays())
        hidden.replace(path)
    except OSError:
        hidden.unlink(missing_ok=True)
        raise


def is_long(axes: Sequence[Axis]) -> bool:
    """Whether a sweep has so many points that expanding it takes long."""
    return math.prod(len(axis.values) for axis in axes) >= MANY


def study_key(study: Study, all_effects: bool) -> str:
    """A digest of all that the results of `pound run` follow from, made without expanding the study."""
    said = _key(study), study.title, study.text, str(all_effects)
    return hashlib.sha256("\0".join(said).encode()).hexdigest()


def _key(study: Study) -> str:
    """A digest of all that decides what a study comes to: what it says, its motions, this program."""
    said = [
        *map(solver_version, _SOURCES),
        json.dumps(study.root, default=str),
        repr(study.axes),
        *sorted(study.reader.digests),
        *(used.motion.digest for used in study.motions(study.base).values()),
    ]
    return hashlib.sha256("\0".join(said).encode()).hexdigest()


def _is_sound(plan: Plan) -> bool:
    """Whether some scenes, spread evenly, are what the study says."""
    assert isinstance(plan.scenes, Scenes)
    for number in np.linspace(0, len(plan.scenes) - 1, SAMPLE).astype(int).tolist():
        digest = plan.scenes.table.digests[number].tobytes().hex()
        if plan.scenes.at(int(plan.scenes.first[number])).digest != digest:
            return False
    return True
