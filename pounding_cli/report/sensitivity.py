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

from pounding_cli.numbers import Unit, counted
from pounding_cli.report.background import background, frame_of
from pounding_cli.report.document import Picture, Report, Section
from pounding_cli.report.evidence import Evidence, axis_keys, motion_sentence, nominal
from pounding_cli.report.references import Use
from pounding_cli.report.style import caption, entitle, key_words, name_axis, new_figure, shared_legend, styled
from pounding_cli.report.table import NOTHING, digits, from_rows, interval
from pounding_cli.results.tables import Table
from pounding_cli.workflows.sensitivity import FOUND, INDICES, OUTPUTS, PERCENTILES, PROBABILITIES, SAMPLES

if TYPE_CHECKING:
    from pounding_cli.results.results import Results

MOST = 6
"""Outputs in one figure, and keys whose samples are drawn; of more, the first and those that decide most."""

_LOW, _HIGH, _FIRST, _TOTAL = "#0072B2", "#E69F00", "#56B4E9", "#000000"
_SHOWN = {
    "first": "first order", "total": "total", "at_low": "output at its low end", "at_high": "output at its high end",
    "mu_star": "mean effect", "mu": "mean, signed", "sigma": "deviation",
}  # fmt: skip
"""Columns of the indices that a person reads."""


def sensitivity_report(results: Results) -> Report:
    """What a sensitivity study says; figures and sentences at one point of the other swept keys."""
    whole, results = results, results.first_sample()
    answer, shown = results.answer(INDICES), nominal(results)
    tables, said, pictures = list[Table](), list[str](), list[Picture]()
    frame = answer.frame[answer.frame["case"] != ""]  # claims rest on all cases: their probabilities say what decides
    is_sobol, stated = "total" in frame, set[str]()
    if PROBABILITIES in results.answers:
        held = results.answer(PROBABILITIES).frame
        stated = set(held["statement"])
        tables.append(_probabilities(results, held))
    if (frame["outcome"] == FOUND).any():
        tables.append(_indices(results, frame))
    drawn = []
    for title, rows in parts(results, _at(results, frame, shown)):
        if rows["output"].iloc[0] not in stated:
            said.append(sentence(title, rows))
        if rows["outcome"].iloc[0] == FOUND:
            drawn.append((title, rows))
    if OUTPUTS in results.answers:
        outputs = _at(results, results.answer(OUTPUTS).frame, shown)
        said += [spread_sentence(row) for row in outputs.to_dict("records")]
    if drawn := drawn[:MOST]:
        samples, text = results.answer(SAMPLES), " ".join(sentence(*each) for each in drawn)
        draw = partial(draw_indices, is_sobol, drawn, shown)
        pictures.append(Picture("sensitivity", "What decides the outputs", text, draw))
        draw = partial(draw_samples, samples, _at(results, samples.frame, shown), drawn, shown)
        text = "Every dot is a sample; the line is the mean of the output along the key."
        pictures.append(Picture("sensitivity-samples", "The samples", text, draw))
    scene = whole.scene()
    return Report(
        **frame_of(results, shown, scene, len(scene[axis_keys(scene)].drop_duplicates())),
        answer=Section("", said, tables, pictures, list(_notes(results, answer.frame))),
        more=lambda: background(whole, shown, scene, ("records",)),
    )


def _at(results: Results, frame: pd.DataFrame, shown: Evidence) -> pd.DataFrame:
    """The rows of the point that is shown; the samples, which are the last axis, are no point of it."""
    for key, value in shown.point.items():
        if key in frame and key not in results.swept[-1]:
            frame = frame[frame[key] == value]
    return frame


def _where(results: Results, row: Mapping[Any, Any]) -> str:
    """Point of the other axes, case and analysis in words."""
    said = [f"{key} = {results.value_label(key, row[key])}" for key in results.axes if key in row]
    return ", ".join([*said, f"case {row['case']}", str(row["analysis"])] if row["case"] else [*said, "all cases"])


def parts(results: Results, frame: pd.DataFrame) -> Iterator[tuple[str, pd.DataFrame]]:
    """Every output in words with where it stands, and its indices, those that decide most first."""
    keys = [key for key in results.axes if key in frame]
    by = "total" if "total" in frame else "mu_star"
    for _, rows in frame.groupby([*keys, "case", "analysis", "output"], sort=False):
        first = rows.iloc[0]
        unit = f" [{first['unit']}]" if first["unit"] else ""
        title = f"{first['output']}{unit}, {_where(results, first.to_dict())}"
        yield title, rows.sort_values(by, ascending=False, kind="stable")


def _indices(results: Results, frame: pd.DataFrame) -> Table:
    """The indices of every output, those that decide most first, with intervals or standard errors."""
    names, rows = [name for name in _SHOWN if name in frame], []
    for title, part in parts(results, frame):
        for row in part.to_dict("records") if part["outcome"].iloc[0] == FOUND else ():
            rows.append([title, row["key"], *(_index(row, name) for name in names)])
    return from_rows("What decides the outputs", ("output", "key", *(_SHOWN[name] for name in names)), rows)


def _index(row: Mapping[Any, Any], name: str) -> str:
    if f"{name}_low" in row:
        return interval(row, name)
    error = row.get(f"{name}_error", np.nan)
    return digits(row[name], 3) + (f" ± {digits(error, 2)}" if error > 0 else "")


def _probabilities(results: Results, frame: pd.DataFrame) -> Table:
    """How likely every statement holds, with its interval, and the key that decides it most."""
    rows = [
        [row["statement"], _where(results, row), interval(row, "probability"),
         row["decided_by"] or NOTHING]
        for row in frame.to_dict("records")
    ]  # fmt: skip
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
        return f"{what}: no distribution, {counted(int(row['failed']), 'sample')} gave no number."
    between = " to ".join(digits(row[f"percentile_{part}"], 3) for part in (low, high))
    return f"{what}: mean {interval(row, 'mean')}{unit}; {high - low} % of the samples from {between}{unit}."


def _notes(results: Results, frame: pd.DataFrame) -> Iterator[str]:
    """What brackets are, and what has no index."""
    spec = results.resolved["sensitivity"]
    yield (
        f"In brackets: {100 * spec['confidence']:.4g} % interval, of indices from {spec['draws']} bootstrap draws of "
        f"the {int(frame['samples'].iloc[0])} samples."
    )
    if (frame["case"] == "").any():
        yield "Claims of the paper and their thresholds: `pound report` of a run, or docs/reproduction.md."
    if failed := int(frame["failed"].max()):
        yield (
            f"Where samples gave no number (up to {counted(failed, 'sample')}) there is no index: leaving them out "
            "would bias it."
        )


@styled
def draw_indices(is_sobol: bool, drawn: list[tuple[str, pd.DataFrame]], shown: Evidence) -> Figure:
    """A line of panels for each output: the output at both ends of each key, and the indices of the key."""
    keys = len(drawn[0][1])
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
            line[1].set(xlabel="part of the variance", xlim=(min(-0.05, line[1].get_xlim()[0]), None))
            line[1].set_xlim(right=max(1.0, line[1].get_xlim()[1]))
        else:
            _dots(line[0], rows, y, "mu_star", _TOTAL, "mean effect")
            line[0].plot(rows["sigma"], y, ls="", marker="x", ms=5, color=_HIGH, label="deviation")
            line[0].set(xlabel="change of the output over the range of the key", xlim=(0, None))
        for ax in line:
            ax.set_ylim(-0.6, keys - 0.4)
            ax.grid(False, axis="y")
    shared_legend(figure, axes[0], "outside lower center", columns=4)
    entitle(figure, shown.title)
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


@styled
def draw_samples(samples: Table, frame: pd.DataFrame, drawn: list[tuple[str, pd.DataFrame]], shown: Evidence) -> Figure:
    """The outputs over the keys: a line of panels for each output, a panel for each of the keys that decide most."""
    wide = min(MOST, len(drawn[0][1]))
    figure = new_figure(1.9 * wide + 0.8, 1.75 * len(drawn) + 0.8)
    axes = figure.subplots(len(drawn), wide, squeeze=False, sharey="row")
    for line, (title, rows) in zip(axes, drawn, strict=True):
        first = rows.iloc[0]
        here = frame[(frame["case"] == first["case"]) & (frame["analysis"] == first["analysis"])]
        if "total" in rows:
            here = here[here["independent"] == 1]
        for ax, key in zip(line, rows["key"], strict=False):
            _scatter(ax, here[key], here[f"output {first['output']}"].to_numpy(float), samples.columns[key].unit)
            name_axis(ax, "x", [key], [samples.columns[key].unit], 7, 28)
            ax.tick_params(labelsize=7)
        line[0].set_ylabel(textwrap.fill(title, 30), fontsize=7)
    entitle(figure, shown.title)
    caption(figure, f"Dots: samples. Line: mean of the output along the key. {motion_sentence(shown.records)}")
    return figure


def _scatter(ax: Axes, column: pd.Series, values: np.ndarray, unit: Unit) -> None:
    """Every sample, and the means over the options of a choice or along a number."""
    samples = pd.DataFrame({"x": column.to_numpy(), "y": values})
    if pd.api.types.is_numeric_dtype(column):
        samples["x"] /= unit.factor
        bins = pd.qcut(samples["x"].rank(method="first"), max(2, min(10, len(samples) // 8)), labels=False)
        means, line = samples.groupby(bins).mean(), dict[str, Any](lw=1.8)
    else:
        numbers, names = pd.factorize(samples["x"])
        means = samples.assign(x=numbers).groupby("x", as_index=False).mean()
        samples["x"] = numbers + np.random.default_rng(1).uniform(-0.2, 0.2, len(numbers))
        ax.set_xticks(range(len(names)), [name[:14] for name in names], rotation=35, ha="right")
        line = {"ls": "", "marker": "_", "ms": 14, "mew": 2}
    ax.plot(samples["x"], samples["y"], ls="", marker=".", ms=2, color="0.6")
    ax.plot(means["x"], means["y"], color=_LOW, **line)


def cite_sensitivity(resolved: Mapping[str, Any], used: Use) -> None:
    """The references of the way a study was asked for sensitivities."""
    if (resolved.get("sensitivity") or {}).get("method", "sobol") == "morris":
        used("campolongo2007", "screening by elementary effects")
    else:
        used("saltelli2010", "first-order and total indices of the variance")
        used("efron1993", "the bootstrap of the samples")
    used("iwanaga2022", "SALib, which draws the samples and computes the indices")
