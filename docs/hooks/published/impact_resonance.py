"""Blows that come once in several periods of the force beside the closed form of their speed."""

from __future__ import annotations

from collections.abc import Iterator
from math import pi
from typing import Any

from comparison import Entry, Row, compare
from impact_oscillator import extrapolate, find_rigid_speed, find_speeds

OSCILLATORS = ((4.0, 0.5, 0.02, 2), (4.0, 0.65, 0.02, 2), (6.0, 0.5, 0.01, 3), (6.0, 0.3, 0.01, 3))
"""w [-], r [-], s [-], and the periods of the force from blow to blow."""


def compare_impact_resonance(solved: Any) -> Iterator[Row]:
    """Yield the speed of the blows of every oscillator."""
    speeds = find_speeds(solved)
    for w, r, s, periods in OSCILLATORS:
        exact = find_rigid_speed(w, r, s, periods) / (2 * pi)
        column = speeds[w, r, s]
        errors = [f"{100 * (column[stiffness] / exact - 1):+.2f} %" for stiffness in (1e3, 1e5)]
        why = f"a contact 1e3 and 1e5 times as stiff as the oscillator is off by {errors[0]} and {errors[1]}"
        quantity = f"speed of the blows, one in {periods} periods, w = {w:g}, r = {r:g}, s = {s:g}"
        yield compare(quantity, exact, extrapolate(column), ".5f", why)


ENTRY = Entry(compare_impact_resonance)
