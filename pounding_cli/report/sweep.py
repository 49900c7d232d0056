"""Figures of a sweep: the largest mean ratio of every building against the swept value, one line a case."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from pounding_cli.report.evidence import Evidence, motion_sentence
from pounding_cli.report.figures import RESPONSES, framed, headline, plotted_cases
from pounding_cli.report.style import caption, looks, styled
from pounding_cli.words import counted

LINE = 34
"""Characters that fit under one panel."""
MOST_POINTS = 40
"""Points without a numeric axis beyond which there is no figure: their names would not be legible."""


def sweep_figures(evidences: Sequence[Evidence]) -> dict[str, Figure]:
    """One figure a building; none where many points have no numeric axis to stand on."""
    numeric = _numeric_axis(evidences)
    if numeric is None and len(evidences) > MOST_POINTS:
        return {}
    return {f"{name}-sweep": sweep_figure(evidences, name) for name in evidences[0].group}


def _numeric_axis(evidences: Sequence[Evidence]) -> np.ndarray | None:
    """The swept values, where exactly one key is swept and its values are numbers."""
    values = [list(evidence.point.values()) for evidence in evidences]
    if len(values[0]) != 1 or not all(isinstance(value[0], int | float | np.number) for value in values):
        return None
    return np.array([value[0] for value in values], float)


def _worded(evidences: Sequence[Evidence]) -> tuple[list[str], str]:
    """Ticks for points that are no numbers, and their key: the words where they fit, else numbers."""
    words = [", ".join(str(value) for value in evidence.point.values()) for evidence in evidences]
    width = LINE // len(words)
    wrapped = [textwrap.fill(text, max(width, 1), break_long_words=False) for text in words]
    if max(len(line) for text in wrapped for line in text.split("\n")) <= width and len("".join(words)) < 3 * LINE:
        return wrapped, ""
    numbers = [str(number) for number in range(1, len(words) + 1)]
    return numbers, " Points: " + "; ".join(f"({n}) {text}" for n, text in zip(numbers, words, strict=True)) + "."


@styled
def sweep_figure(evidences: Sequence[Evidence], building: str) -> Figure:
    """V/V0 elastic and mu/mu0 inelastic at the storey where the mean over the motions is largest."""
    first = evidences[0]
    panels = [panel for panel in RESPONSES if panel[0] in first.analyses]
    figure, axes = framed(first, [building], 1, max(len(panels), 1), headline(first, building))
    numeric = _numeric_axis(evidences)
    ticks, key = ([], "") if numeric is not None else _worded(evidences)
    across = np.arange(len(evidences)) if numeric is None else numeric
    order = np.argsort(across, kind="stable")
    for ax, (analysis, ratio, label) in zip(axes[0], panels, strict=False):
        for case, look in looks(plotted_cases(first)).items():
            largest = np.array([evidence.means(case, analysis, building, ratio).max() for evidence in evidences])
            ax.plot(
                across[order],
                largest[order],
                color=look.color,
                ls=look.line,
                marker=look.marker,
                ms=5,
                lw=1.6,
            )
        ax.axhline(1, color="0.35", lw=1.0, zorder=1)
        ax.set_title(analysis.capitalize(), loc="left")
        ax.set_ylabel(f"{label}, largest mean over the storeys")
        if numeric is None:
            ax.set_xticks(across, ticks)
            ax.set_xlim(-0.3, len(ticks) - 0.7)
        elif (numeric > 0).all() and numeric.max() / numeric.min() > 20:
            ax.set_xscale("log")
        ax.set_xlabel(", ".join(first.point))
    motions = counted(first.storey["record"].nunique(), "motion")
    sentence = motion_sentence(first.records)
    caption(figure, f"Means over the {motions} of the ratios to {building} alone. {sentence}{key}")
    return figure
