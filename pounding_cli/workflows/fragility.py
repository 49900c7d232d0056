"""`pound fragility`: how likely limits are passed at an intensity and how often a year, alone and with pounding."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pandas as pd

from pounding_cli.study import Plan, Study, expand
from pounding_cli.study.expression import COLLAPSE, CONTACT, SHEAR_DEMAND, TAKES_NEIGHBOUR, Target
from pounding_cli.workflows.curves import FEWEST, Fits, Outcome, draws_of, fit_brackets, fit_lines, interval
from pounding_cli.workflows.fragility_question import (
    Question,
    intensities,
    intensity_unit,
    question_of,
    takes_blow,
)
from pounding_cli.workflows.hazard import Hazard, probability
from pounding_cli.workflows.workflow import Found, Table, Workflow, columns_of, swept, tabled

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

UNDECIDED = float("-inf")
"""Demand over limit of a scene that a collapse ended before the limit was passed: the whole motion might have passed
it or not."""

_OVERSHOOT = 1.1
"""By how much the first step beyond a capacity aims too high: a bracket from above is worth more than another below."""

_LONGEST_STEP = 4.0
"""The intensity grows at most by this factor from one level to the next while none has passed."""

_STEP_UNDECIDED = 2.0
"""The intensity grows by this factor from one level to the next while a collapse leaves all undecided."""

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

    def extent(self, study: Study) -> str:
        """Of `ida` the results decide which scenes are solved."""
        return "has at most" if study.model.fragility.method == "ida" else "has"

    def run(self, study: Study, solver: Solver) -> Found:
        """The curves, what every motion said and, with a hazard curve, annual rates."""
        question, plan = question_of(study), self.plan(study)
        places = list(_places(plan, question))
        asked = _hunted(plan, question, places, solver) if question.spec.method == "ida" else np.arange(len(plan))
        solved = solver.responses(plan, asked)
        return Found(plan, solver.dataset(plan, asked), _tables(plan, question, places, solved))


ASKED = Fragility()


# Which scenes are solved


@dataclass(frozen=True, eq=False)
class Place:
    """Where a curve with pounding and that of the building alone stand.

    number : of the point of the sweep, the intensity set aside; point : its index on every axis, 0 on the intensity's
    case, analysis : numbers
    scenes : by LINKED and, where the building alone can pass the limit, ALONE the scenes of all motions and intensities
        by number, shape (motions, levels); intensities rise
    """

    number: int
    point: tuple[int, ...]
    case: int
    analysis: int
    target: Target
    scenes: dict[str, np.ndarray]

    def demand(self, plan: Plan, solved: Solved, suffix: str) -> np.ndarray:
        """Demand over limit [-], above 1 where the limit is passed; inf where a collapse ended the scene after that,
        UNDECIDED where it did before; NaN where the scene failed or was not asked for; shape (motions, levels).

        Passed are limits that were passed before a scene ended, the collapse itself, and limits on the drift or the
        ductility of the storey that collapsed: its drift has no bound.
        """
        limit, values, scenes = self.target.limit, solved.values, self.scenes[suffix]
        place = 0 if suffix == ALONE else self.target.building
        reached = self._reached(plan, solved, scenes, place)
        storey = np.nan_to_num(values["collapse_storey"][scenes]).astype(int)
        own = np.where(values["collapse_building"][scenes] == place, storey, 0)
        falls = own > 0 if limit.quantity == COLLAPSE or not limit.level else own == limit.level
        passed = (reached > 1) | (falls & (limit.quantity in ("mu", "drift", COLLAPSE)))
        demand = np.where(storey > 0, np.where(passed, np.inf, UNDECIDED), reached)
        return np.where(solved.ended[scenes], demand, np.nan)

    def _reached(self, plan: Plan, solved: Solved, scenes: np.ndarray, place: int) -> np.ndarray:
        """Demand over limit by the largest values of scenes, whatever ended them; 0 of collapse."""
        limit, values, links = self.target.limit, solved.values, plan.links
        building = plan.study.building(self.point, self.target.building)
        there = links.kind[(*self.point, self.case)] != ""
        if limit.quantity in ("mu", "drift", "acceleration"):
            peaks = values[_PEAKS[limit.quantity]][scenes, place, : building.storeys]
            parts = peaks / (limit.value * building.height if limit.of_height else limit.value)
            return parts[..., limit.level - 1] if limit.level else np.fmax.reduce(parts, axis=-1)
        if limit.quantity == CONTACT:
            mine = [k for k, each in enumerate(links.places) if there[k] and each[0] == self.target.building]
            gap, closing = links.gap[(*self.point, self.case)][mine], values["link.max_closing"][scenes][..., mine]
            at_once = np.where(closing > 0, np.inf, np.where(np.isnan(closing), np.nan, 0.0))  # floors in touch
            parts = np.divide(closing, gap, out=at_once, where=np.broadcast_to(gap > 0, closing.shape))
        elif limit.quantity == SHEAR_DEMAND:
            strikes = [takes_blow(self.target, each, building.yield_shear) for each in links.places]
            mine = np.flatnonzero(there & strikes).tolist()
            parts = values["columns.demand"][scenes][..., mine] / limit.value
        else:
            mine = []
        return np.fmax.reduce(parts, axis=-1) if mine else np.zeros(scenes.shape)


def _places(plan: Plan, question: Question) -> Iterator[Place]:
    """Every curve with its scenes."""
    numbers, sizes = plan.numbers[..., None, :], [len(axis.values) for axis in plan.axes]
    if question.axis is not None:
        order = np.argsort([float(value) for (value,) in plan.axes[question.axis].values])
        numbers = np.moveaxis(np.take(plan.numbers, order, question.axis), question.axis, -2)
        sizes[question.axis] = 1
    numbers = numbers.reshape(-1, *numbers.shape[-5:])  # points, cases, analyses, motions, levels, 1 + buildings
    points = list(np.ndindex(*sizes))
    for number, case, analysis in np.ndindex(numbers.shape[:3]):
        for target in question.targets:
            here = numbers[number, case, analysis]
            scenes = {LINKED: here[..., 0]}
            if target.limit.quantity not in TAKES_NEIGHBOUR:
                scenes[ALONE] = here[..., 1 + target.building]
            yield Place(number, points[number], case, analysis, target, scenes)


def _hunted(plan: Plan, question: Question, places: Sequence[Place], solver: Solver) -> np.ndarray:
    """Incremental dynamic analysis: the scenes that bracket where every motion passes each limit (`next_levels`).

    The next intensities of all motions are solved together, so that workers are busy.
    """
    assert question.axis is not None  # of `ida`
    levels = np.sort([float(value) for (value,) in plan.axes[question.axis].values])
    asked = new = np.unique([scenes[:, 0] for place in places for scenes in place.scenes.values()])
    while new.size:
        solved, wanted = solver.responses(plan, asked), set[int]()
        for place in places:
            for suffix, scenes in place.scenes.items():
                is_seen, demand = np.isin(scenes, asked), place.demand(plan, solved, suffix)
                for motion in np.flatnonzero(np.isin(scenes, new).any(axis=1)):
                    seen = {int(level): float(demand[motion, level]) for level in np.flatnonzero(is_seen[motion])}
                    wanted |= {int(scenes[motion, level]) for level in next_levels(levels, seen, question.spec.fill)}
        new = np.array(sorted(wanted), int)
        asked = np.union1d(asked, new)
    return asked


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


# What the motions say; intensities `x` and demands over limit have the shape (motions, levels)


class Brackets(NamedTuple):
    """What every motion says, each of shape (motions,).

    held : highest intensity below the first pass at which it holds; 0: none
    passed : that of the first pass; inf: none
    is_open : whether a collapse leaves open if it passes above all at which it holds
    undecided : its scenes that a collapse ended before the limit was passed
    """

    held: np.ndarray
    passed: np.ndarray
    is_open: np.ndarray
    undecided: np.ndarray


def brackets(x: np.ndarray, demand: np.ndarray) -> Brackets:
    """What motions say by their demands: above 1 where the limit is passed, UNDECIDED or NaN."""
    passed = np.where(demand > 1, x, np.inf).min(axis=1)
    holds, lost = (demand <= 1) & (demand != UNDECIDED), demand == UNDECIDED
    held = np.where(holds & (x < passed[:, None]), x, 0.0).max(axis=1)
    is_open = (np.where(lost, x, 0.0).max(axis=1) > held) & (passed == np.inf)
    return Brackets(held, passed, is_open, lost.sum(axis=1))


def _observed(x: np.ndarray, demand: np.ndarray, method: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Both ends of brackets, of `ida` one a motion and of `stripes` one for every scene, or the intensities and demands
    of a cloud; and the motion of each."""
    if method == "cloud":
        one, other = x, demand
        is_told = np.isfinite(demand) & (demand > 0)
    else:
        one, other = np.where((demand <= 1) & (demand != UNDECIDED), x, 0.0), np.where(demand > 1, x, np.inf)
        if method == "ida":
            one, other = brackets(x, demand)[:2]
        is_told = (one > 0) | (other < np.inf)
    return one[is_told], other[is_told], np.nonzero(is_told)[0]


def _curve(
    x: np.ndarray, demand: np.ndarray, there: np.ndarray, question: Question, times: np.ndarray
) -> tuple[dict[str, Any], Fits]:
    """The columns of one curve, and its fits: of the curve first, then of its draws.

    there : whether a scene was asked for; times : `draws_of` the motions
    """
    method, said, motions = question.spec.method, brackets(x, demand), len(x)
    one, other, motion = _observed(x, demand, method)
    is_open, lost, drawn = said.is_open, demand == UNDECIDED, np.unique(motion).size
    if method == "cloud":
        fits, is_few = fit_lines(one, other, times[:, motion]), drawn < FEWEST or 2 * drawn <= motions
        is_few = is_few or float(np.ptp(np.log(one))) <= 1e-12
        is_open = lost.any(axis=1) & ~np.isin(np.arange(motions), motion)
        lost = ~np.isnan(demand) & ~(np.isfinite(demand) & (demand > 0))
    else:
        fits, is_few = fit_brackets(one, other, times[:, motion]), motions < 2 or not one.size
        ends = np.unique(np.concatenate([one, other]))
        is_few = is_few or (fits.outcome[0] == Outcome.SEPARATED and ((ends > 0) & (ends < np.inf)).sum() < 2)
    outcome = Outcome.FEW if is_few else Outcome(fits.outcome[0])
    low, high = 0.0, np.inf
    if 2 * is_open.sum() >= motions:  # between these half of them pass, whatever the undecided ones would do
        outcome = Outcome.UNDECIDED
        if method != "cloud":
            low, high = np.sort(said.held)[(motions - 1) // 2], np.sort(said.passed)[motions // 2]
    elif outcome is Outcome.FITTED or (method == "cloud" and outcome is Outcome.SEPARATED):
        low = high = fits.median[0]
    elif outcome is not Outcome.FLAT and method != "cloud":  # where some hold and some pass, it may lie on either side
        low = one[one < other.min(initial=np.inf)].max(initial=0.0)
        high = other[other > one.max(initial=0.0)].min(initial=np.inf)
    row: dict[str, Any] = {
        "outcome": str(outcome),
        "low": low,
        "high": high,
        "motions": drawn if method == "cloud" and 2 * drawn > motions > 2 * is_open.sum() else motions,
        "scenes": there.sum(),
        "failed": (there & np.isnan(demand)).sum(),
        "undecided": lost.sum(),
        "undecided_motions": is_open.sum(),
    }
    if outcome is Outcome.FITTED:
        for name in ("median", "spread"):
            values = getattr(fits, name)
            lower, upper = interval(values[1:], question.spec.confidence, row["motions"])
            row |= {name: values[0], f"{name}_low": lower, f"{name}_high": upper}
        row["unfitted"] = (fits.outcome[1:] != Outcome.FITTED).sum()
    return row, fits


Curves = dict[str, tuple[dict[str, Any], Fits]]
"""By LINKED and ALONE the columns of a curve and its fits."""


def _ratio(name: str, values: Sequence[np.ndarray], found: Curves, confidence: float) -> dict[str, float]:
    """The ratio of a number with pounding to that alone, and its interval over the same draws; a draw whose ratio has
    no value, both beyond the same end, is taken as 1."""
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio, *drawn = values[0] / values[1]
    motions = min(row["motions"] for row, _ in found.values())
    low, high = interval(np.where(np.isnan(drawn), 1.0, drawn), confidence, motions)
    return {name: ratio, f"{name}_low": low, f"{name}_high": high}


def _points(found: Curves, top: float, confidence: float) -> pd.DataFrame:
    """Points of both curves with their bands, from above 0 to beyond nearly all of each, but not far beyond where
    motions pass; none where there is no curve.

    top : highest intensity at which a motion says something
    """
    fitted = {end: fits for end, (row, fits) in found.items() if "median" in row}
    if not fitted:
        return pd.DataFrame()
    median, spread = (np.array([getattr(fits, name)[0] for fits in fitted.values()]) for name in ("median", "spread"))
    right = np.minimum(median * np.exp(1.8 * spread), np.maximum(2 * top, 1.2 * median)).max()
    x = np.linspace(0.0, 1.1 * right, POINTS_OF_CURVE + 1)[1:]
    columns = {"intensity": x}
    for end, fits in fitted.items():
        passed, *drawn = fits.probability(x)
        low, high = interval(np.array(drawn), confidence, found[end][0]["motions"])
        columns |= {f"probability{end}": passed, f"probability_low{end}": low, f"probability_high{end}": high}
    return pd.DataFrame(columns)


# Annual rates


def _rates(hazard: Hazard, found: Curves, confidence: float) -> dict[str, float]:
    """Annual rates of a limit, their ratio, and their intervals; nothing where there is no curve."""
    row, rates = dict[str, float](), []
    for end, (curve, fits) in found.items():
        if "median" not in curve:
            continue
        at_all = np.where(fits.share > 0, fits.share * hazard.rate(np.zeros(1)), 0.0)  # of draws without a trend
        rates.append(np.where(np.isinf(fits.spread), at_all, hazard.of_lognormal(fits.median, fits.spread)))
        rate = float(rates[-1][0])
        low, high = interval(rates[-1][1:], confidence, curve["motions"])
        beyond = float(hazard.of_lognormal(fits.median[0], fits.spread[0], above=hazard.last))
        row |= {f"rate{end}": rate, f"rate_low{end}": low, f"rate_high{end}": high}
        row |= {f"probability{end}": probability(rate), f"beyond{end}": beyond / rate if rate > 0 else 0.0}
    if len(rates) == 2 and rates[1][0] > 0:
        row |= _ratio("rate_ratio", rates, found, confidence)
    return row


def _contributions(hazard: Hazard, found: Curves) -> pd.DataFrame:
    """The rates that come from STRIPS ranges of intensities, equal in their logarithm; none where there is no curve."""
    fitted = {end: (fits.median[0], fits.spread[0]) for end, (row, fits) in found.items() if "median" in row}
    if not fitted:
        return pd.DataFrame()
    low = min(median * np.exp(-4 * spread) for median, spread in fitted.values())
    high = max(2.5 * median * np.exp(3 * spread) for median, spread in fitted.values())
    edges = np.geomspace(max(low, hazard.edges[0]), max(high, 2 * hazard.edges[0]), STRIPS + 1)
    columns = {"from": edges[:-1], "to": edges[1:]}
    for end, (median, spread) in fitted.items():
        slope = np.full(STRIPS, 1 / spread)
        columns[f"rate{end}"] = hazard.contributions(edges, -slope * np.log(median), slope)
    return pd.DataFrame(columns)


# The tables


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


def _tables(plan: Plan, question: Question, places: Sequence[Place], solved: Solved) -> list[Table]:
    """The tables of curves, of motions, of points and, with a hazard curve, of rates and contributions."""
    spec, hazard, measured = question.spec, question.hazard, intensities(plan, question)
    times, records = draws_of(len(plan.records), spec.draws), np.array(plan.records, object)
    parts: dict[str, list[pd.DataFrame]] = {name: [] for name in _columns(spec.method)}
    for place in places:
        x, found, top = measured[place.number], Curves(), 0.0
        row, said = dict[str, Any](), dict[str, Any](record=records)
        if spec.method != "ida":
            said = {"record": np.repeat(records, x.shape[1]), "intensity": x.ravel()}
        for end, scenes in place.scenes.items():
            demand = place.demand(plan, solved, end)
            found[end] = _curve(x, demand, solved.there[scenes], question, times)
            row |= {name + end: value for name, value in found[end][0].items()}
            each, is_lost = brackets(x, demand), demand == UNDECIDED
            top = max(top, np.where(each.passed < np.inf, each.passed, each.held).max())
            if spec.method == "ida":
                said |= {f"held{end}": each.held, f"passed{end}": each.passed, f"undecided{end}": each.undecided}
            else:
                said |= {f"demand{end}": np.where(is_lost, np.nan, demand).ravel(), f"undecided{end}": is_lost.ravel()}
        if "median" in row and "median0" in row:
            row |= _ratio("ratio", [fits.median for _, fits in found.values()], found, spec.confidence)
        parts[CURVES].append(pd.DataFrame([row]))
        parts[MOTIONS].append(pd.DataFrame(said))
        parts[POINTS].append(_points(found, top, spec.confidence))
        if hazard is not None:
            parts[RATES].append(pd.DataFrame([_rates(hazard, found, spec.confidence)]))
            parts[CONTRIBUTIONS].append(_contributions(hazard, found))
    where, unit, tables = _where(plan, question, places), intensity_unit(plan, question), []
    for name, columns in _columns(spec.method).items():
        if not parts[name]:
            continue
        at = where.loc[np.repeat(where.index, [len(each) for each in parts[name]])].reset_index(drop=True)
        frame = pd.concat(parts[name], ignore_index=True).reindex(columns=columns)
        texts = [column for column in columns if column == "record" or column.startswith("outcome")]
        frame = frame.astype({column: object if column in texts else float for column in columns})
        frame = frame.fillna(dict.fromkeys(texts, ""))
        shown = [column for column in columns if columns_of(CURVES).get(_bare(column), ("",))[0] == "*"]
        tables.append(tabled(name, at.join(frame), plan.axes, dict.fromkeys(shown, unit), unit.si))
    return tables


def _bare(column: str) -> str:
    """The name of a column without what tells its interval or the building alone."""
    return column.removesuffix(ALONE).removesuffix("_low").removesuffix("_high")


def _where(plan: Plan, question: Question, places: Sequence[Place]) -> pd.DataFrame:
    """Where curves stand: the swept values but the intensity, case, analysis, limit and building."""
    others = [number for number in range(len(plan.axes)) if number != question.axis]
    found = swept([plan.axes[number] for number in others], [[each.point[n] for n in others] for each in places])
    found["case"] = [plan.cases[each.case] for each in places]
    found["analysis"] = [plan.analyses[each.analysis] for each in places]
    found["limit"] = [str(each.target.limit) for each in places]
    found["building"] = [each.target.label(plan.buildings) for each in places]
    return found
