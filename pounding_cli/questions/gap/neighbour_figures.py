"""The figure of `pound gap` beside a neighbour that is only seen: how likely a gap is enough."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from pounding_cli.questions.gap.evidence import GapEvidence
from pounding_cli.questions.gap.tables import NEIGHBOUR_CASES_TABLE, NEIGHBOURS_TABLE
from pounding_cli.report.evidence import describe_motions
from pounding_cli.report.style import finish, grid, shared_legend, with_style
from pounding_cli.study.schema.archetypes import is_sample_key

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_DRAWN = ("#0072B2", "over what the neighbour may be")
_MEDIAN = ("#777777", "with the median neighbour")


@with_style
def draw_probabilities(evidence: GapEvidence) -> Figure:
    """Draw the probability that a gap is enough: a panel for each pair of neighbours and analysis."""
    results = evidence.results
    table = results.answer(NEIGHBOURS_TABLE)
    rows = evidence.shown.rows_here(table.frame)
    cases = evidence.shown.rows_here(results.answer(NEIGHBOUR_CASES_TABLE).frame)
    drawn_keys = [key for key in results.axes if is_sample_key(key) and not table.has(key)]
    closings = _find_closings(evidence, drawn_keys)
    panels = list(rows[["left", "right", "analysis"]].itertuples(index=False, name=None))
    figure, axes = grid(len(panels), 3.6, 2.8, "probability that the gap is enough", sharey=True, sharex=True)
    for ax, (left, right, analysis) in zip(axes, panels, strict=True):
        here = closings.xs((left, right, analysis), level=("left", "right", "analysis"))
        is_median = here.index.get_level_values(drawn_keys[0]) == 0
        for (color, label), part in ((_MEDIAN, here[is_median]), (_DRAWN, here[~is_median])):
            _draw_share(ax, part.to_numpy() / evidence.unit.factor, color, label)
        is_panel = (cases["left"] == left) & (cases["right"] == right) & (cases["analysis"] == analysis)
        for gap in cases.loc[is_panel, "gap"].unique():
            ax.axvline(gap / evidence.unit.factor, color="0.6", lw=0.8)
        ax.set(ylim=(0, 1), xlabel=evidence.unit.label("gap"))
        ax.set_title(f"{left} | {right}, {analysis}", loc="left")
    axes[0].set_xlim(0, None)
    shared_legend(figure, axes)
    point = evidence.shown.format_point(rows)
    where = f"At {point}. " if point else ""
    caption = f"{where}Vertical lines: gaps of the cases. {describe_motions(evidence.shown.records)}"
    finish(figure, results.title, caption)
    return figure


def _find_closings(evidence: GapEvidence, drawn_keys: list[str]) -> pd.Series:
    """Return the largest closing of every pair [m], of all drawn and median neighbours, motions and analyses."""
    link = evidence.results.link()
    for key, value in evidence.shown.point.items():
        if key in link and key not in drawn_keys:
            link = link[link[key] == value]
    keys = [drawn_keys[0], "left", "right", "analysis", "record"]
    return link.groupby(keys)["max_closing"].agg(lambda values: values.max(skipna=False)).dropna()


def _draw_share(ax: Axes, widths: np.ndarray, color: str, label: str) -> None:
    """Draw the share of runs that need no more than a width."""
    widths = np.sort(widths)
    shares = np.arange(widths.size + 1) / max(widths.size, 1)
    ax.step([0.0, *widths], shares, where="post", color=color, label=label)
