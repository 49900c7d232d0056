"""The correlation of oscillators by period and damping, which the rule DDC takes, beside a printed table and noise."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from comparison import Entry, Row, compare

from pounding_cli.model.separation import cross_correlation

PERIODS = {"first": 1.3685937, "second": 1.3004468, "third": 0.43155484}
"""Of the study [s]."""
PUBLISHED = {("first", "second"): 0.79280, ("first", "third"): 0.005705, ("second", "third"): 0.006383}
REPEAT = 50.0
"""Time after which the noise repeats itself [s]."""


def compare_modal_correlation(solved: Any) -> Iterator[Row]:
    """Yield the correlation of every pair by the rule and by the time histories."""
    data = solved.results.history().dataset
    steady = data["displacement"].isel(floor=0, time=data["time"].values > data["time"].values[-1] - REPEAT)
    for (left, right), published in PUBLISHED.items():
        rule = cross_correlation(PERIODS[left], PERIODS[right])
        name = f"{left} and {right} mode"
        why = "one formula on both sides (Der Kiureghian 1981)"
        yield compare(f"correlation of {name}, by the rule", published, rule, ".6f", why)
        u, v = (steady.sel(building=each).values.astype(float) for each in (left, right))
        found = float(np.sum(u * v) / np.sqrt(np.sum(u**2) * np.sum(v**2)))
        why = "the noise is white up to 20 Hz and the same again after 50 s"
        yield compare(f"correlation of {name}, in time", published, found, ".6f", why)


ENTRY = Entry(compare_modal_correlation)
