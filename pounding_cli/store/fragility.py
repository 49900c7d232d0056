"""The tables of `pound fragility`: a curve for every limit, alone and with pounding, and what each motion said."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli.fragility import Bands, Fits, bands, median_ratio, resamples
from pounding_cli.fragility.hunt import UNDECIDED
from pounding_cli.store.answers import Column, Read, Table, place_columns
from pounding_cli.study.fragility import intensity_unit, question_of
from pounding_cli.study.fragility_rounds import Layout, Responses

if TYPE_CHECKING:
    from pounding_cli.numbers import Unit
    from pounding_cli.study import Plan
    from pounding_cli.study.fragility import Question

from pounding_cli.store.fragility_samples import ALONE, Place, Sample, samples_of

CURVES, MOTIONS = "fragility", "fragility_motions"
"""Names of the tables."""


def fragility_tables(plan: Plan, read: Read, responses: Responses) -> list[Table]:
    """The tables of a plan of `pound fragility`."""
    question = question_of(plan.study)
    layout = Layout.of(plan, question.axis)
    places, with_pounding, alone = [], [], []
    for place, one, other in samples_of(plan, responses, question, layout):
        places.append(place)
        with_pounding.append(one)
        alone.append(other)
    where = _where(plan, question, layout, places)
    return [
        Table(CURVES, [[*where, *_curves(plan, question, with_pounding, alone)]]),
        _motions(plan, question, where, with_pounding, alone),
    ]


def _where(plan: Plan, question: Question, layout: Layout, places: list[Place]) -> list[Column]:
    """The columns that say where a curve stands."""
    columns = place_columns(plan.axes, [layout.points[place.point] for place in places])
    if question.axis is not None:
        intensity = plan.axes[question.axis].names[0]
        columns = [column for column in columns if column.name != intensity]
    texts = {
        "case": ([plan.cases[place.case] for place in places], "case of the study"),
        "analysis": ([plan.analyses[place.analysis] for place in places], "elastic or inelastic storeys"),
        "limit": ([str(question.targets[place.target].limit) for place in places], "what is passed"),
        "building": (
            [question.targets[place.target].label(plan.buildings) for place in places],
            "building that passes it, or the pair in contact",
        ),
    }
    return [*columns, *(Column(name, _text(values), meaning) for name, (values, meaning) in texts.items())]


def _curves(plan: Plan, question: Question, with_pounding: list[Sample], alone: list[Sample | None]) -> list[Column]:
    """The columns of fits."""
    spec, unit = question.spec, intensity_unit(plan, question)
    times = resamples(len(plan.records), spec.draws)
    rows: list[dict[str, Any]] = []
    for sample, free in zip(with_pounding, alone, strict=True):
        row, draws = _fitted(sample, times, spec.confidence)
        row_alone, draws_alone = ({}, None) if free is None else _fitted(free, times, spec.confidence)
        row |= {name + ALONE: value for name, value in row_alone.items()}
        if draws_alone is not None and row["median"] == row["median"] and row_alone["median"] == row_alone["median"]:
            row["ratio"] = row["median"] / row_alone["median"]
            row["ratio_low"], row["ratio_high"] = median_ratio(draws_alone, draws, spec.confidence)
        rows.append(row)
    return list(_columns(rows, spec.confidence, unit))


def _fitted(sample: Sample, times: np.ndarray, confidence: float) -> tuple[dict[str, Any], Fits]:
    """The columns of one curve, and the fits of its draws."""
    curve, draws = sample.curve(), sample.draws(times)
    row: dict[str, Any] = {
        "outcome": str(curve.outcome),
        "low": curve.between[0],
        "high": curve.between[1],
        "motions": curve.motions,
        "scenes": int(sample.asked.sum()),
        "failed": sample.failed,
        "undecided": int(sample.undecided.sum()),
        "undecided_motions": sample.undecided_motions,
    }
    if sample.method == "ida":
        row["returns"] = int(sample.held_and_passed()[2].sum())
    if curve.median is None or curve.spread is None:
        return row | {"median": np.nan}, draws
    band: Bands = bands(draws, np.ones(1), confidence)
    row |= {"median": curve.median, "median_low": band.median[0], "median_high": band.median[1]}
    row |= {"spread": curve.spread, "spread_low": band.spread[0], "spread_high": band.spread[1]}
    return row | {"unfitted": band.unfitted}, draws


_MEANINGS = {
    "outcome": "outcome of the fit",
    "median": "intensity at which half of the motions pass the limit",
    "spread": "logarithmic standard deviation of that intensity",
    "low": "the median is not below",
    "high": "the median is not above; inf where no end is known",
    "motions": "motions of the curve",
    "scenes": "scenes asked for",
    "failed": "scenes that failed; they widen brackets and are counted neither as holding nor as passing",
    "undecided": "scenes that a collapse ended before the limit was passed or, of a cloud, whose demand is not known "
    "or has no logarithm; counted neither as holding nor as passing",
    "undecided_motions": "motions not known to pass, nor to hold at the highest intensities, since a collapse ended "
    "their scenes; from half of the motions on there is no curve",
    "returns": "motions that hold at an intensity above their first pass",
    "unfitted": "draws of the bootstrap without a fit; they count with what a fit would tend to",
    "ratio": "median with pounding over median alone",
}
_INTENSITIES = ("median", "low", "high")
_WITH_INTERVAL = ("median", "spread", "ratio")


def _columns(rows: list[dict[str, Any]], confidence: float, unit: Unit) -> Iterator[Column]:
    order = [
        name + end + alone
        for alone in ("", ALONE)
        for name in _MEANINGS
        for end in (("", "_low", "_high") if name in _WITH_INTERVAL else ("",))
        if not (name == "ratio" and alone)
    ]
    for name in order:
        base = name.removesuffix(ALONE)
        stem = base.removesuffix("_low").removesuffix("_high")
        meaning = _MEANINGS[stem]
        if base != stem:
            end = "low" if base.endswith("_low") else "high"
            meaning = f"{end} end of the {confidence:.4g} bootstrap interval: {meaning}"
        if name != base:
            meaning += ", buildings alone"
        is_intensity = stem in _INTENSITIES
        if stem == "outcome":
            yield Column(name, _text([row.get(name, "") for row in rows]), meaning)
        else:
            values = np.array([row.get(name, np.nan) for row in rows], dtype=float)
            yield Column(
                name, values, meaning, (unit.si or "1") if is_intensity else "1", unit if is_intensity else None
            )


def _motions(
    plan: Plan, question: Question, where: list[Column], with_pounding: list[Sample], alone: list[Sample | None]
) -> Table:
    """What each motion said: of `ida` the bracket of its capacity, otherwise its demand at each intensity."""
    motions, levels = with_pounding[0].demand.shape
    per_curve = motions if question.spec.method == "ida" else motions * levels
    names = np.repeat(np.array(plan.records, dtype=object), per_curve // motions)
    columns = [Column(each.name, np.repeat(each.data, per_curve), each.text, each.unit, each.shown) for each in where]
    columns.append(Column("record", np.tile(names, len(with_pounding)), "ground motion"))
    unit = intensity_unit(plan, question)
    si = _si(unit)
    nothing = np.full((motions, levels), np.nan)
    if question.spec.method == "ida":
        for suffix, samples in (("", with_pounding), (ALONE, alone)):
            pairs = [
                (np.full(motions, np.nan),) * 2 if sample is None else sample.held_and_passed()[:2]
                for sample in samples
            ]
            words = ", building alone" if suffix else ""
            for name, column, meaning in (
                ("held", 0, "highest intensity below `passed` at which the motion holds; 0 where there is none"),
                ("passed", 1, "lowest intensity at which the motion passes the limit; inf where there is none"),
            ):
                data = np.concatenate([pair[column] for pair in pairs])
                columns.append(Column(name + suffix, data, meaning + words, si, unit))
            none = np.full(motions, np.nan)
            lost = [none if sample is None else sample.undecided.sum(axis=1) for sample in samples]
            what = "scenes that a collapse ended before the limit was passed"
            columns.append(Column("undecided" + suffix, np.concatenate(lost).astype(float), what + words, "1"))
        return Table(MOTIONS, [columns])
    columns.append(Column("intensity", np.concatenate([s.intensity.ravel() for s in with_pounding]), "", si, unit))
    for suffix, samples in (("", with_pounding), (ALONE, alone)):
        data = np.concatenate([(nothing if s is None else s.demand).ravel() for s in samples])
        lost = data == UNDECIDED
        what = (
            "demand over limit; inf where a collapse ended the scene after the limit was passed; empty where one did "
            "before, and where the scene failed"
        )
        columns.append(Column("demand" + suffix, np.where(lost, np.nan, data), what, "1"))
        what = "1 where a collapse ended the scene before the limit was passed"
        columns.append(Column("undecided" + suffix, lost.astype(float), what, "1"))
    return Table(MOTIONS, [columns])


def _si(unit: Unit) -> str:
    return unit.si or "1"


def _text(values: list[str]) -> np.ndarray:
    return np.array(values, dtype=object)
