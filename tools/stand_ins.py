"""Makes the stand-ins that ship: synthetic motions with the measures that `records/catalogue.yaml` states.

    python tools/stand_ins.py -o standins                  the five files of the program, equal in every printed digit
    python tools/stand_ins.py taft --seed 7 -o other       other random phases

A stand-in has the peak, energy, energy growth and response spectrum of its target, within Table 1's duration. Random
phases under an envelope (from the target's Husid curve) are brought to the target spectrum first in
the frequency domain, then in the time domain by Levenberg-Marquardt steps of least norm on all targets
together.  Their adjustments are combinations of time-reversed oscillator responses, as in Lilhanand and Tseng
(1988, Proc. 9th World Conf. Earthquake Eng.); see also Al Atik and Abrahamson (2010, Earthquake Spectra 26(3),
601-617).
"""

from __future__ import annotations

import argparse
import random
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from pounding_cli.records.motion import Motion, arias, cumulative_arias, oscillator, spectrum, velocity
from pounding_cli.units import GRAVITY

CATALOGUE = Path(__file__).parents[1] / "records" / "catalogue.yaml"
DIGITS = 6
"""Decimals of g in a shipped file; rounding moves a sample by at most 5e-7 g."""

_FOURIER_ROUNDS = 12
_NEWTON_ROUNDS = 150
_POINTS_A_PERIOD = 40
_EXTREMA_KEPT = 0.95
_GOOD_ENOUGH = 1e-2
_STALLED = 1e3
_WEIGHT = 3.0
# Extrema this close to the target are held as well: pushing one peak down lets no other one pass it.
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

    It starts and ends at rest: ground velocity and displacement are zero at both ends.
    """
    envelope = _envelope(target)
    samples = _fourier_match(target, envelope, _noise(target.seed, envelope.size))
    pulses = _pulses(target, envelope.size)
    damping, state = 0.1, _linearise(target, samples, pulses)
    for _ in range(_NEWTON_ROUNDS):
        rows, miss = state
        if np.abs(miss).max() < _GOOD_ENOUGH:
            break
        spread = _colour(rows, envelope)
        normal = spread @ spread.T
        normal[np.diag_indices_from(normal)] += damping * np.mean(np.diag(normal))
        step = _colour(spread.T @ np.linalg.solve(normal, miss), envelope, back=True)
        tried = _linearise(target, samples + step, pulses)
        # Levenberg and Marquardt: a step that helps is taken and the next one goes further, else it is cut.
        if tried[1] @ tried[1] < miss @ miss:
            samples, state, damping = samples + step, tried, max(damping / 2.0, 1e-6)
        else:
            damping *= 4.0
        if damping > _STALLED:
            break
    return Motion(target.name, target.dt, samples, "stand-in")


def _noise(seed: int, size: int) -> np.ndarray:
    """White noise of unit variance from random phases; Python's generator is the same on every machine."""
    draw = random.Random(seed)
    phases = np.array([draw.random() for _ in range(size // 2 + 1)]) * 2.0 * np.pi
    noise = np.fft.irfft(np.exp(1j * phases), size)
    return noise / noise.std()


def _envelope(target: Target) -> np.ndarray:
    """Square root of the slope of the target's Husid curve at the samples, unit mean square; shape (n,)."""
    from scipy.interpolate import PchipInterpolator

    n = round(target.duration / target.dt) + 1
    t = target.dt * np.arange(n)
    times = np.concatenate(([0.0], target.husid_times, [target.duration]))
    fractions = np.concatenate(([0.0], target.husid_fractions, [1.0]))
    slope = np.maximum(PchipInterpolator(times, fractions).derivative()(t), 0.0)
    # From rest over the first tenth of a second, so that the first sample is no jump.
    start = np.sin(np.pi / 2.0 * np.minimum(t / 0.1, 1.0)) ** 2
    envelope = start * np.sqrt(slope + 0.002 * slope.max())
    return envelope / np.sqrt(np.mean(envelope**2))


def _colour(rows: np.ndarray, envelope: np.ndarray, back: bool = False) -> np.ndarray:
    """Square root of the covariance of adjustments, as large as the envelope and smooth over a few samples.

    `back` applies its transpose.  Shapes (..., n).
    """
    from scipy.ndimage import gaussian_filter1d

    if back:
        return envelope * gaussian_filter1d(rows, _SMOOTH, axis=-1, mode="constant")
    return gaussian_filter1d(rows * envelope, _SMOOTH, axis=-1, mode="constant")


def _fourier_match(target: Target, envelope: np.ndarray, noise: np.ndarray) -> np.ndarray:
    """Noise under the envelope, its Fourier amplitudes turned towards the target spectrum; shape (n,)."""
    frequency = np.fft.rfftfreq(noise.size, target.dt)
    own = 1.0 / np.asarray(target.periods)[::-1]
    wanted = np.asarray(target.spectrum)
    gain = frequency**4 / (frequency**4 + (0.5 * own[0]) ** 4)
    shape = np.fft.rfft(noise) * gain
    samples = envelope * np.fft.irfft(shape, noise.size)
    for _ in range(_FOURIER_ROUNDS):
        found = spectrum(Motion(target.name, target.dt, samples), target.periods)
        shape = shape * np.interp(frequency, own, (wanted / found)[::-1])
        samples = envelope * np.fft.irfft(shape, noise.size)
    return samples


def _linearise(
    target: Target, samples: np.ndarray, pulses: list[tuple[int, np.ndarray]]
) -> tuple[np.ndarray, np.ndarray]:
    """Rows d(quantity)/d(samples) and what each quantity lacks, both over its target; (m, n), (m,)."""
    motion = Motion(target.name, target.dt, samples)
    rows: list[np.ndarray] = []
    miss: list[float] = []
    index = np.arange(samples.size)
    for period, wanted, (parts, pulse) in zip(target.periods, target.spectrum, pulses, strict=True):
        response = oscillator(motion, period, parts=parts)[0] * ((2.0 * np.pi / period) ** 2 / wanted)
        for k in _extrema(response):
            # Sample j stands parts * j points in; its hat's response starts one sample earlier.
            back = k - parts * (index - 1)
            rows.append(np.where(back >= 0, pulse[np.clip(back, 0, pulse.size - 1)], 0.0))
            miss.append(_lack(response, k))
    for k in _extrema(samples / target.pga):
        rows.append(_WEIGHT * (index == k) / target.pga)
        miss.append(_WEIGHT * _lack(samples / target.pga, k))
    energy_rows, energy_miss = _energy(target, motion)
    rows += energy_rows
    miss += energy_miss
    weights = np.full(samples.size, target.dt)
    weights[[0, -1]] = target.dt / 2.0
    if target.pgv is not None:
        v = velocity(motion) / target.pgv
        for k in _extrema(v):
            rows.append(np.where(index <= k, weights, 0.0) / target.pgv)
            miss.append(_lack(v, k))
    size = target.pgv or target.pga * 0.1
    rest = weights / size, weights * (target.duration - target.dt * index) / (size * target.duration / 4.0)
    rows += rest
    miss += [float(-row @ samples) for row in rest]
    return np.array(rows), np.array(miss)


def _lack(ratio: np.ndarray, k: int) -> float:
    """How far the largest value stands from +-1, or by how much a smaller one passes it."""
    size = abs(ratio[k])
    if size < 1.0 and size < np.abs(ratio).max():
        return 0.0
    return float(np.sign(ratio[k]) * (1.0 - size))


def _energy(target: Target, motion: Motion) -> tuple[list[np.ndarray], list[float]]:
    """Rows and misses of the cumulative Arias intensity at the target's Husid points, the total last."""
    a, total = motion.acceleration, cumulative_arias(motion)
    factor = np.pi / (2.0 * GRAVITY) * target.dt / 3.0 / target.arias
    steps_left = np.concatenate((2.0 * a[:-1] + a[1:], [0.0])) * factor
    steps_right = np.concatenate(([0.0], a[:-1] + 2.0 * a[1:])) * factor
    rows, miss = [], []
    for fraction, time in zip((*target.husid_fractions, 1.0), (*target.husid_times, target.duration), strict=True):
        k = min(round(time / target.dt), a.size - 1)
        index = np.arange(a.size)
        row = np.where(index < k, steps_left, 0.0) + np.where(index <= k, steps_right, 0.0)
        rows.append(_WEIGHT * row)
        miss.append(_WEIGHT * float(fraction - total[k] / target.arias))
    return rows, miss


def _pulses(target: Target, size: int) -> list[tuple[int, np.ndarray]]:
    """For every period: points a step, and the response over its target to one unit sample."""
    hat = np.zeros(size + 1)
    hat[1] = 1.0
    pulses = []
    for period, wanted in zip(target.periods, target.spectrum, strict=True):
        parts = max(1, int(np.ceil(_POINTS_A_PERIOD * target.dt / period)))
        response = oscillator(Motion("hat", target.dt, hat), period, parts=parts)[0]
        pulses.append((parts, response * ((2.0 * np.pi / period) ** 2 / wanted)))
    return pulses


def _extrema(ratio: np.ndarray) -> Iterable[int]:
    """Where |ratio| is largest, and every other local extremum near or above 1."""
    size = np.abs(ratio)
    inner = (size[1:-1] >= size[:-2]) & (size[1:-1] > size[2:]) & (size[1:-1] > _EXTREMA_KEPT)
    return sorted({int(np.argmax(size)), *(np.flatnonzero(inner) + 1).tolist()})


def target_of(name: str, told: dict[str, Any], seed: int | None = None) -> Target:
    """What the stand-in of a catalogue entry has to match: its facts, within Table 1's duration."""
    facts = told["facts"]
    return Target(
        name=name,
        seed=told["stand_in"]["seed"] if seed is None else seed,
        dt=told["stand_in"]["dt_s"],
        duration=float(told["table1"]["duration_s"]),
        pga=facts["peak_g"] * GRAVITY,
        arias=facts["arias"],
        husid_fractions=tuple(facts["husid"]),
        husid_times=tuple(facts["husid"].values()),
        periods=tuple(facts["spectrum_g"]),
        spectrum=tuple(value * GRAVITY for value in facts["spectrum_g"].values()),
        pgv=facts.get("pgv"),
    )


def text_of(motion: Motion, target: Target, told: dict[str, Any]) -> str:
    """The stand-in's file, its header saying what it is and how to make it again."""
    basis = "facts measured on the real motion" if told["facts"]["of"] == "real" else "estimated facts"
    lines = [
        f"# stand-in: STAND-IN for {told['title']}: synthetic, random phases, not a recording",
        f"# matches: {basis} in catalogue.yaml, within the first {target.duration:g} s",
        f"# made by: tools/stand_ins.py {target.name} (seed {target.seed})",
        f"# name: {motion.name}",
        "# unit: g",
        f"# dt: {motion.dt!r} s",
        f"# samples: {motion.acceleration.size}",
    ]
    return "\n".join([*lines, *(f"{value:.{DIGITS}f}" for value in motion.acceleration / GRAVITY)]) + "\n"


def main() -> None:
    catalogue = yaml.safe_load(CATALOGUE.read_text(encoding="utf-8"))["motions"]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"{', '.join(catalogue)}; all unless given")
    parser.add_argument("--seed", type=int, help="seed of the random phases; those of the program unless given")
    parser.add_argument("-o", "--output", type=Path, default=Path(), help="folder for NAME.txt")
    options = parser.parse_args()
    if unknown := set(options.names) - set(catalogue):
        parser.error(f"not in the catalogue: {', '.join(sorted(unknown))}")
    options.output.mkdir(parents=True, exist_ok=True)
    for name in options.names or catalogue:
        target = target_of(name, catalogue[name], options.seed)
        motion = synthesize(target)
        path = options.output / f"{name}.txt"
        path.write_text(text_of(motion, target, catalogue[name]), encoding="utf-8")
        print(
            f"{path}: seed {target.seed}, peak {motion.pga / GRAVITY:.3f} g (aim {target.pga / GRAVITY:.3f}), "
            f"Arias {arias(motion):.3f} m/s (aim {target.arias:.3f})"
        )


if __name__ == "__main__":
    main()
