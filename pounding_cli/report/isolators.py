"""The loops of isolators: their force over the displacement of the base, of scenes that a study keeps over time."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure

from pounding_cli.report.document import Picture
from pounding_cli.report.evidence import Evidence
from pounding_cli.report.style import caption, entitle, looks, panels, shared_legend, styled

if TYPE_CHECKING:
    from pounding_cli.results.results import Results

MOST = 6
"""Scenes in one figure."""


def loop_pictures(results: Results, shown: Evidence) -> list[Picture]:
    """The figure of the loops; nothing where no kept scene has isolators."""
    isolated = [
        name for name in results.resolved["places"]
        if isinstance(base := shown.of_study(name).get("foundation"), dict) and base.get("isolation")
    ]  # fmt: skip
    kept = [row for row in results.histories().to_dict("records") if all(row[k] == v for k, v in shown.point.items())]
    if not isolated or not kept:
        return []
    text = f"Force of the isolators of {', '.join(isolated)} over the displacement of the base, of kept scenes."
    return [Picture("isolators", "Isolators", text, partial(draw_loops, results, shown, isolated, kept[:MOST]))]


@styled
def draw_loops(results: Results, shown: Evidence, isolated: list[str], kept: list[dict[Any, Any]]) -> Figure:
    """A panel for each building on isolators, a line for each kept scene."""
    figure, axes = panels(1, len(isolated), 4.2, 3.4)
    how = looks([str(row["case"]) for row in kept])
    for row in kept:
        place = {name: row[name] for name in ("case", "analysis", "record")}
        history = results.history(**place, **shown.point)
        for ax, name in zip(axes.flat, isolated, strict=True):
            number = list(history.buildings).index(name)
            sway, force = history.sway[:, number], history.base_force[:, number]
            there = np.isfinite(sway)
            label = f"{row['case']}, {row['analysis']}, {row['record']}"
            color, line = how[str(row["case"])].color, "--" if row["analysis"] == "inelastic" else "-"
            ax.plot(100 * sway[there], force[there] / 1e6, line, color=color, lw=0.9, label=label)
    for ax, name in zip(axes.flat, isolated, strict=True):
        ax.set_title(name, loc="left")
        ax.set_xlabel("displacement of the base [cm]")
    axes.flat[0].set_ylabel("force of the isolators [MN]")
    shared_legend(figure, axes.flat)
    entitle(figure, shown.title)
    caption(figure, "Without the dashpots beside the isolators.")
    return figure
