"""What changed between two results files: study, versions, scenes, and the numbers beyond the error both carry."""

from __future__ import annotations

import difflib
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli.results.results import Results
from pounding_cli.variables import COUNTED, ITSELF, PLACE, RESPONSES

if TYPE_CHECKING:
    import pandas as pd

ROUNDING = 1e-12
"""Relative difference [-] that two machines may show in the same computation."""

SOFTWARE = ("pounding_cli", "solver", "python", "numpy", "scipy", "numba", "h5py", "platform", "machine")

_TABLES = {"storey": ("building", "storey"), "floor": ("building", "floor"), "link": ("link",)}
_GIVEN = {
    "buildings": (("building", "storey"), ("mass", "height", "stiffness", "yield_shear", "period", "separation")),
    "records": (("record",), ("scale", "window", "pga", "arias")),
}
_CHANGES = {"table": str, "column": str, "place": str, "before": float, "after": float, "difference": float,
            "carried": float}  # fmt: skip


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

    lines: list[str]
    keys: list[tuple[str, Any, Any]]
    software: list[tuple[str, str, str]]
    removed: list[str]
    added: list[str]
    outcomes: list[tuple[str, str, str]]
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
    has none, and is compared to rounding.  Counts are compared exactly.
    """
    import pandas as pd

    before, after = _scenes(first), _scenes(second)
    both = before.index.intersection(after.index, sort=False)
    one, other = before.loc[both], after.loc[both]
    failed = one["status"] != other["status"]
    parts = []
    if len(both):
        parts = [*_responses(first, second, one[_ERRORS] + other[_ERRORS]), *_given(first, second)]
    found = [_differing(*part) for part in parts]
    changes = (pd.concat(found) if found else pd.DataFrame(columns=list(_CHANGES))).astype(_CHANGES)
    worst_first = np.argsort(-(changes["difference"] / changes["carried"]).to_numpy(), kind="stable")
    lines = difflib.unified_diff(first.study_text.splitlines(), second.study_text.splitlines(), lineterm="", n=0)
    software = [
        (name, *(str(each.attrs.get(f"software_{name}", "-")) for each in (first, second))) for name in SOFTWARE
    ]
    return Comparison(
        [line for line in lines if not line.startswith(("---", "+++", "@@"))],
        list(_keys(first.resolved, second.resolved)),
        [(name, ours, theirs) for name, ours, theirs in software if ours != theirs],
        list(map(_words, before.index.difference(after.index, sort=False))),
        list(map(_words, after.index.difference(before.index, sort=False))),
        list(zip(map(_words, both[failed]), one["status"][failed], other["status"][failed], strict=True)),
        changes.iloc[worst_first].reset_index(drop=True),
        sum(len(rows) for _, _, rows, *_ in parts),
        int((one["error_estimate"].isna() | other["error_estimate"].isna()).sum()),
    )


_ERRORS = ["estimated", "asked"]

Part = tuple[str, str, Any, np.ndarray, np.ndarray, np.ndarray, Any]
"""Table, column, places, numbers before and after, what differences are relative to, and the errors carried [-]."""


def _scenes(results: Results) -> pd.DataFrame:
    """Status and errors [-] by place: `estimated` of its peaks, `asked` where the estimate does not speak."""
    frame = results.accuracy()
    accuracy = frame["accuracy"].fillna(0.0)  # none is asked of fixed steps
    frame["estimated"] = frame["error_estimate"].fillna(accuracy).clip(lower=ROUNDING / 2)
    frame["asked"] = np.maximum(frame["estimated"], accuracy)
    return frame.set_index([*results.axes, *PLACE])


def _responses(first: Results, second: Results, carried: pd.DataFrame) -> Iterator[Part]:
    """Every column of what scenes did; `carried`: errors of the scenes that both files have."""
    scene = [*first.axes, *PLACE]
    for table, places in _TABLES.items():
        inner = list(range(len(scene), len(scene) + len(places)))  # levels below the scene
        one, other = (results.table(table).set_index([*scene, *places]) for results in (first, second))
        # Scenes only one file has were told; a storey or link only one has shows as a number beside a NaN.
        rows: Any = one.index.union(other.index, sort=False)
        rows = rows[rows.droplevel(inner).isin(carried.index)]
        one, other = one.reindex(rows), other.reindex(rows)
        errors = carried.loc[rows.droplevel(inner)]
        group = [rows.get_level_values(name) for name in scene]
        for v in RESPONSES:
            if not v.judged or not (v.name in one or v.name in other):
                continue
            a, b = (np.asarray(each.get(v.name, np.full(len(rows), np.nan)), float) for each in (one, other))
            # the estimate of a building alone stands in no table: it is no worse than the accuracy asked
            error = errors["estimated" if v.judged == ITSELF and not v.alone else "asked"].to_numpy()
            size = np.fmax(np.abs(a), np.abs(b))
            if v.judged == COUNTED:
                error = np.zeros_like(error)
            elif v.judged != ITSELF:  # near zero it has no relative error
                kinds = one[v.judged].abs().combine(other[v.judged].abs(), np.fmax)
                size = kinds.groupby(group).transform("max").to_numpy(float)
            yield table, v.name, rows, a, b, size, error


def _given(first: Results, second: Results) -> Iterator[Part]:
    """Every column of buildings and motions."""
    for table, (places, columns) in _GIVEN.items():
        one, other = first.table(table), second.table(table)
        keys = [*(name for name in first.axes if name in one.columns and name in other.columns), *places]
        one, other = one.set_index(keys), other.set_index(keys)
        rows = one.index.intersection(other.index, sort=False).unique()
        one, other = one.loc[rows], other.loc[rows]
        if len(one) != len(other):  # a sweep that only one of the files has: its studies' lines tell
            continue
        for name in columns:
            a, b = one[name].to_numpy(float), other[name].to_numpy(float)
            yield table, name, one.index, a, b, np.fmax(np.abs(a), np.abs(b)), np.full(len(a), ROUNDING)


def _differing(table: str, column: str, rows: Any, a: np.ndarray, b: np.ndarray, size: Any, error: Any) -> pd.DataFrame:
    """The rows at which a and b differ by more than `error` of `size`; NaN on one side alone differs without end."""
    import pandas as pd

    with np.errstate(invalid="ignore", divide="ignore"):
        difference = np.where(a == b, 0.0, np.abs(a - b) / size)  # equal infinities are equal
    difference[np.isnan(a) & np.isnan(b)] = 0.0
    difference[np.isnan(a) != np.isnan(b)] = np.inf
    at = np.flatnonzero(difference > error)
    data = [table, column, list(map(_words, rows[at])), a[at], b[at], difference[at], error[at]]
    return pd.DataFrame(dict(zip(_CHANGES, data, strict=True)))


def _words(place: Any) -> str:
    return ", ".join(map(str, place)) if isinstance(place, tuple) else str(place)


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
