"""Buildings at the ends of rows and within them beside a statement on both."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pandas as pd
from comparison import Entry, Row

NEIGHBOUR_OF_END = {"b1": "b2", "b5": "b4"}
"""Buildings at the ends of the rows -> their neighbours."""


def is_stiffer_end(row: pd.Series) -> bool:
    """Return whether the building of a row of the table `storey`, at an end, is stiffer than its neighbour."""
    end = str(row["building"])
    return bool(row[f"buildings.{end}.period"] < row[f"buildings.{NEIGHBOUR_OF_END[end]}.period"])


def compare_rows(solved: Any) -> Iterator[Row]:
    """Yield how often buildings at the end and within a row gain, and by how much, for every gap."""
    table = solved.table("storey").query("analysis == 'inelastic'")
    for gap, rows in table.groupby("cases.row.gap"):
        outer = rows["building"].isin(NEIGHBOUR_OF_END)
        end = rows[outer]
        inner = rows.loc[~outer, "mu_ratio"]
        stiffer = end.apply(is_stiffer_end, axis=1)
        rises = 100 * (end["mu_ratio"] > 1)
        name = f"gap of {100 * gap:.0f} cm"
        yield Row(
            f"ends whose ductility demand rises, {name}",
            '"almost always"',
            f"{rises.mean():.0f} %; {100 * (end['mu_ratio'].mean() - 1):+.0f} % in the mean",
            f"{rises.mean() - 100:.0f} % of them do not",
            f"the direction agrees; {rises[stiffer].mean():.0f} % of the ends that are stiffer than their neighbour, "
            f"{rises[~stiffer].mean():.0f} % of the softer ones",
        )
        yield Row(
            f"interior buildings whose ductility demand falls, {name}",
            '"often"',
            f"{100 * (inner < 1).mean():.0f} %; {100 * (inner.mean() - 1):+.0f} % in the mean",
            "none",
            "the abstract gives no share",
        )


ENTRY = Entry(compare_rows)
