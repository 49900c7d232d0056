"""The report of `pound sensitivity`: which uncertain keys decide an output, and how likely claims hold."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pounding_cli.numbers import counted
from pounding_cli.report.background import background, frame_of
from pounding_cli.report.claim_odds import ODDS, odds_pictures, odds_sentences, odds_tables
from pounding_cli.report.document import Picture, Report, Section
from pounding_cli.report.evidence import Evidence, axis_keys, motion_sentence, nominal
from pounding_cli.report.references import Use
from pounding_cli.report.style import caption, entitle, key_words, name_axis, new_figure, shared_legend, styled
from pounding_cli.report.table import NOTHING, from_rows
from pounding_cli.results.tables import Table
from pounding_cli.workflows.indices import FOUND
from pounding_cli.workflows.sensitivity import INDICES, OUTPUTS, PERCENTILES, PROBABILITIES, SAMPLES

if TYPE_CHECKING:
    from pounding_cli.results.results import Results

MOST_OUTPUTS, MOST_KEYS = 6, 6
"""Outputs in one figure, and keys whose samples are drawn; of more, the first and those that decide most."""

_LOW, _HIGH, _FIRST, _TOTAL = "#0072B2", "#E69F00", "#56B4E9", "#000000"
_HEADS = {
    "sobol": ("first order", "total", "output at its low end", "at its high end"),
    "morris": ("mean effect", "mean, signed", "deviation"),
}


def sensitivity_report(results: Results) -> Report:
    """What a sensitivity study says; figures and sentences at one point of the other swept keys."""
    whole, results = results, results.first_sample()
    answer, shown = results.answer(INDICES), nominal(results)
    of_claims = answer.frame["case"] == ""
    found = list(parts(results, _at(answer.frame[~of_claims], shown)))
    tables, said, notes, pictures = list[Table](), list[str](), list[str](), list[Picture]()
    if ODDS in results.answers:
        odds = results.answer(ODDS).frame
        tables, notes = odds_tables(results, method_of(answer))
        said = odds_sentences(_at(odds, shown))
        pictures = odds_pictures(_at(odds, shown), _at(answer.frame[of_claims], shown), shown)
    if not of_claims.all():
        tables.append(_indices(results, answer, answer.frame[~of_claims]))
        notes += _legend(results, answer)
    if PROBABILITIES in results.answers:
        tables.append(_probabilities(results, results.answer(PROBABILITIES).frame))
    said += [sentence(part) for part in found]
    if OUTPUTS in results.answers:
        said += [spread_sentence(row) for row in _at(results.answer(OUTPUTS).frame, shown).to_dict("records")]
    drawn = [part for part in found if part.outcome == FOUND][:MOST_OUTPUTS]
    if drawn:
        text, samples = " ".join(map(sentence, drawn)), results.answer(SAMPLES)
        draw = partial(draw_indices, answer, drawn, shown)
        pictures.append(Picture("sensitivity", "What decides the outputs", text, draw))
        text = "Every dot is a sample; the line is the mean of the output along the key."
        draw = partial(draw_samples, samples, _at(samples.frame, shown), drawn, shown)
        pictures.append(Picture("sensitivity-samples", "The samples", text, draw))
    if len(refused := answer.frame[answer.frame["failed"] > 0]):
        notes.append(
            f"Where samples gave no number (up to {counted(int(refused['failed'].max()), 'sample')}) there is no "
            "index: leaving them out would bias it. Their scenes failed again in a second solution with a hundred "
            "times finer accuracy, or have no such number."
        )
    scene = whole.scene()
    return Report(
        **frame_of(results, shown, scene, len(scene[axis_keys(scene)].drop_duplicates())),
        answer=Section("", said, tables, pictures, notes),
        more=lambda: background(whole, shown, scene, ("records",)),
    )


def _at(frame: pd.DataFrame, shown: Evidence) -> pd.DataFrame:
    """The rows of the point that is shown; the samples are no point of it."""
    uncertain = shown.resolved.get("uncertain") or {}
    sampled = {key for entry in (uncertain if isinstance(uncertain, list | tuple) else [uncertain]) for key in entry}
    for key, value in shown.point.items():
        if key in frame and key not in sampled:
            frame = frame[frame[key] == value]
    return frame


@styled
def draw_indices(answer: Table, drawn: list[Part], shown: Evidence) -> Figure:
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
def draw_samples(samples: Table, frame: pd.DataFrame, drawn: list[Part], shown: Evidence) -> Figure:
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
            name_axis(ax, "x", [key], [samples.columns[key].unit], shown.resolved, 7, 28)
            ax.tick_params(labelsize=7)
        words = f"\n{part.words}" if part.words else ""
        line[0].set_ylabel(f"{part.output}{f' [{part.unit}]' if part.unit else ''}{words}", fontsize=7)
    entitle(figure, shown.title)
    caption(figure, f"Dots: samples. Line: mean of the output along the key. {motion_sentence(shown.records)}")
    return figure


def _scatter(ax: Axes, samples: Table, column: pd.Series, values: np.ndarray) -> None:
    if not pd.api.types.is_numeric_dtype(column):
        names = list(dict.fromkeys(column))
        x = column.map({name: n for n, name in enumerate(names)}).to_numpy(float)
        random = np.random.default_rng(1)
        ax.plot(x + random.uniform(-0.2, 0.2, x.size), values, ls="", marker=".", ms=2, color="0.6")
        means = [values[x == n].mean() for n in range(len(names))]
        ax.plot(range(len(names)), means, ls="", marker="_", ms=14, mew=2, color=_LOW)
        ax.set_xticks(range(len(names)), [name[:14] for name in names], rotation=35, ha="right")
        return
    x = column.to_numpy(float) / samples.columns[str(column.name)].unit.factor
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


@dataclass(frozen=True)
class Part:
    """One output at one point of the other swept keys, case and analysis.

    rows : of the table of indices, those that decide most first
    words : where it is, "" where there is one place
    """

    output: str
    words: str
    rows: pd.DataFrame

    @property
    def title(self) -> str:
        """The output, and where it is."""
        return f"{self.output}{f', {self.words}' if self.words else ''}"

    @property
    def outcome(self) -> str:
        return str(self.rows["outcome"].iloc[0])

    @property
    def unit(self) -> str:
        return str(self.rows["unit"].iloc[0])


def method_of(answer: Table) -> str:
    """sobol or morris."""
    return "sobol" if "total" in answer.frame else "morris"


def parts(results: Results, frame: pd.DataFrame) -> Iterator[Part]:
    """The outputs of a table of indices, one after the other, at every point of the other swept keys."""
    names = [*(key for key in results.axes if key in frame), "case", "analysis"]
    told = [name for name in names if name == "case" or len(set(frame[name])) > 1]
    by = "total" if "total" in frame else "mu_star"
    for _, rows in frame.groupby([*names, "output"], sort=False, dropna=False):
        first = rows.iloc[0]
        words = ", ".join(
            f"{name} = {results.units[name].text(first[name])}" if name in results.axes
            else f"{'case ' if name == 'case' else ''}{first[name]}"
            for name in told
        )  # fmt: skip
        yield Part(str(first["output"]), words, rows.sort_values(by, ascending=False, kind="stable"))


def _indices(results: Results, answer: Table, frame: pd.DataFrame) -> Table:
    """The indices of every output, those that decide most first, with the intervals in brackets."""
    rows = []
    for part in parts(results, frame):
        title = f"{part.output}{f' [{part.unit}]' if part.unit else ''}, {part.words}"
        for row in part.rows.to_dict("records") if part.outcome == FOUND else ():
            if method_of(answer) == "sobol":
                numbers = [interval(row, "first", ".2f"), interval(row, "total", ".2f")]
                numbers += [_error(row, "at_low"), _error(row, "at_high")]
            else:
                numbers = [interval(row, "mu_star"), _number(row["mu"]), _number(row["sigma"])]
            rows.append([title, str(row["key"]), *numbers])
    return from_rows("What decides the outputs", ("output", "key", *_HEADS[method_of(answer)]), rows)


def _probabilities(results: Results, frame: pd.DataFrame) -> Table:
    """How likely every statement holds, with its interval, and the key that decides it most."""
    rows = []
    for row in frame.to_dict("records"):
        point = [f"{key} = {results.value_label(key, row[key])}" for key in results.axes if key in row]
        where = ", ".join((*point, str(row["case"]), str(row["analysis"])))
        rows.append([str(row["statement"]), where, interval(row, "probability"), str(row["decided_by"]) or NOTHING])
    return from_rows("How likely statements hold", ("statement", "where", "probability", "decided most by"), rows)


def interval(row: dict[Any, Any], name: str, form: str = ".3g") -> str:
    """A number with its interval."""
    if row[name] != row[name]:
        return NOTHING
    found, low, high = (_number(row[f"{name}{end}"], form) for end in ("", "_low", "_high"))
    return f"{found} ({low} to {high})"


def _error(row: dict[Any, Any], name: str) -> str:
    if row[name] != row[name]:
        return NOTHING
    return with_error(row[name], row[f"{name}_error"])


def with_error(value: float, error: float) -> str:
    """A number with as many decimals as its standard error has at two digits: 26.8 ± 1.1."""
    if not (math.isfinite(error) and error > 0):
        return _number(value)
    decimals = 1 - math.floor(math.log10(error))
    if not 0 <= decimals <= 6:
        return f"{_number(value)} ± {_number(error, '.2g')}"
    return f"{value:.{decimals}f} ± {error:.{decimals}f}"


def _number(value: float, form: str = ".3g") -> str:
    text = f"{value:{form}}"
    return text.removeprefix("-") if float(text) == 0 else text


def sentence(part: Part) -> str:
    """What decides an output."""
    if part.outcome != FOUND:
        return f"{part.title}: {part.outcome}."
    first = part.rows.iloc[0]
    if "total" in part.rows:
        share = f"{100 * first['total']:.0f} % ({100 * first['total_low']:.0f} to {100 * first['total_high']:.0f} %)"
        return (
            f"{part.title}: decided most by {first['key']}; with its interactions it explains {share} of the variance."
        )
    change = f"{interval(dict(first), 'mu_star')} {part.unit}".rstrip()
    return f"{part.title}: changed most by {first['key']}, on the average by {change}."


def spread_sentence(row: dict[Any, Any]) -> str:
    """The distribution of an output."""
    low, _, high = PERCENTILES
    what = f"{row['output']}, case {row['case']}, {row['analysis']}"
    unit = f" {row['unit']}" if row["unit"] else ""
    if row["mean"] != row["mean"]:
        return f"{what}: no distribution, {counted(int(row['failed']), 'sample')} gave no number."
    between = f"{_number(row[f'percentile_{low}'])} to {_number(row[f'percentile_{high}'])}"
    return f"{what}: mean {interval(row, 'mean')}{unit}; {high - low} % of the samples from {between}{unit}."


def _legend(results: Results, answer: Table) -> list[str]:
    """What the columns of `cells` mean."""
    spec = results.resolved.get("sensitivity") or {}
    first = answer.frame.iloc[0]
    said = [
        f"In brackets: {100 * float(spec.get('confidence', 0.95)):.4g} % interval of {spec.get('draws', 1000)} "
        f"bootstrap draws of the {int(first['samples'])} samples."
    ]
    if method_of(answer) == "sobol":
        said.append(
            "First order: part of the variance that the key explains by itself; total: with all its interactions. At "
            "its ends: mean of the output over the lowest and the highest fifth of the key, of a choice at the "
            "options where it is least and most, with the standard error."
        )
    else:
        said.append(
            "Mean effect: mean size of the change of the output over the whole range of the key; a standard deviation "
            "as large as the mean indicates interactions or a nonlinear effect."
        )
    return said
