"""`keep: histories`: which rows of the tables are kept over time, and how much that comes to."""

from __future__ import annotations

import dataclasses
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli.model.scene import Scene
from pounding_cli.study import schema
from pounding_cli.study.file import Problems, get, nearest
from pounding_cli.study.plan import Plan
from pounding_cli.study.schema import Histories, Keep
from pounding_cli.study.words import value_at

if TYPE_CHECKING:
    from pounding_cli.study.study import Study

MOST_BYTES = 2_000_000_000
"""Histories of a study may take so much [bytes] before compression."""


def wanted(model: Any) -> Histories | None:
    """What is to be kept; None where nothing is."""
    if model.keep is None:
        return None
    spec = model.keep.histories if isinstance(model.keep, Keep) else Histories()
    return spec if isinstance(spec, Histories) else Histories()


def check_keep(study: Study, model: Any, problems: Problems) -> None:
    """Note every name under `keep` that the study does not have, and a method that keeps no histories."""
    spec = wanted(model)
    if spec is None:
        return
    if model.method != "taylor":
        message = f"method: {model.method} keeps no histories, only taylor does"
        problems.at(study.root, ("keep",), message, "write `method: taylor`, or remove `keep`", key=True)
    _chosen(study, model, spec, problems)


def _chosen(study: Study, model: Any, spec: Histories, problems: Problems) -> list[list[int]]:
    """The places that are kept on every axis, among the cases, analyses and motions; unknown names are noted."""
    root, path = study.root, ("keep", "histories")
    chosen = [list(range(len(axis))) for axis in study.axes]
    swept = {name: (number, column) for number, axis in enumerate(study.axes) for column, name in enumerate(axis.names)}
    for key in spec.where:
        if key not in swept:
            message, hint = f"keep: '{key}' is not an axis of the sweep", nearest(key, swept)
            problems.at(root, (*path, "where", key), message, hint, key=True)
            continue
        (number, column), steps = swept[key], tuple(key.split("."))
        texts = [given[column] for given in study.axes[number].given]
        values, kept = [value_at(schema.Study, steps, text) for text in texts], set[int]()
        words = get(root, *path, "where", key)
        for place, word in enumerate(words if isinstance(words, list) else [words]):
            value = value_at(schema.Study, steps, word)
            mine = [n for n, each in enumerate(values) if _is_same(value, each)]
            kept.update(mine)
            if not mine:
                at: Any = (*path, "where", key, *([place] if isinstance(words, list) else []))
                hint = f"known: {', '.join(dict.fromkeys(map(str, texts)))}"
                problems.at(root, at, f"keep: the axis '{key}' has no value {word}", hint)
        chosen[number] = [place for place in chosen[number] if place in kept]
    for name, one, known in (
        ("cases", "case", list(model.cases)),
        ("analyses", "analysis", list(model.analyses)),
        ("records", "record", list(study.motions(study.base))),
    ):
        names = getattr(spec, name)
        for place, word in enumerate(names or ()):
            if known and word not in known:
                message = f"keep: the study has no {one} '{word}'"
                problems.at(root, (*path, name, place), message, nearest(word, known))
        chosen.append([place for place, each in enumerate(known) if names is None or each in names])
    return chosen


def _is_same(one: float | str, other: float | str) -> bool:
    """Whether two values are one, in whatever units they are written."""
    if isinstance(one, str) or isinstance(other, str):
        return one == other
    return math.isclose(one, other, rel_tol=1e-9)


def kept_rows(plan: Plan) -> Plan:
    """The plan with the rows whose scenes are kept, and their output step [s].

    Raises
    ------
    InputError : they would take more than MOST_BYTES
    """
    study, spec = plan.study, wanted(plan.study.model)
    if spec is None:
        return plan
    mask = np.zeros(plan.shape, bool)
    mask[np.ix_(*_chosen(study, study.model, spec, Problems("")))] = True
    rows, size = np.flatnonzero(mask).tolist(), 0.0
    for seen, row in enumerate(rows, start=1):
        size += _bytes_of(plan.build(row), spec.every)
        if size > MOST_BYTES:  # the rest will be like those seen
            problems, whole = Problems(study.file), size / seen * len(rows)
            taken = f"about {whole / 1e9:.3g} GB; the most is {MOST_BYTES / 1e9:g} GB"
            message = f"histories of {len(rows)} scenes every {1000 * spec.every:g} ms take {taken}"
            hint = (
                "keep fewer, e.g. `keep: {histories: {cases: [..], records: [..], where: {..}}}`, or a longer `every:`"
            )
            problems.at(study.root, ("keep",), message, hint, key=True)
            problems.check()
    return dataclasses.replace(plan, kept=tuple(map(plan.row, rows)), every=spec.every)


def _bytes_of(scene: Scene, every: float) -> float:
    """Bytes of the histories of a scene: at every output time four a value, eight for the time itself."""
    storeys = max(building.storeys for building in scene.buildings)
    series = 8 + len(scene.buildings) * (4 * storeys + 2) + len(scene.links)
    return (4.0 * series + 8.0) * (scene.motion.duration + scene.tail) / every
