"""`pound gap`: required separations over the motions, exact and by rules, at every pair of floors that face; what that
means for the gaps of the cases; distances to a property line."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from pounding_cli.laws.apart import Apart
from pounding_cli.model.building import Building
from pounding_cli.model.links import Link, LinkPlace
from pounding_cli.model.meetings import FLOOR_TOLERANCE, find_meetings
from pounding_cli.model.separation import (
    ASCE7,
    EN1998,
    UBC,
    absolute_sum,
    cross_correlation,
    double_difference,
    en1998_separation,
    first_mode_damping,
    gb50011_width,
    root_of_squares,
)
from pounding_cli.model.wall import Wall
from pounding_cli.questions.bootstrap import FEWEST_TOLD, draws_of, with_interval
from pounding_cli.questions.frames import columns_of, swept, tabled
from pounding_cli.questions.gap.spec import GapSpec
from pounding_cli.questions.hazard import (
    INTENSITY_KEYS,
    LEAST,
    Hazard,
    gaps_of,
    hazard_of,
    intensity_axis,
    probability,
)
from pounding_cli.questions.question import Answer, StudyQuestion
from pounding_cli.questions.specs import Measure
from pounding_cli.results.solved import most_storeys
from pounding_cli.study import Plan, Study, make_plan
from pounding_cli.study.axes import Axis
from pounding_cli.study.file import Map
from pounding_cli.study.group import Group
from pounding_cli.study.records_spec import PgaSpec, PgvSpec, SaSpec
from pounding_cli.study.swept import Point, Swept, sweep_map
from pounding_cli.tables import Table

if TYPE_CHECKING:
    import xarray as xr

    from pounding_cli.batch.solve import Solver

EXACT = "exact"
"""Name among the rules of what is required: the largest closing over time, located within the step it lies in."""

OF_MOTIONS = (EXACT, "ABS", "SRSS", "DDC")
"""Rules that depend on the motions."""

GB50011 = "GB 50011-2010"

CONFIDENCE = 0.90
"""Of the interval of a gap for a probability of contact [-]."""

DRAWS = 300
"""Draws of the bootstrap over the motions for the interval of a gap for a rate."""

REQUIRED, CASES, LINE, RATE = "gap", "gap_cases", "property_line", "gap_rate"
"""Names of the tables: what floors that face require, the gaps of the cases, distances to a property line, gaps for a
rate of contact."""

_BETWEEN = ("cases", "impact", "laws")
"""Sections that say what stands between the buildings."""

_ASIDE = (*_BETWEEN, "sweep", "keep", "report", "claims", "uncertain")

CodeDisplacements = Mapping[str, Swept[dict[str, np.ndarray]]]
"""Displacements that codes expect [m], by building type and rule."""
"""Sections without a meaning where the buildings stand alone."""

_FACING = ("left", "right", "floor", "right_floor", "columns")
Where = dict[str, Any]
"""Columns that say where something is required; `point` of the sweep by number."""

Rules = dict[str, tuple[Any, Any]]
"""By rule separations and their numerical errors [m], shape (analyses, motions), or one number of a rule that does not
depend on the motions; NaN where it says nothing."""


class Gap(StudyQuestion):
    """The required separations of all neighbours over the motions.

    Raises InputError: a rate of contact without an intensity, or without its hazard curve.

    apart : the study with nothing between its buildings, whose closings are the required separations; swept keys of
        links are left out, those of buildings and motions stay
    axis : number of its axis that varies the intensity; None of one intensity
    levels : intensities [SI]; of a study that asks for a rate, as `hazard` and `axis`
    hazard : how often a year an intensity is exceeded; None where no rate is asked for
    """

    name = "gap"
    spec: GapSpec

    def __init__(self, study: Study) -> None:
        super().__init__(study)
        self.apart = _with_nothing_between(study)
        self.axis, self.levels, self.hazard = None, np.zeros(0), None
        if self.spec.rate is None:
            return
        scale = study.spec.records.scale
        self.axis = intensity_axis(self, self.apart.axes)
        if self.axis is not None:
            axis = self.apart.axes[self.axis]
            measure, levels = Measure(INTENSITY_KEYS.get(axis.names[0], "pga")), [value for (value, *_) in axis.values]
        elif isinstance(scale, PgaSpec | PgvSpec | SaSpec):
            name = type(scale).__name__.removesuffix("Spec").lower()
            measure, levels = Measure(name, getattr(scale, "period", 0.0)), [getattr(scale, name)]
        else:
            hint = "write e.g. `scale: {sa: 0.4 g, period: 0.5 s}` in `records`, and sweep `records.scale.sa`"
            self.add_problem(("rate",), "a rate needs motions that are scaled to an intensity", hint, key=True)
        self.problems.check()
        self.levels, self.hazard = np.array(levels, float), hazard_of(self, measure)

    @cached_property
    def plan(self) -> Plan:
        """The scenes of every motion and analysis, with nothing between the buildings."""
        resolved = self.apart.resolved
        links = {Apart.name: sweep_map(_all_facing, resolved.group)}
        return dataclasses.replace(make_plan(self.apart, dataclasses.replace(resolved, links=links)), workflow="gap")

    def answer(self, solver: Solver) -> Answer:
        """The tables of what is required, of what that means for the cases, and of the property lines."""
        plan = self.plan
        contents = solver.solve_arrays(plan)
        data = contents.dataset()
        separations = _separations(plan, _between_floors(plan, data))
        distances = _separations(plan, _to_lines(plan, data))
        tables = [
            _required(plan, REQUIRED, separations, [*_FACING, "height"]),
            _of_cases(self.study, plan, separations),
            _required(plan, LINE, distances, ["building", "side", "floor", "height"]),
        ]
        if self.hazard is not None:
            tables.append(self._of_rate(self.hazard, separations[separations["rule"] == EXACT]))
        return Answer(plan, contents, tables)

    def _of_rate(self, hazard: Hazard, exact: pd.DataFrame) -> Table:
        """The gap for the rate that the study allows: a row for every point of the other axes, analysis and pair.

        exact : the separations, of which the largest over the floors of a pair counts; NaN of a scene that failed
        """
        plan, rate, points = self.plan, self.spec.rate, _points(self.plan)
        assert rate is not None  # that is where the hazard comes from
        keys = ["point", "analysis", "number", "motion"]
        worst = exact.groupby(keys, observed=True)["value"].agg(lambda each: each.max(skipna=False)).reset_index()
        intensities = self.levels[[0 if self.axis is None else at[self.axis] for at in points]]
        rows = worst.join(swept(plan.axes, points).assign(intensity=intensities), on="point")
        others = [name for number, each in enumerate(plan.axes) if number != self.axis for name in each.names]
        keys, found = [*others, "analysis", "number"], list[dict[str, Any]]()
        for place, mine in rows.groupby(keys, observed=True, sort=False):
            row: dict[str, Any] = dict(zip(keys, place, strict=True))
            table = mine.pivot_table("value", "intensity", "motion", dropna=False).dropna(axis=1)
            logs, x = np.log(table.clip(lower=LEAST).to_numpy()), np.log(table.index.to_numpy())
            count, (left, right) = logs.shape[1], plan.buildings[row["number"] : row["number"] + 2]
            row |= {"left": left, "right": right, "motions": count, "intensities": len(x)}
            row |= {"rate": rate, "probability": probability(rate)}
            if count > 1:
                gaps = gaps_of(hazard, rate, x, logs, draws_of(count, DRAWS))
                row |= with_interval("gap", gaps, CONFIDENCE, count)
            found.append(row)
        frame = pd.DataFrame(found).reindex(columns=[*others, *columns_of(RATE)])
        return tabled(RATE, frame, plan.axes, dict.fromkeys(["gap", "gap_low", "gap_high"], plan.study.unit("gap")))


# What is required where


def _between_floors(plan: Plan, data: xr.Dataset) -> Iterator[tuple[Where, Rules]]:
    """Floors, and slabs and columns, that face each other, with the rules that say something there.

    `place` is their number among `plan.links`, `number` that of the left building.
    """
    study, links, edition = plan.study, plan.links, _edition(plan)
    closings, errors, moves, bases = (
        _by_point(plan, data, name) for name in ("max_closing", "error_estimate", "displacement", "sway")
    )
    moves = np.concatenate([bases[..., None], moves], axis=-1)
    displacements = _code_displacements(plan)
    for point, at in enumerate(_points(plan)):
        group = [study.building(at, each) for each in range(len(plan.buildings))]
        codes, closing, error, moved = (
            _codes(plan, at, displacements),
            closings[point],
            errors[point],
            moves[point].copy(),
        )
        for each in (moved, *codes.values()):
            each[..., [isinstance(building, Wall) for building in group], :] = 0.0
        worst = np.nanmax(closing, axis=-1, initial=0.0)
        for place, link_place in enumerate(links.places):
            left, floor, right_floor = link_place[:3]
            if not links.kind[(*at, 0, place)]:
                continue
            one, other = group[left : left + 2]
            left_at, right_at = links.left_at[(*at, 0, place)], links.right_at[(*at, 0, place)]
            ends = (left, floor, left_at), (left + 1, right_floor, right_at)
            a, b = (_moved(moved, *end) for end in ends)
            reach = error * absolute_sum(a, b)  # a relative change of both peaks moves no rule by more
            rules: Rules = {
                EXACT: (closing[..., place], error * worst),
                "ABS": (absolute_sum(a, b), reach),
                "SRSS": (root_of_squares(a, b), reach),
                "DDC": (double_difference(a, b, _correlation(one, other)), reach),
            }
            if (asked := study.spec.gap.gb50011) is not None:
                height = min(one.elevation[-1], other.elevation[-1])
                rules[GB50011] = gb50011_width(height, asked.intensity, asked.structure), 0.0
            if floor > 0:  # codes do not tell how far a base moves
                ubc, asce, en = ([_moved(codes[rule], *end) for end in ends] for rule in (UBC, ASCE7, EN1998))
                rules[edition] = absolute_sum(*ubc), 0.0
                rules[ASCE7] = root_of_squares(*asce), 0.0
                rules[EN1998] = en1998_separation(en[0], en[1], _same_floors(one, other)), 0.0
            is_left = left_at == 1.0 and not isinstance(one, Wall)
            numbers = {"point": point, "place": place, "number": left}
            facing = *plan.buildings[left : left + 2], floor, right_floor, link_place.struck_sides
            height = one.level(floor) if is_left else other.level(right_floor)
            yield numbers | dict(zip(_FACING, facing, strict=True)) | {"height": height}, rules


def _moved(displacements: np.ndarray, building: int, floor: int, at: float) -> np.ndarray:
    """Displacement of a floor, or of columns at a part of the storey below it.

    displacements : shape (..., buildings, 1 + floors), of the base first
    """
    above, below = (displacements[..., building, each] for each in (floor, max(floor - 1, 0)))
    part = at * at * (3.0 - 2.0 * at)
    return above if at == 1.0 else part * above + (1.0 - part) * below


def _to_lines(plan: Plan, data: xr.Dataset) -> Iterator[tuple[Where, Rules]]:
    """Every floor and both of its sides: how far it moves there, and what codes ask of the distance to a line."""
    errors, whole, least, most = (
        _by_point(plan, data, name)
        for name in ("error_estimate", "displacement", "displacement_min", "displacement_max")
    )
    worst = errors[..., None] * np.nanmax(whole, axis=-1, initial=0.0)
    displacements = _code_displacements(plan)
    for point, at in enumerate(_points(plan)):
        codes = _codes(plan, at, displacements)
        for number, name in enumerate(plan.buildings):
            building = plan.study.building(at, number)
            for floor in range(1, building.storeys + 1) if not isinstance(building, Wall) else ():
                for side, moved in (("left", -least), ("right", most)):
                    where = {"point": point, "building": name, "side": side, "floor": floor}
                    rules: Rules = {EXACT: (moved[point, :, :, number, floor - 1], worst[point, :, :, number])}
                    rules |= {rule: (codes[rule][number, floor], 0.0) for rule in (ASCE7, EN1998)}
                    yield where | {"height": building.level(floor)}, rules


def _points(plan: Plan) -> list[Point]:
    return list(np.ndindex(*plan.shape[:-3]))


def _by_point(plan: Plan, data: xr.Dataset, name: str) -> np.ndarray:
    """A variable in the one case, shape (points, analyses, motions, ...)."""
    return data[name].values.reshape(-1, *data[name].shape[len(plan.axes) + 1 :])


def _code_displacements(plan: Plan) -> CodeDisplacements:
    """Return the displacements of all building types that codes expect."""
    resolved = plan.study.resolved
    return {name: resolved.displacements(name) for name in plan.study.spec.group}


def _codes(plan: Plan, at: Point, displacements: CodeDisplacements) -> dict[str, np.ndarray]:
    """Displacements that codes expect [m], by rule, shape (buildings, 1 + floors), 0 of the base; NaN where a building
    lacks what the rule needs."""
    storeys = most_storeys(plan)
    found = {rule: np.full((len(plan.buildings), 1 + storeys), np.nan) for rule in (UBC, ASCE7, EN1998)}
    for place, name in enumerate(plan.study.spec.group):
        for rule, moved in displacements[name].at(at).items():
            found[rule][place, : 1 + len(moved)] = 0.0, *moved
    return found


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
    specs = (plan.study.spec.buildings[name].yield_ for name in plan.study.spec.group)
    editions = {getattr(spec, "code", UBC) for spec in specs}
    return editions.pop() if len(editions) == 1 else UBC


# Statistics


def _separations(plan: Plan, required: Iterable[tuple[Where, Rules]]) -> pd.DataFrame:
    """`value` and `error` [m] of every place (`row`, with what is known of it), rule, analysis and motion."""
    places, parts = list[Where](), list[tuple[Any, ...]]()
    for row, (where, rules) in enumerate(required):
        places.append(where)
        for rule, both in rules.items():
            shape = len(plan.analyses), len(plan.records) if rule in OF_MOTIONS else 1
            analysis, motion = np.indices(shape).reshape(2, -1)
            value, error = (np.broadcast_to(each, shape).ravel() for each in both)
            parts.append((np.full(len(value), row), [rule] * len(value), analysis, motion, value, error))
    names = ("row", "rule", "analysis", "motion", "value", "error")
    columns = {name: np.concatenate(each) for name, each in zip(names, zip(*parts, strict=True), strict=True)}
    found = pd.DataFrame(columns).join(pd.DataFrame(places), on="row")
    found["analysis"] = pd.Categorical(np.array(plan.analyses, object)[found["analysis"]], plan.analyses)
    found["rule"] = pd.Categorical(found["rule"], [*OF_MOTIONS, GB50011, _edition(plan), ASCE7, EN1998])
    return found


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
    groups = known.groupby(keys, observed=True)
    found = pd.DataFrame(groups["value"].agg(motions="size", mean="mean", std="std"))
    found["mean_plus_std"] = found["mean"] + found["std"]
    found["largest"] = groups["value"].max()
    for share in percentiles:
        found[f"percentile_{100 * share:g}"] = groups["value"].quantile(share)
    is_fitted = (groups["log"].count() == found["motions"]) & (found["motions"] > 1)
    centre, spread = groups["log"].mean().where(is_fitted), groups["log"].std().where(is_fitted)
    found["median"], found["dispersion"] = np.exp(centre), spread
    for share in contact:
        factors = {motions: _factors(motions, share) for motions in found["motions"].unique()}
        for number, end in enumerate(("", "_low", "_high")):
            times = found["motions"].map({motions: each[number] for motions, each in factors.items()})
            found[f"contact_{100 * share:g}{end}"] = np.exp(centre + times.astype(float) * spread)
    found["error"] = groups["error"].max()
    return found


def _factors(motions: int, probability: float) -> tuple[float, float, float]:
    """By how many standard deviations above the mean of the logarithms the gap lies, and its confidence interval.

    The interval is exact for a normal sample: sqrt(n) times the distance of the quantile from the mean, over the
    standard deviation, has Student's noncentral distribution.
    """
    from scipy import stats  # here, so that other commands do not load it

    z, root = float(stats.norm.isf(probability)), np.sqrt(motions)
    if motions < FEWEST_TOLD:
        return z, np.nan, np.nan
    low, high = stats.nct.ppf([(1 - CONFIDENCE) / 2, (1 + CONFIDENCE) / 2], motions - 1, z * root) / root
    return z, float(low), float(high)


def _required(plan: Plan, name: str, separations: pd.DataFrame, where: list[str]) -> Table:
    """Statistics of what is required: a row for every point, analysis, place and rule that says something there."""
    wanted, keys = plan.study.spec.gap, ["point", "analysis", "row", "rule"]
    rows = statistics(separations, keys, wanted.percentiles, wanted.contact)
    rule = rows.index.get_level_values("rule")
    exact = rows["mean"].where(rule == EXACT).groupby(level=keys[:3], observed=True).transform("first")
    rows["over_exact"] = rows["mean"] / exact
    rows["motions"] = rows["motions"].where(rule.isin(OF_MOTIONS), 0)
    numbers, more = list(rows.columns), dict[str, tuple[str, str]]()
    for share in wanted.percentiles:
        more[f"percentile_{100 * share:g}"] = "m", f"{100 * share:g} % of the motions need no more, interpolated"
    for share in wanted.contact:
        said = "distance that the floor reaches" if name == LINE else "gap"
        said += f" with a probability{'' if name == LINE else ' of contact'} of {100 * share:g} % by the lognormal fit"
        more[f"contact_{100 * share:g}"] = "m", f"{said}; with its interval from {FEWEST_TOLD} motions on"
    rows = rows.reset_index().merge(separations[["row", *where]].drop_duplicates("row"), on="row", how="left")
    return _told(plan, name, rows, ["analysis", *where, "rule", *numbers], more)


def _told(
    plan: Plan, name: str, rows: pd.DataFrame, columns: list[str], more: Mapping[str, tuple[str, str]] | None = None
) -> Table:
    """A table of rows whose points stand there by number; widths in the study's unit of gaps."""
    points, unit = _points(plan), plan.study.unit("gap")
    numbers = rows[columns].astype({"analysis": object, "rule": object})
    frame = pd.concat([swept(plan.axes, [points[number] for number in rows["point"]]), numbers], axis=1)
    widths = [each for each in columns if each != "height" and pd.api.types.is_float_dtype(frame[each])]
    shown = {each: unit for each in widths if each not in ("dispersion", "over_exact")}
    return tabled(name, frame, plan.axes, shown, more=more)


# The gaps of the cases


def _of_cases(study: Study, plan: Plan, separations: pd.DataFrame) -> Table:
    """Whether the gaps of the cases are enough: a row for every point, case, analysis, pair of neighbours and rule.

    A gap is enough where it is no narrower than what is required and its numerical error, at all floors of the pair.
    """
    pair, chosen, told = ["point", "given", "number", "analysis", "rule"], list[int](), list[tuple[Any, ...]]()
    rows = separations.merge(_gaps(study, plan).astype({"point": int, "place": int}), on=["point", "place"])
    columns = {name: rows[name].to_numpy() for name in ("motion", "value", "error", "gap")}
    is_counted = rows["rule"].isin(OF_MOTIONS).to_numpy()
    for at in rows.groupby(pair, observed=True).indices.values():
        motions = int(columns["motion"][at[-1]]) + 1
        value, error, gap = (columns[name][at].reshape(-1, motions) for name in ("value", "error", "gap"))
        known = ~np.isnan(value).any(axis=0)
        if not known.any():
            continue
        fits = (value + np.nan_to_num(error) <= gap)[:, known].all(axis=0)
        required = value[:, known].max(axis=1)
        worst = int(np.argmin(gap[:, 0] - required))
        enough = "no" if not fits.all() else "yes" if known.all() else "unknown"
        counts = (fits.sum(), known.sum()) if is_counted[at[0]] else (0, 0)
        chosen.append(at[worst * motions])
        told.append((required[worst], enough, *counts))
    found = pd.DataFrame(told, rows.index[chosen], columns=["required", "enough", "enough_for", "motions"])
    wanted = ["case", "analysis", *_FACING, "gap", "rule", "required", "enough", "enough_for", "motions"]
    return _told(plan, CASES, rows.iloc[chosen].join(found).sort_values(pair, ignore_index=True), wanted)


def _gaps(study: Study, plan: Plan) -> pd.DataFrame:
    """The gaps of the cases [m] at the places of the plan: at each of its points every set of gaps that the sweep of
    the study gives a case (`given`, by number).

    Left out are cases in which something acts between the buildings before a gap has closed, so that they do not move
    alone, and those without links.
    """
    axes = [_kept(axis) for axis in study.axes]
    numbers: dict[LinkPlace, int] = {}
    for number, link_place in enumerate(plan.links.places):
        numbers.setdefault(link_place._replace(name=""), number)
    found: dict[tuple[int, int, tuple[tuple[int, float], ...]], str] = {}
    for whole in np.ndindex(*(len(axis) for axis in study.axes)):
        at = [each[1].index(each[2][place]) for each, place in zip(axes, whole, strict=True) if each[0]]
        point = int(np.ravel_multi_index(at, plan.shape[:-3])) if at else 0
        for place, case in enumerate(study.spec.cases):
            links = study.links(whole, case)
            if links and all(link.law.subtracts_gap for link in links):
                gaps: dict[int, float] = {}
                for link in links:
                    here = numbers.get(link.place, -1)
                    gaps[here] = min(link.gap, gaps.get(here, link.gap))
                found[point, place, tuple(gaps.items())] = case
    rows = [
        (point, given, case, place, gap)
        for given, ((point, _, gaps), case) in enumerate(sorted(found.items(), key=lambda each: each[0][:2]))
        for place, gap in gaps
    ]
    return pd.DataFrame(rows, columns=["point", "given", "case", "place", "gap"])


# The study with nothing between its buildings


def _kept(axis: Axis) -> tuple[list[int], list[tuple[str, ...]], list[tuple[str, ...]]]:
    """Which keys of an axis change buildings or motions; their different values, and those at every point of it."""
    kept = [number for number, path in enumerate(axis.paths) if path[0] not in _BETWEEN]
    values = [tuple(str(given[number]) for number in kept) for given in axis.written_values]
    return kept, list(dict.fromkeys(values)), values


def _with_nothing_between(study: Study) -> Study:
    """The study with one case, in which nothing stands between the buildings, and without the axes of links."""
    root, mark = study.tree, study.tree.mark
    tree = Map({name: node for name, node in root.items() if name not in _ASIDE}, mark, root.marks)
    tree["cases"] = Map(
        {Apart.name: Map({"link": "none"}, mark, {"link": (mark, mark)})}, mark, {Apart.name: (mark, mark)}
    )
    axes = []
    for axis in study.axes:
        kept, different, values = _kept(axis)
        if kept:
            first = [values.index(each) for each in different]
            given, marks = (
                [tuple(rows[place][n] for n in kept) for place in first] for rows in (axis.written_values, axis.marks)
            )
            units = tuple(axis.units[n] for n in kept)
            axes.append(Axis(tuple(axis.names[n] for n in kept), given, marks, units))
    return study.with_axes(axes, tree)


def _all_facing(group: Group) -> tuple[Link, ...]:
    """Every pair of floors, and of slabs and columns, that face each other, with nothing between them."""
    links: list[Link] = []
    for left, pair in enumerate(pairwise(group.buildings)):
        floors, strikes = find_meetings(*pair)  # slabs beside columns too, whether or not their share is known
        links += [Link.apart(left, *both) for both in floors]
        links += [Link.apart(left, s.left_floor, s.right_floor, s.left_at, s.right_at) for s in strikes]
    return tuple(links)
