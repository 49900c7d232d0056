"""Scale factors that bring a motion, or a suite of motions, to a wanted intensity."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from pounding_cli.errors import InputError, Problem
from pounding_cli.records.intensity import SPECTRUM_DAMPING, arias, pgv, spectrum
from pounding_cli.records.motion import Motion

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

    def __post_init__(self) -> None:
        if len(self.periods) != len(self.values) or not self.periods:
            raise ValueError("a target spectrum needs as many values as periods")
        if any(b <= a for a, b in zip(self.periods, self.periods[1:], strict=False)) or min(self.periods) <= 0:
            raise ValueError("the periods of a target spectrum rise from above zero")
        if not self.periods[0] <= self.low < self.high <= self.periods[-1]:
            raise ValueError("the range lies within the target's periods")

    @classmethod
    def of(cls, motion: Motion, low: float, high: float, damping: float = SPECTRUM_DAMPING) -> TargetSpectrum:
        """The spectrum of a motion itself, exact at every period of `grid`.  Raises InputError for one at rest."""
        grid = _grid(low, high)
        values = spectrum(motion, grid, damping)
        _measured(motion, float(values.min()))
        return cls(tuple(map(float, grid)), tuple(map(float, values)), low, high, damping)

    @property
    def grid(self) -> np.ndarray:
        """The periods at which it is met [s], shape (POINTS,)."""
        return _grid(self.low, self.high)

    @property
    def ordinates(self) -> np.ndarray:
        """Its values at `grid` [m/s2]."""
        return np.exp(np.interp(np.log(self.grid), np.log(self.periods), np.log(self.values)))


def arias_factor(motion: Motion, target: Motion | float) -> float:
    """Factor [-] after which `motion` has the Arias intensity of `target` (a motion, or a value in m/s).

    Both are taken as they are: cut them to their windows first.  I_A grows with the factor squared.  The rule
    behind the last column of the paper's Table 1.  Raises InputError for a motion at rest or a target <= 0.
    """
    wanted = arias(target) if isinstance(target, Motion) else float(target)
    return math.sqrt(_positive(wanted, "Arias intensity to reach", "m/s") / _measured(motion, arias(motion)))


def pga_factor(motion: Motion, pga: float) -> float:
    """Factor [-] after which the peak ground acceleration is `pga` [m/s2].

    Raises InputError for a motion at rest or a peak that is not positive.
    """
    return _positive(pga, "peak ground acceleration to reach", "m/s2") / _measured(motion, motion.pga)


def pgv_factor(motion: Motion, velocity: float) -> float:
    """Factor [-] after which the peak ground velocity is `velocity` [m/s]; no baseline correction.

    Raises InputError for a motion at rest or a peak that is not positive.
    """
    return _positive(velocity, "peak ground velocity to reach", "m/s") / _measured(motion, pgv(motion))


def sa_factor(motion: Motion, sa: float, period: float, damping: float = SPECTRUM_DAMPING) -> float:
    """Factor [-] after which the pseudo-acceleration at `period` [s] and `damping` [-] is `sa` [m/s2].

    Raises InputError for a motion at rest or an ordinate that is not positive.
    """
    found = float(spectrum(motion, (period,), damping)[0])
    return _positive(sa, "spectral acceleration to reach", "m/s2") / _measured(motion, found)


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
    wanted = target.ordinates
    spectra = {name: spectrum(motion, target.grid, target.damping) for name, motion in motions.items()}
    for name, found in spectra.items():
        _measured(motions[name], float(found.min()))
    if each:
        factors = {name: _least_squares(wanted, found) for name, found in spectra.items()}
    else:
        factors = dict.fromkeys(spectra, _least_squares(wanted, _mean(list(spectra.values()))))
    if at_least is not None:
        mean = _mean([factors[name] * found for name, found in spectra.items()])
        lift = max(1.0, float((at_least * wanted / mean).max()))
        factors = {name: lift * factor for name, factor in factors.items()}
    return factors


def _grid(low: float, high: float) -> np.ndarray:
    return np.geomspace(low, high, POINTS)


def _least_squares(wanted: np.ndarray, found: np.ndarray) -> float:
    return float(np.exp(np.mean(np.log(wanted / found))))


def _mean(spectra: Sequence[np.ndarray]) -> np.ndarray:
    return np.mean(np.array(spectra), axis=0)


def _positive(value: float, what: str, unit: str) -> float:
    if not (math.isfinite(value) and value > 0):
        raise InputError(Problem(f"the {what} is {value:g} {unit}", "give a value above 0"))
    return value


def _measured(motion: Motion, value: float) -> float:
    if value <= 0:
        raise InputError(
            Problem(
                f"motion '{motion.name}' is at rest: every sample in its window is zero",
                "lengthen the window",
            )
        )
    return value
