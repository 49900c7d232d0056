"""The report of `pound fragility`: curves alone and with pounding, with their bands and what the motions say."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Mapping
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
from pounding_cli.report.table import NOTHING, digits, from_rows, interval
from pounding_cli.results.tables import Table
from pounding_cli.workflows.curves import CONFIDENCE, DRAWS, Outcome, bands, resamples
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
_BOTH = {ALONE: "alone", "": "with pounding"}
_MEASURES = {
    "pga": "peak ground acceleration", "pgv": "peak ground velocity", "sa": "pseudo-acceleration",
    "factor": "scale factor",
}  # fmt: skip


@dataclass(frozen=True)
class Asked:
    """How the curves were asked for: method, intensity measure in words with its unit, confidence [-], draws of the
    bootstrap."""

    method: str
    measure: str
    unit: Unit
    confidence: float
    draws: int


def asked_of(results: Results) -> Asked:
    """How the curves of a results file were asked for."""
    spec = results.resolved.get("fragility") or {}
    swept = next((name for key, name in INTENSITY_KEYS.items() if key in results.units), "pga")
    measure = str(spec.get("intensity") or swept)
    scale = results.resolved["records"]["scale"]
    if measure == "sa" and isinstance(scale, dict) and "period" in scale:
        measure = f"sa({scale['period']:g} s)"
    name, _, period = measure.partition("(")
    words = _MEASURES.get(name, name) + (f" at {period.removesuffix(')')}" if period else "")
    unit = results.answer(CURVES).columns["median"].unit
    confidence, draws = float(spec.get("confidence", CONFIDENCE)), int(spec.get("draws", DRAWS))
    return Asked(str(spec.get("method", "ida")), words, unit, confidence, draws)


def fragility_report(results: Results) -> Report:
    """What the fragility curves say."""
    answer, asked, shown = results.answer(CURVES), asked_of(results), nominal(results)
    motions, rows, pictures = results.answer(MOTIONS).frame, shown.here(answer.frame), []
    for analysis, here in rows.groupby("analysis", sort=False):
        text = " ".join(_sentence(asked, row) for row in here.to_dict("records"))
        draw = partial(draw_curves, asked, here, shown.here(motions), shown)
        pictures.append(Picture(f"fragility-{analysis}", f"Fragility, {analysis} storeys", text, draw))
    rates, of_rates, notes = rate_table(results, shown)
    tables = [_medians(results, asked, answer.frame), *rates]
    said = [f"Intensity: {asked.measure}.", *(_sentence(asked, row) for row in rows.to_dict("records"))]

    def more() -> list[Section]:
        *others, kept, study = background(results, shown, results.scene(), TABLES)
        points = Table("fragility_curves", curve_points(answer, asked, motions), caption="Points of the curves")
        return [*others, Section(kept.title, kept.sentences, [*kept.tables, points], folded=True), study]

    return Report(
        **frame_of(results, shown, results.scene()),
        answer=Section("", said, tables, pictures + of_rates, _notes(asked, answer.frame) + notes),
        more=more,
    )


# the curves


@dataclass(frozen=True, eq=False)
class Curve:
    """One curve: its row in the table, the rows of its motions, ALONE or "", and over the intensities `x` the
    probability of passing with its interval; None where there is no curve."""

    row: Mapping[Any, Any]
    motions: pd.DataFrame
    suffix: str
    x: np.ndarray
    likely: pd.DataFrame | None


def curves_of(asked: Asked, rows: pd.DataFrame, motions: pd.DataFrame) -> Iterator[Curve]:
    """The curves of one limit: the building alone, which is the same in all cases, and every case with pounding.

    rows : of the table, a case each; motions : the table of motions
    """
    where = [name for name in rows.columns[: rows.columns.get_loc("outcome")] if name != "case"]
    motions = motions[(motions[where] == rows[where].iloc[0]).all(axis=1)]
    x = np.linspace(0, _right(rows, motions), 201)[1:]
    times = resamples(motion_numbers(motions)[1], asked.draws)
    everything = rows.to_dict("records")
    for suffix, row in ((ALONE, everything[0]), *(("", row) for row in everything)):
        mine, likely = motions[motions["case"] == row["case"]], None
        if row[f"median{suffix}"] == row[f"median{suffix}"]:
            band = bands(fits_of(mine, suffix, asked.method, times), x, asked.confidence)
            passed = ndtr(np.log(x / row[f"median{suffix}"]) / row[f"spread{suffix}"])
            likely = pd.DataFrame({"probability": passed, "probability_low": band.low, "probability_high": band.high})
        if row[f"outcome{suffix}"]:
            yield Curve(row, mine, suffix, x, likely)


def _right(rows: pd.DataFrame, motions: pd.DataFrame) -> float:
    """Where an axis of intensities ends: beyond nearly all of every curve, but not far beyond where motions pass; where
    there is no curve, beyond what was solved."""
    names = ["intensity"] if "intensity" in motions else [name + end for name in ("held", "passed") for end in _BOTH]
    seen = motions[names].to_numpy(dtype=float).ravel()
    top, ends = float(seen[np.isfinite(seen)].max(initial=0.0)), list[float]()
    for suffix in _BOTH:
        median, spread = rows[f"median{suffix}"], rows[f"spread{suffix}"]
        ends += np.minimum(median * np.exp(1.8 * spread), np.maximum(2 * top, 1.2 * median)).dropna().tolist()
    return 1.1 * max(ends, default=top) or 1.0


def curve_points(answer: Table, asked: Asked, motions: pd.DataFrame) -> pd.DataFrame:
    """Points of every curve: intensities and swept keys in the units of the study, `curve` alone or with pounding, the
    probability of passing the limit [-] and its bootstrap interval. A limit without a curve has none.

    motions : the table of motions
    """
    frame, head = answer.frame, asked.unit.label("intensity")
    where = [name for name in frame.columns[: frame.columns.get_loc("outcome")] if name != "case"]
    units = {name: answer.columns[name].unit for name in where}
    columns = [*(unit.label(name) for name, unit in units.items()), "case", "curve", head]
    parts = [pd.DataFrame(columns=[*columns, "probability", "probability_low", "probability_high"])]
    for _, rows in frame.groupby(where, sort=False):
        for curve in curves_of(asked, rows, motions):
            if curve.likely is not None:
                row, case = curve.row, "" if curve.suffix else curve.row["case"]
                at = [row[name] if isinstance(row[name], str) else units[name].number(row[name]) for name in where]
                values = [*at, case, _BOTH[curve.suffix], (curve.x / asked.unit.factor).round(10)]
                parts.append(pd.concat([pd.DataFrame(dict(zip(columns, values, strict=True))), curve.likely], axis=1))
    return pd.concat(parts[1:] or parts, ignore_index=True)


@styled
def draw_curves(asked: Asked, rows: pd.DataFrame, motions: pd.DataFrame, shown: Evidence) -> Figure:
    """Probability against intensity: a line of panels for each limit, a panel for each building or pair."""
    limits = {limit: here["building"].unique() for limit, here in rows.groupby("limit", sort=False)}
    cases = rows["case"].unique().tolist()
    look = {case: each for case, each in looks(cases).items() if case in cases[:MOST_CASES]}
    figure, axes = panels(len(limits), max(map(len, limits.values())), 3.6, 2.8, sharey=True)
    for line, (limit, buildings) in zip(axes, limits.items(), strict=True):
        for ax in line[len(buildings) :]:
            ax.set_visible(False)
        for ax, building in zip(line, buildings, strict=False):
            here = rows[(rows["limit"] == limit) & (rows["building"] == building) & rows["case"].isin(look)]
            _panel(ax, asked, here, motions, look)
            ax.set(ylim=(0, 1), xlabel=asked.unit.label(asked.measure))
            ax.set_title(subject(building, str(limit)), loc="left")
        line[0].set_ylabel("probability of passing the limit")
    shared_legend(figure, axes.flat)
    entitle(figure, shown.title)
    kept = {key: value for key, value in shown.point.items() if key in rows}
    where = ", ".join(f"{key} = {shown.results.value_label(key, value)}" for key, value in kept.items())
    left_out = f" Of {len(cases)} cases the first {MOST_CASES} are drawn." if len(cases) > MOST_CASES else ""
    dots = {
        "ida": "Markers: the share of motions that have passed by that intensity, by Kaplan and Meier where some are "
        "undecided.",
        "stripes": "Markers: the share of the decided motions that pass at each intensity.",
    }.get(asked.method, "Curves from a line through the cloud of demands.")
    caption(
        figure,
        f"{f'At {where}. ' if where else ''}{dots} Bands: {100 * asked.confidence:.4g} % of {asked.draws} bootstrap "
        f"draws of the motions.{left_out} {motion_sentence(shown.records)}",
    )
    return figure


def _panel(ax: Axes, asked: Asked, rows: pd.DataFrame, motions: pd.DataFrame, cases: Mapping[str, Look]) -> None:
    """The curves of one limit and building."""
    factor, up = asked.unit.factor, 0.04
    for curve in curves_of(asked, rows, motions):
        case, x = curve.row["case"], curve.x / factor
        look, label = (_ALONE, "alone") if curve.suffix else (cases[case], f"with pounding: {case}")
        (line,) = ax.plot([], [], color=look.color, ls=look.line, lw=1.8, label=label)
        if curve.likely is not None:
            line.set_data(x, curve.likely["probability"])
            low, high = curve.likely["probability_low"], curve.likely["probability_high"]
            ax.fill_between(x, low, high, color=look.color, alpha=0.13, lw=0)
        else:
            said = textwrap.wrap(f"{label}: {median_text(asked, curve.row, curve.suffix)}", 50)
            ax.text(0.98, up, "\n".join(said), transform=ax.transAxes, ha="right", fontsize=7.5, color=look.color)
            up += 0.08 * len(said)
        at, share = _points(curve.motions, curve.suffix, asked.method)
        seen = at <= curve.x[-1]
        if seen.any():  # a line without points would count as one at the corner of the figure
            ax.plot(
                at[seen] / factor, share[seen], ls="", marker=look.marker, ms=3.2, color=look.color, alpha=0.75,
                clip_on=False,
            )  # fmt: skip
        ax.set_xlim(0, x[-1])


def _points(rows: pd.DataFrame, suffix: str, method: str) -> tuple[np.ndarray, np.ndarray]:
    """What the motions say: the share that has passed by an intensity (`ida`) or passes at it (`stripes`)."""
    if method == "ida":
        held, passed = rows[f"held{suffix}"].to_numpy(float), rows[f"passed{suffix}"].to_numpy(float)
        last = np.where(np.isfinite(passed), passed, held)  # the highest intensity at which a motion says something
        at, passes = np.unique(passed[np.isfinite(passed)], return_counts=True)
        # Kaplan, E. L. and Meier, P. (1958). Nonparametric estimation from incomplete observations. JASA 53, 457-481
        left = np.array([(last >= x).sum() for x in at])
        return at, 1 - np.cumprod(1 - passes / left)
    if method == "stripes":
        done = rows[rows[f"demand{suffix}"].notna()]
        shares = (done[f"demand{suffix}"] > 1).groupby(done["intensity"]).agg(["mean", "size"])
        shares = shares[shares["size"] > 1]  # intensities of single motions are no stripes
        return shares.index.to_numpy(float), shares["mean"].to_numpy(float)
    return np.zeros(0), np.zeros(0)


# in words


def _medians(results: Results, asked: Asked, frame: pd.DataFrame) -> Table:
    """Medians, spreads and their ratios with their intervals in brackets, a row a curve and point of the sweep.

    A case or an analysis that is the same in all rows is left out.
    """
    rows = []
    for row in frame.to_dict("records"):
        cells = {results.axis_label(key): results.value_label(key, row[key]) for key in results.axes if key in frame}
        cells |= {name: row[name] for name in ("limit", "building")}
        cells |= {name: row[name] for name in ("case", "analysis") if len(frame[name].unique()) > 1}
        for suffix, what in _BOTH.items():
            there = bool(row[f"outcome{suffix}"])
            cells[asked.unit.label(f"median {what}").strip()] = median_text(asked, row, suffix)
            cells[f"spread {what}"] = interval(row, "spread", suffix) if there else NOTHING
            lost = (frame[f"undecided_motions{suffix}"] > 0) & (frame[f"outcome{suffix}"] != Outcome.UNDECIDED)
            if lost.any():
                cells[f"undecided {what}"] = undecided_text(row, suffix) if there else NOTHING
        rows.append(cells | {"ratio of medians": interval(row, "ratio")})
    heads = list(rows[0]) if rows else []
    return from_rows("Intensity at which half of the motions pass", heads, [list(row.values()) for row in rows])


def _sentence(asked: Asked, row: Mapping[Any, Any]) -> str:
    """One curve in words."""
    what = f"{subject(row['building'], row['limit'])}, {row['case']}, {row['analysis']}"
    medians = [f"{median_text(asked, row, suffix, asked.unit.name)}{words}"
               for suffix, words in ((ALONE, " alone"), ("", " with pounding")) if row[f"outcome{suffix}"]]  # fmt: skip
    said = f"{what}, median: {', '.join(medians)}"
    if row["ratio"] == row["ratio"]:
        motion = "a weaker motion is enough" if row["ratio"] < 1 else "it takes a stronger motion"
        said += f"; with pounding {motion}, by a factor of {interval(row, 'ratio')}"
        if row["ratio_low"] <= 1 <= row["ratio_high"]:
            said = f"{what}, median: {', '.join(medians)}; a difference that may be chance in "
            said += counted(int(row["motions"]), "motion")
    for suffix, words in _BOTH.items():
        if row[f"undecided_motions{suffix}"] > 0:
            so = ", so there is no curve" if row[f"outcome{suffix}"] == Outcome.UNDECIDED else ""
            said += (
                f". {words.capitalize()}, a collapse ended the scenes of {undecided_text(row, suffix)} motions before "
            )
            said += f"the limit was passed{so}"
    return f"{said}."


def subject(building: str, limit: str) -> str:
    """The limit and the building that it is asked of; a limit may name the building itself."""
    return limit if f" in {building} " in f"{limit} " else f"{building}, {limit}"


def median_text(asked: Asked, row: Mapping[Any, Any], suffix: str = "", unit: str = "") -> str:
    """A median with its interval; where there is none, outcome of the fit and what is known."""
    outcome, low, high = str(row[f"outcome{suffix}"]), row[f"low{suffix}"], row[f"high{suffix}"]
    if not outcome:
        return NOTHING
    if row[f"median{suffix}"] == row[f"median{suffix}"]:
        return interval(row, "median", suffix, asked.unit.factor, unit)
    if outcome == Outcome.UNDECIDED and not unit:  # a sentence says more
        outcome += f" in {undecided_text(row, suffix)} motions"
    ends = [digits(end / asked.unit.factor, 3) for end in (low, high)]
    known = " to ".join(ends) if low > 0 and high < np.inf else f"above {ends[0]}" if low > 0 else f"below {ends[1]}"
    return f"{outcome}: {known} {unit}".rstrip() if low > 0 or high < np.inf else outcome


def undecided_text(row: Mapping[Any, Any], suffix: str = "") -> str:
    """How many motions are undecided, of how many: "5 of 8"."""
    return f"{int(row[f'undecided_motions{suffix}'])} of {int(row[f'motions{suffix}'])}"


def _notes(asked: Asked, rows: pd.DataFrame) -> list[str]:
    """What a reader should know of the rows."""

    def count(name: str) -> int:
        return sum(int(rows[f"{name}{suffix}"].fillna(0).sum()) for suffix in _BOTH if f"{name}{suffix}" in rows)

    said = [
        f"In brackets: {100 * asked.confidence:.4g} % interval of {asked.draws} bootstrap draws of the motions, the "
        "same draws alone and with pounding."
    ]
    if asked.method == "ida":
        said.append(
            "Every motion that passes is bracketed between two neighbouring intensities of the study, further apart "
            "only where a scene failed or is undecided; the fit is of maximum likelihood over these brackets."
        )
    if returns := count("returns"):
        which = counted(returns, "motion holds", "motions hold")
        said.append(f"{which} again above the first intensity that passes; the first one counts.")
    ended = ", or gave a demand that has no logarithm" if asked.method == "cloud" else " before the limit was passed"
    for name, what in (("failed", "failed"), ("undecided", f"ended with a collapse{ended}")):
        if number := count(name):
            said.append(
                f"{counted(number, 'scene')} {what} (a scene that several rows need counts in each): counted neither "
                f"as holding nor as passing.{' The table `scene` names them.' if name == 'failed' else ''}"
            )
    if count("undecided_motions"):
        known = {
            "ida": "a motion counts as holding up to the highest intensity at which it is decided",
            "stripes": "undecided scenes are left out of the counts",
        }.get(asked.method, "undecided scenes are left out of the line")
        said.append(
            "Undecided motions: a collapse ended their scenes before the limit was passed, and the rest of the motion "
            f"might have passed it; {known}, as if undecided motions were like the others."
        )
    outcomes = dict.fromkeys(value for suffix in _BOTH for value in rows[f"outcome{suffix}"])
    return said + [f"{each}: {Outcome(each).meaning}." for each in outcomes if each not in ("", "fitted")]


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
