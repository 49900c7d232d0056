"""What reports of `pound fragility` and `pound gap` say of a hazard curve: annual rates, and the gap for one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from pounding_cli.numbers import counted
from pounding_cli.report.document import Picture
from pounding_cli.report.evidence import Evidence
from pounding_cli.report.style import entitle, looks, panels, shared_legend, styled
from pounding_cli.report.table import NOTHING, digits, from_rows, interval
from pounding_cli.results.tables import Table
from pounding_cli.workflows.fragility import ALONE, CONTRIBUTIONS, LINKED, RATES
from pounding_cli.workflows.hazard import RATE, YEARS

if TYPE_CHECKING:
    from pounding_cli.results.results import Results

MUCH_BEYOND = 0.1
"""Part of a rate from beyond the last intensity of the hazard curve that is told [-]."""


def told_place(results: Results, frame: pd.DataFrame, row: Mapping[Any, Any], names: Sequence[str]) -> dict[str, str]:
    """Where a row of an answer stands, by heading: swept keys in the units of the study, and some columns that are not
    the same in all rows."""
    place = {results.axis_label(key): results.value_label(key, row[key]) for key in results.axes if key in frame}
    return place | {name: str(row[name]) for name in names if len(frame[name].unique()) > 1}


def rate_table(results: Results, shown: Evidence) -> tuple[list[Table], list[Picture], list[str]]:
    """Annual rates of limits with their intervals, the figure of what contributes, and notes; nothing without a hazard
    curve."""
    if RATES not in results.answers:
        return [], [], []
    frame, rows = results.answer(RATES).frame, []
    for row in frame.to_dict("records"):
        cells = {"limit": row["limit"], "building": row["building"]}
        cells |= told_place(results, frame, row, ("case", "analysis"))
        for end, what in ((ALONE, "alone"), (LINKED, "with pounding")):
            cells[f"rate {what} [1/year]"] = interval(row, "rate", end)
            cells[f"in {YEARS:g} years {what}"] = _percent(row[f"probability{end}"])
        rows.append(cells | {"ratio of rates": interval(row, "rate_ratio")})
    beyond = max(frame[name].max() for name in ("beyond", "beyond" + ALONE))
    notes = []
    if beyond > MUCH_BEYOND:
        notes.append(
            f"Up to {beyond:.0%} of a rate comes from intensities above the last one of the hazard curve, where its "
            "last line goes on: give the curve further."
        )
    text, pictures = "Annual rates at which limits are passed, by the intensity at which they are.", []
    if len(shown.here(results.answer(CONTRIBUTIONS).frame)):
        draw = partial(draw_contributions, results, shown)
        pictures = [Picture("fragility-rates", "What contributes to the annual rates", text, draw)]
    return (
        [from_rows("Annual rates of the limits", list(rows[0]), [list(row.values()) for row in rows])],
        pictures,
        notes,
    )


def _percent(value: float) -> str:
    return NOTHING if value != value else f"{digits(100 * value, 3)} %"


@styled
def draw_contributions(results: Results, shown: Evidence) -> Figure:
    """The annual rate per ln of the intensity, alone and with pounding: a line a limit, a panel a building."""
    answer = results.answer(CONTRIBUTIONS)
    rows, unit = shown.here(answer.frame), answer.columns["from"].unit
    rows = rows[rows["analysis"] == rows["analysis"].iloc[-1]]
    places = rows[["limit", "building"]].drop_duplicates().to_numpy().tolist()
    how = looks(list(dict.fromkeys(rows["case"])))
    wide = max(sum(limit == each for each, _ in places) for limit, _ in places)
    figure, axes = panels(-(-len(places) // wide), wide, 3.6, 2.8)
    for ax in axes.flat[len(places) :]:
        ax.set_visible(False)
    for ax, (limit, building) in zip(axes.flat, places, strict=False):
        mine = rows[(rows["limit"] == limit) & (rows["building"] == building)]
        for number, (case, own) in enumerate(mine.groupby("case", sort=False)):
            at = np.sqrt(own["from"] * own["to"]) / unit.factor
            width = np.log(own["to"] / own["from"])
            if number == 0 and own["rate" + ALONE].notna().any():
                ax.plot(at, own["rate" + ALONE] / width, color="#777777", ls=(0, (2, 1)), lw=1.6, label="alone")
            look = how[str(case)]
            ax.plot(at, own["rate"] / width, color=look.color, ls=look.line, lw=1.8, label=f"with pounding: {case}")
        ax.set_title(f"{building}, {limit}", loc="left")
        ax.set_xscale("log")
        ax.set_ylim(bottom=0)
        ax.set_xlabel(f"intensity [{unit.name}]" if unit.name else "intensity")
    for ax in axes[:, 0]:
        ax.set_ylabel("annual rate per ln of the intensity")
    shared_legend(figure, axes.flat)
    entitle(figure, shown.title)
    return figure


def gap_for_rate(results: Results) -> tuple[list[Table], list[str]]:
    """The gap for an annual rate of contact, of every pair; nothing without a hazard curve."""
    if RATE not in results.answers:
        return [], []
    answer = results.answer(RATE)
    frame, unit, rows = answer.frame, answer.columns["gap"].unit, []
    for row in frame.to_dict("records"):
        cells = {"between": f"{row['left']} | {row['right']}"} | told_place(results, frame, row, ("analysis",))
        rows.append(cells | {f"gap [{unit.name}]": interval(row, "gap", factor=unit.factor)})
    first = frame.iloc[0]
    often = f"{digits(first['rate'], 3)} times a year, {_percent(first['probability'])} in {YEARS:g} years"
    few = counted(int(first["intensities"]), "intensity", "intensities")
    notes = [f"The gap for a rate rests on {few} of {counted(int(first['motions']), 'motion')}."]
    return [from_rows(f"Gap that closes {often}", list(rows[0]), [list(row.values()) for row in rows])], notes
