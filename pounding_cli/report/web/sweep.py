"""The page's chart of a sweep: the largest mean ratio of every building at every point, by case and analysis."""

from __future__ import annotations

import json
from itertools import chain, product
from typing import Any

import pandas as pd

from pounding_cli.report.columns import shown
from pounding_cli.report.evidence import Tables, axis_keys, names
from pounding_cli.report.web.data import numbers

RATIOS = ("V_ratio", "mu_ratio", "acceleration_ratio")
MOST_VALUES = 60_000
"""Values the chart may carry; a longer sweep is thinned along its longest axis."""

Axis = tuple[list[str], list[tuple[Any, ...]]]
"""Keys that are swept together, and the values they take."""


def sweep_chart(results: Tables) -> dict[str, Any] | None:
    """Axes, and per ratio, analysis, building and case one value a point, the last axis fastest; None without a sweep.

    A value is the largest over the storeys (floors) of the mean over the motions. `thinned`: every how many points of
    the longest axes are there.
    """
    frame = results.summary()
    axes = _axes(frame, results)
    if not axes:
        return None
    ratios = [ratio for ratio in RATIOS if f"{ratio}_mean" in frame.columns]
    lines = len(ratios) * len(frame[["case", "analysis", "building"]].drop_duplicates())
    thinned = 1
    while lines * len(list(product(*(values for _, values in axes)))) > MOST_VALUES:
        longest = max(axes, key=lambda axis: len(axis[1]))
        axes[axes.index(longest)] = (longest[0], longest[1][::2])
        thinned *= 2
    keys = [key for names_of, _ in axes for key in names_of]
    grid = [tuple(chain(*point)) for point in product(*(values for _, values in axes))]
    columns = [f"{ratio}_mean" for ratio in ratios]
    largest = frame.groupby([*keys, "case", "analysis", "building"], sort=False)[columns].max()
    series = []
    for case, analysis, building in product(*(names(frame[key]) for key in ("case", "analysis", "building"))):
        rows = largest.reindex(pd.MultiIndex.from_tuples([(*point, case, analysis, building) for point in grid]))
        for ratio, column in zip(ratios, columns, strict=True):
            line = {"ratio": ratio, "case": case, "analysis": analysis, "building": building}
            series.append({**line, "values": numbers(rows[column].to_numpy(float))})
    labels = {ratio: shown(ratio).label for ratio in ratios}
    return {"axes": [_plain(axis) for axis in axes], "ratios": labels, "series": series, "thinned": thinned}


def _axes(frame: pd.DataFrame, results: Tables) -> list[Axis]:
    """The swept axes in the order of the file."""
    groups = json.loads(results.attrs.get("swept", "null"))
    groups = groups if groups is not None else [[key] for key in axis_keys(frame)]
    return [(keys, list(frame[keys].drop_duplicates().itertuples(index=False, name=None))) for keys in groups]


def _plain(axis: Axis) -> dict[str, Any]:
    keys, values = axis
    numeric = len(keys) == 1 and not any(isinstance(value, str) for (value,) in values)
    shown_values = [value[0] if numeric else ", ".join(map(_word, value)) for value in values]
    return {"label": ", ".join(keys), "numeric": numeric, "values": shown_values}


def _word(value: Any) -> str:
    return value if isinstance(value, str) else f"{value:.4g}"
