"""How well a suite of motions, as it is used, meets the target spectrum it was scaled to."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import cached_property
from typing import Any

import numpy as np

from pounding_cli.records.intensity import spectrum
from pounding_cli.records.motion import Motion
from pounding_cli.records.scaling import TargetSpectrum, spectrum_factors

DRAWN = 80
"""Periods of the spectra, evenly in ln T, from half the range's beginning to twice its end."""


@dataclass(frozen=True)
class SpectrumMatch:
    """The spectra of the motions as used, and their target.

    each : whether every motion has a factor of its own; at_least : part of the target the mean may not fall below
    lift : the factor that `at_least` added for all [-]
    lowest : the mean spectrum over the target where that is least in the range [-], and the period there [s]
    periods : [s]; spectra : pseudo-accelerations by motion [m/s2] at `periods`
    """

    target: TargetSpectrum
    each: bool
    at_least: float | None
    lift: float
    lowest: tuple[float, float]
    periods: tuple[float, ...]
    spectra: Mapping[str, tuple[float, ...]]

    @cached_property
    def mean(self) -> np.ndarray:
        """The mean of the spectra [m/s2] at `periods`."""
        return np.mean(np.array(list(self.spectra.values())), axis=0)

    @property
    def words(self) -> str:
        """How the motions were scaled and how near the target their mean is, in sentences."""
        what = "every motion by a factor of its own" if self.each else "all motions by one factor"
        said = f"Scaled to a target spectrum from {self.target.low:g} to {self.target.high:g} s, {what}. "
        if self.at_least is not None:
            more = f"a factor of {self.lift:.3f} was added for all" if self.lift > 1 else "no further factor was needed"
            said += f"The mean spectrum is nowhere below {self.at_least:g} of the target: {more}. "
        ratio, period = self.lowest
        return f"{said}The mean spectrum is lowest at {period:.2f} s: {ratio:.2f} of the target."

    def as_dict(self) -> dict[str, Any]:
        """Plain numbers and texts, for a file."""
        return asdict(self)

    @classmethod
    def of_dict(cls, data: Mapping[str, Any]) -> SpectrumMatch:
        """What `as_dict` gave, read back."""
        points = {name: tuple(data["target"][name]) for name in ("periods", "values")}
        target = TargetSpectrum(**{**data["target"], **points})
        spectra = {name: tuple(values) for name, values in data["spectra"].items()}
        tuples = {"lowest": tuple(data["lowest"]), "periods": tuple(data["periods"]), "spectra": spectra}
        return cls(**{**data, **tuples, "target": target})


def spectrum_match(
    used: Mapping[str, Motion], target: TargetSpectrum, each: bool, at_least: float | None
) -> SpectrumMatch:
    """The match of motions already cut and scaled; `each` and `at_least` as in `spectrum_factors`."""
    # What least squares alone would still change in the motions is the factor that `at_least` added.
    lift = 1.0 if at_least is None else 1.0 / min(spectrum_factors(used, target, each).values())
    inside = np.mean([spectrum(motion, target.grid, target.damping) for motion in used.values()], axis=0)
    ratios = inside / target.ordinates
    least = int(np.argmin(ratios))
    periods = np.geomspace(target.low / 2, 2 * target.high, DRAWN)
    spectra = {name: tuple(map(float, spectrum(m, periods, target.damping))) for name, m in used.items()}
    lowest = (float(ratios[least]), float(target.grid[least]))
    return SpectrumMatch(
        target, each, at_least, lift if lift > 1 + 1e-9 else 1.0, lowest, tuple(map(float, periods)), spectra
    )
