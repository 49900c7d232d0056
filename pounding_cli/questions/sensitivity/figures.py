"""The figure of `pound sensitivity`: the outputs at both ends of every key, and the indices of the keys."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from pounding_cli.numbers import Unit
from pounding_cli.questions.expression_words import find_output_unit
from pounding_cli.questions.sensitivity.words import describe_influence, describe_output_place, list_shown
from pounding_cli.report.document import Picture
from pounding_cli.report.style import finish, new_figure, shared_legend, with_style
from pounding_cli.study.display import key_words

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from pounding_cli.results.results import ResultTables

_LOW, _HIGH, _FIRST, _TOTAL = "#0072B2", "#E69F00", "#56B4E9", "#000000"


def list_figures(results: ResultTables) -> list[Picture]:
    """Return the figure of the indices; none where no output has any."""
    outputs = list_shown(results)
    if not outputs:
        return []
    sentences = [
        f"{describe_output_place(results, rows.iloc[0].to_dict())}: {describe_influence(results, rows)}"
        for rows in outputs
    ]
    draw = partial(draw_indices, results, outputs)
    return [Picture("sensitivity", "The most influential keys", " ".join(sentences), draw)]


@with_style
def draw_indices(results: ResultTables, outputs: Sequence[pd.DataFrame]) -> Figure:
    """Return a line of panels for every output: the output at both ends of each key, and the indices of the key.

    outputs : the indices of each, the most influential key first
    """
    key_count = len(outputs[0])
    is_sobol = "total" in outputs[0]
    title_width = 100 if is_sobol else 56
    titles = [textwrap.fill(describe_output_place(results, rows.iloc[0].to_dict()), title_width) for rows in outputs]
    height = (0.33 * key_count + 1.0) * len(outputs) + 0.15 * sum(title.count("\n") for title in titles) + 0.8
    figure = new_figure(9.0 if is_sobol else 6.0, height)
    axes = figure.subplots(len(outputs), 2 if is_sobol else 1, squeeze=False, sharey="row")
    y = np.arange(key_count)
    for line, most_first, title in zip(axes, outputs, titles, strict=True):
        rows = most_first[::-1]
        first = most_first.iloc[0].to_dict()
        unit = find_output_unit(results, first["output"], first["unit"])
        line[0].set_yticks(y, map(_label_key, rows["key"]), fontsize=7)
        line[0].set_title(title, loc="left")
        if is_sobol:
            _draw_tornado(line[0], rows, y, unit)
            _draw_dots(line[1], rows, y + 0.13, "total", _TOTAL, "total index")
            _draw_dots(line[1], rows, y - 0.13, "first", _FIRST, "first order")
            line[1].axvline(0, color="0.3", lw=0.8)
            low, high = line[1].get_xlim()
            line[1].set(xlabel="part of the variance", xlim=(min(-0.05, low), max(1.0, high)))
        else:
            _draw_dots(line[0], rows, y, "mu_star", _TOTAL, "mean effect", unit)
            deviations = rows["sigma"] / unit.factor
            line[0].plot(deviations, y, ls="", marker="x", ms=5, color=_HIGH, label="deviation")
            line[0].set(xlabel=unit.label("change of the output over the range of the key"), xlim=(0, None))
        for ax in line:
            ax.set_ylim(-0.6, key_count - 0.4)
            ax.grid(False, axis="y")
    shared_legend(figure, axes[0], "outside lower center", columns=4)
    finish(figure, results.title)
    return figure


def _label_key(key: str) -> str:
    """Return a key in words, and below them as the study writes it."""
    words = key_words(key)
    return key if words == key else f"{textwrap.fill(words, 32)}\n{key}"


def _draw_tornado(ax: Axes, rows: pd.DataFrame, y: np.ndarray, unit: Unit) -> None:
    """Draw the mean output at the low and at the high end of each key, from its mean outwards."""
    middle = float(rows["mean"].iloc[0]) / unit.factor
    for name, color in (("low", _LOW), ("high", _HIGH)):
        ends = rows[f"at_{name}"].to_numpy(float) / unit.factor
        errors = rows[f"at_{name}_error"].to_numpy(float) / unit.factor
        ax.barh(y, ends - middle, left=middle, height=0.56, color=color, label=f"key at its {name} end")
        ax.errorbar(ends, y, xerr=errors, ls="", color="0.25", lw=1, capsize=2)
    ax.axvline(middle, color="0.3", lw=0.8)
    ax.set_xlabel(unit.label("mean output"))


def _draw_dots(
    ax: Axes, rows: pd.DataFrame, y: np.ndarray, name: str, color: str, label: str, unit: Unit | None = None
) -> None:
    """Draw numbers of every key with their intervals."""
    factor = 1.0 if unit is None else unit.factor
    x = rows[name].to_numpy(float) / factor
    below = np.maximum(x - rows[f"{name}_low"].to_numpy(float) / factor, 0)
    above = np.maximum(rows[f"{name}_high"].to_numpy(float) / factor - x, 0)
    ax.errorbar(x, y, xerr=[below, above], ls="", marker="o", ms=4.5, color=color, lw=1.2, capsize=2.5, label=label)
