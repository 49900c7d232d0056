"""The restitution of contacts over the speed of the blow beside a measured one."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from comparison import Entry, Row, compare

CONTACTS = (
    (("pounding", "hertz-damp", "jankowski"), "they have one restitution at all speeds"),
    (("bilinear",), "it loses nothing in weak blows, and most in the blow that closes it to its penetration"),
)
"""Laws, which are the cases of the study, and why they have another restitution."""


def find_ice_restitution(speed: float) -> float:
    """Return the restitution of ice at a speed [m/s].

    Source: the measurements of Bridges et al. (1984), as the examples of the program REBOUND have them.
    """
    return 0.32 * (100 * speed) ** -0.234


def compare_restitution_speed(solved: Any) -> Iterator[Row]:
    """Yield the restitution of the contacts at a fifth of and five times the speed that they were set for: of laws that
    stand together, the one that is furthest from the measured."""
    impulses = solved.table("link").set_index(["records.scale", "case"])["impulse"]
    for laws, why in CONTACTS:
        names = ", ".join(f"`{law}`" for law in laws)
        for scale in (0.004, 0.1):
            speed = 0.5 * scale
            measured = find_ice_restitution(speed)
            ours = max((impulses[scale][list(laws)] / (2e5 * speed) - 1), key=lambda e: abs(e - measured))
            yield compare(f"restitution at {100 * speed:g} cm/s, {names}", measured, ours, ".3f", why)


ENTRY = Entry(compare_restitution_speed)
