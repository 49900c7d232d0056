"""The gap whose contact has an annual rate: the closings of all motions at one or more intensities, and a hazard curve.

At every intensity the closings of a pair of neighbours, the largest over its floors, have a lognormal distribution
over the motions, so that a gap g closes with the probability Phi((ln median - ln g) / dispersion). Between intensities
the argument of Phi is a straight line over the logarithm of the intensity, and its last line goes on. Below the lowest
intensity, and everywhere where there is only one, closings are taken to be in proportion to it, as those of linear
buildings are."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

import numpy as np
import pandas as pd

from pounding_cli.study import Plan, Study
from pounding_cli.study.file import Problems
from pounding_cli.study.motions import Pga, Pgv, Sa
from pounding_cli.study.questions import Measure
from pounding_cli.workflows.curves import draws_of, interval
from pounding_cli.workflows.fragility_question import INTENSITY_KEYS
from pounding_cli.workflows.hazard import YEARS, Hazard, hazard_of, probability
from pounding_cli.workflows.workflow import Columns, swept, tabled

if TYPE_CHECKING:
    from pounding_cli.results.tables import Table
    from pounding_cli.study.study import Point

RATE = "gap_rate"
"""Name of the table."""

DRAWS = 300
"""Draws of the bootstrap over the motions."""

FEWEST = 5
"""Motions from which an interval is told."""

LEAST, MOST = 1e-6, 1e3
"""Gaps between which one is sought [m]; a closing below the first counts as it."""

_COLUMNS: Columns = {
    "analysis": ("", "elastic or inelastic storeys"),
    "left": ("", "building left of the gap"),
    "right": ("", "building right of the gap"),
    "motions": ("1", "motions at every intensity"),
    "intensities": ("1", "intensities"),
    "rate": ("1/year", "annual rate of contact that is allowed"),
    "probability": ("1", f"probability of contact within {YEARS:g} years at this rate"),
    "gap": ("m", "gap with this rate of contact at any floor of the pair"),
    "gap_low": ("m", "lower end of its bootstrap interval"),
    "gap_high": ("m", "upper end of its bootstrap interval"),
}


def intensity_of(study: Study) -> tuple[int | None, Measure, np.ndarray]:
    """The swept axis of the intensity, the measure, and its values [SI].

    Raises
    ------
    InputError : the motions have no common intensity
    """
    for number, axis in enumerate(study.axes):
        if axis.names[0] in INTENSITY_KEYS and len(axis.names) == 1:
            levels = np.array([float(value) for (value,) in axis.values])
            return number, Measure(INTENSITY_KEYS[axis.names[0]]), levels
    scale, problems = study.model.records.scale, Problems(study.file)
    if not isinstance(scale, Pga | Pgv | Sa):
        hint = "write e.g. `scale: {sa: 0.4 g, period: 0.5 s}` in `records`, and sweep `records.scale.sa`"
        problems.at(study.root, ("gap", "rate"), "a rate needs motions that are scaled to an intensity", hint, key=True)
        problems.check()
    name = type(scale).__name__.lower()
    return None, Measure(name, scale.period if isinstance(scale, Sa) else 0.0), np.array([getattr(scale, name)])


def of_rate(plan: Plan, closings: pd.DataFrame, confidence: float) -> Table:
    """The gap for the rate that the study allows: a row for every point of the other axes, analysis and pair.

    closings : `point`, `number` (of the left building) and `motion` by number, `analysis`, and `value` [m]: the largest
        over the floors of the pair; NaN of a scene that failed
    """
    axis, measure, levels = intensity_of(plan.study)
    hazard, rate = hazard_of(plan.study, "gap", measure), plan.study.model.gap.rate
    assert hazard is not None  # the study was validated
    at = np.array(list(np.ndindex(*plan.shape[:-3])), int)[closings["point"]]
    others = [number for number in range(len(plan.axes)) if number != axis]
    places: list[Any] = [tuple(place) for place in at[:, others].tolist()]
    rows = closings.assign(level=0 if axis is None else at[:, axis], point=places)
    found = []
    for place, mine in rows.groupby(["point", "analysis", "number"], observed=True):
        point, analysis, number = cast("tuple[Point, str, int]", place)
        table = mine.pivot_table("value", "level", "motion", dropna=False).dropna(axis=1)
        table = table.iloc[np.argsort(levels[table.index])]
        logs, x = np.log(table.clip(lower=LEAST).to_numpy()), np.log(levels[table.index])
        count = logs.shape[1]
        row = {"point": point, "analysis": analysis, "left": plan.buildings[number], "motions": count}
        row |= {
            "right": plan.buildings[number + 1],
            "intensities": len(x),
            "rate": rate,
            "probability": probability(rate),
        }
        if count > 1:
            row["gap"], *drawn = _gaps(hazard, rate, x, logs, draws_of(count, DRAWS))
            if count >= FEWEST:
                row["gap_low"], row["gap_high"] = interval(np.array(drawn), confidence)
        found.append(row)
    frame = pd.DataFrame(found)
    where = swept([plan.axes[number] for number in others], frame.pop("point").tolist())
    unit = dict.fromkeys(["gap", "gap_low", "gap_high"], plan.study.unit("gap"))
    return tabled(RATE, where.join(frame.reindex(columns=list(_COLUMNS))), _COLUMNS, plan.axes, unit)


def _gaps(hazard: Hazard, rate: float, x: np.ndarray, logs: np.ndarray, times: np.ndarray) -> np.ndarray:
    """The gaps [m] with an annual rate of contact, of every draw, shape (draws,); NaN where there is none.

    x : ln intensities, rising, shape (levels,); logs : ln closings, shape (levels, motions)
    times : how often a draw takes every motion, shape (draws, motions)
    """
    count = times.sum(axis=1, keepdims=True)
    mean = times @ logs.T / count
    spread = np.sqrt(np.maximum(times @ (logs**2).T / count - mean**2, 0.0) * count / (count - 1))
    spread = np.maximum(spread, 1e-6)
    edges = np.exp(np.concatenate([[-np.inf], x[:-1], [np.inf]]))  # the last line goes on
    low, high = np.full(len(times), np.log(LEAST)), np.full(len(times), np.log(MOST))
    for _ in range(60):
        middle = 0.5 * (low + high)
        score = (mean - middle[:, None]) / spread
        slope = np.concatenate([1.0 / spread[:, :1], np.diff(score, axis=1) / np.diff(x)], axis=1)
        slope[:, -1] = np.maximum(slope[:, -1], 0.0)
        often = hazard.contributions(edges, score - slope * x, slope).sum(axis=1) > rate
        low, high = np.where(often, middle, low), np.where(often, high, middle)
    is_inside = (low > np.log(2 * LEAST)) & (high < np.log(0.5 * MOST))
    return np.where(is_inside, np.exp(0.5 * (low + high)), np.nan)
