"""A ground motion: evenly spaced acceleration samples joined by straight lines."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pounding_cli.units import GRAVITY as GRAVITY  # others take it from here


@dataclass(frozen=True, eq=False)
class Motion:
    """Ground acceleration as a straight line between samples; the first sample is at t = 0.

    Parameters
    ----------
    name : what tables and figures call it
    dt : time step [s], > 0
    acceleration : samples [m/s2], shape (n,), n >= 2, finite
    source : label, one of "real", "stand-in", "user"; of a file whose unit is assumed "user, unit g assumed"
    """

    name: str
    dt: float
    acceleration: np.ndarray
    source: str = "user"

    def __post_init__(self) -> None:
        samples = np.array(self.acceleration, dtype=float)
        if samples.ndim != 1 or samples.size < 2:
            raise ValueError("a motion needs a one-dimensional array of at least two samples")
        if not np.isfinite(samples).all() or not (np.isfinite(self.dt) and self.dt > 0):
            raise ValueError("a motion needs finite samples and a positive time step")
        samples.setflags(write=False)
        object.__setattr__(self, "acceleration", samples)

    def __repr__(self) -> str:
        every = f"{self.duration:.4g} s every {1000 * self.dt:.4g} ms"
        return f"Motion({self.name!r}, {every}, peak {self.pga:.4g} m/s2, {self.source})"

    @property
    def duration(self) -> float:
        """Time of the last sample [s]."""
        return self.dt * (self.acceleration.size - 1)

    @cached_property
    def pga(self) -> float:
        """Peak ground acceleration [m/s2]."""
        return float(np.abs(self.acceleration).max())

    @cached_property
    def digest(self) -> str:
        """SHA-256 over time step and samples: two motions with one digest are the same motion."""
        return hashlib.sha256(np.float64(self.dt).tobytes() + self.acceleration.tobytes()).hexdigest()

    def scaled(self, factor: float) -> Motion:
        """The same motion times `factor` [-]."""
        return Motion(self.name, self.dt, self.acceleration * factor, self.source)

    def windowed(self, duration: float) -> Motion:
        """The first `duration` [s], cut after a sample; a shorter motion is returned whole.

        The cut keeps the time step: the last sample kept is the last one not after `duration`.
        """
        keep = int(np.floor(duration / self.dt + 1e-9)) + 1
        if keep >= self.acceleration.size:
            return self
        return Motion(self.name, self.dt, self.acceleration[: max(keep, 2)], self.source)
