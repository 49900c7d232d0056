"""A rod that strikes another beside the closed form of a validation manual."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from comparison import Entry, Row, compare
from meeting import Meeting

GAP = 0.0501
"""Of the study [m]."""
PUBLISHED = {0.2: (-0.1, -0.100780), 0.4: (-0.2, -0.193735), 0.6: (-0.1, -0.095579), 1.0: (0.2, 0.206157)}
"""Time after the contact [ms] -> displacement of the striking end by the manual: closed form and program [mm]."""
WAVE = 1000 * (7800 / 2e11) ** 0.5
"""Time that a wave takes to run the rod [ms]."""


def find_displacement(time: float) -> float:
    """Return the displacement of the end of a free rod that strikes an equal one, fixed at its far end, at 1 m/s [mm].

    time : after the contact [ms]

    Both ends move at half the speed until the wave returns from the free end, then back as fast, until the other one
    returns from the fixed end and throws the free rod back at its whole speed.
    """
    there = -0.5 * min(time, 2 * WAVE)
    back = 0.5 * min(max(time - 2 * WAVE, 0), 2 * WAVE)
    return there + back + max(time - 4 * WAVE, 0)


def compare_rod_and_rod(solved: Any) -> Iterator[Row]:
    """Yield where the striking end is."""
    meeting = Meeting(solved.results.history(), GAP, "free")
    contact = meeting.find_contacts()[0]
    for time, (published, theirs) in PUBLISHED.items():
        ours = 1000 * (meeting.displacement(contact + time / 1000) - meeting.displacement(contact))
        why = (
            f"the manual has a wave that takes 0.2 ms for the rod; it takes {WAVE:.4f} ms, which gives "
            f"{find_displacement(time):.4f}; the manual's program finds {theirs:.4f}"
        )
        yield compare(f"striking end, {time:g} ms after the contact [mm]", published, ours, ".4f", why)
    lasts = 1000 * (meeting.find_partings()[-1] - contact)
    why = f"the manual's closed form is back at its start then; four times {WAVE:.4f} ms is {4 * WAVE:.4f}"
    yield compare("end of the contact [ms]", 0.8, lasts, ".4f", why)


ENTRY = Entry(compare_rod_and_rod)
