"""The motions of the hard scenes, made by rule: `python -m tests.hard.make_motions` writes `motions/` anew."""

from __future__ import annotations

from pathlib import Path

import numpy as np

FOLDER = Path(__file__).parent / "motions"


def noise(duration: float, dt: float, seed: int, width: float = 0.08) -> np.ndarray:
    """Smoothed noise of unit peak that begins and ends at zero; `width` is that of the smoothing window [s]."""
    count = round(duration / dt) + 1
    window = np.hanning(max(3, round(width / dt)) + 2)[1:-1]
    raw = np.random.default_rng(seed).normal(size=count + window.size - 1)
    smooth = np.convolve(raw, window, "valid") * np.sin(np.linspace(0.0, np.pi, count)) ** 0.5
    smooth[[0, -1]] = 0.0
    return smooth / np.abs(smooth).max()


def spikes(duration: float, dt: float) -> np.ndarray:
    """Silence with single samples of 1 g, up and down."""
    samples = np.zeros(round(duration / dt) + 1)
    samples[10::25] = 1.0
    samples[22::25] = -1.0
    return samples


def push(duration: float, dt: float) -> np.ndarray:
    """A push that grows to 0.1 g in one second and then stays."""
    t = np.arange(round(duration / dt) + 1) * dt
    return 0.1 * np.minimum(t, 1.0)


MOTIONS: dict[str, tuple[float, np.ndarray]] = {
    "shake": (0.01, 0.35 * noise(1.5, 0.01, 1)),
    "fine": (0.001, 0.35 * noise(0.6, 0.001, 2)),
    "coarse": (0.05, 0.35 * noise(5.0, 0.05, 3, width=0.2)),
    "long": (0.05, 0.2 * noise(300.0, 0.05, 4, width=0.3)),
    "spikes": (0.01, spikes(1.0, 0.01)),
    "push": (0.05, push(6.0, 0.05)),
    "zero": (0.02, np.zeros(51)),
}
"""Name to time step [s] and acceleration [g]."""

PUSHED = ("long", "push")
"""Motions of which the ground drifts away, or is pushed one way, and is meant to."""


def text_of(name: str) -> str:
    """The file of one motion: header and one value a line."""
    dt, samples = MOTIONS[name]
    values = "\n".join(f"{x:.5g}" for x in samples)
    baseline = "# baseline: kept\n" if name in PUSHED else ""
    return f"# name: {name}\n# dt: {dt:g} s\n# unit: g\n{baseline}{values}\n"


if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    for motion in MOTIONS:
        (FOLDER / f"{motion}.txt").write_text(text_of(motion), encoding="utf-8")
