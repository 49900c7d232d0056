"""The answer at the head of the page: the cases side by side at one point of the sweep."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import pandas as pd

from pounding_cli.laws import drawn
from pounding_cli.numbers import Unit, counted
from pounding_cli.report.columns import shown
from pounding_cli.report.evidence import Evidence
from pounding_cli.report.web.story import digits
from pounding_cli.solver.response import OUTCOMES
from pounding_cli.store import FlagGroup, flag_groups_of

MOST_BUILDINGS = 3
"""Buildings with columns of their own, as many as fit a window of 1400 pixels; of more, the largest of all is shown."""
MOST_FLAGS = 3
"""Flags written out under a case."""

_QUANTITIES = {
    "V_ratio": ("storey", "V", "V/V₀"),
    "mu_ratio": ("storey", "mu", "μ/μ₀"),
    "acceleration_ratio": ("floor", "acceleration", "a"),
}
"""Of every ratio: where it stands, the quantity itself, and the head of its column."""


@dataclass(frozen=True)
class Cell:
    """One number, where it stands in words, and `above` or `below` that alone."""

    number: str
    where: str = ""
    tone: str = ""


@dataclass(frozen=True)
class CaseRow:
    """One case: its numbers, its flags in words, whether a flag makes its numbers meaningless."""

    case: str
    cells: Sequence[Cell]
    flags: Sequence[str]
    meaningless: bool


@dataclass(frozen=True)
class LargestRow:
    """One case (and its place among them) and analysis: the largest value of every quantity and where, and whether a
    flag takes the meaning from the numbers of one of its scenes."""

    place: int
    case: str
    analysis: str
    cells: Sequence[Cell]
    meaningless: bool


@dataclass(frozen=True)
class LargestOf:
    """The table of largest values: heads of its columns behind case and analysis, rows."""

    heads: Sequence[str]
    rows: Sequence[LargestRow]


@dataclass(frozen=True)
class Answer:
    """The table: buildings with the number of columns each takes, heads of the columns, rows."""

    groups: Sequence[tuple[str, int]]
    heads: Sequence[tuple[str, str]]
    rows: Sequence[CaseRow]


def answer(evidence: Evidence) -> Answer:
    """The cases side by side."""
    cases = evidence.cases
    each = len(evidence.group) <= MOST_BUILDINGS
    places = evidence.group if each else [""]
    columns = _columns(evidence.analyses)
    found: dict[tuple[str, ...], Cell] = {}
    for ratio in dict.fromkeys(ratio for _, ratio in columns):
        found |= _largest(evidence, ratio, each)
    closing = _closing(evidence.link, evidence.unit("gap"))
    flags = _flags(evidence.scene)
    rows = [
        CaseRow(
            case,
            [found.get((ratio, case, analysis, place), Cell("–")) for place in places for analysis, ratio in columns]
            + [closing.get(case, Cell("–"))],
            *flags.get(case, ([], False)),
        )
        for case in cases
    ]
    heads = [(_QUANTITIES[ratio][2], analysis) for _ in places for analysis, ratio in columns]
    titles = evidence.group if each else [f"largest of the {len(evidence.group)} buildings"]
    return Answer([(title, len(columns)) for title in titles], heads, rows)


def largest(evidence: Evidence) -> LargestOf:
    """The largest demand, ratio, drift, acceleration and shear of struck columns over buildings, storeys and motions,
    by case and analysis."""
    struck = evidence.struck
    struck = struck if struck.empty else struck[struck["impacts"] > 0]
    tables = {"μ": ("mu", evidence.storey), "μ/μ₀": ("mu_ratio", evidence.storey),
              "V/V₀": ("V_ratio", evidence.storey), "drift": ("drift_ratio", evidence.storey),
              "a": ("acceleration", evidence.floor), "struck columns": ("shear_demand", struck)}  # fmt: skip
    only = {"μ": "inelastic", "μ/μ₀": "inelastic", "V/V₀": "elastic"}
    heads = [
        head
        for head, (name, frame) in tables.items()
        if name in frame and not frame.empty and only.get(head, "") in ("", *evidence.analyses)
    ]
    rows: dict[tuple[str, str], dict[str, Cell]] = {
        (case, analysis): {} for case in evidence.cases for analysis in evidence.analyses
    }
    for head in heads:
        name, frame = tables[head]
        known = frame[frame[name].notna()]
        for row in known.loc[known.groupby(["case", "analysis"], sort=False)[name].idxmax()].to_dict("records"):
            if only.get(head, row["analysis"]) == row["analysis"]:
                rows[row["case"], row["analysis"]][head] = _cell(evidence, name, row)
    empty, void = {head: Cell("–") for head in heads}, evidence.meaningless
    return LargestOf(
        heads,
        [
            LargestRow(evidence.cases.index(place[0]), *place, list((empty | cells).values()), place in void)
            for place, cells in rows.items()
        ],
    )


def _cell(evidence: Evidence, name: str, row: Mapping[Any, Any]) -> Cell:
    """A number as people read it, and where it stands."""
    level = "floor" if "floor" in row else "storey"
    where = f"{row['building']}, {level} {row[level]}"
    where += f", {row['record']}" if len(evidence.records) > 1 else ""
    look = shown(name, evidence.units)
    unit = f" {look.unit}" if look.unit not in ("", "–") else ""
    return Cell(digits(look.factor * row[name], 3) + unit, where)


def _columns(analyses: Sequence[str]) -> list[tuple[str, str]]:
    """Analysis and ratio of every column: shears where elastic, ductilities where inelastic, accelerations in both."""
    found = []
    for analysis in analyses:
        if analysis != "inelastic" or len(analyses) == 1:
            found.append((analysis, "V_ratio"))
        if analysis == "inelastic":
            found.append((analysis, "mu_ratio"))
        found.append((analysis, "acceleration_ratio"))
    return found


def _largest(evidence: Evidence, ratio: str, each: bool) -> dict[tuple[str, ...], Cell]:
    """By ratio, case, analysis and building: the largest mean over the motions, of an acceleration itself."""
    level, itself, _ = _QUANTITIES[ratio]
    frame = evidence.floor if level == "floor" else evidence.storey
    keys = ["case", "analysis", "building", level]
    means = frame.groupby(keys, sort=False, as_index=False)[[ratio, itself]].mean()
    of = itself if level == "floor" else ratio
    means = means[means[of].notna()]
    largest = means.loc[means.groupby(keys[: 3 if each else 2], sort=False)[of].idxmax()]
    found: dict[tuple[str, ...], Cell] = {}
    for row in largest.to_dict("records"):
        where = f"{level} {row[level]}" if each else f"{row['building']}, {level} {row[level]}"
        number, ratio_here = digits(row[of], 3), row[ratio]
        if level == "floor":
            unit = evidence.unit("acceleration")
            number = f"{digits(unit.number(row[of]), 3)} {unit.name}"
            where += f", {digits(ratio_here, 3)}×" if ratio_here == ratio_here else ""
        place = row["building"] if each else ""
        found[ratio, row["case"], row["analysis"], place] = Cell(number, where, _tone(ratio_here))
    return found


def _tone(ratio: float) -> str:
    return "above" if ratio > 1.005 else "below" if ratio < 0.995 else ""


def _closing(link: pd.DataFrame, unit: Unit) -> dict[str, Cell]:
    """By case: the largest closing of the link that comes closest to its gap or goes furthest beyond, all motions."""
    link = link[link["max_closing"].notna()]
    if link.empty:
        return {}
    beyond = link["max_closing"] - link["gap"]
    runs = link.groupby(["case", "analysis", "record"], sort=False)["impacts"].max() > 0
    closed = runs.groupby(level="case").agg(["sum", "size"])
    found = {}
    for row in link.loc[beyond.groupby(link["case"], sort=False).idxmax()].to_dict("records"):
        times, of = closed.loc[row["case"]]
        where = f"contact: {times} of {counted(of, 'run')}" if times else "no contact"
        number = f"{digits(unit.number(row['max_closing']), 3)} / {unit.text(row['gap'])}"
        found[row["case"]] = Cell(number, where if drawn(row["kind"]) == "gap" else str(row["kind"]))
    return found


def _flags(scene: pd.DataFrame) -> dict[str, tuple[list[str], bool]]:
    """By case: failed runs and flags in words, and whether a flag makes numbers of the case meaningless."""
    groups: dict[str, list[FlagGroup]] = {}
    for group in flag_groups_of(scene):
        groups.setdefault(group.case, []).append(group)
    failed = (~scene["status"].isin(OUTCOMES)).groupby(scene["case"], sort=False).agg(["sum", "size"])
    found: dict[str, tuple[list[str], bool]] = {}
    for case, (lost, of) in failed.iterrows():
        said = [f"{lost} of {counted(int(of), 'run')} failed and are left out of the means"] if lost else []
        here = groups.get(str(case), [])
        said += [_said(group) for group in here[:MOST_FLAGS]]
        if len(here) > MOST_FLAGS:
            said.append(f"{counted(len(here) - MOST_FLAGS, 'further flag')}: see Flags")
        if said:
            found[str(case)] = (said, any(group.meaningless for group in here))
    return found


def _said(group: FlagGroup) -> str:
    which = f"{group.count} of {counted(group.of, 'run')}" + (f" ({group.scenes})" if group.scenes != "all" else "")
    return f"{group.flag}: {group.analysis}, {which}"
