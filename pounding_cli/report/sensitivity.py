"""The report of `pound sensitivity`: tornado and indices of every output, and its samples over the keys."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pounding_cli.numbers import Unit
from pounding_cli.report import claim_odds
from pounding_cli.report.answer_page import AnswerPage, Illustration
from pounding_cli.report.citations import Use
from pounding_cli.report.claim_samples import ODDS, THRESHOLDS
from pounding_cli.report.evidence import Evidence, motion_sentence
from pounding_cli.report.key_words import key_words, name_axis
from pounding_cli.report.sensitivity_text import (
    Part,
    cells,
    heads,
    method_of,
    notes,
    parts,
    sentence,
    split_claims,
    spread_sentence,
)
from pounding_cli.report.style import caption, entitle, new_figure, shared_legend, styled
from pounding_cli.report.web.story import Grid
from pounding_cli.store import Results
from pounding_cli.store.answers import Answer
from pounding_cli.store.indices import FOUND
from pounding_cli.store.sensitivity import INDICES, OUTPUTS, SAMPLES

MOST_OUTPUTS = 6
"""Outputs in one figure; of more, the first are drawn."""

MOST_KEYS = 6
"""Keys whose samples are drawn, those that decide most."""

_LOW, _HIGH, _FIRST, _TOTAL = "#0072B2", "#E69F00", "#56B4E9", "#000000"


def sensitivity_page(results: Results, shown: Evidence, with_figures: bool = True) -> AnswerPage:
    """What the report of a sensitivity study says, at one point of the other swept keys."""
    answer = results.answer(INDICES)
    of_claims, frame = split_claims(_at(answer.frame, shown))
    found = list(parts(results, frame))
    figures: dict[str, Illustration] = {}
    grids, lead, said = list[tuple[str, Grid]](), list[str](), list[str]()
    if claim_odds.asks_claims(results):
        odds = _at(results.answer(ODDS).frame, shown)
        lead = claim_odds.lead(odds)
        grids = claim_odds.grids(odds, _at(results.answer(THRESHOLDS).frame, shown))
        said = claim_odds.notes(results, odds)
        if with_figures:
            drawing = claim_odds.draw_odds(odds, of_claims, shown)
            figures["sensitivity-claims"] = Illustration(drawing, "How likely each claim holds", " ".join(lead))
    drawn = [part for part in found if part.outcome == FOUND][:MOST_OUTPUTS]
    if with_figures and drawn:
        text = " ".join(map(sentence, drawn))
        figures["sensitivity"] = Illustration(draw_indices(answer, drawn, shown), "What decides the outputs", text)
        samples = results.answer(SAMPLES)
        about = "Every dot is a sample; the line is the mean of the output along the key."
        scatter = draw_samples(samples, _at(samples.frame, shown), drawn, shown)
        figures["sensitivity-samples"] = Illustration(scatter, "The samples", about)
    grids += [
        (part.title, Grid(heads(answer), cells(answer, part), range(1, len(heads(answer)))))
        for part in found
        if part.outcome == FOUND
    ]
    lead += [sentence(part) for part in found]
    if OUTPUTS in results.answers:
        lead += [spread_sentence(row) for row in _at(results.answer(OUTPUTS).frame, shown).to_dict("records")]
    return AnswerPage("Sensitivity", lead, figures, grids, [*said, *notes(results)])


def _at(frame: pd.DataFrame, shown: Evidence) -> pd.DataFrame:
    """The rows of the point that is shown; the samples are no point of it."""
    uncertain = shown.resolved.get("uncertain") or {}
    sampled = {key for entry in (uncertain if isinstance(uncertain, list | tuple) else [uncertain]) for key in entry}
    for key, value in shown.point.items():
        if key in frame and key not in sampled:
            frame = frame[frame[key] == value]
    return frame


@styled
def draw_indices(answer: Answer, drawn: list[Part], shown: Evidence) -> Figure:
    """A line of panels for each output: the output at both ends of each key, and the indices of the key."""
    keys = len(drawn[0].rows)
    is_sobol = method_of(answer) == "sobol"
    figure = new_figure(9.0 if is_sobol else 6.0, (0.33 * keys + 1.0) * len(drawn) + 0.8)
    axes = figure.subplots(len(drawn), 2 if is_sobol else 1, squeeze=False, sharey="row")
    for line, part in zip(axes, drawn, strict=True):
        rows = part.rows[::-1].reset_index(drop=True)
        y = np.arange(len(rows))
        named = [f"{textwrap.fill(key_words(key, shown.resolved), 32)}\n{key}" for key in rows["key"]]
        line[0].set_yticks(y, named, fontsize=7)
        line[0].set_title(part.title, loc="left")
        unit = f" [{part.unit}]" if part.unit else ""
        if is_sobol:
            _tornado(line[0], rows, y)
            line[0].set_xlabel(f"mean output{unit}")
            _bars(line[1], rows, y)
            line[1].set_xlabel("part of the variance")
        else:
            _dots(line[0], rows, y, "mu_star", _TOTAL, "mean effect")
            line[0].plot(rows["sigma"], y, ls="", marker="x", ms=5, color=_HIGH, label="deviation")
            line[0].set_xlabel(f"change of the output over the range of the key{unit}")
            line[0].set_xlim(left=0)
        for ax in line:
            ax.set_ylim(-0.6, len(rows) - 0.4)
            ax.grid(False, axis="y")
    shared_legend(figure, axes[0], "outside lower center", columns=4)
    entitle(figure, shown.title)
    return figure


def _tornado(ax: Axes, rows: pd.DataFrame, y: np.ndarray) -> None:
    """Mean output at the low and at the high end of each key, from its mean outwards."""
    low, high = rows["at_low"].to_numpy(float), rows["at_high"].to_numpy(float)
    middle = float(rows["mean"].iloc[0])
    for ends, errors, color, label in (
        (low, rows["at_low_error"], _LOW, "key at its low end"),
        (high, rows["at_high_error"], _HIGH, "key at its high end"),
    ):
        ax.barh(y, ends - middle, left=middle, height=0.56, color=color, label=label)
        ax.errorbar(ends, y, xerr=errors, ls="", color="0.25", lw=1, capsize=2)
    ax.axvline(middle, color="0.3", lw=0.8)


def _bars(ax: Axes, rows: pd.DataFrame, y: np.ndarray) -> None:
    _dots(ax, rows, y + 0.13, "total", _TOTAL, "total index")
    _dots(ax, rows, y - 0.13, "first", _FIRST, "first order")
    ax.axvline(0, color="0.3", lw=0.8)
    ax.set_xlim(min(-0.05, ax.get_xlim()[0]), max(1.0, ax.get_xlim()[1]))


def _dots(ax: Axes, rows: pd.DataFrame, y: np.ndarray, name: str, color: str, label: str) -> None:
    x = rows[name].to_numpy(float)
    ends = np.maximum([x - rows[f"{name}_low"], rows[f"{name}_high"] - x], 0)
    ax.errorbar(x, y, xerr=ends, ls="", marker="o", ms=4.5, color=color, lw=1.2, capsize=2.5, label=label)


@styled
def draw_samples(samples: Answer, frame: pd.DataFrame, drawn: list[Part], shown: Evidence) -> Figure:
    """The outputs over the keys: a line of panels for each output, a panel for each of the keys that decide most."""
    wide = min(MOST_KEYS, len(drawn[0].rows))
    figure = new_figure(1.9 * wide + 0.8, 1.75 * len(drawn) + 0.8)
    axes = figure.subplots(len(drawn), wide, squeeze=False, sharey="row")
    for line, part in zip(axes, drawn, strict=True):
        first = part.rows.iloc[0]
        here = frame[(frame["case"] == first["case"]) & (frame["analysis"] == first["analysis"])]
        if "total" in part.rows:
            here = here[here["independent"] == 1]
        values = here[f"output {part.output}"].to_numpy(float)
        for ax, key in zip(line, part.rows["key"], strict=False):
            _scatter(ax, samples, here[key], values)
            name_axis(ax, "x", [key], [samples.units.get(key, Unit())], shown.resolved, 7, 28)
            ax.tick_params(labelsize=7)
        words = f"\n{part.words}" if part.words else ""
        line[0].set_ylabel(f"{part.output}{f' [{part.unit}]' if part.unit else ''}{words}", fontsize=7)
    entitle(figure, shown.title)
    caption(figure, f"Dots: samples. Line: mean of the output along the key. {motion_sentence(shown.records)}")
    return figure


def _scatter(ax: Axes, samples: Answer, column: pd.Series, values: np.ndarray) -> None:
    if not pd.api.types.is_numeric_dtype(column):
        names = list(dict.fromkeys(column))
        x = column.map({name: n for n, name in enumerate(names)}).to_numpy(float)
        random = np.random.default_rng(1)
        ax.plot(x + random.uniform(-0.2, 0.2, x.size), values, ls="", marker=".", ms=2, color="0.6")
        means = [values[x == n].mean() for n in range(len(names))]
        ax.plot(range(len(names)), means, ls="", marker="_", ms=14, mew=2, color=_LOW)
        ax.set_xticks(range(len(names)), [name[:14] for name in names], rotation=35, ha="right")
        return
    unit = samples.units.get(str(column.name))
    x = column.to_numpy(float) / (unit.factor if unit else 1.0)
    order = np.argsort(x, kind="stable")
    ax.plot(x, values, ls="", marker=".", ms=2, color="0.6")
    bins = np.array_split(order, max(2, min(10, x.size // 8)))
    ax.plot([x[b].mean() for b in bins], [values[b].mean() for b in bins], color=_LOW, lw=1.8)


def cite_sensitivity(resolved: Mapping[str, Any], used: Use) -> None:
    """The references of the way a study was asked for sensitivities."""
    if (resolved.get("sensitivity") or {}).get("method", "sobol") == "morris":
        used("campolongo2007", "screening by elementary effects")
    else:
        used("saltelli2010", "first-order and total indices of the variance")
        used("efron1993", "the bootstrap of the samples")
    used("iwanaga2022", "SALib, which draws the samples and computes the indices")
