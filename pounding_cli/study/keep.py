"""`keep: histories`: which rows of the tables are kept over time, and how much that comes to."""

from __future__ import annotations

import dataclasses
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli.model.scene import Scene
from pounding_cli.study import schema
from pounding_cli.study.axes import SweepAxis
from pounding_cli.study.file import Problems, get, nearest
from pounding_cli.study.plan import Plan
from pounding_cli.study.schema import Histories, Keep
from pounding_cli.study.words import value_at

if TYPE_CHECKING:
    from pounding_cli.study.study import Study

MOST_BYTES = 2_000_000_000
"""Histories of a study may take so much [bytes] before compression."""

COARSEST = 0.02
"""An output step above this [s] is not suggested: it would miss most contacts."""


def wanted(model: Any) -> Histories | None:
    """What is to be kept; None where nothing is."""
    if model.keep is None:
        return None
    spec = model.keep.histories if isinstance(model.keep, Keep) else Histories()
    return spec if isinstance(spec, Histories) else Histories()


def check_keep(study: Study, model: Any, problems: Problems) -> None:
    """Note every name under `keep` that the study does not have."""
    root, path = study.root, ("keep", "histories")
    spec = wanted(model)
    if spec is None:
        return
    if model.method != "taylor":
        message = f"method: {model.method} keeps no histories, only taylor does"
        problems.at(root, ("keep",), message, "write `method: taylor`, or remove `keep`", key=True)
    for name, one, there in (
        ("cases", "case", list(model.cases)),
        ("analyses", "analysis", list(model.analyses)),
        ("records", "record", list(study.motions(study.base))),
    ):
        for place, word in enumerate(getattr(spec, name) or ()):
            if there and word not in there:
                message = f"keep: the study has no {one} '{word}'"
                problems.at(root, (*path, name, place), message, nearest(word, there))
    swept = {name: (axis, column) for axis in study.swept for column, name in enumerate(axis.names)}
    for key in spec.where:
        if key not in swept:
            hint = nearest(key, swept) if swept else "remove `where`, or add a sweep"
            problems.at(root, (*path, "where", key), f"keep: '{key}' is not an axis of the sweep", hint, key=True)
            continue
        axis, column = swept[key]
        for at, value in _values(root, key):
            if not _places(axis, column, value):
                texts = dict.fromkeys(str(values[column]) for values in axis.given)
                message = f"keep: the axis '{key}' has no value {value}"
                problems.at(root, (*path, "where", key, *at), message, f"known: {', '.join(texts)}")


def kept_rows(plan: Plan) -> Plan:
    """The plan with the rows whose scenes are kept, and their output step [s].

    Raises
    ------
    InputError : they would take more than MOST_BYTES
    """
    study, spec = plan.study, wanted(plan.study.model)
    if spec is None:
        return plan
    chosen = np.ones(plan.shape, bool)
    names = ("cases", plan.cases), ("analyses", plan.analyses), ("records", plan.records)
    for place, (key, known) in enumerate(names, start=-3):
        words = getattr(spec, key)
        is_wanted = np.array([words is None or name in words for name in known])
        chosen &= np.expand_dims(is_wanted, tuple(range(is_wanted.ndim, -place)))
    for number, axis in enumerate(study.swept):
        for column, key in enumerate(axis.names):
            if key in spec.where:
                found = {place for _, value in _values(study.root, key) for place in _places(axis, column, value)}
                is_wanted = np.isin(np.arange(len(axis)), list(found))
                chosen &= np.expand_dims(is_wanted, tuple(range(1, chosen.ndim - number)))
    rows = np.flatnonzero(chosen.ravel())
    size = 0.0
    for seen, row in enumerate(rows.tolist(), start=1):
        size += _bytes_of(plan.build(row), spec.every)
        if size > MOST_BYTES:  # the rest will be like those seen
            _refuse(study, len(rows), size / seen * len(rows), spec.every)
    return dataclasses.replace(plan, kept=tuple(plan.row(row) for row in rows.tolist()), every=spec.every)


def _refuse(study: Study, count: int, size: float, every: float) -> None:
    """Raise `InputError`: the histories would take `size` bytes."""
    fits, problems = every * size / MOST_BYTES, Problems(study.file)
    coarser = f", or coarser: `every: {1000 * fits * 1.05:.2g} ms`" if fits < COARSEST else ""
    taken = f"about {size / 1e9:.3g} GB; the most is {MOST_BYTES / 1e9:g} GB"
    message = f"histories of {count} scenes every {1000 * every:g} ms take {taken}"
    hint = f"keep fewer, e.g. `keep: {{histories: {{cases: [..], records: [..], where: {{..}}}}}}`{coarser}"
    problems.at(study.root, ("keep",), message, hint, key=True)
    problems.check()


def _bytes_of(scene: Scene, every: float) -> float:
    """Bytes of the histories of a scene: at every output time four a value, eight for the time itself."""
    storeys = max(building.storeys for building in scene.buildings)
    series = 8 + len(scene.buildings) * (4 * storeys + 2) + len(scene.links)
    return (4.0 * series + 8.0) * (scene.motion.duration + scene.tail) / every


def _values(root: Any, key: str) -> list[tuple[tuple[int, ...], Any]]:
    """The values given for one key of `where`, one or a list, each with its place in the list."""
    given = get(root, "keep", "histories", "where", key)
    if given is None:
        return []
    return [((place,), value) for place, value in enumerate(given)] if isinstance(given, list) else [((), given)]


def _places(axis: SweepAxis, column: int, wanted: Any) -> list[int]:
    """Where on an axis a value stands: as the same word, or as the same amount in other units."""
    path = tuple(axis.paths[column])
    value = value_at(schema.Study, path, wanted)

    def fits(other: float | str) -> bool:
        if isinstance(value, str) or isinstance(other, str):
            return value == other
        return math.isclose(value, other, rel_tol=1e-9)

    return [place for place, values in enumerate(axis.given) if fits(value_at(schema.Study, path, values[column]))]
