"""Differences between two results files: study, versions, rows, and the numbers beyond the error that both carry."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import pandas as pd

from pounding_cli.results.changes import changed_keys
from pounding_cli.results.results import ResultTables
from pounding_cli.variables import (
    COORDINATE_VARIABLES,
    ITSELF,
    NO_DIFFERENCE,
    RESPONSE_VARIABLES,
    SCENE_DIMS,
    Variable,
)

ROUNDING = 1e-12
"""Relative difference [-] that two machines may show in the same computation."""

SOFTWARE = ("pounding_cli", "solver", "python", "numpy", "scipy", "numba", "h5py", "platform", "machine")
"""Software and machine whose versions are compared."""

_NUMBERED = ("storey", "floor", "line")
"""Dimensions whose labels are numbers."""

CHANGE = ["table", "column", "place", "before", "after", "difference", "carried"]
"""Columns of the numbers that changed."""


@dataclass(frozen=True)
class Comparison:
    """The differences of a second results file from a first one.

    Attributes
    ----------
    lines : of the study as written, "-" gone and "+" new
    keys : of the study with every default filled in: key, before, after
    software : name, before, after
    removed, added : rows that only the first or only the second file has, in words
    outcomes : row, status before, status after
    changes : numbers that differ beyond the error carried, worst first: table, column, place, before, after,
        difference and carried (relative [-])
    compared : count of the numbers that were compared, those that only one of the files has among them
    unestimated : count of the rows with no error estimate in one of the files
    other_lines : buildings whose frame lines of one number do not stand at one place of the plan in both files
    """

    lines: list[str]
    keys: list[tuple[str, Any, Any]]
    software: list[tuple[str, str, str]]
    removed: list[str]
    added: list[str]
    outcomes: list[tuple[str, str, str]]
    changes: pd.DataFrame
    compared: int
    unestimated: int
    other_lines: list[str]

    @property
    def has_same_numbers(self) -> bool:
        """True if both files hold the same rows with the same outcomes and the same numbers."""
        return not (self.removed or self.added or self.outcomes or len(self.changes))

    @property
    def is_same(self) -> bool:
        """True if both studies are equal too; words, comments and versions do not count."""
        return self.has_same_numbers and not self.keys


def compare(first: ResultTables, second: ResultTables) -> Comparison:
    """Return the differences of two results files, row by row and number by number.

    A peak storey shear, drift or ductility has changed where it differs, relative to itself, by more than the two
    estimated errors of its row together. Numbers near zero (accelerations, residual drifts, link forces ...) are judged
    against the largest of their kind in the row, by the larger of the estimate and the accuracy asked; so are the peaks
    of buildings alone. Where there is no estimate the accuracy asked stands in; a fixed-step method has none, and is
    compared to rounding. Counts are compared exactly. A number that only one of the files has is a change.
    """
    before = _Rows(first)
    after = _Rows(second)
    common = [place for place in before.number_of if place in after.number_of]
    pair = _CommonRows(before, after, common)
    statuses = zip(common, pair.read(before, "status"), pair.read(after, "status"), strict=True)
    lines = difflib.unified_diff(first.study_text.splitlines(), second.study_text.splitlines(), lineterm="", n=0)
    changes, compared = _find_changes(pair)
    errors = [pair.read(rows, "error_estimate") for rows in (before, after)]
    return Comparison(
        lines=[line for line in lines if not line.startswith(("---", "+++", "@@"))],
        keys=changed_keys(first.study_data, second.study_data),
        software=_compare_software(first.attrs, second.attrs),
        removed=[place for place in before.number_of if place not in after.number_of],
        added=[place for place in after.number_of if place not in before.number_of],
        outcomes=[(place, old, new) for place, old, new in statuses if old != new],
        changes=changes,
        compared=compared,
        unestimated=int(np.isnan(errors).any(axis=0).sum()),
        other_lines=_find_other_lines(first, second),
    )


def _compare_software(before: Mapping[str, Any], after: Mapping[str, Any]) -> list[tuple[str, str, str]]:
    """Return name, version before and after of the software that differs."""
    versions = [(name, *(str(attrs.get(f"software_{name}", "-")) for attrs in (before, after))) for name in SOFTWARE]
    return [(name, old, new) for name, old, new in versions if old != new]


def _find_other_lines(before: ResultTables, after: ResultTables) -> list[str]:
    """Return the buildings whose frame lines of one number stand at different places of their plans in two files."""
    places = [_list_line_places(results) for results in (before, after)]
    return [name for name in places[0] if name in places[1] and not _agree(places[0][name], places[1][name])]


def _agree(one: np.ndarray, other: np.ndarray) -> bool:
    """Return whether the lines of one number stand at one place, as far as both files have them."""
    count = min(len(one), len(other))
    return bool(np.allclose(one[:count], other[:count], rtol=0.0, atol=1e-6, equal_nan=True))


def _list_line_places(results: ResultTables) -> dict[str, np.ndarray]:
    """Return where the frame lines of every building with a plan stand [m], at the first point of a sweep: across the
    row from its first line, so that a plan that is shifted has the same, and along it; shape (lines, 2)."""
    if "line_street" not in results.arrays:
        return {}
    found = {}
    names = ("line_street", "line_x")
    first = [results.arrays[name].values.reshape(-1, *results.arrays[name].shape[-2:])[0] for name in names]
    for building, street, x in zip(results.names("building"), *first, strict=True):
        is_line = np.isfinite(street) | np.isfinite(x)
        if is_line.any():
            found[building] = np.column_stack([street[is_line] - street[0], x[is_line]])
    return found


class _Rows:
    """The rows of a results file: the points of its sweep, cases, analyses and motions that were solved."""

    def __init__(self, results: ResultTables) -> None:
        self.results = results
        self.arrays = results.arrays
        self.dims = self.arrays["status"].dims

    @cached_property
    def number_of(self) -> dict[str, int]:
        """Row in words -> its number among all that the dimensions allow."""
        statuses = self.arrays["status"].values
        places = [self._list_places(dim) for dim in self.dims]
        rows = np.argwhere(statuses != "").tolist()
        names = [", ".join(where[number] for where, number in zip(places, row, strict=True)) for row in rows]
        numbers = np.ravel_multi_index(np.transpose(rows), statuses.shape).tolist() if rows else []
        return dict(zip(names, numbers, strict=True))

    def _list_places(self, dim: str) -> list[str]:
        """Return the places along a dimension in words; keys that move together are one dimension."""
        if dim in SCENE_DIMS:
            return self.results.names(dim)
        (keys,) = [keys for keys in self.results.swept if keys[0] == dim]
        columns = [self.arrays[key].values.tolist() for key in keys]
        return [_format_place(keys, values) for values in zip(*columns, strict=True)]

    def list_labels(self, dim: str) -> list[Any]:
        """Return the labels along a dimension of buildings, storeys, floors or links."""
        return list(self.arrays[dim].values.tolist())


@dataclass(frozen=True)
class _CommonRows:
    """The rows that two files have both.

    places : in words
    """

    before: _Rows
    after: _Rows
    places: Sequence[str]

    def labels(self, dim: str) -> list[Any]:
        """Return the labels along a dimension of either file."""
        return list(dict.fromkeys([*self.before.list_labels(dim), *self.after.list_labels(dim)]))

    def read(self, rows: _Rows, name: str) -> np.ndarray:
        """Return a variable of one of the files: a row each, over the labels of both; NaN where it has none."""
        array = rows.arrays[name]
        dims = array.dims[len(rows.dims) :]
        shape = array.shape[len(rows.dims) :]
        numbers = [rows.number_of[place] for place in self.places]
        values = array.values.reshape(-1, *shape)[numbers]
        if values.dtype.kind not in "iuf":
            return values
        labels = [self.labels(dim) for dim in dims]
        spread = np.full((len(numbers), *map(len, labels)), np.nan)
        known = [
            [every.index(label) for label in rows.list_labels(dim)] for dim, every in zip(dims, labels, strict=True)
        ]
        spread[np.ix_(range(len(numbers)), *known)] = values
        return spread


def _find_changes(pair: _CommonRows) -> tuple[pd.DataFrame, int]:
    """Return the numbers that changed, of rows that both files have, worst first; and the count of those compared."""
    if not pair.places:
        return pd.DataFrame(columns=CHANGE), 0
    accuracies = [np.nan_to_num(pair.read(rows, "accuracy")) for rows in (pair.before, pair.after)]
    estimates = [
        np.fmax(np.where(np.isnan(estimate), accuracy, estimate), ROUNDING / 2)
        for estimate, accuracy in zip(
            [pair.read(rows, "error_estimate") for rows in (pair.before, pair.after)], accuracies, strict=True
        )
    ]
    estimated = estimates[0] + estimates[1]
    allowed = np.fmax(estimates[0], accuracies[0]) + np.fmax(estimates[1], accuracies[1])
    frames = []
    compared = 0
    for variable in RESPONSE_VARIABLES:
        if not variable.difference_scale:
            continue
        if variable.name not in pair.before.arrays or variable.name not in pair.after.arrays:
            continue
        carried = _choose_error(variable, estimated, allowed)
        frame, count = _compare_variable(pair, variable, carried)
        frames.append(frame)
        compared += count
    if not frames:
        return pd.DataFrame(columns=CHANGE), 0
    changes = pd.concat(frames, ignore_index=True)
    with np.errstate(divide="ignore"):
        excess = changes["difference"].to_numpy(float) / changes["carried"].to_numpy(float)
    return changes.iloc[np.argsort(-excess, kind="stable")].reset_index(drop=True), compared


def _choose_error(variable: Variable, estimated: np.ndarray, allowed: np.ndarray) -> np.ndarray:
    """Return the relative error that a variable carries in every row [-].

    estimated : by the estimates of both files
    allowed : by the larger of estimate and accuracy; for numbers near zero and for buildings alone, without estimates
    """
    if variable.difference_scale == NO_DIFFERENCE:
        return np.zeros_like(allowed)
    if variable.difference_scale == ITSELF and not variable.alone:
        return estimated
    return allowed


def _compare_variable(pair: _CommonRows, variable: Variable, carried: np.ndarray) -> tuple[pd.DataFrame, int]:
    """Return the values of a variable that changed, and the count of those that were compared.

    carried : relative error of every row [-]
    """
    before = pair.read(pair.before, variable.name)
    after = pair.read(pair.after, variable.name)
    # A value that only one of the files has is compared too: its difference is infinite.
    is_known = np.isfinite(before) | np.isfinite(after)
    with np.errstate(invalid="ignore", divide="ignore"):
        difference = np.abs(before - after) / _find_scale(pair, variable, before, after)
    difference[before == after] = 0.0
    difference[np.isnan(difference)] = np.inf
    error = carried.reshape(-1, *[1] * (before.ndim - 1))
    changed = np.argwhere(is_known & (difference > error))
    dims = pair.before.arrays[variable.name].dims[len(pair.before.dims) :]
    labels = [pair.labels(dim) for dim in dims]
    at = tuple(changed.T)
    places = []
    for row, *numbers in changed.tolist():
        within = [every[number] for every, number in zip(labels, numbers, strict=True)]
        places.append(", ".join([pair.places[row], _format_place(dims, within)]))
    frame = pd.DataFrame(
        {
            "table": variable.dims[-1],
            "column": variable.name,
            "place": places,
            "before": before[at],
            "after": after[at],
            "difference": difference[at],
            "carried": carried[changed[:, 0]],
        },
        columns=CHANGE,
    )
    return frame, int(is_known.sum())


def _find_scale(pair: _CommonRows, variable: Variable, before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """Return the values that differences are relative to: the larger value itself, or the largest of another variable
    in the row, where the values may be near zero."""
    if variable.difference_scale in (ITSELF, NO_DIFFERENCE):
        return np.fmax(np.abs(before), np.abs(after))
    scales = [np.abs(pair.read(rows, variable.difference_scale)) for rows in (pair.before, pair.after)]
    larger = np.fmax(*scales).reshape(len(before), -1)
    largest = np.fmax.reduce(larger, axis=1, initial=0.0)
    return largest.reshape(-1, *[1] * (before.ndim - 1))


def _format_place(dims: Iterable[Any], place: Iterable[Any]) -> str:
    """Return a place of the tables in words: "cases.gap.gap = 0.05, gap, elastic, elcentro, stiff, storey 3"."""
    words = []
    for dim, value in zip(dims, place, strict=True):
        if dim in _NUMBERED:
            words.append(f"{dim} {value}")
        elif dim in COORDINATE_VARIABLES:
            words.append(str(value))
        else:
            words.append(f"{dim} = {value}")
    return ", ".join(words)
