"""How far results depend on an unknown value: their spread over its bracket, or a sentence without a bracket."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr

from pounding_cli.results.file import written

HARDLY = 0.05
"""A quantity whose median changes by no more than this from end to end of a bracket hardly depends on it [-]."""

UNKNOWN = "impact.stiffness"

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


@dataclass(frozen=True)
class Spread:
    """How far one quantity depends on one bracketed key.

    middle : the value that tables and figures lead with, as the study wrote it
    ends : likewise the values at both ends -> smallest, median and largest of the quantity there over that at the
        middle: of the means over the motions, over all storeys, floors or links of cases whose floors strike
    """

    key: str
    middle: str
    quantity: str
    ends: dict[str, tuple[float, float, float]]

    @property
    def hardly(self) -> bool:
        """Whether the quantity hardly depends on the key."""
        return all(abs(median - 1) <= HARDLY for _, median, _ in self.ends.values())

    @property
    def words(self) -> list[str]:
        """The median at both ends (smallest to largest)."""
        return [f"{median:.2f} ({smallest:.2f} to {largest:.2f})" for smallest, median, largest in self.ends.values()]


def spreads(data: xr.Dataset) -> Iterator[Spread]:
    """Of every bracketed key how far V/V0, mu/mu0, accelerations and link forces depend on it; none without brackets
    or where no floor strikes."""
    struck = _struck(data)
    for key in json.loads(str(data["study_resolved"].item())).get("bracket") or () if struck.any() else ():
        values = [written(data[key].attrs).text(value) for value in data[key].values.tolist()]
        middle = len(values) // 2
        here = struck.isel({key: middle}).values
        for name, quantity in QUANTITIES.items():
            array = data[f"{name}_mean"] if f"{name}_mean" in data else data[name].mean("record")
            first, lead, last = (
                array.transpose(*struck.dims, ...).isel({key: n}).values[here] for n in (0, middle, -1)
            )
            with np.errstate(invalid="ignore", divide="ignore"):
                changes = {values[0]: first / lead, values[-1]: last / lead}
            known = {value: change[np.isfinite(change)] for value, change in changes.items()}
            if all(change.size for change in known.values()):
                ends = {value: (each.min(), float(np.median(each)), each.max()) for value, each in known.items()}
                yield Spread(key, values[middle], quantity, ends)


def depends(mine: Sequence[Spread]) -> list[str]:
    """Which results a key changes and which it hardly does, in sentences; `mine` are the spreads over that key."""
    lines = []
    for words, hardly in (("It hardly changes", True), ("It changes", False)):
        names = [spread.quantity for spread in mine if spread.hardly == hardly]
        if names:
            lines.append(f"{words} {' and '.join(filter(None, (', '.join(names[:-1]), names[-1])))}.")
    return lines


def advice(data: xr.Dataset) -> str:
    """What is said where floors strike and the impact stiffness has one value; "" elsewhere."""
    return ADVICE if UNKNOWN not in data and _struck(data).any() else ""


def _struck(data: xr.Dataset) -> xr.DataArray:
    """Whether a pounding link closed under any motion, over the swept axes, case and analysis."""
    if "kind" not in data:  # no case has a link
        return xr.DataArray(False)
    closed = ((data["impacts"] > 0).any("record") & (data["kind"] == "pounding")).any("link")
    return closed.transpose(..., "case", "analysis")
