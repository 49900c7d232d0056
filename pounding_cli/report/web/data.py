"""Tables as JSON for the page's scripts: column by column, texts as codes, six digits, no more rows than fit."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from pounding_cli.numbers import Unit
from pounding_cli.report.columns import Shown, shown
from pounding_cli.report.evidence import Evidence, Tables, axis_keys
from pounding_cli.store import flagged_scenes
from pounding_cli.variables import RESPONSES

MOST_ROWS = 6000
"""Rows of one table that the page carries; about 0.1 kB each."""
MOST_POINTS = 400
"""Points of a sweep that the page carries in detail."""
SIX_DIGITS = 6

AXIS_LIKE = (
    "case",
    "analysis",
    "record",
    "building",
    "link",
    "left",
    "right",
    "status",
    "method",
    "kind",
    "source",
    "meaningless",
)
"""Text columns a reader filters by."""

PLACES = ("case", "analysis", "record", "building", "storey", "floor", "link", "left", "right", "at", "by", "by_floor")
"""Columns that say where a number stands."""
TRUST = ("_error", "_sensitivity")
"""Endings of the columns that say how far a quantity can be trusted."""

_TITLES = {
    "summary": "Means over the motions",
    "storey": "Storeys",
    "floor": "Floors",
    "link": "Links",
    "struck": "Struck columns",
    "scene": "Runs",
    "flagged": "Flags",
    "records": "Motions",
    "buildings": "Buildings",
}


def charted(chart: str) -> dict[str, tuple[str, ...]]:
    """The variables that a chart offers (`Variable.charts`), by the table that holds them, ratios first."""
    offered = sorted((v for v in RESPONSES if chart in v.charts), key=lambda v: not v.ratio)
    return {level: tuple(v.name for v in offered if v.dims[-1] == level) for level in ("storey", "floor", "link")}


def chosen_points(evidences: Sequence[Evidence], shown_point: Evidence) -> list[Evidence]:
    """The points of a sweep that the page carries in detail: all, or as many as fit, evenly spread.

    shown_point : of `evidences`, always among them
    """
    largest = max(len(frame) for frame in (shown_point.storey, shown_point.floor, shown_point.link))
    fit = max(1, min(MOST_POINTS, MOST_ROWS // max(largest, 1)))
    if len(evidences) <= fit:
        return list(evidences)
    here = next(number for number, evidence in enumerate(evidences) if evidence is shown_point)
    spread = np.linspace(0, len(evidences) - 1, fit).round().astype(int)
    spread[np.abs(spread - here).argmin()] = here
    return [evidences[number] for number in spread]


def tables(results: Tables, chosen: Sequence[Evidence]) -> dict[str, dict[str, Any]]:
    """Every table as `packed` makes it, cut to the chosen points of the sweep and to MOST_ROWS."""
    scene = results.scene()
    keys = axis_keys(scene)
    frames = {
        "summary": with_trust(results.summary(), scene, keys),
        "storey": with_trust(results.storey(), scene, keys),
        "floor": with_trust(results.floor(), scene, keys),
        "link": with_trust(results.link(), scene, keys),
        "struck": results.struck(),
        "scene": scene.drop(columns=["effects", "dropped"], errors="ignore"),
        "flagged": _flagged(scene),
        "records": results.records(),
        "buildings": results.buildings,
    }
    found = {
        name: packed(_TITLES[name], _at_points(frame, keys, chosen), len(frame), results.units)
        for name, frame in frames.items()
        if name != "struck" or not frame.empty
    }
    return {name: answer_table(results, name) for name in results.answers} | found


def answer_table(results: Tables, name: str) -> dict[str, Any]:
    """A table that a workflow added, as `packed` makes it."""
    frame, units, meanings = results.answer(name)
    looks = {
        column: Shown(column, units[column].name, 1 / units[column].factor, text)
        if column in units
        else Shown(column, "" if unit == "1" else unit, 1.0, text)
        for column, (unit, text) in meanings.items()
    }
    return packed(name.replace("_", " ").capitalize(), frame.head(MOST_ROWS), len(frame), looks=looks)


def _flagged(scene: pd.DataFrame) -> pd.DataFrame:
    """The flags of the scenes, `meaningless` in words."""
    frame = flagged_scenes(scene)
    return frame.assign(meaningless=frame["meaningless"].map({True: "yes", False: "no"}))


def with_trust(frame: pd.DataFrame, scene: pd.DataFrame, keys: Sequence[str]) -> pd.DataFrame:
    """The table with the numerical error and the sensitivity of its numbers beside them.

    Where a quantity has its own (`V_ratio_error`), they come right after it. Where none has, those of the scene stand
    before the numbers; a mean over motions gets the largest of its scenes.
    """
    if frame.empty:
        return frame
    columns = [str(column) for column in frame.columns]
    own = [column for column in columns if column.endswith(TRUST)]
    if not own:
        on = [*keys, "case", "analysis", *(["record"] if "record" in columns else [])]
        trust = scene.groupby(on, sort=False, as_index=False)[["error_estimate", "sensitivity"]].max()
        frame = frame.merge(trust, on=on, how="left", sort=False)
        first = next(n for n, column in enumerate(columns) if column not in (*keys, *PLACES))
        return frame[[*columns[:first], "error_estimate", "sensitivity", *columns[first:]]]
    order = []
    for column in columns:
        if column not in own:
            order += [column, *(name for name in own if name.startswith(column) and name[len(column) :] in TRUST)]
    return frame[order + [name for name in own if name not in order]]


def _at_points(frame: pd.DataFrame, keys: Sequence[str], chosen: Sequence[Evidence]) -> pd.DataFrame:
    """The rows at the chosen points; a table without swept columns is the same at all of them."""
    if "case" in frame.columns:
        frame = frame[frame["case"].isin(chosen[0].cases)]
    mine = [key for key in keys if key in frame.columns]
    if mine:
        wanted = {tuple(evidence.point[key] for key in mine) for evidence in chosen}
        there = [row in wanted for row in frame[mine].itertuples(index=False, name=None)]
        frame = frame[np.array(there, bool)]
    return frame.head(MOST_ROWS)


def packed(
    title: str,
    frame: pd.DataFrame,
    total: int,
    units: Mapping[str, Unit] | None = None,
    looks: Mapping[str, Shown] | None = None,
) -> dict[str, Any]:
    """A frame for `data.js`: title, rows, total (rows the file has), columns.

    units : as `Results.units`; looks : of columns that are none of a study's
    """
    looks = looks or {}
    columns = [_column(str(key), frame[key], looks.get(str(key)) or shown(str(key), units)) for key in frame.columns]
    return {"title": title, "rows": len(frame), "total": total, "columns": columns}


def point_of(evidence: Evidence) -> dict[str, Any]:
    """Swept key -> value, as the columns of `tables` hold it."""
    units = evidence.units
    return {
        key: value if isinstance(value, str) else numbers(np.array([value]) / units.get(key, Unit()).factor)[0]
        for key, value in evidence.point.items()
    }


def _column(key: str, values: pd.Series, look: Shown) -> dict[str, Any]:
    head = {"key": key, "label": look.label, "unit": look.unit, "text": look.text}
    if pd.api.types.is_numeric_dtype(values):
        whole = pd.api.types.is_integer_dtype(values) or look.unit == ""
        return {**head, "values": numbers(values.to_numpy(float) * look.factor), "whole": bool(whole)}
    codes, known = pd.factorize(values.astype(str), sort=False)
    return {**head, "codes": codes.tolist(), "names": [str(name) for name in known], "filter": key in AXIS_LIKE}


def numbers(values: np.ndarray) -> list[float | int | None]:
    """Numbers with six digits; None where there is none, integers as such."""
    return [_number(value) for value in np.asarray(values, float).ravel().tolist()]


def _number(value: float) -> float | int | None:
    if not np.isfinite(value):
        return None
    short = float(f"{value:.{SIX_DIGITS}g}")
    return int(short) if short.is_integer() and abs(short) < 1e15 else short


def as_json(data: Any) -> str:
    """JSON that may stand in a script element: no markup can end it early."""
    text = json.dumps(data, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    return text.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")
