"""A rod that strikes a rigid wall beside a study of contact by finite elements."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from comparison import Entry, Row, compare
from meeting import Meeting

GAP = 0.0257
"""Of the study [m]."""
SPEED = 202.2 * 0.0254 / 10
"""[m/s]"""
MASS = 0.73e-3 * 10 * 4.4482216152605 / 0.0254
"""Of the rod [kg]."""


def compare_rod_and_wall(solved: Any) -> Iterator[Row]:
    """Yield how long the contact lasts and the speed after it."""
    meeting = Meeting(solved.results.history(), GAP, "rod")
    lasts = meeting.find_partings()[-1] - meeting.find_contacts()[0]
    why = "a chain of 20 pieces and a contact 20 times as stiff as one; 2 L sqrt(rho / E) is 0.0987 ms"
    yield compare("time from contact to release [ms]", 0.0986, 1000 * lasts, ".4f", why)
    speed = (solved.table("link")["impulse"].iloc[0] / MASS - SPEED) * 10 / 0.0254
    why = "of the rod's centre; the rest swings in the chain, which has no wave front"
    yield compare("speed after it [in/s]", 202.2, speed, ".1f", why)


ENTRY = Entry(compare_rod_and_wall)
