"""What changed between two results files: study, versions, scenes, and the numbers beyond the error both carry."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli.results.results import Results
from pounding_cli.variables import BUILDINGS, COORDINATES, COUNTED, ITSELF, PLACE, RECORDS, RESPONSES, Variable

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

ROUNDING = 1e-12
"""Relative difference [-] that two machines may show in the same computation."""

SOFTWARE = ("pounding_cli", "solver", "python", "numpy", "scipy", "numba", "h5py", "platform", "machine")

_CHANGES = ["table", "column", "place", "before", "after", "difference", "carried"]


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
    found, compared = [pd.DataFrame(columns=_CHANGES)], 0
    for rows, count in _numbers(first, second) if len(both) else ():
        compared += count
        found += [rows] if len(rows) else []
    changes = pd.concat(found[1:] or found, ignore_index=True)
    worst_first = np.argsort(-(changes["difference"] / changes["carried"]).to_numpy(float), kind="stable")
    lines = difflib.unified_diff(first.study_text.splitlines(), second.study_text.splitlines(), lineterm="", n=0)
    versions = [[str(each.attrs.get(f"software_{name}", "-")) for each in (first, second)] for name in SOFTWARE]
    ours, theirs = (dict(_flat(each.resolved)) for each in (first, second))
    return Comparison(
        [line for line in lines if not line.startswith(("---", "+++", "@@"))],
        [(key, ours.get(key), theirs.get(key)) for key in ours | theirs if ours.get(key) != theirs.get(key)],
        [(name, old, new) for name, (old, new) in zip(SOFTWARE, versions, strict=True) if old != new],
        before.index.difference(after.index, sort=False).tolist(),
        after.index.difference(before.index, sort=False).tolist(),
        list(zip(both[failed], one["status"][failed], other["status"][failed], strict=True)),
        changes.iloc[worst_first].reset_index(drop=True),
        compared,
        int((one["error_estimate"].isna() | other["error_estimate"].isna()).sum()),
    )


def _scenes(results: Results) -> pd.DataFrame:
    """The table of accuracy by scene in words."""
    frame = results.accuracy()
    places = frame[[*results.axes, *PLACE]]
    return frame.set_index(places.apply(lambda place: _words(place.index, place), axis=1))


def _numbers(first: Results, second: Results) -> Iterator[tuple[pd.DataFrame, int]]:
    """Of every variable the numbers that changed, of scenes that both files have, and how many were compared."""
    import xarray as xr

    one, other = xr.align(first.data, second.data, join="outer", fill_value={"status": ""})
    here = (one["status"] != "") & (other["status"] != "")
    (estimated, asked), more = _errors(one), _errors(other)
    estimated, asked = estimated + more[0], asked + more[1]
    for v in (*RESPONSES, *BUILDINGS, *RECORDS):
        is_given = v not in RESPONSES
        if v.kind == "s" or v.name not in one.keys() | one.coords or v.name not in other.keys() | other.coords:
            continue
        a, b = one[v.name], other[v.name]
        size: Any = np.fmax(abs(a), abs(b))
        is_compared = np.isfinite(a) | np.isfinite(b)
        if is_given:  # what only one file has comes with its scenes
            is_compared, error = np.isfinite(a) & np.isfinite(b), xr.full_like(a, ROUNDING)
        elif not v.judged:
            continue
        else:
            # the estimate of a building alone stands in no table: it is no worse than the accuracy asked
            error = estimated if v.judged == ITSELF and not v.alone else 0.0 * asked if v.judged == COUNTED else asked
            if v.judged not in (ITSELF, COUNTED):  # near zero it has no relative error
                whole = xr.concat([abs(one[v.judged]), abs(other[v.judged])], "file")
                size = whole.max(["file", *v.dims[len(PLACE) :]])
            is_compared = is_compared & here
        with np.errstate(invalid="ignore", divide="ignore"):
            difference = (abs(a - b) / size).where(a != b, 0.0).fillna(np.inf)
        yield _changed(v, a, b, difference.where(is_compared, 0.0), error), int(is_compared.sum())


def _errors(data: xr.Dataset) -> tuple[xr.DataArray, xr.DataArray]:
    """Of every scene the error of its peaks [-]: estimated, and what was asked where the estimate does not speak."""
    accuracy = data["accuracy"].fillna(0.0)  # none is asked of fixed steps
    estimated = data["error_estimate"].fillna(accuracy).clip(ROUNDING / 2)
    return estimated, estimated.where(estimated > accuracy, accuracy)


def _changed(v: Variable, a: xr.DataArray, b: xr.DataArray, difference: xr.DataArray, error: Any) -> pd.DataFrame:
    """The places at which a and b differ by more than `error`."""
    import pandas as pd

    dims = a.dims
    error = error.broadcast_like(a).transpose(*dims)
    difference = difference.transpose(*dims)
    at = np.nonzero((difference > error).values)
    names = [a[dim].values[number] for dim, number in zip(dims, at, strict=True)]
    levels = {"link": "link", "floor": "floor", "storey": "storey", "record": "scene"}
    table = "records" if v in RECORDS else "buildings" if v in BUILDINGS else levels[str(dims[-1])]
    values = [each.transpose(*dims).values[at] for each in (a, b, difference, error)]
    places = [_words(dims, place) for place in zip(*names, strict=True)]
    column = v.name.removeprefix("record_")
    return pd.DataFrame(dict(zip(_CHANGES, [table, column, places, *values], strict=True)))


def _words(dims: Iterable[Any], place: Iterable[Any]) -> str:
    """A place of the tables: "cases.gap.gap = 0.05, gap, elastic, elcentro"."""
    named = zip(dims, place, strict=True)
    return ", ".join(str(value) if dim in COORDINATES else f"{dim} = {value}" for dim, value in named)


def _flat(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Dotted keys with their values; what is derived from them is left out."""
    if not isinstance(value, dict):
        yield path, value
        return
    for key, item in value.items():
        if not (key == "derived" or (not path and key in ("places", "separation"))):
            yield from _flat(item, f"{path}.{key}" if path else key)
