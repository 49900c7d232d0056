"""What the page draws over a sweep: of every quantity the mean over the motions with its spread, place by place."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd

from pounding_cli.report.axes import SweptAxis, swept_axes
from pounding_cli.report.columns import Shown, shown
from pounding_cli.report.evidence import Tables, by_floor, names
from pounding_cli.report.quantity import largest, over_motions, point_numbers
from pounding_cli.report.web.data import charted, numbers
from pounding_cli.store import flagged_scenes

QUANTITIES = charted("sweep")
"""Quantities by the table that holds them; those that it does not have are left out."""
MOST_VALUES = 200_000
"""Numbers the page carries; of more, only the largest over the height, then only some points of the longest axis."""


def sweep_data(results: Tables, cases: Sequence[str]) -> dict[str, Any] | None:
    """Axes and quantities over the sweep, the last axis fastest; None where nothing is swept.

    cases : those the page carries

    `rows` of a quantity: case, analysis and building or pair as places in `names`, then storey or floor (0: the largest
    over the height); `mean`, `low` and `high` over the motions, row after row. `void`: by case and analysis how many
    motions have numbers without meaning, at every point. `thinned`: every how many points of the longest axes.
    """
    axes = swept_axes(results)
    if not axes:
        return None
    frames = {level: _of_cases(getattr(results, level)(), cases) for level in QUANTITIES}
    kept = {level: [key for key in keys if key in frames[level].columns] for level, keys in QUANTITIES.items()}
    places = {level: frame[_place(level)].drop_duplicates() for level, frame in frames.items()}

    def size(heights: bool, points: int) -> int:
        rows = {level: len(here if heights else here.iloc[:, :3].drop_duplicates()) for level, here in places.items()}
        return 3 * points * sum(rows[level] * len(keys) for level, keys in kept.items())

    heights = size(True, _count(axes)) <= MOST_VALUES
    carried, thinned = list(axes), 1
    while size(heights, _count(carried)) > MOST_VALUES and max(map(len, carried)) > 2:
        longest = max(range(len(carried)), key=lambda number: len(carried[number]))
        carried[longest] = replace(carried[longest], points=carried[longest].points[::2])
        thinned *= 2
    known = {"case": list(cases), "analysis": names(results.scene()["analysis"])}
    known |= {"building": names(frames["storey"]["building"]), "pair": names(_pairs(frames["link"]))}
    quantities: list[dict[str, Any]] = []
    for level, keys in kept.items():
        frame = frames[level].assign(point=point_numbers(frames[level], carried))
        frame = frame[frame["point"] >= 0]
        for key in keys:
            quantities += _quantity(frame, level, shown(key, results.units), key, heights, _count(carried), known)
    return {
        "axes": [_axis(axis) for axis in carried],
        "quantities": quantities,
        "names": known,
        "void": _void(results, carried, cases),
        "heights": heights,
        "thinned": thinned,
    }


def _quantity(
    frame: pd.DataFrame,
    level: str,
    look: Shown,
    key: str,
    heights: bool,
    points: int,
    known: dict[str, list[str]],
) -> list[dict[str, Any]]:
    """One quantity for the page; none where it has no number."""
    place = _place(level)
    found = over_motions(frame, key, place)
    if found.empty:
        return []
    if not heights:
        found = largest(found, ["point", *place[:3]]).assign(**{place[3]: 0})
    rows = found[place].drop_duplicates()
    row = pd.MultiIndex.from_frame(rows).get_indexer(pd.MultiIndex.from_frame(found[place]))
    where = "pair" if level == "link" else "building"
    codes = [known[name].index for name in ("case", "analysis", where)]
    packed: dict[str, Any] = {
        "key": key, "label": look.label, "unit": look.unit, "text": look.text, "level": level, "where": where,
        "rows": [
            [*(code(value) for code, value in zip(codes, each[:3], strict=True)), int(each[3])]
            for each in rows.itertuples(index=False, name=None)
        ],
    }  # fmt: skip
    for name, column in (("mean", "mean"), ("low", "min"), ("high", "max")):
        values = np.full((len(rows), points), np.nan)
        values[row, found["point"]] = look.factor * found[column]
        packed[name] = numbers(values)
    return [packed]


def _void(results: Tables, axes: Sequence[SweptAxis], cases: Sequence[str]) -> list[dict[str, Any]]:
    """By case and analysis: at how many motions of every point the numbers have no meaning, and why."""
    flagged = flagged_scenes(_of_cases(results.scene(), cases))
    flagged = flagged[flagged["meaningless"]]
    flagged = flagged.assign(point=point_numbers(flagged, axes))
    found = []
    for (case, analysis), rows in flagged[flagged["point"] >= 0].groupby(["case", "analysis"], sort=False):
        motions = rows.drop_duplicates(["point", "record"])["point"]
        count = np.bincount(motions, minlength=_count(axes)).tolist()
        found.append({"case": case, "analysis": analysis, "count": count, "why": str(rows["flag"].iloc[0])})
    return found


def _place(level: str) -> list[str]:
    """The columns that say where a number stands: case, analysis, building or pair, storey or floor."""
    return ["case", "analysis", "pair" if level == "link" else "building", "floor" if level == "link" else level]


def _of_cases(frame: pd.DataFrame, cases: Sequence[str]) -> pd.DataFrame:
    frame = frame[frame["case"].isin(cases)]
    if "left" not in frame.columns:
        return frame
    frame = by_floor(frame)
    return frame.assign(pair=_pairs(frame))


def _pairs(link: pd.DataFrame) -> pd.Series:
    return link["left"].astype(str) + " | " + link["right"].astype(str)


def _count(axes: Sequence[SweptAxis]) -> int:
    return math.prod(len(axis) for axis in axes)


def _axis(axis: SweptAxis) -> dict[str, Any]:
    words = [axis.at(place) for place in range(len(axis))]
    values = numbers(axis.coordinates)
    return {"label": axis.words, "numeric": axis.numeric, "values": values, "names": list(axis.names), "words": words}
