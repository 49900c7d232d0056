"""A sudden force on an oscillator that yields, beside a textbook's example."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from comparison import Entry, Row, compare

INCH = 0.0254


def compare_sudden_force(solved: Any) -> Iterator[Row]:
    """Yield the largest displacement and the smallest after it, and their times."""
    data = solved.results.history().dataset
    times = data["time"].values
    displacement = -data["displacement"].sel(building="oscillator").values[:, 0] / INCH
    largest = int(np.argmax(displacement))
    smallest = largest + int(np.argmin(displacement[largest:]))
    why = "R² / (2 k (R - F)) is 0.8043, by the work of the force"
    yield compare("largest displacement [in]", 0.806, displacement[largest], ".3f", why)
    yield compare("it is reached after [s]", 0.0669, times[largest], ".4f", "a history every 0.1 ms")
    why = "2 (R - F) / k below the largest"
    yield compare("smallest displacement after it [in]", 0.438, displacement[smallest], ".3f", why)
    yield compare("it is reached after [s]", 0.122, times[smallest], ".3f", "half a period after the largest")


ENTRY = Entry(compare_sudden_force)
