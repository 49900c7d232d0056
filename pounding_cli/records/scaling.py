"""Scale factors that bring a motion, or a suite of motions, to a wanted intensity, and how well a suite then fits."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pounding_cli.errors import InputError, Problem
from pounding_cli.records.motion import SPECTRUM_DAMPING, Motion, arias, spectrum

POINTS = 50
"""Periods a target spectrum is met at: so many, evenly in ln T over the range."""


@dataclass(frozen=True)
class TargetSpectrum:
    """A spectrum to be met over a range of periods.

    periods, values : its points [s], [m/s2], straight lines between them in ln T and ln Sa
    low, high : the range [s]; damping : ratio [-]
    """

    periods: tuple[float, ...]
    values: tuple[float, ...]
    low: float
    high: float
    damping: float = SPECTRUM_DAMPING

    @classmethod
    def of(cls, motion: Motion, low: float, high: float, damping: float = SPECTRUM_DAMPING) -> TargetSpectrum:
        """The spectrum of a motion itself, exact at every period of `grid`.  Raises InputError for one at rest."""
        grid = np.geomspace(low, high, POINTS)
        values = spectrum(motion, grid, damping)
        scale_factor(motion, float(values.min()), 1.0)
        return cls(tuple(map(float, grid)), tuple(map(float, values)), low, high, damping)

    @cached_property
    def grid(self) -> np.ndarray:
        """The periods at which it is met [s], shape (POINTS,)."""
        return np.geomspace(self.low, self.high, POINTS)

    @property
    def ordinates(self) -> np.ndarray:
        """Its values at `grid` [m/s2]."""
        return np.exp(np.interp(np.log(self.grid), np.log(self.periods), np.log(self.values)))


def scale_factor(motion: Motion, measured: float, wanted: float) -> float:
    """Factor [-] after which a measure of `motion` that grows with it, e.g. its peak, is `wanted`.

    Raises InputError for a motion at rest, whose measures are zero.
    """
    if measured <= 0:
        message = f"motion '{motion.name}' is at rest: every sample in its window is zero"
        raise InputError(Problem(message, "lengthen the window"))
    return float(wanted / measured)


def arias_factor(motion: Motion, target: Motion) -> float:
    """Factor [-] after which `motion` has the Arias intensity of `target`: the rule of the paper's Table 1.

    Both are taken as they are: cut them to their windows first.  I_A grows with the factor squared.
    Raises InputError for a motion at rest.
    """
    return math.sqrt(scale_factor(motion, arias(motion), 1.0) / scale_factor(target, arias(target), 1.0))


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
        mean = (factors[:, None] * spectra).mean(axis=0)
        factors = factors * max(1.0, float((at_least * target.ordinates / mean).max()))
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
        words = f"Scaled to a target spectrum from {target.low:g} to {target.high:g} s, {what}. "
        if at_least is not None:
            # What least squares alone would still change in the motions is the factor that `at_least` added.
            lift = 1.0 / min(spectrum_factors(used, target, each).values())
            more = f"a factor of {lift:.3f} was added for all" if lift > 1 + 1e-9 else "no further factor was needed"
            words += f"The mean spectrum is nowhere below {at_least:g} of the target: {more}. "
        mean = np.mean([spectrum(motion, target.grid, target.damping) for motion in used.values()], axis=0)
        least = np.argmin(mean / target.ordinates)
        ratio, period = (mean / target.ordinates)[least], target.grid[least]
        words += f"The mean spectrum is lowest at {period:.2f} s: {ratio:.2f} of the target."
        periods = np.geomspace(target.low / 2, 2 * target.high, 80)
        spectra = {name: spectrum(motion, periods, target.damping).tolist() for name, motion in used.items()}
        return cls(target, at_least, words, periods.tolist(), spectra)
