"""The report of `pound fragility`: curves alone and with pounding, with their bands and what the motions say."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pounding_cli.numbers import Unit, counted
from pounding_cli.report.background import background, frame_of
from pounding_cli.report.document import Picture, Report, Section
from pounding_cli.report.evidence import Evidence, motion_sentence, nominal
from pounding_cli.report.rates import rate_table, told_place
from pounding_cli.report.references import Use
from pounding_cli.report.style import Look, caption, entitle, looks, panels, shared_legend, styled
from pounding_cli.report.table import NOTHING, digits, from_rows, interval
from pounding_cli.results.tables import Table
from pounding_cli.workflows.curves import FEWEST_TOLD, Outcome
from pounding_cli.workflows.fragility import ALONE, CURVES, LINKED, MOTIONS, POINTS
from pounding_cli.workflows.hazard import INTENSITY_KEYS

if TYPE_CHECKING:
    from pounding_cli.results.results import Results

TABLES = ("storey", "floor", "link", "scene", "summary", "records", "buildings")
"""The tables of scenes that the report has."""
MOST_CASES = 4
"""Cases in one panel; of more, the first are drawn."""

_ALONE = Look("#777777", (0, (2, 1)), "x")
"""As no case looks: one may be black, as `touching` is."""
_BOTH = {ALONE: "alone", LINKED: "with pounding"}
_MEASURES = {
    "pga": "peak ground acceleration", "pgv": "peak ground velocity", "sa": "pseudo-acceleration",
    "factor": "scale factor",
}  # fmt: skip


@dataclass(frozen=True)
class Asked:
    """How the curves were asked for: the section of the study, the intensity measure in words and its unit."""

    spec: Mapping[str, Any]
    measure: str
    unit: Unit


def asked_of(results: Results) -> Asked:
    """How the curves of a results file were asked for."""
    spec = results.resolved["fragility"]
    swept = next((name for key, name in INTENSITY_KEYS.items() if key in results.units), "pga")
    measure, scale = str(spec.get("intensity") or swept), results.resolved["records"]["scale"]
    if measure == "sa" and isinstance(scale, dict) and "period" in scale:
        measure = f"sa({scale['period']:g} s)"
    name, _, period = measure.partition("(")
    words = _MEASURES.get(name, name) + (f" at {period.removesuffix(')')}" if period else "")
    return Asked(spec, words, results.answer(CURVES).columns["median"].unit)


def fragility_report(results: Results) -> Report:
    """What the fragility curves say."""
    answer, asked, shown = results.answer(CURVES).frame, asked_of(results), nominal(results)
    rows, motions, points = (shown.here(results.answer(name).frame) for name in (CURVES, MOTIONS, POINTS))
    pictures = []
    for analysis, here in rows.groupby("analysis", sort=False):
        text = " ".join(_sentence(asked, row) for row in here.to_dict("records"))
        draw = partial(draw_curves, asked, here, motions, points, shown)
        pictures.append(Picture(f"fragility-{analysis}", f"Fragility, {analysis} storeys", text, draw))
    rates, of_rates, notes = rate_table(results, shown)
    said = [f"Intensity: {asked.measure}.", *(_sentence(asked, row) for row in rows.to_dict("records"))]
    tables = [_medians(results, asked, answer), *rates]
    return Report(
        **frame_of(results, shown, results.scene()),
        answer=Section("", said, tables, pictures + of_rates, _notes(asked, answer) + notes),
        more=partial(background, results, shown, results.scene(), TABLES),
    )


# The curves


@styled
def draw_curves(
    asked: Asked, rows: pd.DataFrame, motions: pd.DataFrame, points: pd.DataFrame, shown: Evidence
) -> Figure:
    """Probability against intensity: a line of panels for each limit, a panel for each building or pair.

    rows, motions, points : of the tables at the point shown; rows of one analysis
    """
    limits = {limit: here["building"].unique() for limit, here in rows.groupby("limit", sort=False)}
    cases = rows["case"].unique().tolist()
    look = {case: each for case, each in looks(cases).items() if case in cases[:MOST_CASES]}
    figure, axes = panels(len(limits), max(map(len, limits.values())), 3.6, 2.8, sharey=True)
    for line, (limit, buildings) in zip(axes, limits.items(), strict=True):
        for ax in line[len(buildings) :]:
            ax.set_visible(False)
        for ax, building in zip(line, buildings, strict=False):
            here = rows[(rows["limit"] == limit) & (rows["building"] == building) & rows["case"].isin(look)]
            _panel(ax, asked, here, motions, points, look)
            ax.set(ylim=(0, 1), xlabel=asked.unit.label(asked.measure))
            ax.set_title(subject(building, str(limit)), loc="left")
        line[0].set_ylabel("probability of passing the limit")
    shared_legend(figure, axes.flat)
    entitle(figure, shown.title)
    swept = [f"{key} = {shown.results.value_label(key, value)}" for key, value in shown.point.items() if key in rows]
    where = f"At {', '.join(swept)}. " if swept else ""
    left_out = f" Of {len(cases)} cases the first {MOST_CASES} are drawn." if len(cases) > MOST_CASES else ""
    dots = {
        "ida": "Markers: the share of motions that have passed by that intensity, by Kaplan and Meier where some are "
        "undecided.",
        "stripes": "Markers: the share of the decided motions that pass at each intensity.",
    }.get(asked.spec["method"], "Curves from a line through the cloud of demands.")
    bands = f"Bands: {100 * asked.spec['confidence']:.4g} % of {asked.spec['draws']} bootstrap draws of the motions."
    if rows["motions"].max() < FEWEST_TOLD:
        bands = f"No bands for fewer than {FEWEST_TOLD} motions."
    caption(figure, f"{where}{dots} {bands}{left_out} {motion_sentence(shown.records)}")
    return figure


def _panel(
    ax: Axes, asked: Asked, rows: pd.DataFrame, motions: pd.DataFrame, points: pd.DataFrame, cases: Mapping[str, Look]
) -> None:
    """The curves of one limit and building: the building alone, which is the same in all cases, and every case."""
    factor, up, right, where = asked.unit.factor, 0.04, 0.0, ["case", "analysis", "limit", "building"]
    everything = rows.to_dict("records")
    for end, row in ((ALONE, everything[0]), *((LINKED, row) for row in everything)):
        if not row[f"outcome{end}"]:
            continue
        mine, curve = (each[(each[where] == [row[name] for name in where]).all(axis=1)] for each in (motions, points))
        look, label = (_ALONE, "alone") if end else (cases[row["case"]], f"with pounding: {row['case']}")
        (line,) = ax.plot([], [], color=look.color, ls=look.line, lw=1.8, label=label)
        x = curve["intensity"] / factor
        if row[f"median{end}"] == row[f"median{end}"]:
            line.set_data(x, curve[f"probability{end}"])
            low, high = curve[f"probability_low{end}"], curve[f"probability_high{end}"]
            ax.fill_between(x, low, high, color=look.color, alpha=0.13, lw=0)
        else:
            said = textwrap.wrap(f"{label}: {median_text(asked, row, end)}", 50)
            ax.text(0.98, up, "\n".join(said), transform=ax.transAxes, ha="right", fontsize=7.5, color=look.color)
            up += 0.08 * len(said)
        at, share = _shares(mine, end, asked.spec["method"])
        seen = mine[["intensity"] if "intensity" in mine else [f"held{end}", f"passed{end}"]].to_numpy(float)
        right = max(right, x.max() if len(x) else 1.1 * seen[np.isfinite(seen)].max(initial=0.0) / factor)
        if (is_in := at / factor <= right).any():  # a line without points would count as one at the corner
            dots: dict[str, Any] = {"ls": "", "marker": look.marker, "ms": 3.2, "color": look.color, "alpha": 0.75}
            ax.plot(at[is_in] / factor, share[is_in], clip_on=False, **dots)
    ax.set_xlim(0, right or 1.0)


def _shares(rows: pd.DataFrame, end: str, method: str) -> tuple[np.ndarray, np.ndarray]:
    """What the motions say: the share that has passed by an intensity (`ida`) or passes at it (`stripes`)."""
    if method == "ida":
        held, passed = rows[f"held{end}"].to_numpy(float), rows[f"passed{end}"].to_numpy(float)
        last = np.where(np.isfinite(passed), passed, held)  # the highest intensity at which a motion says something
        at, passes = np.unique(passed[np.isfinite(passed)], return_counts=True)
        # Kaplan, E. L. and Meier, P. (1958). Nonparametric estimation from incomplete observations. JASA 53, 457-481
        left = np.array([(last >= x).sum() for x in at])
        return at, 1 - np.cumprod(1 - passes / left)
    if method == "stripes":
        done = rows[rows[f"demand{end}"].notna()]
        shares = (done[f"demand{end}"] > 1).groupby(done["intensity"]).agg(["mean", "size"])
        shares = shares[shares["size"] > 1]  # intensities of single motions are no stripes
        return shares.index.to_numpy(float), shares["mean"].to_numpy(float)
    return np.zeros(0), np.zeros(0)


# In words


def _medians(results: Results, asked: Asked, frame: pd.DataFrame) -> Table:
    """Medians, spreads and their ratios with their intervals in brackets, a row a curve and point of the sweep.

    A case or an analysis that is the same in all rows is left out.
    """
    rows = []
    for row in frame.to_dict("records"):
        cells = {name: row[name] for name in ("limit", "building")}
        cells |= told_place(results, frame, row, ("case", "analysis"))
        for end, what in _BOTH.items():
            cells[asked.unit.label(f"median {what}")] = median_text(asked, row, end)
            cells[f"spread {what}"] = interval(row, "spread", end)
        rows.append(cells | {"ratio of medians": interval(row, "ratio")})
    heads = list(rows[0]) if rows else []
    return from_rows("Intensity at which half of the motions pass", heads, [list(row.values()) for row in rows])


def _sentence(asked: Asked, row: Mapping[Any, Any]) -> str:
    """One curve in words."""
    medians = [
        f"{median_text(asked, row, end, asked.unit.name)} {words}"
        for end, words in _BOTH.items()
        if row[f"outcome{end}"]
    ]
    said = f"{subject(row['building'], row['limit'])}, {row['case']}, {row['analysis']}, median: {', '.join(medians)}"
    is_told = row["ratio_low"] == row["ratio_low"]
    if row["ratio"] == row["ratio"] and (not is_told or row["ratio_low"] <= 1 <= row["ratio_high"]):
        said += f"; a difference that may be chance in {counted(int(row['motions']), 'motion')}"
    elif row["ratio"] == row["ratio"]:
        motion = "a weaker motion is enough" if row["ratio"] < 1 else "it takes a stronger motion"
        said += f"; with pounding {motion}, by a factor of {interval(row, 'ratio')}"
    return f"{said}."


def subject(building: str, limit: str) -> str:
    """The limit and the building that it is asked of; a limit may name the building itself."""
    return limit if f" in {building} " in f"{limit} " else f"{building}, {limit}"


def median_text(asked: Asked, row: Mapping[Any, Any], end: str = "", unit: str = "") -> str:
    """A median with its interval; where there is none, outcome of the fit and what is known."""
    outcome, low, high = str(row[f"outcome{end}"]), row[f"low{end}"], row[f"high{end}"]
    if not outcome:
        return NOTHING
    if row[f"median{end}"] == row[f"median{end}"]:
        return interval(row, "median", end, asked.unit.factor, unit)
    if outcome == Outcome.UNDECIDED:
        outcome += f" in {int(row[f'undecided_motions{end}'])} of {int(row[f'motions{end}'])} motions"
    ends = [digits(each / asked.unit.factor, 3) for each in (low, high)]
    known = " to ".join(ends) if low > 0 and high < np.inf else f"above {ends[0]}" if low > 0 else f"below {ends[1]}"
    return f"{outcome}: {known} {unit}".rstrip() if low > 0 or high < np.inf else outcome


def _notes(asked: Asked, rows: pd.DataFrame) -> list[str]:
    """What a reader should know of the rows."""
    spec, few = asked.spec, int(rows["motions"].min(skipna=True))
    said = [
        f"In brackets: {100 * spec['confidence']:.4g} % interval of {spec['draws']} bootstrap draws of the motions, "
        "the same draws alone and with pounding."
    ]
    if few < FEWEST_TOLD:
        said = [f"No interval for fewer than {FEWEST_TOLD} motions: {counted(few, 'motion')} cannot tell it."]

    def count(name: str) -> int:
        return sum(int(rows[f"{name}{end}"].fillna(0).sum()) for end in _BOTH)

    for name, what in (("failed", "failed"), ("undecided", "ended with a collapse before the limit was passed")):
        if number := count(name):
            said.append(
                f"{counted(number, 'scene')} {what} (a scene that several rows need counts in each): counted neither "
                "as holding nor as passing."
            )
    if number := count("undecided_motions"):
        said.append(
            f"{counted(number, 'motion is', 'motions are')} undecided: a collapse ended the scenes before the limit "
            "was passed. A fit takes them to be like the others; from half of the motions on there is no curve."
        )
    return said


def cite_fragility(resolved: Mapping[str, Any], used: Use) -> None:
    """The references of the way a study was asked for fragility curves."""
    spec = resolved.get("fragility") or {}
    if spec.get("method", "ida") == "ida":
        used("vamvatsikos2004", "hunting for the intensity at which a motion passes a limit")
    if spec.get("method") == "cloud":
        used("jalayer2015", "the line through a cloud of demands")
    else:
        used("baker2015", "fragility curves of maximum likelihood")
    used("efron1993", "the bootstrap of the motions")
    if spec.get("hazard"):
        used("cornell2002", "annual rates from a fragility curve and a hazard curve")
