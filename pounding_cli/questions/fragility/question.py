"""`pound fragility`: how likely limits are passed at an intensity and how often a year, alone and with pounding."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli.model.archetypes import draw_factors
from pounding_cli.numbers import Unit
from pounding_cli.questions.fragility.demands import CurvePlace, find_demands
from pounding_cli.questions.fragility.hunt import expected_levels, next_levels
from pounding_cli.questions.fragility.spec import FragilitySpec
from pounding_cli.questions.fragility.targets import find_targets
from pounding_cli.questions.frames import ALONE, WITH_POUNDING
from pounding_cli.questions.hazard import SWEEP_EXAMPLE, build_hazard, find_intensity_axis, measure_motion
from pounding_cli.questions.neighbours import build_neighbour_axis, list_drawn
from pounding_cli.questions.question import Answer, StudyQuestion
from pounding_cli.questions.specs import Measure
from pounding_cli.study import Plan, Study, make_plan
from pounding_cli.study.construct.swept import Point
from pounding_cli.study.expressions.limits import LIMITS_OF_PAIRS, Target
from pounding_cli.study.schema.records import INTENSITY_KEYS

if TYPE_CHECKING:
    from pounding_cli.batch.solve import Solver


class Fragility(StudyQuestion):
    """The probability that every limit is passed at an intensity, alone and with pounding.

    Raises InputError: no limit, one that concerns no building of the group, an intensity that is not swept.

    neighbour_axis : number of the axis of what neighbours may be that are only seen; None where all are certain
    drawn : the buildings of the study that this axis varies
    axis : number of the swept axis that varies the intensity; None of a cloud without one
    swept : the measure that it varies; "" without one
    measure : the intensity measure of the curves; `swept` unless the study names another
    targets : limits with the buildings or pairs that they concern, in the order of the limits
    hazard : annual rate at which an intensity is exceeded; None where the study gives none
    """

    name = "fragility"
    spec: FragilitySpec

    def __init__(self, study: Study) -> None:
        super().__init__(study)
        neighbours = build_neighbour_axis(self)
        self.problems.check()
        self.neighbour_axis = None
        self.drawn = list_drawn(study)
        if neighbours is not None:
            self.neighbour_axis = len(study.axes)
            self.study = study.with_axes([*study.axes, neighbours])
        if self.spec.method == "ida":  # the results decide which time histories are solved
            self.extent = "has at most"
            self.refuse_histories("the time histories that `pound fragility` chooses")
        if not self.spec.limits:
            hint = "write e.g. `fragility: {limits: [mu > 4]}`"
            self.add_problem((), "the study has no limit, whose fragility could be sought", hint, key=True)
        self.targets = find_targets(self, self.spec.limits)
        self._set_intensity()
        self.problems.check()
        self.hazard = build_hazard(self, self.measure)

    def _set_intensity(self) -> None:
        """Find the axis of the intensity and the measure of the curves; add what is wrong with them to the problems."""
        is_cloud = self.spec.method == "cloud"
        axes = self.study.axes
        self.axis = find_intensity_axis(self, axes, min_intensities=1 if is_cloud else 2)
        self.swept = "" if self.axis is None else INTENSITY_KEYS.get(axes[self.axis].names[0], "")
        if self.axis is None and not is_cloud:
            hint = f"{SWEEP_EXAMPLE}, or `method: cloud` for motions as they are"
            self.add_problem(("intensity",), "the intensity is not swept", hint, key=self.spec.intensity is None)
        self.measure = self.spec.intensity or Measure(self.swept or "pga")
        if self.measure == Measure("ag") and self.swept != "ag":
            hint = "write e.g. `sweep: {records.scale.target.ag: {from: 0.05 g, to: 0.6 g, step: 0.05 g}}`"
            self.add_problem(("intensity",), "ag of the target spectrum is not swept", hint)
        has_period = self.measure != Measure("sa") or self.swept == "sa"
        if not has_period and (self.axis is not None or is_cloud):
            self.add_problem(("intensity",), "sa is not swept and has no period", "write e.g. `intensity: sa(0.5 s)`")

    @cached_property
    def plan(self) -> Plan:
        """The time histories of every motion at every intensity, of which `ida` solves some."""
        return make_plan(self.study)

    @property
    def expected_count(self) -> int:
        """Number of time histories of the whole question.

        Of `ida` it is that of demands in proportion to the intensity, with limits passed all over the levels.
        """
        if self.spec.method != "ida":
            return len(self.plan)
        numbers: set[int] = set()
        for place in self._iter_places():
            share = (1 + self.targets.index(place.target)) / (1 + len(self.targets))
            capacity = float(np.quantile(self.levels, share))
            levels = expected_levels(self.levels, capacity, self.spec.fill)
            for histories in place.histories.values():
                numbers.update(histories[:, levels].ravel().tolist())
        return len(numbers - {-1})

    @property
    def levels(self) -> np.ndarray:
        """The swept intensities, rising; 1 of motions as they are."""
        values = [(1.0,)] if self.axis is None else self.plan.axes[self.axis].values
        return np.sort([float(value) for (value,) in values])

    @cached_property
    def points(self) -> list[Point]:
        """The points of the sweep, the intensity set aside: index on every axis, 0 on the intensity's."""
        axes = enumerate(self.plan.axes)
        return list(np.ndindex(*(1 if number == self.axis else len(axis) for number, axis in axes)))

    @cached_property
    def intensities(self) -> np.ndarray:
        """The intensity of every motion at every level, rising, in SI; shape (points, motions, levels).

        Every way to scale is in proportion to its value, so a motion is measured once.
        """
        shape = (len(self.points), len(self.plan.records), self.levels.size)
        levels = np.broadcast_to(self.levels, shape)
        if self.measure == Measure(self.swept):
            return levels
        by_suite: dict[Point, list[float]] = {}
        suite_axes = self.study.parts.suite.axes
        suites = [tuple(point[axis] for axis in suite_axes) for point in self.points]
        for suite, point in zip(suites, self.points, strict=True):
            if suite not in by_suite:
                by_suite[suite] = self._measure_motions(point)
        measured_at = 1.0 if self.axis is None else float(self.plan.axes[self.axis].values[0][0])
        return np.array([by_suite[suite] for suite in suites])[..., None] * levels / measured_at

    def _measure_motions(self, point: Point) -> list[float]:
        """Return the intensities of all motions at a point, in SI."""
        uses = self.study.motion_uses(point)
        return [measure_motion(uses[name], self.study.motion(point, name), self.measure) for name in self.plan.records]

    @property
    def unit(self) -> Unit:
        """The unit that people read intensities in."""
        name = self.measure.name
        if self.axis is not None and name == self.swept:
            return self.plan.axes[self.axis].units[0]
        return {"factor": Unit(), "pgv": Unit("m/s", 1.0, "m/s")}.get(name) or self.study.unit("acceleration")

    def answer(self, solver: Solver) -> Answer:
        """Return the curves, the capacities or demands of all motions and, with a hazard curve, annual rates."""
        from pounding_cli.questions.fragility.answer import build_tables  # with pandas and SciPy

        places = list(self._iter_places())
        asked = self._hunt(places, solver) if self.spec.method == "ida" else np.arange(len(self.plan))
        solved = solver.solve_plan(self.plan, asked)
        return Answer(self.plan, solver.solve_arrays(self.plan, asked), build_tables(self, places, solved))

    def _iter_places(self) -> Iterator[CurvePlace]:
        """Yield the place of every curve with its time histories."""
        numbers = self.plan.numbers[..., None, :]
        if self.axis is not None:
            order = np.argsort([float(value) for (value,) in self.plan.axes[self.axis].values])
            numbers = np.moveaxis(np.take(self.plan.numbers, order, self.axis), self.axis, -2)
        # points, cases, analyses, motions, levels, 1 + buildings
        numbers = numbers.reshape(-1, *numbers.shape[-5:])
        for point, case, analysis in np.ndindex(numbers.shape[:3]):
            of_case = numbers[point, case, analysis]
            for target in self.targets:
                histories = {WITH_POUNDING: of_case[..., 0]}
                if target.limit.quantity not in LIMITS_OF_PAIRS:
                    histories = {ALONE: of_case[..., 1 + target.building], **histories}
                factor = self._find_limit_factor(self.points[point], target)
                yield CurvePlace(point, self.points[point], case, analysis, target, histories, factor)

    def _find_limit_factor(self, point: Point, target: Target) -> float:
        """Return the factor on a damage limit of one of the buildings that a neighbour may be [-], 1 of others."""
        name = self.study.spec.group[target.building]
        seen = next((each for each in self.drawn if each.name == name), None)
        if seen is None or self.neighbour_axis is None or not target.is_damage:
            return 1.0
        spreads = seen.archetype.spreads
        return draw_factors(spreads, name, point[self.neighbour_axis], seen.spec.neighbours)["drift"]

    def group_neighbours(self, places: Sequence[CurvePlace]) -> list[list[CurvePlace]]:
        """Return the places of the same curve over what neighbours may be, the median buildings first.

        Where all buildings are certain each place is by itself.
        """
        if self.neighbour_axis is None:
            return [[place] for place in places]
        groups: dict[tuple[Any, ...], list[CurvePlace]] = {}
        for place in places:
            others = tuple(index for axis, index in enumerate(place.point) if axis != self.neighbour_axis)
            groups.setdefault((others, place.case, place.analysis, place.target), []).append(place)
        return list(groups.values())

    def _hunt(self, places: Sequence[CurvePlace], solver: Solver) -> np.ndarray:
        """Return the time histories that bracket where every motion passes each limit (`hunt.next_levels`).

        The next intensities of all motions are solved together, so that workers are busy.
        """
        new = np.unique([histories[:, 0] for place in places for histories in place.histories.values()])
        asked = new
        while new.size:
            solved = solver.solve_plan(self.plan, asked)
            wanted: set[int] = set()
            for place in places:
                for state, histories in place.histories.items():
                    is_asked = np.isin(histories, asked)
                    demand = find_demands(self.plan, solved, place, state)
                    for motion in np.flatnonzero(np.isin(histories, new).any(axis=1)):
                        levels = np.flatnonzero(is_asked[motion])
                        demands = dict(zip(levels.tolist(), demand[motion, levels].tolist(), strict=True))
                        further = next_levels(self.levels, demands, self.spec.fill)
                        wanted.update(histories[motion, list(further)].tolist())
            new = np.array(sorted(wanted), int)
            asked = np.union1d(asked, new)
        return asked
