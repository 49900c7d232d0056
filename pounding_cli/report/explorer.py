"""What the page's explorer draws: of every quantity the mean over the motions with its spread, place by place and point
by point of the sweep, and where there is room every motion by itself."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from pounding_cli.report.evidence import Evidence, by_floor, names
from pounding_cli.report.figures import main_building
from pounding_cli.report.sweep import SweptAxis, largest, over_motions, point_numbers, swept_axes, void_scenes
from pounding_cli.report.table import column_of
from pounding_cli.variables import RESPONSES

if TYPE_CHECKING:
    from pounding_cli.results.results import Results

MOST_VALUES = 120_000
"""Numbers that a page carries; of more no single motions, then only the largest over the height, then only some points
of the longest axis."""
MEAN = "mean"
"""What stands for all motions in the list of motions."""

_PLACES = {"storey": ("building", "storey"), "floor": ("building", "floor"), "link": ("pair", "floor")}


def explored(results: Results, shown: Evidence) -> dict[str, Any]:
    """Axes and quantities, the last axis fastest.

    `rows` of a quantity: case, analysis, motion and building or pair as places in `names`, then storey or floor (0: the
    largest over the height); `mean`, `low` and `high`, row after row. `void`: by case and analysis how many motions
    have numbers without meaning at every point. `thinned`: every how many points of the longest axes are there.
    """
    axes, thinned = list(swept_axes(results)), 1
    frames = {level: _frame(results, level, shown.cases) for level in _PLACES}
    offered = sorted((v for v in RESPONSES if v.charts), key=lambda v: not v.ratio)
    kept = {
        level: [v.name for v in offered if v.dims[-1] == level and v.name in frame] for level, frame in frames.items()
    }
    motions = names(shown.records["record"])

    def size(heights: bool, single: bool) -> int:
        rows = {
            level: len(
                frame[["case", "analysis", *(_PLACES[level] if heights else _PLACES[level][:1])]].drop_duplicates()
            )
            for level, frame in frames.items()
        }
        each = 3 + (len(motions) if single else 0)
        return each * math.prod(map(len, axes)) * sum(rows[level] * len(keys) for level, keys in kept.items())

    single = len(motions) > 1 and size(True, True) <= MOST_VALUES
    heights = size(True, single) <= MOST_VALUES
    while size(heights, single) > MOST_VALUES and max(map(len, axes), default=0) > 2:
        longest = max(range(len(axes)), key=lambda number: len(axes[number]))
        axes[longest] = replace(axes[longest], points=axes[longest].points[::2])
        thinned *= 2
    known = {"case": list(shown.cases), "analysis": shown.analyses, "motion": [MEAN, *(motions if single else [])]}
    known |= {"building": shown.group, "pair": names(frames["link"]["pair"])}
    quantities: list[dict[str, Any]] = []
    for level, keys in kept.items():
        frame = frames[level].assign(point=point_numbers(frames[level], axes), motion=MEAN)
        frame = frame[frame["point"] >= 0]
        for key in keys:
            found = [frame, frame.assign(motion=frame["record"])] if single else [frame]
            packed = _quantity(pd.concat(found), key, level, heights, math.prod(map(len, axes)), known)
            if packed:
                how = column_of(key, results.units)
                about = {"key": key, "label": how.head, "text": how.text or how.label, "factor": 1 / how.unit.factor}
                quantities.append(about | packed)
    for each in quantities:
        for name in ("mean", "low", "high"):
            each[name] = [rounded(each["factor"] * value) for value in each[name]]
    return {
        "axes": [
            {
                "label": axis.words, "numeric": axis.numeric, "names": axis.names,
                "values": [rounded(value) for value in axis.coordinates.tolist()],
            }
            for axis in axes
        ],
        "quantities": quantities, "names": known, "void": _void(results, axes, shown.cases), "thinned": thinned,
        "heights": heights, "building": main_building(shown), "point": _place(axes, shown),
    }  # fmt: skip


def _frame(results: Results, level: str, cases: Sequence[str]) -> pd.DataFrame:
    """The table of a level, of links one row a floor and with the pair of neighbours."""
    frame = results.table(level)
    frame = frame[frame["case"].isin(cases)]
    if level != "link":
        return frame
    frame = by_floor(frame)
    return frame.assign(pair=frame["left"].astype(str) + " | " + frame["right"].astype(str))


def _quantity(
    frame: pd.DataFrame, key: str, level: str, heights: bool, points: int, known: dict[str, list[str]]
) -> dict[str, Any]:
    """One quantity; nothing where it has no number."""
    where, at = _PLACES[level]
    place = ["case", "analysis", "motion", where, at]
    found = over_motions(frame, key, place)
    if found.empty or (level == "link" and not (found["mean"] != 0).any()):
        return {}
    if not heights:
        found = largest(found, ["point", *place[:4]]).assign(**{at: 0})
    rows = found[place].drop_duplicates()
    row = pd.MultiIndex.from_frame(rows).get_indexer(pd.MultiIndex.from_frame(found[place]))
    packed: dict[str, Any] = {"level": at, "where": where}
    codes = [known[name].index for name in place[:4]]
    packed["rows"] = [
        [*(code(value) for code, value in zip(codes, each[:4], strict=True)), int(each[4])]
        for each in rows.itertuples(index=False, name=None)
    ]
    single = [motion != MEAN for motion in rows["motion"]]
    for name, column in (("mean", "mean"), ("low", "min"), ("high", "max")):
        values = np.full((len(rows), points), np.nan)
        values[row, found["point"]] = found[column]
        packed[name] = (values if name == "mean" else values[np.logical_not(single)]).ravel()
    return packed


def _void(results: Results, axes: Sequence[SweptAxis], cases: Sequence[str]) -> list[dict[str, Any]]:
    """By case and analysis: at how many motions of every point the numbers have no meaning, and why."""
    flagged = void_scenes(results.scene(), axes)
    flagged = flagged[(flagged["point"] >= 0) & flagged["case"].isin(cases)]
    found = []
    for (case, analysis), rows in flagged.groupby(["case", "analysis"], sort=False):
        motions = rows.drop_duplicates(["point", "record"])["point"]
        count = np.bincount(motions, minlength=math.prod(map(len, axes))).tolist()
        found.append({"case": case, "analysis": analysis, "count": count, "why": str(rows["flag"].iloc[0])})
    return found


def _place(axes: Sequence[SweptAxis], shown: Evidence) -> list[int]:
    """The place of the point shown on every axis; the first where it was thinned out."""
    wanted = [tuple(shown.point[key] for key in axis.keys) for axis in axes]
    return [axis.points.index(w) if w in axis.points else 0 for axis, w in zip(axes, wanted, strict=True)]


def rounded(value: float) -> float | int | None:
    """A number with six digits; None where there is none, a whole one as an integer."""
    if not math.isfinite(value):
        return None
    short = float(f"{value:.6g}")
    return int(short) if short.is_integer() and abs(short) < 1e15 else short
