"""An elastoplastic oscillator under El Centro beside a textbook's."""

from __future__ import annotations

from collections.abc import Iterator
from math import pi
from typing import Any

import numpy as np
from comparison import CHOPRA_ELCENTRO, Entry, Row, compare
from scipy.constants import g as GRAVITY
from superposition import STEP, read_elcentro


def integrate_by_average_acceleration(frequency: float, samples: np.ndarray) -> float:
    """Return the largest displacement of an undamped oscillator by average acceleration, a step for every sample [m].

    frequency : of the oscillator [rad/s]
    samples : acceleration of the ground every 0.02 s [m/s2]
    """
    displacement = velocity = largest = 0.0
    acceleration = samples[0]
    for sample in samples[1:]:
        predicted = displacement + STEP * velocity + STEP**2 / 4 * acceleration
        following = (sample - frequency**2 * predicted) / (1 + (frequency * STEP) ** 2 / 4)
        displacement = predicted + STEP**2 / 4 * following
        velocity += STEP / 2 * (acceleration + following)
        acceleration = following
        largest = max(largest, abs(displacement))
    return largest


def compare_chopra_yielding(solved: Any) -> Iterator[Row]:
    """Yield the strength that the elastic oscillator needs and the displacement of the yielding one."""
    displacements = solved.table("floor").query("building == 'oscillator'").set_index("analysis")["displacement"]
    frequency = 2 * pi / 0.5
    weight = frequency**2 / GRAVITY  # displacement [m] to spring force over weight
    coarse = weight * integrate_by_average_acceleration(frequency, read_elcentro(solved.file.parent))
    why = f"without damping errors of a method add up: average acceleration in steps of 0.02 s gives {coarse:.2f}"
    yield compare("strength for staying elastic, over the weight", 1.37, weight * displacements["elastic"], ".2f", why)
    why = "the strength of 0.171 of the weight is that of the book, an eighth of its 1.37"
    yield compare("displacement of the yielding one [cm]", 4.34, 100 * displacements["inelastic"], ".2f", why)


ENTRY = Entry(compare_chopra_yielding, motions=(CHOPRA_ELCENTRO,))
