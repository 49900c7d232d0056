"""`pound fragility`: a curve for every limit, alone and with pounding, and what each motion said."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from pounding_cli.study import Plan, Study, expand
from pounding_cli.study.expression import COLLAPSE, CONTACT, SHEAR_DEMAND, TAKES_NEIGHBOUR, Target
from pounding_cli.workflows import curves
from pounding_cli.workflows.curves import Curve, Fits, Outcome, interval
from pounding_cli.workflows.fragility_question import Question, intensities, intensity_unit, question_of, takes_blow
from pounding_cli.workflows.hazard import YEARS, Hazard, probability
from pounding_cli.workflows.hunt import UNDECIDED, next_levels
from pounding_cli.workflows.workflow import Columns, Found, Table, Workflow, swept, tabled

if TYPE_CHECKING:
    from pounding_cli.batch.solve import Solver
    from pounding_cli.results.solved import Solved

CURVES, MOTIONS = "fragility", "fragility_motions"
RATES, CONTRIBUTIONS = "fragility_rates", "fragility_contributions"
"""Names of the tables; the last two where the study gives a hazard curve."""

ALONE = "0"
"""Ends the name of a column of the buildings alone."""

_WITH_INTERVAL = ("median", "spread", "ratio")
_INTENSITY = "unit of the intensity"
_CURVES: Columns = {
    "limit": ("", "what is passed"),
    "building": ("", "building that passes it, or the pair in contact"),
    "outcome": ("", "outcome of the fit"),
    "median": (_INTENSITY, "intensity at which half of the motions pass the limit"),
    "spread": ("1", "logarithmic standard deviation of that intensity"),
    "low": (_INTENSITY, "the median is not below"),
    "high": (_INTENSITY, "the median is not above; inf where no end is known"),
    "motions": ("1", "motions of the curve"),
    "scenes": ("1", "scenes asked for"),
    "failed": ("1", "scenes that failed; they widen brackets and are counted neither as holding nor as passing"),
    "undecided": ("1", "scenes that a collapse ended before the limit was passed or, of a cloud, whose demand is not "
                  "known or has no logarithm; counted neither as holding nor as passing"),
    "undecided_motions": ("1", "motions not known to pass, nor to hold at the highest intensities, since a collapse "
                          "ended their scenes; from half of the motions on there is no curve"),
    "returns": ("1", "motions that hold at an intensity above their first pass"),
    "unfitted": ("1", "draws of the bootstrap without a fit; they count with what a fit would tend to"),
    "ratio": ("1", "median with pounding over median alone"),
}  # fmt: skip
_MOTIONS: Columns = {
    "limit": _CURVES["limit"],
    "building": _CURVES["building"],
    "intensity": (_INTENSITY, "intensity of the motion"),
    "held": (_INTENSITY, "highest intensity below `passed` at which the motion holds; 0 where there is none"),
    "passed": (_INTENSITY, "lowest intensity at which the motion passes the limit; inf where there is none"),
    "demand": ("1", "demand over limit; inf where a collapse ended the scene after the limit was passed; empty where "
               "one did before, and where the scene failed"),
    "undecided": ("1", "scenes that a collapse ended before the limit was passed"),
}  # fmt: skip

_RATES: Columns = {
    "limit": _CURVES["limit"],
    "building": _CURVES["building"],
    "rate": ("1/year", "mean annual rate at which the limit is passed"),
    "probability": ("1", f"probability that it is passed within {YEARS:g} years"),
    "beyond": ("1", "part of the rate that comes from intensities above the last one of the hazard curve"),
    "rate_ratio": ("1", "rate with pounding over rate alone"),
}
_CONTRIBUTIONS: Columns = {
    "limit": _CURVES["limit"],
    "building": _CURVES["building"],
    "from": (_INTENSITY, "lower end of a range of intensities"),
    "to": (_INTENSITY, "its upper end"),
    "rate": ("1/year", "annual rate at which the limit is passed at these intensities"),
}
STRIPS = 40
"""Ranges of intensities whose contributions to a rate are told."""

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
        return np.unique([each.scenes[:, 0] for each in _series(plan, question)])

    def goes_on(self, study: Study) -> bool:
        """Whether it is `ida`."""
        return bool(study.model.fragility.method == "ida")

    def run(self, study: Study, solver: Solver) -> Found:
        """The curves, and what every motion said."""
        question, plan = question_of(study), self.plan(study)
        series = list(_series(plan, question))
        is_ida = question.spec.method == "ida"
        asked = _hunted(plan, question, series, solver) if is_ida else np.arange(len(plan))
        solved = solver.responses(plan, asked)
        measured = intensities(plan, question)
        parts = [each.rows(plan, solved, measured[each.number]).assign(series=n) for n, each in enumerate(series)]
        scenes = pd.concat(parts, ignore_index=True)
        return Found(plan, solver.dataset(plan, asked), _tables(plan, question, series, scenes))


ASKED = Fragility()


# Which scenes are solved


@dataclass(frozen=True, eq=False)
class Series:
    """The scenes of all motions and intensities that one curve rests on.

    number : of the point of the sweep, the intensity set aside; point : its index on every axis, 0 on the intensity's
    case, analysis : numbers
    is_alone : whether the target's building stands alone
    scenes : numbers, shape (motions, levels); intensities rise
    """

    number: int
    point: tuple[int, ...]
    case: int
    analysis: int
    target: Target
    is_alone: bool
    scenes: np.ndarray

    def rows(self, plan: Plan, solved: Solved, intensity: np.ndarray) -> pd.DataFrame:
        """`motion`, `level`, `intensity` and `demand` of the scenes that were asked for.

        intensity : shape (motions, levels)
        """
        motion, level = np.nonzero(solved.there[self.scenes])
        demand = self.demand(plan, solved)[motion, level]
        return pd.DataFrame({"motion": motion, "level": level, "intensity": intensity[motion, level], "demand": demand})

    def demand(self, plan: Plan, solved: Solved) -> np.ndarray:
        """Demand over limit [-], above 1 where the limit is passed; inf where a collapse ended the scene after that,
        UNDECIDED where it did before; NaN where the scene failed or was not asked for; shape (motions, levels).

        Passed are limits that were passed before a scene ended, the collapse itself, and limits on the drift or the
        ductility of the storey that collapsed: its drift has no bound.
        """
        limit, values, scenes = self.target.limit, solved.values, self.scenes
        place = 0 if self.is_alone else self.target.building
        reached = self._reached(plan, solved, place)
        storey = np.nan_to_num(values["collapse_storey"][scenes]).astype(int)
        own = np.where(values["collapse_building"][scenes] == place, storey, 0)
        falls = own > 0 if limit.quantity == COLLAPSE or not limit.level else own == limit.level
        passed = (reached > 1) | (falls & (limit.quantity in ("mu", "drift", COLLAPSE)))
        demand = np.where(storey > 0, np.where(passed, np.inf, UNDECIDED), reached)
        return np.where(solved.ended[scenes], demand, np.nan)

    def _reached(self, plan: Plan, solved: Solved, place: int) -> np.ndarray:
        """Demand over limit by the largest values of scenes, whatever ended them; 0 of collapse."""
        limit, values, links, scenes = self.target.limit, solved.values, plan.links, self.scenes
        if limit.quantity == COLLAPSE:
            return np.zeros(scenes.shape)
        there = links.kind[(*self.point, self.case)] != ""
        if limit.quantity == CONTACT:
            mine = [k for k, each in enumerate(links.places) if there[k] and each[0] == self.target.building]
            gap, closing = links.gap[(*self.point, self.case)][mine], values["link.max_closing"][scenes][..., mine]
            at_once = np.where(closing > 0, np.inf, np.where(np.isnan(closing), np.nan, 0.0))  # floors in touch
            parts = np.divide(closing, gap, out=at_once, where=np.broadcast_to(gap > 0, closing.shape))
            return np.fmax.reduce(parts, axis=-1) if mine else np.zeros(scenes.shape)
        building = plan.study.building(self.point, self.target.building)
        if limit.quantity == SHEAR_DEMAND:
            struck = [k for k in takes_blow(self.target, links.places, building.yield_shear) if there[k]]
            demand = values["columns.demand"][scenes][..., struck]
            return np.fmax.reduce(demand, axis=-1) / limit.value if struck else np.zeros(scenes.shape)
        peaks = values[_PEAKS[limit.quantity]][scenes, place, : building.storeys]
        parts = peaks / (limit.value * building.height if limit.of_height else limit.value)
        return parts[..., limit.level - 1] if limit.level else np.fmax.reduce(parts, axis=-1)


def _series(plan: Plan, question: Question) -> Iterator[Series]:
    """Of every curve the scenes with pounding, and behind them those of the building alone, where it can pass."""
    numbers, sizes = plan.numbers[..., None, :], [len(axis.values) for axis in plan.axes]
    if question.axis is not None:
        order = np.argsort([float(value) for (value,) in plan.axes[question.axis].values])
        numbers = np.moveaxis(np.take(plan.numbers, order, question.axis), question.axis, -2)
        sizes[question.axis] = 1
    numbers = numbers.reshape(-1, *numbers.shape[-5:])  # points, cases, analyses, motions, levels, 1 + buildings
    points = list(np.ndindex(*sizes))
    for number, case, analysis in np.ndindex(numbers.shape[:3]):
        for target in question.targets:
            for is_alone in (False,) if target.limit.quantity in TAKES_NEIGHBOUR else (False, True):
                scenes = numbers[number, case, analysis, ..., 1 + target.building if is_alone else 0]
                yield Series(number, points[number], case, analysis, target, is_alone, scenes)


def _hunted(plan: Plan, question: Question, series: list[Series], solver: Solver) -> np.ndarray:
    """Incremental dynamic analysis: the scenes that bracket where every motion passes each limit (`hunt`).

    The next intensities of all motions are solved together, so that workers are busy.
    """
    levels = np.ones(1) if question.axis is None else np.sort([float(v) for (v,) in plan.axes[question.axis].values])
    asked = new = np.unique([each.scenes[:, 0] for each in series])
    while new.size:
        solved, wanted = solver.responses(plan, asked), set[int]()
        for each in series:
            is_seen = np.isin(each.scenes, asked)
            demand = each.demand(plan, solved)
            for motion in np.flatnonzero(np.isin(each.scenes, new).any(axis=1)):
                seen = {int(level): float(demand[motion, level]) for level in np.flatnonzero(is_seen[motion])}
                more = next_levels(levels, seen, question.spec.fill)
                wanted |= {int(each.scenes[motion, level]) for level in more}
        new = np.array(sorted(wanted), int)
        asked = np.union1d(asked, new)
    return asked


# What curves rest on: frames of scenes and motions, with the columns of the table of motions


def brackets(scenes: pd.DataFrame, keys: list[str]) -> pd.DataFrame:
    """What every motion says, by `keys`: `held`, the highest intensity below the first pass at which it holds (0:
    none), `passed`, that of the first pass (inf: none), `returns`, whether it holds at a higher one again, `open`,
    whether a collapse leaves open if it passes above all at which it holds, and `undecided`, its scenes that one ended.

    scenes : `intensity` and `demand` over limit, above 1 where the limit is passed, UNDECIDED or NaN
    """
    x, demand = scenes["intensity"], scenes["demand"]
    by = [scenes[key] for key in keys]
    passed = x.where(demand > 1).groupby(by).min()
    first = x.where(demand > 1).groupby(by).transform("min").fillna(np.inf)
    holds = (demand <= 1) & (demand != UNDECIDED)
    lost = demand == UNDECIDED
    found = pd.DataFrame({"held": x.where(holds & (x < first)).groupby(by).max().fillna(0.0)})
    found["passed"] = passed.fillna(np.inf)
    found["returns"] = (holds & (x > first)).groupby(by).any()
    found["open"] = (x.where(lost).groupby(by).max() > found["held"]) & passed.isna()
    found["undecided"] = lost.groupby(by).sum().astype(float)
    return found.reset_index()


def fits_of(rows: pd.DataFrame, suffix: str, method: str, times: np.ndarray) -> Fits:
    """The fits of the bootstrap of one curve, from its rows in the table of motions.

    suffix : ALONE or ""; times : `resamples` of as many motions
    """
    motion, _ = motion_numbers(rows)
    one, other, told = _observed(rows, suffix, method)
    weights = times[:, motion[told]].astype(float)
    return curves.fit_lines(one, other, weights) if method == "cloud" else curves.fit_brackets(one, other, weights)


def curve_of(rows: pd.DataFrame, suffix: str, method: str) -> Curve:
    """The curve of some rows of the table of motions, or why there is none; undecided motions are not looked at."""
    motion, motions = motion_numbers(rows)
    one, other, told = _observed(rows, suffix, method)
    if method != "cloud":
        return curves.fit(one, other, motions)
    drawn = np.unique(motion[told]).size
    if 2 * drawn <= motions:  # the others collapsed: a line through the rest would mislead
        return Curve(Outcome.FEW, 0.0, np.inf)
    return curves.fit_cloud(one, other, drawn)


def _observed(rows: pd.DataFrame, suffix: str, method: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The ends of brackets, or the intensities and demands of a cloud, of the rows that tell something, and which rows
    these are: of `ida` one bracket a motion, of `stripes` one for every scene."""
    if method == "ida":
        one, other = (rows[name + suffix].to_numpy(float) for name in ("held", "passed"))
    else:
        x, demand = rows["intensity"].to_numpy(float), rows["demand" + suffix].to_numpy(float)
        if method == "cloud":
            told = np.isfinite(demand) & (demand > 0)
            return x[told], demand[told], told
        one, other = np.where((demand <= 1) & (demand != UNDECIDED), x, 0.0), np.where(demand > 1, x, np.inf)
    told = (one > 0) | (other < np.inf)
    return one[told], other[told], told


def motion_numbers(rows: pd.DataFrame) -> tuple[np.ndarray, int]:
    """The number of the motion of every row of one curve, and how many motions there are."""
    numbers, names = pd.factorize(rows["record"])
    return numbers, len(names)


# The tables


def _tables(plan: Plan, question: Question, series: list[Series], scenes: pd.DataFrame) -> list[Table]:
    """The tables of curves and of motions.

    scenes : `series`, `motion`, `level`, `intensity` and `demand`
    """
    times = curves.resamples(len(plan.records), question.spec.draws)
    motions = brackets(scenes, ["series", "motion"])
    said, values = motions, ["held", "passed", "undecided"]
    if question.spec.method != "ida":
        lost = scenes["demand"] == UNDECIDED
        said, values = (
            scenes.assign(demand=scenes["demand"].mask(lost), undecided=lost.astype(float)),
            ["demand", "undecided"],
        )
    said = said.assign(record=np.array(plan.records, object)[said["motion"]])
    parts = zip(*(frame.groupby("series") for frame in (scenes, motions, said)), strict=True)
    found = dict(enumerate(_curve(own, mine, rows, question, times) for (_, own), (_, mine), (_, rows) in parts))
    linked = [number for number, each in enumerate(series) if not each.is_alone]
    place_of = {number: place for place, number in enumerate(linked)}
    where = _where(plan, question, [series[number] for number in linked])
    names = [name + end for name in _CURVES if name not in ("limit", "building")
             for end in (("", "_low", "_high") if name in _WITH_INTERVAL else ("",))]  # fmt: skip
    names += [name + ALONE for name in names if not name.startswith("ratio")]
    numbers = pd.DataFrame(
        [_pair(found[n], found.get(n + 1) if n + 1 not in place_of else None, question) for n in linked]
    )
    numbers = numbers.reindex(columns=names)
    is_text = numbers.columns.str.startswith("outcome")
    numbers = numbers.loc[:, ~is_text].astype(float).join(numbers.loc[:, is_text].astype(object).fillna(""))[names]

    is_linked = said["series"].isin(linked)
    keys = ["series", "motion", *(["level"] if "level" in said else [])]
    alone = said.loc[~is_linked, [*keys, *values]].assign(series=lambda rows: rows["series"] - 1)
    rows = said[is_linked].merge(alone, on=keys, how="left", suffixes=("", ALONE))
    if "level" in said:
        rows = rows.fillna({"undecided" + ALONE: 0.0})
    columns = ["record", *(["intensity"] if "level" in said else []), *values, *(name + ALONE for name in values)]
    place = where.loc[rows["series"].map(place_of)].reset_index(drop=True)
    tables = [
        _told(plan, question, CURVES, where.join(numbers), _CURVES),
        _told(plan, question, MOTIONS, place.join(rows[columns]), _MOTIONS),
    ]
    if question.hazard is None:
        return tables
    both = [(found[n], found.get(n + 1) if n + 1 not in place_of else None) for n in linked]
    rates = pd.DataFrame([_rate(question.hazard, *each, question.spec.confidence) for each in both])
    strips = _contributions(question.hazard, numbers)
    of_place = where.loc[strips.pop("place")].reset_index(drop=True)
    return [
        *tables,
        _told(plan, question, RATES, where.join(rates), _RATES),
        _told(plan, question, CONTRIBUTIONS, of_place.join(strips), _CONTRIBUTIONS),
    ]


def _rate(
    hazard: Hazard,
    linked: tuple[dict[str, Any], Fits],
    alone: tuple[dict[str, Any], Fits] | None,
    confidence: float,
) -> dict[str, float]:
    """Annual rates of a limit with pounding and alone, their ratio, and their intervals over the same draws; NaN where
    there is no curve."""
    found, draws = dict[str, float](), list[np.ndarray]()
    names = ("rate", "rate_low", "rate_high", "probability", "beyond")
    for suffix, each in (("", linked), (ALONE, alone)):
        row, fits = each or ({}, None)
        if fits is None or "median" not in row:
            found |= dict.fromkeys([name + suffix for name in names], np.nan)
            continue
        rate = float(hazard.of_lognormal(row["median"], row["spread"]))
        beyond = float(hazard.of_lognormal(row["median"], row["spread"], above=hazard.last)) if rate > 0 else 0.0
        at_all = np.where(fits.share > 0, fits.share * hazard.rate(np.zeros(1)), 0.0)  # of draws without a trend
        draws.append(np.where(np.isinf(fits.spread), at_all, hazard.of_lognormal(fits.median, fits.spread)))
        low, high = interval(draws[-1], confidence)
        numbers = rate, low, high, probability(rate), beyond / rate if rate > 0 else 0.0
        found |= {name + suffix: float(value) for name, value in zip(names, numbers, strict=True)}
    if len(draws) == 2 and found["rate" + ALONE] > 0:
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = draws[0] / draws[1]
        low, high = interval(np.where(np.isnan(ratio), 1.0, ratio), confidence)
        found |= {"rate_ratio": found["rate"] / found["rate" + ALONE], "rate_ratio_low": low, "rate_ratio_high": high}
    return found


def _contributions(hazard: Hazard, curves: pd.DataFrame) -> pd.DataFrame:
    """`place` (of the row in the table of curves), `from`, `to`, `rate` and `rate0` of STRIPS ranges of intensities,
    equal in ln of the intensity, that all curves share."""
    both = [curves[["median" + s, "spread" + s]].dropna().to_numpy() for s in ("", ALONE)]
    medians, spreads = np.concatenate(both).T if len(both) else np.zeros((2, 0))
    names = ["place", "from", "to", "rate", "rate" + ALONE]
    if not medians.size:
        return pd.DataFrame(columns=names)
    ends = (medians * np.exp(-4 * spreads)).min(), 2.5 * (medians * np.exp(3 * spreads)).max()
    edges = np.geomspace(max(ends[0], hazard.edges[0]), max(ends[1], 2 * hazard.edges[0]), STRIPS + 1)
    parts = []
    for place, row in enumerate(curves.to_dict("records")):
        strips = {"place": place, "from": edges[:-1], "to": edges[1:]}
        for suffix in ("", ALONE):
            slope = np.full(STRIPS, 1 / row["spread" + suffix])
            is_told = row["median" + suffix] == row["median" + suffix]
            rate = hazard.contributions(edges, -slope * np.log(row["median" + suffix]), slope) if is_told else np.nan
            strips["rate" + suffix] = rate
        parts.append(pd.DataFrame(strips))
    return pd.concat(parts, ignore_index=True)[names]


def _told(plan: Plan, question: Question, name: str, frame: pd.DataFrame, columns: Columns) -> Table:
    """A table with intensities in their unit."""
    unit = intensity_unit(plan, question)
    meant = {key: (unit.si or "1" if si == _INTENSITY else si, text) for key, (si, text) in columns.items()}
    intensity = [key for key, (si, _) in columns.items() if si == _INTENSITY]
    ends = [end + alone for end in ("", "_low", "_high") for alone in ("", ALONE)]
    shown = [key + end for key in intensity for end in ends if key + end in frame]
    return tabled(name, frame, meant, plan.axes, dict.fromkeys(shown, unit))


def _pair(
    linked: tuple[dict[str, Any], Fits], alone: tuple[dict[str, Any], Fits] | None, question: Question
) -> dict[str, Any]:
    """The columns of a curve with pounding, of that of the building alone, and of the ratio of both medians."""
    row, draws = linked
    if alone is None:
        return row
    own, own_draws = alone
    row = row | {name + ALONE: value for name, value in own.items()}
    if "median" in row and "median" in own:
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = draws.median / own_draws.median
        # a draw whose ratio has no value, both medians beyond the same end, is taken as 1
        low, high = interval(np.where(np.isnan(ratio), 1.0, ratio), question.spec.confidence)
        row |= {"ratio": row["median"] / own["median"], "ratio_low": low, "ratio_high": high}
    return row


def _where(plan: Plan, question: Question, series: list[Series]) -> pd.DataFrame:
    """Where curves stand: the swept values but the intensity, case, analysis, limit and building."""
    others = [number for number in range(len(plan.axes)) if number != question.axis]
    found = swept([plan.axes[number] for number in others], [[each.point[n] for n in others] for each in series])
    found["case"] = [plan.cases[each.case] for each in series]
    found["analysis"] = [plan.analyses[each.analysis] for each in series]
    found["limit"] = [str(each.target.limit) for each in series]
    found["building"] = [each.target.label(plan.buildings) for each in series]
    return found


def _curve(
    scenes: pd.DataFrame, motions: pd.DataFrame, rows: pd.DataFrame, question: Question, times: np.ndarray
) -> tuple[dict[str, Any], Fits]:
    """The columns of one curve, and the fits of its draws.

    scenes, motions : it rests on; rows : of the table of motions
    """
    method, confidence, demand = question.spec.method, question.spec.confidence, scenes["demand"]
    count, lost, is_open = len(motions), demand == UNDECIDED, motions["open"]
    if method == "cloud":
        is_drawn = np.isfinite(demand) & (demand > 0)
        has_point = is_drawn.groupby(scenes["motion"]).any()
        is_open = lost.groupby(scenes["motion"]).any() & ~has_point
        lost = demand.notna() & ~is_drawn
        if 2 * has_point.sum() > count and 2 * is_open.sum() < count:
            count = int(has_point.sum())
    curve, draws = curve_of(rows, "", method), fits_of(rows, "", method, times)
    if 2 * is_open.sum() >= len(motions):  # between these half of them pass, whatever the undecided ones would do
        half, (held, passed) = count // 2, (np.sort(motions[name]) for name in ("held", "passed"))
        ends = (0.0, np.inf) if method == "cloud" else (held[count - 1 - half], passed[half])
        curve = Curve(Outcome.UNDECIDED, *ends)
    row: dict[str, Any] = {
        "outcome": str(curve.outcome), "low": curve.low, "high": curve.high, "motions": count, "scenes": len(scenes),
        "failed": int(demand.isna().sum()), "undecided": int(lost.sum()), "undecided_motions": int(is_open.sum()),
    }  # fmt: skip
    if method == "ida":
        row["returns"] = int(motions["returns"].sum())
    if curve.outcome is Outcome.FITTED:
        for name in ("median", "spread"):
            low, high = interval(getattr(draws, name), confidence)
            row |= {name: getattr(curve, name), f"{name}_low": low, f"{name}_high": high}
        row["unfitted"] = int((draws.outcome != Outcome.FITTED).sum())
    return row, draws
