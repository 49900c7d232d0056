"""An isolated building that strikes the walls of its moat, beside the statements of a study."""

from __future__ import annotations

from collections.abc import Iterator
from math import pi
from typing import Any

import pandas as pd
from comparison import Entry, Row

MASS = 8e5
"""Of the building [kg]."""
CONTACTS = {200e6: "200 kN/mm", 1000e6: "1000 kN/mm", 5000e6: "5000 kN/mm"}
"""Stiffness [N/m] -> as it is written."""


def add_period(table: pd.DataFrame) -> pd.DataFrame:
    """Return a table with the period of the isolators under the whole building, to a tenth [s]."""
    first = table["buildings.isolated.stiffness"].str.strip("[").str.split().str[0].astype(float) * 1e6
    return table.assign(isolators=(2 * pi * (MASS / first) ** 0.5).round(1))


def compare_moat_wall(solved: Any) -> Iterator[Row]:
    """Yield what the walls do to accelerations and drifts, and what contact and isolators change of it."""
    floors = add_period(solved.table("floor").query("building == 'isolated'"))
    storeys = add_period(solved.table("storey").query("building == 'isolated' and storey > 1"))
    usual = floors[(floors["impact.stiffness"] == 1000e6) & (floors["isolators"] == 2.0)]
    ratios = usual.pivot_table("acceleration_ratio", "record", "floor")
    means = ratios.mean()
    yield Row(
        "accelerations over those without walls",
        '"substantially" more',
        f"{means[1]:.0f} times at the base, {means.iloc[1:].min():.0f} to {means.iloc[1:].max():.0f} above",
        "none",
        "the abstract gives no numbers; means of five motions, a gap of 10 cm, contacts of 1000 kN/mm",
    )
    most = (ratios.idxmax(axis=1) == 1).sum()
    yield Row(
        "floor whose acceleration grows most",
        "the base",
        f"the base, under {most} of {len(ratios)} motions",
        "none" if most == len(ratios) else f"{len(ratios) - most} motions",
        f"the roof is next, with {means.iloc[-1]:.0f} times",
    )
    drifts = storeys[(storeys["impact.stiffness"] == 1000e6) & (storeys["isolators"] == 2.0)]
    grown = drifts.groupby("storey")["V_ratio"].mean()  # elastic: of shears and drifts
    yield Row(
        "storey drifts over those without walls",
        "increased",
        f"{grown.min():.0f} to {grown.max():.0f} times",
        "none",
        "isolated, the building moves as one; the blows bring its own modes",
    )
    base = floors[(floors["floor"] == 1) & (floors["isolators"] == 2.0)]
    stiff = base.groupby("impact.stiffness")[["acceleration", "displacement"]].mean()
    change = 100 * (stiff.loc[5000e6] / stiff.loc[200e6] - 1)
    contacts = f"{CONTACTS[5000e6]} in place of {CONTACTS[200e6]}"
    why = "the base stops at the wall in both, 10 cm and the depth of the contact away"
    yield Row(
        f"acceleration of the base, contacts of {contacts}",
        "affected significantly",
        f"{change['acceleration']:+.0f} %",
        "none",
        "a stiffer contact takes the same speed in a shorter time",
    )
    yield Row(
        f"displacement of the base, contacts of {contacts}",
        "more insensitive",
        f"{change['displacement']:+.0f} %",
        "none",
        why,
    )
    soft = floors[(floors["floor"] == 1) & (floors["impact.stiffness"] == 1000e6)]
    flexible = soft.groupby("isolators")[["acceleration0", "acceleration"]].mean()
    steps = ", ".join(f"{value:.0f}" for value in flexible["acceleration"])
    gain = 100 * (flexible.loc[3.0] / flexible.loc[1.0] - 1)
    yield Row(
        "acceleration of the base, isolators of 3 s in place of 1 s",
        '"may lead to a building vulnerable to poundings"',
        f"{gain['acceleration0']:+.0f} % without walls, {gain['acceleration']:+.0f} % with them",
        "none",
        f"with walls {steps} m/s2 for 1, 1.5, 2 and 3 s",
    )


ENTRY = Entry(compare_moat_wall)
