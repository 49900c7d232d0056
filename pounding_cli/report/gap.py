"""The report of `pound gap`: required separations over the height, exact and by rules, and over the sweep."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pounding_cli.model.links import BASE
from pounding_cli.model.separation import ASCE7, EN1998
from pounding_cli.numbers import Unit, counted
from pounding_cli.report.background import background, frame_of
from pounding_cli.report.document import Picture, Report, Section
from pounding_cli.report.evidence import Evidence, motion_sentence, nominal
from pounding_cli.report.rates import gap_for_rate
from pounding_cli.report.references import Use
from pounding_cli.report.style import caption, entitle, name_axis, panels, shared_legend, styled
from pounding_cli.report.table import NOTHING, interval
from pounding_cli.results.tables import Column, Table
from pounding_cli.study.file import parse
from pounding_cli.workflows.curves import FEWEST_TOLD
from pounding_cli.workflows.gap import CASES, CONFIDENCE, EXACT, GB50011, LINE, REQUIRED

if TYPE_CHECKING:
    from pounding_cli.results.results import Results

TABLES = ("storey", "floor", "link", "scene", "summary", "records", "buildings")
"""The tables of scenes that the report has."""
FEW_GAPS = 4
"""Gaps of the cases in sentences; the table has all."""
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


def gap_report(results: Results) -> Report:
    """What the required separations say."""
    answer, cases, line = (results.answer(name) for name in (REQUIRED, CASES, LINE))
    shown, keys = nominal(results), [key for key in results.axes if key in answer.frame]
    pairs = _widest(answer.frame, [*keys, "left", "right"], PLACE)
    pairs = pairs.assign(between=pairs["left"] + " | " + pairs["right"], floors=pairs.apply(_floors, axis=1))
    lines = _widest(line.frame, [*keys, "building", "side"], ["floor"])
    of_rate, rate_notes = gap_for_rate(results)
    heading, far = "Required gap at the floors that require the widest", "at the floors that move most"
    tables = [
        *of_rate,
        _widths(heading, pairs, answer, [*keys, "between", "floors"], "contact"),
        *([_of_cases(keys, cases)] if len(cases.frame) else []),
        _widths(f"Distance to a property line, {far}", lines, line, [*keys, "building", "side", "floor"], "reached"),
    ]
    said = [*_sentences(answer, shown.here(pairs)), *_case_sentences(cases, shown.here(cases.frame))]
    pictures, frame = [], shown.here(answer.frame)
    if len(frame):
        draw = partial(draw_profiles, answer, frame, shown)
        pictures.append(Picture("required-gap", "Required gap over the height", " ".join(said), draw))
        if keys and len(results.axes[keys[0]]) > 1:
            text = "Mean over the motions at the floors that require the widest gap."
            draw = partial(draw_sweep, answer, pairs, shown, keys[0])
            pictures.append(Picture("required-gap-sweep", "Required gap over the sweep", text, draw))
    return Report(
        **frame_of(results, shown, results.scene()),
        answer=Section("", said, tables, pictures, rate_notes + list(_notes(results, answer, cases.frame))),
        more=partial(background, results, shown, results.scene(), TABLES),
    )


def _widest(frame: pd.DataFrame, among: Sequence[str], place: Sequence[str]) -> pd.DataFrame:
    """Of every pair of neighbours, or side of a building, the rows of the floor whose exact mean is largest, by
    analysis.

    among : columns that tell them apart; place : columns that say which floor
    """
    exact, told = frame[(frame["rule"] == EXACT) & frame["mean"].notna()], [*among, "analysis"]
    most = exact.loc[exact.groupby(told, sort=False)["mean"].idxmax(), [*told, *place]]
    order = most.drop(columns="analysis").drop_duplicates(list(among))[list(among)]
    return order.merge(frame.merge(most, on=[*told, *place]), on=list(among))


def _floors(row: Mapping[Any, Any]) -> str:
    """Which floors of both buildings face each other, in words."""
    one, other, side = row["floor"], row["right_floor"], row["columns"]
    if not side:
        return f"floor {one}" if one == other > 0 else BASE if one == other else f"floors {one} and {other}"
    slab, storey = (other, one) if side == "left" else (one, other)
    return f"floor {slab} beside columns of {row[side]} in storey {storey}"


def _widths(heading: str, rows: pd.DataFrame, answer: Table, where: Sequence[str], reached: str) -> Table:
    """Widths in the unit of the study; those for a probability of contact with their confidence interval."""
    shares = [name for name in map(str, rows) if name.startswith("percentile_")]
    labels = {"mean_plus_std": "mean + σ", "over_exact": "mean over exact"}
    labels |= {name: f"{name.removeprefix('percentile_')} %" for name in shares}
    shown = rows[[*where, "analysis", "rule", "mean", "mean_plus_std", "largest", *shares]].copy()
    how = {n: replace(column, label=labels.get(n, n)) for n, column in answer.columns.items() if n in shown}
    for name in _contacts(answer):
        shown[name] = [interval(row, name, factor=_unit(answer).factor) for row in rows.to_dict("records")]
        how[name] = Column(label=f"{reached} {name.removeprefix('contact_')} % [{_unit(answer).name}]")
    how["over_exact"] = Column(label="mean over exact")
    return Table("", shown.assign(over_exact=rows["over_exact"]), how, heading)


def _unit(answer: Table) -> Unit:
    """The unit of widths."""
    return answer.columns["mean"].unit


def _contacts(answer: Table) -> list[str]:
    """The columns of gaps for a probability of contact."""
    return [n for n in answer.columns if n.startswith("contact_") and not n.endswith(("_low", "_high"))]


def _of_cases(keys: Sequence[str], cases: Table) -> Table:
    """Whether the gaps of the cases are enough."""
    rows = cases.frame
    shown = rows[[*keys, "case"]].assign(between=rows["left"] + " | " + rows["right"])
    shown = shown.join(rows[["analysis", "rule", "gap", "required", "enough"]])
    motions = rows["enough_for"].astype(str) + " of " + rows["motions"].astype(str)
    shown["for motions"] = motions.where(rows["motions"] > 0, NOTHING)
    return Table("", shown, cases.columns, "Gaps of the cases")


# In words


def _sentences(answer: Table, rows: pd.DataFrame) -> Iterator[str]:
    """What every pair of buildings needs, analysis by analysis."""
    unit, contact = _unit(answer), _contacts(answer)[0]
    for pair, part in rows.groupby("between", sort=False):
        parts = []
        for row in part[part["rule"] == EXACT].to_dict("records"):
            words = f"{row['analysis'].capitalize()}: mean {unit.text(row['mean'], 4)}"
            words += f", largest {unit.text(row['largest'], 4)}"
            if row[contact] == row[contact]:
                width = interval(row, contact, factor=unit.factor, unit=unit.name)
                words += f"; {width} for {contact.removeprefix('contact_')} % probability of contact"
            parts.append(words)
        motions = counted(int(part["motions"].max()), "motion")
        yield f"{pair}: required gap at {' or '.join(part['floors'].unique())}, {motions}. {'. '.join(parts)}."


def _case_sentences(cases: Table, frame: pd.DataFrame) -> list[str]:
    """Whether each gap is enough, by what the motions require; at one point of the sweep."""
    unit, said = cases.columns["gap"].unit, list[str]()
    words = {"yes": "enough", "no": "not enough", "unknown": "not known, as scenes failed"}
    for _, rows in frame[frame["rule"] == EXACT].groupby(["case", "left", "right", "gap"], sort=False):
        first, motions = rows.iloc[0], counted(int(rows["motions"].iloc[0]), "motion")
        by_analysis = [
            f"{row['analysis']} {words[row['enough']]} (for {row['enough_for']} of {motions} it is)"
            for row in rows.to_dict("records")
        ]
        gap = unit.text(first["gap"], 4)
        said.append(f"Case {first['case']}, {first['left']} | {first['right']}: gap {gap}: {', '.join(by_analysis)}.")
    return said[:FEW_GAPS]


def _notes(results: Results, answer: Table, cases: pd.DataFrame) -> Iterator[str]:
    """What a reader should know of the widths and of the cases."""
    frame = answer.frame
    error, few = float(frame["error"].max()), frame.loc[frame["rule"] == EXACT, "motions"].min()
    worth = "The numerical error was not estimated (estimate: none)."
    yield f"No width has a numerical error above {_unit(answer).text(error, 2)}." if error == error else worth
    if few >= FEWEST_TOLD:
        yield f"In brackets: {CONFIDENCE:.0%} confidence."
    elif few == few:
        yield (
            f"No confidence interval for fewer than {FEWEST_TOLD} motions: {counted(int(few), 'motion')} "
            f"{'is' if few == 1 else 'are'} too few to tell how much the gap varies from motion to motion."
        )
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
    for rule, keys in {ASCE7: ("base_shear", "Cd", "Ie"), EN1998: ("base_shear", "qd")}.items():
        lacking = []
        for name in dict.fromkeys(results.resolved["group"]):
            building = results.resolved["buildings"][name]
            own = building["yield"] if building["yield_shear"] is None else {}
            if lacks := [f"`{key}`" for key in keys if own.get(key) is None]:
                lacking.append(f"{', '.join(lacks)} of {name}")
        if lacking:
            yield f"{rule} is not evaluated: `yield` lacks {'; '.join(lacking)}."


# Figures


def _panels(frame: pd.DataFrame, height: float) -> tuple[Figure, Any, Iterator[tuple[Axes, pd.DataFrame]]]:
    """A figure with its axes: a line of panels for each pair of neighbours, a panel for each analysis; and the rows of
    each panel."""
    pairs, analyses = frame[["left", "right"]].drop_duplicates(), frame["analysis"].unique()
    figure, axes = panels(len(pairs), len(analyses), 3.9, height, sharey="row", sharex=True)

    def each() -> Iterator[tuple[Axes, pd.DataFrame]]:
        for line, (left, right) in zip(axes, pairs.itertuples(index=False), strict=True):
            for ax, analysis in zip(line, analyses, strict=True):
                ax.set_title(f"{left} | {right}, {analysis}", loc="left")
                yield ax, frame[(frame["left"] == left) & (frame["right"] == right) & (frame["analysis"] == analysis)]

    return figure, axes, each()


def _line(ax: Axes, rule: str, x: Any, y: Any) -> None:
    """The line of one rule."""
    color, style, marker = _LOOKS.get(rule, _CODE)
    size, width, above = (4.5, 2.2, 4) if rule == EXACT else (3.5, 1.3, 3)
    label = "exact, mean" if rule == EXACT else rule
    ax.plot(x, y, color=color, ls=style, marker=marker, ms=size, lw=width, zorder=above, label=label)


@styled
def draw_profiles(answer: Table, frame: pd.DataFrame, shown: Evidence) -> Figure:
    """Widths across, height upwards: a panel for each pair of neighbours and analysis."""
    unit, contact = _unit(answer), _contacts(answer)[0]
    figure, axes, each = _panels(frame, 3.6)
    for ax, here in each:
        for _, motion in _closings(shown, here).groupby("record", sort=False):
            ax.plot(motion["max_closing"] / unit.factor, motion["height"], color="0.75", lw=0.7, zorder=2)
        for rule, rows in here.groupby("rule", sort=False):
            rows = rows.sort_values("height")
            _line(ax, str(rule), rows["mean"] / unit.factor, rows["height"])
            if rule == EXACT and rows[contact].notna().any():
                low, wanted, high = (rows[contact + end] / unit.factor for end in ("_low", "", "_high"))
                ax.fill_betweenx(rows["height"], low, high, color="#56B4E9", alpha=0.2, lw=0, zorder=1)
                label = f"exact, contact {contact.removeprefix('contact_')} %"
                ax.plot(wanted, rows["height"], color="#56B4E9", lw=1.8, zorder=3.5, label=label)
        ax.set_ylim(0, None)
    for ax in axes[:, 0]:
        ax.set_ylabel("height of the floors [m]")
    for ax in axes[-1]:
        ax.set_xlabel(f"gap [{unit.name}]")
    reach = frame[["largest", contact]].max().max() / unit.factor
    axes[0, 0].set_xlim(0, 1.25 * reach if reach > 0 else None)  # a wide interval of confidence leaves the panel
    shared_legend(figure, axes.flat)
    entitle(figure, shown.title)
    where = f"At {shown.label}. " if shown.label else ""
    said = f"{where}Grey: every motion, exact. Lines: mean over the motions. Band: {CONFIDENCE:.0%} confidence."
    caption(figure, f"{said} {motion_sentence(shown.records)}")
    return figure


def _closings(shown: Evidence, here: pd.DataFrame) -> pd.DataFrame:
    """Of every motion the largest closing at every height of one pair and analysis."""
    link = shown.link if "left_at" in shown.link else shown.link.assign(left_at=1.0, right_at=1.0)
    link = link.assign(columns=np.select([link["left_at"] < 1, link["right_at"] < 1], ["left", "right"], ""))
    facing = here[["left", "right", "analysis", *PLACE, "height"]].drop_duplicates()
    return link.merge(facing, on=["left", "right", "analysis", *PLACE]).sort_values("height")


@styled
def draw_sweep(answer: Table, pairs: pd.DataFrame, shown: Evidence, key: str) -> Figure:
    """Mean widths at the floors that need most against the first swept key, the others as at the point shown."""
    unit, across, rows = _unit(answer), shown.results.units[key], pairs
    for other, value in shown.point.items():
        rows = rows[rows[other] == value] if other != key and other in rows else rows
    figure, axes, each = _panels(rows, 3.0)
    for ax, mine in each:
        for rule, here in mine.groupby("rule", sort=False):
            x = here[key] / across.factor if here[key].dtype.kind == "f" else here[key]
            _line(ax, str(rule), x, here["mean"] / unit.factor)
        ax.set_ylim(0, None)
        name_axis(ax, "x", [key], [across])
    for ax in axes[:, 0]:
        ax.set_ylabel(f"gap, mean over the motions [{unit.name}]")
    shared_legend(figure, axes.flat)
    entitle(figure, shown.title)
    return figure


def cite_gap(resolved: Mapping[str, Any], used: Use) -> None:
    """The references of the rules that stand beside the exact separations."""
    used("jeng1992", "the rule DDC")
    used("derkiureghian1981", "the correlation of two oscillators in DDC")
    buildings = [resolved["buildings"][name] for name in resolved["group"]]
    yields = [building["yield"] for building in buildings if building["yield_shear"] is None]
    if any(each.get("Cd") and each.get("Ie") for each in yields):
        used("asce2017", "the separation of ASCE/SEI 7-16, section 12.12.3")
    if any(each.get("qd") for each in yields):
        used("en1998", "the separation of EN 1998-1, 4.4.2.7")
    if (resolved.get("gap") or {}).get("gb50011"):
        used("gb50011-2010", "the joint width of clause 6.1.4")
