"""How far results depend on an unknown value: their spread over its bracket, or a sentence without a bracket."""

from __future__ import annotations

import json
from collections.abc import Iterator

import numpy as np
import xarray as xr

from pounding_cli.results.file import written

ADVICE = (
    "Floor accelerations and link forces of floors that strike grow with the square root of the impact stiffness, "
    "which is unknown. Sweep it to see the effect: `impact.stiffness: {values: [5 x stiffest storey, 20 x stiffest "
    "storey, 100 x stiffest storey], middle: 20 x stiffest storey}`."
)
"""What is said where floors strike and the impact stiffness has one value."""

QUANTITIES = {
    "V_ratio": "V/V0",
    "mu_ratio": "mu/mu0",
    "acceleration": "floor acceleration",
    "peak_force": "link force",
}
"""Variable -> what a reader calls it. V0 and mu0 are those of the buildings alone and do not change."""


def spreads(data: xr.Dataset) -> Iterator[tuple[str, list[str], list[list[str]]]]:
    """Of every bracketed key a table (caption, heads, rows): V/V0, mu/mu0, accelerations and link forces at both ends
    over those at the middle, of the means over the motions in cases whose floors strike; none where no floor does."""
    struck = _struck(data)
    for key in json.loads(str(data["study_resolved"].item())).get("bracket") or () if struck.any() else ():
        values, rows = [written(data[key].attrs).text(value) for value in data[key].values.tolist()], []
        middle = len(values) // 2
        here = struck.isel({key: middle}).values
        for name, quantity in QUANTITIES.items():
            array = data[f"{name}_mean"] if f"{name}_mean" in data else data[name].mean("record")
            array = array.transpose(*struck.dims, ...)
            first, lead, last = (array.isel({key: place}).values[here] for place in (0, middle, -1))
            with np.errstate(invalid="ignore", divide="ignore"):
                changes = [each[np.isfinite(each)] for each in (first / lead, last / lead)]
            if all(each.size for each in changes):
                words = [f"{np.median(each):.2f} ({each.min():.2f} to {each.max():.2f})" for each in changes]
                rows.append([quantity, *words])
        what = f"Bracket of {key}: results at both ends over those at {values[middle]}, median (smallest to largest)"
        yield what, ["result", f"at {values[0]}", f"at {values[-1]}"], rows


def advice(data: xr.Dataset) -> str:
    """What is said where floors strike and the impact stiffness has one value; "" elsewhere."""
    return ADVICE if "impact.stiffness" not in data and _struck(data).any() else ""


def _struck(data: xr.Dataset) -> xr.DataArray:
    """Whether a pounding link closed under any motion, over the swept axes, case and analysis."""
    if "kind" not in data:  # no case has a link
        return xr.DataArray(False)
    closed = ((data["impacts"] > 0).any("record") & (data["kind"] == "pounding")).any("link")
    return closed.transpose(..., "case", "analysis")
