"""How far results depend on an unknown value: their spread over its bracket, or a sentence without a bracket."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np

from pounding_cli.store.files import opened
from pounding_cli.store.structure import strings
from pounding_cli.store.swept import coordinate, written
from pounding_cli.store.values import PIECE

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
    ends: tuple[End, End]

    @property
    def hardly(self) -> bool:
        """Whether the quantity hardly depends on the key."""
        return all(abs(end.median - 1) <= HARDLY for end in self.ends)


def brackets(file: h5py.File) -> tuple[str, ...]:
    """The keys that the study brackets."""
    return tuple(json.loads(strings(file["study/resolved"])).get("bracket") or ())


def leading(file: h5py.File) -> tuple[int | slice, ...]:
    """The point of every swept axis that leads: the middle of a bracket, all of another axis."""
    keys, found = brackets(file), []
    for names in json.loads(file.attrs["swept"]):
        found.append(file[names[0]].size // 2 if names[0] in keys else slice(None))
    return tuple(found)


def spreads(path: Path) -> tuple[Spread, ...]:
    """Of every bracketed key how far V/V0, mu/mu0, accelerations and link forces depend on it; none without brackets
    or where no floor strikes.

    Raises
    ------
    InputError : not a results file of this program
    """
    with opened(path) as file:
        return tuple(_spreads(file))


def _spreads(file: h5py.File) -> Iterator[Spread]:
    keys = brackets(file)
    swept = [names[0] for names in json.loads(file.attrs["swept"])]
    struck = _struck(file, len(swept)) if keys else np.zeros(0)
    for key in keys if struck.any() else ():
        axis = swept.index(key)
        unit = written(file[key])
        values = [unit.text(value) for value in coordinate(file, key)]
        middle = len(values) // 2
        here = np.take(struck, middle, axis=axis)
        for name, quantity in QUANTITIES.items():
            array = file[f"{name}_mean"][()] if f"{name}_mean" in file else _over_records(file[name][()], len(swept))
            lead = np.take(array, middle, axis=axis)[here]
            ends = []
            for place in (0, len(values) - 1):
                with np.errstate(invalid="ignore", divide="ignore"):
                    change = np.take(array, place, axis=axis)[here] / lead
                known = change[np.isfinite(change)]
                if known.size:
                    ends.append(End(values[place], float(known.min()), float(np.median(known)), float(known.max())))
            if len(ends) == 2:
                yield Spread(key, values[middle], quantity, (ends[0], ends[1]))


def depends(mine: Sequence[Spread]) -> list[str]:
    """Which results a key changes and which it hardly does, in sentences; `mine` are the spreads over that key."""
    lines = []
    for words, hardly in (("It hardly changes", True), ("It changes", False)):
        names = [spread.quantity for spread in mine if spread.hardly == hardly]
        if names:
            listed = " and ".join((", ".join(names[:-1]), names[-1])) if len(names) > 1 else names[0]
            lines.append(f"{words} {listed}.")
    return lines


def advice(path: Path) -> str:
    """What is said where floors strike and the impact stiffness has one value; "" elsewhere."""
    with opened(path) as file:
        return _advice(file)


def _advice(file: h5py.File) -> str:
    strikes = UNKNOWN not in file and _struck(file, len(json.loads(file.attrs["swept"]))).any()
    return ADVICE if strikes else ""


def said(file: h5py.File) -> list[str]:
    """What the results owe to bracketed keys and to the impact stiffness, in lines for a terminal; none where no floor
    strikes and nothing is bracketed."""
    found = tuple(_spreads(file))
    lines = []
    for key in dict.fromkeys(spread.key for spread in found):
        mine = [spread for spread in found if spread.key == key]
        first, last = mine[0].ends
        lines.append(
            f"Bracket of {key}: at {first.value} and at {last.value}, over the value at {mine[0].middle} shown above: "
            "median of the means over the motions (smallest to largest)"
        )
        lines += [f"  {spread.quantity}: {spread.ends[0]} and {spread.ends[1]}" for spread in mine]
        lines += [f"  {sentence}" for sentence in depends(mine)]
    return [*lines, *filter(None, [_advice(file)])]


def _struck(file: h5py.File, axes: int) -> np.ndarray:
    """Whether a pounding link closed under any motion, over the swept axes, case and analysis."""
    if "kind" not in file:  # no case has a link
        return np.zeros(1, bool)
    kinds, impacts, found = file["kind"], file["impacts"], []
    step = max(1, PIECE // max(1, math.prod(impacts.shape[1:])))
    for begin in range(0, kinds.shape[0], step):
        pounds = kinds.asstr()[begin : begin + step] == "pounding"  # over axes, case, link
        closed = np.nan_to_num(impacts[begin : begin + step]).max(axis=axes + 2) > 0  # over axes, case, analysis, link
        found.append((closed & pounds[..., None, :]).any(axis=-1))
    return np.concatenate(found)


def _over_records(array: np.ndarray, axes: int) -> np.ndarray:
    """Mean over the motions, of what is there."""
    known = np.isfinite(array)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(known, array, 0).sum(axis=axes + 2) / known.sum(axis=axes + 2)
