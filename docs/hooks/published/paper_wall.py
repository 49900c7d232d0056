"""The bumper wall beside Fig. 8 of the paper."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from comparison import GALLERY, Entry, Row, compare


def compare_paper_wall(solved: Any) -> Iterator[Row]:
    """Yield the stress of its Fig. 8."""
    table = solved.written().query("`contact.over` == 'node'").set_index("mesh.size")
    stress = 1e-6 * table["wall_stress"]
    why = f"elements of half a metre; under one node the stress does not converge: {stress[0.25]:.1f} at 0.25 m"
    yield compare("stress beside the point of impact [N/mm2]", 33.0, stress[0.5], ".1f", why)


ENTRY = Entry(compare_paper_wall, "wall", GALLERY)
