"""A container that is dropped on springs beside a textbook's example."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from comparison import Entry, Row, compare
from meeting import Meeting

INCH = 0.0254
POUND = 4.4482216152605
"""[N]"""
MASS = 0.5 * POUND / INCH
"""[kg]"""


def compare_dropped_container(solved: Any) -> Iterator[Row]:
    """Yield time, speed and energy of the contact, and the largest displacement."""
    meeting = Meeting(solved.results.history(), INCH, "container")
    contact = meeting.find_contacts()[0]
    speed = -meeting.speed(contact)
    why = "a closed form on both sides"
    yield compare("contact after [s]", 0.07198, contact, ".5f", why)
    yield compare("speed of the contact [in/s]", 27.79, speed / INCH, ".2f", why)
    yield compare("kinetic energy then [lb in]", 193, MASS * speed**2 / 2 / (POUND * INCH), ".1f", why)
    deepest = solved.table("link")["max_closing"].iloc[0]
    yield compare("largest displacement [in]", 1.5506, deepest / INCH, ".4f", why)
    why = "the closed form is 0.10044"
    yield compare("it is reached after [s]", 0.10037, meeting.times[meeting.closing.argmax()], ".5f", why)


ENTRY = Entry(compare_dropped_container)
