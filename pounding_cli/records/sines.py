"""Sinusoidal ground motions, as shaking tables make them and studies of resonance use them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pounding_cli.records.motion import Motion

SAMPLES_A_CYCLE = 200
"""Samples of one cycle: straight lines between them miss the sine by up to (2 pi / 200)^2 / 8 = 1.2e-4 of its
amplitude; their part of its frequency is (2 pi / 200)^2 / 12 = 8e-5 too small."""

MAX_CYCLES = 100_000
"""Cycles of all sinusoidal motions of one entry of a study: their samples take 160 MB."""

SINE_SOURCE = "sine"
"""The label of every sinusoidal motion (`Motion.source`)."""


@dataclass(frozen=True)
class Sine:
    """A ground acceleration amplitude * sin(2 pi frequency t), which may grow evenly to its amplitude at first.

    frequency : [Hz], > 0
    amplitude : [m/s2], > 0
    cycles : how many there are, >= 0.5
    ramp : cycles in which it grows to its amplitude, >= 0 and at most `cycles`
    """

    frequency: float
    amplitude: float
    cycles: float
    ramp: float = 0.0

    @property
    def name(self) -> str:
        """The name of the motion in tables."""
        return f"sine {self.frequency:.6g} Hz"

    def build_motion(self) -> Motion:
        """Return the motion, of SAMPLES_A_CYCLE samples a cycle."""
        count = max(1, round(SAMPLES_A_CYCLE * self.cycles))
        cycles = np.arange(count + 1) / SAMPLES_A_CYCLE
        growth = np.minimum(cycles / self.ramp, 1.0) if self.ramp else 1.0
        step = 1.0 / (SAMPLES_A_CYCLE * self.frequency)
        return Motion(self.name, step, self.amplitude * growth * np.sin(2.0 * np.pi * cycles), SINE_SOURCE)
