"""Two buildings of five storeys beside Fig. 6 of the paper and its text."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from comparison import GALLERY, Entry, Row, compare


def compare_paper_pair(solved: Any) -> Iterator[Row]:
    """Yield the separation and the accelerations of its Fig. 6."""
    separation = 100 * solved.table("buildings")["separation"].dropna().iloc[0]
    yield compare("separation by the UBC [cm]", 7.0, separation, ".1f", 'the paper says "approximately"')
    floors = solved.table("floor").query("analysis == 'elastic'")
    means = floors.groupby(["case", "building", "floor"])["acceleration"].mean()
    fall = 100 * (1 - (means["infill"] / means["touching"]).groupby("building").mean()["stiff"])
    yield Row(
        "reduction of accelerations by the infill",
        '"more than 80%"',
        f"{fall:.0f} %",
        "none",
        "the contact stiffness, which the paper does not give, decides on which side of 80 %",
    )


ENTRY = Entry(compare_paper_pair, folder=GALLERY)
