"""The tables of `pound fragility`: a curve for every limit, alone and with pounding, and what each motion said."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from pounding_cli.fragility import (
    Bands,
    Brackets,
    Curve,
    Fits,
    bands,
    cloud,
    cloud_draw,
    draw,
    fit,
    median_ratio,
    resamples,
)
from pounding_cli.fragility.hunt import found
from pounding_cli.store.answers import Column, Read, Table, place_columns
from pounding_cli.study.fragility import intensities, intensity_unit, question_of
from pounding_cli.study.fragility_rounds import Layout, by_level, demand_of_collapse, over_gap, over_limit
from pounding_cli.study.limits import COLLAPSE, CONTACT, Target

if TYPE_CHECKING:
    import pandas as pd

    from pounding_cli.numbers import Unit
    from pounding_cli.study import Plan
    from pounding_cli.study.fragility import Question

CURVES, MOTIONS = "fragility", "fragility_motions"
"""Names of the tables."""

ALONE = "0"
"""Ends the name of a column of the buildings alone."""

_ALONE = {"mu": "mu0", "drift": "drift0", "acceleration": "acceleration0"}


@dataclass(frozen=True, eq=False)
class Sample:
    """What one curve rests on; shapes (motions, levels).

    method : ida, stripes or cloud
    intensity : [SI]
    demand : over limit [-], above 1 where the limit is passed; NaN where the scene failed, was not asked for or ended
        with a collapse that leaves it unknown
    asked : whether the scene was
    ended : whether a collapse ended the scene
    """

    method: str
    intensity: np.ndarray
    demand: np.ndarray
    asked: np.ndarray
    ended: np.ndarray

    @property
    def failed(self) -> int:
        """Scenes that failed."""
        return int((self.asked & np.isnan(self.demand) & ~self.ended).sum())  # fault: failed-scenes-counted

    @property
    def undecided(self) -> int:
        """Scenes that did not fail and tell nothing of the limit: a collapse ended them first or, of a cloud, their
        demand has no logarithm."""
        known = self._drawable if self.method == "cloud" else ~np.isnan(self.demand)
        return int((self.asked & ~known).sum()) - self.failed

    @property
    def _drawable(self) -> np.ndarray:
        return np.isfinite(self.demand) & (self.demand > 0)

    def held_and_passed(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Of every motion the highest intensity below its first pass at which it holds (0: none), that of its first
        pass (inf: none), and whether it holds at a higher one again; shape (motions,)."""
        motions, levels = self.demand.shape
        held, passed, returns = np.zeros(motions), np.full(motions, np.inf), np.zeros(motions, bool)
        for motion in range(motions):
            known = found(dict(enumerate(self.demand[motion].tolist())), levels)
            if known.held >= 0:
                held[motion] = self.intensity[motion, known.held]
            if known.passed < levels:
                passed[motion] = self.intensity[motion, known.passed]
            returns[motion] = known.returns
        return held, passed, returns

    def brackets(self) -> Brackets:
        """The capacities: of `ida` one bracket a motion, of `stripes` one for every scene."""
        motions = len(self.demand)
        if self.method == "ida":
            held, passed, _ = self.held_and_passed()
            return Brackets.of(np.arange(motions), held, passed, motions)
        known = ~np.isnan(self.demand)  # fault: failed-scene-of-stripes
        above = self.demand[known] > 1
        x = self.intensity[known]
        return Brackets.of(
            np.nonzero(known)[0], np.where(above, 0.0, x), np.where(above, x, np.inf), motions
        )  # fmt: skip

    def curve(self) -> Curve:
        """The fit."""
        if self.method != "cloud":
            return fit(self.brackets())
        some = self._drawable
        return cloud(self.intensity[some], self.demand[some], 1.0, np.nonzero(some)[0]).curve

    def draws(self, times: np.ndarray) -> Fits:
        """The fits of a bootstrap; `times` : `resamples` of the motions."""
        if self.method != "cloud":
            return draw(self.brackets(), times)
        some = self._drawable
        return cloud_draw(self.intensity[some], self.demand[some], 1.0, np.nonzero(some)[0], times)


@dataclass(frozen=True, eq=False)
class Place:
    """Where a curve stands: point of the sweep without the intensity, case, analysis, target; numbers from 0."""

    point: int
    case: int
    analysis: int
    target: int


def fragility_tables(plan: Plan, read: Read) -> list[Table]:
    """The tables of a plan of `pound fragility`."""
    question = question_of(plan.study)
    layout = Layout.of(plan, question.axis)
    places, with_pounding, alone = [], [], []
    for place, one, other in _samples(plan, read, question, layout):
        places.append(place)
        with_pounding.append(one)
        alone.append(other)
    where = _where(plan, question, layout, places)
    return [
        Table(CURVES, [[*where, *_curves(plan, question, with_pounding, alone)]]),
        _motions(plan, question, where, with_pounding, alone),
    ]


def _samples(
    plan: Plan, read: Read, question: Question, layout: Layout
) -> Iterator[tuple[Place, Sample, Sample | None]]:
    """Every curve: with pounding, and alone (None: contact, which takes two)."""
    demands = _Demands(plan, read, question, layout)
    x, method = intensities(plan, question), question.spec.method
    is_asked = np.frompyfunc(plan.scenes.__contains__, 1, 1)
    asked, asked_alone = is_asked(layout.linked).astype(bool), is_asked(layout.alone).astype(bool)
    for point, case, analysis in np.ndindex(*asked.shape[:3]):
        for number, target in enumerate(question.targets):
            with_pounding, free = demands.of(target, point, case, analysis)
            alone = None
            if free is not None:
                mine = asked_alone[point, analysis, :, :, target.building]
                alone = Sample(method, x[point], free.demand, mine, free.ended)
            here = asked[point, case, analysis]
            one = Sample(method, x[point], with_pounding.demand, here, with_pounding.ended)
            yield Place(point, case, analysis, number), one, alone


class _Demand(NamedTuple):
    """Demand over limit, and whether a collapse ended the scene; shapes (motions, levels)."""

    demand: np.ndarray
    ended: np.ndarray


class _Demands:
    """Demand over limit, read from the tables of the file."""

    def __init__(self, plan: Plan, read: Read, question: Question, layout: Layout) -> None:
        self.plan, self.read, self.question, self.layout = plan, read, question, layout
        self._read: dict[str, np.ndarray] = {}

    def of(self, target: Target, point: int, case: int, analysis: int) -> tuple[_Demand, _Demand | None]:
        """With pounding and alone; None alone: contact, which takes two."""
        limit, building = target.limit, target.building
        storeys = [self._levels(name)[point, case, analysis] for name in ("collapsed", "collapsed0")]
        fell = (storeys[0] > 0).any(axis=-1)
        if limit.quantity == CONTACT:
            links = self.layout.links[point, case]
            mine = [self._link(link.place) for link in links if link.left == building]
            gaps = np.array([link.gap for link in links if link.left == building])
            closing = self._levels("max_closing")[point, case, analysis] if mine else np.zeros((*self._shape(), 0))
            return _Demand(over_gap(closing[..., mine], gaps), fell), None
        height = self.plan.study.building(self.layout.points[point], building).height
        both: list[_Demand] = []
        quantity = "drift" if limit.quantity == COLLAPSE else limit.quantity
        for name, storey in zip((quantity, _ALONE[quantity]), storeys, strict=True):
            peaks = self._levels(name)[point, case, analysis, ..., building, : len(height)]
            demand = 0.0 * peaks[..., 0] if limit.quantity == COLLAPSE else over_limit(limit, peaks, height)
            own = storey[..., building] > 0
            ended = own if both else fell
            # fault: demand-over-a-collapse
            both.append(_Demand(np.where(ended, demand_of_collapse(limit, own), demand), ended))
        return both[0], both[1]

    def _levels(self, name: str) -> np.ndarray:
        if name not in self._read:
            axis, axes = self.question.axis, self.plan.axes
            self._read[name] = by_level(self.read(name), len(axes), axis, self.layout.order)
        return self._read[name]

    def _shape(self) -> tuple[int, ...]:
        return self.layout.linked.shape[3:]

    def _link(self, place: Any) -> int:
        if not hasattr(self, "_places"):
            self._places = {
                each: number
                for number, each in enumerate(sorted({link.place for row in self.plan.rows for link in row.links}))
            }
        return self._places[place]


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
        # fault: paired-by-motion
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
        "undecided": sample.undecided,
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
    "outcome": "what came of the fit",
    "median": "intensity at which half of the motions pass the limit",
    "spread": "logarithmic standard deviation of that intensity",
    "low": "the median is not below",
    "high": "the median is not above; inf where no end is known",
    "motions": "motions that the curve rests on",
    "scenes": "scenes asked for",
    "failed": "scenes that failed; they widen brackets and are counted neither as holding nor as passing",
    "undecided": "scenes that ended with a collapse before the limit was decided or, of a cloud, whose demand has no "
    "logarithm; counted neither as holding nor as passing",
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
        return Table(MOTIONS, [columns])
    columns.append(Column("intensity", np.concatenate([s.intensity.ravel() for s in with_pounding]), "", si, unit))
    for suffix, samples in (("", with_pounding), (ALONE, alone)):
        data = np.concatenate([(nothing if s is None else s.demand).ravel() for s in samples])
        columns.append(Column("demand" + suffix, data, "demand over limit; empty where the scene failed", "1"))
    return Table(MOTIONS, [columns])


def _si(unit: Unit) -> str:
    return unit.si or "1"


def _text(values: list[str]) -> np.ndarray:
    return np.array(values, dtype=object)


def fits_of(rows: pd.DataFrame, suffix: str, method: str, times: np.ndarray) -> Fits:
    """The fits of the bootstrap of one curve, from its rows in the table of motions.

    suffix : ALONE or ""; times : `resamples` of as many motions
    """
    motion, _ = motion_numbers(rows)
    if method == "ida":
        held, passed = rows["held" + suffix].to_numpy(), rows["passed" + suffix].to_numpy()
        return draw(Brackets.of(motion, held, passed, times.shape[1]), times)
    demand, x = rows["demand" + suffix].to_numpy(), rows["intensity"].to_numpy()
    if method == "stripes":
        known = ~np.isnan(demand)
        above = demand[known] > 1
        low, high = np.where(above, 0.0, x[known]), np.where(above, x[known], np.inf)
        return draw(Brackets.of(motion[known], low, high, times.shape[1]), times)
    some = np.isfinite(demand) & (demand > 0)
    return cloud_draw(x[some], demand[some], 1.0, motion[some], times)


def motion_numbers(rows: pd.DataFrame) -> tuple[np.ndarray, int]:
    """The number of the motion of every row of one curve, and how many motions there are."""
    names = list(dict.fromkeys(rows["record"]))
    return rows["record"].map({name: number for number, name in enumerate(names)}).to_numpy(), len(names)
