"""`pound fragility`: a curve for every limit, alone and with pounding, and what each motion said."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from pounding_cli.results.tables import Filled, Table, column, place_columns
from pounding_cli.study import Plan, Study, expand
from pounding_cli.study.expression import COLLAPSE, CONTACT, SHEAR_DEMAND, TAKES_NEIGHBOUR, Limit, Target
from pounding_cli.workflows import curves
from pounding_cli.workflows.curves import Brackets, Curve, Fits, Outcome
from pounding_cli.workflows.fragility_question import Question, intensities, intensity_unit, question_of, takes_blow
from pounding_cli.workflows.hunt import UNDECIDED, found, next_levels
from pounding_cli.workflows.workflow import Found, Workflow

if TYPE_CHECKING:
    import pandas as pd

    from pounding_cli.batch.solve import Solver
    from pounding_cli.results.solved import Solved

CURVES, MOTIONS = "fragility", "fragility_motions"
"""Names of the tables."""

ALONE = "0"
"""Ends the name of a column of the buildings alone."""

_PEAKS = {"mu": "building.ductility", "drift": "building.drift", "acceleration": "building.acceleration"}
"""What a limit looks at, as responses call it."""


class Fragility(Workflow):
    """How likely every limit is passed at an intensity, alone and with pounding."""

    name = "fragility"

    def check(self, study: Study) -> Question:
        """What a study asks.  Raises InputError, see `question_of`."""
        return question_of(study)

    def plan(self, study: Study) -> Plan:
        """The scenes of every motion at every intensity, of which `ida` solves some."""
        self.check(study)
        return dataclasses.replace(expand(study), workflow="fragility")

    def first(self, plan: Plan) -> np.ndarray:
        """Of `ida` the lowest intensity of every motion."""
        question = question_of(plan.study)
        if question.spec.method != "ida":
            return super().first(plan)
        return np.unique([series.scenes[0] for series in _series(Layout.of(plan, question.axis), question.targets)])

    def goes_on(self, study: Study) -> bool:
        """Whether it is `ida`."""
        return bool(study.model.fragility.method == "ida")

    def run(self, study: Study, solver: Solver) -> Found:
        """The curves, and what every motion said."""
        question, plan = question_of(study), self.plan(study)
        layout = Layout.of(plan, question.axis)
        asked = _hunted(plan, question, layout, solver) if question.spec.method == "ida" else np.arange(len(plan))
        samples = list(_samples(plan, solver.responses(plan, asked), question, layout))
        where = _where(plan, question, layout, samples)
        curves = Table.of(CURVES, [*where, *_curve_columns(plan, question, samples)])
        motions = Table.of(MOTIONS, _motion_columns(plan, question, where, samples))
        return Found(plan, solver.dataset(plan, asked), [curves, motions])


ASKED = Fragility()


@dataclass(frozen=True, eq=False)
class Layout:
    """Where the scenes of a plan stand, the intensity apart from the other swept axes.

    intensity : of the levels as the study says it, rising, shape (levels,)
    points : of the other axes, an index on every axis, 0 on that of the intensity
    linked : numbers of the scenes, shape (points, cases, analyses, motions, levels)
    alone : numbers of the baselines, shape (points, analyses, motions, levels, buildings)
    """

    intensity: np.ndarray
    points: list[tuple[int, ...]]
    linked: np.ndarray
    alone: np.ndarray

    @classmethod
    def of(cls, plan: Plan, axis: int | None) -> Layout:
        """The layout of a plan; `axis` : number of the axis of the intensity; None: there is one level."""
        values = [1.0] if axis is None else [float(value) for (value,) in plan.axes[axis].values]
        order, swept = np.argsort(values), [len(each.values) for each in plan.axes]
        if axis is None:
            numbers = plan.numbers[..., None, :]
        else:
            numbers = np.moveaxis(np.take(plan.numbers, order, axis), axis, -2)
            swept[axis] = 1
        numbers = numbers.reshape(-1, *numbers.shape[-5:])
        return cls(np.array(values)[order], list(np.ndindex(*swept)), numbers[..., 0], numbers[:, 0, ..., 1:])


# Which scenes are solved


class _Series(NamedTuple):
    """The scenes of one motion over the levels, and the targets that they tell of.

    scenes : numbers, shape (levels,); is_alone : whether they are of one building alone
    """

    scenes: np.ndarray
    point: int
    case: int
    is_alone: bool
    targets: tuple[Target, ...]


def _series(layout: Layout, targets: Sequence[Target]) -> Iterator[_Series]:
    """Every motion with pounding, and every building alone once."""
    known: set[int] = set()
    for point, case, analysis, motion in np.ndindex(*layout.linked.shape[:-1]):
        yield _Series(layout.linked[point, case, analysis, motion], point, case, False, tuple(targets))
        for building in range(layout.alone.shape[-1]):
            mine = tuple(t for t in targets if t.building == building and t.limit.quantity not in TAKES_NEIGHBOUR)
            scenes = layout.alone[point, analysis, motion, :, building]
            if mine and int(scenes[0]) not in known:  # cases and points share it
                known.add(int(scenes[0]))
                yield _Series(scenes, point, case, True, mine)


def _hunted(plan: Plan, question: Question, layout: Layout, solver: Solver) -> np.ndarray:
    """Incremental dynamic analysis: the scenes that bracket where every motion passes each limit (`hunt`).

    The next levels of all motions are solved together, so that workers are busy.
    """
    series = list(_series(layout, question.targets))
    seen: list[dict[Target, dict[int, float]]] = [{target: {} for target in each.targets} for each in series]
    wanted = {number: {0} for number in range(len(series))}
    asked: list[np.ndarray] = []
    while wanted:
        asked.append(np.array([series[number].scenes[level] for number, levels in wanted.items() for level in levels]))
        solved = solver.responses(plan, asked[-1])
        following: dict[int, set[int]] = {}
        for number, levels in wanted.items():
            each, some = series[number], sorted(levels)
            more: set[int] = set()
            for target, told in seen[number].items():
                demand = _demand(plan, solved, target, each.scenes[some], layout.points[each.point], each.case,
                                 each.is_alone)  # fmt: skip
                told |= dict(zip(some, demand.tolist(), strict=True))
                more |= next_levels(layout.intensity, told, question.spec.fill)
            if more:
                following[number] = more
        wanted = following
    return np.unique(np.concatenate(asked))


# What scenes say of a limit


def _demand(
    plan: Plan, solved: Solved, target: Target, scenes: np.ndarray, point: tuple[int, ...], case: int, is_alone: bool
) -> np.ndarray:
    """Demand over limit [-], above 1 where the limit is passed; inf where a collapse ended the scene after that,
    UNDECIDED where it did before; NaN where the scene failed or was not asked for.  Shape of `scenes`.

    Passed are limits that were passed before a scene ended, the collapse itself, and limits on the drift or the
    ductility of the storey that collapsed: its drift has no bound.

    scenes : numbers of scenes of one point and case; is_alone : of the target's building alone
    """
    limit, values = target.limit, solved.values
    place = 0 if is_alone else target.building
    reached = _reached(plan, solved, target, scenes, point, case, place)
    storey = np.nan_to_num(values["collapse_storey"][scenes]).astype(int)
    own = np.where(values["collapse_building"][scenes] == place, storey, 0)
    falls = own > 0 if limit.quantity == COLLAPSE or not limit.level else own == limit.level
    passed = (reached > 1) | (falls & (limit.quantity in ("mu", "drift", COLLAPSE)))
    demand = np.where(storey > 0, np.where(passed, np.inf, UNDECIDED), reached)
    return np.where(solved.ended[scenes], demand, np.nan)


def _reached(
    plan: Plan, solved: Solved, target: Target, scenes: np.ndarray, point: tuple[int, ...], case: int, place: int
) -> np.ndarray:
    """Demand over limit by the largest values of scenes, whatever ended them; 0 of collapse."""
    limit, values, links = target.limit, solved.values, plan.links
    if limit.quantity == COLLAPSE:
        return np.zeros(scenes.shape)
    there = links.kind[(*point, case)] != ""
    if limit.quantity == CONTACT:
        mine = [k for k, each in enumerate(links.places) if there[k] and each[0] == target.building]
        return _over_gap(values["link.max_closing"][scenes][..., mine], links.gap[(*point, case)][mine])
    building = plan.study.building(point, target.building)
    if limit.quantity == SHEAR_DEMAND:
        struck = [k for k in takes_blow(target, links.places, building.yield_shear) if there[k]]
        demand = values["columns.demand"][scenes][..., struck]
        return np.fmax.reduce(demand, axis=-1) / limit.value if struck else np.zeros(scenes.shape)
    return _over_limit(limit, values[_PEAKS[limit.quantity]][scenes, place, : building.storeys], building.height)


def _over_limit(limit: Limit, peaks: np.ndarray, height: np.ndarray) -> np.ndarray:
    """Demand over limit of peaks of storeys or floors, shape (..., storeys) as `height` [m]; of the worst of them."""
    parts = peaks / (limit.value * height if limit.of_height else limit.value)
    return parts[..., limit.level - 1] if limit.level else np.fmax.reduce(parts, axis=-1)


def _over_gap(closing: np.ndarray, gap: np.ndarray) -> np.ndarray:
    """Largest closing over gap [-], above 1 where a gap closes; 0 without links, NaN where no closing is known.

    closing, gap : of every link, shape (..., links) [m]
    """
    if not closing.shape[-1]:
        return np.zeros(closing.shape[:-1])
    at_once = np.where(closing > 0, np.inf, np.where(np.isnan(closing), np.nan, 0.0))  # floors in touch
    parts = np.divide(closing, gap, out=at_once, where=np.broadcast_to(gap > 0, closing.shape))
    return np.fmax.reduce(parts, axis=-1)


# What a curve rests on


@dataclass(frozen=True, eq=False)
class Sample:
    """What one curve rests on; shapes (motions, levels).

    method : ida, stripes or cloud
    intensity : [SI]
    demand : over limit [-], above 1 where the limit is passed; inf where a collapse ended the scene after that,
        UNDECIDED where it did before; NaN where the scene failed or was not asked for
    asked : whether the scene was
    """

    method: str
    intensity: np.ndarray
    demand: np.ndarray
    asked: np.ndarray

    @property
    def failed(self) -> int:
        """Scenes that failed."""
        return int((self.asked & np.isnan(self.demand)).sum())

    @property
    def undecided(self) -> np.ndarray:
        """Scenes that did not fail and tell nothing of the limit: a collapse ended them before it was passed or, of a
        cloud, their demand is not known to its end or has no logarithm; shape (motions, levels)."""
        if self.method == "cloud":
            return self.asked & ~np.isnan(self.demand) & ~_drawable(self.demand)
        return self.demand == UNDECIDED

    @property
    def undecided_motions(self) -> int:
        """Motions not known to pass, nor to hold at the highest intensities, since a collapse ended their scenes there;
        of a cloud motions that have no point because of that."""
        undecided = self.demand == UNDECIDED
        if self.method == "cloud":
            return int((undecided.any(axis=1) & ~_drawable(self.demand).any(axis=1)).sum())
        levels = np.arange(1, self.demand.shape[1] + 1)
        held = np.where((self.demand <= 1) & ~undecided, levels, 0).max(axis=1)
        lost = np.where(undecided, levels, 0).max(axis=1)
        return int(((lost > held) & ~(self.demand > 1).any(axis=1)).sum())

    def held_and_passed(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Of every motion the highest intensity below its first pass at which it holds (0: none), that of its first
        pass (inf: none), and whether it holds at a higher one again; shape (motions,)."""
        motions, levels = self.demand.shape
        held, passed, returns = np.zeros(motions), np.full(motions, np.inf), np.zeros(motions, bool)
        for motion, demand in enumerate(self.demand.tolist()):
            known = found(dict(enumerate(demand)), levels)
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
        known = np.where(self.undecided, np.nan, self.demand)
        return _of_scenes(_motion_of(self.demand), self.intensity.ravel(), known.ravel(), motions)

    def curve(self) -> Curve:
        """The fit; none where half of the motions or more are undecided."""
        motions = len(self.demand)
        if 2 * self.undecided_motions >= motions:
            return Curve(Outcome.UNDECIDED, motions, None, None, self._middle())
        if self.method != "cloud":
            return curves.fit(self.brackets())
        some = _drawable(self.demand)
        if 2 * some.any(axis=1).sum() <= motions:  # the others collapsed: a line through the rest would mislead
            return Curve(Outcome.FEW, motions, None, None, (0.0, np.inf))
        return curves.fit_cloud(self.intensity[some], self.demand[some], np.nonzero(some)[0])

    def _middle(self) -> tuple[float, float]:
        """Intensities between which half of the motions pass, whatever the undecided ones would do."""
        if self.method == "cloud":
            return 0.0, np.inf
        held, passed, _ = self.held_and_passed()
        half = len(held) // 2
        return float(np.sort(held)[len(held) - 1 - half]), float(np.sort(passed)[half])

    def draws(self, times: np.ndarray) -> Fits:
        """The fits of a bootstrap; `times` : `resamples` of the motions."""
        if self.method != "cloud":
            return curves.draw(self.brackets(), times)
        return _cloud_draws(_motion_of(self.demand), self.intensity.ravel(), self.demand.ravel(), times)


def _drawable(demand: np.ndarray) -> np.ndarray:
    """Which demands a cloud can show."""
    return np.isfinite(demand) & (demand > 0)


def _motion_of(demand: np.ndarray) -> np.ndarray:
    """The numbers of the motions of demands (motions, levels), flat."""
    return np.repeat(np.arange(len(demand)), demand.shape[1])


def _of_scenes(motion: np.ndarray, intensity: np.ndarray, demand: np.ndarray, motions: int) -> Brackets:
    """The capacities by single scenes; NaN tells nothing."""
    known = ~np.isnan(demand)
    above, x = demand[known] > 1, intensity[known]
    return Brackets.of(motion[known], np.where(above, 0.0, x), np.where(above, x, np.inf), motions)


def _cloud_draws(motion: np.ndarray, intensity: np.ndarray, demand: np.ndarray, times: np.ndarray) -> Fits:
    some = _drawable(demand)
    return curves.draw_cloud(intensity[some], demand[some], motion[some], times)


def fits_of(rows: pd.DataFrame, suffix: str, method: str, times: np.ndarray) -> Fits:
    """The fits of the bootstrap of one curve, from its rows in the table of motions.

    suffix : ALONE or ""; times : `resamples` of as many motions
    """
    motion, motions = motion_numbers(rows)
    if method == "ida":
        held, passed = rows["held" + suffix].to_numpy(), rows["passed" + suffix].to_numpy()
        return curves.draw(Brackets.of(motion, held, passed, motions), times)
    intensity, demand = rows["intensity"].to_numpy(), rows["demand" + suffix].to_numpy()
    if method == "stripes":
        return curves.draw(_of_scenes(motion, intensity, demand, motions), times)
    return _cloud_draws(motion, intensity, demand, times)


def motion_numbers(rows: pd.DataFrame) -> tuple[np.ndarray, int]:
    """The number of the motion of every row of one curve, and how many motions there are."""
    names = list(dict.fromkeys(rows["record"]))
    return rows["record"].map({name: number for number, name in enumerate(names)}).to_numpy(), len(names)


class _Samples(NamedTuple):
    """What a curve rests on with pounding, and alone (None: what takes a neighbour), and where it stands: point of the
    sweep without the intensity, case, analysis, by number from 0."""

    point: int
    case: int
    analysis: int
    target: Target
    linked: Sample
    alone: Sample | None


def _samples(plan: Plan, solved: Solved, question: Question, layout: Layout) -> Iterator[_Samples]:
    """Of every curve."""
    x, method = intensities(plan, question), question.spec.method
    for at in np.ndindex(layout.linked.shape[:3]):
        point, case, analysis = at

        def of(target: Target, scenes: np.ndarray, is_alone: bool, point: int = point, case: int = case) -> Sample:
            demand = _demand(plan, solved, target, scenes, layout.points[point], case, is_alone)
            return Sample(method, x[point], demand, solved.there[scenes])

        for target in question.targets:
            alone = None
            if target.limit.quantity not in TAKES_NEIGHBOUR:
                alone = of(target, layout.alone[point, analysis, ..., target.building], True)
            yield _Samples(point, case, analysis, target, of(target, layout.linked[at], False), alone)


# The tables


def _where(plan: Plan, question: Question, layout: Layout, samples: Sequence[_Samples]) -> list[Filled]:
    """The columns that say where a curve stands."""
    columns = place_columns(plan.axes, [layout.points[each.point] for each in samples])
    if question.axis is not None:
        columns = [each for each in columns if each.name != plan.axes[question.axis].names[0]]
    texts = {
        "case": ([plan.cases[each.case] for each in samples], "case of the study"),
        "analysis": ([plan.analyses[each.analysis] for each in samples], "elastic or inelastic storeys"),
        "limit": ([str(each.target.limit) for each in samples], "what is passed"),
        "building": (
            [each.target.label(plan.buildings) for each in samples],
            "building that passes it, or the pair in contact",
        ),
    }
    return [*columns, *(column(name, np.array(values, object), text) for name, (values, text) in texts.items())]


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


def _curve_columns(plan: Plan, question: Question, samples: Sequence[_Samples]) -> Iterator[Filled]:
    """The columns of fits."""
    spec, unit = question.spec, intensity_unit(plan, question)
    times = curves.resamples(len(plan.records), spec.draws)
    rows: list[dict[str, Any]] = []
    for each in samples:
        row, draws = _fitted(each.linked, times, spec.confidence)
        if each.alone is not None:
            alone, draws_alone = _fitted(each.alone, times, spec.confidence)
            row |= {name + ALONE: value for name, value in alone.items()}
            if "median" in row and "median" in alone:
                row["ratio"] = row["median"] / alone["median"]
                row["ratio_low"], row["ratio_high"] = curves.median_ratio(draws_alone, draws, spec.confidence)
        rows.append(row)
    for suffix in ("", ALONE):
        for stem, text in _MEANINGS.items():
            if stem == "ratio" and suffix:
                continue
            for end in ("", "_low", "_high") if stem in _WITH_INTERVAL else ("",):
                name = stem + end + suffix
                meaning = f"{end[1:]} end of the {spec.confidence:.4g} bootstrap interval: {text}" if end else text
                meaning += ", buildings alone" if suffix else ""
                if stem == "outcome":
                    yield column(name, np.array([row.get(name, "") for row in rows], object), meaning)
                    continue
                values = np.array([row.get(name, np.nan) for row in rows], dtype=float)
                is_intensity = stem in _INTENSITIES
                yield (
                    column(name, values, meaning, unit.si or "1", unit)
                    if is_intensity
                    else column(name, values, meaning, "1")
                )


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
    if curve.median is None:
        return row, draws
    band = curves.bands(draws, np.ones(1), confidence)
    row |= {"median": curve.median, "median_low": band.median[0], "median_high": band.median[1]}
    row |= {"spread": curve.spread, "spread_low": band.spread[0], "spread_high": band.spread[1]}
    return row | {"unfitted": band.unfitted}, draws


def _motion_columns(
    plan: Plan, question: Question, where: Sequence[Filled], samples: Sequence[_Samples]
) -> list[Filled]:
    """What each motion said: of `ida` the bracket of its capacity, otherwise its demand at each intensity."""
    motions, levels = samples[0].linked.demand.shape
    is_ida, unit = question.spec.method == "ida", intensity_unit(plan, question)
    each = 1 if is_ida else levels  # rows of a motion
    columns = [of._replace(data=np.repeat(of.data, motions * each)) for of in where]
    names = np.repeat(np.array(plan.records, dtype=object), each)
    columns.append(column("record", np.tile(names, len(samples)), "ground motion"))
    if not is_ida:
        whole = np.concatenate([sample.linked.intensity.ravel() for sample in samples])
        columns.append(column("intensity", whole, "", unit.si or "1", unit))
    said = {
        "held": "highest intensity below `passed` at which the motion holds; 0 where there is none",
        "passed": "lowest intensity at which the motion passes the limit; inf where there is none",
        "undecided": "scenes that a collapse ended before the limit was passed",
    } if is_ida else {
        "demand": "demand over limit; inf where a collapse ended the scene after the limit was passed; empty where one "
        "did before, and where the scene failed",
        "undecided": "1 where a collapse ended the scene before the limit was passed",
    }  # fmt: skip
    for suffix, mine in (("", [sample.linked for sample in samples]), (ALONE, [sample.alone for sample in samples])):
        nothing = dict.fromkeys(said, np.full(motions * each, np.nan))
        if not is_ida:
            nothing["undecided"] = np.zeros(motions * each)
        told = [nothing if sample is None else _told(sample) for sample in mine]
        for name, text in said.items():
            values = np.concatenate([one[name] for one in told])
            shown = (unit.si or "1", unit) if name in ("held", "passed") else ("1", None)
            columns.append(column(name + suffix, values, text + ", building alone" * bool(suffix), *shown))
    return columns


def _told(sample: Sample) -> dict[str, np.ndarray]:
    """The columns of one curve in the table of motions."""
    lost = sample.demand == UNDECIDED
    if sample.method == "ida":
        held, passed, _ = sample.held_and_passed()
        return {"held": held, "passed": passed, "undecided": lost.sum(axis=1).astype(float)}
    return {"demand": np.where(lost, np.nan, sample.demand).ravel(), "undecided": lost.ravel().astype(float)}
