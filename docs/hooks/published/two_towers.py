"""Two towers on a shaking table beside two statements on such towers."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from comparison import Entry, Row


def compare_two_towers(solved: Any) -> Iterator[Row]:
    """Yield both claims for every pair of towers."""
    links = solved.table("link").set_index(["buildings.stiff.period", "record"])
    storeys = solved.table("storey")
    ratios = storeys.pivot_table("V_ratio", ["buildings.stiff.period", "record"], "building")
    struck = ratios[links["impacts"].reindex(ratios.index) > 0]
    for period, pair in struck.groupby(level=0):
        pair = pair.droplevel(0)
        pair.index = pair.index.str.split().str[0].astype(int) / 1000
        pair = pair.sort_index()
        forces = links["peak_force"][period]
        hardest = int(forces.idxmax().split()[0]) / 1000
        stiff = 1 / period
        name = f"1 and {stiff:.2f} Hz"
        within = 1 < hardest < stiff
        why = "the frequencies are 0.05 Hz apart"
        if not within:
            why = "at its own resonance the stiff tower alone swings across the gap"
        yield Row(
            f"frequency of the hardest blow, towers of {name}",
            f"between 1 and {stiff:.2f} Hz",
            f"{hardest:.2f} Hz",
            "none" if within else f"{hardest - stiff:+.2f} Hz",
            why,
        )
        both = (pair["stiff"] > 1) & (pair["soft"] < 1)
        turned = pair.index[(pair["stiff"] < 1)]
        yield Row(
            f"stiff amplified and soft suppressed, towers of {name}",
            "of all frequencies",
            f"of {both.sum()} of {len(pair)} frequencies with blows",
            f"{len(pair) - both.sum()} frequencies",
            f"near its own resonance the stiff one is the suppressed one: {turned.min():.2f} to {turned.max():.2f} Hz",
        )


ENTRY = Entry(compare_two_towers)
