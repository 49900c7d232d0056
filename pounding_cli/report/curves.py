"""Curves of a quantity against one swept axis: the mean over the motions, one line per case, with its spread."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pounding_cli.report.axes import Placed, placed
from pounding_cli.report.evidence import Evidence
from pounding_cli.report.figures import framed
from pounding_cli.report.quantity import Panels
from pounding_cli.report.style import Look, caption, looks, styled

LINE = 34
"""Characters that fit under one panel."""
PANELS_IN_A_ROW = 2


@styled
def draw_curves(
    evidence: Evidence, black: Sequence[str], headline: str, panels: Sequence[Panels], words: str
) -> Figure:
    """One panel for each of `panels`, the swept axis across.

    black : buildings filled in the drawing of the group
    words : what is drawn, for the caption
    """
    cases = list(dict.fromkeys(case for panel in panels for case in panel.by_case))
    columns = min(len(panels), PANELS_IN_A_ROW)
    rows = -(-len(panels) // columns)
    figure, axes = framed(evidence, black, rows, columns, headline, cases=cases, width=4.0, height=3.2)
    every = [over for panel in panels for over in panel.by_case.values()]
    places = placed(every[0].axes[0], LINE)
    flat = [ax for line in axes for ax in line]
    for ax, panel in zip(flat, panels, strict=False):
        _draw(ax, panel, places, looks(cases))
    for ax in flat[len(panels) :]:
        ax.axis("off")
    spread = "; bands: one standard deviation either way" if any(np.isfinite(over.std).any() for over in every) else ""
    caption(figure, f"{words}{spread}.{_void(panels)}{places.key}")
    return figure


def _draw(ax: Axes, panel: Panels, places: Placed, look: Mapping[str, Look]) -> None:
    x, joined = places.positions, places.ticks is None
    for case, over in panel.by_case.items():
        mean, std, void = (values[places.order] for values in (over.mean, over.std, over.meaningless > 0))
        style = look[case]
        if joined:
            ax.fill_between(x, mean - std, mean + std, color=style.color, alpha=0.13, lw=0, zorder=1.5)
        elif np.isfinite(std).any():
            ax.errorbar(x, mean, yerr=std, fmt="none", ecolor=style.color, elinewidth=0.8, capsize=2)
        ax.plot(x, mean, color=style.color, ls=style.line if joined else "none", lw=1.6, zorder=2.5, label=case)
        size = 5 if len(x) <= 25 else 2.5
        ax.plot(x[~void], mean[~void], style.marker, color=style.color, ms=size, zorder=3)
        ax.plot(x[void], mean[void], style.marker, mfc="white", mec="0.45", ms=size + 1, zorder=3)
    first = next(iter(panel.by_case.values()))
    ax.set_title(panel.heading, loc="left")
    ax.set_ylabel(first.title)
    if first.is_ratio:
        ax.axhline(1, color="0.35", lw=1.0, zorder=1)
    places.apply(ax, "x")
    first.axes[0].name(ax, "x")
    if not joined:
        ax.set_xlim(0.6, len(x) + 0.4)


def _void(panels: Sequence[Panels]) -> str:
    """What the open markers mean, in a sentence; "" where there are none."""
    void = {case: over for panel in panels for case, over in panel.by_case.items() if over.meaningless.any()}
    if not void:
        return ""
    reasons = "; ".join(dict.fromkeys(reason for over in void.values() for reason in over.reasons))
    return f" Open grey markers ({', '.join(void)}): the numbers of some motions have no meaning, {reasons}."
