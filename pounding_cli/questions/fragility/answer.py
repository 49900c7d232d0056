"""The tables of `pound fragility`: curves, motions, points of curves, annual rates and what contributes to them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from pounding_cli.numbers import Unit
from pounding_cli.questions.bootstrap import build_estimate, draw_motions
from pounding_cli.questions.fragility.curves import FitOutcome, FragilityCurve, find_brackets, fit_curve
from pounding_cli.questions.fragility.demands import UNDECIDED, CurvePlace, find_demands
from pounding_cli.questions.fragility.tables import (
    COLUMNS_BY_TABLE,
    CONTRIBUTIONS,
    CURVE_POINTS,
    CURVES,
    IN_UNIT_OF_INTENSITY,
    MOTIONS,
    NEIGHBOURS,
    RATES,
    list_columns,
)
from pounding_cli.questions.frames import ALONE, WITH_POUNDING, build_swept_frame, list_swept_columns
from pounding_cli.questions.hazard import Hazard, poisson_probability
from pounding_cli.tables import Table, build_table

if TYPE_CHECKING:
    from pounding_cli.questions.fragility.question import Fragility
    from pounding_cli.results.responses import Responses

POINTS_OF_CURVE = 200
"""Intensities of the points of a curve."""

RANGES_OF_RATE = 40
"""Ranges of intensities whose contributions to a rate are given."""

MIN_ADDED = 1e-6
"""Part of the square of a spread below which what a neighbour adds is rounding [-]."""

CurveByState = dict[str, FragilityCurve]
"""State -> its fitted curve; a state without one is left out."""


@dataclass
class _Rows:
    """Rows of one table, added block by block.

    places : number of the curve's place of every block
    states : of every block
    blocks : column -> its values, or one for all rows of the block
    counts : rows of every block
    """

    places: list[int] = field(default_factory=list)
    states: list[str] = field(default_factory=list)
    blocks: list[Mapping[str, Any]] = field(default_factory=list)
    counts: list[int] = field(default_factory=list)

    def add(self, place: int, state: str, block: Mapping[str, Any]) -> None:
        """Add a block of rows."""
        self.places.append(place)
        self.states.append(state)
        self.blocks.append(block)
        self.counts.append(max((np.size(values) for values in block.values()), default=0))

    def to_frame(self, columns: Sequence[str], where: pd.DataFrame) -> pd.DataFrame:
        """Return all rows.

        columns : of the frame
        where : the columns that say where the places stand, by number of the place
        """
        frame = where.loc[np.repeat(self.places, self.counts)].reset_index(drop=True)
        frame["state"] = np.repeat(np.array(self.states, object), self.counts)
        for name in columns:
            if name not in frame:
                frame[name] = self._join(name)
        return frame

    def _join(self, name: str) -> np.ndarray:
        """Return the values of a column in all blocks; NaN in those without it."""
        parts = [
            np.broadcast_to(np.asarray(block.get(name, np.nan)), count)
            for block, count in zip(self.blocks, self.counts, strict=True)
        ]
        return np.concatenate(parts) if parts else np.zeros(0)


def build_tables(question: Fragility, places: Sequence[CurvePlace], solved: Responses) -> list[Table]:
    """Return the tables of curves, motions and points and, with a hazard curve, of rates and contributions."""
    spec = question.spec
    hazard = question.hazard
    records = np.array(question.plan.records, object)
    draws = draw_motions(len(records), spec.draws)
    names = [CURVES, MOTIONS, CURVE_POINTS]
    if hazard is not None:
        names += [RATES, CONTRIBUTIONS]
    if question.neighbour_axis is not None:
        names.append(NEIGHBOURS)
    rows = {name: _Rows() for name in names}
    groups = question.group_neighbours(places)
    for number, group in enumerate(groups):
        median_place, *drawn = group
        curves: CurveByState = {}
        blocks: dict[str, dict[str, Any]] = {}
        highest = 0.0  # intensity at which a motion holds or passes
        for state in median_place.histories:
            observed = _observe(question, solved, drawn or [median_place], state)
            intensity, demand, _ = observed
            curve = fit_curve(*observed, draws, spec)
            blocks[state] = curve.columns
            if drawn:
                of_median = fit_curve(*_observe(question, solved, [median_place], state), draws, spec)
                rows[NEIGHBOURS].add(number, state, _compare_with_median(curve, of_median, len(drawn)))
            if curve.is_fitted:
                curves[state] = curve
            brackets = find_brackets(intensity, demand)
            highest = max(highest, np.where(np.isfinite(brackets.passed), brackets.passed, brackets.held).max())
            of_rows = np.tile(records, len(demand) // len(records))
            rows[MOTIONS].add(number, state, _build_motions(spec.method, of_rows, intensity, demand))
        if len(curves) == 2:
            medians = {state: curve.fits.median for state, curve in curves.items()}
            blocks[WITH_POUNDING] |= _build_ratio("ratio", medians, curves, spec.confidence)
        for state, block in blocks.items():
            rows[CURVES].add(number, state, block)
        for state, block in _build_points(curves, highest, spec.confidence).items():
            rows[CURVE_POINTS].add(number, state, block)
        if hazard is not None:
            rates = _build_rates(hazard, curves, spec.confidence)
            for state in median_place.histories:
                rows[RATES].add(number, state, rates.get(state, {"rate": np.nan}))
            for state, block in _build_contributions(hazard, curves).items():
                rows[CONTRIBUTIONS].add(number, state, block)
    firsts = [group[0] for group in groups]
    return [_to_table(question, name, rows[name], firsts) for name in names]


def _observe(
    question: Fragility, solved: Responses, places: Sequence[CurvePlace], state: str
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return intensities, demands, and whether time histories were asked for, a row for every place and motion."""
    intensities = [question.intensities[place.number] for place in places]
    demands = [find_demands(question.plan, solved, place, state) for place in places]
    are_asked = [solved.is_known[place.histories[state]] for place in places]
    return np.concatenate(intensities), np.concatenate(demands), np.concatenate(are_asked)


def _compare_with_median(curve: FragilityCurve, of_median: FragilityCurve, neighbours: int) -> dict[str, float]:
    """Return the columns that compare a curve over what a neighbour may be with that of its median building.

    Where the intensities at which motions hold and pass do not overlap with the median building, the capacities scatter
    by less than the step: by 0. Where they do not overlap over all buildings there is no curve to compare.
    """
    medians = np.full(2, np.nan)
    spreads = np.full(2, np.nan)
    for number, each in enumerate((curve, of_median)):
        if each.is_fitted or (each is of_median and each.columns["outcome"] == FitOutcome.SEPARATED):
            medians[number] = each.fits.median[0]
            spreads[number] = each.fits.spread[0]
    median, median_of_median = medians.tolist()
    spread, spread_of_median = spreads.tolist()
    added = spread**2 - spread_of_median**2
    widening = 0.0 * added  # NaN where one of both is not known
    if added > MIN_ADDED * spread**2:
        widening = added**0.5
    return {
        "neighbours": neighbours,
        "median": median,
        "spread": spread,
        "median_of_median": median_of_median,
        "spread_of_median": spread_of_median,
        "widening": widening,
    }


def _to_table(question: Fragility, name: str, rows: _Rows, places: Sequence[CurvePlace]) -> Table:
    """Return the table of some rows."""
    plan = question.plan
    axes = [axis for number, axis in enumerate(plan.axes) if number not in (question.axis, question.neighbour_axis)]
    where = _build_where(question, places)
    frame = rows.to_frame(list_columns(name, question.spec.method), where)
    unit = Unit(question.unit.name, question.unit.factor, question.unit.si or "1")
    units = dict.fromkeys(IN_UNIT_OF_INTENSITY, unit)
    return build_table(name, frame, [*list_swept_columns(axes), *COLUMNS_BY_TABLE[name]], units)


def _build_where(question: Fragility, places: Sequence[CurvePlace]) -> pd.DataFrame:
    """Return where curves stand: the swept values but the intensity, case, analysis, limit and building."""
    plan = question.plan
    others = [number for number in range(len(plan.axes)) if number not in (question.axis, question.neighbour_axis)]
    return build_swept_frame(
        [plan.axes[number] for number in others],
        [[place.point[number] for number in others] for place in places],
        case=[plan.cases[place.case] for place in places],
        analysis=[plan.analyses[place.analysis] for place in places],
        limit=[str(place.target.limit) for place in places],
        building=[place.target.label(plan.buildings) for place in places],
    )


def _build_motions(
    method: str, records: np.ndarray, intensity: np.ndarray, demand: np.ndarray
) -> dict[str, np.ndarray]:
    """Return the columns of all motions for one curve; intensity and demand of shape (motions, levels)."""
    if method == "ida":
        brackets = find_brackets(intensity, demand)
        columns = {"record": records, "held": brackets.held, "passed": brackets.passed}
        return columns | {"undecided": brackets.undecided}
    is_undecided = demand == UNDECIDED
    return {
        "record": np.repeat(records, intensity.shape[1]),
        "intensity": intensity.ravel(),
        "demand": np.where(is_undecided, np.nan, demand).ravel(),
        "undecided": is_undecided.ravel().astype(int),
    }


def _build_ratio(
    name: str, values: Mapping[str, np.ndarray], curves: CurveByState, confidence: float
) -> dict[str, float]:
    """Return the ratio of a number with pounding to that alone, with its interval over the same draws.

    A draw whose ratio has no value, both beyond the same end, is taken as 1.

    values : of the curves first, then of their draws
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = values[WITH_POUNDING] / values[ALONE]
    ratio[1:] = np.where(np.isnan(ratio[1:]), 1.0, ratio[1:])
    return build_estimate(name, ratio, confidence, min(curve.motions for curve in curves.values()))


def _build_points(curves: CurveByState, highest: float, confidence: float) -> dict[str, dict[str, Any]]:
    """Return by state the points of its curve with their band, at the same intensities.

    They reach from above 0 to beyond nearly all of each, but not far beyond where motions pass.

    highest : intensity at which a motion holds or passes
    """
    if not curves:
        return {}
    median = np.array([curve.fits.median[0] for curve in curves.values()])
    spread = np.array([curve.fits.spread[0] for curve in curves.values()])
    last = np.minimum(median * np.exp(1.8 * spread), np.maximum(2 * highest, 1.2 * median)).max()
    x = np.linspace(0.0, 1.1 * last, POINTS_OF_CURVE + 1)[1:]
    return {
        state: {"intensity": x} | build_estimate("probability", curve.fits.probability(x), confidence, curve.motions)
        for state, curve in curves.items()
    }


def _build_rates(hazard: Hazard, curves: CurveByState, confidence: float) -> dict[str, dict[str, Any]]:
    """Return by state the annual rate of a limit and, with pounding, its ratio to that alone."""
    rates = {}
    blocks = {}
    for state, curve in curves.items():
        fits = curve.fits
        without_trend = np.where(fits.share > 0, fits.share * hazard.rate(np.zeros(1)), 0.0)
        rates[state] = np.where(np.isinf(fits.spread), without_trend, hazard.lognormal_rates(fits.median, fits.spread))
        rate = float(rates[state][0])
        beyond = float(hazard.lognormal_rates(fits.median[0], fits.spread[0], above=hazard.last))
        blocks[state] = build_estimate("rate", rates[state], confidence, curve.motions) | {
            "probability": poisson_probability(rate),
            "beyond": beyond / rate if rate > 0 else 0.0,
        }
    if len(rates) == 2 and rates[ALONE][0] > 0:
        blocks[WITH_POUNDING] |= _build_ratio("rate_ratio", rates, curves, confidence)
    return blocks


def _build_contributions(hazard: Hazard, curves: CurveByState) -> dict[str, dict[str, Any]]:
    """Return by state the rates that come from ranges of intensities, equal in their logarithm."""
    if not curves:
        return {}
    medians = {state: curve.fits.median[0] for state, curve in curves.items()}
    spreads = {state: curve.fits.spread[0] for state, curve in curves.items()}
    low = min(medians[state] * np.exp(-4 * spreads[state]) for state in curves)
    high = max(2.5 * medians[state] * np.exp(3 * spreads[state]) for state in curves)
    edges = np.geomspace(max(low, hazard.edges[0]), max(high, 2 * hazard.edges[0]), RANGES_OF_RATE + 1)
    blocks = {}
    for state in curves:
        slope = np.full(RANGES_OF_RATE, 1 / spreads[state])
        rate = hazard.contributions(edges, -slope * np.log(medians[state]), slope)
        blocks[state] = {"from": edges[:-1], "to": edges[1:], "rate": rate}
    return blocks
