"""Histories that a study keeps: which rows, and whether they take too much memory."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from pounding_cli.errors import Issue, KeyPath
from pounding_cli.model.scene import Scene
from pounding_cli.study.schema import study as schema
from pounding_cli.study.schema.lookup import value_at
from pounding_cli.study.schema.study import HistoriesSpec, KeepSpec
from pounding_cli.study.text.file import Map, get, nearest
from pounding_cli.study.vary.axes import Axis

MAX_BYTES_OF_HISTORIES = 2_000_000_000
"""Histories of a study may take so much [bytes] before compression."""

PATH: KeyPath = ("keep", "histories")


def requested_histories(spec: Any) -> HistoriesSpec | None:
    """Return which histories are to be kept; None where none is.

    spec : the validated section `keep`
    """
    if spec is None:
        return None
    histories = spec.histories if isinstance(spec, KeepSpec) else HistoriesSpec()
    return histories if isinstance(histories, HistoriesSpec) else HistoriesSpec()


def find_keep_issues(
    specs: Mapping[Any, Any], cases: Sequence[str], motions: Sequence[str], tree: Map, axes: Sequence[Axis]
) -> list[Issue]:
    """Return every name under `keep` that the study does not have, and a method that keeps no histories.

    specs : validated sections of the study
    cases, motions : names; motions are empty where they are not known
    """
    histories = requested_histories(specs.get(("keep",)))
    if histories is None:
        return []
    issues = []
    method = specs.get(("method",)) or "taylor"
    if method != "taylor":
        message = f"method: {method} keeps no histories, only taylor does"
        issues.append(Issue(("keep",), message, "write `method: taylor`, or remove `keep`", at_key=True))
    names = {"cases": cases, "analyses": specs.get(("analyses",)) or (), "records": motions}
    _, found = choose_rows(histories, names, tree, axes)
    return issues + found


def choose_rows(
    histories: HistoriesSpec, names: Mapping[str, Sequence[str]], tree: Map, axes: Sequence[Axis]
) -> tuple[list[list[int]], list[Issue]]:
    """Return the places that are kept on every axis, among cases, analyses and motions, and unknown names.

    names : of cases, analyses and records
    """
    issues: list[Issue] = []
    chosen = [list(range(len(axis))) for axis in axes]
    for key in histories.where:
        numbers = [number for number, axis in enumerate(axes) if key in axis.names]
        if not numbers:
            swept = [name for axis in axes for name in axis.names]
            message = f"keep: '{key}' is not an axis of the sweep"
            issues.append(Issue((*PATH, "where", key), message, nearest(key, swept), at_key=True))
            continue
        number = numbers[0]
        places, unknown = _find_places(key, axes[number], tree)
        issues += unknown
        chosen[number] = [place for place in chosen[number] if place in places]
    for section, all_names in names.items():
        wanted = getattr(histories, section)
        texts = list(map(str, all_names))
        for place, word in enumerate(wanted or ()):
            if texts and word not in texts:
                message = f"keep: '{word}' is none of the {section}"
                issues.append(Issue((*PATH, section, place), message, nearest(word, texts)))
        chosen.append([place for place, text in enumerate(texts) if wanted is None or text in wanted])
    return chosen, issues


def _find_places(key: str, axis: Axis, tree: Map) -> tuple[set[int], list[Issue]]:
    """Return the places of an axis at which a key has one of the values under `where`, and values that it has not."""
    column = axis.names.index(key)
    swept = [row[column] for row in axis.values]
    written = get(tree, *PATH, "where", key)
    is_list = isinstance(written, list)
    places: set[int] = set()
    issues = []
    for number, word in enumerate(written if is_list else [written]):
        value = value_at(schema.StudySpec, tuple(key.split(".")), word)
        equal = [place for place, each in enumerate(swept) if _is_equal(value, each)]
        places.update(equal)
        if not equal:
            path = (*PATH, "where", key, *([number] if is_list else []))
            values = ", ".join(dict.fromkeys(axis.display_values(place)[column] for place in range(len(swept))))
            issues.append(Issue(path, f"keep: the axis '{key}' has no value {word}", f"known: {values}"))
    return places, issues


def _is_equal(one: float | str, other: float | str) -> bool:
    """Return whether two values are the same, in whatever units they are written."""
    if isinstance(one, str) or isinstance(other, str):
        return one == other
    return math.isclose(one, other, rel_tol=1e-9)


def count_bytes(scene: Scene, every: float) -> float:
    """Return the bytes of the histories of a scene: at every output time four a value, eight for the time itself.

    every : output step [s]
    """
    storeys = max(building.storeys for building in scene.buildings)
    series = 8 + len(scene.buildings) * (4 * storeys + 2) + len(scene.links)
    return (4.0 * series + 8.0) * (scene.motion.duration + scene.tail) / every
