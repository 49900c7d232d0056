"""The texts of `pound fragility`: its answer in sentences, its tables, and notes on the numbers."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

from pounding_cli.numbers import Unit, format_number, pluralize
from pounding_cli.questions.bootstrap import MIN_MOTIONS
from pounding_cli.questions.fragility.curves import FitOutcome
from pounding_cli.questions.fragility.neighbour_words import describe_drawn, describe_widening, show_widening
from pounding_cli.questions.fragility.tables import CURVES, NEIGHBOURS, PERCENT, RATES
from pounding_cli.questions.frames import ALONE, STATE_COLUMN, WITH_POUNDING
from pounding_cli.questions.hazard import YEARS
from pounding_cli.report.evidence import find_nominal
from pounding_cli.study.expressions.expression import SHEAR_DEMAND, Scope
from pounding_cli.study.expressions.limits import EDGE_DRIFT, EVENTS, TWIST, parse_limit
from pounding_cli.study.schema.records import INTENSITY_KEYS
from pounding_cli.tables import Column, Row, Table

if TYPE_CHECKING:
    import pandas as pd

    from pounding_cli.results.results import ResultTables

MAX_SENTENCES = 24
"""Curves that are told in sentences; of more the table tells the rest."""

MIN_TOLD_BEYOND = 0.1
"""Part of a rate from beyond the last intensity of the hazard curve from which a note tells it [-]."""

_MEASURES = {
    "pga": "peak ground acceleration",
    "pgv": "peak ground velocity",
    "sa": "pseudo-acceleration",
    "ag": "ground acceleration of the target spectrum",
    "factor": "scale factor",
}
_QUANTITIES = {
    "mu": "ductility",
    "drift": "interstorey drift",
    "acceleration": "floor acceleration",
    EDGE_DRIFT: "interstorey drift of either edge",
    TWIST: "rotation of a floor",
    SHEAR_DEMAND: "shear demand of columns",
}
_REASONS = {
    FitOutcome.NEVER: "never passed",
    FitOutcome.ALWAYS: "always passed",
    FitOutcome.SEPARATED: "no overlap of intensities at which motions hold and at which they pass",
    FitOutcome.FLAT: "no trend: stronger motions do not pass more often",
    FitOutcome.FEW: "too few motions or intensities for a curve",
}
"""Why there is no median, in sentences; tables have the outcome alone."""


class ComparedCurves(NamedTuple):
    """The rows of one limit, building, case, analysis and point of the sweep.

    place : the columns that say where they stand
    alone, pounding : rows by state; None of a state that does not exist
    """

    place: Row
    alone: Row | None
    pounding: Row | None


def pair_states(frame: pd.DataFrame) -> list[ComparedCurves]:
    """Return the rows of a table by place, those of both states together."""
    columns = list(map(str, frame.columns))
    place_columns = columns[: columns.index(STATE_COLUMN)]
    by_place: dict[tuple[Any, ...], dict[str, Row]] = {}
    for row in frame.to_dict("records"):
        key = tuple(row[name] for name in place_columns)
        by_place.setdefault(key, {})[row[STATE_COLUMN]] = row
    return [
        ComparedCurves(dict(zip(place_columns, key, strict=True)), rows.get(ALONE), rows.get(WITH_POUNDING))
        for key, rows in by_place.items()
    ]


# Sentences


def list_sentences(results: ResultTables) -> list[str]:
    """Return the answer in sentences: of every limit and building at one point of the sweep, then the intensity."""
    answer = results.answer(CURVES)
    evidence = find_nominal(results)
    curves = pair_states(evidence.rows_here(answer.frame))
    rates: list[ComparedCurves] = []
    if RATES in results.answers:
        rates = pair_states(evidence.rows_here(results.answer(RATES).frame))
    median = median_column(answer.column("median"))
    confidence = format_confidence(results)
    point = evidence.format_point(answer.frame.columns)
    buildings = results.names("building")
    sentences = []
    for number, curve in enumerate(curves[:MAX_SENTENCES]):
        subject = describe_curve_place(curve.place, curves, buildings, point, list_twisting_buildings(results))
        sentence = f"{subject}: {compare_medians(curve, median, confidence)}."
        if rates and (words := compare_rates(rates[number], confidence, _count_motions(curve))):
            sentence += f" {words}."
        if words := describe_widening(evidence, curve.place):
            sentence += f" {words}."
        sentences.append(sentence)
    if len(curves) > MAX_SENTENCES:
        sentences.append(f"The table has {len(curves) - MAX_SENTENCES} more limits and buildings.")
    if len(evidence.rows_here(answer.frame)) < len(answer.frame):
        sentences.append("The table has the other points of the sweep.")
    last = [describe_drawn(results), f"Intensity measure: {describe_measure(results)}."]
    return [*sentences, *(sentence for sentence in last if sentence)]


def format_confidence(results: ResultTables) -> str:
    """Return the confidence of all intervals: "90 %"."""
    return f"{100 * results.study_data['fragility']['confidence']:.4g} %"


def describe_measure(results: ResultTables) -> str:
    """Return the intensity measure in words: "pseudo-acceleration at 0.5 s"."""
    scale = results.study_data["records"]["scale"]
    swept = next((name for key, name in INTENSITY_KEYS.items() if key in results.units), "pga")
    measure = str(results.study_data["fragility"].get("intensity") or swept)
    if measure == "sa" and isinstance(scale, dict) and "period" in scale:
        measure = f"sa({scale['period']:g} s)"
    name, _, period = measure.partition("(")
    return _MEASURES.get(name, name) + (f" at {period.removesuffix(')')}" if period else "")


def list_twisting_buildings(results: ResultTables) -> Collection[str]:
    """Return the names of the buildings whose floors twist in some time history."""
    if "twist" not in results.arrays:
        return ()
    floors = results.floor("twist")
    return set(floors.loc[floors["twist"] > 0.0, "building"])


def describe_curve_place(
    place: Row,
    others: list[ComparedCurves],
    buildings: Sequence[str],
    point: str = "",
    twisting: Collection[str] = (),
) -> str:
    """Return where a curve stands: building, limit and, where they vary, case, analysis and point of the sweep.

    buildings : names of the group by place
    twisting : buildings whose floors twist, where the drift of a storey is that of its centre of mass
    """
    limit = describe_limit(str(place["limit"]), buildings, twists=place["building"] in twisting)
    words = [str(place["building"]).replace("|", " and "), limit]
    if len({other.place["case"] for other in others}) > 1:
        words.append(f"case {place['case']}")
    if len({other.place["analysis"] for other in others}) > 1:
        words.append(f"{place['analysis']} storeys")
    if point:
        words.append(f"at {point}")
    return ", ".join(words)


def describe_limit(text: str, buildings: Sequence[str], twists: bool = False) -> str:
    """Return a limit in words: "ductility of storey 2 above 4".

    buildings : names of the group by place
    twists : whether the floors of the building twist, so that the drift of a storey is that of its centre of mass
    """
    limit = parse_limit(text, Scope(tuple(buildings)))
    if limit.quantity in EVENTS:
        return limit.quantity
    value = text.partition(">")[2].strip()
    if limit.of_height:
        value = f"{100 * limit.value:.6g} % of the storey height"
    quantity = _QUANTITIES[limit.quantity]
    if limit.level and limit.quantity == "acceleration":
        quantity = f"acceleration of floor {limit.level}"
    elif limit.level and limit.quantity == TWIST:
        quantity = f"rotation of floor {limit.level}"
    elif limit.line:
        quantity += f" of line {limit.line}"
        if limit.level:
            quantity += f" in storey {limit.level}"
    elif limit.level:
        quantity += f" of storey {limit.level}"
    if twists and limit.quantity == "drift" and not limit.line:
        quantity += " at the centre of mass"
    return f"{quantity} above {value}"


def compare_medians(curve: ComparedCurves, median: Column, confidence: str) -> str:
    """Return in words what pounding changes of a median capacity, with its direction and number."""
    rows = {WITH_POUNDING: curve.pounding, ALONE: curve.alone}
    texts = {state: _describe_median(row, median, confidence) for state, row in rows.items() if row is not None}
    if curve.alone is None or curve.pounding is None:
        return "".join(texts.values())
    ratio = curve.pounding["ratio"]
    if not math.isfinite(ratio):
        if texts[WITH_POUNDING] == texts[ALONE]:
            return f"{texts[ALONE]}, {ALONE} and {WITH_POUNDING}"
        return f"{WITH_POUNDING} {texts[WITH_POUNDING]}; {ALONE} {texts[ALONE]}"
    with_pounding = replace(median, low="", high="").format_with_unit(curve.pounding)
    alone = replace(median, low="", high="").format_with_unit(curve.alone)
    if _is_one(curve.pounding, "ratio"):
        return f"pounding makes no difference in three digits (median capacity {with_pounding})"
    factor = format_number(ratio, 3)
    interval = _format_interval(curve.pounding, "ratio", confidence)
    if not _is_significant(curve.pounding, "ratio"):
        motions = pluralize(_count_motions(curve), "motion")
        return (
            f"the difference is not significant with {motions} "
            f"(median capacity {with_pounding} {WITH_POUNDING}, {alone} {ALONE}; factor {factor}, {interval})"
        )
    medians = f"({interval}; median capacity {with_pounding} in place of {alone})"
    if ratio < 1:
        return f"{WITH_POUNDING} a motion {factor} times as strong is enough {medians}"
    return f"{WITH_POUNDING} it takes a motion {factor} times as strong {medians}"


def compare_rates(rates: ComparedCurves, confidence: str, motions: int) -> str:
    """Return in words what pounding changes of an annual rate; "" where there is none.

    motions : behind both rates
    """
    texts = [
        f"{_format_rate(row['rate'])} {state}"
        for state, row in ((WITH_POUNDING, rates.pounding), (ALONE, rates.alone))
        if row is not None and math.isfinite(row["rate"])
    ]
    if not texts:
        return ""
    words = f"Annual rate {', '.join(texts)}"
    row = rates.pounding
    if row is None or rates.alone is None or not math.isfinite(row["rate_ratio"]) or _is_one(row, "rate_ratio"):
        return words
    if not _is_significant(row, "rate_ratio"):
        return f"{words}: a difference that is not significant with {pluralize(motions, 'motion')}"
    interval = _format_interval(row, "rate_ratio", confidence)
    return f"{words}: {format_number(row['rate_ratio'], 3)} times as often ({interval})"


def _count_motions(curve: ComparedCurves) -> int:
    """Return the motions behind the curves of both states, the fewer where they differ."""
    return min(int(row["motions"]) for row in (curve.alone, curve.pounding) if row is not None)


def _is_one(row: Row, name: str) -> bool:
    """Return whether a ratio is 1 in three digits, with both ends of its interval where it has one."""
    values = [row[each] for each in (name, f"{name}_low", f"{name}_high")]
    return all(math.isnan(value) or format_number(value, 3) == "1.00" for value in values)


def _is_significant(row: Row, name: str) -> bool:
    """Return whether the interval of a ratio leaves out 1; never without an interval."""
    return bool(row[f"{name}_low"] > 1 or row[f"{name}_high"] < 1)


def _format_interval(row: Row, name: str, confidence: str) -> str:
    """Return the interval of a ratio in words."""
    low = row[f"{name}_low"]
    high = row[f"{name}_high"]
    if math.isnan(low):
        return f"no interval from fewer than {MIN_MOTIONS} motions"
    ends = f"above {format_number(low, 3)}"
    if math.isfinite(high):
        ends = f"{format_number(low, 3)} to {format_number(high, 3)}"
    return f"{confidence} interval {ends}"


def _format_rate(rate: float) -> str:
    """Return an annual rate and how many years lie between two events: "0.0083 (once in 120 years)"."""
    if rate <= 0:
        return format_number(rate, 3)
    return f"{format_number(rate, 3)} (once in {format_number(1 / rate, 3)} years)"


def _describe_median(row: Row, median: Column, confidence: str) -> str:
    """Return a median capacity with its interval; where there is none, why, and what is known of it."""
    if math.isfinite(row["median"]):
        text = f"median capacity {replace(median, low='', high='').format_with_unit(row)}"
        if math.isnan(row["median_low"]):
            return text
        ends = f"above {median.format(row['median_low'])} {median.unit.name}"
        if math.isfinite(row["median_high"]):
            ends = f"{median.format(row['median_low'])} to {median.format(row['median_high'])} {median.unit.name}"
        return f"{text} ({confidence} interval {ends.rstrip()})"
    reason = _REASONS.get(row["outcome"]) or _describe_outcome(row)
    bounds = _format_bounds(row, median.unit)
    return f"{reason} (median capacity {bounds} {median.unit.name}".rstrip() + ")" if bounds else reason


def _describe_outcome(row: Row) -> str:
    """Return the outcome of a fit; of undecided motions with how many they are."""
    outcome = str(row["outcome"])
    if outcome == FitOutcome.UNDECIDED:
        outcome += f" in {int(row['undecided_motions'])} of {int(row['motions'])} motions"
    return outcome


def _format_bounds(row: Row, unit: Unit) -> str:
    """Return what is known of a median that no fit gives: "0.2 to 0.3", "above 0.2"; "" where nothing is."""
    low = format_number(row["low"] / unit.factor, 3)
    high = format_number(row["high"] / unit.factor, 3)
    if row["low"] > 0 and math.isfinite(row["high"]):
        return f"{low} to {high}"
    if row["low"] > 0:
        return f"above {low}"
    return f"below {high}" if math.isfinite(row["high"]) else ""


# Tables


def list_tables(results: ResultTables) -> list[Table]:
    """Return the tables that a terminal prints: medians with their ratios and, with a hazard curve, annual rates."""
    tables = [_view_medians(results.answer(CURVES))]
    if RATES in results.answers:
        tables.append(_view_rates(results.answer(RATES)))
    if NEIGHBOURS in results.answers:
        curves = results.answer(CURVES)
        median = median_column(curves.column("median"))
        tables.append(show_widening(results, _limit_column(curves), median, _varying(curves)))
    return tables


def median_column(declared: Column) -> Column:
    """Return the column of medians as people read it: with its interval or, without a median, why there is none."""

    def explain(row: Row) -> str:
        outcome = _describe_outcome(row)
        bounds = _format_bounds(row, declared.unit)
        return f"{outcome}: {bounds}" if bounds else outcome

    return replace(declared, digits=3, otherwise=explain)


def join_place(building: str, limit: str) -> str:
    """Return the building and the limit that is asked of it; a limit may name the building itself."""
    is_named = f" in {building} " in f"{limit} " or f" of {building} " in f"{limit} "
    return limit if is_named else f"{building}, {limit}"


def _limit_column(table: Table) -> Column:
    """Return the column of limits with their buildings."""
    return replace(table.column("limit"), write=lambda row: join_place(row["building"], row["limit"]))


def _ratio_column(declared: Column) -> Column:
    """Return the column of ratios to the building alone, empty where there is none to compare with."""
    return replace(declared, digits=3, label="ratio to alone", otherwise=lambda _row: "", optional=True)


def _varying(table: Table) -> list[str]:
    """Return the columns before the limit: swept keys, case and analysis."""
    names = [column.name for column in table.columns]
    return names[: names.index("limit")]


def _view_medians(curves: Table) -> Table:
    """Return the medians, a row a curve and point of the sweep."""
    return curves.view(
        _limit_column(curves),
        STATE_COLUMN,
        median_column(curves.column("median")),
        _ratio_column(curves.column("ratio")),
        replace(curves.column("spread"), digits=3, optional=True),
        varying=_varying(curves),
        caption="Median capacity (exceeded for 50 % of the motions)",
    )


def _view_rates(rates: Table) -> Table:
    """Return the annual rates of the limits, a row as in the table of medians."""
    return rates.view(
        _limit_column(rates),
        STATE_COLUMN,
        replace(rates.column("rate"), digits=3, label="annual rate"),
        replace(rates.column("probability"), digits=3, unit=PERCENT, label=f"in {YEARS:g} years", optional=True),
        _ratio_column(rates.column("rate_ratio")),
        varying=_varying(rates),
        caption="Mean annual rate at which a limit is passed",
    )


# Notes and references


def list_notes(results: ResultTables) -> list[str]:
    """Return what a reader should know of the numbers."""
    notes = list(_iter_notes(results, results.answer(CURVES).frame))
    if RATES in results.answers:
        beyond = results.answer(RATES).frame["beyond"].max()
        if beyond > MIN_TOLD_BEYOND:
            notes.append(
                f"Up to {100 * beyond:.0f} % of a rate comes from intensities beyond the last one of the hazard curve, "
                "where its last line goes on: extend the curve."
            )
    return notes


def _iter_notes(results: ResultTables, curves: pd.DataFrame) -> Iterator[str]:
    spec = results.study_data["fragility"]
    fewest = int(curves["motions"].min())
    if fewest < MIN_MOTIONS:
        motions = pluralize(fewest, "motion")
        yield f"No interval for fewer than {MIN_MOTIONS} motions: {motions} cannot show how much capacities vary."
    if curves["motions"].max() >= MIN_MOTIONS:
        yield (
            f"In brackets: {format_confidence(results)} interval of {spec['draws']} bootstrap draws of the motions, "
            "the same draws for both states."
        )
    if failed := int(results.attrs["scenes_failed"]):
        histories = pluralize(failed, "time history", "time histories")
        yield f"{histories} failed: counted neither as holding nor as passing."
    if undecided := int(curves["undecided"].sum()):
        histories = pluralize(undecided, "time history", "time histories")
        yield (
            f"{histories} ended with a collapse before the limit was passed (one that several rows need counts in "
            "each): counted neither as holding nor as passing."
        )
    if undecided_motions := int(curves["undecided_motions"].sum()):
        motions = pluralize(undecided_motions, "motion is", "motions are")
        yield (
            f"{motions} undecided: a collapse ended the time histories before the limit was passed. A fit takes them "
            "to be like the others; from half of the motions on there is no curve."
        )


def list_references(resolved: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Yield the references of the way a study asks for fragility curves."""
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
