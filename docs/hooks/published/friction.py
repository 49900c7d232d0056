"""The free vibration of an oscillator with friction, beside the closed form of a validation manual."""

from __future__ import annotations

from collections.abc import Iterator
from math import pi, sqrt
from typing import Any

import numpy as np
from comparison import Entry, Row, compare

END = 20.0
"""Of the pull [s]."""
HALF = pi / 100
"""Half a period of the oscillator [s]."""
PUBLISHED = (-0.4596, 0.3182, -0.1768, 0.03536)
"""Displacement after every half period, its component at 45 degrees [mm]."""


def compare_friction(solved: Any) -> Iterator[Row]:
    """Yield where the oscillator is after every half period."""
    data = solved.results.history().dataset
    floor = -data["displacement"].sel(building="oscillator").values[:, 0].astype(float)
    for number, published in enumerate(PUBLISHED, 1):
        ours = 1000 * np.interp(END + number * HALF, data["time"].values, floor) / sqrt(2)
        why = "the closed form has no spring in series with the friction, which gives back at a turn what it holds"
        yield compare(f"displacement after {number / 2:g} periods [mm]", published, ours, ".4f", why)


ENTRY = Entry(compare_friction)
