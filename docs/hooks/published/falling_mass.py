"""A mass that falls on a spring, with and without a dashpot, beside the closed form of a validation manual."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from comparison import Entry, Row, compare
from meeting import Meeting

START = 0.1
"""The mass starts that much earlier, from rest [s]."""
HEIGHT = 0.05
"""And that much higher [m]."""
GAP = 2.05
"""Of the study [m]."""

WITHOUT = {"parts": 0.88545615307643, 1.0: -1.332162981855, 1.1: -0.856394405035}
WITH = {"parts": 0.92403882542, 1.0: -1.88214079833, 1.1: -1.81496422497}
"""When the mass leaves the spring [s], and where it is at two times [m]."""


def compare_falling_mass(solved: Any) -> Iterator[Row]:
    """Yield when the mass meets and leaves the spring, and where it is afterwards."""
    spring, dashpot, cut = (
        Meeting(solved.results.history(case=case), GAP, "mass") for case in ("spring", "dashpot", "cut")
    )
    yield compare("contact after [s]", 0.54031242374, spring.find_contacts()[0] - START, ".5f", "free fall")
    names = ((spring, WITHOUT, "the spring"), (dashpot, WITH, "spring and dashpot"))
    for meeting, published, name in names:
        why = "both have the force of spring and dashpot until the spring is as long as before"
        if meeting is spring:
            why = "closed form on both sides"
        yield compare(f"{name} left after [s]", published["parts"], meeting.find_partings()[0] - START, ".5f", why)
        for time in (1.0, 1.1):
            place = meeting.displacement(time + START) + HEIGHT
            reason = "closed form on both sides"
            if meeting is dashpot:
                other = cut.displacement(time + START) + HEIGHT
                reason = f"with `tension_cut`, which ends a force that pulls: {other:.5f}"
            yield compare(f"height at {time:g} s after {name} [m]", published[time], place, ".5f", reason)


ENTRY = Entry(compare_falling_mass)
