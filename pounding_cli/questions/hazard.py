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

import numpy as np
from numpy.typing import ArrayLike
from pydantic_core import PydanticCustomError

from pounding_cli import records
from pounding_cli.errors import InputError
from pounding_cli.questions.question import StudyQuestion
from pounding_cli.questions.specs import HazardFile, Measure, PowerHazard
from pounding_cli.records import Motion
from pounding_cli.records.hazard import intensity_factor, read_hazard
from pounding_cli.study.construct.motions import MotionUse
from pounding_cli.study.schema.quantity import ACCELERATION, Quantity
from pounding_cli.study.schema.records import INTENSITY_KEYS, CodeTargetSpec, scales_in_proportion
from pounding_cli.study.vary.axes import Axis

YEARS = 50.0
"""Years of the probability that stands beside a rate."""


@dataclass(frozen=True)
class Hazard:
    """The annual rate at which an intensity is exceeded, as power laws k0 x^-k.

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
    def from_power_law(cls, k0: float, k: float) -> Hazard:
        """Return the curve k0 x^-k at all intensities."""
        return cls(np.array([0.0, np.inf]), np.array([k0]), np.array([k]))

    @classmethod
    def from_points(cls, intensity: np.ndarray, rate: np.ndarray) -> Hazard:
        """Return the curve through points, at least two.

        intensity : rising, above 0, shape (n,)
        rate : falling, above 0 [1/year], shape (n,)
        """
        log_intensity = np.log(intensity)
        log_rate = np.log(rate)
        k = -np.diff(log_rate) / np.diff(log_intensity)
        k0 = np.exp(log_rate[:-1] + k * log_intensity[:-1])
        return cls(np.append(intensity[:-1], np.inf), k0, k, float(intensity[-1]))

    def rate(self, intensity: np.ndarray) -> np.ndarray:
        """Return the annual rate at which intensities are exceeded [1/year]; below the first edge that of the edge."""
        x = np.maximum(intensity, self.edges[0])
        piece = np.clip(np.searchsorted(self.edges, x, side="right") - 1, 0, self.k.size - 1)
        with np.errstate(divide="ignore"):
            return self.k0[piece] * x ** -self.k[piece]

    def contributions(self, edges: np.ndarray, intercept: np.ndarray, slope: np.ndarray) -> np.ndarray:
        """Return the annual rates of limits by range of intensities [1/year], shape (..., m).

        edges : intensities, rising, shape (m + 1,)
        intercept, slope : c and b of the probability Phi(c + b ln x) between them, shape (..., m)
        """
        lowest = max(edges[0], self.edges[0])
        cuts = np.unique(np.clip(np.concatenate([edges, self.edges]), lowest, edges[-1]))
        if cuts.size < 2:
            return np.zeros(intercept.shape)
        part = np.clip(np.searchsorted(edges, cuts[:-1], side="right") - 1, 0, edges.size - 2)
        piece = np.clip(np.searchsorted(self.edges, cuts[:-1], side="right") - 1, 0, self.k.size - 1)
        rates = _integrate_pieces(
            cuts[:-1], cuts[1:], self.k0[piece], self.k[piece], intercept[..., part], slope[..., part]
        )
        return np.stack([rates[..., part == each].sum(axis=-1) for each in range(edges.size - 1)], axis=-1)

    def lognormal_rates(self, median: ArrayLike, spread: ArrayLike, above: float = 0.0) -> np.ndarray:
        """Return the annual rates of limits with lognormal fragility curves [1/year].

        With a spread of 0 it is the rate at which the median is exceeded; with a median of inf it is 0.

        above : lowest intensity that counts
        """
        median, spread = np.broadcast_arrays(np.asarray(median, float), np.asarray(spread, float))
        is_curve = (spread > 0) & (median > 0) & (median < np.inf)
        slope = 1.0 / np.where(is_curve, spread, 1.0)
        intercept = -slope * np.log(np.where(is_curve, median, 1.0))
        whole = np.array([above, np.inf])
        rates = self.contributions(whole, intercept[..., None], slope[..., None])[..., 0]
        at_median = self.rate(np.maximum(np.where(np.isfinite(median), median, 1.0), above))
        return np.where(is_curve, rates, np.where(median == np.inf, 0.0, at_median))


def _integrate_pieces(
    low: np.ndarray, high: np.ndarray, k0: np.ndarray, k: np.ndarray, intercept: np.ndarray, slope: np.ndarray
) -> np.ndarray:
    """Return the integral of the module's docstring over pieces from `low` to `high` [1/year]."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        low_score = _score(low, intercept, slope)
        high_score = _score(high, intercept, slope)
        low_rate = _rate_at_end(low, low_score, k0, k)
        high_rate = _rate_at_end(high, high_score, k0, k)
        shift = k / slope
        log_size = np.log(k0) + intercept * shift + 0.5 * shift**2
        between = _scaled_difference(low_score + shift, high_score + shift, log_size)
    return low_rate - high_rate + np.where(slope == 0, 0.0, between)


def _score(x: np.ndarray, intercept: np.ndarray, slope: np.ndarray) -> np.ndarray:
    """Return c + b ln x, which is c at any x where b is 0."""
    return np.where(slope == 0, intercept, intercept + slope * np.log(x))


def _rate_at_end(x: np.ndarray, score: np.ndarray, k0: np.ndarray, k: np.ndarray) -> np.ndarray:
    """Return P(x) lambda(x) at one end of a piece; 0 at the intensities 0 and inf."""
    from scipy.special import ndtr  # here: reading a study takes no SciPy

    return np.where(np.isinf(x) | (x == 0), 0.0, ndtr(score) * k0 * x**-k)


def _scaled_difference(low: np.ndarray, high: np.ndarray, log_size: np.ndarray) -> np.ndarray:
    """Return exp(log_size) (Phi(high) - Phi(low)).

    In the upper tail it is taken from the complements, whose logarithms are exact.
    """
    from scipy.special import log_ndtr

    is_upper = (np.maximum(low, high) > 0) & (np.minimum(low, high) > -np.inf)
    first = np.where(is_upper, -high, low)
    second = np.where(is_upper, -low, high)
    return np.exp(log_size + log_ndtr(second)) - np.exp(log_size + log_ndtr(first))


def poisson_probability(rate: float, years: float = YEARS) -> float:
    """Return the probability that an event with an annual rate [1/year] occurs within so many years [-]."""
    return float(-np.expm1(-rate * years))


_VELOCITY = Quantity("velocity", "m/s", "20 cm/s", 0.0, open_low=True)
_FACTOR = Quantity("scale factor", "", "1.5", 0.0, open_low=True)
MEASURE_QUANTITIES = {"pga": ACCELERATION, "sa": ACCELERATION, "ag": ACCELERATION, "pgv": _VELOCITY, "factor": _FACTOR}
"""Quantity of every intensity measure, by which its values are read."""

SWEEP_EXAMPLE = "write e.g. `sweep: {records.scale.pga: {from: 0.05 g, to: 2 g, step: 0.05 g}}`"


def find_intensity_axis(question: StudyQuestion, axes: Sequence[Axis], min_intensities: int = 1) -> int | None:
    """Return the number of the axis that varies the intensity; add what is wrong with it to the question's problems."""
    for number, axis in enumerate(axes):
        if INTENSITY_KEYS.keys().isdisjoint(axis.names):
            continue
        path: tuple[str, ...] = ("sweep",)
        message = ""
        if len(axis.names) > 1:
            message = f"{' and '.join(axis.names)} move together: the intensity is an axis of its own"
        elif not scales_in_proportion(axis.names[0], code := _target_code(question)):
            message = f"the spectrum of {code} is not in proportion to '{axis.names[0]}', as an intensity has to be"
        elif any(isinstance(value, str) for (value,) in axis.values):
            message = f"'{axis.names[0]}' takes values that are not numbers"
        elif len(axis) < min_intensities:
            path = ("sweep", axis.names[0])
            message = "a fragility curve takes two intensities at least"
        if message:
            is_key = len(path) == 1
            question.problems.add_at(question.study.tree, path, message, SWEEP_EXAMPLE, key=is_key)
        return number
    return None


def _target_code(question: StudyQuestion) -> str | None:
    """Return the code of the target spectrum as written; None without one."""
    target = getattr(question.study.spec.records.scale, "target", None)
    return target.name if isinstance(target, CodeTargetSpec) else None


def measure_motion(use: MotionUse, motion: Motion, measure: Measure) -> float:
    """Return the intensity of a motion as used [SI].

    measure : any but `ag`, which motions do not have by themselves
    """
    match measure.name:
        case "factor":
            return use.scale
        case "pga":
            return use.pga
        case "pgv":
            return records.pgv(motion)
    return float(records.spectrum(motion, (measure.period,))[0])


def build_hazard(question: StudyQuestion, measure: Measure) -> Hazard | None:
    """Return the hazard curve in the section of a question; None without one.

    measure : intensity measure of the question

    Raises
    ------
    InputError : no hazard curve, or one of another intensity measure
    """
    spec = question.spec.hazard
    quantity = MEASURE_QUANTITIES[measure.name]
    if spec is None:
        return None
    if isinstance(spec, HazardFile):
        path = question.study.path.parent / spec.file
        curve = read_hazard(path, quantity.si, spec.declare(), _name_measure(question, measure))
        question.taken = (*question.taken, curve.taken)
        return Hazard.from_points(curve.intensity, curve.rate)
    try:
        if isinstance(spec, PowerHazard):
            unit = spec.unit or {"m/s2": "g", "m/s": "m/s"}.get(quantity.si)
            one = intensity_factor(unit, quantity.si, "")
            return Hazard.from_power_law(spec.k0 * one**spec.k, spec.k)
        return Hazard.from_points(*_parse_hazard_table(spec, quantity))
    except InputError as error:
        question.add_issues(error.below("hazard").issues)
        question.problems.check()
        raise


def _parse_hazard_table(rate_by_level: Mapping[str, float], quantity: Quantity) -> np.ndarray:
    """Return intensities [SI] and annual rates of a table in the study, shape (2, n).  Raises InputError."""
    points = []
    for level, rate in rate_by_level.items():
        try:
            points.append((float(quantity.read(level)), rate))
        except PydanticCustomError as error:
            context = error.context or {}
            raise InputError(f"{level}: {context['message']}", context["hint"]) from None
    intensity, rates = np.array(sorted(points)).reshape(-1, 2).T
    if len(points) < 2 or (np.diff(intensity) <= 0).any() or (np.diff(rates) >= 0).any():
        hint = "give at least two intensities, each once, with rates that fall as they rise"
        raise InputError("this is not a hazard curve", hint)
    return np.stack([intensity, rates])


def _name_measure(question: StudyQuestion, measure: Measure) -> str:
    """Return the name of a measure as OpenQuake writes it; SA of any period where that is swept."""
    if measure.name != "sa":
        return measure.name.upper()
    is_swept = any("records.scale.period" in axis.names for axis in question.study.axes)
    written = 0.0 if is_swept else getattr(question.study.spec.records.scale, "period", 0.0)
    period = measure.period or written
    return f"SA({period:g})" if period else "SA"


# The gap for an annual rate of contact

MIN_GAP = 1e-6
MAX_GAP = 1e3
"""Gaps between which one is sought [m]; a closing below the first counts as it."""

_HALVINGS = 60


def compute_contact_rates(
    hazard: Hazard, log_gaps: np.ndarray, log_intensities: np.ndarray, log_closings: np.ndarray, draws: np.ndarray
) -> np.ndarray:
    """Return the annual rates of contact, of every draw of motions at its gap [1/year], shape (draws,).

    log_gaps : of the gaps [m], shape (draws,)
    log_intensities : rising, shape (levels,)
    log_closings : of the closings [m], shape (levels, motions)
    draws : how often each takes every motion, shape (draws, motions)
    """
    edges, intercept, slope = _fit_contact_lines(log_gaps, log_intensities, log_closings, draws)
    return hazard.contributions(edges, intercept, slope).sum(axis=1)


def compute_contact_probability(
    intensity: float, gap: float, log_intensities: np.ndarray, log_closings: np.ndarray
) -> float:  # fmt: skip
    """Return the probability that a gap closes at an intensity [-].

    gap : [m]
    log_intensities : rising, shape (levels,)
    log_closings : of the closings [m], shape (levels, motions)
    """
    from scipy.special import ndtr  # here: reading a study takes no SciPy

    draws = np.ones((1, log_closings.shape[1]))
    edges, intercept, slope = _fit_contact_lines(np.log([gap]), log_intensities, log_closings, draws)
    part = int(np.clip(np.searchsorted(edges, intensity, side="right") - 1, 0, edges.size - 2))
    return float(ndtr(intercept[0, part] + slope[0, part] * np.log(intensity)))


def _fit_contact_lines(
    log_gaps: np.ndarray, log_intensities: np.ndarray, log_closings: np.ndarray, draws: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return intensities, shape (levels + 1,), and between them c and b of the probability of contact
    Phi(c + b ln x), of every draw, shape (draws, levels); arguments as of `compute_contact_rates`."""
    count = draws.sum(axis=1, keepdims=True)
    mean = draws @ log_closings.T / count
    variance = np.maximum(draws @ (log_closings**2).T / count - mean**2, 0.0)
    spread = np.maximum(np.sqrt(variance * count / (count - 1)), 1e-6)
    edges = np.exp(np.concatenate([[-np.inf], log_intensities[:-1], [np.inf]]))  # the last line goes on
    score = (mean - log_gaps[:, None]) / spread
    slope = np.concatenate([1.0 / spread[:, :1], np.diff(score, axis=1) / np.diff(log_intensities)], axis=1)
    slope[:, -1] = np.maximum(slope[:, -1], 0.0)
    return edges, score - slope * log_intensities, slope


def find_intensity(hazard: Hazard, rate: float) -> float:
    """Return the intensity that is exceeded at an annual rate [1/year]; of a table at most its first one for rates that
    it does not have."""
    low = np.log(MIN_GAP)
    high = np.log(MAX_GAP)
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        is_too_often = float(hazard.rate(np.exp([middle]))[0]) > rate
        low, high = (middle, high) if is_too_often else (low, middle)
    return float(np.exp(0.5 * (low + high)))


def find_gaps(
    hazard: Hazard, rate: float, log_intensities: np.ndarray, log_closings: np.ndarray, draws: np.ndarray
) -> np.ndarray:
    """Return the gaps with an annual rate of contact, of every draw of motions [m], shape (draws,); NaN without one.

    rate : of contact [1/year]
    log_intensities : rising, shape (levels,)
    log_closings : of the closings [m], shape (levels, motions)
    draws : how often each takes every motion, shape (draws, motions)
    """
    low = np.full(len(draws), np.log(MIN_GAP))
    high = np.full(len(draws), np.log(MAX_GAP))
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        is_too_often = compute_contact_rates(hazard, middle, log_intensities, log_closings, draws) > rate
        low = np.where(is_too_often, middle, low)
        high = np.where(is_too_often, high, middle)
    is_inside = (low > np.log(2 * MIN_GAP)) & (high < np.log(0.5 * MAX_GAP))
    return np.where(is_inside, np.exp(0.5 * (low + high)), np.nan)
