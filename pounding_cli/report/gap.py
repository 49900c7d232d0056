"""The report of `pound gap`: required separations over the height, exact and by rules, and over the sweep."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pounding_cli.model.separation import ASCE7, EN1998
from pounding_cli.numbers import Unit, counted
from pounding_cli.report.answer_page import AnswerPage, Illustration
from pounding_cli.report.citations import Use
from pounding_cli.report.evidence import Evidence, motion_sentence
from pounding_cli.report.gap_text import (
    case_headings,
    case_notes,
    case_rows,
    case_sentences,
    cases_at,
    code_notes,
    contact_columns,
    error_sentence,
    governing,
    headings,
    interval_sentence,
    line_headings,
    line_rows,
    numbers,
    pair_heading,
    width_unit,
)
from pounding_cli.report.key_words import name_axis
from pounding_cli.report.style import caption, entitle, new_figure, shared_legend, styled
from pounding_cli.report.web.story import Grid
from pounding_cli.store import Results
from pounding_cli.store.answers import Answer
from pounding_cli.store.gap import CASES, CONFIDENCE, EXACT, LINE

LEFT_OUT = (
    "UBC 1997 and NZS 1170.5 have other rules. They are left out because no source of their clauses was available."
)

MOST_GAPS, FEW_GAPS = 20, 4
"""Gaps of the cases in the table of a pair, and in sentences."""

_LOOKS = {
    EXACT: ("#000000", "-", "o"),
    "ABS": ("#E69F00", (0, (5, 2)), "^"),
    "SRSS": ("#0072B2", (0, (5, 2)), "s"),
    "DDC": ("#009E73", (0, (5, 1.5, 1, 1.5)), "D"),
    ASCE7: ("#CC79A7", (0, (1, 1.2)), "v"),
    EN1998: ("#56B4E9", (0, (1, 1.2)), "<"),
    "GB 50011-2010": ("#AA2211", (0, (1, 1.2)), "P"),
}
_CODE = ("#666666", (0, (3, 1)), "X")


def gap_page(results: Results, shown: Evidence, with_figures: bool = True) -> AnswerPage:
    """What the report of required separations says, at one point of the sweep."""
    answer, keys = results.answer("gap"), list(results.axes)
    frame = shown.here(answer.frame)
    parts = governing(frame, [])
    figures = {}
    if with_figures and len(frame):
        text = " ".join(_sentence(answer, part) for part in parts)
        figures["required-gap"] = Illustration(
            draw_profiles(answer, frame, shown), "Required gap over the height", text
        )
        if keys and len(results.axes[keys[0]]) > 1:
            said = "Mean over the motions at the floors that require the widest gap."
            figures["required-gap-sweep"] = Illustration(draw_sweep(results, answer, shown), "Over the sweep", said)
    heads = _flat(headings(answer))
    tables = [
        (
            pair_heading(results, shown.point, left, right, rows),
            Grid(heads, numbers(answer, rows), range(2, len(heads))),
        )
        for _, left, right, rows in parts
    ]
    lead = [_sentence(answer, part) for part in parts]
    cases, line = results.answer(CASES), results.answer(LINE)
    own = shown.here(cases.frame)
    for _, left, right, _ in parts:
        here, gaps = cases_at(own, {}, left, right, MOST_GAPS)
        if gaps:
            more = f" (the first {MOST_GAPS} of {gaps}; all: tables/{CASES}.csv)" if gaps > MOST_GAPS else ""
            grid = Grid(_flat(case_headings(cases)), case_rows(cases, here), range(3, 7))
            tables.append((f"Gaps of the cases, {left} | {right}{more}", grid))
            lead += case_sentences(cases, cases_at(here, {}, left, right, FEW_GAPS)[0])
    grid = Grid(_flat(line_headings(line)), line_rows(line, shown.here(line.frame)), range(5, len(line_headings(line))))
    tables.append(("Distance to a property line, at the floors that move most", grid))
    notes = [*_notes(frame, answer), *case_notes(results, own), *code_notes(results), LEFT_OUT]
    return AnswerPage("Required gap", lead, figures, tables, notes)


def _flat(heads: Sequence[str]) -> list[str]:
    return [heading.replace("\n", " ") for heading in heads]


def _sentence(answer: Answer, part: tuple[Any, ...]) -> str:
    """What a pair of buildings needs, analysis by analysis."""
    _, left, right, rows = part
    unit, said = width_unit(answer), []
    contact = contact_columns(answer)[0]
    for row in rows[rows["rule"] == EXACT].to_dict("records"):
        words = (
            f"{row['analysis'].capitalize()}: mean {unit.text(row['mean'], 4)}, largest {unit.text(row['largest'], 4)}"
        )
        if row[contact] == row[contact]:
            words += f"; {unit.text(row[contact], 4)} for {contact.removeprefix('contact_')} % probability of contact"
            if row[f"{contact}_low"] == row[f"{contact}_low"]:
                between = f"{unit.text(row[contact + '_low'], 3)} to {unit.text(row[contact + '_high'], 3)}"
                words += f" ({CONFIDENCE:.0%} confidence: {between})"
        said.append(words)
    motions = counted(int(rows["motions"].max()), "motion")
    return f"{left} | {right}: required gap at the floors that require the widest gap, {motions}. {'. '.join(said)}."


def _notes(frame: pd.DataFrame, answer: Answer) -> list[str]:
    """What a reader should know of the numbers."""
    said = error_sentence(answer, float(frame["error"].max()))
    notes = [
        "Exact: largest closing of two floors over time; for a property line, largest displacement of the floor to "
        f"that side. Each building is alone. {said}",
        interval_sentence(frame),
        "ABS, SRSS and DDC combine the largest displacements of each building under the same motion; DDC takes the "
        "periods and damping ratios of the elastic first modes.",
    ]
    rules = set(frame["rule"])
    if "GB 50011-2010" in rules:
        notes.append("GB 50011-2010, 6.1.4: a least width that depends on height, intensity and system alone.")
    if any(rule.startswith("UBC") for rule in rules):
        notes.append("UBC: sum of the displacements that the code which set the yield shears allows both buildings.")
    return list(filter(None, notes))


@styled
def draw_profiles(answer: Answer, frame: pd.DataFrame, shown: Evidence) -> Figure:
    """Widths across, height upwards: a panel for each pair of neighbours and analysis."""
    unit = width_unit(answer)
    pairs = list(dict.fromkeys(zip(frame["left"], frame["right"], strict=True)))
    analyses = list(dict.fromkeys(frame["analysis"]))
    figure = new_figure(3.9 * len(analyses) + 1.7, 3.6 * len(pairs) + 0.7)
    axes = figure.subplots(len(pairs), len(analyses), squeeze=False, sharey="row", sharex=True)
    for line, (left, right) in zip(axes, pairs, strict=True):
        for ax, analysis in zip(line, analyses, strict=True):
            here = frame[(frame["left"] == left) & (frame["right"] == right) & (frame["analysis"] == analysis)]
            _motions(ax, shown, here, unit)
            _profile(ax, here, unit, contact_columns(answer)[0])
            ax.set_title(f"{left} | {right}, {analysis}", loc="left")
            ax.set_ylim(0, None)
        line[0].set_ylabel("height of the floors [m]")
    for ax in axes[-1]:
        ax.set_xlabel(f"gap [{unit.name}]")
    reach = frame[["largest", contact_columns(answer)[0]]].max().max() / unit.factor
    axes[0, 0].set_xlim(0, 1.25 * reach if reach > 0 else None)  # a wide interval of confidence leaves the panel
    shared_legend(figure, axes.flat)
    entitle(figure, shown.title)
    where = f"At {shown.label}. " if shown.label else ""
    contact = contact_columns(answer)[0]
    has_band = frame.loc[frame["rule"] == EXACT, f"{contact}_low"].notna().any()
    band = f"Band: {CONFIDENCE:.0%} confidence of the blue line, cut at the edge. " if has_band else ""
    caption(
        figure,
        f"{where}Grey: every motion, exact. Lines: mean over the motions, exact and by rules. {band}"
        f"{motion_sentence(shown.records)}",
    )
    return figure


def _profile(ax: Axes, here: pd.DataFrame, unit: Unit, contact: str) -> None:
    """The lines of one panel."""
    for rule, rows in here.groupby("rule", sort=False):
        rows = rows.sort_values("height")
        color, style, marker = _LOOKS.get(str(rule), _CODE)
        width = rows["mean"] / unit.factor
        strong = rule == EXACT
        ax.plot(
            width, rows["height"], color=color, ls=style, marker=marker, ms=4.5 if strong else 3.5,
            lw=2.2 if strong else 1.3, zorder=4 if strong else 3, label="exact, mean" if strong else str(rule),
        )  # fmt: skip
        if strong and rows[contact].notna().any():
            low, wanted, high = (rows[contact + end] / unit.factor for end in ("_low", "", "_high"))
            ax.fill_betweenx(rows["height"], low, high, color="#56B4E9", alpha=0.2, lw=0, zorder=1)
            share = contact.removeprefix("contact_")
            ax.plot(wanted, rows["height"], color="#56B4E9", lw=1.8, zorder=3.5, label=f"exact, contact {share} %")


def _motions(ax: Axes, shown: Evidence, here: pd.DataFrame, unit: Unit) -> None:
    """Every motion as a thin line."""
    left, right, analysis = (here[name].iloc[0] for name in ("left", "right", "analysis"))
    link = shown.link
    link = link if "left_at" in link else link.assign(left_at=1.0, right_at=1.0)
    mine = link[(link["left"] == left) & (link["right"] == right) & (link["analysis"] == analysis)]
    facing = here[["floor", "right_floor", "columns", "height"]]
    heights = {tuple(place): height for *place, height in facing.itertuples(index=False)}
    for _, rows in mine.groupby("record", sort=False):
        sides = np.where(rows["left_at"] < 1, "left", np.where(rows["right_at"] < 1, "right", ""))
        at = [heights[place] for place in zip(rows["floor"], rows["right_floor"], sides, strict=True)]
        order = np.argsort(at)
        widths = rows["max_closing"].to_numpy() / unit.factor
        ax.plot(widths[order], np.array(at)[order], color="0.75", lw=0.7, zorder=2)


@styled
def draw_sweep(results: Results, answer: Answer, shown: Evidence) -> Figure:
    """Mean widths at the floors that need most against the first swept key, the others as at the point shown."""
    unit, keys = width_unit(answer), list(results.axes)
    key, frame = keys[0], answer.frame
    for other in keys[1:]:
        frame = frame[frame[other] == shown.point[other]]
    parts = governing(frame, [key])
    pairs = list(dict.fromkeys((left, right) for _, left, right, _ in parts))
    analyses = list(dict.fromkeys(frame["analysis"]))
    figure = new_figure(3.9 * len(analyses) + 1.7, 3.0 * len(pairs) + 0.7)
    axes = figure.subplots(len(pairs), len(analyses), squeeze=False, sharey="row", sharex=True)
    for line, pair in zip(axes, pairs, strict=True):
        rows = pd.concat([rows for _, left, right, rows in parts if (left, right) == pair])
        for ax, analysis in zip(line, analyses, strict=True):
            for rule, here in rows[rows["analysis"] == analysis].groupby("rule", sort=False):
                color, style, marker = _LOOKS.get(str(rule), _CODE)
                across: Mapping[str, Any] | Sequence[Any] = here[key]
                if here[key].dtype.kind == "f":
                    across = here[key] / results.units[key].factor
                label = "exact" if rule == EXACT else str(rule)
                ax.plot(
                    across, here["mean"] / unit.factor, color=color, ls=style, marker=marker, ms=3.5,
                    lw=2.2 if rule == EXACT else 1.3, zorder=4 if rule == EXACT else 3, label=label,
                )  # fmt: skip
            ax.set_title(f"{pair[0]} | {pair[1]}, {analysis}", loc="left")
            ax.set_ylim(0, None)
            name_axis(ax, "x", [key], [results.units[key]], results.resolved)
        line[0].set_ylabel(f"gap, mean over the motions [{unit.name}]")
    shared_legend(figure, axes.flat)
    entitle(figure, shown.title)
    return figure


def cite_gap(resolved: Mapping[str, Any], used: Use) -> None:
    """The references of the rules that stand beside the exact separations."""
    used("jeng1992", "the rule DDC")
    used("derkiureghian1981", "the correlation of two oscillators in DDC")
    asked = resolved.get("gap") or {}
    yields = [building["yield"] for building in (resolved["buildings"][name] for name in resolved["group"])
              if building["yield_shear"] is None]  # fmt: skip
    if any(each.get("Cd") and each.get("Ie") for each in yields):
        used("asce2017", "the separation of ASCE/SEI 7-16, section 12.12.3")
    if any(each.get("qd") for each in yields):
        used("en1998", "the separation of EN 1998-1, 4.4.2.7")
    if asked.get("gb50011"):
        used("gb50011-2010", "the joint width of clause 6.1.4")
