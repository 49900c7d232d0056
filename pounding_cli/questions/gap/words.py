"""The texts of `pound gap`: its tables, references and notes on the numbers."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from pounding_cli.model.effects import COUPLING
from pounding_cli.model.separation import CODE_RULES, NTC2008, UBC
from pounding_cli.numbers import NOTHING, format_number, join_limited, pluralize
from pounding_cli.questions.bootstrap import MIN_MOTIONS
from pounding_cli.questions.gap.evidence import (
    describe_floors,
    describe_pair,
    select_exact,
    select_failed,
    select_widest,
)
from pounding_cli.questions.gap.neighbour_words import note_median, show_neighbours
from pounding_cli.questions.gap.sentences import describe_rate
from pounding_cli.questions.gap.spec import format_needed_keys
from pounding_cli.questions.gap.tables import (
    CASES_TABLE,
    CODES_TABLE,
    EXACT,
    GAP_CONFIDENCE,
    GAP_TABLE,
    HIGH_END,
    LINE_TABLE,
    LOW_END,
    RATE_TABLE,
)
from pounding_cli.questions.gap.written_gaps import read_written_gaps
from pounding_cli.records.code_spectra import NTC2018
from pounding_cli.solver.response import COLLAPSED
from pounding_cli.tables import Column, Row, Table
from pounding_cli.texts import escape_controls

if TYPE_CHECKING:
    from pounding_cli.results.results import ResultTables

MIN_PERCENT = 0.01
"""Probability of contact, or of none, below which no number is shown [%]."""

_PAIR = Column("left", "two neighbours, left and right of the gap", label="between", write=describe_pair)
_FLOORS = Column("floor", "floors that face each other", label="floors", write=describe_floors)


def list_tables(results: ResultTables) -> list[Table]:
    """Return the tables that a terminal prints, those without rows left out."""
    tables = [_show_separations(results), _show_cases(results), _show_distances(results)]
    if CODES_TABLE in results.answers:
        tables.insert(1, _show_codes(results))
    if RATE_TABLE in results.answers:
        tables.insert(0, _show_rate(results))
    tables = [*show_neighbours(results), *tables]
    return [table for table in tables if len(table.frame)]


def _list_swept_keys(results: ResultTables, table: Table) -> list[str]:
    return [key for key in results.axes if table.has(key)]


def _move_constants(frame: pd.DataFrame, columns: Sequence[Column], caption: str) -> tuple[list[Column], str]:
    """Return the columns whose cells differ, and the caption with the cells of the others: "Gaps: case near, A | B"."""
    rows = frame.to_dict("records")
    cells = {column.name: list(dict.fromkeys(column.cell(row) for row in rows)) for column in columns}
    named = {"case": "case ", "floor": "floor "}
    constants = [
        f"{named.get(column.label or column.name, '')}{cells[column.name][0]}"
        for column in columns
        if len(cells[column.name]) == 1
    ]
    varying = [column for column in columns if len(cells[column.name]) > 1]
    return varying, f"{caption}: {', '.join(constants)}" if constants else caption


def _show_separations(results: ResultTables) -> Table:
    """Return the required gaps of every pair at the floors that need most on average."""
    table = results.answer(GAP_TABLE)
    keys = _list_swept_keys(results, table)
    rows = select_widest(table.frame, [*keys, "left", "right"])
    caption = "Required gap at the floors whose mean over the motions is the widest"
    places, caption = _move_constants(rows, [_PAIR, _FLOORS, table.column("analysis")], caption)
    return table.view(*keys, *places, *_list_widths(table), frame=rows, caption=caption)


def _show_distances(results: ResultTables) -> Table:
    """Return how far every building moves to both sides, at the floors that move most on average."""
    table = results.answer(LINE_TABLE)
    keys = _list_swept_keys(results, table)
    rows = select_widest(table.frame, [*keys, "building", "side"])
    caption = "Distance to a property line, at the floors whose mean over the motions is the largest"
    places = [table.column(name) for name in ("building", "side", "floor", "end", "analysis") if table.has(name)]
    places, caption = _move_constants(rows, places, caption)
    return table.view(*keys, *places, *_list_widths(table), frame=rows, caption=caption)


def _list_widths(table: Table) -> list[str | Column]:
    """Return rule and widths, the most important first; the others give way on narrow terminals."""
    names = [column.name for column in table.columns]
    contact = [name for name in names if name.startswith("contact_") and not name.endswith(("_low", "_high"))]
    percentiles = [name for name in names if name.startswith("percentile_")]
    optional = [*contact, *percentiles, "mean_plus_std"]
    if set(table.frame["rule"]) != {EXACT}:
        optional.append("over_exact")
    columns = [replace(table.column(name), optional=True) for name in optional]
    return ["rule", "mean", "largest", *columns]


def _show_cases(results: ResultTables) -> Table:
    """Return whether the gaps of the cases are enough."""
    table = results.answer(CASES_TABLE)
    keys = _list_swept_keys(results, table)
    motions = Column("enough_for", "motions for which it is", label="for motions", write=_count_motions, optional=True)
    required = replace(table.column("required"), label="required (largest)")
    caption = "Gaps of the cases and required gaps, both at the governing floors"
    places = [table.column("case"), _PAIR, table.column("analysis")]
    places, caption = _move_constants(table.frame, places, caption)
    columns: list[str | Column] = ["rule", "gap", required, "enough", motions]
    return table.view(*keys, *places, *columns, caption=caption)


def _count_motions(row: Row) -> str:
    """Return for how many of the motions a gap is enough: "2 of 5"."""
    return f"{row['enough_for']} of {row['motions']}" if row["motions"] > 0 else NOTHING


def _show_codes(results: ResultTables) -> Table:
    """Return the gaps of codes with what they are worth in these motions, and how often a year they close."""
    table = results.answer(CODES_TABLE)
    keys = _list_swept_keys(results, table)
    closed = Column("closed", "motions that close it", label="closed by", write=_count_closed)
    caption = "Gaps of codes, and how likely the pair touches at some floor"
    places, caption = _move_constants(table.frame, [_PAIR, table.column("analysis")], caption)
    probability = replace(table.column("probability"), write=_format_probability, is_right=True)
    columns: list[str | Column] = [table.column("rule"), table.column("gap"), closed, probability]
    if table.frame["rate"].notna().any():
        columns.append(table.column("rate"))
    point = table.frame.groupby(keys, sort=False).ngroup() if keys else np.zeros(len(table.frame))
    pair = table.frame["left"].map(results.names("building").index)
    rows = table.frame.iloc[np.lexsort((pair, point))]  # otherwise in the order of the file
    return table.view(*keys, *places, *columns, frame=rows, caption=caption)


def _format_probability(row: Row) -> str:
    """Return a probability of contact in percent with its interval: "12 (1.6 to 44)", "<0.01 (<0.01 to 7.5)".

    A fit to a few motions tells nothing of probabilities beyond MIN_PERCENT.
    """
    value, low, high = (100 * row[name] for name in ("probability", "probability_low", "probability_high"))
    if not math.isfinite(value):
        return NOTHING
    text = _format_percent(value)
    return f"{text} ({_format_percent(low)} to {_format_percent(high)})" if math.isfinite(low) else text


def _format_percent(value: float) -> str:
    if value < MIN_PERCENT:
        return f"<{MIN_PERCENT:g}"
    if value > 100 - MIN_PERCENT:
        return f">{100 - MIN_PERCENT:g}"
    return format_number(value, 4 if value > 99 else 2)


def _count_closed(row: Row) -> str:
    """Return how many of the motions close a gap: "2 of 5"."""
    return f"{row['closed']} of {row['motions']}"


def _show_rate(results: ResultTables) -> Table:
    """Return the gap of every pair for the annual rate of contact."""
    table = results.answer(RATE_TABLE)
    keys = _list_swept_keys(results, table)
    gap = replace(table.column("gap"), otherwise=_explain_no_gap)
    caption = f"Gap with which a pair touches {describe_rate(table.frame.iloc[0].to_dict())}"
    places, caption = _move_constants(table.frame, [_PAIR, table.column("analysis")], caption)
    return table.view(*keys, *places, gap, caption=caption)


def _explain_no_gap(row: Row) -> str:
    """Return why there is no gap for a rate of contact."""
    return "needs 2 motions" if row["motions"] < 2 else "no such gap"


# Notes


def list_notes(results: ResultTables) -> list[str]:
    """Return what a reader should know of the numbers."""
    exact = select_exact(results.answer(GAP_TABLE).frame)
    if exact.empty:
        return []
    return list(_iter_notes(results, exact))


def _iter_notes(results: ResultTables, exact: pd.DataFrame) -> Iterator[str]:
    cases = results.answer(CASES_TABLE).frame
    if median := note_median(results):
        yield median
    yield from _iter_rate_notes(results)
    scene = results.scene()
    failed_rows = select_failed(scene)
    if failed := failed_rows["status"].value_counts().to_dict():
        outcomes = ", ".join(f"{count} {status}" for status, count in failed.items())
        is_divided = failed_rows[failed_rows["status"] == COLLAPSED]["dropped"].map(
            lambda names: COUPLING in names.splitlines()
        )
        kept = ", but for pairs that nothing links to the collapse" if is_divided.any() else ""
        yield f"{sum(failed.values())} of {pluralize(len(scene), 'run')} failed ({outcomes}) and are left out{kept}."
    yield from _iter_street_notes(results, exact)
    yield _describe_error(exact, results.answer(GAP_TABLE).column("error"))
    fewest = int(exact["motions"].min())
    if fewest >= MIN_MOTIONS:
        yield f"In brackets: {100 * GAP_CONFIDENCE:.0f} % confidence interval."
    else:
        motions = pluralize(fewest, "motion")
        is_are = "is" if fewest == 1 else "are"
        yield f"No confidence interval: it needs at least {MIN_MOTIONS} motions, and there {is_are} {motions}."
    if len(results.names("building")) > 2:
        yield (
            "A building between two others moves alone only while neither of them strikes it. Where the gap on one "
            "side is not enough, the answer for the other side does not hold."
        )
    yield from _iter_code_notes(results)
    if left_out := _list_cases_left_out(results, cases):
        yield (
            f"Not compared: {join_limited(left_out)}. There is no link, or one that acts before the gap has closed; "
            "`pound run` simulates them."
        )


def _iter_street_notes(results: ResultTables, exact: pd.DataFrame) -> Iterator[str]:
    """Yield where floors that twist share an edge, and how codes count their twist."""
    facing = set(zip(*(results.arrays[name].values.tolist() for name in ("link_left", "link_right")), strict=True))
    for left, right in pairwise(results.names("building")):
        if (left, right) not in facing and "plan_low" in results.arrays:
            yield f"{left} and {right} share no edge along the street, so that they need no gap."
    if "end" not in exact or not exact["end"].any():
        return
    at_ends = exact[exact["end"].isin([LOW_END, HIGH_END])]
    for pair, rows in at_ends.groupby(["left", "right"], sort=False):
        low, high = (_format_places(rows.loc[rows["end"] == end, "street"]) for end in (LOW_END, HIGH_END))
        yield (
            f"{' and '.join(map(str, pair))} share an edge along the street, from its low end at {low} m to its high "
            f"end at {high} m."
        )
    yield "Where floors twist, gaps and distances are those of their edges, not of their centres of mass."
    evaluated = set(results.answer(GAP_TABLE).frame["rule"])
    rules = [each for each in evaluated if each.startswith("UBC")]
    rules += [rule.name for rule in CODE_RULES if rule.displacement is not None and rule.name in evaluated]
    if rules:
        verb = "counts" if len(rules) == 1 else "count"
        yield (
            f"Here {join_limited(rules)} {verb} how floors twist under design forces through their centres of mass, "
            "without the accidental eccentricities of codes (`accidental` moves the centre of mass)."
        )


def _format_places(ys: pd.Series) -> str:
    """Return places along the street [m] that a sweep may move: "-5", "-5 to -3"."""
    ends = dict.fromkeys(f"{y:.4g}" for y in (ys.min(), ys.max()))
    return " to ".join(ends)


def _iter_code_notes(results: ResultTables) -> Iterator[str]:
    """Yield the codes that say nothing of some or of all buildings, with the keys that they need."""
    evaluated = set(results.answer(GAP_TABLE).frame["rule"])
    yield from _iter_partial_codes(results)
    yield from _iter_estimated_displacements(results)
    settings = results.study_data.get("gap") or {}
    named = settings.get("codes") or ()
    others: list[str] = []
    for rule in CODE_RULES:
        if rule.name == UBC or rule.name in evaluated:
            continue
        factors = format_needed_keys(rule)
        if rule.name in named:
            yield f"{rule.name} is left out: it needs {factors} of two neighbours."
        elif rule.section or rule.by_name:
            others.append(f"{rule.name} (`gap.{rule.section or 'codes'}`)")
        else:
            others.append(f"{rule.name} ({factors})")
    if others:
        yield f"Further codes and the keys that they need: {', '.join(others)}."


def _iter_partial_codes(results: ResultTables) -> Iterator[str]:
    """Yield the codes that say something of some pairs of neighbours and nothing of others, with the keys they need."""
    frame = results.answer(GAP_TABLE).frame
    gaps = frame[frame["mean"].notna()]
    places = pd.Series(list(zip(gaps["left"], gaps["right"], strict=True)), index=gaps.index)
    pairs = list(dict.fromkeys(places))
    rules_by_pairs: dict[tuple[tuple[str, str], ...], list[str]] = {}
    for rule in CODE_RULES:
        is_rule = gaps["rule"].astype(str).str.startswith("UBC") if rule.name == UBC else gaps["rule"] == rule.name
        having = set(places[is_rule])
        lacking = tuple(pair for pair in pairs if pair not in having)
        if having and lacking:
            rules_by_pairs.setdefault(lacking, []).append(f"{rule.name} ({format_needed_keys(rule)})")
    for lacking, rules in rules_by_pairs.items():
        where = join_limited(" | ".join(pair) for pair in lacking)
        yield f"Not evaluated for {where}, as a building lacks the keys: {', '.join(rules)}."


def _iter_estimated_displacements(results: ResultTables) -> Iterator[str]:
    """Yield the buildings whose displacement the Italian codes estimate by their height."""
    evaluated = set(results.answer(GAP_TABLE).frame["rule"])
    rules = [name for name in (NTC2018, NTC2008) if name in evaluated]
    names = dict.fromkeys(results.study_data["group"])
    buildings = {name: results.study_data["buildings"][name] for name in names}
    estimated = [
        name
        for name, building in buildings.items()
        if not building.get("wall") and (building["yield_shear"] is not None or building["yield"].get("mu_d") is None)
    ]
    if rules and estimated:
        verb = "estimates" if len(rules) == 1 else "estimate"
        whose = join_limited(estimated)
        yield f"{' and '.join(rules)} {verb} the displacement of {whose} by the height: there is no `mu_d` in `yield`."


def _iter_rate_notes(results: ResultTables) -> Iterator[str]:
    """Yield how many intensities and motions annual rates of contact rest on."""
    if RATE_TABLE in results.answers:
        row = results.answer(RATE_TABLE).frame.iloc[0].to_dict()
        yield f"The gap for a rate rests on {_format_rate_basis(int(row['intensities']), int(row['motions']))}"
        return
    codes = results.answer(CODES_TABLE).frame if CODES_TABLE in results.answers else pd.DataFrame({"rate": []})
    rated = codes[codes["rate"].notna()]
    if len(rated):
        from pounding_cli.study.schema.records import INTENSITY_KEYS  # here: a terminal prints results without a study

        intensity_keys = [key for key in results.axes if key in INTENSITY_KEYS]
        intensities = len(rated[intensity_keys].drop_duplicates()) if intensity_keys else 1
        yield f"The rates of contact rest on {_format_rate_basis(intensities, int(rated['motions'].min()))}"


def _format_rate_basis(intensities: int, motions: int) -> str:
    """Return the end of a sentence on what annual rates rest on, with what one intensity means for them."""
    basis = f"{pluralize(intensities, 'intensity', 'intensities')} of {pluralize(motions, 'motion')}"
    if intensities > 1:
        return f"{basis}."
    return f"{basis}: closings are taken in proportion to it, which is right for elastic buildings only."


def _describe_error(exact: pd.DataFrame, column: Column) -> str:
    """Return the largest numerical error of the required gaps."""
    error = float(exact["error"].max())
    if np.isnan(error):
        return "The numerical error was not estimated (estimate: none)."
    return f"Numerical error: at most {column.format(error)} {column.unit.name}."


def _list_cases_left_out(results: ResultTables, cases: pd.DataFrame) -> list[str]:
    """Return the cases of the study whose gaps are not compared."""
    compared = set(cases["case"])
    return [escape_controls(case) for case in read_written_gaps(results) if case not in compared]


# References


def list_references(resolved: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Return the references of the rules beside the exact separations, and what each is used for.

    resolved : the study with every default filled in
    """
    references = [("jeng1992", "the rule DDC"), ("derkiureghian1981", "the correlation of two oscillators in DDC")]
    buildings = [resolved["buildings"][name] for name in resolved["group"]]
    yields = [building["yield"] for building in buildings if building["yield_shear"] is None]
    settings = resolved.get("gap") or {}
    for rule in CODE_RULES:
        has_factors = any(all(each.get(key) for key in rule.factors) for each in yields) or not rule.factors
        is_selected = settings.get(rule.section) if rule.section else not rule.by_name
        is_named = rule.by_name and rule.name in (settings.get("codes") or ())
        if rule.source and has_factors and (is_selected or is_named):
            references.append((rule.source, f"the separation of {rule.name}, {rule.clause}"))
    return references
