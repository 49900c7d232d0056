"""What changed between two results files: study, versions, scenes, and the numbers beyond the error both carry."""

from __future__ import annotations

import difflib
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli.results.results import Results
from pounding_cli.variables import COUNTED, ITSELF, RESPONSES

if TYPE_CHECKING:
    import pandas as pd

ROUNDING = 1e-12
"""Relative difference [-] that two machines may show in the same computation."""

SOFTWARE = ("pounding_cli", "solver", "python", "numpy", "scipy", "numba", "h5py", "platform", "machine")

_SCENE = ("case", "analysis", "record")

_TABLES: dict[str, tuple[str, ...]] = {
    "storey": ("building", "storey"),
    "floor": ("building", "floor"),
    "link": ("link",),
}
_GIVEN: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "buildings": (("building", "storey"), ("mass", "height", "stiffness", "yield_shear", "period", "separation")),
    "records": (("record",), ("scale", "window", "pga", "arias")),
}


@dataclass(frozen=True)
class Comparison:
    """What changed from a first results file to a second.

    Attributes
    ----------
    lines : of the study as written, "-" gone and "+" new
    keys : of the study with every default filled in: key, before, after
    software : name, before, after
    removed, added : scenes that only the first or only the second has, in words
    outcomes : scene, status before, status after
    changes : numbers that differ beyond the error carried, worst first: table, column, place, before, after,
        difference and carried (relative [-])
    compared : how many numbers were compared
    unestimated : scenes with no error estimate in one of the files
    """

    lines: tuple[str, ...]
    keys: tuple[tuple[str, Any, Any], ...]
    software: tuple[tuple[str, str, str], ...]
    removed: tuple[str, ...]
    added: tuple[str, ...]
    outcomes: tuple[tuple[str, str, str], ...]
    changes: pd.DataFrame
    compared: int
    unestimated: int

    @property
    def same_numbers(self) -> bool:
        """Whether both files hold the same scenes with the same outcomes and the same numbers."""
        return not (self.removed or self.added or self.outcomes or len(self.changes))

    @property
    def same(self) -> bool:
        """Whether, beyond that, both studies come to the same; words, comments and versions do not count."""
        return self.same_numbers and not self.keys


def compare(first: Results, second: Results) -> Comparison:
    """Compare two results files, scene by scene and number by number.

    A peak storey shear, drift or ductility has changed where it differs, relative to itself, by more than the two
    estimated errors of its scene together.  Numbers near zero (accelerations, residual drifts, link forces ...) are
    judged against the largest of their kind in the scene, by the larger of the estimate and the accuracy asked;
    so are the peaks of buildings alone.  Where there is no estimate the accuracy asked stands in; a fixed-step method
    has none, and is compared to rounding; so are the points of a model of its own.  Counts are compared exactly.

    """
    import pandas as pd

    before, after = _scenes(first), _scenes(second)
    removed, added = before.index.difference(after.index, sort=False), after.index.difference(before.index, sort=False)
    both = before.index.intersection(after.index, sort=False)
    one, other = before.loc[both], after.loc[both]
    failed = one["status"] != other["status"]
    outcomes = zip(map(_words, both[failed]), one["status"][failed], other["status"][failed], strict=True)
    found, compared = [], 0
    if len(both):
        carried = one[["estimated", "asked"]] + other[["estimated", "asked"]]
        for changes, count in _numbers(first, second, carried):
            found.append(changes)
            compared += count
    changes = pd.concat(found) if found else _changed("", "", [], [], [], [], [])
    excess = changes["difference"] / changes["carried"]
    return Comparison(
        tuple(_lines(first.study_text, second.study_text)),
        tuple(_keys(first.resolved, second.resolved)),
        tuple(_software(first.attrs, second.attrs)),
        tuple(map(_words, removed)),
        tuple(map(_words, added)),
        tuple(outcomes),
        changes.iloc[np.argsort(-excess.to_numpy(), kind="stable")].reset_index(drop=True),
        compared,
        int((one["error_estimate"].isna() | other["error_estimate"].isna()).sum()),
    )


def _scenes(results: Results) -> pd.DataFrame:
    """Status and errors [-] by place: `estimated` of its peaks, `asked` where the estimate does not speak."""
    frame = results.accuracy()
    accuracy = frame["accuracy"].fillna(0.0)  # none is asked of fixed steps
    frame["estimated"] = frame["error_estimate"].fillna(accuracy).clip(lower=ROUNDING / 2)
    frame["asked"] = np.maximum(frame["estimated"], accuracy)
    return frame.set_index(_named(results, _SCENE))


def _numbers(first: Results, second: Results, carried: pd.DataFrame) -> Iterator[tuple[pd.DataFrame, int]]:
    """Changes and the number of numbers compared, column by column."""
    scene = _named(first, _SCENE)
    for table, places in _TABLES.items():
        keys = [*scene, *places]
        inner = list(range(len(scene), len(keys)))  # levels below the scene
        one, other = (results.table(table).set_index(keys) for results in (first, second))
        # Scenes only one file has were told; a storey or link only one has shows as a number beside a NaN.
        rows: Any = one.index.union(other.index, sort=False)
        rows = rows[rows.droplevel(inner).isin(carried.index)]
        one, other = one.reindex(rows), other.reindex(rows)
        errors = carried.loc[rows.droplevel(inner)]
        group = [rows.get_level_values(name) for name in scene]
        for variable in (v for v in RESPONSES if v.judged):
            column = variable.name
            if column not in one and column not in other:
                continue
            a, b = (np.asarray(each.get(column, np.full(len(rows), np.nan)), float) for each in (one, other))
            size = np.fmax(np.abs(a), np.abs(b))
            # The estimate of a building alone stands in no table: it is no worse than the accuracy asked.
            estimated = variable.judged == ITSELF and not variable.alone
            error = errors["estimated" if estimated else "asked"].to_numpy()
            if variable.judged == COUNTED:
                error = np.zeros_like(error)
            elif variable.judged != ITSELF:  # near zero it has no relative error
                kinds = one[variable.judged].abs().combine(other[variable.judged].abs(), np.fmax)
                size = kinds.groupby(group).transform("max").to_numpy(float)
            yield _differing(table, column, rows, a, b, size, error), len(rows)
    for table, (places, columns) in _GIVEN.items():
        one, other = first.table(table), second.table(table)
        keys = [name for name in one.columns if name in first.axes and name in other.columns] + list(places)
        one, other = one.set_index(keys), other.set_index(keys)
        rows = one.index.intersection(other.index, sort=False).unique()
        one, other = one.loc[rows], other.loc[rows]
        if len(one) != len(other):  # a sweep that only one of the files has: its studies' lines tell
            continue
        for column in columns:
            a, b = one[column].to_numpy(float), other[column].to_numpy(float)
            error = np.full(len(a), ROUNDING)
            yield _differing(table, column, one.index, a, b, np.fmax(np.abs(a), np.abs(b)), error), len(a)


def _differing(table: str, column: str, rows: pd.Index, a, b, size, error) -> pd.DataFrame:
    """The rows at which a and b differ by more than `error` of `size`; NaN on one side alone differs without end."""
    with np.errstate(invalid="ignore", divide="ignore"):
        apart = np.where(a == b, 0.0, np.abs(a - b))  # equal infinities are equal
        difference = np.where(apart == 0, 0.0, apart / size)
    difference = np.where(np.isnan(a) & np.isnan(b), 0.0, np.where(np.isnan(a) != np.isnan(b), np.inf, difference))
    at = np.flatnonzero(difference > error)
    return _changed(table, column, [_words(row) for row in rows[at]], a[at], b[at], difference[at], error[at])


def _changed(table, column, place, before, after, difference, carried) -> pd.DataFrame:
    import pandas as pd

    columns = {"place": place, "before": before, "after": after, "difference": difference, "carried": carried}
    frame = pd.DataFrame(columns).astype(dict.fromkeys(("before", "after", "difference", "carried"), float))
    frame.insert(0, "table", table)
    frame.insert(1, "column", column)
    return frame


def _named(results: Results, places: tuple[str, ...]) -> list[str]:
    return [*results.axes, *places]


def _words(place: Any) -> str:
    return ", ".join(map(str, place)) if isinstance(place, tuple) else str(place)


def _lines(first: str, second: str) -> Iterator[str]:
    for line in difflib.unified_diff(first.splitlines(), second.splitlines(), lineterm="", n=0):
        if not line.startswith(("---", "+++", "@@")):
            yield line


def _keys(first: dict[str, Any], second: dict[str, Any]) -> Iterator[tuple[str, Any, Any]]:
    one, other = dict(_flat(first)), dict(_flat(second))
    for key in dict.fromkeys((*one, *other)):
        if one.get(key) != other.get(key):
            yield key, one.get(key), other.get(key)


def _flat(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Dotted keys with their values; what is derived from them is left out."""
    if not isinstance(value, dict):
        yield path, value
        return
    for key, item in value.items():
        if not (key == "derived" or (not path and key in ("places", "separation"))):
            yield from _flat(item, f"{path}.{key}" if path else key)


def _software(first: dict[str, Any], second: dict[str, Any]) -> Iterator[tuple[str, str, str]]:
    for name in SOFTWARE:
        one, other = (str(attrs.get(f"software_{name}", "-")) for attrs in (first, second))
        if one != other:
            yield name, one, other
