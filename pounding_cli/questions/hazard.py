"""Seismic hazard: the annual rate at which an intensity is exceeded, and from it the annual rate of a limit; the
intensity measures of motions.

Between the points of a hazard curve the logarithm of the rate is a straight line over the logarithm of the intensity,
so every piece is a power law, lambda(x) = k0 x^-k. Where the probability that a limit is passed is
P(x) = Phi(c + b ln x), its annual rate over a piece from x1 to x2,

    integral of P(x) |d lambda(x)|  =  P(x1) lambda(x1) - P(x2) lambda(x2)
                                       + k0 exp(k c / b + k^2 / 2 b^2) (Phi(u2) - Phi(u1)),    u = c + b ln x + k / b,

is exact. Over one power law this is k0 theta^-k exp(k^2 beta^2 / 2), with the median theta and the logarithmic spread
beta (Cornell, C. A., Jalayer, F., Hamburger, R. O. and Foutch, D. A. (2002). Probabilistic basis for 2000 SAC Federal
Emergency Management Agency steel moment frame guidelines. Journal of Structural Engineering 128(4), 526-533).

A gap has an annual rate of contact too. At every intensity the closings of a pair of neighbours, the largest over its
floors, have a lognormal distribution over the motions, so that a gap g closes with the probability
Phi((ln median - ln g) / dispersion). Between intensities the argument of Phi is a straight line over the logarithm of
the intensity, and its last line goes on. Below the lowest intensity, and everywhere where there is only one, closings
are taken to be in proportion to it, as those of linear buildings are."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike
from pydantic_core import PydanticCustomError
from scipy.special import log_ndtr, ndtr

from pounding_cli import records
from pounding_cli.errors import InputError, Problem
from pounding_cli.questions.question import StudyQuestion
from pounding_cli.questions.specs import HazardFile, Measure, PowerHazard
from pounding_cli.records import Motion
from pounding_cli.records.hazard import intensity_factor, read_hazard
from pounding_cli.study.axes import Axis
from pounding_cli.study.motions import MotionUse
from pounding_cli.study.quantity import ACCELERATION, Quantity
from pounding_cli.study.records_spec import INTENSITY_KEYS

YEARS = 50.0
"""Years of the probability that is told beside a rate."""


@dataclass(frozen=True)
class Hazard:
    """How often an intensity is exceeded, as power laws k0 x^-k.

    Below the first edge nothing is known, and nothing is counted; above the last point of a table its last power law
    goes on.

    edges : intensities between which each holds, rising from 0 or the first point of a table to inf, shape (n + 1,)
    k0, k : of each, shape (n,)
    last : the last intensity that a table has; inf of a power law
    """

    edges: np.ndarray
    k0: np.ndarray
    k: np.ndarray
    last: float = np.inf

    @classmethod
    def power_law(cls, k0: float, k: float) -> Hazard:
        """k0 x^-k at all intensities."""
        return cls(np.array([0.0, np.inf]), np.array([k0]), np.array([k]))

    @classmethod
    def table(cls, intensity: np.ndarray, rate: np.ndarray) -> Hazard:
        """Through points: intensities, rising, and annual rates, falling, shape (n,), at least two, all above 0."""
        x, y = np.log(intensity), np.log(rate)
        k = -np.diff(y) / np.diff(x)
        return cls(np.append(intensity[:-1], np.inf), np.exp(y[:-1] + k * x[:-1]), k, float(intensity[-1]))

    def rate(self, intensity: np.ndarray) -> np.ndarray:
        """Annual rate at which intensities are exceeded [1/year]; of those below the first that of the first."""
        x = np.maximum(intensity, self.edges[0])
        piece = np.clip(np.searchsorted(self.edges, x, side="right") - 1, 0, self.k.size - 1)
        with np.errstate(divide="ignore"):
            return self.k0[piece] * x ** -self.k[piece]

    def contributions(self, edges: np.ndarray, intercept: np.ndarray, slope: np.ndarray) -> np.ndarray:
        """Annual rates of limits by intensity [1/year], shape (..., m).

        edges : intensities, rising, shape (m + 1,)
        intercept, slope : c and b of the probability Phi(c + b ln x) between them, shape (..., m)
        """
        cuts = np.unique(np.clip(np.concatenate([edges, self.edges]), max(edges[0], self.edges[0]), edges[-1]))
        if cuts.size < 2:
            return np.zeros(intercept.shape)
        part = np.clip(np.searchsorted(edges, cuts[:-1], side="right") - 1, 0, edges.size - 2)
        piece = np.clip(np.searchsorted(self.edges, cuts[:-1], side="right") - 1, 0, self.k.size - 1)
        rates = _piece(cuts[:-1], cuts[1:], self.k0[piece], self.k[piece], intercept[..., part], slope[..., part])
        return np.stack([rates[..., part == each].sum(axis=-1) for each in range(edges.size - 1)], axis=-1)

    def of_lognormal(self, median: ArrayLike, spread: ArrayLike, above: float = 0.0) -> np.ndarray:
        """Annual rates of limits with lognormal fragility curves, from intensities above one [1/year]; with a spread of
        0 that at which the median is exceeded, and none where the median is inf."""
        median, spread = np.broadcast_arrays(np.asarray(median, float), np.asarray(spread, float))
        is_curve = (spread > 0) & (median > 0) & (median < np.inf)
        slope = 1.0 / np.where(is_curve, spread, 1.0)
        intercept = -slope * np.log(np.where(is_curve, median, 1.0))
        whole = np.array([above, np.inf])
        rates = self.contributions(whole, intercept[..., None], slope[..., None])[..., 0]
        at_median = self.rate(np.maximum(np.where(np.isfinite(median), median, 1.0), above))
        return np.where(is_curve, rates, np.where(median == np.inf, 0.0, at_median))


def _piece(
    low: np.ndarray, high: np.ndarray, k0: np.ndarray, k: np.ndarray, intercept: np.ndarray, slope: np.ndarray
) -> np.ndarray:
    """The integral of the module's first lines, of many pieces at once."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        ends = [np.where(slope == 0, intercept, intercept + slope * np.log(x)) for x in (low, high)]
        first, second = (np.where(np.isinf(x) | (x == 0), 0.0, ndtr(z) * k0 * x**-k)
                         for x, z in zip((low, high), ends, strict=True))  # fmt: skip
        shift = k / slope
        size = np.log(k0) + intercept * shift + 0.5 * shift**2
        between = _difference(ends[0] + shift, ends[1] + shift, size)
    return first - second + np.where(slope == 0, 0.0, between)


def _difference(u1: np.ndarray, u2: np.ndarray, size: np.ndarray) -> np.ndarray:
    """exp(size) (Phi(u2) - Phi(u1)); in the upper tail by the complements, whose logarithms are exact."""
    flip = np.maximum(u1, u2) > 0
    flip &= np.minimum(u1, u2) > -np.inf
    a, b = np.where(flip, -u2, u1), np.where(flip, -u1, u2)
    return np.exp(size + log_ndtr(b)) - np.exp(size + log_ndtr(a))


def probability(rate: float, years: float = YEARS) -> float:
    """Probability [-] that what comes at an annual rate [1/year] comes within so many years (Poisson process)."""
    return float(-np.expm1(-rate * years))


_VELOCITY = Quantity("velocity", "m/s", "20 cm/s", 0.0, open_low=True)
_FACTOR = Quantity("scale factor", "", "1.5", 0.0, open_low=True)
INTENSITIES = {"pga": ACCELERATION, "sa": ACCELERATION, "pgv": _VELOCITY, "factor": _FACTOR}
"""How every intensity measure is written."""


SWEEP = "write e.g. `sweep: {records.scale.pga: {from: 0.05 g, to: 2 g, step: 0.05 g}}`"


def intensity_axis(asked: StudyQuestion, axes: Sequence[Axis], least: int = 1) -> int | None:
    """The number of the axis that varies the intensity; what is wrong with it is noted.

    least : intensities that are needed
    """
    root, problems = asked.study.tree, asked.problems
    for number, axis in enumerate(axes):
        if INTENSITY_KEYS.keys().isdisjoint(axis.names):
            continue
        if len(axis.names) > 1:
            what = f"{' and '.join(axis.names)} move together: the intensity is an axis of its own"
            problems.at(root, ("sweep",), what, SWEEP, key=True)
        elif any(isinstance(value, str) for (value,) in axis.values):
            problems.at(root, ("sweep",), f"'{axis.names[0]}' takes values that are not numbers", SWEEP, key=True)
        elif len(axis) < least:
            problems.at(root, ("sweep", axis.names[0]), "a fragility curve takes two intensities at least", SWEEP)
        return number
    return None


def measure_motion(use: MotionUse, motion: Motion, measure: Measure) -> float:
    """Return the intensity of a motion as used [SI]."""
    match measure.name:
        case "factor":
            return use.scale
        case "pga":
            return use.pga
        case "pgv":
            return records.pgv(motion)
    return float(records.spectrum(motion, (measure.period,))[0])


def hazard_of(asked: StudyQuestion, measure: Measure) -> Hazard | None:
    """The hazard curve that the section of a question gives; None without one.

    Raises
    ------
    InputError : no hazard curve, or one of another intensity measure
    """
    spec, quantity = asked.spec.hazard, INTENSITIES[measure.name]
    if spec is None:
        return None
    if isinstance(spec, HazardFile):
        return Hazard.table(*_from_file(asked.study.path.parent / spec.file, spec.unit, quantity.si, measure))
    try:
        if isinstance(spec, PowerHazard):
            one = intensity_factor(spec.unit or {"m/s2": "g", "m/s": "m/s"}.get(quantity.si), quantity.si, "")
            return Hazard.power_law(spec.k0 * one**spec.k, spec.k)
        return Hazard.table(*_from_study(spec, quantity))
    except InputError as error:
        for problem in error.problems:
            asked.add_problem(("hazard",), problem.message, problem.hint)
        asked.problems.check()
        raise


def _from_study(levels: Mapping[str, float], quantity: Quantity) -> np.ndarray:
    """Intensities [SI] and annual rates of a table in the study, shape (2, n).  Raises InputError."""
    points = []
    for level, rate in levels.items():
        try:
            points.append((float(quantity.read(level)), rate))
        except PydanticCustomError as refused:
            told = refused.context or {}
            raise InputError(Problem(f"{level}: {told['message']}", told["hint"])) from None
    found = np.array(sorted(points)).T
    if len(points) < 2 or (np.diff(found[0]) <= 0).any() or (np.diff(found[1]) >= 0).any():
        hint = "give at least two intensities, each once, with rates that fall as they rise"
        raise InputError(Problem("this is not a hazard curve", hint))
    return found


def _from_file(path: Path, unit: str | None, si: str, measure: Measure) -> tuple[np.ndarray, np.ndarray]:
    """The points of a file, unless it says that they are those of another measure."""
    intensity, rate, named = read_hazard(path, unit, si)
    mine = f"SA({measure.period:g})" if measure.name == "sa" and measure.period else measure.name.upper()
    if named and named != mine and not (mine == "SA" and named.startswith("SA")):
        hint = f"write `intensity: {named.lower()}`, or take the curve of {measure}"
        raise InputError(Problem(f"the hazard is that of {named}, the intensity is {measure}", hint, str(path)))
    return intensity, rate


# The gap for an annual rate of contact

LEAST, MOST = 1e-6, 1e3
"""Gaps between which one is sought [m]; a closing below the first counts as it."""


def gaps_of(hazard: Hazard, rate: float, x: np.ndarray, logs: np.ndarray, times: np.ndarray) -> np.ndarray:
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
