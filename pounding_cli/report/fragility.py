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
from scipy.special import ndtr

from pounding_cli.numbers import Unit, counted
from pounding_cli.report.background import background, frame_of
from pounding_cli.report.document import Picture, Report, Section
from pounding_cli.report.evidence import Evidence, motion_sentence, nominal
from pounding_cli.report.rates import rate_table
from pounding_cli.report.references import Use
from pounding_cli.report.style import Look, caption, entitle, looks, panels, shared_legend, styled
from pounding_cli.report.table import NOTHING, from_rows
from pounding_cli.results.tables import Table
from pounding_cli.workflows.curves import CONFIDENCE, DRAWS, Bands, Outcome, bands, resamples
from pounding_cli.workflows.fragility import ALONE, CURVES, MOTIONS, fits_of, motion_numbers
from pounding_cli.workflows.fragility_question import INTENSITY_KEYS

if TYPE_CHECKING:
    from pounding_cli.results.results import Results

TABLES = ("storey", "floor", "link", "scene", "summary", "records", "buildings")
"""The tables of scenes that the report has."""
MOST_CASES = 4
"""Cases in one panel; of more, the first are drawn."""

_ALONE = Look("#777777", (0, (2, 1)), "x")
"""As no case looks: one may be black, as `touching` is."""
_WORDS = ("limit", "building", "case", "analysis")
"""Columns of text."""
_BOTH = ((ALONE, "alone"), ("", "with pounding"))


def fragility_report(results: Results) -> Report:
    """What the fragility curves say."""
    answer, asked, shown = results.answer(CURVES), asked_of(results), nominal(results)
    everywhere, motions = results.answer(MOTIONS).frame, shown.here(results.answer(MOTIONS).frame)
    rows, pictures = shown.here(answer.frame), []
    for analysis in dict.fromkeys(rows["analysis"]):
        here = rows[rows["analysis"] == analysis]
        text = " ".join(_sentence(answer, row) for row in here.to_dict("records"))
        draw = partial(draw_curves, answer, asked, here, motions[motions["analysis"] == analysis], shown)
        pictures.append(Picture(f"fragility-{analysis}", f"Fragility, {analysis} storeys", text, draw))
    said = [f"Intensity: {asked.measure}.", *(_sentence(answer, row) for row in rows.to_dict("records"))]

    rates, of_rates, notes = rate_table(results, shown)

    def more() -> list[Section]:
        *others, tables, study = background(results, shown, results.scene(), TABLES)
        points = Table("fragility_curves", curve_points(answer, asked, everywhere), caption="Points of the curves")
        tables = Section(tables.title, tables.sentences, [*tables.tables, points], folded=True)
        return [*others, tables, study]

    return Report(
        **frame_of(results, shown, results.scene()),
        answer=Section(
            "", said, [_medians(results, answer), *rates], pictures + of_rates, _notes(asked, answer.frame) + notes
        ),
        more=more,
    )


def curve_points(answer: Table, asked: Asked, motions: pd.DataFrame) -> pd.DataFrame:
    """Points of every curve: intensities and swept keys in the units of the study, `curve` alone or with pounding, the
    probability of passing the limit [-] and its bootstrap interval. A limit without a curve has none.

    motions : the table of motions
    """
    frame, unit = answer.frame, intensity_unit(answer)
    where = [name for name in frame.columns[: frame.columns.get_loc("outcome")] if name != "case"]
    units = {name: answer.columns[name].unit for name in where}
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


def _sentence(answer: Table, row: Mapping[Any, Any]) -> str:
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
def draw_curves(answer: Table, asked: Asked, rows: pd.DataFrame, motions: pd.DataFrame, shown: Evidence) -> Figure:
    """Probability against intensity: a line of panels for each limit, a panel for each building or pair."""
    unit = intensity_unit(answer)
    limits = list(dict.fromkeys(rows["limit"]))
    columns = {limit: list(dict.fromkeys(rows[rows["limit"] == limit]["building"])) for limit in limits}
    wide = max(len(each) for each in columns.values())
    cases = list(dict.fromkeys(rows["case"]))
    drawn = {case: look for case, look in looks(cases).items() if case in cases[:MOST_CASES]}
    figure, axes = panels(len(limits), wide, 3.6, 2.8, sharey=True)
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
    answer: Table,
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
    if (resolved.get("fragility") or {}).get("hazard"):
        used("cornell2002", "annual rates from a fragility curve and a hazard curve")


def intensity_unit(answer: Table) -> Unit:
    """The unit of intensities; one without a name for a scale factor."""
    return answer.columns["median"].unit


def _medians(results: Results, answer: Table) -> Table:
    """Medians, spreads and their ratios with their intervals in brackets, a row a curve and point of the sweep.

    A case or an analysis that is the same in all rows is left out.
    """
    rows = answer.frame
    keys = [key for key in results.axes if key in rows]
    words = [name for name in _WORDS if name in _WORDS[:2] or len(set(rows[name])) > 1]
    unit = f" [{name}]" if (name := intensity_unit(answer).name) else ""
    lost = [
        alone for alone, _ in _BOTH
        if ((rows[f"undecided_motions{alone}"] > 0) & (rows[f"outcome{alone}"] != Outcome.UNDECIDED)).any()
    ]  # fmt: skip
    heads = [*(results.axis_label(key) for key in keys), *words]
    for alone, what in _BOTH:
        heads += [f"median {what}{unit}", f"spread {what}", *[f"undecided {what}"] * (alone in lost)]
    found = []
    for row in rows.to_dict("records"):
        cells = [results.value_label(key, row[key]) for key in keys] + [str(row[name]) for name in words]
        for alone, _ in _BOTH:
            cells += [median_text(answer, row, alone), _between(row, "spread", alone, Unit())]
            if alone in lost:
                cells.append(undecided_text(row, alone) if row["outcome" + alone] else NOTHING)
        found.append([*cells, _between(row, "ratio", "", Unit())])
    return from_rows("Intensity at which half of the motions pass", [*heads, "ratio of medians"], found)


def subject(building: str, limit: str) -> str:
    """The limit and the building that it is asked of; a limit may name the building itself."""
    return limit if f" in {building} " in f"{limit} " else f"{building}, {limit}"


def median_text(answer: Table, row: Mapping[Any, Any], alone: str = "", named: bool = False) -> str:
    """A median with its interval; where there is none, outcome of the fit and what is known.

    named : with the unit, in a sentence
    """
    unit = intensity_unit(answer)
    name = f" {unit.name}" if named and unit.name else ""
    outcome = str(row.get("outcome" + alone, ""))
    if not outcome:
        return NOTHING
    if row["median" + alone] == row["median" + alone]:
        return _between(row, "median", alone, unit, name)
    if outcome == Outcome.UNDECIDED and not named:  # a sentence says more
        outcome += f" in {undecided_text(row, alone)} motions"
    low, high = row["low" + alone], row["high" + alone]
    if low > 0 and high < np.inf:
        return f"{outcome}: {_text(low, unit)} to {_text(high, unit)}{name}"
    if low > 0 or high < np.inf:
        return (
            f"{outcome}: above {_text(low, unit)}{name}" if low > 0 else f"{outcome}: below {_text(high, unit)}{name}"
        )
    return outcome


def undecided_text(row: Mapping[Any, Any], alone: str = "") -> str:
    """How many motions are undecided, of how many: "5 of 8"."""
    return f"{int(row['undecided_motions' + alone])} of {int(row['motions' + alone])}"


def _between(row: Mapping[Any, Any], name: str, alone: str, unit: Unit, unit_name: str = "") -> str:
    value = row.get(name + alone, np.nan)
    if value != value:
        return NOTHING
    low, high = (_text(row[f"{name}_{end}{alone}"], unit) for end in ("low", "high"))
    return f"{_text(value, unit)}{unit_name} ({low} to {high}{unit_name})"


def _text(value: float, unit: Unit) -> str:
    return f"{unit.number(value):.3g}" if np.isfinite(value) else "inf"


@dataclass(frozen=True)
class Asked:
    """How the curves were asked for: method, intensity measure in words, confidence [-], draws of the bootstrap."""

    method: str
    measure: str
    confidence: float
    draws: int


def asked_of(results: Results) -> Asked:
    """How the curves of a results file were asked for."""
    spec = results.resolved.get("fragility") or {}
    swept = next((name for key, name in INTENSITY_KEYS.items() if key in results.units), "pga")
    measure = str(spec.get("intensity") or swept)
    if measure == "sa":
        scale = results.resolved["records"]["scale"]
        measure = f"sa({scale['period']:g} s)" if isinstance(scale, dict) and "period" in scale else measure
    words = _MEASURES.get(measure.partition("(")[0], measure)
    period = measure.partition("(")[2].removesuffix(")")
    return Asked(
        str(spec.get("method", "ida")),
        f"{words} at {period}" if period else words,
        float(spec.get("confidence", CONFIDENCE)),
        int(spec.get("draws", DRAWS)),
    )


_MEASURES = {
    "pga": "peak ground acceleration", "pgv": "peak ground velocity", "sa": "pseudo-acceleration",
    "factor": "scale factor",
}  # fmt: skip


def _notes(asked: Asked, rows: pd.DataFrame) -> list[str]:
    """What a reader should know of the rows."""
    both = [name for name in ("", ALONE) if "outcome" + name in rows]
    said = [
        f"In brackets: {100 * asked.confidence:.4g} % interval of {asked.draws} bootstrap draws of the motions, "
        "the same draws alone and with pounding."
    ]
    if asked.method == "ida":
        said.append(
            "Every motion that passes is bracketed between two neighbouring intensities of the study, further apart "
            "only where a scene failed or is undecided; the fit is of maximum likelihood over these brackets."
        )
        returns = sum(int(rows[f"returns{name}"].fillna(0).sum()) for name in both if f"returns{name}" in rows)
        if returns:
            which = counted(returns, "motion holds", "motions hold")
            said.append(f"{which} again above the first intensity that passes; the first one counts.")
    undecided = "ended with a collapse before the limit was passed"
    if asked.method == "cloud":
        undecided = "ended with a collapse, or gave a demand that has no logarithm"
    for column, what, more in (("failed", "failed", " The table `scene` names them."), ("undecided", undecided, "")):
        number = sum(int(rows[f"{column}{name}"].fillna(0).sum()) for name in both if f"{column}{name}" in rows)
        if number:
            said.append(
                f"{counted(number, 'scene')} {what} (a scene that several rows need counts in each): counted neither "
                f"as holding nor as passing.{more}"
            )
    if any(rows[f"undecided_motions{name}"].fillna(0).max() > 0 for name in both):
        known = {
            "ida": "a motion counts as holding up to the highest intensity at which it is decided",
            "stripes": "undecided scenes are left out of the counts",
        }.get(asked.method, "undecided scenes are left out of the line")
        said.append(
            "Undecided motions: a collapse ended their scenes before the limit was passed, and the rest of the motion "
            f"might have passed it; {known}, as if undecided motions were like the others."
        )
    outcomes = dict.fromkeys(value for name in both for value in rows["outcome" + name] if value not in ("", "fitted"))
    said += [f"{outcome}: {Outcome(outcome).meaning}." for outcome in outcomes]
    return said
