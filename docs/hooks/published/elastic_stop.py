"""An oscillator that swings against a stop beside the closed form of a validation manual."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from comparison import Entry, Row, compare
from meeting import Meeting


def compare_elastic_stop(solved: Any) -> Iterator[Row]:
    """Yield force, duration and impulse of the blows, and the time between them."""
    meeting = Meeting(solved.results.history(), 0.0, "oscillator")
    start = meeting.find_contacts()[-2]
    peaks = meeting.find_peaks()[-2:] - start
    link = solved.table("link").iloc[0]
    yield compare("largest force [N]", 9950, link["peak_force"], ".0f", "V sqrt(m K² / (k + K)) on both sides")
    yield compare("duration of a blow [s]", 0.03126, link["contact_time"] / 2, ".5f", "pi sqrt(m / (k + K))")
    why = "2 m V K / (k + K) is 198.02: the manual's last digits are rounded"
    yield compare("impulse of a blow [N s]", 198.05, link["impulse"] / 2, ".2f", why)
    why = "half the duration of a blow"
    yield compare("first largest force after [s]", 0.01563, peaks[0], ".5f", why)
    why = "half a period of the oscillator and one and a half of the blow's duration"
    yield compare("second largest force after [s]", 0.361, peaks[1], ".3f", why)
    second = meeting.find_contacts()[-1]
    yield compare("speed of the second blow [m/s]", 1.0, abs(meeting.speed(second - 1e-4)), ".4f", "nothing is lost")


ENTRY = Entry(compare_elastic_stop)
