"""The blows of a forced oscillator on a hard stop beside the exact times of a validation manual."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from comparison import Entry, Row, compare
from meeting import Meeting

GAP = 0.001
"""Of the study [m]."""
CONTACTS = {
    1: (0.024867876, 0.025260518),
    10: (0.471718478, 0.472111368),
    30: (1.646257587, 1.646652297),
    50: (2.834892801, 2.835286766),
    70: (3.886525493, 3.886916559),
}
"""Number of a contact -> its start and end by the manual, of 70 within 4 s [s]."""


def compare_hard_stop(solved: Any) -> Iterator[Row]:
    """Yield how many contacts there are, and when they start and end."""
    meeting = Meeting(solved.results.history(), GAP, "oscillator")
    starts, ends = meeting.find_contacts(), meeting.find_partings()
    yield compare("contacts in 4 s", 70, len(starts), ".0f", "a contact lasts 0.39 ms")
    for number, (start, end) in CONTACTS.items():
        for name, published, ours in (("start", start, starts[number - 1]), ("end", end, ends[number - 1])):
            yield Row(
                f"{name} of contact {number} [s]",
                f"{published:.6f}",
                f"{ours:.6f}",
                f"{round(1e6 * (ours - published), 2) or 0.0:+.2f} µs",
                "closed forms on one side, Taylor series on the other; the history has a sample every 10 µs",
            )


ENTRY = Entry(compare_hard_stop)
