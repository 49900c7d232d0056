"""`pound fragility`: how likely limits are passed at an intensity and how often a year, alone and with pounding."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pandas as pd

from pounding_cli.model.links import LinkPlace, link_places
from pounding_cli.numbers import Unit
from pounding_cli.questions.bootstrap import draws_of, with_interval
from pounding_cli.questions.fragility.curves import UNDECIDED, Fits, brackets, curve_of
from pounding_cli.questions.fragility.spec import FragilitySpec
from pounding_cli.questions.frames import columns_of, swept, tabled
from pounding_cli.questions.hazard import (
    INTENSITY_KEYS,
    SWEEP,
    Hazard,
    hazard_of,
    intensity_axis,
    measure_motion,
    probability,
)
from pounding_cli.questions.question import Answer, StudyQuestion
from pounding_cli.questions.specs import Measure
from pounding_cli.study import Plan, Study, make_plan
from pounding_cli.study.expression import COLLAPSE, CONTACT, LIMITS_OF_PAIRS, SHEAR_DEMAND, Limit, Target
from pounding_cli.study.file import nearest
from pounding_cli.study.group import unique_names
from pounding_cli.study.swept import Point
from pounding_cli.tables import Table

if TYPE_CHECKING:
    from pounding_cli.batch.solve import Solver
    from pounding_cli.results.solved import Solved

CURVES, MOTIONS, POINTS = "fragility", "fragility_motions", "fragility_curves"
RATES, CONTRIBUTIONS = "fragility_rates", "fragility_contributions"
"""Names of the tables; the last two where the study gives a hazard curve."""

LINKED, ALONE = "", "0"
"""End the names of columns with pounding and of the building alone."""

POINTS_OF_CURVE, STRIPS = 200, 40
"""Intensities at which a curve is told, and ranges of intensities whose contributions to a rate are."""

_OVERSHOOT = 1.1
"""By how much the first step beyond a capacity aims too high: a bracket from above is worth more than another below."""

_LONGEST_STEP = 4.0
"""The intensity grows at most by this factor from one level to the next while none has passed."""

_STEP_UNDECIDED = 2.0
"""The intensity grows by this factor from one level to the next while a collapse leaves all undecided."""

_PEAKS = {"mu": "building.ductility", "drift": "building.drift", "acceleration": "building.acceleration"}
"""What a limit looks at, as responses call it."""

_CANNOT = {
    COLLAPSE: "write `p_delta: true` of a building that yields, or the drift: `collapse: 10 %`",
    SHEAR_DEMAND: "write `columns:` in a building that yields; `pound check` lists where slabs strike columns",
}


class Place(NamedTuple):
    """Where a curve with pounding and that of the building alone stand.

    number : of the point of the sweep, the intensity set aside; point : its index on every axis, 0 on the intensity's
    case, analysis : numbers
    scenes : by LINKED and, where the building alone can pass the limit, ALONE the scenes of all motions and intensities
        by number, shape (motions, levels); intensities rise
    """

    number: int
    point: Point
    case: int
    analysis: int
    target: Target
    scenes: dict[str, np.ndarray]


class Fragility(StudyQuestion):
    """How likely every limit is passed at an intensity, alone and with pounding.

    Raises InputError: no limit, one that concerns no building of the group, an intensity that is not swept.

    axis : number of the swept axis that varies the intensity; None of a cloud without one
    swept : the measure that it varies; "" without one
    measure : the intensity measure of the curves; `swept` unless another is wanted
    targets : what the curves are about, in the order of the limits
    hazard : how often a year an intensity is exceeded; None where nothing is asked of it
    """

    name = "fragility"
    spec: FragilitySpec

    def __init__(self, study: Study) -> None:
        super().__init__(study)
        spec, is_cloud = self.spec, self.spec.method == "cloud"
        if spec.method == "ida":  # the results decide which scenes are solved
            self.extent = "has at most"
            self.refuse_histories("the scenes that `pound fragility` chooses")
        if not spec.limits:
            hint = "write e.g. `fragility: {limits: [mu > 4]}`"
            self.add_problem((), "the study has no limit, whose fragility could be sought", hint, key=True)
        self.targets = list[Target]()
        for number, limit in enumerate(spec.limits):
            for target in self._targets(limit, number):
                if target in self.targets:
                    self.add_problem(("limits", number), f"the limit '{limit}' occurs twice", "remove one of the two")
                self.targets.append(target)
        self.axis = intensity_axis(self, study.axes, least=1 if is_cloud else 2)
        self.swept = "" if self.axis is None else INTENSITY_KEYS.get(study.axes[self.axis].names[0], "")
        if self.axis is None and not is_cloud:
            hint = f"{SWEEP}, or `method: cloud` for motions as they are"
            self.add_problem(("intensity",), "the intensity is not swept", hint, key=spec.intensity is None)
        self.measure = spec.intensity or Measure(self.swept or "pga")
        if self.measure == Measure("sa") and self.swept != "sa" and (self.axis is not None or is_cloud):
            self.add_problem(("intensity",), "sa is not swept and has no period", "write e.g. `intensity: sa(0.5 s)`")
        self.problems.check()
        self.hazard = hazard_of(self, self.measure)

    def _targets(self, limit: Limit, number: int) -> list[Target]:
        """Return the buildings, or pairs, that a limit concerns; what is wrong with it is noted.

        A wall stands in a row only where a limit on its movement names it.
        """
        study, path = self.study, ("limits", number)
        group, names = study.spec.group, unique_names(study.spec.group)
        if limit.quantity == CONTACT:
            return [Target(limit, left) for left in range(len(names) - 1)]
        first, wanted = (0,) * len(study.axes), limit.building
        if wanted:
            mine = [place for place, name in enumerate(names) if wanted in (name, group[place])]
        else:
            mine = [place for place in range(len(names)) if not self.is_wall(place)]
        if any(self.lacks(place, limit.quantity) for place in mine):
            buildings = [name for place, name in enumerate(names) if not self.is_wall(place)]
            message = f"'{limit}': {wanted} is a wall, which has no {limit.quantity}"
            self.add_problem(path, message, f"name one of the buildings: {', '.join(buildings)}")
            return []
        storeys = {place: study.building(first, place).storeys for place in mine}
        found = [Target(limit, place) for place in mine if storeys[place] >= limit.level]
        able = {COLLAPSE: _can_collapse, SHEAR_DEMAND: _can_be_struck}.get(limit.quantity)
        if not mine:
            what = f"'{limit}': no building '{wanted}' in the group"
            self.add_problem(path, what, nearest(wanted, dict.fromkeys((*names, *group))))
        elif not found:
            most = max(storeys.values())
            self.add_problem(path, f"'{limit}': the highest is {most}", f"write a number from 1 to {most}")
        elif able is not None:
            points = list(np.ndindex(*(len(axis.values) for axis in study.axes)))
            found = [target for target in found if any(able(study, target, at) for at in points)]
            if not found:
                self.add_problem(path, f"'{limit}': no storey there can pass it", _CANNOT[limit.quantity])
        return found

    @cached_property
    def plan(self) -> Plan:
        """The scenes of every motion at every intensity, of which `ida` solves some."""
        return dataclasses.replace(make_plan(self.study), workflow="fragility")

    @property
    def expected_count(self) -> int:
        """Number of time histories of the whole question.

        Of `ida` it is that of demands in proportion to the intensity, with limits passed all over the levels.
        """
        if self.spec.method != "ida":
            return len(self.plan)
        numbers = set[int]()
        for place in self._places():
            share = (1 + self.targets.index(place.target)) / (1 + len(self.targets))
            capacity = float(np.quantile(self.levels, share))
            levels = expected_levels(self.levels, capacity, self.spec.fill)
            for scenes in place.scenes.values():
                numbers.update(scenes[:, levels].ravel().tolist())
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
        plan, study, known = self.plan, self.study, dict[Point, list[float]]()
        found = np.broadcast_to(self.levels, (len(self.points), len(plan.records), self.levels.size))
        if self.measure == Measure(self.swept):
            return found
        keys = [tuple(point[axis] for axis in study.resolved.suite.axes) for point in self.points]
        for key, point in zip(keys, self.points, strict=True):
            if key not in known:
                uses = study.motion_uses(point)
                known[key] = [
                    measure_motion(uses[name], study.motion(point, name), self.measure) for name in plan.records
                ]
        first = 1.0 if self.axis is None else float(plan.axes[self.axis].values[0][0])  # where they were measured
        return np.array([known[key] for key in keys])[..., None] * found / first

    @property
    def unit(self) -> Unit:
        """The unit that people read intensities in."""
        name = self.measure.name
        if self.axis is not None and name == self.swept:
            return self.plan.axes[self.axis].units[0]
        return {"factor": Unit(), "pgv": Unit("m/s", 1.0, "m/s")}.get(name) or self.study.unit("acceleration")

    def answer(self, solver: Solver) -> Answer:
        """The curves, what every motion said and, with a hazard curve, annual rates."""
        places = list(self._places())
        asked = self._hunted(places, solver) if self.spec.method == "ida" else np.arange(len(self.plan))
        solved = solver.solve_plan(self.plan, asked)
        return Answer(self.plan, solver.solve_arrays(self.plan, asked), self._tables(places, solved))

    # Which scenes are solved

    def _places(self) -> Iterator[Place]:
        """Every curve with its scenes."""
        plan, numbers = self.plan, self.plan.numbers[..., None, :]
        if self.axis is not None:
            order = np.argsort([float(value) for (value,) in plan.axes[self.axis].values])
            numbers = np.moveaxis(np.take(plan.numbers, order, self.axis), self.axis, -2)
        numbers = numbers.reshape(-1, *numbers.shape[-5:])  # points, cases, analyses, motions, levels, 1 + buildings
        for number, case, analysis in np.ndindex(numbers.shape[:3]):
            for target in self.targets:
                here = numbers[number, case, analysis]
                scenes = {LINKED: here[..., 0]}
                if target.limit.quantity not in LIMITS_OF_PAIRS:
                    scenes[ALONE] = here[..., 1 + target.building]
                yield Place(number, self.points[number], case, analysis, target, scenes)

    def _hunted(self, places: Sequence[Place], solver: Solver) -> np.ndarray:
        """Incremental dynamic analysis: the scenes that bracket where every motion passes each limit (`next_levels`).

        The next intensities of all motions are solved together, so that workers are busy.
        """
        asked = new = np.unique([scenes[:, 0] for place in places for scenes in place.scenes.values()])
        while new.size:
            solved, wanted = solver.solve_plan(self.plan, asked), set[int]()
            for place in places:
                for end, scenes in place.scenes.items():
                    is_seen, demand = np.isin(scenes, asked), self._demand(place, solved, end)
                    for motion in np.flatnonzero(np.isin(scenes, new).any(axis=1)):
                        seen = {int(level): float(demand[motion, level]) for level in np.flatnonzero(is_seen[motion])}
                        wanted |= {int(scenes[motion, k]) for k in next_levels(self.levels, seen, self.spec.fill)}
            new = np.array(sorted(wanted), int)
            asked = np.union1d(asked, new)
        return asked

    def _demand(self, at: Place, solved: Solved, end: str) -> np.ndarray:
        """Demand over limit [-], above 1 where the limit is passed; inf where a collapse ended the scene after that,
        UNDECIDED where it did before; NaN where the scene failed or was not asked for; shape (motions, levels).

        Passed are limits that were passed before a scene ended, the collapse itself, and limits on the drift or the
        ductility of the storey that collapsed: its drift has no bound.
        """
        limit, values, scenes = at.target.limit, solved.values, at.scenes[end]
        place = 0 if end == ALONE else at.target.building
        reached = self._reached(at, solved, scenes, place)
        storey = np.nan_to_num(values["collapse_storey"][scenes]).astype(int)
        own = np.where(values["collapse_building"][scenes] == place, storey, 0)
        falls = own > 0 if limit.quantity == COLLAPSE or not limit.level else own == limit.level
        passed = (reached > 1) | (falls & (limit.quantity in ("mu", "drift", COLLAPSE)))
        demand = np.where(storey > 0, np.where(passed, np.inf, UNDECIDED), reached)
        return np.where(solved.ended[scenes], demand, np.nan)

    def _reached(self, at: Place, solved: Solved, scenes: np.ndarray, place: int) -> np.ndarray:
        """Demand over limit by the largest values of scenes, whatever ended them; 0 of collapse."""
        limit, values, links = at.target.limit, solved.values, self.plan.links
        building = self.study.building(at.point, at.target.building)
        there = links.kind[(*at.point, at.case)] != ""
        if limit.quantity in _PEAKS:
            peaks = values[_PEAKS[limit.quantity]][scenes, place, : building.storeys]
            parts = peaks / (limit.value * building.height if limit.of_height else limit.value)
            return parts[..., limit.level - 1] if limit.level else np.fmax.reduce(parts, axis=-1)
        if limit.quantity == CONTACT:
            mine = [k for k, each in enumerate(links.places) if there[k] and each.left == at.target.building]
            gap, closing = links.gap[(*at.point, at.case)][mine], values["link.max_closing"][scenes][..., mine]
            with np.errstate(divide="ignore", invalid="ignore"):  # floors in touch
                parts = np.where(closing == 0, 0.0, closing / gap)
        elif limit.quantity == SHEAR_DEMAND:
            strikes = [_takes_blow(at.target, each, building.yield_shear) for each in links.places]
            mine = np.flatnonzero(there & strikes).tolist()
            parts = values["columns.demand"][scenes][..., mine] / limit.value
        else:
            mine = []
        return np.fmax.reduce(parts, axis=-1) if mine else np.zeros(scenes.shape)

    # The tables

    def _tables(self, places: Sequence[Place], solved: Solved) -> list[Table]:
        """The tables of curves, of motions, of points and, with a hazard curve, of rates and contributions."""
        spec, hazard, tables = self.spec, self.hazard, list[Table]()
        times, records = draws_of(len(self.plan.records), spec.draws), np.array(self.plan.records, object)
        parts: dict[str, list[pd.DataFrame]] = {name: [] for name in _columns(spec.method)}
        for place in places:
            x, fitted, top = self.intensities[place.number], Curves(), 0.0
            row, said = dict[str, Any](), dict[str, Any](record=records)
            if spec.method != "ida":
                said = {"record": np.repeat(records, x.shape[1]), "intensity": x.ravel()}
            for end, scenes in place.scenes.items():
                demand = self._demand(place, solved, end)
                own, fits = curve_of(x, demand, solved.there[scenes], times, spec)
                row |= {name + end: value for name, value in own.items()}
                if "median" in own:
                    fitted[end] = own["motions"], fits
                each, is_lost = brackets(x, demand), demand == UNDECIDED
                top = max(top, np.where(each.passed < np.inf, each.passed, each.held).max())
                if spec.method == "ida":
                    said |= {f"held{end}": each.held, f"passed{end}": each.passed, f"undecided{end}": each.undecided}
                else:
                    known = np.where(is_lost, np.nan, demand)
                    said |= {f"demand{end}": known.ravel(), f"undecided{end}": is_lost.ravel()}
            if len(fitted) == 2:
                row |= _ratio("ratio", [fits.median for _, fits in fitted.values()], fitted, spec.confidence)
            parts[CURVES].append(pd.DataFrame([row]))
            parts[MOTIONS].append(pd.DataFrame(said))
            parts[POINTS].append(_points(fitted, top, spec.confidence))
            if hazard is not None:
                parts[RATES].append(pd.DataFrame([_rates(hazard, fitted, spec.confidence)]))
                parts[CONTRIBUTIONS].append(_contributions(hazard, fitted))
        where = self._where(places)
        for name, columns in _columns(spec.method).items():
            if not parts[name]:
                continue
            at = where.loc[np.repeat(where.index, [len(each) for each in parts[name]])].reset_index(drop=True)
            frame = pd.concat(parts[name], ignore_index=True).reindex(columns=columns)
            texts = [column for column in columns if column == "record" or column.startswith("outcome")]
            frame = frame.astype({column: object if column in texts else float for column in columns})
            frame = frame.fillna(dict.fromkeys(texts, ""))
            shown = [column for column in columns if columns_of(CURVES).get(_bare(column), ("",))[0] == "*"]
            units = dict.fromkeys(shown, self.unit)
            tables.append(tabled(name, at.join(frame), self.plan.axes, units, self.unit.si))
        return tables

    def _where(self, places: Sequence[Place]) -> pd.DataFrame:
        """Where curves stand: the swept values but the intensity, case, analysis, limit and building."""
        plan, others = self.plan, [number for number in range(len(self.plan.axes)) if number != self.axis]
        return swept(
            [plan.axes[number] for number in others],
            [[each.point[number] for number in others] for each in places],
            case=[plan.cases[each.case] for each in places],
            analysis=[plan.analyses[each.analysis] for each in places],
            limit=[str(each.target.limit) for each in places],
            building=[each.target.label(plan.buildings) for each in places],
        )


# Limits


def _can_collapse(study: Study, target: Target, at: Point) -> bool:
    return bool(np.isfinite(study.building(at, target.building).collapse_drift).any())


def _can_be_struck(study: Study, target: Target, at: Point) -> bool:
    """Whether a slab strikes columns of the building in any case."""
    yield_shear = study.building(at, target.building).yield_shear
    links = (place for case in study.spec.cases for place in link_places(study.links(at, case) or ()))
    return any(_takes_blow(target, place, yield_shear) for place in links)


def _takes_blow(target: Target, place: LinkPlace, yield_shear: np.ndarray) -> bool:
    """Whether a link strikes columns of the target's building, of its only storey if the limit names one; not those of
    storeys that cannot yield: nothing says what they can carry.

    yield_shear : of the building's storeys [N], shape (storeys,)
    """
    if not place.is_on_columns:
        return False
    building, storey = place.struck_storey
    is_meant = building == target.building and target.limit.level in (0, storey)
    return bool(is_meant and yield_shear[storey - 1] < np.inf)


# The hunt of one motion


def next_levels(intensity: np.ndarray, seen: Mapping[int, float], fill: int) -> set[int]:
    """The levels of one motion to look at next; none when its bracket is closed and filled below.

    Hunt and fill (Vamvatsikos, D. and Cornell, C. A. (2004). Applied incremental dynamic analysis. Earthquake Spectra
    20(2), 523-553): step up until the limit is passed, close the bracket, then look again below it, for demand need not
    grow with intensity.

    Parameters
    ----------
    intensity : of the levels, rising, shape (levels,)
    seen : number of a level -> demand over limit there; above 1 where the limit is passed, UNDECIDED where a collapse
        left that open, NaN where the scene failed
    fill : levels below the bracket that are looked at, evenly
    """
    levels = len(intensity)
    passed = min((level for level, demand in seen.items() if demand > 1), default=levels)
    ended = min((level for level, demand in seen.items() if demand > 1 or demand == UNDECIDED), default=levels)
    held = max((level for level, demand in seen.items() if demand <= 1 and level < ended), default=-1)
    between = [level for level in range(held + 1, ended) if level not in seen]
    if ended < levels and not between:
        last = max((level for level in seen if level < passed), default=-1)
        if ended < passed and passed - last > 1:  # a collapse came first: a stronger motion may pass before it
            double = int(np.searchsorted(intensity, _STEP_UNDECIDED * intensity[last]))
            return {min(max(double, last + 1), levels - 1) if passed == levels else (last + passed) // 2}
        return set(np.linspace(0, max(held, 0), fill + 2)[1:-1].round().astype(int).tolist()) - seen.keys()
    if ended < levels:
        return {between[len(between) // 2]}
    if held < 0:
        return set(between[:1])  # all that was looked at failed
    # a level above all at which the motion holds, where demand in proportion would pass the limit
    factor = _LONGEST_STEP if seen[held] * _LONGEST_STEP < _OVERSHOOT else _OVERSHOOT / seen[held]
    wanted = int(np.searchsorted(intensity, factor * intensity[max(seen)]))
    return {min(between, key=lambda level: (abs(level - wanted), level))} if between else set()


def expected_levels(intensity: np.ndarray, capacity: float, fill: int) -> list[int]:
    """Return the levels that `next_levels` looks at where the demand is in proportion to the intensity.

    Parameters
    ----------
    intensity : of the levels, rising, shape (levels,)
    capacity : intensity at which the limit is passed
    fill : as of `next_levels`
    """
    seen = dict[int, float]()
    wanted = {0}
    while wanted:
        seen |= {level: float(intensity[level]) / capacity for level in wanted}
        wanted = next_levels(intensity, seen, fill)
    return sorted(seen)


# The curves


Curves = dict[str, tuple[int, Fits]]
"""By LINKED and ALONE, where there is a curve, its motions and its fits."""


def _ratio(name: str, values: Sequence[np.ndarray], fitted: Curves, confidence: float) -> dict[str, float]:
    """The ratio of a number with pounding to that alone, and its interval over the same draws; a draw whose ratio has
    no value, both beyond the same end, is taken as 1."""
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = values[0] / values[1]
    ratio[1:] = np.where(np.isnan(ratio[1:]), 1.0, ratio[1:])
    return with_interval(name, ratio, confidence, min(motions for motions, _ in fitted.values()))


def _points(fitted: Curves, top: float, confidence: float) -> pd.DataFrame:
    """Points of both curves with their bands, from above 0 to beyond nearly all of each, but not far beyond where
    motions pass; none where there is no curve.

    top : highest intensity at which a motion says something
    """
    if not fitted:
        return pd.DataFrame()
    median, spread = np.array([(fits.median[0], fits.spread[0]) for _, fits in fitted.values()]).T
    right = np.minimum(median * np.exp(1.8 * spread), np.maximum(2 * top, 1.2 * median)).max()
    x = np.linspace(0.0, 1.1 * right, POINTS_OF_CURVE + 1)[1:]
    columns = {"intensity": x}
    for end, (motions, fits) in fitted.items():
        columns |= with_interval("probability", fits.probability(x), confidence, motions, end)
    return pd.DataFrame(columns)


def _rates(hazard: Hazard, fitted: Curves, confidence: float) -> dict[str, float]:
    """Annual rates of a limit, their ratio, and their intervals; nothing where there is no curve."""
    row, rates = dict[str, float](), []
    for end, (motions, fits) in fitted.items():
        at_all = np.where(fits.share > 0, fits.share * hazard.rate(np.zeros(1)), 0.0)  # of draws without a trend
        rates.append(np.where(np.isinf(fits.spread), at_all, hazard.of_lognormal(fits.median, fits.spread)))
        rate = float(rates[-1][0])
        beyond = float(hazard.of_lognormal(fits.median[0], fits.spread[0], above=hazard.last))
        row |= with_interval("rate", rates[-1], confidence, motions, end)
        row |= {f"probability{end}": probability(rate), f"beyond{end}": beyond / rate if rate > 0 else 0.0}
    if len(rates) == 2 and rates[1][0] > 0:
        row |= _ratio("rate_ratio", rates, fitted, confidence)
    return row


def _contributions(hazard: Hazard, fitted: Curves) -> pd.DataFrame:
    """The rates that come from STRIPS ranges of intensities, equal in their logarithm; none where there is no curve."""
    if not fitted:
        return pd.DataFrame()
    curves = {end: (fits.median[0], fits.spread[0]) for end, (_, fits) in fitted.items()}
    low = min(median * np.exp(-4 * spread) for median, spread in curves.values())
    high = max(2.5 * median * np.exp(3 * spread) for median, spread in curves.values())
    edges = np.geomspace(max(low, hazard.edges[0]), max(high, 2 * hazard.edges[0]), STRIPS + 1)
    columns = {"from": edges[:-1], "to": edges[1:]}
    for end, (median, spread) in curves.items():
        slope = np.full(STRIPS, 1 / spread)
        columns[f"rate{end}"] = hazard.contributions(edges, -slope * np.log(median), slope)
    return pd.DataFrame(columns)


# Columns


def _three(name: str) -> list[str]:
    return [name, f"{name}_low", f"{name}_high"]


def _columns(method: str) -> dict[str, list[str]]:
    """The columns of every table behind those that say where its numbers stand."""
    curve = ["outcome", *_three("median"), *_three("spread"), "low", "high", "motions", "scenes", "failed", "undecided",
             "undecided_motions", "unfitted"]  # fmt: skip
    motion, rate = ["demand", "undecided"], [*_three("rate"), "probability", "beyond"]
    if method == "ida":
        motion = ["held", "passed", "undecided"]

    def both(names: list[str]) -> list[str]:
        return [name + end for end in (LINKED, ALONE) for name in names]

    return {
        CURVES: [*both(curve), *_three("ratio")],
        MOTIONS: ["record", *(["intensity"] if method != "ida" else []), *both(motion)],
        POINTS: ["intensity", *both(_three("probability"))],
        RATES: [*both(rate), *_three("rate_ratio")],
        CONTRIBUTIONS: ["from", "to", *both(["rate"])],
    }


def _bare(column: str) -> str:
    """The name of a column without what tells its interval or the building alone."""
    return column.removesuffix(ALONE).removesuffix("_low").removesuffix("_high")
