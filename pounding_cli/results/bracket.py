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
class End:
    """A quantity at one end of a bracket over itself at the middle value: of the means over the motions, over all
    storeys, floors or links of cases whose floors strike.

    value : the bracketed key's value there, as the study wrote it
    """

    value: str
    smallest: float
    median: float
    largest: float

    def __str__(self) -> str:
        return f"{self.median:.2f} ({self.smallest:.2f} to {self.largest:.2f})"


@dataclass(frozen=True)
class Spread:
    """How far one quantity depends on one bracketed key.

    middle : the value that tables and figures lead with
    """

    key: str
    middle: str
    quantity: str
    ends: tuple[End, ...]

    @property
    def hardly(self) -> bool:
        """Whether the quantity hardly depends on the key."""
        return all(abs(end.median - 1) <= HARDLY for end in self.ends)


def spreads(data: xr.Dataset) -> Iterator[Spread]:
    """Of every bracketed key how far V/V0, mu/mu0, accelerations and link forces depend on it; none without brackets
    or where no floor strikes."""
    struck = _struck(data)
    for key in json.loads(str(data["study_resolved"].item())).get("bracket") or () if struck.any() else ():
        unit = written(data[key].attrs)
        values = [unit.text(value) for value in data[key].values.tolist()]
        middle = len(values) // 2
        here = struck.isel({key: middle}).values
        for name, quantity in QUANTITIES.items():
            array = data[f"{name}_mean"] if f"{name}_mean" in data else data[name].mean("record")
            array = array.transpose(*struck.dims, ...)
            lead = array.isel({key: middle}).values[here]
            ends = []
            for place in (0, -1):
                with np.errstate(invalid="ignore", divide="ignore"):
                    change = array.isel({key: place}).values[here] / lead
                known = change[np.isfinite(change)]
                if known.size:
                    ends.append(End(values[place], float(known.min()), float(np.median(known)), float(known.max())))
            if len(ends) == 2:
                yield Spread(key, values[middle], quantity, tuple(ends))


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
