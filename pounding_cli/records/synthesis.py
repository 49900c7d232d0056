"""Stand-ins: synthetic motions with the peak, energy, energy growth and response spectrum of a target.

Random phases under an envelope (from the target's Husid curve) are brought to the target spectrum first in the
frequency domain, then in the time domain by Newton steps of least norm on all targets together.  The step of
Lilhanand and Tseng (1988, Proc. 9th World Conf. Earthquake Eng., II-819), whose adjustments are time-reversed
oscillator responses, and of Al Atik and Abrahamson (2010, Earthquake Spectra 26(3), 601-617) is the same idea.
"""

from __future__ import annotations

import random
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from pounding_cli.records.intensity import cumulative_arias, oscillator, spectrum, velocity
from pounding_cli.records.motion import GRAVITY, Motion

_FOURIER_ROUNDS = 12
_NEWTON_ROUNDS = 20
_POINTS_A_PERIOD = 40
_EXTREMA_KEPT = 0.985
# Extrema closer than this to the target are held as well, so that pushing one peak down lets no other one pass it.
_SMOOTH = 1.2
# Width [samples] of the correlation of an adjustment in time: keeps single-sample spikes out.


@dataclass(frozen=True)
class Target:
    """What a stand-in has to match, all within its own duration.

    Parameters
    ----------
    name : of the motion
    seed : of the random phases
    dt, duration : time step and length [s]
    pga : peak ground acceleration [m/s2]
    arias : Arias intensity [m/s]
    husid_fractions, husid_times : points of the Husid curve [-], [s], rising, within (0, 1) and (0, duration)
    periods, spectrum : [s], 5 % damped pseudo-acceleration [m/s2], periods rising
    pgv : peak ground velocity [m/s], or None to leave it free
    """

    name: str
    seed: int
    dt: float
    duration: float
    pga: float
    arias: float
    husid_fractions: tuple[float, ...]
    husid_times: tuple[float, ...]
    periods: tuple[float, ...]
    spectrum: tuple[float, ...]
    pgv: float | None = None


def synthesize(target: Target) -> Motion:
    """A motion, labelled "stand-in", that meets `target`; the same target gives the same motion.

    Of all Newton rounds the one whose worst relative miss is smallest is kept.  It starts and ends at rest:
    ground velocity and displacement are zero at both ends.
    """
    envelope = _envelope(target)
    samples = _fourier_match(target, envelope, _noise(target.seed, envelope.size))
    best, least = samples, np.inf
    covariance = _covariance(envelope)
    for _ in range(_NEWTON_ROUNDS):
        rows, miss, worst = _linearise(target, samples)
        if worst < least:
            best, least = samples, worst
        spread = covariance @ rows.T
        normal = rows @ spread
        # The little added to the diagonal keeps near-parallel rows (neighbouring periods) from fighting.
        normal[np.diag_indices_from(normal)] *= 1.0 + 1e-3
        samples = samples + 0.7 * (spread @ np.linalg.solve(normal, miss))
    return Motion(target.name, target.dt, best, "stand-in")


def with_seed(target: Target, seed: int) -> Target:
    """The same target with other random phases."""
    return replace(target, seed=seed)


def _noise(seed: int, size: int) -> np.ndarray:
    """White noise of unit variance from uniform random phases; Python's generator is the same on every machine."""
    draw = random.Random(seed)
    phases = np.array([draw.random() for _ in range(size // 2 + 1)]) * 2.0 * np.pi
    noise = np.fft.irfft(np.exp(1j * phases), size)
    return noise / noise.std()


def _envelope(target: Target) -> np.ndarray:
    """Square root of the slope of the smoothed target Husid curve at the samples, unit mean square; shape (n,)."""
    from scipy.interpolate import PchipInterpolator

    n = round(target.duration / target.dt) + 1
    t = target.dt * np.arange(n)
    times = np.concatenate(([0.0], target.husid_times, [target.duration]))
    fractions = np.concatenate(([0.0], target.husid_fractions, [1.0]))
    slope = np.maximum(PchipInterpolator(times, fractions).derivative()(t), 0.0)
    envelope = np.sqrt(slope + 0.002 * slope.max())
    return envelope / np.sqrt(np.mean(envelope**2))


def _covariance(envelope: np.ndarray) -> np.ndarray:
    """Where adjustments may go: as large as the envelope, smooth over a few samples; shape (n, n)."""
    index = np.arange(envelope.size)
    near = np.exp(-(((index[:, None] - index[None, :]) / _SMOOTH) ** 2) / 2.0)
    return envelope[:, None] * near * envelope[None, :]


def _fourier_match(target: Target, envelope: np.ndarray, noise: np.ndarray) -> np.ndarray:
    """Noise under the envelope, its Fourier amplitudes turned towards the target spectrum; shape (n,)."""
    frequency = np.fft.rfftfreq(noise.size, target.dt)
    own = 1.0 / np.asarray(target.periods)[::-1]
    wanted = np.asarray(target.spectrum)
    gain = frequency**2 / (frequency**2 + (0.5 * own[0]) ** 2)
    shape = np.fft.rfft(noise) * gain
    samples = envelope * np.fft.irfft(shape, noise.size)
    for _ in range(_FOURIER_ROUNDS):
        found = spectrum(Motion(target.name, target.dt, samples), target.periods)
        shape = shape * np.interp(frequency, own, (wanted / found)[::-1])
        samples = envelope * np.fft.irfft(shape, noise.size)
    return samples


def _linearise(target: Target, samples: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
    """Rows d(quantity)/d(samples), what each quantity lacks, and the worst relative miss.

    Every row is divided by the size of its quantity, so that the misses are relative; shapes (m, n), (m,), scalar.
    """
    motion = Motion(target.name, target.dt, samples)
    rows: list[np.ndarray] = []
    miss: list[float] = []
    worst = 0.0
    for period, wanted in zip(target.periods, target.spectrum, strict=True):
        omega2 = (2.0 * np.pi / period) ** 2
        parts = max(1, int(np.ceil(_POINTS_A_PERIOD * target.dt / period)))
        u, _ = oscillator(motion, period, parts=parts)
        response = u * (omega2 / wanted)
        pulse = _hat_response(target.dt, samples.size, period, parts) * (omega2 / wanted)
        for k in _extrema(response):
            # Sample j stands parts * j points in; its hat's response starts one sample earlier.
            back = k - parts * (np.arange(samples.size) - 1)
            rows.append(np.where(back >= 0, pulse[np.clip(back, 0, pulse.size - 1)], 0.0))
            miss.append(float(np.sign(response[k]) - response[k]))
        worst = max(worst, abs(float(np.abs(response).max()) - 1.0))
    for k in _extrema(samples / target.pga):
        rows.append(np.eye(1, samples.size, k)[0] / target.pga)
        miss.append(float(np.sign(samples[k]) - samples[k] / target.pga))
    worst = max(worst, 5.0 * abs(motion.pga / target.pga - 1.0))
    energy_rows, energy_miss = _energy(target, motion)
    rows += energy_rows
    miss += energy_miss
    worst = max(worst, 10.0 * abs(energy_miss[-1]))
    h, n = target.dt, samples.size
    weights = np.full(n, h)
    weights[[0, -1]] = h / 2.0
    v = velocity(motion)
    if target.pgv is not None:
        for k in _extrema(v / target.pgv):
            rows.append(np.where(np.arange(n) <= k, weights, 0.0) / target.pgv)
            miss.append(float(np.sign(v[k]) - v[k] / target.pgv))
    unit = target.pgv or target.pga * 0.1
    lag = target.duration - h * np.arange(n)
    moment = weights * lag
    for row, scale in ((weights, unit), (moment, unit * target.duration / 4.0)):
        rows.append(row / scale)
        miss.append(float(-row @ samples / scale))
    return np.array(rows), np.array(miss), worst


def _energy(target: Target, motion: Motion) -> tuple[list[np.ndarray], list[float]]:
    """Rows and misses of the cumulative Arias intensity at the target's Husid points, the total last."""
    a, total = motion.acceleration, cumulative_arias(motion)
    factor = np.pi / (2.0 * GRAVITY) * target.dt / 3.0 / target.arias
    steps_left = np.concatenate((2.0 * a[:-1] + a[1:], [0.0])) * factor
    steps_right = np.concatenate(([0.0], a[:-1] + 2.0 * a[1:])) * factor
    rows, miss = [], []
    for fraction, time in zip(
        (*target.husid_fractions, 1.0), (*target.husid_times, target.duration), strict=True
    ):
        k = min(round(time / target.dt), a.size - 1)
        index = np.arange(a.size)
        rows.append(np.where(index < k, steps_left, 0.0) + np.where(index <= k, steps_right, 0.0))
        miss.append(float(fraction - total[k] / target.arias))
    return rows, miss


def _hat_response(dt: float, size: int, period: float, parts: int) -> np.ndarray:
    """Oscillator displacement after one unit sample (a hat two steps wide, its foot at point 0)."""
    hat = np.zeros(size + 1)
    hat[1] = 1.0
    return oscillator(Motion("hat", dt, hat), period, parts=parts)[0]


def _extrema(ratio: np.ndarray) -> Iterable[int]:
    """Where |ratio| is largest, and every other local extremum near or above 1."""
    size = np.abs(ratio)
    inner = (size[1:-1] >= size[:-2]) & (size[1:-1] > size[2:]) & (size[1:-1] > _EXTREMA_KEPT)
    return sorted({int(np.argmax(size)), *(np.flatnonzero(inner) + 1).tolist()})
