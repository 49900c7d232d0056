"""The evidence of a report: a results file at one point of its sweep, and the names of what is there."""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from pounding_cli.numbers import Unit, join_limited
from pounding_cli.results.flags import FlagGroup, flag_groups_of
from pounding_cli.study.schema.archetypes import is_sample_key
from pounding_cli.variables import VARIABLES

if TYPE_CHECKING:
    import xarray as xr

    from pounding_cli.results.results import ResultTables

MARK = "†"
"""Stands behind the name of a case whose numbers mean nothing for some motions."""
MAX_PAGE_CASES = 40
"""Cases in the figures and on the page; the tables hold all."""

_MAX_CHARACTERS_OF_NAMES = 300
# About three lines, of which the captions of figures hold few more.

RESPONSES = (("elastic", "V_ratio"), ("inelastic", "mu_ratio"))
"""Analysis and ratio to the building alone that stand for the response, as in Figs 6 and 7 of the paper."""


@dataclass(frozen=True, eq=False)
class Evidence:
    """A results file at one point of its sweep.

    results : cut to this point
    point : swept key -> value there (SI, as in the tables); empty where nothing is swept
    """

    results: ResultTables
    point: Mapping[str, Any]

    @property
    def title(self) -> str:
        """The study's title."""
        return self.results.title

    @cached_property
    def data(self) -> xr.Dataset:
        """Every variable here, without the swept axes."""
        return self.results.data.isel({keys[0]: 0 for keys in self.results.swept}, drop=True)

    @cached_property
    def link(self) -> pd.DataFrame:
        """The table of links here."""
        return self._table("link")

    @cached_property
    def records(self) -> pd.DataFrame:
        """The table of motions here."""
        return self._table("records")

    @cached_property
    def buildings(self) -> pd.DataFrame:
        """The table of buildings here."""
        return self._table("buildings")

    def _table(self, name: str) -> pd.DataFrame:
        return self.results.table(name).drop(columns=list(self.point), errors="ignore")

    @property
    def label(self) -> str:
        """The point in words and the units of the study: "cases.gap.gap = 5 cm"; empty where nothing is swept."""
        return self.format_point(self.point)

    def format_point(self, keys: Container[str]) -> str:
        """Return the values of some swept keys here, such as the columns of a table, in words."""
        return format_point(self.results, {key: value for key, value in self.point.items() if key in keys})

    def building_of_study(self, place: str) -> dict[str, Any]:
        """Return the building of the study that stands at a place of the group."""
        number = self.results.study_data["places"].index(place)
        return dict(self.results.study_data["buildings"][self.results.study_data["group"][number]])

    def rows_here(self, frame: pd.DataFrame) -> pd.DataFrame:
        """Return the rows of a table of the whole file at this point; swept keys that are no column do not matter."""
        for key in (key for key in self.point if key in frame):
            frame = frame[frame[key] == self.point[key]]
        return frame

    def unit(self, column: str) -> Unit:
        """Return the unit that a column is shown in: that of the study, SI where it is not known."""
        return self.results.units.get(column, Unit(VARIABLES[column].unit))

    def names(self, dim: str) -> list[str]:
        """Return the names along a dimension (case, analysis, building, record), in the order of the file."""
        return self.results.names(dim)

    @property
    def cases(self) -> list[str]:
        """All cases."""
        return self.names("case")

    @property
    def analyses(self) -> list[str]:
        """All analyses."""
        return self.names("analysis")

    @property
    def group(self) -> list[str]:
        """Buildings by place, left to right."""
        return self.names("building")

    @cached_property
    def buildings_without_walls(self) -> list[str]:
        """The buildings of the group, without walls."""
        return [name for name in self.group if name not in self.results.walls]

    @cached_property
    def periods(self) -> dict[str, float]:
        """Fundamental period of every building of the group [s]."""
        return dict(zip(self.group, self.results.values("period").reshape(-1).tolist(), strict=True))

    @cached_property
    def main_building(self) -> str:
        """The building that comes first: `report: {building: NAME}` of the study, else the one of shortest period."""
        chosen = (self.results.study_data.get("report") or {}).get("building")
        if chosen in self.group:
            return str(chosen)
        return min(self.buildings_without_walls, key=lambda name: self.periods[name])

    @cached_property
    def plotted_cases(self) -> list[str]:
        """The cases of the figures: `report: {plot: [..]}` of the study, else all of them; at most MAX_PAGE_CASES."""
        chosen = (self.results.study_data.get("report") or {}).get("plot") or self.cases
        return [case for case in self.cases if case in chosen][:MAX_PAGE_CASES]

    def values(self, name: str, **places: str) -> np.ndarray:
        """Return a variable here, over its dimensions but the swept axes and those whose `places` are given."""
        array = self.results.arrays[name]
        key = tuple(
            0 if dim in self.point else self.names(dim).index(places[dim]) if dim in places else slice(None)
            for dim in array.dims
        )
        return array.values[key]

    @cached_property
    def flag_groups(self) -> tuple[FlagGroup, ...]:
        """The flags of every case and analysis here."""
        return flag_groups_of(self._table("scene"))

    @cached_property
    def void(self) -> set[tuple[str, str]]:
        """Cases and analyses of which some scenes carry a flag that takes the meaning from their numbers."""
        return {(group.case, group.analysis) for group in self.flag_groups if group.meaningless}

    def mark_case(self, case: str) -> str:
        """Return the name of a case, with MARK where the numbers of some of its scenes mean nothing."""
        return f"{case} {MARK}" if case in {named for named, _ in self.void} else case


def format_point(results: ResultTables, row: Mapping[Any, Any]) -> str:
    """Return the swept keys of a row in the units of the study: "cases.gap.gap = 5 cm"; "" where it has none."""
    keys = [key for key in results.axes if key in row]
    medians = [key.split(".")[1] for key in keys if is_sample_key(key) and row[key] == 0]
    others = [
        f"{key} = {results.value_label(key, row[key])}" for key in keys if not is_sample_key(key) or row[key] != 0
    ]
    median = f"the median {'building' if len(medians) == 1 else 'buildings'} {' and '.join(medians)}"
    return ", ".join([*others, *([median] if medians else [])])


def list_acting_keys(results: ResultTables, case: str) -> list[str]:
    """Return the swept keys that a case may depend on: all but those of other cases alone."""
    others = tuple(f"cases.{other}." for other in results.names("case") if other != case)
    return [key for keys in results.swept for key in keys if not all(each.startswith(others) for each in keys)]


def list_points(results: ResultTables, keys: Sequence[str]) -> list[tuple[Any, ...]]:
    """Return the points of the axis of some swept keys: a value of every key."""
    return list(zip(*(results.axes[key] for key in keys), strict=True))


def build_evidence(results: ResultTables, index: Mapping[str, int]) -> Evidence:
    """Return the evidence at a point: on every axis, by its first key, the number of a value."""
    point = {key: results.axes[key][index[keys[0]]] for keys in results.swept for key in keys}
    return Evidence(results.cut(index), point)


def find_nominal(results: ResultTables) -> Evidence:
    """Return the evidence where every axis has the value of the study without its sweep, or else its first value.

    Where that point was not solved, it is the first one that was.
    """
    index = {}
    for keys in results.swept:
        points = list_points(results, keys)
        written = tuple(find_written_value(results, key) for key in keys)
        index[keys[0]] = points.index(written) if written in points else 0
    solved = (results.values("status") != "").any(axis=(-3, -2, -1))  # over the swept axes
    if not solved[tuple(index.values())] and solved.any():
        index = dict(zip(index, np.argwhere(solved)[0].tolist(), strict=True))
    return build_evidence(results, index)


def find_written_value(results: ResultTables, key: str) -> Any:
    """Return the value of a swept key in the study without its sweep; None where it writes none."""
    return _get_at(results.study_data, key.split("."))


def _get_at(tree: Any, path: Iterable[str]) -> Any:
    """Return the value at a path in nested mappings; None where there is none."""
    for part in path:
        tree = tree.get(part) if isinstance(tree, Mapping) else None
    return tree


def describe_motions(records: pd.DataFrame) -> str:
    """Return the motions by where they come from: "Motions: real: taft; stand-in: elcentro, eureka.".

    Of many motions of one kind the first are named; the table of motions has all.
    """
    kinds = records.drop_duplicates("record").groupby("source", sort=False)["record"].agg(_join_names)
    return f"Motions: {'; '.join(f'{kind}: {named}' for kind, named in kinds.items())}."


def _join_names(names: Iterable[str]) -> str:
    """Return names of motions joined by commas, of very many the first and how many are left."""
    return join_limited(names, max_characters=_MAX_CHARACTERS_OF_NAMES)
