"""The report of `pound fragility`: curves alone and with pounding, with their bands and what the motions say."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.special import ndtr

from pounding_cli.fragility import Bands, Outcome, bands, resamples
from pounding_cli.numbers import Unit, counted
from pounding_cli.report.answer_page import AnswerPage, Illustration
from pounding_cli.report.citations import Use
from pounding_cli.report.evidence import Evidence, motion_sentence
from pounding_cli.report.fragility_text import (
    Asked,
    asked_of,
    intensity_unit,
    median_text,
    notes,
    subject,
    table,
    undecided_text,
)
from pounding_cli.report.style import Look, caption, entitle, looks, new_figure, shared_legend, styled
from pounding_cli.report.web.story import Grid
from pounding_cli.store import Results
from pounding_cli.store.answers import Answer
from pounding_cli.store.fragility import CURVES, MOTIONS
from pounding_cli.store.fragility_samples import ALONE, fits_of, motion_numbers
from pounding_cli.texts import cells

POINTS = "fragility_curves.csv"
"""File of the points of the curves, among the tables of a report."""

MOST_CASES = 4
"""Cases in one panel; of more, the first are drawn."""

_ALONE = Look("#777777", (0, (2, 1)), "x")
"""As no case looks: one may be black, as `touching` is."""
_WHERE = ("case", "analysis", "limit", "building")


def fragility_page(results: Results, shown: Evidence, with_figures: bool = True) -> AnswerPage:
    """What the report of fragility curves says, at one point of the sweep."""
    answer, asked = results.answer(CURVES), asked_of(results)
    rows = shown.here(answer.frame)
    figures = {}
    if with_figures:
        motions = shown.here(results.answer(MOTIONS).frame)
        for analysis in dict.fromkeys(rows["analysis"]):
            here = rows[rows["analysis"] == analysis]
            text = " ".join(_sentence(answer, row) for row in here.to_dict("records"))
            drawn = draw_curves(answer, asked, here, motions[motions["analysis"] == analysis], shown)
            figures[f"fragility-{analysis}"] = Illustration(drawn, f"Fragility, {analysis} storeys", text)
    heads, cells, words = table(answer, rows)
    grid = Grid([heading.replace("\n", " ").strip() for heading in heads], cells, range(words, len(heads)))
    lead = [_sentence(answer, row) for row in rows.to_dict("records")]
    tables = [("Intensity at which half of the motions pass", grid)]
    beside = partial(_write_points, answer, asked, results.answer(MOTIONS).frame)
    return AnswerPage("Fragility", lead, figures, tables, notes(asked, rows), beside)


def _write_points(answer: Answer, asked: Asked, motions: pd.DataFrame, folder: Path) -> list[Path]:
    """Write the points of every curve of the study, those of the figures; returns the file."""
    path = folder / "tables" / POINTS
    cells(curve_points(answer, asked, motions)).to_csv(path, index=False)
    return [path]


def curve_points(answer: Answer, asked: Asked, motions: pd.DataFrame) -> pd.DataFrame:
    """Points of every curve: intensities and swept keys in the units of the study, `curve` alone or with pounding, the
    probability of passing the limit [-] and its bootstrap interval. A limit without a curve has none.

    motions : the table of motions
    """
    frame, unit = answer.frame, intensity_unit(answer)
    where = [name for name in frame.columns[: frame.columns.get_loc("outcome")] if name != "case"]
    units = {name: answer.units.get(name, Unit()) for name in where}
    heads = [units[name].label(name) for name in where]
    columns = [*heads, "case", "curve", unit.label("intensity"), "probability", "probability_low", "probability_high"]
    parts: list[pd.DataFrame] = []
    place: Any
    for place, rows in frame.groupby(where, sort=False):
        mine = motions[(motions[where] == list(place)).all(axis=1)]
        values = [v if isinstance(v, str) else units[name].number(v) for name, v in zip(where, place, strict=True)]
        x = _grid(_right(rows, mine))
        times = resamples(motion_numbers(mine)[1], asked.draws)
        everything = rows.to_dict("records")
        # the building alone is the same in all cases
        for suffix, row in ((ALONE, everything[0]), *(("", row) for row in everything)):
            if row["median" + suffix] != row["median" + suffix]:
                continue
            likely, band = _curve(row, mine[mine["case"] == row["case"]], suffix, asked, x, times)
            part = pd.DataFrame([[*values, *(("", "alone") if suffix else (row["case"], "with pounding"))]] * len(x))
            part = part.assign(x=(x / unit.factor).round(10), likely=likely, low=band.low, high=band.high)
            parts.append(part.set_axis(columns, axis=1))
    return pd.concat(parts, ignore_index=True) if parts else pd.DataFrame(columns=columns)


def _curve(
    row: Mapping[Any, Any], motions: pd.DataFrame, suffix: str, asked: Asked, x: np.ndarray, times: np.ndarray
) -> tuple[np.ndarray, Bands]:
    """Probability of one curve at some intensities, and its bands."""
    likely = ndtr(np.log(x / row["median" + suffix]) / row["spread" + suffix])
    return likely, bands(fits_of(motions, suffix, asked.method, times), x, asked.confidence)


def _grid(right: float) -> np.ndarray:
    """The intensities at which curves are drawn, shape (200,)."""
    return np.linspace(0, right, 201)[1:]


def _sentence(answer: Answer, row: Mapping[Any, Any]) -> str:
    """One curve in words."""
    what = f"{subject(row['building'], row['limit'])}, {row['case']}, {row['analysis']}"
    with_pounding = median_text(answer, row, named=True)
    left = "".join(_undecided(row, suffix) for suffix in (ALONE, ""))
    if not row.get("outcome" + ALONE):
        return f"{what}, median: {with_pounding}.{left}"
    said = f"{what}, median: {median_text(answer, row, ALONE, named=True)} alone, {with_pounding} with pounding"
    if row["ratio"] != row["ratio"]:
        return f"{said}.{left}"
    low, high = row["ratio_low"], row["ratio_high"]
    if low <= 1 <= high:
        return f"{said}; a difference that may be chance in {counted(int(row['motions']), 'motion')}.{left}"
    motion = "a weaker motion is enough" if row["ratio"] < 1 else "it takes a stronger motion"
    return f"{said}; with pounding {motion}, by a factor of {row['ratio']:.3g} ({low:.3g} to {high:.3g}).{left}"


def _undecided(row: Mapping[Any, Any], suffix: str) -> str:
    """A sentence on the motions that a collapse leaves undecided; empty without any."""
    number = row.get("undecided_motions" + suffix, 0)
    if not number > 0:
        return ""
    where, left = "Alone" if suffix else "With pounding", undecided_text(row, suffix)
    so = ", so there is no curve" if row["outcome" + suffix] == Outcome.UNDECIDED else ""
    return f" {where}, a collapse ended the scenes of {left} motions before the limit was passed{so}."


@styled
def draw_curves(answer: Answer, asked: Asked, rows: pd.DataFrame, motions: pd.DataFrame, shown: Evidence) -> Figure:
    """Probability against intensity: a line of panels for each limit, a panel for each building or pair."""
    unit = intensity_unit(answer)
    limits = list(dict.fromkeys(rows["limit"]))
    columns = {limit: list(dict.fromkeys(rows[rows["limit"] == limit]["building"])) for limit in limits}
    wide = max(len(each) for each in columns.values())
    cases = list(dict.fromkeys(rows["case"]))
    drawn = {case: look for case, look in looks(cases).items() if case in cases[:MOST_CASES]}
    figure = new_figure(3.6 * wide + 1.9, 2.8 * len(limits) + 0.8)
    axes = figure.subplots(len(limits), wide, squeeze=False, sharey=True)
    for line, limit in zip(axes, limits, strict=True):
        same = rows["case"].isin(drawn) & (rows["limit"] == limit)
        right = _right(rows[same], motions[motions["case"].isin(drawn) & (motions["limit"] == limit)])
        for ax in line[len(columns[limit]) :]:
            ax.set_visible(False)
        for ax, building in zip(line, columns[limit], strict=False):
            here = rows[(rows["limit"] == limit) & (rows["building"] == building)]
            mine = motions[(motions["limit"] == limit) & (motions["building"] == building)]
            _panel(ax, answer, asked, here, mine, drawn, right)
            ax.set_title(subject(building, limit), loc="left")
            ax.set_ylim(0, 1)
            ax.set_xlim(0, right / unit.factor)
            ax.set_xlabel(f"{asked.measure} [{unit.name}]" if unit.name else asked.measure)
        line[0].set_ylabel("probability of passing the limit")
    shared_legend(figure, axes.flat)
    entitle(figure, shown.title)
    kept = {key: value for key, value in shown.point.items() if key in rows}
    where = ", ".join(f"{key} = {shown.units[key].text(value)}" for key, value in kept.items())
    left_out = f" Of {len(cases)} cases the first {MOST_CASES} are drawn." if len(cases) > MOST_CASES else ""
    caption(
        figure,
        f"{f'At {where}. ' if where else ''}{_dots(asked.method)} Bands: {100 * asked.confidence:.4g} % of "
        f"{asked.draws} bootstrap draws of the motions.{left_out} {motion_sentence(shown.records)}",
    )
    return figure


def _dots(method: str) -> str:
    return {
        "ida": "Markers: the share of motions that have passed by that intensity, by Kaplan and Meier where some are "
        "undecided.",
        "stripes": "Markers: the share of the decided motions that pass at each intensity.",
    }.get(method, "Curves from a line through the cloud of demands.")


def _panel(
    ax: Axes,
    answer: Answer,
    asked: Asked,
    rows: pd.DataFrame,
    motions: pd.DataFrame,
    cases: Mapping[str, Look],
    right: float,
) -> None:
    """The curves of one limit and building, up to the intensity `right`."""
    factor = intensity_unit(answer).factor
    everything = rows.to_dict("records")
    curves = [("alone", everything[0], motions[motions["case"] == everything[0]["case"]], ALONE, _ALONE)]
    for row in everything:
        if (case := str(row["case"])) in cases:
            curves.append((case, row, motions[motions["case"] == case], "", cases[case]))
    curves = [each for each in curves if each[1].get("outcome" + each[3])]
    x = _grid(right)
    times = resamples(motion_numbers(curves[0][2])[1], asked.draws)
    up = 0.04
    for name, row, mine, suffix, look in curves:
        label = name if suffix else f"with pounding: {name}"
        if row["median" + suffix] == row["median" + suffix]:
            likely, band = _curve(row, mine, suffix, asked, x, times)
            ax.fill_between(x / factor, band.low, band.high, color=look.color, alpha=0.13, lw=0)
            ax.plot(x / factor, likely, color=look.color, ls=look.line, lw=1.8, label=label)
        else:
            ax.plot([], [], color=look.color, ls=look.line, lw=1.8, label=label)
            said = textwrap.wrap(f"{name}: {median_text(answer, row, suffix)}", 50)
            ax.text(0.98, up, "\n".join(said), transform=ax.transAxes, ha="right", fontsize=7.5, color=look.color)
            up += 0.08 * len(said)
        at, share = _points(mine, suffix, asked.method)
        at, share = at[at <= right], share[at <= right]
        if at.size:  # a line without points would count as one at the corner of the figure
            ax.plot(at / factor, share, ls="", marker=look.marker, ms=3.2, color=look.color, alpha=0.75, clip_on=False)


def _right(rows: pd.DataFrame, motions: pd.DataFrame) -> float:
    """Where an axis of intensities ends: beyond nearly all of every curve, but not far beyond where motions pass; where
    there is no curve, beyond what was solved.

    rows, motions : of the curves
    """
    both = [suffix for suffix in ("", ALONE) if "outcome" + suffix in rows]
    names = ["intensity"] if "intensity" in motions else [name + end for name in ("held", "passed") for end in both]
    seen = motions[names].to_numpy(dtype=float).ravel()
    seen = seen[np.isfinite(seen) & (seen > 0)]
    top, ends = float(seen.max(initial=0.0)), []
    for suffix in both:
        median, spread = rows["median" + suffix].to_numpy(float), rows["spread" + suffix].to_numpy(float)
        median, spread = median[np.isfinite(median)], spread[np.isfinite(median)]
        ends += np.minimum(median * np.exp(1.8 * spread), np.maximum(2 * top, 1.2 * median)).tolist()
    return 1.1 * max(ends, default=top) or 1.0


def _points(rows: pd.DataFrame, suffix: str, method: str) -> tuple[np.ndarray, np.ndarray]:
    """What the motions say: the share that has passed by an intensity (`ida`) or passes at it (`stripes`)."""
    if method == "ida":
        held, passed = rows["held" + suffix].to_numpy(float), rows["passed" + suffix].to_numpy(float)
        last = np.where(np.isfinite(passed), passed, held)  # the highest intensity at which a motion says something
        at, passes = np.unique(passed[np.isfinite(passed)], return_counts=True)
        # Kaplan, E. L. and Meier, P. (1958). Nonparametric estimation from incomplete observations. JASA 53, 457-481
        left = np.array([(last >= x).sum() for x in at])
        return at, 1 - np.cumprod(1 - passes / left)
    if method == "stripes":
        done = rows[rows["demand" + suffix].notna()]
        shares = (done["demand" + suffix] > 1).groupby(done["intensity"]).agg(["mean", "size"])
        shares = shares[shares["size"] > 1]  # intensities of single motions are no stripes
        return shares.index.to_numpy(float), shares["mean"].to_numpy(float)
    return np.zeros(0), np.zeros(0)


def cite_fragility(resolved: Mapping[str, Any], used: Use) -> None:
    """The references of the way a study was asked for fragility curves."""
    method = (resolved.get("fragility") or {}).get("method", "ida")
    if method == "ida":
        used("vamvatsikos2004", "hunting for the intensity at which a motion passes a limit")
    if method == "cloud":
        used("jalayer2015", "the line through a cloud of demands")
    else:
        used("baker2015", "fragility curves of maximum likelihood")
    used("efron1993", "the bootstrap of the motions")
