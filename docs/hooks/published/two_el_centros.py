"""Blows of a textbook's frame on a wall under two digitisations of El Centro."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from comparison import CHOPRA_ELCENTRO, PEER_ELCENTRO, Entry, Row


def compare_two_el_centros(solved: Any) -> Iterator[Row]:
    """Yield the number of blows on the wall under the book's motion and under the other one."""
    beside = solved.table("link").query("case == 'beside'").groupby("record")
    blows = beside["impacts"].sum().astype(int)
    force = beside["peak_force"].max()
    roofs = solved.table("floor").query("case == 'apart' and building == 'frame' and floor == 5").set_index("record")
    towards = 100 * roofs["displacement_max"]
    why = "without the wall the roof moves {:.1f} cm towards it; the hardest blow has {:.0f} kN"
    for record, quantity in (
        ("El Centro", "blows on the wall, El Centro as the book has it"),
        ("PEER", "the same by PEER"),
    ):
        difference = f"{blows[record]} blows" if blows[record] else "none"
        reason = why.format(towards[record], force[record] / 1e3)
        yield Row(quantity, "0", f"{blows[record]}", difference, reason.removesuffix("; the hardest blow has 0 kN"))


ENTRY = Entry(compare_two_el_centros, motions=(CHOPRA_ELCENTRO, PEER_ELCENTRO))
