"""The report of `pound gap`: required separations over the height, exact and by rules, and over the sweep."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from pounding_cli.model.links import BASE
from pounding_cli.model.separation import ASCE7, EN1998
from pounding_cli.numbers import Unit, pluralize
from pounding_cli.questions.bootstrap import FEWEST_TOLD
from pounding_cli.questions.gap.separations import CASES, CONFIDENCE, EXACT, GB50011, LINE, RATE, REQUIRED
from pounding_cli.questions.hazard import YEARS
from pounding_cli.report.background import report_of
from pounding_cli.report.document import Picture, Report, Section
from pounding_cli.report.evidence import Evidence, describe_motions, find_nominal
from pounding_cli.report.style import finish, grid, shared_legend, styled
from pounding_cli.report.table import NOTHING, digits, from_answer, interval
from pounding_cli.results.tables import Column, Table
from pounding_cli.study.file import parse

if TYPE_CHECKING:
    from pounding_cli.results.results import ResultTables

PLACE = ["floor", "right_floor", "columns"]
"""Which floors of two neighbours face each other."""

_LOOKS = {
    EXACT: ("#000000", "-", "o"),
    "ABS": ("#E69F00", (0, (5, 2)), "^"),
    "SRSS": ("#0072B2", (0, (5, 2)), "s"),
    "DDC": ("#009E73", (0, (5, 1.5, 1, 1.5)), "D"),
    ASCE7: ("#CC79A7", (0, (1, 1.2)), "v"),
    EN1998: ("#56B4E9", (0, (1, 1.2)), "<"),
    GB50011: ("#AA2211", (0, (1, 1.2)), "P"),
}
_CODE = ("#666666", (0, (3, 1)), "X")


def gap_report(results: ResultTables) -> Report:
    """What the required separations say."""
    answer, cases, line = (results.answer(name) for name in (REQUIRED, CASES, LINE))
    shown, keys = find_nominal(results), [key for key in results.axes if key in answer.frame]
    unit = answer.columns["mean"].unit
    pairs, lines = _widest(answer.frame, [*keys, "left", "right"]), _widest(line.frame, [*keys, "building", "side"])
    pairs = pairs.assign(between=pairs["left"] + " | " + pairs["right"], floors=[_floors(row) for row in _rows(pairs)])
    heading, far = "Required gap at the floors whose mean is the widest", "at the floors that move most on average"
    tables = [
        _widths(heading, pairs, answer, [*keys, "between", "floors"], "contact"),
        *([_of_cases(keys, cases)] if len(cases.frame) else []),
        _widths(f"Distance to a property line, {far}", lines, line, [*keys, "building", "side", "floor"], "reached"),
    ]
    if _exact(answer.frame).empty:
        told = [table for table in tables if len(table.frame)]
        return report_of(results, shown, Section("", [_nothing(results, bool(told))], told))
    notes = list(_notes(results, answer.frame, unit, cases.frame))
    if RATE in results.answers:
        frame = results.answer(RATE).frame
        tables.insert(0, _for_rate(results, frame, unit))
        first = frame.iloc[0]
        few = pluralize(int(first["intensities"]), "intensity", "intensities")
        notes.insert(0, f"The gap for a rate rests on {few} of {pluralize(int(first['motions']), 'motion')}.")
    frame = shown.rows_here(answer.frame)
    said, pictures = list(_sentences(shown.rows_here(pairs), frame, unit)), list[Picture]()
    if len(frame):
        draw = partial(draw_profiles, frame, unit, shown)
        pictures = [Picture("required-gap", "Required gap over the height", " ".join(said), draw)]
    return report_of(results, shown, Section("", said, tables, pictures, notes))


def _nothing(results: ResultTables, has_codes: bool) -> str:
    """Why there is no answer; `has_codes` : whether rules of codes are told."""
    ended = results.scene()["status"].value_counts()
    how = ", ".join(f"{count} {status}" for status, count in ended.items())
    told = "only rules of codes are told" if has_codes else "none of a case is compared"
    return f"No gap is known, and {told}: no run came to its end ({how})."


def _rows(frame: pd.DataFrame) -> list[dict[Any, Any]]:
    return frame.to_dict("records")


def _exact(frame: pd.DataFrame) -> pd.DataFrame:
    """The rows with an exact mean."""
    return frame[(frame["rule"] == EXACT) & frame["mean"].notna()]


def _widest(frame: pd.DataFrame, among: list[str]) -> pd.DataFrame:
    """Of every pair of neighbours, or side of a building, the rows of the floor whose exact mean is largest, by
    analysis; whose mean by a code is, where nothing exact is known.

    among : columns that tell them apart
    """
    exact, told = _exact(frame), [*among, "analysis"]
    if exact.empty:
        exact = frame[frame["mean"].notna()]
    place = [*told, *(name for name in PLACE if name in frame)]
    most = exact.loc[exact.groupby(told, sort=False)["mean"].idxmax(), place]
    return most[among].drop_duplicates().merge(frame.merge(most, on=place), on=among)


def _floors(row: Mapping[Any, Any]) -> str:
    """Which floors of both buildings face each other, in words."""
    one, other, side = row["floor"], row["right_floor"], row["columns"]
    if not side:
        return f"floor {one}" if one == other > 0 else BASE if one == other else f"floors {one} and {other}"
    slab, storey = (other, one) if side == "left" else (one, other)
    return f"floor {slab} beside columns of {row[side]} in storey {storey}"


def _contacts(frame: pd.DataFrame) -> list[str]:
    """The columns of gaps for a probability of contact."""
    return [str(n) for n in frame if str(n).startswith("contact_") and not str(n).endswith(("_low", "_high"))]


def _widths(heading: str, rows: pd.DataFrame, answer: Table, where: Sequence[str], reached: str) -> Table:
    """Widths in the unit of the study; those for a probability of contact with their confidence interval."""
    shares = [name for name in map(str, rows) if name.startswith("percentile_")]
    labels = {"mean": "mean", "mean_plus_std": "mean + σ", "largest": "largest"}
    labels |= {name: f"{name.removeprefix('percentile_')} %" for name in shares}
    unit, shown = answer.columns["mean"].unit, rows[[*where, "analysis", "rule", *labels]].copy()
    columns = {name: replace(answer.columns[name], label=labels[name]) for name in labels}
    columns |= {name: replace(answer.columns[name], label=name) for name in where if name in answer.columns}
    for name in _contacts(rows):
        shown[name] = [interval(row, name, factor=unit.factor) for row in _rows(rows)]
        columns[name] = Column(label=unit.label(f"{reached} {name.removeprefix('contact_')} %"))
    columns["over_exact"] = Column(label="mean over exact")
    return Table("", shown.assign(over_exact=rows["over_exact"]), columns, heading)


def _of_cases(keys: Sequence[str], cases: Table) -> Table:
    """Whether the gaps of the cases are enough."""
    rows = cases.frame
    shown = rows[[*keys, "case"]].assign(between=rows["left"] + " | " + rows["right"])
    shown = shown.join(rows[["analysis", "rule", "gap", "required", "enough"]])
    motions = rows["enough_for"].astype(str) + " of " + rows["motions"].astype(str)
    shown["for motions"] = motions.where(rows["motions"] > 0, NOTHING)
    return Table("", shown, cases.columns, "Gaps of the cases")


def _for_rate(results: ResultTables, frame: pd.DataFrame, unit: Unit) -> Table:
    """The gap for an annual rate of contact, of every pair."""
    first = frame.iloc[0]
    often = f"{digits(first['rate'], 3)} times a year, {digits(100 * first['probability'], 3)} % in {YEARS:g} years"
    frame = frame.assign(between=frame["left"] + " | " + frame["right"])

    def told(row: Mapping[Any, Any]) -> dict[str, str]:
        return {unit.label("gap"): interval(row, "gap", factor=unit.factor)}

    return from_answer(results, f"Gap that closes {often}", frame, ("between",), ("analysis",), told)


# In words


def _sentences(rows: pd.DataFrame, everywhere: pd.DataFrame, unit: Unit) -> Iterator[str]:
    """What every pair of buildings needs, analysis by analysis.

    rows : of the floors whose mean is the widest; everywhere : of all floors
    """
    contact = _contacts(rows)[0]
    exact = _exact(everywhere)
    for pair, part in rows[rows["rule"] == EXACT].groupby("between", sort=False):
        said = [f"{pair}: required gap at {' or '.join(part['floors'].unique())}, "
                f"{pluralize(int(part['motions'].max()), 'motion')}."]  # fmt: skip
        for row in _rows(part):
            words = f"{row['analysis'].capitalize()}: mean {unit.text(row['mean'], 4)}"
            words += f", largest {unit.text(row['largest'], 4)}"
            where = ["left", "right", "analysis"]
            alike = (exact[where] == [row[name] for name in where]).all(axis=1)
            widest = exact[alike].sort_values("largest").iloc[-1].to_dict()
            if widest["largest"] > row["largest"]:
                words += f" ({unit.text(widest['largest'], 4)} at {_floors(widest)})"
            if not np.isnan(row[contact]):
                width = interval(row, contact, factor=unit.factor, unit=unit.name)
                words += f"; {width} for {contact.removeprefix('contact_')} % probability of contact"
            said.append(f"{words}.")
        yield " ".join(said)


def _notes(results: ResultTables, frame: pd.DataFrame, unit: Unit, cases: pd.DataFrame) -> Iterator[str]:
    """What a reader should know of the widths and of the cases."""
    exact = _exact(frame)
    error, few = float(exact["error"].max()), exact["motions"].min()
    worth = "The numerical error was not estimated (estimate: none)."
    yield worth if np.isnan(error) else f"No width has a numerical error above {unit.text(error, 2)}."
    if few >= FEWEST_TOLD:
        yield f"In brackets: {CONFIDENCE:.0%} confidence."
    elif not np.isnan(few):
        motions = pluralize(int(few), "motion")
        yield f"No confidence interval for fewer than {FEWEST_TOLD} motions: {motions} cannot tell it."
    if len(cases) and len(results.resolved["places"]) > 2:
        yield (
            "A building between two others moves alone only while neither of them strikes it. Where the gap on one "
            "side is not enough, the answer for the other side does not hold."
        )
    written = parse(results.study_text, str(results.path)).get("cases")
    if others := [case for case in written or () if case not in set(cases["case"])]:
        yield (
            f"Not compared: {', '.join(others)}. There is no link, or one that acts before the gap has closed; "
            "`pound run` simulates them."
        )


@styled
def draw_profiles(frame: pd.DataFrame, unit: Unit, shown: Evidence) -> Figure:
    """Widths across, height upwards: a panel for each pair of neighbours and analysis."""
    contact, groups = _contacts(frame)[0], frame.groupby(["left", "right", "analysis"], sort=False)
    figure, axes = grid(len(groups), 3.6, 3.4, "height of the floors [m]", sharey=True, sharex=True)
    for ax, ((left, right, analysis), here) in zip(axes, groups, strict=True):
        for _, motion in _closings(shown, here).groupby("record", sort=False):
            ax.plot(motion["max_closing"] / unit.factor, motion["height"], color="0.75", lw=0.7, zorder=2)
        for rule, rows in here.sort_values("height").groupby("rule", sort=False):
            (color, style, marker), is_exact = _LOOKS.get(str(rule), _CODE), rule == EXACT
            ax.plot(
                rows["mean"] / unit.factor, rows["height"], color=color, ls=style, marker=marker,
                ms=4.5 if is_exact else 3.5, lw=2.2 if is_exact else 1.3, zorder=4 if is_exact else 3,
                label="exact, mean" if is_exact else rule,
            )  # fmt: skip
            if is_exact and rows[contact].notna().any():
                low, wanted, high = (rows[contact + end] / unit.factor for end in ("_low", "", "_high"))
                ax.fill_betweenx(rows["height"], low, high, color="#56B4E9", alpha=0.2, lw=0, zorder=1)
                label = f"exact, contact {contact.removeprefix('contact_')} %"
                ax.plot(wanted, rows["height"], color="#56B4E9", lw=1.8, zorder=3.5, label=label)
        ax.set_title(f"{left} | {right}, {analysis}", loc="left")
        ax.set_xlabel(unit.label("gap"))
    axes[0].set_ylim(0, None)  # of all panels, after the tallest pair
    reach = frame[["largest", contact]].max().max() / unit.factor
    axes[0].set_xlim(0, 1.25 * reach if reach > 0 else None)  # a wide interval of confidence leaves the panel
    shared_legend(figure, axes)
    where = f"At {shown.label}. " if shown.label else ""
    said = f"{where}Grey: every motion, exact. Lines: mean over the motions. Band: {CONFIDENCE:.0%} confidence."
    finish(figure, shown.title, f"{said} {describe_motions(shown.records)}")
    return figure


def _closings(shown: Evidence, here: pd.DataFrame) -> pd.DataFrame:
    """Of every motion the largest closing at every height of one pair and analysis."""
    link = shown.link if "left_at" in shown.link else shown.link.assign(left_at=1.0, right_at=1.0)
    link = link.assign(columns=np.select([link["left_at"] < 1, link["right_at"] < 1], ["left", "right"], ""))
    facing = here[["left", "right", "analysis", *PLACE, "height"]].drop_duplicates()
    return link.merge(facing, on=["left", "right", "analysis", *PLACE]).sort_values("height")


def cite_gap(resolved: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """The references of the rules that stand beside the exact separations."""
    yield "jeng1992", "the rule DDC"
    yield "derkiureghian1981", "the correlation of two oscillators in DDC"
    buildings = [resolved["buildings"][name] for name in resolved["group"]]
    yields = [building["yield"] for building in buildings if building["yield_shear"] is None]
    if any(each.get("Cd") and each.get("Ie") for each in yields):
        yield "asce2017", "the separation of ASCE/SEI 7-16, section 12.12.3"
    if any(each.get("qd") for each in yields):
        yield "en1998", "the separation of EN 1998-1, 4.4.2.7"
    if (resolved.get("gap") or {}).get("gb50011"):
        yield "gb50011-2010", "the joint width of clause 6.1.4"
