"""What restitution the damping formulas of contact laws give beside the one that was wanted."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from comparison import Entry, Row, compare

FORMULAS = {
    "anagnostopoulos": ("linear spring and dashpot (Anagnostopoulos 1988)", "the formula is exact"),
    "jankowski": ("`jankowski`, formula of 2006", "the formula is an approximation by its author"),
    "ye": ("`hertz-damp`, formula of Ye, Li & Zhu 2009", "the formula is an approximation for little loss"),
    "muthukumar": (
        "`hertz-damp`, formula of Muthukumar & DesRoches 2006",
        "the formula loses too little: Ye, Li & Zhu (2009) found it incorrect for pounding",
    ),
}
"""Case of the study -> whose formula it is, and why another restitution comes out."""


def compare_restitution(solved: Any) -> Iterator[Row]:
    """Yield the restitution that every formula gives, from the impulse of the blow."""
    impulse = solved.table("link").set_index("case")["impulse"]
    for case, (name, why) in FORMULAS.items():
        yield compare(f"restitution, {name}", 0.65, impulse[case] / (2e5 * 0.5) - 1, ".4f", why)


ENTRY = Entry(compare_restitution)
