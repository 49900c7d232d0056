"""A flexible building beside a stiff one under two digitisations of El Centro; what a paper printed is not known."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from comparison import CHOPRA_ELCENTRO, NOT_KNOWN, PEER_ELCENTRO, Entry, Row

SIDES = {"left": "at the left", "right": "at the right"}
"""Case of the study -> where the stiff building stands."""


def compare_three_storey_pair(solved: Any) -> Iterator[Row]:
    """Yield the largest displacement of the flexible roof for both sides on which the stiff building may stand."""
    roofs = solved.table("floor").query("building == 'flexible' and floor == 3").set_index(["case", "record"])
    displacements = 1000 * roofs["displacement"]
    for case, place in SIDES.items():
        by_book, by_peer = displacements[case, "El Centro"], displacements[case, "PEER"]
        yield Row(
            f"roof of the flexible building, the stiff one {place}",
            "not found",
            f"{by_book:.0f} mm as the book has El Centro, {by_peer:.0f} mm by PEER",
            NOT_KNOWN,
            f"one record, two digitisations: {100 * (by_peer / by_book - 1):+.0f} %",
        )


ENTRY = Entry(compare_three_storey_pair, motions=(CHOPRA_ELCENTRO, PEER_ELCENTRO))
