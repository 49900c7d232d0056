"""The figure of how costs grow, drawn from the kept numbers."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter, NullLocator

from .clock import ROOT

PICTURE = ROOT / "docs" / "figures" / "growth-scene.png"
BLUE, GREY = "#1f5fa8", "#8a8a8a"


def draw(growth: Sequence[dict], sweeps: Sequence[dict], path: Path = PICTURE) -> None:
    """One panel a sort of growth, one for a sweep's time, one for its memory; straight lines show what is allowed."""
    figure, axes = plt.subplots(2, 4, figsize=(11, 5.2), layout="constrained")
    panels = list(axes.flat)
    for panel, one in zip(panels, growth, strict=False):
        _panel(panel, one["values"], np.array(one["seconds"]) * 1e3, one["over"], "time of a scene [ms]")
        if one["whole"]:
            panel.axhline(1e3 * one["seconds"][0] * one["most"], color=GREY, ls="--", lw=1)
            panel.invert_xaxis()
            _say(panel, f"x {one['ratio']:.2g} in all (dashed: x {one['most']:g})")
        elif one["most"]:
            _line(panel, one["values"], 1e3 * one["seconds"][0], one["most"])
            _say(panel, f"slope {one['slope']:.2f} (dashed: {one['most']:.3g})")
        else:
            _say(panel, f"x {one['ratio']:.0f} in all")
    counts = [one["scenes"] for one in sweeps]
    time, memory, *empty = panels[len(growth) :]
    _panel(time, counts, [one["wall"] for one in sweeps], "scenes in a sweep", "pound run, all included [s]")
    long = [one for one in sweeps if one["scenes"] >= 1000]  # shorter ones are starting and loading
    _line(time, [one["scenes"] for one in long], long[0]["wall"], 1.0)
    _say(time, "dashed: linear")
    _panel(memory, counts, [one["memory"] / 1e6 for one in sweeps], "scenes in a sweep", "memory of all processes [MB]")
    memory.axhline(500, color=GREY, ls="--", lw=1)
    memory.set_ylim(50, 2000)
    _say(memory, "dashed: 500 MB")
    for panel in empty:
        panel.set_axis_off()
    figure.savefig(path, dpi=130, metadata={"Software": None})
    plt.close(figure)


def _panel(panel: Axes, x: Sequence[float], y: Sequence[float] | np.ndarray, over: str, what: str) -> None:
    panel.loglog(x, y, "o-", color=BLUE, ms=4, lw=1.4)
    panel.set_xlabel(over, fontsize=8)
    panel.set_ylabel(what, fontsize=8)
    panel.tick_params(labelsize=7, which="both")
    if max(x) / min(x) < 1000:  # round numbers as a reader writes them, not powers of ten
        panel.set_xticks(x, [f"{value:g}" for value in x])
        panel.xaxis.set_minor_locator(NullLocator())
    panel.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if max(y) / min(y) < 100 else (1.0,)))
    panel.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    panel.yaxis.set_minor_formatter(NullFormatter())
    panel.grid(True, which="major", color="#dddddd", lw=0.6)
    panel.spines[["top", "right"]].set_visible(False)


def _line(panel: Axes, x: Sequence[float], first: float, slope: float) -> None:
    """What growth of this slope would give, from the first value on."""
    at = np.array([x[0], x[-1]], float)
    panel.plot(at, first * (at / at[0]) ** slope, "--", color=GREY, lw=1)


def _say(panel: Axes, text: str) -> None:
    panel.set_title(text, fontsize=8, loc="left")
