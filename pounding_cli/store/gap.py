"""The table `gap`: required separations over the motions, exact and by rules, at every pair of floors that face."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from pounding_cli.model.links import LinkPlace
from pounding_cli.model.meetings import meetings
from pounding_cli.model.scene import Analysis
from pounding_cli.model.separation import (
    absolute_sum,
    asce7_displacement,
    cross_correlation,
    double_difference,
    first_mode_damping,
    gb50011_width,
    root_of_squares,
)
from pounding_cli.store.answers import Column, Read, Table, place_columns

if TYPE_CHECKING:
    from pounding_cli.study import Plan
    from pounding_cli.study.gap_keys import GapSpec

EXACT = "exact"
"""Name among the rules of what is required: the largest closing over time, located within the step it lies in."""

BLOCK_ROWS = 200_000
"""Widths of single motions that are looked at together, about."""

CONFIDENCE = 0.90
"""Of the interval of a gap for a probability of contact [-]."""

_OF_COLUMNS = (
    "building whose columns, in the storey below its floor, a slab of the other faces: left or right; empty where two "
    "slabs face each other"
)


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


def gap_tables(plan: Plan, read: Read, _responses: object) -> list[Table]:
    """The table `gap` of a plan of `pound gap`."""
    return [Table("gap", _blocks(plan, read))]


def _blocks(plan: Plan, read: Read) -> Iterator[list[Column]]:
    """The table, some points of the sweep at a time."""
    places = sorted({link.place for row in plan.rows for link in row.links})
    points = list(np.ndindex(*(len(axis.values) for axis in plan.axes)))
    # what the scenes did, points first, without the one case
    whole = {name: read(name) for name in ("max_closing", "displacement", "error_estimate")}
    whole = {name: array.reshape(len(points), *array.shape[len(plan.axes) + 1 :]) for name, array in whole.items()}
    step = max(1, BLOCK_ROWS // (len(places) * len(plan.analyses) * max(10, len(plan.records))))
    for begin in range(0, len(points), step):
        here = slice(begin, begin + step)
        yield _block(plan, points[here], places, {name: array[here] for name, array in whole.items()})


def _block(
    plan: Plan, points: list[tuple[int, ...]], places: list[LinkPlace], found: Mapping[str, np.ndarray]
) -> list[Column]:
    """The rows at some points; `found` : variables, shape (points, analyses, ...)."""
    wanted = plan.study.model.gap  # type: ignore[attr-defined]  # a section that the registry adds
    facts = _Facts(plan, points, places)
    parts = [_statistics(rule, wanted) for rule in _rules(plan, found, facts, wanted)]
    exact = parts[0]
    for part in parts:
        with np.errstate(divide="ignore", invalid="ignore"):
            part["over_exact"] = part["mean"] / exact["mean"]
    # rows: point, analysis, pair of floors, rule; only floors that face each other at that point
    shape = (len(points), len(plan.analyses), len(places), len(parts))
    there = np.broadcast_to(facts.faces[:, None, :, None], shape).copy()
    there &= np.stack([part["motions"] >= 0 for part in parts], axis=-1)
    index = np.nonzero(there)

    def spread(values: list, axis: int) -> np.ndarray:
        return np.array(values, dtype=object if isinstance(values[0], str) else None)[index[axis]]

    names = plan.buildings
    columns = place_columns(plan.axes, [points[number] for number in index[0]])
    columns += [
        Column("analysis", spread(list(plan.analyses), 1), "elastic or inelastic storeys"),
        Column("left", spread([names[left] for left, *_ in places], 2), "building left of the gap"),
        Column("right", spread([names[left + 1] for left, *_ in places], 2), "building right of the gap"),
        Column("floor", spread([floor for _, floor, *_ in places], 2), "floor of the left building", "1"),
        Column("right_floor", spread([floor for _, _, floor, _ in places], 2), "floor of the right building", "1"),
        Column("columns", spread([name.removesuffix(" columns") for *_, name in places], 2), _OF_COLUMNS),
        Column("height", facts.heights[index[0], index[2]], "of the slabs above the ground", "m"),
        Column("rule", spread([part["name"] for part in parts], 3), "exact, or the rule that estimates it"),
    ]
    width = plan.study.unit("gap")
    for name, text in _meanings(wanted).items():
        values = np.stack([part[name] for part in parts], axis=-1)[index]
        is_length = name not in ("motions", "dispersion", "over_exact")
        columns.append(Column(name, values, text, "m" if is_length else "1", width if is_length else None))
    return columns


def _meanings(wanted: GapSpec) -> dict[str, str]:
    """The columns of numbers and what each means."""
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
        said = f"gap with a probability of contact of {100 * share:g} % by the lognormal fit"
        found |= {
            name: said,
            f"{name}_low": f"lower end of the {CONFIDENCE:.0%} confidence interval of that gap",
            f"{name}_high": f"upper end of the {CONFIDENCE:.0%} confidence interval of that gap",
        }
    found["error"] = "largest numerical error of a motion's separation; no statistic but those of the fit exceeds it"
    found["over_exact"] = "mean over the mean of the exact separations"
    return found


class _Facts:
    """What the buildings are at every point of the sweep; shapes (points, pairs of floors)."""

    def __init__(self, plan: Plan, points: list[tuple[int, ...]], places: list[LinkPlace]) -> None:
        shape = (len(points), len(places))
        self.correlations, self.heights, self.lower, self.code = (np.full(shape, np.nan) for _ in range(4))
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
                for array in (self.correlations, self.heights, self.lower, self.code):
                    array[number] = array[same]
                self.upper[:, number] = self.upper[:, same]
        self.faces = np.isfinite(self.heights)

    def _enter(self, plan: Plan, number: int, point: tuple[int, ...]) -> None:
        row = [plan.study.building(point, place) for place in range(len(plan.buildings))]
        damping = [first_mode_damping(building) for building in row]
        allowed = [plan.study.resolver.design_displacements(point, name) for name in plan.study.model.group]
        there: dict[tuple[int, int, int, str], tuple[float, float]] = {}
        for left, pair in enumerate(pairwise(row)):
            floors, strikes = meetings(*pair)
            there |= {(left, *both, ""): (1.0, 1.0) for both in floors}
            for strike in strikes:
                name = f"{('left', 'right')[strike.side]} columns"
                there[left, strike.left_floor, strike.right_floor, name] = strike.left_at, strike.right_at
        for column, place in enumerate(self.places):
            if place not in there:
                continue
            left, left_floor, right_floor, _ = place
            a, b = row[left], row[left + 1]
            slab = a.elevation[left_floor - 1] if there[place][0] == 1.0 else b.elevation[right_floor - 1]
            self.heights[number, column] = slab
            self.upper[:, number, column] = [at * at * (3.0 - 2.0 * at) for at in there[place]]
            self.lower[number, column] = min(a.elevation[-1], b.elevation[-1])
            if damping[left] > 0 and damping[left + 1] > 0:
                self.correlations[number, column] = cross_correlation(
                    float(a.periods[0]), float(b.periods[0]), damping[left], damping[left + 1]
                )
            one, other = allowed[left], allowed[left + 1]
            if one is not None and other is not None:
                ends = zip((one, other), (left_floor, right_floor), self.upper[:, number, column], strict=True)
                self.code[number, column] = sum(
                    part * d[floor - 1] + (1.0 - part) * (d[floor - 2] if floor > 1 else 0.0) for d, floor, part in ends
                )


def _rules(plan: Plan, found: Mapping[str, np.ndarray], facts: _Facts, wanted: GapSpec) -> Iterator[Rule]:
    """The exact separations first, then the rules that say something here."""
    analyses = len(plan.analyses)
    # fault: required-gap
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
    if wanted.asce7 is not None and str(Analysis.ELASTIC) in plan.analyses:
        factors = wanted.asce7.Cd, wanted.asce7.R
        elastic = np.array([word == Analysis.ELASTIC for word in plan.analyses])[:, None, None]
        width = np.where(elastic, root_of_squares(*(asce7_displacement(each, *factors) for each in (a, b))), np.nan)
        yield Rule("ASCE 7-10", width, np.where(elastic, reach * factors[0] / factors[1], np.nan))
    if wanted.gb50011 is not None:
        system = wanted.gb50011.intensity, wanted.gb50011.structure
        joint = np.vectorize(lambda height: gb50011_width(height, *system) if height == height else np.nan)
        yield _of_no_motion("GB 50011-2010", joint(facts.lower), analyses)
    if np.isfinite(facts.code).any():
        yield _of_no_motion(_edition(plan), facts.code, analyses)


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
    editions = {getattr(spec, "code", "UBC") for spec in specs}
    return editions.pop() if len(editions) == 1 else "UBC"


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
    std = np.sqrt(_over((away**2).sum(axis=2), count - 1))  # fault: gap-deviation
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

    z = float(stats.norm.isf(probability))  # fault: gap-of-a-probability
    root = np.sqrt(number)
    low, high = (float(stats.nct.ppf(p, number - 1, z * root)) / root for p in _tails())  # fault: gap-interval
    return z, low, high


def _tails() -> tuple[float, float]:
    return (1 - CONFIDENCE) / 2, (1 + CONFIDENCE) / 2
