"""`keep: histories`: which rows of the tables are kept over time, and how much that comes to."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from pydantic_core import PydanticCustomError

from pounding_cli.errors import InputError, Problem
from pounding_cli.model.scene import Scene
from pounding_cli.study.axes import SweepAxis
from pounding_cli.study.file import Problems, get, locate, nearest
from pounding_cli.study.plan import Row
from pounding_cli.study.quantity import Quantity
from pounding_cli.study.schema import Histories, Keep

if TYPE_CHECKING:
    from pounding_cli.study.study import Study

MOST_BYTES = 2_000_000_000
"""Histories of a study may take so much [bytes] before compression."""

COARSEST = 0.02
"""An output step above this [s] is not suggested: it would miss most contacts."""

_UNITS = ("", "m", "kg", "s", "N", "N/m", "m/s2")


def wanted(model: Any) -> Histories | None:
    """What is to be kept; None where nothing is."""
    if model.keep is None:
        return None
    spec = model.keep.histories if isinstance(model.keep, Keep) else Histories()
    return spec if isinstance(spec, Histories) else Histories()


def check_keep(study: Study, problems: Problems) -> None:
    """Note every name under `keep` that the study does not have."""
    model, root, path = study.model, study.root, ("keep", "histories")
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


def kept_rows(study: Study, rows: Sequence[Row], scenes: Mapping[str, Scene]) -> tuple[tuple[Row, ...], float]:
    """The rows whose scenes are kept, and the output step [s].

    Raises
    ------
    InputError : they would take more than MOST_BYTES
    """
    spec = wanted(study.model)
    if spec is None:
        return (), Histories().every
    chosen = []
    allowed: dict[int, set[int]] = {}
    for number, axis in enumerate(study.swept):
        for column, key in enumerate(axis.names):
            if key in spec.where:
                found = {place for _, value in _values(study.root, key) for place in _places(axis, column, value)}
                allowed[number] = allowed.get(number, found) & found
    for row in rows:
        there = all(row.point[number] in places for number, places in allowed.items())
        if (
            there
            and (spec.cases is None or row.case in spec.cases)
            and (spec.analyses is None or row.analysis in spec.analyses)
            and (spec.records is None or row.record in spec.records)
        ):
            chosen.append(row)
    size = 0.0
    for seen, row in enumerate(chosen, start=1):
        size += _bytes_a_second(scenes[row.scene]) * _seconds(scenes[row.scene]) / spec.every
        if size > MOST_BYTES:  # the rest will be like those seen: a study may have millions
            total = size / seen * len(chosen)
            mark = locate(study.root, ("keep",), key=True)
            raise InputError(_too_much(len(chosen), spec.every, total, study.file, mark))
    return tuple(chosen), spec.every


def _too_much(count: int, every: float, size: float, file: str, mark: tuple[int, int]) -> Problem:
    fits = every * size / MOST_BYTES
    coarser = f", or coarser: `every: {1000 * fits * 1.05:.2g} ms`" if fits < COARSEST else ""
    return Problem(
        f"histories of {count} scenes every {1000 * every:g} ms take about {size / 1e9:.3g} GB; "
        f"the most is {MOST_BYTES / 1e9:g} GB",
        f"keep fewer, e.g. `keep: {{histories: {{cases: [..], records: [..], where: {{..}}}}}}`{coarser}",
        file,
        *mark,
    )


def _seconds(scene: Scene) -> float:
    return scene.motion.duration + scene.tail


def _bytes_a_second(scene: Scene) -> float:
    """Bytes of one output time: four a value, eight for the time itself."""
    storeys = max(building.storeys for building in scene.buildings)
    series = 8 + len(scene.buildings) * (4 * storeys + 2) + len(scene.links)
    return 4.0 * series + 8.0


def _values(root: Any, key: str) -> list[tuple[tuple[int, ...], Any]]:
    """The values given for one key of `where`, one or a list, each with its place in the list."""
    given = get(root, "keep", "histories", "where", key)
    if given is None:
        return []
    return [((place,), value) for place, value in enumerate(given)] if isinstance(given, list) else [((), given)]


def _places(axis: SweepAxis, column: int, wanted: Any) -> list[int]:
    """Where on an axis a value stands: as the same text, or as the same amount in other units."""
    return [place for place, values in enumerate(axis.given) if _same(values[column], wanted)]


def _same(one: Any, other: Any) -> bool:
    if one == other:
        return True
    left, right = amount(one), amount(other)
    return left is not None and right is not None and abs(left - right) <= 1e-9 * max(abs(left), abs(right))


def amount(value: Any) -> float | None:
    """A quantity in SI, whatever its unit; None for what is none."""
    for unit in _UNITS:
        try:
            return float(Quantity("value", unit, "").read(value))
        except (PydanticCustomError, TypeError, ValueError):
            continue
    return None
