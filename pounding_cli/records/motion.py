"""A ground motion, and its measures: Arias, Husid, significant duration, peak velocity, response spectra.

The acceleration is a straight line between evenly spaced samples, so every integral here is exact: velocity is
piecewise quadratic, displacement piecewise cubic, the cumulative Arias intensity piecewise cubic too.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pounding_cli.units import GRAVITY

SPECTRUM_DAMPING = 0.05
"""Damping ratio of every spectrum by default [-]."""

_STEPS_A_PERIOD = 50
# At 50 points a period the cubic through displacement and velocity misses a peak by (pi / 25)^4 / 384 < 1e-6.


@dataclass(frozen=True, eq=False)
class Motion:
    """Ground acceleration as a straight line between samples; the first sample is at t = 0.

    Parameters
    ----------
    name : what tables and figures call it
    dt : time step [s], > 0
    acceleration : samples [m/s2], shape (n,), n >= 2, finite
    source : label: "real", "stand-in", "user", "sine", or the set that the motion is of ("FEMA P695
        far-field set, ...")
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

    def scale_by(self, factor: float) -> Motion:
        """The same motion times `factor` [-]."""
        return Motion(self.name, self.dt, self.acceleration * factor, self.source)

    def cut_to(self, duration: float) -> Motion:
        """The first `duration` [s], cut after a sample; a shorter motion is returned whole.

        The cut keeps the time step: the last sample kept is the last one not after `duration`.
        """
        keep = int(np.floor(duration / self.dt + 1e-9)) + 1
        if keep >= self.acceleration.size:
            return self
        return Motion(self.name, self.dt, self.acceleration[: max(keep, 2)], self.source)


def cumulative_arias(motion: Motion) -> np.ndarray:
    """Arias intensity up to each sample [m/s], shape (n,), exact for the straight line between samples.

    I_A(t) = pi / (2 g) * integral of a^2 (Arias, 1970, in Seismic Design for Nuclear Power
    Plants, MIT Press).
    """
    a = motion.acceleration
    steps = motion.dt / 3.0 * (a[:-1] ** 2 + a[:-1] * a[1:] + a[1:] ** 2)
    return np.concatenate(([0.0], np.pi / (2.0 * GRAVITY) * np.cumsum(steps)))


def arias(motion: Motion) -> float:
    """Arias intensity of the whole motion [m/s]; the exact integral of the straight line squared."""
    return float(cumulative_arias(motion)[-1])


def husid(motion: Motion) -> np.ndarray:
    """Cumulative Arias intensity over its final value [-], shape (n,) (Husid, 1969), of a motion that moves."""
    total = cumulative_arias(motion)
    return total / total[-1]


def significant_duration(motion: Motion) -> tuple[float, float]:
    """Begin and end [s] of D5-95, in which the Arias intensity grows from 5 to 95 % of its final value; straight lines
    between samples (Trifunac and Brady, 1975, Bull. Seism. Soc. Am. 65(3), 581-626)."""
    first, last = np.interp((0.05, 0.95), husid(motion), motion.dt * np.arange(motion.acceleration.size))
    return float(first), float(last)


def velocity(motion: Motion) -> np.ndarray:
    """Ground velocity at the samples [m/s], shape (n,), from rest; exact, no baseline correction."""
    a = motion.acceleration
    return np.concatenate(([0.0], np.cumsum(motion.dt / 2.0 * (a[:-1] + a[1:]))))


def displacement(motion: Motion) -> np.ndarray:
    """Ground displacement at the samples [m], shape (n,), from rest; exact, no baseline correction."""
    a = motion.acceleration
    v = velocity(motion)
    h = motion.dt
    return np.concatenate(([0.0], np.cumsum(h * v[:-1] + h**2 / 6.0 * (2.0 * a[:-1] + a[1:]))))


def pgv(motion: Motion) -> float:
    """Peak ground velocity [m/s], exact: also between samples, where the straight line crosses zero."""
    a = motion.acceleration
    v = velocity(motion)
    peak = float(np.abs(v).max())
    crossing = np.flatnonzero(a[:-1] * a[1:] < 0)
    if crossing.size:
        first = a[crossing]
        last = a[crossing + 1]
        inside = v[crossing] + 0.5 * motion.dt * first**2 / (first - last)
        peak = max(peak, float(np.abs(inside).max()))
    return peak


def oscillator(
    motion: Motion, period: float, damping: float = SPECTRUM_DAMPING, parts: int = 1
) -> tuple[np.ndarray, np.ndarray]:
    """Relative displacement [m] and velocity [m/s] of a damped oscillator, exact at 1/`parts` of a step.

    u'' + 2 zeta w u' + w^2 u = -a from rest, in the complex form z' = lambda z - a with
    z = u' - conj(lambda) u, lambda = -zeta w + i w sqrt(1 - zeta^2); a is linear in the step, so
    the recursion is exact (Nigam and Jennings, 1969, Bull. Seism. Soc. Am. 59(2), 909-922).
    Shapes (parts * (n - 1) + 1,).
    Raises ValueError for a period that is not positive or a damping ratio outside [0, 1).
    """
    from scipy.signal import lfilter

    if not period > 0 or not 0 <= damping < 1:
        raise ValueError("an oscillator needs a positive period and a damping ratio in [0, 1)")
    omega = 2.0 * np.pi / period
    root = omega * complex(-damping, np.sqrt(1.0 - damping**2))
    a = motion.acceleration
    if parts > 1:
        a = np.interp(np.arange(parts * (a.size - 1) + 1) / parts, np.arange(a.size), a)
    h = motion.dt / parts
    phi1 = np.expm1(root * h) / (root * h)
    phi2 = (phi1 - 1.0) / (root * h)
    drive = h * ((phi1 - phi2) * a[:-1] + phi2 * a[1:])
    z = np.concatenate(([0.0], lfilter([-1.0], [1.0, -np.exp(root * h)], drive)))
    u = z.imag / root.imag
    return u, z.real + root.real * u


def spectrum(motion: Motion, periods: Sequence[float] | np.ndarray, damping: float = SPECTRUM_DAMPING) -> np.ndarray:
    """Pseudo-acceleration response spectrum w^2 max|u| [m/s2] at `periods` [s], shape (len,).

    Exact for the straight line between samples: see `oscillator`; peaks between points come from the cubic
    through displacement and velocity (relative error below 1e-6).  Lasts as long as the motion does,
    without the free vibration after it.
    """
    omega = 2.0 * np.pi / np.asarray(periods, dtype=float)
    return omega**2 * np.array([_peak_displacement(motion, float(period), damping) for period in periods])


def _peak_displacement(motion: Motion, period: float, damping: float) -> float:
    from scipy.interpolate import CubicHermiteSpline

    parts = max(1, int(np.ceil(_STEPS_A_PERIOD * motion.dt / period)))
    u, v = oscillator(motion, period, damping, parts)
    path = CubicHermiteSpline(motion.dt / parts * np.arange(u.size), u, v)
    turns = path.derivative().roots(extrapolate=False)
    return float(np.nanmax(np.abs(np.append(u, path(turns)))))  # NaN where it rests
