"""The gap whose contact has an annual rate: the closings of all motions at one or more intensities, and a hazard curve.

At every intensity the closings of a pair of neighbours, the largest over its floors, have a lognormal distribution
over the motions, so that a gap g closes with the probability Phi((ln median - ln g) / dispersion). Between intensities
the argument of Phi is a straight line over the logarithm of the intensity, and its last line goes on. Below the lowest
intensity, and everywhere where there is only one, closings are taken to be in proportion to it, as those of linear
buildings are."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from pounding_cli.study import Plan, Study
from pounding_cli.study.file import Problems
from pounding_cli.study.models import Pga, Pgv, Sa
from pounding_cli.study.questions import Measure
from pounding_cli.workflows.curves import interval, resamples
from pounding_cli.workflows.fragility_question import INTENSITY_KEYS
from pounding_cli.workflows.hazard import YEARS, Hazard, hazard_of, probability
from pounding_cli.workflows.workflow import Columns, swept, tabled

if TYPE_CHECKING:
    from pounding_cli.results.tables import Table

NAME = "gap_rate"
"""Name of the table."""

DRAWS = 300
"""Draws of the bootstrap over the motions."""

FEWEST = 5
"""Motions from which an interval is told."""

LEAST, MOST = 1e-6, 1e3
"""Gaps between which one is sought [m]; a closing below the first counts as it."""

COLUMNS: Columns = {
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
    scale = study.model.records.scale
    if isinstance(scale, Pga | Pgv | Sa):
        name = type(scale).__name__.lower()
        return None, Measure(name, scale.period if isinstance(scale, Sa) else 0.0), np.array([getattr(scale, name)])
    problems = Problems(study.file)
    hint = (
        "write e.g. `scale: {sa: 0.4 g, period: 0.5 s}` in `records`, and `sweep: {records.scale.sa: [0.2 g, 0.8 g]}`"
    )
    problems.at(study.root, ("gap", "rate"), "a rate needs motions that are scaled to an intensity", hint, key=True)
    problems.check()
    raise AssertionError


def of_rate(plan: Plan, closings: pd.DataFrame, confidence: float) -> Table:
    """The gap for the rate that the study allows: a row for every point of the other axes, analysis and pair.

    closings : `point`, `analysis`, `number` (of the pair), `motion` by number, and `value` [m]: the largest over the
        floors of the pair; NaN of a scene that failed
    """
    study = plan.study
    axis, measure, levels = intensity_of(study)
    hazard, wanted = hazard_of(study, "gap", measure), study.model.gap.rate
    assert hazard is not None  # the study was validated
    at = np.array(np.unravel_index(closings["point"], plan.shape[:-3]) if plan.axes else np.zeros((0, len(closings))))
    others = [number for number in range(len(plan.axes)) if number != axis]
    rows = closings.assign(level=0 if axis is None else at[axis])
    for number in others:
        rows[f"axis {number}"] = at[number]
    keys = [f"axis {number}" for number in others] + ["analysis", "number"]
    found = []
    for place, mine in rows.groupby(keys):
        table = mine.pivot_table("value", "level", "motion", dropna=False).dropna(axis=1)
        logs, x = np.log(table.clip(lower=LEAST).to_numpy()), np.log(levels[table.index])
        order = np.argsort(x)
        row = dict(zip(keys, place, strict=True)) | {"motions": logs.shape[1], "intensities": logs.shape[0]}
        if logs.shape[1] > 1:
            times = np.vstack([np.ones(logs.shape[1]), resamples(logs.shape[1], DRAWS)])
            gaps = _gaps(hazard, wanted, x[order], logs[order], times)
            row["gap"] = gaps[0]
            if logs.shape[1] >= FEWEST:
                row["gap_low"], row["gap_high"] = interval(gaps[1:], confidence)
        found.append(row)
    frame = pd.DataFrame(found).assign(rate=wanted, probability=probability(wanted))
    where = swept([plan.axes[number] for number in others], frame[keys[:-2]].to_numpy(int).tolist())
    names = np.array(plan.buildings, object)
    frame = frame.assign(
        analysis=np.array(plan.analyses, object)[frame["analysis"]], left=names[frame["number"]],
        right=names[frame["number"] + 1],
    ).reindex(columns=list(COLUMNS))  # fmt: skip
    unit = study.unit("gap")
    return tabled(NAME, where.join(frame), COLUMNS, plan.axes, dict.fromkeys(["gap", "gap_low", "gap_high"], unit))


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
        intercept = score - slope * x
        often = hazard.contributions(edges, intercept, slope).sum(axis=1) > rate
        low, high = np.where(often, middle, low), np.where(often, high, middle)
    middle = 0.5 * (low + high)
    is_inside = (middle > np.log(2 * LEAST)) & (middle < np.log(0.5 * MOST))
    return np.where(is_inside, np.exp(middle), np.nan)
