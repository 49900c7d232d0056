"""`pound gap`: required separations over the motions, exact and by rules, at every pair of floors that face; what that
means for the gaps of the cases; distances to a property line."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from itertools import pairwise, product
from typing import TYPE_CHECKING

import numpy as np

from pounding_cli.model.links import APART, Link, LinkPlace
from pounding_cli.model.meetings import FLOOR_TOLERANCE, meetings
from pounding_cli.model.separation import (
    ASCE7,
    EN1998,
    absolute_sum,
    cross_correlation,
    double_difference,
    en1998_separation,
    first_mode_damping,
    gb50011_width,
    root_of_squares,
)
from pounding_cli.results.tables import Filled, Table, column, place_columns
from pounding_cli.study import Plan, Study, expand
from pounding_cli.study.axes import SweepAxis
from pounding_cli.study.file import Items, Map
from pounding_cli.study.study import Point
from pounding_cli.workflows.workflow import Found, Workflow

if TYPE_CHECKING:
    from pounding_cli.batch.solve import Solver
    from pounding_cli.model.building import Building
    from pounding_cli.study.questions import GapSpec

EXACT = "exact"
"""Name among the rules of what is required: the largest closing over time, located within the step it lies in."""

CONFIDENCE = 0.90
"""Of the interval of a gap for a probability of contact [-]."""

FEWEST = 5
"""Motions from which that interval is told: fewer do not tell how much the gap varies from motion to motion."""

CASES, LINE = "gap_cases", "property_line"
"""Names of the tables of the gaps of the cases and of the distances to a property line."""

_UBC = "UBC"

_OF_COLUMNS = (
    "building whose columns, in the storey below its floor, a slab of the other faces: left or right; empty where two "
    "slabs face each other"
)


_BETWEEN = ("cases", "impact", "laws")
"""Sections that say what stands between the buildings."""

_ASIDE = ("keep", "report", "claims", "uncertain")
"""Sections without a meaning where no case is run."""

Points = list[tuple[int, ...]]
"""Points of the sweep, an index on every axis each."""


@dataclass(frozen=True)
class Rule:
    """Separations by one rule.

    values : [m], shape (points, analyses, motions, pairs of floors); NaN where it says nothing
    errors : numerical error of each [m], same shape
    needs_motions : whether it depends on the motion; else `values` has one motion
    """

    name: str
    values: np.ndarray
    errors: np.ndarray
    needs_motions: bool = True


class Gap(Workflow):
    """The required separations of all neighbours over the motions."""

    name = "gap"

    def plan(self, study: Study) -> Plan:
        """The scenes whose closings are the required separations: every motion and analysis, with nothing between the
        buildings; swept keys of links are left out, those of buildings and motions stay."""
        apart = _with_nothing_between(study)
        return dataclasses.replace(expand(apart, partial(_all_facing, apart)), workflow="gap")

    def run(self, study: Study, solver: Solver) -> Found:
        """The tables of what is required, of what that means for the cases, and of the property lines."""
        plan = self.plan(study)
        data = solver.dataset(plan)
        points = list(np.ndindex(*plan.shape[:-3]))
        names = ("max_closing", "displacement", "displacement_max", "displacement_min", "error_estimate")
        # points first, without the one case
        found = {name: _points_first(data[name].values, len(plan.axes)) for name in names}
        facts = _Facts(plan, points, plan.links.places)
        rules = list(_rules(plan, found, facts))
        tables = {
            "gap": _required(plan, points, facts, rules),
            CASES: _of_cases(plan, points, facts, rules),
            LINE: _of_lines(plan, points, found),
        }
        return Found(plan, data, [Table.of(name, columns) for name, columns in tables.items()])


ASKED = Gap()


def _points_first(values: np.ndarray, axes: int) -> np.ndarray:
    return values.reshape(-1, *values.shape[axes + 1 :])


def _required(plan: Plan, points: Points, facts: _Facts, rules: Sequence[Rule]) -> list[Filled]:
    """What floors that face each other require."""

    def of_places(place: np.ndarray, point: np.ndarray) -> list[Filled]:
        return [
            *_place_columns(plan.buildings, [facts.places[number] for number in place]),
            column("height", facts.heights[point, place], "of the slabs above the ground", "m"),
        ]

    return _rows(plan, points, rules, facts.faces, of_places)


def _place_columns(names: Sequence[str], places: Sequence[LinkPlace]) -> list[Filled]:
    """Which floors, of which buildings."""
    return [
        column("left", _texts(names[left] for left, *_ in places), "building left of the gap"),
        column("right", _texts(names[left + 1] for left, *_ in places), "building right of the gap"),
        column("floor", np.array([floor for _, floor, *_ in places], int), "floor of the left building", "1"),
        column("right_floor", np.array([floor for *_, floor, _ in places], int), "floor of the right building", "1"),
        column("columns", _texts(name.removesuffix(" columns") for *_, name in places), _OF_COLUMNS),
    ]


def _texts(values: Iterable[str]) -> np.ndarray:
    return np.array(list(values), dtype=object)


def _rows(
    plan: Plan,
    points: Points,
    rules: Sequence[Rule],
    faces: np.ndarray,
    of_places: Callable[[np.ndarray, np.ndarray], list[Filled]],
    is_line: bool = False,
) -> list[Filled]:
    """A row for every point, analysis, place and rule, with the statistics over the motions.

    faces : whether a place is there, shape (points, places)
    of_places : (place of every row, its point) -> the columns that say where it is
    """
    wanted = plan.study.model.gap
    parts = [_statistics(rule, wanted) for rule in rules]
    exact = parts[0]
    for part in parts:
        with np.errstate(divide="ignore", invalid="ignore"):
            part["over_exact"] = part["mean"] / exact["mean"]
    shape = (len(points), len(plan.analyses), faces.shape[1], len(parts))
    there = np.broadcast_to(faces[:, None, :, None], shape).copy()
    there &= np.stack([part["motions"] >= 0 for part in parts], axis=-1)
    point, analysis, place, rule = np.nonzero(there)
    columns = place_columns(plan.axes, [points[number] for number in point])
    columns += [
        column("analysis", np.array(plan.analyses, object)[analysis], "elastic or inelastic storeys"),
        *of_places(place, point),
        column("rule", np.array([part["name"] for part in parts], object)[rule], "exact, or the rule"),
    ]
    width = plan.study.unit("gap")
    for name, text in _meanings(wanted, is_line).items():
        values = np.stack([part[name] for part in parts], axis=-1)[point, analysis, place, rule]
        is_length = name not in ("motions", "dispersion", "over_exact")
        columns.append(column(name, values, text, "m" if is_length else "1", width if is_length else None))
    return columns


def _of_cases(plan: Plan, points: Points, facts: _Facts, rules: Sequence[Rule]) -> list[Filled]:
    """Whether the gaps of the cases are enough: a row for every point, case, analysis, pair of neighbours and rule."""
    places = facts.places
    rows: list[tuple[int, str, int, str, _Enough]] = []
    for number, point in enumerate(points):
        for case, gaps in gaps_of_cases(plan, point):
            width = np.array([gaps.get(place, np.nan) for place in places])
            for left in sorted({place[0] for place in gaps}):
                own = np.isfinite(width) & np.array([place[0] == left for place in places]) & facts.faces[number]
                for analysis in range(len(plan.analyses)) if own.any() else ():
                    for rule in rules:
                        one = _enough(rule, number, analysis, width, own)
                        if one is not None:
                            rows.append((number, case, analysis, rule.name, one))
    unit, here = plan.study.unit("gap"), [each for *_, each in rows]
    chosen = [places[each.place] for each in here]
    return [
        *place_columns(plan.axes, [points[number] for number, *_ in rows]),
        column("case", _texts(case for _, case, *_ in rows), "case of the study"),
        column("analysis", _texts(plan.analyses[analysis] for _, _, analysis, *_ in rows), "elastic or inelastic"),
        *_place_columns(plan.buildings, chosen),
        column("gap", np.array([each.gap for each in here], float), "of the case at these floors", "m", unit),
        column("rule", _texts(name for *_, name, _ in rows), "exact, or the rule"),
        column(
            "required",
            np.array([each.required for each in here], float),
            "by the rule at these floors, which lack most or have least to spare; largest of the motions",
            "m",
            unit,
        ),
        column(
            "enough",
            _texts(each.word for each in here),
            "whether the gap is wide enough at all floors of the pair, under all motions; unknown where scenes failed",
        ),
        column("enough_for", np.array([each.count for each in here], int), "motions for which it is", "1"),
        column(
            "motions", np.array([each.motions for each in here], int), "motions; 0 where the rule depends on none", "1"
        ),
    ]


@dataclass(frozen=True)
class _Enough:
    """Whether a gap is enough by a rule, and the floors that lack most or have least to spare.

    place : their number; gap, required : there [m]
    word : yes, no or unknown; count, motions : for how many motions it is enough, of how many
    """

    place: int
    gap: float
    required: float
    word: str
    count: int
    motions: int


def _enough(rule: Rule, point: int, analysis: int, gap: np.ndarray, own: np.ndarray) -> _Enough | None:
    """Compare gaps [m], shape (places,), with what a rule requires at the places `own`; None where it says nothing.
    A gap is enough where it is no narrower than what is required and its numerical error."""
    values = rule.values[point, analysis][:, own]
    errors = np.nan_to_num(rule.errors[point, analysis][:, own])
    known = np.isfinite(values).all(axis=1)
    if not known.any():
        return None
    is_enough = (values[known] + errors[known] <= gap[own]).all(axis=1)
    largest = values[known].max(axis=0)
    worst = int(np.argmin(gap[own] - largest))
    word = "no" if not is_enough.all() else "yes" if known.all() else "unknown"
    count, motions = (int(is_enough.sum()), known.size) if rule.needs_motions else (0, 0)
    place = int(np.flatnonzero(own)[worst])
    return _Enough(place, float(gap[place]), float(largest[worst]), word, count, motions)


def _of_lines(plan: Plan, points: Points, found: Mapping[str, np.ndarray]) -> list[Filled]:
    """How far every floor moves to either side, and what codes ask of the distance to a property line."""
    names, floors = plan.buildings, found["displacement"].shape[-1]
    sides = [(building, floor, side) for building in range(len(names)) for floor in range(floors) for side in (0, 1)]
    shape = len(points), len(sides)
    heights = np.full(shape, np.nan)
    codes = {name: np.full(shape, np.nan) for name in (ASCE7, EN1998)}
    for number, point in enumerate(points):
        row = [plan.study.building(point, place) for place in range(len(names))]
        expected = [plan.study.code_displacements(point, name) for name in plan.study.model.group]
        for side, (building, floor, _) in enumerate(sides):
            if floor < row[building].storeys:
                heights[number, side] = row[building].elevation[floor]
                for name, whole in expected[building].items():
                    codes[name][number, side] = whole[floor]
    both = np.stack([-found["displacement_min"], found["displacement_max"]], axis=-1)
    relative = found["error_estimate"][..., None, None]
    reach = relative * np.nanmax(found["displacement"], axis=-1, keepdims=True, initial=0.0)
    exact = both.reshape(*both.shape[:3], -1)
    errors = np.broadcast_to(reach[..., None], both.shape).reshape(exact.shape)
    rules = [Rule(EXACT, exact, errors)]
    rules += [_of_no_motion(name, widths, len(plan.analyses)) for name, widths in codes.items()]

    def of_places(place: np.ndarray, point: np.ndarray) -> list[Filled]:
        chosen = [sides[number] for number in place]
        return [
            column("building", _texts(names[building] for building, *_ in chosen), "building, left to right"),
            column(
                "side", _texts(("left", "right")[side] for *_, side in chosen), "of the building that faces the line"
            ),
            column("floor", np.array([floor + 1 for _, floor, _ in chosen], int), "floor, from 1 at the ground", "1"),
            column("height", heights[point, place], "of the floor above the ground", "m"),
        ]

    return _rows(plan, points, rules, np.isfinite(heights), of_places, is_line=True)


def _meanings(wanted: GapSpec, is_line: bool = False) -> dict[str, str]:
    """The columns of numbers and what each means; `is_line`: of the distances to a property line."""
    found = {
        "motions": "number of motions behind the row; 0 where the rule depends on none",
        "mean": "mean over the motions",
        "std": "standard deviation over the motions (n - 1)",
        "mean_plus_std": "mean plus one standard deviation",
        "largest": "largest of the motions",
    }
    for share in wanted.percentiles:
        found[f"percentile_{100 * share:g}"] = f"{100 * share:g} % of the motions need no more, interpolated"
    found |= {
        "median": "median of the lognormal fit",
        "dispersion": "standard deviation of the logarithm (n - 1)",
    }
    for share in wanted.contact:
        name = f"contact_{100 * share:g}"
        said = "distance that the floor reaches with a probability" if is_line else "gap with a probability of contact"
        said += f" of {100 * share:g} % by the lognormal fit"
        found |= {
            name: said,
            f"{name}_low": f"lower end of its {CONFIDENCE:.0%} confidence interval; from {FEWEST} motions on",
            f"{name}_high": f"upper end of its {CONFIDENCE:.0%} confidence interval; from {FEWEST} motions on",
        }
    found["error"] = "largest numerical error of a motion's separation; no statistic but those of the fit exceeds it"
    found["over_exact"] = "mean over the mean of the exact separations"
    return found


class _Facts:
    """What the buildings are at every point of the sweep; shapes (points, pairs of floors)."""

    def __init__(self, plan: Plan, points: Points, places: Sequence[LinkPlace]) -> None:
        shape = (len(points), len(places))
        self.correlations, self.heights, self.lower = (np.full(shape, np.nan) for _ in range(3))
        self.codes = {name: np.full(shape, np.nan) for name in (_UBC, ASCE7, EN1998)}
        self.upper = np.ones((2, *shape))  # what the floor has of a place's movement; the floor below has the rest
        self.places = places
        touched = plan.study.touching("buildings")
        known: dict[tuple[int, ...], int] = {}
        for number, point in enumerate(points):
            key = tuple(place for place, is_touched in zip(point, touched, strict=True) if is_touched)
            same = known.setdefault(key, number)
            if same == number:
                self._enter(plan, number, point)
            else:
                for array in (self.correlations, self.heights, self.lower, *self.codes.values()):
                    array[number] = array[same]
                self.upper[:, number] = self.upper[:, same]
        self.faces = np.isfinite(self.heights)

    def _enter(self, plan: Plan, number: int, point: tuple[int, ...]) -> None:
        row = [plan.study.building(point, place) for place in range(len(plan.buildings))]
        damping = [first_mode_damping(building) for building in row]
        expected = []
        for name in plan.study.model.group:
            ubc = plan.study.design_displacements(point, name)
            codes = plan.study.code_displacements(point, name)
            expected.append({**codes, **({} if ubc is None else {_UBC: ubc})})
        level = [_same_floors(one, other) for one, other in pairwise(row)]
        there: dict[tuple[int, int, int, str], tuple[float, float]] = {}
        for left, pair in enumerate(pairwise(row)):
            floors, strikes = meetings(*pair)
            there |= {(left, *both, ""): (1.0, 1.0) for both in floors}
            for strike in strikes:
                name = f"{('left', 'right')[strike.side]} columns"
                there[left, strike.left_floor, strike.right_floor, name] = strike.left_at, strike.right_at
        for facing, place in enumerate(self.places):
            if place not in there:
                continue
            left, left_floor, right_floor, _ = place
            a, b = row[left], row[left + 1]
            slab = a.elevation[left_floor - 1] if there[place][0] == 1.0 else b.elevation[right_floor - 1]
            self.heights[number, facing] = slab
            self.upper[:, number, facing] = [at * at * (3.0 - 2.0 * at) for at in there[place]]
            self.lower[number, facing] = min(a.elevation[-1], b.elevation[-1])
            if damping[left] > 0 and damping[left + 1] > 0:
                self.correlations[number, facing] = cross_correlation(
                    float(a.periods[0]), float(b.periods[0]), damping[left], damping[left + 1]
                )
            upper = self.upper[:, number, facing]
            for name in expected[left].keys() & expected[left + 1].keys():
                one, other = (
                    part * d[floor - 1] + (1.0 - part) * (d[floor - 2] if floor > 1 else 0.0)
                    for d, floor, part in zip(
                        (expected[left][name], expected[left + 1][name]), (left_floor, right_floor), upper, strict=True
                    )
                )
                self.codes[name][number, facing] = {
                    _UBC: one + other,
                    ASCE7: float(root_of_squares(one, other)),
                    EN1998: float(en1998_separation(one, other, level[left])),
                }[name]


def _same_floors(left: Building, right: Building) -> bool:
    """Whether the floors of two neighbours have the same elevations, up to the lower roof."""
    count = min(left.storeys, right.storeys)
    return bool((np.abs(left.elevation[:count] - right.elevation[:count]) <= FLOOR_TOLERANCE).all())


def _rules(plan: Plan, found: Mapping[str, np.ndarray], facts: _Facts) -> Iterator[Rule]:
    """The exact separations first, then the rules that say something here."""
    analyses, wanted = len(plan.analyses), plan.study.model.gap
    exact, peaks, relative = found["max_closing"], found["displacement"], found["error_estimate"][..., None]
    left, left_floor, right_floor, _ = (np.array(column) for column in zip(*facts.places, strict=True))
    a = _between(peaks[..., left, left_floor - 1], peaks[..., left, left_floor - 2], left_floor, facts.upper[0])
    b = _between(
        peaks[..., left + 1, right_floor - 1], peaks[..., left + 1, right_floor - 2], right_floor, facts.upper[1]
    )
    reach = relative * absolute_sum(
        a, b
    )  # a relative change of both peaks moves no rule by more than that of their sum
    yield Rule(EXACT, exact, relative * np.nanmax(exact, axis=-1, keepdims=True, initial=0.0) + 0 * exact)
    yield Rule("ABS", absolute_sum(a, b), reach)
    yield Rule("SRSS", root_of_squares(a, b), reach)
    yield Rule("DDC", double_difference(a, b, facts.correlations[:, None, None, :]), reach)
    if wanted.gb50011 is not None:
        system = wanted.gb50011.intensity, wanted.gb50011.structure
        joint = np.vectorize(lambda height: gb50011_width(height, *system) if height == height else np.nan)
        yield _of_no_motion("GB 50011-2010", joint(facts.lower), analyses)
    for name, widths in facts.codes.items():
        if np.isfinite(widths).any():
            yield _of_no_motion(_edition(plan) if name == _UBC else name, widths, analyses)


def _between(above: np.ndarray, below: np.ndarray, floor: np.ndarray, upper: np.ndarray) -> np.ndarray:
    """Displacements where slabs face each other or columns: `upper` of the floor above, shape (points, places), and
    the rest of the floor below; floor 1 stands on the ground. Shape (points, analyses, motions, places)."""
    part = upper[:, None, None, :]
    return np.where(part == 1.0, above, part * above + (1.0 - part) * np.where(floor > 1, below, 0.0))


def _of_no_motion(name: str, widths: np.ndarray, analyses: int) -> Rule:
    values = np.repeat(widths[:, None, None, :], analyses, axis=1)
    return Rule(name, values, 0 * values, needs_motions=False)


def _edition(plan: Plan) -> str:
    """The edition of the UBC that set the yield shears; "UBC" where there are several."""
    specs = (plan.study.model.buildings[name].yield_ for name in plan.study.model.group)
    editions = {getattr(spec, "code", _UBC) for spec in specs}
    return editions.pop() if len(editions) == 1 else _UBC


def _statistics(rule: Rule, wanted: GapSpec) -> dict:
    """The columns of one rule, shape (points, analyses, pairs of floors); `motions` is -1 where it says nothing."""
    values = rule.values
    known = np.isfinite(values)
    count = known.sum(axis=2)
    none = count == 0
    found: dict = {"name": rule.name, "motions": np.where(none, -1, count if rule.needs_motions else 0)}
    filled = np.where(known, values, 0.0)
    mean = _over(filled.sum(axis=2), count)
    away = np.where(known, values - mean[:, :, None], 0.0)
    std = np.sqrt(_over((away**2).sum(axis=2), count - 1))
    found |= {"mean": mean, "std": std, "mean_plus_std": mean + std}
    found["largest"] = np.where(none, np.nan, np.where(known, values, -np.inf).max(axis=2))
    ordered = np.sort(np.where(known, values, np.inf), axis=2)
    for share in wanted.percentiles:
        found[f"percentile_{100 * share:g}"] = _percentile(ordered, count, share) if rule.needs_motions else mean
    positive = known & (values > 0)
    whole = (positive.sum(axis=2) == count) & (count > 1) & rule.needs_motions
    logs = np.log(np.where(positive, values, 1.0))
    centre = np.where(whole, _over(logs.sum(axis=2), count), np.nan)
    spread = np.where(known, logs - centre[:, :, None], 0.0)
    beta = np.sqrt(_over((spread**2).sum(axis=2), count - 1))
    found |= {"median": np.exp(centre), "dispersion": np.where(whole, beta, np.nan)}
    for share in wanted.contact:
        name = f"contact_{100 * share:g}"
        for suffix, factors in zip(("", "_low", "_high"), _quantiles(count, share), strict=True):
            found[name + suffix] = np.exp(centre + factors * beta)
    errors = np.where(np.isfinite(rule.errors), rule.errors, -1.0).max(axis=2)
    found["error"] = np.where(none | (errors < 0), np.nan, errors)
    return found


def _over(total: np.ndarray, count: np.ndarray) -> np.ndarray:
    return np.divide(total, count, out=np.full(total.shape, np.nan), where=count > 0)


def _percentile(ordered: np.ndarray, count: np.ndarray, share: float) -> np.ndarray:
    """Linear between the order statistics, as numpy.percentile has it; `ordered` along axis 2, infinite where there is
    no value."""
    place = share * np.maximum(count - 1, 0)
    low = np.floor(place).astype(int)
    high = np.minimum(low + 1, np.maximum(count - 1, 0))
    one, other = (np.take_along_axis(ordered, each[:, :, None], axis=2)[:, :, 0] for each in (low, high))
    with np.errstate(invalid="ignore"):
        found = one + (place - low) * (other - one)
    return np.where(count > 0, found, np.nan)


def _quantiles(count: np.ndarray, probability: float) -> list[np.ndarray]:
    """By how many standard deviations above the mean of the logarithms the gap lies, and its confidence interval.

    The interval is exact for a normal sample: sqrt(n) times the distance of the quantile from the mean, over the
    standard deviation, has Student's noncentral distribution.
    """
    found = [np.full(count.shape, np.nan) for _ in range(3)]
    for number in np.unique(count[count > 1]):
        for array, factor in zip(found, _factors(int(number), probability), strict=True):
            array[count == number] = factor
    return found


@cache
def _factors(number: int, probability: float) -> tuple[float, float, float]:
    from scipy import stats  # here, so that other commands do not load it

    z = float(stats.norm.isf(probability))
    root = np.sqrt(number)
    if number < FEWEST:
        return z, np.nan, np.nan
    low, high = (float(stats.nct.ppf(p, number - 1, z * root)) / root for p in _tails())
    return z, low, high


def _tails() -> tuple[float, float]:
    return (1 - CONFIDENCE) / 2, (1 + CONFIDENCE) / 2


# The study with nothing between its buildings


def _all_facing(apart: Study, point: Point, case: str) -> tuple[Link, ...]:
    """Every pair of floors, and of slabs and columns, that face each other, with nothing between them."""
    row = apart.group(point)
    assert row is not None  # the study was validated at every point
    links: list[Link] = []
    for left, pair in enumerate(pairwise(row.buildings)):
        floors, strikes = meetings(*pair)  # slabs beside columns too, whether or not their share is known
        links += [Link.apart(left, *both) for both in floors]
        links += [Link.apart(left, s.left_floor, s.right_floor, s.left_at, s.right_at) for s in strikes]
    return tuple(links)


def gaps_of_cases(plan: Plan, point: Point) -> Iterator[tuple[str, dict[LinkPlace, float]]]:
    """The cases of the study at a point of a plan of `expand_gap`, each with its gaps [m] by place; once for every set
    of gaps that the sweep of the study gives it. Places are named as those of a plan of `expand_gap`.

    Left out are cases in which something acts between the buildings before a gap has closed, so that they do not move
    alone, and those without links.
    """
    study, choices, kept = plan.study.written, list[range | list[int]](), iter(point)
    assert study is not None
    for axis in study.swept:
        own, keys = _kept(axis)
        there: range | list[int] = range(len(keys))
        if own:
            wanted = next(kept)
            number = {key: place for place, key in enumerate(dict.fromkeys(keys))}
            there = [place for place in there if number[keys[place]] == wanted]
        choices.append(there if any(path[0] == "cases" for path in axis.paths) else there[:1])
    for case in study.model.cases:
        seen = set()
        for whole in product(*choices):
            links = study.links(whole, case) or ()
            if not links or not all(link.law.subtracts_gap for link in links):
                continue
            gaps: dict[LinkPlace, float] = {}
            for link in links:
                columns = "left columns" if link.left_at < 1.0 else "right columns" if link.right_at < 1.0 else ""
                place = link.left, link.left_floor, link.right_floor, columns
                gaps[place] = min(link.gap, gaps.get(place, link.gap))
            if (key := tuple(gaps.items())) not in seen:
                seen.add(key)
                yield case, gaps


def _kept(axis: SweepAxis) -> tuple[list[int], list[tuple[str, ...]]]:
    """Which keys of an axis change buildings or motions, and the values of those keys at every point of it."""
    kept = [number for number, path in enumerate(axis.paths) if path[0] not in _BETWEEN]
    return kept, [tuple(str(values[number]) for number in kept) for values in axis.given]


def _with_nothing_between(study: Study) -> Study:
    """The study with one case, in which nothing stands between the buildings, and without the axes of links."""
    root, mark = study.root, study.root.mark
    axes = Items((), mark)
    for axis in study.swept:
        kept, keys = _kept(axis)
        values = dict(zip(keys, axis.given, strict=True))
        if kept:
            columns = {
                axis.names[n]: Items([row[n] for row in values.values()], mark, [mark] * len(values)) for n in kept
            }
            axes.append(Map(columns, mark, dict.fromkeys(columns, (mark, mark))))
            axes.marks.append(mark)
    marks = dict.fromkeys(("cases", "sweep"), (mark, mark)) | root.marks
    tree = Map({name: node for name, node in root.items() if name not in _ASIDE}, mark, marks)
    nothing = Map({"link": "none"}, mark, {"link": (mark, mark)})
    tree["cases"] = Map({APART: nothing}, mark, {APART: (mark, mark)})
    tree["sweep"] = axes
    return Study(study.path, study.text, tree, written=study)
