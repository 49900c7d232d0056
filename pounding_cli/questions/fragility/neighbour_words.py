"""Sentences and a table of fragility curves beside a neighbour that is only seen."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from pounding_cli.numbers import format_number, join_limited, pluralize
from pounding_cli.questions.fragility.tables import NEIGHBOURS
from pounding_cli.questions.frames import ALONE, STATE_COLUMN
from pounding_cli.questions.neighbours import describe_seen, list_drawn_names
from pounding_cli.report.evidence import Evidence
from pounding_cli.tables import Column, Row, Table

if TYPE_CHECKING:
    from pounding_cli.results.results import ResultTables


def describe_drawn(results: ResultTables) -> str:
    """Return over what the curves are; "" where all buildings are certain."""
    if NEIGHBOURS not in results.answers:
        return ""
    names = list_drawn_names(results, results.answer(NEIGHBOURS))
    count = int(results.answer(NEIGHBOURS).frame["neighbours"].iloc[0])
    seen = join_limited((describe_seen(results, name) for name in names), last=" and ")
    motions = pluralize(len(results.names("record")), "motion")
    return f"Curves are over {count} buildings that {seen} may be, and over {motions}."


def describe_widening(evidence: Evidence, place: Row) -> str:
    """Return how much wider the curve at a place is than with the median building; "" where that is not known."""
    results = evidence.results
    if NEIGHBOURS not in results.answers:
        return ""
    frame = evidence.rows_here(results.answer(NEIGHBOURS).frame)
    for name in ("case", "analysis", "limit", "building"):
        frame = frame[frame[name] == place[name]]
    parts = []
    for row in sorted(frame.to_dict("records"), key=lambda row: bool(row[STATE_COLUMN] == ALONE)):
        if not math.isfinite(row["widening"]):
            continue
        both = format_number(row["spread"], 2)
        neighbour = format_number(row["widening"], 2)
        motions = format_number(row["spread_of_median"], 2)
        if row["spread_of_median"] == 0.0:
            motions = "less than a step of the intensities"
        parts.append(f"{both} {row[STATE_COLUMN]} (motions {motions}, neighbour {neighbour})")
    return f"β is {', '.join(parts)}" if parts else ""


def show_widening(results: ResultTables, limit: Column, median: Column, varying: list[str]) -> Table:
    """Return the table of how much wider curves are.

    limit, median : columns of limits and of medians, as the table of medians has them
    varying : columns that are shown where they differ from row to row
    """
    table = results.answer(NEIGHBOURS)
    return table.view(
        limit,
        STATE_COLUMN,
        _like(median, table.column("median")),
        _like(median, table.column("median_of_median")),
        table.column("spread"),
        table.column("spread_of_median"),
        table.column("widening"),
        varying=varying,
        caption="How much wider the curves are over what the neighbour may be",
    )


def _like(median: Column, column: Column) -> Column:
    """Return a column of medians with as many digits as another."""
    return replace(column, unit=median.unit, digits=median.digits)
