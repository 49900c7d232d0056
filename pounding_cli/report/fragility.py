"""The report of `pound fragility`: curves alone and with pounding, with their bands and what the motions say."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.special import ndtr

from pounding_cli.fragility import bands, resamples
from pounding_cli.numbers import counted
from pounding_cli.report.answer_page import AnswerPage, Illustration
from pounding_cli.report.citations import Use
from pounding_cli.report.evidence import Evidence, motion_sentence
from pounding_cli.report.fragility_text import Asked, asked_of, intensity_unit, median_text, notes, subject, table
from pounding_cli.report.style import Look, caption, entitle, looks, new_figure, shared_legend, styled
from pounding_cli.report.web.story import Grid
from pounding_cli.store import Results
from pounding_cli.store.answers import Answer
from pounding_cli.store.fragility import CURVES, MOTIONS
from pounding_cli.store.fragility_samples import ALONE, fits_of, motion_numbers

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
    return AnswerPage(
        "Fragility", lead, figures, [("Intensity at which half of the motions pass", grid)], notes(asked, rows)
    )


def _sentence(answer: Answer, row: Mapping[Any, Any]) -> str:
    """One curve in words."""
    what = f"{subject(row['building'], row['limit'])}, {row['case']}, {row['analysis']}"
    with_pounding = median_text(answer, row, named=True)
    if not row.get("outcome" + ALONE):
        return f"{what}, median: {with_pounding}."
    said = f"{what}, median: {median_text(answer, row, ALONE, named=True)} alone, {with_pounding} with pounding"
    if row["ratio"] != row["ratio"]:
        return f"{said}."
    low, high = row["ratio_low"], row["ratio_high"]
    if low <= 1 <= high:
        return f"{said}; a difference that may be chance in {counted(int(row['motions']), 'motion')}."
    motion = "a weaker motion is enough" if row["ratio"] < 1 else "it takes a stronger motion"
    return f"{said}; with pounding {motion}, by a factor of {row['ratio']:.3g} ({low:.3g} to {high:.3g})."


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
        for ax in line[len(columns[limit]) :]:
            ax.set_visible(False)
        for ax, building in zip(line, columns[limit], strict=False):
            here = rows[(rows["limit"] == limit) & (rows["building"] == building)]
            mine = motions[(motions["limit"] == limit) & (motions["building"] == building)]
            _panel(ax, answer, asked, here, mine, drawn)
            ax.set_title(subject(building, limit), loc="left")
            ax.set_ylim(0, 1)
            ax.set_xlabel(f"{asked.measure} [{unit.name}]" if unit.name else asked.measure)
        for ax in line:
            ax.set_xlim(0, max(each.get_xlim()[1] for each in line[: len(columns[limit])]))
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
        "ida": "Markers: the share of motions that have passed by that intensity.",
        "stripes": "Markers: the share of motions that pass at each intensity.",
    }.get(method, "Curves from a line through the cloud of demands.")


def _panel(
    ax: Axes, answer: Answer, asked: Asked, rows: pd.DataFrame, motions: pd.DataFrame, cases: Mapping[str, Look]
) -> None:
    """The curves of one limit and building."""
    factor = intensity_unit(answer).factor
    everything = rows.to_dict("records")
    curves = [("alone", everything[0], motions[motions["case"] == everything[0]["case"]], ALONE, _ALONE)]
    for row in everything:
        if (case := str(row["case"])) in cases:
            curves.append((case, row, motions[motions["case"] == case], "", cases[case]))
    curves = [each for each in curves if each[1].get("outcome" + each[3])]
    x = np.linspace(0, _right(curves), 200)[1:]
    times = resamples(motion_numbers(curves[0][2])[1], asked.draws)
    for label, row, mine, suffix, look in curves:
        median, spread = row["median" + suffix], row["spread" + suffix] if f"spread{suffix}" in row else np.nan
        label = "alone" if suffix else f"with pounding: {label}"
        if median == median:
            band = bands(fits_of(mine, suffix, asked.method, times), x, asked.confidence)
            ax.fill_between(x / factor, band.low, band.high, color=look.color, alpha=0.13, lw=0)
            ax.plot(x / factor, ndtr(np.log(x / median) / spread), color=look.color, ls=look.line, lw=1.8, label=label)
        else:
            ax.plot([], [], color=look.color, ls=look.line, lw=1.8, label=label)
            said = f"{label}: {median_text(answer, row, suffix)}"
            up = 0.04 + 0.08 * len(ax.texts)  # one line a curve
            ax.text(0.98, up, said, transform=ax.transAxes, ha="right", fontsize=7.5, color=look.color)
        at, share = _points(mine, suffix, asked.method)
        ax.plot(at / factor, share, ls="", marker=look.marker, ms=3.2, color=look.color, alpha=0.75, clip_on=False)


def _right(curves: list[tuple[str, Any, pd.DataFrame, str, Look]]) -> float:
    """Where the panel ends: beyond nearly all of every curve, and of what was looked at where there is none."""
    ends = []
    for _, row, mine, suffix, _ in curves:
        if row["median" + suffix] == row["median" + suffix]:
            ends.append(float(row["median" + suffix] * np.exp(1.8 * row["spread" + suffix])))
        name = "intensity" if "intensity" in mine else "passed" + suffix
        seen = mine[name].to_numpy(dtype=float)
        if np.isfinite(seen).any():
            ends.append(float(np.quantile(seen[np.isfinite(seen)], 0.9)))
    return 1.1 * max(ends, default=1.0)


def _points(rows: pd.DataFrame, suffix: str, method: str) -> tuple[np.ndarray, np.ndarray]:
    """What the motions say: the share that has passed by an intensity (`ida`) or passes at it (`stripes`)."""
    if method == "ida":
        held, passed = rows["held" + suffix].to_numpy(float), rows["passed" + suffix].to_numpy(float)
        passed = passed[(held > 0) | (passed < np.inf)]  # of the motions that say anything
        at = np.unique(passed[np.isfinite(passed)])
        return at, np.searchsorted(np.sort(passed), at, side="right") / max(1, len(passed))
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
