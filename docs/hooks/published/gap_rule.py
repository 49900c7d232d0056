"""How good the rule DDC is beside the main period of the motions, beside the statement of a study."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from comparison import Entry, Row


def compare_gap_rule(solved: Any) -> Iterator[Row]:
    """Yield the gap by the rule over the exact one for short, middle and long periods of the same ratio."""
    table = solved.results.table("gap")
    table = table[table["rule"] == "DDC"]
    longer, shorter = table["buildings.longer.period"], table["buildings.shorter.period"]
    table = table.assign(ratio=(shorter / longer).round(2), period=np.sqrt(shorter * longer).round(2))
    over = table.pivot_table("over_exact", "ratio", "period")
    for ratio, row in over.iterrows():
        short, middle, long = row
        spread = 100 * (row.max() / row.min() - 1)
        yield Row(
            f"gap by DDC over the exact one, period ratio {ratio:g}",
            "depends on the periods too",
            f"{short:.2f}, {middle:.2f} and {long:.2f} at 0.3, 1 and 3 times the main period",
            "none",
            f"the rule takes the correlation under white noise; the three differ by {spread:.0f} %",
        )


ENTRY = Entry(compare_gap_rule, "gap")
