"""The free vibration of an oscillator beside a soft stop, beside a validation manual."""

from __future__ import annotations

from collections.abc import Iterator
from math import acos, pi, sqrt
from typing import Any

import numpy as np
from comparison import Entry, Row, compare
from meeting import Meeting

GAP = 0.01
"""[m]"""


def find_frequency(energy: float, mass: float, stiffness: float, stop: float, gap: float) -> float:
    """Return the frequency of the free vibration of an oscillator that reaches an elastic stop on one side [Hz].

    Parameters
    ----------
    energy : of the vibration, more than that of the gap [J]
    mass : [kg]
    stiffness, stop : of the oscillator and of the stop [N/m]
    gap : between the stop and the place of rest [m]
    """
    speed = sqrt((2 * energy - stiffness * gap**2) / mass)
    free, held = sqrt(stiffness / mass), sqrt((stiffness + stop) / mass)
    depth = gap * stiffness / (stiffness + stop)  # of the stop's edge over the place of rest on it
    apart = 2 * (pi - acos(gap * free / sqrt((gap * free) ** 2 + speed**2))) / free
    touching = 2 * acos(depth * held / sqrt((depth * held) ** 2 + speed**2)) / held
    return 1 / (apart + touching)


def compare_one_sided_oscillator(solved: Any) -> Iterator[Row]:
    """Yield the frequency."""
    contacts = Meeting(solved.results.history(), GAP, "oscillator").find_contacts()
    exact = find_frequency(0.00650108331626, 1.0, 10.0, 50.0, GAP)
    formula = "the manual's formula, whose time on the stop is another one, has 0.64622"
    why = f"the force of the manual's stop sets in smoothly; the closed form is {exact:.5f}; {formula}"
    yield compare("frequency [Hz]", 0.64669392749957, 1 / np.diff(contacts)[0], ".5f", why)


ENTRY = Entry(compare_one_sided_oscillator)
