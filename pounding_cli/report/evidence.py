"""What a report rests on: the tables of a results file at one point of its sweep, and their means."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import pandas as pd

from pounding_cli.numbers import Unit
from pounding_cli.results.flags import FlagGroup, flag_groups_of
from pounding_cli.variables import LINK, OF_COLUMNS, RESPONSES, VARIABLES

if TYPE_CHECKING:
    from pounding_cli.results.results import Results

MARK = "†"
"""Stands behind the name of a case whose numbers mean nothing for some motions."""

ROLES = ("touching", "gap", "infill", "connected")
"""The four cases of Figs 6 and 7."""


@dataclass(frozen=True, eq=False)
class Evidence:
    """The tables at one point of the sweep, without the swept columns; names are in the order of the file.

    point : swept key -> value there; empty where nothing is swept
    units : column -> the unit the study wrote it in: swept keys, gaps, accelerations
    storey, floor, link, struck, scene, records, buildings : frames as in docs/architecture.md
    """

    title: str
    resolved: dict[str, Any]
    point: dict[str, Any]
    storey: pd.DataFrame
    floor: pd.DataFrame
    link: pd.DataFrame
    scene: pd.DataFrame
    records: pd.DataFrame
    buildings: pd.DataFrame
    units: Mapping[str, Unit] = field(default_factory=dict)
    struck: pd.DataFrame = field(default_factory=pd.DataFrame)

    @property
    def label(self) -> str:
        """The point in words and the units of the study: "cases.gap.gap = 5 cm"; empty where nothing is swept."""
        return ", ".join(f"{key} = {self.units.get(key, Unit()).text(value)}" for key, value in self.point.items())

    def here(self, frame: pd.DataFrame) -> pd.DataFrame:
        """The rows of a table at this point; swept keys that are no column of it do not matter."""
        for key, value in self.point.items():
            if key in frame:
                frame = frame[frame[key] == value]
        return frame

    def unit(self, column: str) -> Unit:
        """The unit a column is shown in: that of the study, SI where it is not known."""
        return self.units.get(column, Unit(VARIABLES[column].unit))

    @cached_property
    def cases(self) -> list[str]:
        """Cases in the order of the file."""
        return names(self.scene["case"])

    @cached_property
    def analyses(self) -> list[str]:
        """Analyses in the order of the file."""
        return names(self.scene["analysis"])

    @cached_property
    def group(self) -> list[str]:
        """Buildings by place, left to right."""
        return names(self.storey["building"])

    @cached_property
    def periods(self) -> dict[str, float]:
        """Fundamental period of every building of the group [s]."""
        first = self.buildings.drop_duplicates("building").set_index("building")["period"]
        return {name: float(first[name]) for name in self.group}

    @cached_property
    def stiffer(self) -> str:
        """The building with the shortest fundamental period (the first of them, from the left)."""
        return min(self.periods, key=lambda name: self.periods[name])

    @property
    def others(self) -> list[str]:
        """Every building of the group except the stiffer one."""
        return [name for name in self.group if name != self.stiffer]

    def case_of(self, role: str) -> str | None:
        """The case that plays `role`: the one of that name, else the first whose links are of that kind."""
        if role in self.cases:
            return role
        if role not in ROLES or self.link.empty:
            return None
        kind = {"touching": "pounding", "gap": "pounding"}.get(role, "connector" if role == "connected" else role)
        links = self.link[self.link["kind"] == kind]
        if role in ("touching", "gap"):
            links = links[(links["gap"] == 0) if role == "touching" else (links["gap"] > 0)]
        found = names(links["case"])
        return found[0] if found else None

    def means(self, case: str | None, analysis: str, building: str, ratio: str) -> pd.Series:
        """Mean over the motions of a ratio to the building alone, per storey or floor.

        ratio : "V_ratio", "mu_ratio" (index: storey) or "acceleration_ratio" (index: floor)
        """
        return self._means[ratio].get((str(case), analysis, building), pd.Series(dtype=float))

    @cached_property
    def _means(self) -> dict[str, dict[tuple[str, str, str], pd.Series]]:
        """Of every ratio the means by case, analysis and building, all at once: claims ask for them again and again."""
        found = {}
        for ratio in ("V_ratio", "mu_ratio", "acceleration_ratio"):
            frame, level = (self.floor, "floor") if ratio == "acceleration_ratio" else (self.storey, "storey")
            means = frame.groupby(["case", "analysis", "building", level])[ratio].mean().dropna()
            parts = _by_place(means.groupby(level=[0, 1, 2], sort=False))
            found[ratio] = {place: here.droplevel([0, 1, 2]) for place, here in parts.items()}
        return found

    def against(self, case: str | None, base: str | None, analysis: str, building: str) -> pd.Series:
        """Mean over the motions of a case's floor accelerations over those of another case, per floor."""
        mine = self._accelerations(case, analysis, building)
        theirs = self._accelerations(base, analysis, building)
        if mine.empty or theirs.empty:
            return pd.Series(dtype=float)
        ratios = (mine / theirs.where(theirs > 0)).dropna()
        return ratios.groupby(level="floor").mean()

    def _accelerations(self, case: str | None, analysis: str, building: str) -> pd.Series:
        return self._places.get((str(case), analysis, building), pd.Series(dtype=float))

    @cached_property
    def _places(self) -> dict[tuple[str, str, str], pd.Series]:
        """Floor accelerations by case, analysis and building, over motion and floor."""
        parts = _by_place(self.floor.groupby(["case", "analysis", "building"], sort=False))
        return {place: here.set_index(["record", "floor"])["acceleration"] for place, here in parts.items()}

    def only(self, cases: Sequence[str]) -> Evidence:
        """The same with some of its cases alone, in the order given."""
        order = {case: number for number, case in enumerate(cases)}

        def cut(frame: pd.DataFrame) -> pd.DataFrame:
            place = frame["case"].map(order)
            return frame[place.notna()].iloc[place.dropna().argsort(kind="stable")].reset_index(drop=True)

        storey, floor, link, scene = map(cut, (self.storey, self.floor, self.link, self.scene))
        struck = self.struck if self.struck.empty else cut(self.struck)
        return replace(self, storey=storey, floor=floor, link=link, scene=scene, struck=struck)

    @cached_property
    def meaningless(self) -> dict[tuple[str, str], FlagGroup]:
        """By case and analysis the flag that takes the meaning from the numbers of some of its scenes."""
        groups = flag_groups_of(self.scene, self.units)
        return {(group.case, group.analysis): group for group in groups if group.meaningless}

    @property
    def footnote(self) -> str:
        """Which cases carry MARK and why, in sentences; "" if none does."""
        return " ".join(f"{MARK} {group}; these numbers have no meaning." for group in self.meaningless.values())

    def marked(self, case: str) -> str:
        """The name of a case, with MARK where the numbers of some of its scenes mean nothing."""
        return f"{case} {MARK}" if case in {named for named, _ in self.meaningless} else case


def _by_place(parts: Any) -> dict[tuple[str, str, str], Any]:
    """The parts of a frame or series grouped by case, analysis and building."""
    return {(str(case), str(analysis), str(building)): part for (case, analysis, building), part in parts}


def names(column: Iterable[Any]) -> list[str]:
    """The distinct values of a column in order of appearance."""
    return list(dict.fromkeys(str(value) for value in column))


def axis_keys(frame: pd.DataFrame) -> list[str]:
    """The swept keys of a table: every column before `case`; none where nothing is swept."""
    columns = [str(column) for column in frame.columns]
    return columns[: columns.index("case")]


def by_floor(link: pd.DataFrame) -> pd.DataFrame:
    """The table of links with one row a floor: of several links between the same floors the largest of every number."""
    place = [*axis_keys(link), "case", "analysis", "record", "left", "right", "floor"]
    if not any(", " in label for label in link["link"].unique()) or not link.duplicated(place).any():
        return link
    numbers = dict.fromkeys((*(v.name for v in RESPONSES if v.dims == LINK), *OF_COLUMNS))
    largest = dict.fromkeys((name for name in numbers if name in link.columns), "max")
    others = [name for name in link.columns if name not in (*place, *largest)]
    return link.groupby(place, sort=False, as_index=False).agg(dict.fromkeys(others, "first") | largest)


def points(results: Results) -> list[Evidence]:
    """The evidence at every point of the sweep, in the order of the file; one where nothing is swept."""
    frames = _frames(results)
    keys = axis_keys(frames["scene"])
    rows = _points(frames["scene"], keys)
    cuts = {name: _cuts(frame, keys, rows) for name, frame in frames.items()}
    return [_evidence(results, keys, row, {name: cuts[name][n] for name in cuts}) for n, row in enumerate(rows)]


def nominal(results: Results) -> Evidence:
    """The evidence at the point of the sweep that equals the study without its sweep; where none does at the first, in
    the middle of every bracket."""
    scene = results.scene()
    keys = axis_keys(scene)
    rows, resolved = _points(scene, keys), results.resolved
    chosen = rows[0]
    for wanted in (resolved.get("bracket") or (), keys):  # all keys, if they can be met
        alike = [r for r in rows if all(_at(resolved, k) == v for k, v in zip(keys, r, strict=True) if k in wanted)]
        chosen = alike[0] if alike else chosen
    here = results.at(_index(results, dict(zip(keys, chosen, strict=True))))
    frames = {name: _cuts(frame, keys, [chosen])[0] for name, frame in _frames(here).items()}
    return _evidence(results, keys, chosen, frames)


def _index(results: Results, point: Mapping[str, Any]) -> dict[str, int]:
    """The index of a point on every swept axis, by the first key of each."""
    found = {}
    for names in results.swept:
        values = list(zip(*(results.axes[name] for name in names), strict=True))
        found[names[0]] = values.index(tuple(point[name] for name in names))
    return found


def _frames(results: Results) -> dict[str, pd.DataFrame]:
    names = ("storey", "floor", "link", "struck", "scene", "records")
    return {name: results.table(name) for name in names} | {"buildings": results.buildings}


def _points(scene: pd.DataFrame, keys: Sequence[str]) -> list[tuple[Any, ...]]:
    """The points of the sweep as values of its keys."""
    return list(scene[list(keys)].drop_duplicates().itertuples(index=False, name=None)) if keys else [()]


def _evidence(
    results: Results, keys: Sequence[str], point: Sequence[Any], frames: Mapping[str, pd.DataFrame]
) -> Evidence:
    where = dict(zip(keys, point, strict=True))
    return Evidence(results.title, results.resolved, where, **frames, units=results.units)


def _cuts(frame: pd.DataFrame, keys: Sequence[str], rows: Sequence[tuple[Any, ...]]) -> list[pd.DataFrame]:
    """The rows of a frame at every point; a table without a swept column is the same at every point of it."""
    mine = [number for number, key in enumerate(keys) if key in frame.columns]
    if not mine:
        return [frame.reset_index(drop=True)] * len(rows)
    named = [keys[number] for number in mine]
    parts = {place: part.drop(columns=named).reset_index(drop=True) for place, part in frame.groupby(named, sort=False)}
    nothing = frame.drop(columns=named).iloc[:0]
    return [parts.get(tuple(row[number] for number in mine), nothing) for row in rows]


def _at(tree: object, key: str) -> object:
    """The value at a dotted key of nested dicts; None where there is none."""
    for part in key.split("."):
        if not isinstance(tree, Mapping):
            return None
        tree = tree.get(part)
    return tree


def motion_label(records: pd.DataFrame) -> str:
    """Motions by where they come from: "real: taft; stand-in: elcentro, eureka", or "stand-in motions"."""
    if records.empty:
        return "no motions"
    kinds = records.drop_duplicates("record").groupby("source", sort=False)["record"].agg(list).to_dict()
    if set(kinds) == {"stand-in"}:
        return "stand-in motions"
    known = ("real", "user", "stand-in")
    rank = {kind: str(kind).partition(",")[0] for kind in kinds}  # "user, unit g assumed"
    order = sorted(kinds, key=lambda kind: known.index(rank[kind]) if rank[kind] in known else len(known))
    return "; ".join(f"{kind}: {', '.join(kinds[kind])}" for kind in order)


def motion_sentence(records: pd.DataFrame) -> str:
    """The label as a sentence: "Motions: real: ...; stand-in: ...." or "All are stand-in motions."."""
    label = motion_label(records)
    return "All are stand-in motions." if label == "stand-in motions" else f"Motions: {label}."


def split(cell: Any) -> list[str]:
    """The sentences of one cell: a list, or one sentence a line."""
    if cell is None or (isinstance(cell, float) and math.isnan(cell)):
        return []
    if isinstance(cell, str):
        return [line.strip() for line in cell.splitlines() if line.strip()]
    return [str(flag) for flag in cell]
