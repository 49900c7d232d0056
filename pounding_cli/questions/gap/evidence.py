"""Rows of the tables of `pound gap` at one point of the sweep, for sentences, tables and figures."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import pandas as pd

from pounding_cli.model.links import BASE
from pounding_cli.numbers import Unit
from pounding_cli.questions.gap.tables import (
    CASES_TABLE,
    CODES_TABLE,
    EXACT,
    GAP_TABLE,
    HIGH_END,
    LOW_END,
    MOTION_RULES,
)
from pounding_cli.questions.gap.written_gaps import read_written_gaps
from pounding_cli.report.evidence import Evidence, find_nominal
from pounding_cli.solver.response import DONE
from pounding_cli.tables import Row

if TYPE_CHECKING:
    from pounding_cli.results.results import ResultTables

PLACE_KEYS = ["floor", "right_floor", "columns", "end"]
"""Columns that say which floors of two neighbours face each other, and where along the street if these twist."""


@dataclass(frozen=True)
class Need:
    """The gap that the motions require of two neighbours in one analysis.

    required : largest over the motions, at the governing floors [m]
    mean : over the motions, at the same floors [m]
    floors : these floors, in words
    is_widest : whether the mean is nowhere wider than at these floors
    twists : whether these floors twist, so that the place along the street matters
    motions, failed : number of motions behind it, and of those whose run failed
    gap : of the case at these floors [m]; NaN without a case
    enough : verdict of CASES_TABLE; "" without a case
    """

    required: float
    mean: float
    floors: str
    is_widest: bool
    twists: bool
    motions: int
    failed: int
    gap: float = float("nan")
    enough: str = ""


@dataclass(frozen=True)
class CaseEntry:
    """A case with one set of gaps between two neighbours.

    case : its name
    needs : by analysis; an analysis all of whose runs failed is not there
    is_uniform : whether all floors of the pair have the same gap
    """

    case: str
    needs: Mapping[str, Need]
    is_uniform: bool


class GapEvidence:
    """Rows of the tables of `pound gap` at one point of the sweep.

    results : of the whole file
    shown : the results at this point
    unit : that people read gaps in
    gaps, cases : rows of GAP_TABLE and CASES_TABLE at this point
    """

    def __init__(self, results: ResultTables) -> None:
        self.results = results
        self.shown: Evidence = find_nominal(results)
        self.unit: Unit = results.answer(GAP_TABLE).column("mean").unit
        self.gaps = self.shown.rows_here(results.answer(GAP_TABLE).frame)
        self.cases = self.shown.rows_here(results.answer(CASES_TABLE).frame)

    @property
    def analyses(self) -> list[str]:
        """All analyses, elastic first."""
        return self.shown.analyses

    @property
    def pairs(self) -> list[tuple[str, str]]:
        """All neighbours some floors of which face each other, left to right."""
        facing = set(zip(self.gaps["left"], self.gaps["right"], strict=True))
        return [pair for pair in pairwise(self.results.names("building")) if pair in facing]

    def has_wall(self, pair: tuple[str, str]) -> bool:
        """Return whether one of two neighbours is a wall."""
        return bool(set(pair) & set(self.results.walls))

    def list_failed_pairs(self, analysis: str) -> list[tuple[str, str]]:
        """Return the neighbours that have no closings in an analysis under any motion."""
        exact = select_exact(self.gaps)
        exact = exact[exact["analysis"] == analysis]
        links = self.results.link()
        pairs = dict.fromkeys(zip(links["left"], links["right"], strict=True))
        return [pair for pair in pairs if self.select_pair(exact, pair).empty]

    def count_motions(self) -> int:
        """Return the number of motions."""
        return len(self.results.names("record"))

    def select_pair(self, frame: pd.DataFrame, pair: tuple[str, str]) -> pd.DataFrame:
        """Return the rows of two neighbours."""
        return frame[(frame["left"] == pair[0]) & (frame["right"] == pair[1])]

    def find_needs(self, pair: tuple[str, str]) -> dict[str, Need]:
        """Return by analysis what two neighbours require at the floors where one motion requires most."""
        exact = select_exact(self.select_pair(self.gaps, pair))
        needs = {}
        for analysis in self.analyses:
            rows = exact[exact["analysis"] == analysis]
            if len(rows):
                row = rows.iloc[int(rows["largest"].argmax())].to_dict()
                needs[analysis] = self._build_need(rows, row, row["largest"])
        return needs

    def _build_need(
        self, rows: pd.DataFrame, row: Row, required: float, gap: float = float("nan"), enough: str = ""
    ) -> Need:
        """Return a need at the floors of a row.

        rows : exact ones of the pair in this analysis
        row : of these
        """
        return Need(
            required, row["mean"], describe_facing_place(row), bool(row["mean"] >= rows["mean"].max()),
            bool(row.get("end")),
            int(row["motions"]), self.count_motions() - int(row["motions"]), gap, enough,
        )  # fmt: skip

    def list_entries(self, pair: tuple[str, str]) -> list[CaseEntry]:
        """Return the cases of the study with every set of gaps that they have between two neighbours."""
        exact = select_exact(self.select_pair(self.gaps, pair))
        cases = self.select_pair(self.cases, pair)
        cases = cases[cases["rule"] == EXACT]
        numbers = cases.groupby(["case", "analysis"], sort=False).cumcount()
        written = read_written_gaps(self.results)
        number = 1 + list(pairwise(self.results.names("building"))).index(pair)
        entries = []
        for (case, _), rows in cases.groupby([cases["case"], numbers], sort=False):
            needs = {}
            gaps = {each.gap for each in written.get(str(case), ()) if each.pair in (None, number)}
            for judged in rows.to_dict("records"):
                of_analysis = exact[exact["analysis"] == judged["analysis"]]
                keys = [key for key in PLACE_KEYS if key in of_analysis]
                is_here = (of_analysis[keys] == [judged[key] for key in keys]).all(axis=1)
                row = of_analysis[is_here].iloc[0].to_dict()
                needs[judged["analysis"]] = self._build_need(
                    of_analysis, row, judged["required"], judged["gap"], judged["enough"]
                )
            entries.append(CaseEntry(str(case), needs, len(gaps) <= 1))
        return entries

    def find_worth(self, pair: tuple[str, str], rule: str) -> dict[str, Row]:
        """Return by analysis the row of CODES_TABLE of a rule for two neighbours; nothing where no motion is known."""
        if CODES_TABLE not in self.results.answers:
            return {}
        rows = self.select_pair(self.shown.rows_here(self.results.answer(CODES_TABLE).frame), pair)
        return {row["analysis"]: row for row in rows[rows["rule"] == rule].to_dict("records")}

    def iter_code_gaps(self, pair: tuple[str, str]) -> Iterator[tuple[str, float]]:
        """Yield the rules of codes with the gap that each requires of two neighbours, the largest of all floors [m]."""
        rows = self.select_pair(self.gaps, pair)
        codes = rows[~rows["rule"].isin(MOTION_RULES) & rows["mean"].notna()]
        for rule, of_rule in codes.groupby("rule", sort=False):
            yield str(rule), float(of_rule["mean"].max())


def select_failed(scene: pd.DataFrame) -> pd.DataFrame:
    """Return the runs without closings: those that failed, and those that a collapse ended."""
    return scene[scene["status"] != DONE]


def select_exact(frame: pd.DataFrame) -> pd.DataFrame:
    """Return the rows with what the motions require, where some motion has a value."""
    return frame[(frame["rule"] == EXACT) & frame["mean"].notna()]


def select_widest(frame: pd.DataFrame, keys: list[str]) -> pd.DataFrame:
    """Return, of every pair or side of a building, the rows of the floors whose mean over the motions is the widest.

    These are the floors with the largest exact mean of an analysis, or the largest of a code where nothing exact is
    known.

    keys : columns that tell pairs, or sides of buildings, apart
    """
    known = select_exact(frame)
    if known.empty:
        known = frame[frame["mean"].notna()]
    by_analysis = [*keys, "analysis"]
    places = [*by_analysis, *(name for name in PLACE_KEYS if name in frame)]
    widest = known.loc[known.groupby(by_analysis, sort=False)["mean"].idxmax(), places]
    return widest[keys].drop_duplicates().merge(frame.merge(widest, on=places), on=keys)


def describe_facing_place(row: Row) -> str:
    """Return where two neighbours face each other, for a sentence: "floor 5", "the low end of the shared edge of floor
    5"."""
    floors = describe_floors({**row, "end": ""})
    end = row.get("end")
    if not end:
        return floors
    return f"the {end} of the shared edge of {floors}" if end in (LOW_END, HIGH_END) else f"{end} along {floors}"


def describe_floors(row: Row) -> str:
    """Return which floors of two neighbours face each other, for a table: "floor 5", "floor 4 beside storey 6 of A",
    "floor 5, low end" of floors that twist."""
    floors = _describe_floors(row)
    return f"{floors}, {row['end']}" if row.get("end") else floors


def _describe_floors(row: Row) -> str:
    left_floor = row["floor"]
    right_floor = row["right_floor"]
    side = row["columns"]
    if side == "left":
        return f"floor {right_floor} beside storey {left_floor} of {row['left']}"
    if side:
        return f"floor {left_floor} beside storey {right_floor} of {row['right']}"
    if left_floor != right_floor:
        return f"floors {left_floor} and {right_floor}"
    return f"floor {left_floor}" if left_floor > 0 else BASE


def describe_pair(row: Mapping[Any, Any]) -> str:
    """Return two neighbours as tables name them: "stiff | soft"."""
    return f"{row['left']} | {row['right']}"
