"""Scale factors that bring a motion, or a suite of motions, to a wanted intensity, and how well a suite then fits."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pounding_cli.errors import InputError
from pounding_cli.records.motion import SPECTRUM_DAMPING, Motion, arias, spectrum

FIT_POINTS = 50
"""Periods of the fit to a target spectrum: so many, evenly in ln T over the range."""

POINTS_PER_FIT_POINT = 8
"""Points of the spectrum of a motion that is a target, for each one of the fit."""

MIN_SLOPE_DAMPING = 0.01
"""Damping ratio below which the slope of a spectrum is bounded as at it [-]."""

RATIO_TOLERANCE = 1e-4
"""Relative error of the smallest ratio of a mean spectrum to its target, at most [-]."""


@dataclass(frozen=True)
class TargetSpectrum:
    """A spectrum to be met over a range of periods.

    periods, values : its points [s], [m/s2]; the first period may be 0 where the line from there is straight in T
    low, high : the range [s]
    damping : ratio [-]
    straight_in_period : of every interval between points, whether the line is straight in T and Sa, as the rising
        branches of codes are; else it is straight in ln T and ln Sa, as all of them are where this is empty
    name : code and parameters in words, e.g. "EN 1998-1, type 1, soil C, 0.25 g"; "" of another spectrum
    """

    periods: tuple[float, ...]
    values: tuple[float, ...]
    low: float
    high: float
    damping: float = SPECTRUM_DAMPING
    straight_in_period: tuple[bool, ...] = ()
    name: str = ""

    @classmethod
    def of(cls, motion: Motion, low: float, high: float, damping: float = SPECTRUM_DAMPING) -> TargetSpectrum:
        """The spectrum of a motion itself, exact at every period of `grid`, and straight between points that are close.
        Raises InputError for one at rest."""
        grid = np.geomspace(low, high, POINTS_PER_FIT_POINT * (FIT_POINTS - 1) + 1)
        values = spectrum(motion, grid, damping)
        scale_factor(motion, float(values.min()), 1.0)
        return cls(tuple(map(float, grid)), tuple(map(float, values)), low, high, damping)

    @cached_property
    def grid(self) -> np.ndarray:
        """The periods at which it is met [s], shape (POINTS,)."""
        return np.geomspace(self.low, self.high, FIT_POINTS)

    @property
    def ordinates(self) -> np.ndarray:
        """Its values at `grid` [m/s2]."""
        return self.interpolate(self.grid)

    def interpolate(self, periods: np.ndarray) -> np.ndarray:
        """Return its values at `periods` [m/s2]."""
        points = np.array(self.periods)
        values = np.array(self.values)
        has_logarithm = points > 0
        logarithms = np.interp(np.log(periods), np.log(points[has_logarithm]), np.log(values[has_logarithm]))
        ordinates: np.ndarray = np.exp(logarithms)
        if not any(self.straight_in_period):
            return ordinates
        is_straight = np.array(self.straight_in_period)[self._intervals_of(periods)]
        return np.where(is_straight, np.interp(periods, points, values), ordinates)

    def _intervals_of(self, periods: np.ndarray) -> np.ndarray:
        """Return the numbers of the intervals between points in which periods lie, or that are next to them."""
        return np.clip(np.searchsorted(self.periods, periods, side="right") - 1, 0, len(self.periods) - 2)

    def slope_bounds(self, periods: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the lowest and the highest slope d ln Sa / d ln T between each two of some periods [-].

        Between two of its points the slope is constant, or rises or falls all the way: that of a straight line
        Sa = a + b T is b T / Sa. No two periods may have a point between them.

        periods : rising, shape (n,); the slopes have the shape (n - 1,)
        """
        ordinates = self.interpolate(periods)
        between = np.diff(np.log(ordinates)) / np.diff(np.log(periods))
        if not any(self.straight_in_period):
            return between, between
        interval = self._intervals_of(np.sqrt(periods[:-1] * periods[1:]))
        rise = (np.diff(self.values) / np.diff(self.periods))[interval]
        is_straight = np.array(self.straight_in_period)[interval]
        left = np.where(is_straight, rise * periods[:-1] / ordinates[:-1], between)
        right = np.where(is_straight, rise * periods[1:] / ordinates[1:], between)
        return np.minimum(left, right), np.maximum(left, right)


def scale_factor(motion: Motion, measured: float, wanted: float) -> float:
    """Factor [-] after which a measure of `motion` that grows with it, e.g. its peak, is `wanted`.

    Raises InputError for a motion at rest, whose measures are zero.
    """
    if measured <= 0:
        message = f"motion '{motion.name}' is at rest: every sample in its window is zero"
        raise InputError(message, "lengthen the window")
    return float(wanted / measured)


def arias_factor(motion: Motion, target: Motion) -> float:
    """Factor [-] after which `motion` has the Arias intensity of `target`: the rule of the paper's Table 1.

    Both are taken as they are: cut them to their windows first.  I_A grows with the factor squared.
    Raises InputError for a motion at rest.
    """
    return math.sqrt(scale_factor(motion, arias(motion), 1.0) / scale_factor(target, arias(target), 1.0))


def lowest_ratio(motions: Mapping[str, Motion], target: TargetSpectrum) -> tuple[float, float]:
    """Return the smallest ratio of the mean spectrum of motions to the target over its whole range [-], and the period
    at which it stands [s].

    Intervals of the periods of the fit, and of the points of the target, are halved as long as the ratio could fall
    below the smallest one known by more than RATIO_TOLERANCE, given how steep a spectrum may be (Shubert, B. O. (1972).
    A sequential method seeking the global maximum of a function. SIAM J. Numer. Anal. 9(3), 379-388); then the smallest
    is followed down between its neighbours.  An oscillator remembers 1 / (2 zeta w) seconds, so that
    |d ln Sa / d ln T| stays below 1 / (2 zeta) + 2.
    """
    from scipy.optimize import minimize_scalar

    def log_ratio(periods: np.ndarray) -> np.ndarray:
        spectra = [spectrum(motion, periods, target.damping) for motion in motions.values()]
        return np.log(np.mean(spectra, axis=0) / target.interpolate(periods))

    steepest = 0.5 / max(target.damping, MIN_SLOPE_DAMPING) + 2.0
    corners = [period for period in target.periods if target.low < period < target.high]
    periods = np.unique(np.concatenate([target.grid, corners]))
    values = log_ratio(periods)
    while True:
        width = np.diff(np.log(periods))
        lowest_slope, highest_slope = target.slope_bounds(periods)
        falls = steepest + highest_slope  # how steeply the ratio may fall from the left end, and from the right one
        falls_back = steepest - lowest_slope
        bounds = (falls_back * values[:-1] + falls * values[1:] - falls * falls_back * width) / (falls + falls_back)
        can_dip = (falls > 0) & (falls_back > 0)
        between = np.flatnonzero(can_dip & (bounds < values.min() - RATIO_TOLERANCE))
        if not between.size:
            break
        middles = np.sqrt(periods[between] * periods[between + 1])
        order = np.argsort(np.concatenate([periods, middles]))
        values = np.concatenate([values, log_ratio(middles)])[order]
        periods = np.concatenate([periods, middles])[order]
    place = int(values.argmin())
    lowest = float(values[place])
    period = float(periods[place])
    ends = np.log(periods[[max(place - 1, 0), min(place + 1, len(periods) - 1)]])
    minimum = minimize_scalar(
        lambda x: float(log_ratio(np.exp([x]))[0]), bounds=ends, method="bounded", options={"xatol": 1e-8}
    )
    if minimum.fun < lowest:
        lowest = float(minimum.fun)
        period = float(np.exp(minimum.x))
    return float(np.exp(lowest)), period


def spectrum_factors(
    motions: Mapping[str, Motion], target: TargetSpectrum, each: bool, at_least: float | None = None
) -> dict[str, float]:
    """Factors [-] by name after which the spectra of a suite meet `target` over its range of periods.

    each : every motion by a factor of its own, that of least squares in ln Sa over the range (the mean of
        ln(target / Sa) is zero: the scaling of PEER's ground motion database); else one factor for all, by
        the same rule on the arithmetic mean of their spectra
    at_least : then one more factor for all, where the mean spectrum would fall below this part of the target
        anywhere in the range (0.9 in ASCE/SEI 7-16, 16.2.3.2, and in EN 1998-1:2004, 3.2.3.1.2(4)c)

    Raises InputError for a motion at rest.
    """
    spectra = np.array([spectrum(motion, target.grid, target.damping) for motion in motions.values()])
    for motion, found in zip(motions.values(), spectra, strict=True):
        scale_factor(motion, float(found.min()), 1.0)
    fitted = spectra if each else np.broadcast_to(spectra.mean(axis=0), spectra.shape)
    factors = np.exp(np.log(target.ordinates / fitted).mean(axis=1))
    if at_least is not None:
        scaled = {name: each.scale_by(factor) for (name, each), factor in zip(motions.items(), factors, strict=True)}
        ratio, _ = lowest_ratio(scaled, target)
        factors = factors * max(1.0, at_least / ratio)
    return dict(zip(motions, map(float, factors), strict=True))


@dataclass(frozen=True)
class SpectrumMatch:
    """The spectra of the motions as used, and their target.

    at_least : part of the target that the mean spectrum may not fall below, None: it may fall to any
    words : how the motions were scaled and how near the target their mean is, in sentences
    periods : of the spectra [s], from half the range's beginning to twice its end
    spectra : pseudo-accelerations by motion [m/s2] at `periods`
    """

    target: TargetSpectrum
    at_least: float | None
    words: str
    periods: Sequence[float]
    spectra: Mapping[str, Sequence[float]]

    @classmethod
    def of(
        cls, used: Mapping[str, Motion], target: TargetSpectrum, each: bool, at_least: float | None
    ) -> SpectrumMatch:
        """The match of motions already cut and scaled; `each` and `at_least` as in `spectrum_factors`."""
        what = "every motion by a factor of its own" if each else "all motions by one factor"
        spectrum_in_words = f"the spectrum of {target.name}," if target.name else "a target spectrum"
        words = f"Scaled to {spectrum_in_words} from {target.low:g} to {target.high:g} s, {what}. "
        if at_least is not None:
            # What least squares alone would still change in the motions is the factor that `at_least` added.
            lift = 1.0 / min(spectrum_factors(used, target, each).values())
            more = f"a factor of {lift:.3f} was added for all" if lift > 1 + 1e-9 else "no further factor was needed"
            words += f"The mean spectrum is nowhere below {at_least:g} of the target: {more}. "
        ratio, period = lowest_ratio(used, target)
        words += f"In that range the mean spectrum is lowest at {period:.3g} s: {ratio:.3f} of the target."
        periods = np.geomspace(target.low / 2, 2 * target.high, 80)
        spectra = {name: spectrum(motion, periods, target.damping).tolist() for name, motion in used.items()}
        return cls(target, at_least, words, periods.tolist(), spectra)
