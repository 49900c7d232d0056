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
    2: (0.046328519, 0.046722721),
    10: (0.471718478, 0.472111368),
    20: (1.062676943, 1.063070409),
    30: (1.626799772, 1.627192863),
    40: (2.210064660, 2.210455239),
    50: (2.853479566, 2.853874093),
    60: (3.408817607, 3.409205942),
    70: (3.886525493, 3.886916559),
}
"""Number of a contact -> its start and end by the manual, of 70 within 4 s [s]."""


def compare_hard_stop(solved: Any) -> Iterator[Row]:
    """Yield how many contacts there are, and when they start and end."""
    meeting = Meeting(solved.results.history(), GAP, "oscillator")
    starts, ends = meeting.find_contacts(), meeting.find_partings()
    why = "a closed form from contact to contact on both sides"
    yield compare("contacts in 4 s", 70, len(starts), ".0f", why)
    for number, (start, end) in CONTACTS.items():
        for name, published, ours in (("start", start, starts[number - 1]), ("end", end, ends[number - 1])):
            late = f"{1e6 * (ours - published):+.2f} µs"
            yield compare(f"{name} of contact {number} [s]", published, ours, ".6f", late)


ENTRY = Entry(compare_hard_stop)
