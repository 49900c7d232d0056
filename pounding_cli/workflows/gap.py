"""`pound gap`: required separations over the motions, exact and by rules, at every pair of floors that face; what that
means for the gaps of the cases; distances to a property line."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from functools import cache, partial
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import pandas as pd

from pounding_cli.model.links import APART, Link
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
from pounding_cli.model.wall import Wall
from pounding_cli.results.solved import most_storeys
from pounding_cli.study import Plan, Study, expand
from pounding_cli.study.axes import SweepAxis
from pounding_cli.study.file import Map
from pounding_cli.study.study import Point
from pounding_cli.workflows.gap_rate import intensity_of, of_rate
from pounding_cli.workflows.hazard import hazard_of
from pounding_cli.workflows.workflow import Columns, Found, Table, Workflow, swept, tabled

if TYPE_CHECKING:
    import xarray as xr

    from pounding_cli.batch.solve import Solver
    from pounding_cli.model.building import Building

EXACT = "exact"
"""Name among the rules of what is required: the largest closing over time, located within the step it lies in."""

CONFIDENCE = 0.90
"""Of the interval of a gap for a probability of contact [-]."""

FEWEST = 5
"""Motions from which that interval is told: fewer do not tell how much the gap varies from motion to motion."""

CASES, LINE = "gap_cases", "property_line"
"""Names of the tables of the gaps of the cases and of the distances to a property line."""

UBC = "UBC"

_BETWEEN = ("cases", "impact", "laws")
"""Sections that say what stands between the buildings."""

_ASIDE = (*_BETWEEN, "sweep", "keep", "report", "claims", "uncertain")
"""Sections without a meaning where the buildings stand alone."""

_WHERE = ("left", "right", "building", "side", "floor", "right_floor", "columns", "height")
"""Columns that say where a row stands."""

_COLUMNS: Columns = {
    "left": ("", "building left of the gap"),
    "right": ("", "building right of the gap"),
    "floor": ("1", "floor, of the left building where two face each other"),
    "right_floor": ("1", "floor of the right building"),
    "columns": ("", "building whose columns, in the storey below its floor, a slab of the other faces: left or right; "
                "empty where two slabs face each other"),
    "side": ("", "of the building that faces the line"),
    "height": ("m", "of the slabs, or the floor, above the ground"),
    "rule": ("", "exact, or the rule"),
    "motions": ("1", "number of motions behind the row; 0 where the rule depends on none"),
    "mean": ("m", "mean over the motions"),
    "std": ("m", "standard deviation over the motions (n - 1)"),
    "mean_plus_std": ("m", "mean plus one standard deviation"),
    "largest": ("m", "largest of the motions"),
    "median": ("m", "median of the lognormal fit"),
    "dispersion": ("1", "standard deviation of the logarithm (n - 1)"),
    "error": ("m", "largest numerical error of a motion's separation; no statistic but those of the fit exceeds it"),
    "over_exact": ("1", "mean over the mean of the exact separations"),
    "gap": ("m", "of the case at these floors"),
    "required": ("m", "by the rule at these floors, which lack most or have least to spare; largest of the motions"),
    "enough": ("", "whether the gap is wide enough at all floors of the pair, under all motions; unknown where scenes "
               "failed"),
    "enough_for": ("1", "motions for which it is"),
}  # fmt: skip


class Rule(NamedTuple):
    """Separations by one rule at some places.

    values, errors : with their numerical errors [m], shape (places, analyses, motions), of a rule that does not need
        motions (places, 1, 1); NaN where it says nothing
    """

    name: str
    values: np.ndarray
    errors: np.ndarray
    needs_motions: bool = True


class Gap(Workflow):
    """The required separations of all neighbours over the motions."""

    name = "gap"

    def check(self, study: Study) -> None:
        """A rate of contact takes an intensity and its hazard curve."""
        if study.model.gap.rate is not None:
            hazard_of(study, "gap", intensity_of(study)[1])

    def plan(self, study: Study) -> Plan:
        """The scenes whose closings are the required separations: every motion and analysis, with nothing between the
        buildings; swept keys of links are left out, those of buildings and motions stay."""
        self.check(study)
        apart = _with_nothing_between(study)
        return dataclasses.replace(expand(apart, partial(_all_facing, apart)), workflow="gap")

    def run(self, study: Study, solver: Solver) -> Found:
        """The tables of what is required, of what that means for the cases, and of the property lines."""
        plan = self.plan(study)
        data = solver.dataset(plan)
        places = _facing(plan)
        rules = _rules(plan, data, places)
        separations = _separations(plan, places, rules)
        tables = [
            _required(plan, "gap", places, separations, rules),
            _of_cases(plan, places, separations, rules),
            _of_lines(plan, data),
        ]
        if study.model.gap.rate is not None:
            exact = separations[separations["rule"] == 0].join(places["number"], on="row")
            keys = ["point", "analysis", "number", "motion"]
            worst = exact.groupby(keys)["value"].agg(lambda each: each.max(skipna=False)).reset_index()
            tables.append(of_rate(plan, worst, CONFIDENCE))
        return Found(plan, data, tables)


ASKED = Gap()


# Statistics


def statistics(
    separations: pd.DataFrame, keys: list[str], percentiles: Sequence[float], contact: Sequence[float]
) -> pd.DataFrame:
    """Statistics over the motions, a row for every combination of `keys` of which some motion has a value.

    separations : `value` and `error` [m], a row a motion; NaN where there is none
    percentiles, contact : wanted shares of the motions and probabilities of contact [-]; the latter by a lognormal fit
        with an interval of CONFIDENCE, where all of several motions have a value above 0
    """
    known = separations[separations["value"].notna()]
    known = known.assign(log=np.log(known["value"].where(known["value"] > 0)))
    groups = known.groupby(keys)
    found = pd.DataFrame(groups["value"].agg(motions="size", mean="mean", std="std"))
    found["mean_plus_std"] = found["mean"] + found["std"]
    found["largest"] = groups["value"].max()
    for share in percentiles:
        found[f"percentile_{100 * share:g}"] = groups["value"].quantile(share)
    is_fitted = (groups["log"].count() == found["motions"]) & (found["motions"] > 1)
    centre, spread = groups["log"].mean().where(is_fitted), groups["log"].std().where(is_fitted)
    found["median"], found["dispersion"] = np.exp(centre), spread
    for share in contact:
        factors = found["motions"].map(partial(_factors, probability=share))
        for number, end in enumerate(("", "_low", "_high")):
            found[f"contact_{100 * share:g}{end}"] = np.exp(centre + factors.str[number].astype(float) * spread)
    found["error"] = groups["error"].max()
    return found


@cache
def _factors(motions: int, probability: float) -> tuple[float, float, float]:
    """By how many standard deviations above the mean of the logarithms the gap lies, and its confidence interval.

    The interval is exact for a normal sample: sqrt(n) times the distance of the quantile from the mean, over the
    standard deviation, has Student's noncentral distribution.
    """
    from scipy import stats  # here, so that other commands do not load it

    z, root = float(stats.norm.isf(probability)), np.sqrt(motions)
    if motions < FEWEST:
        return z, np.nan, np.nan
    low, high = stats.nct.ppf([(1 - CONFIDENCE) / 2, (1 + CONFIDENCE) / 2], motions - 1, z * root) / root
    return z, float(low), float(high)


def _separations(plan: Plan, places: pd.DataFrame, rules: Sequence[Rule]) -> pd.DataFrame:
    """`value` and `error` [m] of every point, analysis, place, rule and motion, by number from 0.

    places : a row for each that `rules` tell of, with the numbers of its point and place
    """
    parts = []
    for number, rule in enumerate(rules):
        shape = len(places), len(plan.analyses), rule.values.shape[2]
        row, analysis, motion = (each.ravel() for each in np.indices(shape))
        value, error = (np.broadcast_to(each, shape).ravel() for each in (rule.values, rule.errors))
        columns = {"row": row, "analysis": analysis, "motion": motion, "rule": number, "value": value, "error": error}
        parts.append(pd.DataFrame(columns))
    return pd.concat(parts, ignore_index=True).join(places[["point", "place"]], on="row")


def _required(plan: Plan, name: str, places: pd.DataFrame, separations: pd.DataFrame, rules: Sequence[Rule]) -> Table:
    """Statistics of what is required: a row for every point, analysis, place and rule that says something there."""
    wanted, keys = plan.study.model.gap, ["point", "analysis", "place", "rule"]
    rows = statistics(separations, keys, wanted.percentiles, wanted.contact)
    exact = rows["mean"].where(rows.index.get_level_values("rule") == 0)
    rows["over_exact"] = rows["mean"] / exact.groupby(level=keys[:3]).transform("first")
    rows = rows.reset_index()
    numbers = list(rows.columns[len(keys) :])
    rows["motions"] *= np.array([rule.needs_motions for rule in rules], int)[rows["rule"]]
    meant = dict(_COLUMNS)
    for share in wanted.percentiles:
        meant[f"percentile_{100 * share:g}"] = "m", f"{100 * share:g} % of the motions need no more, interpolated"
    for share in wanted.contact:
        said = "distance that the floor reaches" if name == LINE else "gap"
        said += f" with a probability{'' if name == LINE else ' of contact'} of {100 * share:g} % by the lognormal fit"
        meant[f"contact_{100 * share:g}"] = "m", f"{said}; with its interval from {FEWEST} motions on"
    where = [column for column in places.columns if column in _WHERE]
    return _told(plan, name, rows.merge(places, on=["point", "place"], how="left"), rules,
                 ["analysis", *where, "rule", *numbers], meant)  # fmt: skip


def _told(
    plan: Plan, name: str, rows: pd.DataFrame, rules: Sequence[Rule], columns: list[str], meant: Columns = _COLUMNS
) -> Table:
    """A table of rows whose points, analyses and rules stand there by number; widths in the study's unit of gaps."""
    points = list(np.ndindex(*plan.shape[:-3]))
    for column, names in (("analysis", plan.analyses), ("rule", [rule.name for rule in rules])):
        rows = rows.assign(**{column: np.array(names, object)[rows[column].astype(int)]})
    frame = pd.concat([swept(plan.axes, [points[number] for number in rows["point"]]), rows[columns]], axis=1)
    unit = plan.study.unit("gap")
    widths = [each for each in columns if each != "height" and pd.api.types.is_float_dtype(frame[each])]
    shown = {each: unit for each in widths if each not in ("dispersion", "over_exact")}
    return tabled(name, frame, meant, plan.axes, shown)


# What floors that face each other require


def _facing(plan: Plan) -> pd.DataFrame:
    """Floors, and slabs and columns, that face each other: a row for each at each point of the sweep.

    `left_at` and `right_at` are the heights of both ends in the storeys below their floors, 1 at a floor.
    """
    points, links = int(np.prod(plan.shape[:-3])), plan.links
    kind, left_at, right_at = (each.reshape(points, -1) for each in (links.kind, links.left_at, links.right_at))
    point, place = np.nonzero(kind != "")
    left, floor, right_floor, name = (np.array(each)[place] for each in zip(*links.places, strict=True))
    names = np.array(plan.buildings, object)
    found = pd.DataFrame({
        "point": point, "place": place, "number": left, "left": names[left], "right": names[left + 1], "floor": floor,
        "right_floor": right_floor, "columns": [each.removesuffix(" columns") for each in name],
        "left_at": left_at[point, place], "right_at": right_at[point, place],
    })  # fmt: skip
    rows = [[plan.study.building(at, each) for each in range(len(names))] for at in np.ndindex(*plan.shape[:-3])]
    beside_wall = np.array([isinstance(rows[at][each], Wall) for at, each in zip(point, left, strict=True)], bool)
    is_left = (found["left_at"] == 1.0) & ~beside_wall
    slabs = zip(point, np.where(is_left, left, left + 1), np.where(is_left, floor, right_floor), strict=True)
    return found.assign(height=[rows[at][building].level(level) for at, building, level in slabs])


def _by_floor(plan: Plan, of: Callable[[Point, int, str], np.ndarray | None]) -> np.ndarray:
    """Something of every floor, shape (points, buildings, floors); NaN where there is none.

    of : (point, place of the building, name of its type) -> of its floors
    """
    points, names = list(np.ndindex(*plan.shape[:-3])), plan.study.model.group
    found = np.full((len(points), len(names), most_storeys(plan)), np.nan)
    for number, place in np.ndindex(found.shape[:2]):
        values = of(points[number], place, names[place])
        if values is not None:
            found[number, place, : len(values)] = values
    return found


def _codes(plan: Plan) -> dict[str, np.ndarray]:
    """Displacements that codes expect of every floor [m], by rule, shape (points, buildings, floors)."""
    study = plan.study
    return {
        UBC: _by_floor(plan, lambda at, _, name: study.design_displacements(at, name)),
        ASCE7: _by_floor(plan, lambda at, _, name: study.code_displacements(at, name).get(ASCE7)),
        EN1998: _by_floor(plan, lambda at, _, name: study.code_displacements(at, name).get(EN1998)),
    }


def _rules(plan: Plan, data: xr.Dataset, places: pd.DataFrame) -> list[Rule]:
    """The exact separations first, then the rules that say something here."""
    study, points = plan.study, list(np.ndindex(*plan.shape[:-3]))
    point, place, left = (places[name].to_numpy() for name in ("point", "place", "number"))
    ends = [(left, places["floor"].to_numpy(), places["left_at"].to_numpy()),
            (left + 1, places["right_floor"].to_numpy(), places["right_at"].to_numpy())]  # fmt: skip

    row = [study.building(points[0], each) for each in range(len(plan.buildings))]
    is_wall = np.array([isinstance(each, Wall) for each in row])

    def moved(displacements: np.ndarray, base: np.ndarray | None = None) -> list[np.ndarray]:
        """Displacements of both ends, shape (places, analyses, motions), those of columns between their floors.

        displacements, base : shape (points, analyses, motions, buildings, floors) and that of the base; codes do not
            tell how far a base moves
        """
        bases = np.zeros(displacements.shape[:-1]) if base is None else base
        whole, found = np.concatenate([bases[..., None], displacements], axis=-1), []
        whole[..., is_wall, :] = np.nan_to_num(whole[..., is_wall, :])
        for building, floor, at in ends:
            part = (at * at * (3.0 - 2.0 * at))[:, None, None]
            level = np.where(is_wall[building], 1, floor)
            above, below = (whole[point, :, :, building, each] for each in (level, np.maximum(level - 1, 0)))
            is_known = ((level > 0) | (base is not None))[:, None, None]
            found.append(np.where(is_known, np.where(part == 1.0, above, part * above + (1.0 - part) * below), np.nan))
        return found

    exact = _points_first(plan, data["max_closing"])[point, :, :, place]
    relative = _points_first(plan, data["error_estimate"])
    most = np.nanmax(_points_first(plan, data["max_closing"]), axis=-1, initial=0.0)
    one, other = moved(_points_first(plan, data["displacement"]), _points_first(plan, data["sway"]))
    reach = relative[point] * absolute_sum(one, other)  # a relative change of both peaks moves no rule by more

    def of_pairs(value: Callable[[Building, Building], float]) -> np.ndarray:
        """Something of both buildings, shape (places, 1, 1)."""
        kept = cache(lambda at, place: value(study.building(at, place), study.building(at, place + 1)))
        key = [study.key(each, ("buildings", "group")) for each in points]
        return np.array([kept(key[p], b) for p, b in zip(point, left, strict=True)])[:, None, None]

    rules = [
        Rule(EXACT, exact, (relative * most)[point]),
        Rule("ABS", absolute_sum(one, other), reach),
        Rule("SRSS", root_of_squares(one, other), reach),
        Rule("DDC", double_difference(one, other, of_pairs(_correlation)), reach),
    ]
    if (asked := study.model.gap.gb50011) is not None:
        lower = of_pairs(lambda a, b: min(a.elevation[-1], b.elevation[-1]))
        joint = np.vectorize(lambda height: gb50011_width(height, asked.intensity, asked.structure))(lower)
        rules.append(_of_no_motion("GB 50011-2010", joint))
    for name, displacements in _codes(plan).items():
        one, other = moved(displacements[:, None, None])
        if name == UBC:
            rules.append(_of_no_motion(_edition(plan), one + other))
        elif name == ASCE7:
            rules.append(_of_no_motion(name, root_of_squares(one, other)))
        else:
            rules.append(_of_no_motion(name, en1998_separation(one, other, of_pairs(_same_floors))))
    return rules


def _points_first(plan: Plan, values: xr.DataArray) -> np.ndarray:
    """Values of the one case, shape (points, analyses, motions, ...)."""
    return values.values.reshape(-1, *values.shape[len(plan.axes) + 1 :])


def _of_no_motion(name: str, widths: np.ndarray) -> Rule:
    return Rule(name, widths, np.zeros_like(widths), needs_motions=False)


def _correlation(left: Building, right: Building) -> float:
    """Of the first modes; NaN where one has no damping."""
    damping = first_mode_damping(left), first_mode_damping(right)
    if min(damping) <= 0:
        return np.nan
    return cross_correlation(float(left.periods[0]), float(right.periods[0]), *damping)


def _same_floors(left: Building, right: Building) -> bool:
    """Whether the floors of two neighbours have the same elevations, up to the lower roof."""
    count = min(left.storeys, right.storeys)
    return bool((np.abs(left.elevation[:count] - right.elevation[:count]) <= FLOOR_TOLERANCE).all())


def _edition(plan: Plan) -> str:
    """The edition of the UBC that set the yield shears; "UBC" where there are several."""
    specs = (plan.study.model.buildings[name].yield_ for name in plan.study.model.group)
    editions = {getattr(spec, "code", UBC) for spec in specs}
    return editions.pop() if len(editions) == 1 else UBC


# Distances to a property line


def _of_lines(plan: Plan, data: xr.Dataset) -> Table:
    """How far every floor moves to either side, and what codes ask of the distance to a property line."""
    height = _by_floor(plan, lambda at, place, _: plan.study.building(at, place).elevation)
    point, building, floor, side = (each.ravel() for each in np.indices((*height.shape, 2)))
    there = np.isfinite(height[point, building, floor])
    point, building, floor, side = (each[there] for each in (point, building, floor, side))
    places = pd.DataFrame({
        "point": point, "place": np.ravel_multi_index((building, floor, side), (*height.shape[1:], 2)),
        "building": np.array(plan.buildings, object)[building], "side": np.array(["left", "right"], object)[side],
        "floor": floor + 1, "height": height[point, building, floor],
    })  # fmt: skip

    def at(name: str) -> np.ndarray:
        return _points_first(plan, data[name])[point, :, :, building, floor]

    exact = np.where(side[:, None, None] == 0, -at("displacement_min"), at("displacement_max"))
    most = np.nanmax(_points_first(plan, data["displacement"]), axis=-1, initial=0.0)
    errors = _points_first(plan, data["error_estimate"])[point] * most[point, :, :, building]
    rules = [Rule(EXACT, exact, errors)]
    rules += [_of_no_motion(name, widths[point, building, floor][:, None, None])
              for name, widths in _codes(plan).items() if name != UBC]  # fmt: skip
    return _required(plan, LINE, places, _separations(plan, places, rules), rules)


# The gaps of the cases


def _of_cases(plan: Plan, places: pd.DataFrame, separations: pd.DataFrame, rules: Sequence[Rule]) -> Table:
    """Whether the gaps of the cases are enough: a row for every point, case, analysis, pair of neighbours and rule.

    A gap is enough where it is no narrower than what is required and its numerical error, at all floors of the pair.
    """
    pair = ["point", "given", "number", "analysis", "rule"]
    gaps = _gaps(plan).merge(places, on=["point", "place"])
    rows = separations.merge(gaps, on=["point", "place"])
    rows["fits"] = rows["value"] + rows["error"].fillna(0.0) <= rows["gap"]
    rows["known"] = rows["value"].notna().groupby([rows[key] for key in [*pair, "motion"]]).transform("all")
    all_known = rows.groupby(pair)["known"].all()
    rows = rows[rows["known"]]
    fits = rows.groupby([*pair, "motion"])["fits"].all().groupby(pair)
    found = fits.agg(enough_for="sum", motions="size", enough="all").join(all_known)
    floors = rows.groupby([*pair, "place"], as_index=False).agg(gap=("gap", "first"), required=("value", "max"))
    spare = floors["gap"] - floors["required"]
    worst = floors.loc[spare.groupby([floors[key] for key in pair]).idxmin()] if len(floors) else floors
    found = worst.merge(found.reset_index(), on=pair, how="left")
    found = found.merge(gaps.drop(columns="gap"), on=["point", "given", "number", "place"])
    counts = np.array([rule.needs_motions for rule in rules], int)[found["rule"].astype(int)]
    for column in ("enough_for", "motions"):
        found[column] = counts * found[column].astype(int)
    found["enough"] = np.where(~found["enough"].astype(bool), "no", np.where(found["known"], "yes", "unknown"))
    columns = ["case", "analysis", "left", "right", "floor", "right_floor", "columns", "gap", "rule", "required",
               "enough", "enough_for", "motions"]  # fmt: skip
    return _told(plan, CASES, found, rules, columns)


def _gaps(plan: Plan) -> pd.DataFrame:
    """The gaps of the cases [m] at the places of the plan: at each of its points every set of gaps that the sweep of
    the study gives a case (`given`, by number).

    Left out are cases in which something acts between the buildings before a gap has closed, so that they do not move
    alone, and those without links.
    """
    study = plan.study.written
    assert study is not None
    axes = [_kept(axis) for axis in study.swept]
    number = {place: each for each, place in enumerate(plan.links.places)}
    found: dict[tuple[int, int, tuple[tuple[int, float], ...]], str] = {}
    for whole in np.ndindex(*(len(axis) for axis in study.swept)):
        at = [each[1].index(each[2][place]) for each, place in zip(axes, whole, strict=True) if each[0]]
        point = int(np.ravel_multi_index(at, plan.shape[:-3])) if at else 0
        for place, case in enumerate(study.model.cases):
            links = study.links(whole, case) or ()
            if links and all(link.law.subtracts_gap for link in links):
                gaps: dict[int, float] = {}
                for link in links:
                    columns = "left columns" if link.left_at < 1.0 else "right columns" if link.right_at < 1.0 else ""
                    here = number.get((link.left, link.left_floor, link.right_floor, columns), -1)
                    gaps[here] = min(link.gap, gaps.get(here, link.gap))
                found[point, place, tuple(gaps.items())] = case
    rows = [
        (point, given, case, place, gap)
        for given, ((point, _, gaps), case) in enumerate(sorted(found.items(), key=lambda each: each[0][:2]))
        for place, gap in gaps
    ]
    return pd.DataFrame(rows, columns=["point", "given", "case", "place", "gap"])


# The study with nothing between its buildings


def _kept(axis: SweepAxis) -> tuple[list[int], list[tuple[str, ...]], list[tuple[str, ...]]]:
    """Which keys of an axis change buildings or motions; their different values, and those at every point of it."""
    kept = [number for number, path in enumerate(axis.paths) if path[0] not in _BETWEEN]
    values = [tuple(str(given[number]) for number in kept) for given in axis.given]
    return kept, list(dict.fromkeys(values)), values


def _with_nothing_between(study: Study) -> Study:
    """The study with one case, in which nothing stands between the buildings, and without the axes of links."""
    root, mark = study.root, study.root.mark
    tree = Map({name: node for name, node in root.items() if name not in _ASIDE}, mark, root.marks)
    tree["cases"] = Map({APART: Map({"link": "none"}, mark, {"link": (mark, mark)})}, mark, {APART: (mark, mark)})
    axes = []
    for axis in study.swept:
        kept, different, values = _kept(axis)
        if kept:
            first = [values.index(each) for each in different]
            given, marks = (
                [tuple(each[place][n] for n in kept) for place in first] for each in (axis.given, axis.marks)
            )
            units = tuple(axis.units[n] for n in kept)
            axes.append(SweepAxis(tuple(axis.names[n] for n in kept), given, marks, units))
    return Study(study.path, study.text, tree, axes, study.reader, written=study)


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
