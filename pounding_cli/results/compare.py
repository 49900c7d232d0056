"""What changed between two results files: study, versions, scenes, and the numbers beyond the error both carry."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from pounding_cli.results.changes import changed_keys
from pounding_cli.results.results import ResultTables
from pounding_cli.variables import COORDINATE_VARIABLES, ITSELF, NO_DIFFERENCE, RESPONSE_VARIABLES, SCENE_DIMS

ROUNDING = 1e-12
"""Relative difference [-] that two machines may show in the same computation."""

SOFTWARE = ("pounding_cli", "solver", "python", "numpy", "scipy", "numba", "h5py", "platform", "machine")

CHANGE = ["table", "column", "place", "before", "after", "difference", "carried"]
"""What is told of a number that changed."""


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


def compare(first: ResultTables, second: ResultTables) -> Comparison:
    """Compare two results files, scene by scene and number by number.

    A peak storey shear, drift or ductility has changed where it differs, relative to itself, by more than the two
    estimated errors of its scene together.  Numbers near zero (accelerations, residual drifts, link forces ...) are
    judged against the largest of their kind in the scene, by the larger of the estimate and the accuracy asked;
    so are the peaks of buildings alone.  Where there is no estimate the accuracy asked stands in; a fixed-step method
    has none, and is compared to rounding.  Counts are compared exactly.
    """
    before, after = _scenes(first), _scenes(second)
    both = before.index.intersection(after.index, sort=False)
    one, other = before.loc[both], after.loc[both]
    failed = one["status"] != other["status"]
    changes, compared = _changes(first.data, second.data) if len(both) else (pd.DataFrame(columns=CHANGE), 0)
    lines = difflib.unified_diff(first.study_text.splitlines(), second.study_text.splitlines(), lineterm="", n=0)
    old, new = ({name: str(each.attrs.get(f"software_{name}", "-")) for name in SOFTWARE} for each in (first, second))
    return Comparison(
        [line for line in lines if not line.startswith(("---", "+++", "@@"))],
        changed_keys(first.resolved, second.resolved),
        [(name, old[name], new[name]) for name in SOFTWARE if old[name] != new[name]],
        before.index.difference(after.index, sort=False).tolist(),
        after.index.difference(before.index, sort=False).tolist(),
        list(zip(both[failed], one["status"][failed], other["status"][failed], strict=True)),
        changes,
        compared,
        int((one["error_estimate"].isna() | other["error_estimate"].isna()).sum()),
    )


def _scenes(results: ResultTables) -> pd.DataFrame:
    """The table of accuracy by scene in words."""
    frame, place = results.accuracy(), [*results.axes, *SCENE_DIMS]
    return frame.set_index(pd.Index([_words(place, at) for at in frame[place].itertuples(index=False, name=None)]))


def _changes(first: xr.Dataset, second: xr.Dataset) -> tuple[pd.DataFrame, int]:
    """The numbers that changed, of scenes that both files have, worst first; and how many were compared."""
    bare = (each.reset_coords(drop=True) for each in (first, second))  # motions differ in more than their names
    one, other = xr.align(*bare, join="outer", fill_value={"status": ""})
    here, compared, found = (one["status"] != "") & (other["status"] != ""), 0, []
    accuracies = [(each, each["accuracy"].fillna(0.0)) for each in (one, other)]  # none is asked of fixed steps
    pairs = [(each["error_estimate"].fillna(accuracy).clip(ROUNDING / 2), accuracy) for each, accuracy in accuracies]
    estimated, asked = sum(estimate for estimate, _ in pairs), sum(np.fmax(*pair) for pair in pairs)
    for v in RESPONSE_VARIABLES:
        if not (v.difference_scale and v.name in one and v.name in other):
            continue
        a, b = one[v.name], other[v.name]
        size: Any = np.fmax(abs(a), abs(b))
        error, is_known = asked, (np.isfinite(a) | np.isfinite(b)) & here
        if v.difference_scale == NO_DIFFERENCE:
            error = 0.0 * asked
        elif (
            v.difference_scale == ITSELF
        ):  # the estimate of a building alone stands in no table: it is no worse than asked
            error = asked if v.alone else estimated
        else:  # near zero it has no relative error
            whole: Any = np.fmax(abs(one[v.difference_scale]), abs(other[v.difference_scale]))
            size = whole.max(v.dims[len(SCENE_DIMS) :])
        with np.errstate(invalid="ignore", divide="ignore"):
            difference = (abs(a - b) / size).where(a != b, 0.0).fillna(np.inf).where(is_known, 0.0)
        compared += int(is_known.sum())
        numbers = xr.Dataset({"before": a, "after": b, "difference": difference, "carried": error})
        frame = numbers.to_dataframe(dim_order=list(a.dims))
        frame = frame[frame["difference"] > frame["carried"]]
        place = [_words(a.dims, each) for each in frame.index]
        found.append(frame.assign(table=str(a.dims[-1]), column=v.name, place=place).reset_index(drop=True))
    changes = pd.concat(found, ignore_index=True)
    worst = np.argsort(-(changes["difference"] / changes["carried"]).to_numpy(float), kind="stable")
    return changes.iloc[worst].reset_index(drop=True), compared


def _words(dims: Iterable[Any], place: Iterable[Any]) -> str:
    """A place of the tables: "cases.gap.gap = 0.05, gap, elastic, elcentro"."""
    named = zip(dims, place, strict=True)
    return ", ".join(str(value) if dim in COORDINATE_VARIABLES else f"{dim} = {value}" for dim, value in named)
