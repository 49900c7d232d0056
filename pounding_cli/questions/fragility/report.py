"""The report of `pound fragility`: curves alone and with pounding, what the motions say, and annual rates."""

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
from pounding_cli.questions.bootstrap import FEWEST_TOLD
from pounding_cli.questions.fragility.curves import Outcome
from pounding_cli.questions.fragility.limits import ALONE, CONTRIBUTIONS, CURVES, LINKED, MOTIONS, POINTS, RATES
from pounding_cli.questions.hazard import INTENSITY_KEYS, YEARS
from pounding_cli.report.background import report_of
from pounding_cli.report.document import Picture, Report, Section
from pounding_cli.report.evidence import Evidence, describe_motions, find_nominal
from pounding_cli.report.style import Look, finish, grid, looks, shared_legend, styled
from pounding_cli.report.table import NOTHING, digits, from_answer, interval
from pounding_cli.results.tables import Table

if TYPE_CHECKING:
    from pounding_cli.results.results import ResultTables

MOST_CASES = 4
"""Cases in one panel; of more, the first are drawn."""
MUCH_BEYOND = 0.1
"""Part of a rate from beyond the last intensity of the hazard curve that is told [-]."""

_ALONE = Look("#777777", (0, (2, 1)), "x")
"""As no case looks: one may be black, as `touching` is."""
_BOTH = {ALONE: "alone", LINKED: "with pounding"}
_PLACE = ("limit", "building"), ("case", "analysis")
"""Columns that say where a row stands; the second two where they differ."""
_MEASURES = {
    "pga": "peak ground acceleration", "pgv": "peak ground velocity", "sa": "pseudo-acceleration",
    "factor": "scale factor",
}  # fmt: skip

Row = Mapping[Any, Any]


def fragility_report(results: ResultTables) -> Report:
    """What the fragility curves say."""
    answer, shown, spec = results.answer(CURVES), find_nominal(results), results.resolved["fragility"]
    unit, measure, frame = answer.columns["median"].unit, _measure(results), answer.frame
    rows, motions, points = (shown.rows_here(results.answer(name).frame) for name in (CURVES, MOTIONS, POINTS))
    said = {place: _sentence(row, unit) for place, row in zip(rows.index, rows.to_dict("records"), strict=True)}
    tables, pictures, notes = [_medians(results, frame, unit)], list[Picture](), list(_notes(results, spec, frame))
    for analysis, here in rows.groupby("analysis", sort=False):
        draw = partial(draw_curves, spec, unit.label(measure), unit, here, motions, points, shown)
        text = " ".join(said[place] for place in here.index)
        pictures.append(Picture(f"fragility-{analysis}", f"Fragility, {analysis} storeys", text, draw))
    if RATES in results.answers:
        rates = results.answer(RATES).frame
        tables.append(_rates(results, rates))
        if (beyond := rates[["beyond", f"beyond{ALONE}"]].max().max()) > MUCH_BEYOND:
            notes.append(
                f"Up to {beyond:.0%} of a rate comes from intensities above the last one of the hazard curve, where "
                "its last line goes on: give the curve further."
            )
        text = "Annual rates at which limits are passed, by the intensity at which they are."
        if len(parts := shown.rows_here(results.answer(CONTRIBUTIONS).frame)):  # no limit may have a curve
            draw = partial(draw_contributions, parts, unit, shown)
            pictures.append(Picture("fragility-rates", "What contributes to the annual rates", text, draw))
    return report_of(results, shown, Section("", [f"Intensity: {measure}.", *said.values()], tables, pictures, notes))


def _measure(results: ResultTables) -> str:
    """The intensity measure in words."""
    spec, scale = results.resolved["fragility"], results.resolved["records"]["scale"]
    swept = next((name for key, name in INTENSITY_KEYS.items() if key in results.units), "pga")
    measure = str(spec.get("intensity") or swept)
    if measure == "sa" and isinstance(scale, dict) and "period" in scale:
        measure = f"sa({scale['period']:g} s)"
    name, _, period = measure.partition("(")
    return _MEASURES.get(name, name) + (f" at {period.removesuffix(')')}" if period else "")


# In words


def _medians(results: ResultTables, frame: pd.DataFrame, unit: Unit) -> Table:
    """Medians, their ratios and spreads with their intervals in brackets, a row a curve and point of the sweep."""

    def told(row: Row) -> dict[str, str]:
        medians = {unit.label(f"median {what}"): median_text(row, end, unit) for end, what in _BOTH.items()}
        spreads = {f"spread {what}": interval(row, "spread", end) for end, what in _BOTH.items()}
        return medians | {"ratio of medians": interval(row, "ratio")} | spreads

    return from_answer(results, "Intensity at which half of the motions pass", frame, *_PLACE, told)


def _rates(results: ResultTables, frame: pd.DataFrame) -> Table:
    """Annual rates of the limits with their intervals, a row as in `_medians`."""

    def told(row: Row) -> dict[str, str]:
        cells = {}
        for end, what in _BOTH.items():
            cells[f"rate {what} [1/year]"] = interval(row, "rate", end)
            share = row[f"probability{end}"]
            cells[f"in {YEARS:g} years {what}"] = NOTHING if np.isnan(share) else f"{digits(100 * share, 3)} %"
        return cells | {"ratio of rates": interval(row, "rate_ratio")}

    return from_answer(results, "Annual rates of the limits", frame, *_PLACE, told)


def _sentence(row: Row, unit: Unit) -> str:
    """One curve in words."""
    medians = [
        f"{median_text(row, end, unit, unit.name)} {words}" for end, words in _BOTH.items() if row[f"outcome{end}"]
    ]
    said = f"{subject(row['building'], row['limit'])}, {row['case']}, {row['analysis']}, median: {', '.join(medians)}"
    if np.isnan(row["ratio"]):
        return f"{said}."
    if all(digits(row[name], 3) in ("1.00", NOTHING) for name in ("ratio", "ratio_low", "ratio_high")):
        return f"{said}; pounding makes no difference in three digits."
    if not (row["ratio_low"] > 1 or row["ratio_high"] < 1):
        return f"{said}; a difference that may be chance in {pluralize(int(row['motions']), 'motion')}."
    motion = "a weaker motion is enough" if row["ratio"] < 1 else "it takes a stronger motion"
    return f"{said}; with pounding {motion}, by a factor of {interval(row, 'ratio')}."


def subject(building: str, limit: str) -> str:
    """The limit and the building that it is asked of; a limit may name the building itself."""
    return limit if f" in {building} " in f"{limit} " else f"{building}, {limit}"


def median_text(row: Row, end: str, unit: Unit, named: str = "") -> str:
    """A median with its interval; where there is none, outcome of the fit and what is known."""
    outcome, low, high = str(row[f"outcome{end}"]), row[f"low{end}"], row[f"high{end}"]
    if not outcome or not np.isnan(row[f"median{end}"]):
        return interval(row, "median", end, unit.factor, named)
    if outcome == Outcome.UNDECIDED:
        outcome += f" in {int(row[f'undecided_motions{end}'])} of {int(row[f'motions{end}'])} motions"
    ends = [digits(each / unit.factor, 3) for each in (low, high)]
    known = " to ".join(ends) if low > 0 and high < np.inf else f"above {ends[0]}" if low > 0 else f"below {ends[1]}"
    return f"{outcome}: {known} {named}".rstrip() if low > 0 or high < np.inf else outcome


def _notes(results: ResultTables, spec: Mapping[str, Any], rows: pd.DataFrame) -> Iterator[str]:
    """What a reader should know of the rows."""
    if (few := int(rows["motions"].min(skipna=True))) < FEWEST_TOLD:
        yield f"No interval for fewer than {FEWEST_TOLD} motions: {pluralize(few, 'motion')} cannot tell it."
    if rows["motions"].max(skipna=True) >= FEWEST_TOLD:
        share = f"{100 * spec['confidence']:.4g} %"
        yield f"In brackets: {share} interval of {spec['draws']} bootstrap draws of the motions, the same for both."
    if failed := int(results.attrs["scenes_failed"]):
        yield f"{pluralize(failed, 'scene')} failed: counted neither as holding nor as passing."
    names = ("undecided", "undecided_motions")
    count = {name: int(rows[[name, f"{name}{ALONE}"]].sum().sum()) for name in names}
    if count["undecided"]:
        yield (
            f"{pluralize(count['undecided'], 'scene')} ended with a collapse before the limit was passed (a scene that "
            "several rows need counts in each): counted neither as holding nor as passing."
        )
    if number := count["undecided_motions"]:
        yield (
            f"{pluralize(number, 'motion is', 'motions are')} undecided: a collapse ended the scenes before the limit "
            "was passed. A fit takes them to be like the others; from half of the motions on there is no curve."
        )


# Figures


@styled
def draw_curves(
    spec: Mapping[str, Any], across: str, unit: Unit, rows: pd.DataFrame, motions: pd.DataFrame, points: pd.DataFrame,
    shown: Evidence,
) -> Figure:  # fmt: skip
    """Probability against intensity: a panel for each limit and building or pair.

    rows, motions, points : of the tables at the point shown; rows of one analysis
    """
    groups, cases = rows.groupby(["limit", "building"], sort=False), rows["case"].unique().tolist()
    look = {case: each for case, each in looks(cases).items() if case in cases[:MOST_CASES]}
    figure, axes = grid(len(groups), 3.6, 2.8, "probability of passing the limit", sharey=True)
    for ax, ((limit, building), here) in zip(axes, groups, strict=True):
        _panel(ax, spec["method"], unit, here[here["case"].isin(look)], motions, points, look)
        ax.set(ylim=(0, 1), xlabel=across)
        ax.set_title(subject(str(building), str(limit)), loc="left")
    shared_legend(figure, axes)
    said = [f"At {shown.format_point(rows)}."] if shown.format_point(rows) else []
    said += {
        "ida": ["Markers: the share of motions that have passed by that intensity, by Kaplan and Meier where some are "
                "undecided."],
        "stripes": ["Markers: the share of the decided motions that pass at each intensity."],
    }.get(spec["method"], ["Curves from a line through the cloud of demands."])  # fmt: skip
    if rows["motions"].max() < FEWEST_TOLD:
        said.append(f"No bands for fewer than {FEWEST_TOLD} motions.")
    else:
        said.append(f"Bands: {100 * spec['confidence']:.4g} % of {spec['draws']} bootstrap draws of the motions.")
    if len(cases) > MOST_CASES:
        said.append(f"Of {len(cases)} cases the first {MOST_CASES} are drawn.")
    finish(figure, shown.title, " ".join([*said, describe_motions(shown.records)]))
    return figure


def _panel(
    ax: Axes, method: str, unit: Unit, rows: pd.DataFrame, motions: pd.DataFrame, points: pd.DataFrame,
    cases: Mapping[str, Look],
) -> None:  # fmt: skip
    """The curves of one limit and building: the building alone, which is the same in all cases, and every case."""
    up, right, where = 0.04, 0.0, ["case", "analysis", "limit", "building"]
    everything = rows.to_dict("records")
    for end, row in ((ALONE, everything[0]), *((LINKED, row) for row in everything)):
        if not row[f"outcome{end}"]:
            continue
        mine, curve = (each[(each[where] == [row[name] for name in where]).all(axis=1)] for each in (motions, points))
        look, label = (_ALONE, "alone") if end else (cases[row["case"]], f"with pounding: {row['case']}")
        (line,) = ax.plot([], [], color=look.color, ls=look.line, lw=1.8, label=label)
        x = curve["intensity"] / unit.factor
        if np.isnan(row[f"median{end}"]):
            said = textwrap.wrap(f"{label}: {median_text(row, end, unit)}", 50)
            ax.text(0.98, up, "\n".join(said), transform=ax.transAxes, ha="right", fontsize=7.5, color=look.color)
            up += 0.08 * len(said)
        else:
            line.set_data(x, curve[f"probability{end}"])
            low, high = curve[f"probability_low{end}"], curve[f"probability_high{end}"]
            ax.fill_between(x, low, high, color=look.color, alpha=0.13, lw=0)
        at, share = _shares(mine, end, method)
        seen = mine[["intensity"] if "intensity" in mine else [f"held{end}", f"passed{end}"]].to_numpy(float)
        right = max(right, x.max() if len(x) else 1.1 * seen[np.isfinite(seen)].max(initial=0.0) / unit.factor)
        if (is_in := at / unit.factor <= right).any():  # a line without points would count as one at the corner
            dots: dict[str, Any] = {"ls": "", "marker": look.marker, "ms": 3.2, "color": look.color, "alpha": 0.75}
            ax.plot(at[is_in] / unit.factor, share[is_in], clip_on=False, **dots)
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


@styled
def draw_contributions(rows: pd.DataFrame, unit: Unit, shown: Evidence) -> Figure:
    """The annual rate per ln of the intensity, alone and with pounding: a panel for each limit and building."""
    rows = rows[rows["analysis"] == rows["analysis"].iloc[-1]]
    groups, look = rows.groupby(["limit", "building"], sort=False), looks(rows["case"].unique().tolist())
    figure, axes = grid(len(groups), 3.6, 2.8)
    for ax, ((limit, building), mine) in zip(axes, groups, strict=True):
        for case, own in mine.groupby("case", sort=False):
            at, width = np.sqrt(own["from"] * own["to"]) / unit.factor, np.log(own["to"] / own["from"])
            if case == mine["case"].iloc[0] and own[f"rate{ALONE}"].notna().any():
                ax.plot(at, own[f"rate{ALONE}"] / width, color=_ALONE.color, ls=_ALONE.line, lw=1.6, label="alone")
            how = look[str(case)]
            ax.plot(at, own["rate"] / width, color=how.color, ls=how.line, lw=1.8, label=f"with pounding: {case}")
        ax.set_title(subject(str(building), str(limit)), loc="left")
        ax.set(xscale="log", xlabel=unit.label("intensity"), ylabel="annual rate per ln of the intensity")
        ax.set_ylim(bottom=0)
    shared_legend(figure, axes)
    finish(figure, shown.title)
    return figure


def cite_fragility(resolved: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """The references of the way a study was asked for fragility curves."""
    spec = resolved.get("fragility") or {}
    if spec.get("method", "ida") == "ida":
        yield "vamvatsikos2004", "hunting for the intensity at which a motion passes a limit"
    if spec.get("method") == "cloud":
        yield "jalayer2015", "the line through a cloud of demands"
    else:
        yield "baker2015", "fragility curves of maximum likelihood"
    yield "efron1993", "the bootstrap of the motions"
    if spec.get("hazard"):
        yield "cornell2002", "annual rates from a fragility curve and a hazard curve"
