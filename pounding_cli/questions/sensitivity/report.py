"""The report of `pound sensitivity`: which uncertain keys decide an output, and how likely statements hold."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Mapping
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pounding_cli.numbers import Unit, pluralize
from pounding_cli.questions.sensitivity.indices import FOUND, INDICES, OUTPUTS, PERCENTILES, PROBABILITIES
from pounding_cli.report.background import report_of
from pounding_cli.report.document import Picture, Report, Section
from pounding_cli.report.evidence import Evidence, find_nominal
from pounding_cli.report.style import finish, new_figure, shared_legend, styled
from pounding_cli.report.table import NOTHING, digits, from_records, from_rows, interval
from pounding_cli.results.tables import Table
from pounding_cli.study.display import key_words

if TYPE_CHECKING:
    from pounding_cli.results.results import ResultTables

MOST = 6
"""Outputs in the figure; of more, the first are drawn."""

ROUNDING = 1e-9
"""An index below this is zero: the numbers differ by rounding [-]."""

_LOW, _HIGH, _FIRST, _TOTAL = "#0072B2", "#E69F00", "#56B4E9", "#000000"
_SHOWN = {
    "first": "first order", "total": "total", "at_low": "at its low end", "at_high": "at its high end",
    "mu_star": "mean effect", "mu": "mean, signed", "sigma": "deviation",
}  # fmt: skip
"""Columns of the indices that a person reads."""

Row = Mapping[Any, Any]


def sensitivity_report(results: ResultTables) -> Report:
    """What a sensitivity study says; figures and sentences at one point of the other swept keys."""
    frame, shown = results.answer(INDICES).frame, find_nominal(results.first_sample())
    of_cases = frame[frame["case"] != ""]  # claims rest on all cases: their probabilities say what decides
    said, tables, pictures, stated = list[str](), list[Table](), list[Picture](), set[str]()
    if PROBABILITIES in results.answers:
        held = results.answer(PROBABILITIES).frame
        tables, stated = [_probabilities(results, held)], set(held["statement"])
    found = of_cases[of_cases["outcome"] == FOUND]
    if len(found):
        tables.append(_indices(results, found))
    for title, rows in parts(results, shown.rows_here(of_cases)):
        said += [] if rows["output"].iloc[0] in stated else [sentence(title, rows)]
    if OUTPUTS in results.answers:
        said += map(spread_sentence, shown.rows_here(results.answer(OUTPUTS).frame).to_dict("records"))
    if drawn := list(parts(results, shown.rows_here(found)))[:MOST]:
        text = " ".join(sentence(*each) for each in drawn)
        draw = partial(draw_indices, drawn, shown)
        pictures = [Picture("sensitivity", "What decides the outputs", text, draw)]
    return report_of(results, shown, Section("", said, tables, pictures, list(_notes(results, frame))), is_sampled=True)


def _where(results: ResultTables, row: Row) -> str:
    """Point of the other axes, case and analysis in words."""
    said = [f"{key} = {results.value_label(key, row[key])}" for key in results.axes if key in row]
    return ", ".join([*said, f"case {row['case']}", str(row["analysis"])] if row["case"] else [*said, "all cases"])


def parts(results: ResultTables, frame: pd.DataFrame) -> Iterator[tuple[str, pd.DataFrame]]:
    """Every output in words with where it stands, and its indices, those that decide most first."""
    keys = [key for key in results.axes if key in frame]
    by = "total" if "total" in frame else "mu_star"
    indices = frame.columns[frame.columns.str.match("(first|total)(_|$)")]
    frame = frame.assign(**frame[indices].mask(frame[indices].abs() < ROUNDING, 0.0))
    for _, rows in frame.groupby([*keys, "case", "analysis", "output"], sort=False):
        first = rows.iloc[0].to_dict()
        title = f"{Unit(first['unit']).label(first['output'])}, {_where(results, first)}"
        yield title, rows.sort_values(by, ascending=False, kind="stable")


def _indices(results: ResultTables, frame: pd.DataFrame) -> Table:
    """The indices of every output, those that decide most first, with intervals or standard errors."""

    def text(row: Row, name: str) -> str:
        if f"{name}_low" in row:
            return interval(row, name)
        error = row.get(f"{name}_error", 0.0)
        return digits(row[name], 3) + (f" ± {digits(error, 2)}" if error > 0 else "")

    rows = [
        {"output": title, "key": row["key"]} | {head: text(row, name) for name, head in _SHOWN.items() if name in row}
        for title, part in parts(results, frame)
        for row in part.to_dict("records")
    ]
    return from_records("What decides the outputs", rows)


def _probabilities(results: ResultTables, frame: pd.DataFrame) -> Table:
    """How likely every statement holds, with its interval, and the key that decides it most."""
    rows = [
        [row["statement"], _where(results, row), interval(row, "probability"), row["decided_by"] or NOTHING]
        for row in frame.to_dict("records")
    ]
    return from_rows("How likely statements hold", ("statement", "where", "probability", "decided most by"), rows)


def sentence(title: str, rows: pd.DataFrame) -> str:
    """What decides an output."""
    first = rows.iloc[0].to_dict()
    if first["outcome"] != FOUND:
        return f"{title}: {first['outcome']}."
    if "total" in first:
        share = f"{100 * first['total']:.0f} % ({100 * first['total_low']:.0f} to {100 * first['total_high']:.0f} %)"
        return f"{title}: decided most by {first['key']}; with its interactions it explains {share} of the variance."
    return f"{title}: changed most by {first['key']}, on the average by {interval(first, 'mu_star')}."


def spread_sentence(row: Mapping[Any, Any]) -> str:
    """The distribution of an output."""
    low, _, high = PERCENTILES
    what, unit = f"{row['output']}, case {row['case']}, {row['analysis']}", f" {row['unit']}".rstrip()
    if row["mean"] != row["mean"]:
        return f"{what}: no distribution, {pluralize(int(row['failed']), 'sample')} gave no number."
    between = " to ".join(digits(row[f"percentile_{part}"], 3) for part in (low, high))
    return f"{what}: mean {interval(row, 'mean')}{unit}; {high - low} % of the samples from {between}{unit}."


def _notes(results: ResultTables, frame: pd.DataFrame) -> Iterator[str]:
    """What brackets are, and what has no index."""
    spec = results.resolved["sensitivity"]
    yield (
        f"In brackets: {100 * spec['confidence']:.4g} % interval, of indices from {spec['draws']} bootstrap draws of "
        f"the {int(frame['samples'].iloc[0])} samples."
    )
    motions = len(results.data["record"])
    if motions > 1 and (frame["case"] != "").any():
        words = {"mean": "the mean over the motions", "largest": "the largest of the motions"}[spec["over_motions"]]
        yield f"An output of a sample is {words} it rests on, storey by storey, before storeys are compared."
    if (frame["case"] == "").any():
        yield "Claims of the paper and their thresholds: `pound report` of a run, or docs/reproduction.md."
    if failed := int(frame["failed"].max()):
        yield (
            f"Where samples gave no number (up to {pluralize(failed, 'sample')}) there is no index: leaving them out "
            "would bias it."
        )


@styled
def draw_indices(drawn: list[tuple[str, pd.DataFrame]], shown: Evidence) -> Figure:
    """A line of panels for each output: the output at both ends of each key, and the indices of the key."""
    keys, is_sobol = len(drawn[0][1]), "total" in drawn[0][1]
    figure = new_figure(9.0 if is_sobol else 6.0, (0.33 * keys + 1.0) * len(drawn) + 0.8)
    axes = figure.subplots(len(drawn), 2 if is_sobol else 1, squeeze=False, sharey="row")
    for line, (title, most_first) in zip(axes, drawn, strict=True):
        rows, y = most_first[::-1], np.arange(keys)
        named = [f"{textwrap.fill(key_words(key), 32)}\n{key}" for key in rows["key"]]
        line[0].set_yticks(y, named, fontsize=7)
        line[0].set_title(title, loc="left")
        if is_sobol:
            _tornado(line[0], rows, y)
            _dots(line[1], rows, y + 0.13, "total", _TOTAL, "total index")
            _dots(line[1], rows, y - 0.13, "first", _FIRST, "first order")
            line[1].axvline(0, color="0.3", lw=0.8)
            low, high = line[1].get_xlim()
            line[1].set(xlabel="part of the variance", xlim=(min(-0.05, low), max(1.0, high)))
        else:
            _dots(line[0], rows, y, "mu_star", _TOTAL, "mean effect")
            line[0].plot(rows["sigma"], y, ls="", marker="x", ms=5, color=_HIGH, label="deviation")
            line[0].set(xlabel="change of the output over the range of the key", xlim=(0, None))
        for ax in line:
            ax.set_ylim(-0.6, keys - 0.4)
            ax.grid(False, axis="y")
    shared_legend(figure, axes[0], "outside lower center", columns=4)
    finish(figure, shown.title)
    return figure


def _tornado(ax: Axes, rows: pd.DataFrame, y: np.ndarray) -> None:
    """Mean output at the low and at the high end of each key, from its mean outwards."""
    middle = float(rows["mean"].iloc[0])
    for name, color in (("low", _LOW), ("high", _HIGH)):
        ends = rows[f"at_{name}"].to_numpy(float)
        ax.barh(y, ends - middle, left=middle, height=0.56, color=color, label=f"key at its {name} end")
        ax.errorbar(ends, y, xerr=rows[f"at_{name}_error"], ls="", color="0.25", lw=1, capsize=2)
    ax.axvline(middle, color="0.3", lw=0.8)
    ax.set_xlabel("mean output")


def _dots(ax: Axes, rows: pd.DataFrame, y: np.ndarray, name: str, color: str, label: str) -> None:
    x = rows[name].to_numpy(float)
    ends = np.maximum([x - rows[f"{name}_low"], rows[f"{name}_high"] - x], 0)
    ax.errorbar(x, y, xerr=ends, ls="", marker="o", ms=4.5, color=color, lw=1.2, capsize=2.5, label=label)


def cite_sensitivity(resolved: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """The references of the way a study was asked for sensitivities."""
    if (resolved.get("sensitivity") or {}).get("method", "sobol") == "morris":
        yield "campolongo2007", "screening by elementary effects"
    else:
        yield "saltelli2010", "first-order and total indices of the variance"
        yield "efron1993", "the bootstrap of the samples"
    yield "iwanaga2022", "SALib, which draws the samples and computes the indices"
