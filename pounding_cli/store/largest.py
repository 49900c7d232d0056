"""The largest values of a results file, each with its place: what a reader of a study asks for first."""

from __future__ import annotations

from dataclasses import dataclass

import h5py
import numpy as np

from pounding_cli.solver.flags import is_meaningless
from pounding_cli.store.structure import strings
from pounding_cli.store.swept import pieces

SHOWN = {
    "elastic": ("V_ratio", "drift_ratio", "shear_demand"),
    "inelastic": ("mu", "mu_ratio", "drift_ratio", "shear_demand"),
}
"""Of what the largest value is told, by analysis."""


@dataclass(frozen=True)
class Largest:
    """The largest value of a quantity over storeys, motions and points of the sweep, in one case and analysis.

    quantity : a variable of the file; of `shear_demand` only columns that were struck count
    value : [-]; NaN where there is none, and the rest says nothing
    storey : from 1
    point : number of the point of the sweep, the last axis fastest, among those looked at
    meaningless : whether a flag takes the meaning from the numbers of the scene
    """

    case: str
    analysis: str
    quantity: str
    value: float
    building: str = ""
    storey: int = 0
    record: str = ""
    point: int = 0
    meaningless: bool = False


def largest_values(file: h5py.File, lead: tuple[int | slice, ...]) -> list[Largest]:
    """The largest value of every quantity of SHOWN that the file has, case by case and analysis by analysis.

    lead : what is looked at of every swept axis
    """
    cases, analyses = (list(strings(file[name])) for name in ("case", "analysis"))
    asked = dict.fromkeys(name for analysis in analyses for name in SHOWN[analysis] if name in file)
    found = {name: _found(file, name, lead) for name in asked}
    told = []
    for c, case in enumerate(cases):
        for a, analysis in enumerate(analyses):
            for name in SHOWN[analysis]:
                if name in found:
                    values, places = found[name]
                    told.append(_told(file, lead, (case, analysis, name), (c, a), values[c, a], places[c, a]))
    return told


def _found(file: h5py.File, name: str, lead: tuple[int | slice, ...]) -> tuple[np.ndarray, np.ndarray]:
    """The largest value by case and analysis (-inf where there is none) and where: point, record and level, an index
    each; shapes (cases, analyses) and (cases, analyses, indices)."""
    data, begin = file[name], 0
    struck = pieces(file["impacts"], lead) if name == "shear_demand" else None
    best: np.ndarray | None = None
    for piece in pieces(data, lead):
        values = np.where(np.isfinite(piece), piece, -np.inf)
        if struck is not None:
            values[~(next(struck) > 0)] = -np.inf
        values = np.moveaxis(values, 0, 2)  # case, analysis, point, record, ...
        flat = values.reshape(*values.shape[:2], -1)
        place = np.stack(np.unravel_index(flat.argmax(axis=-1), values.shape[2:]), axis=-1)
        place[..., 0] += begin
        begin += len(piece)
        if best is None:
            best, where = flat.max(axis=-1), place
        else:
            where = np.where((flat.max(axis=-1) > best)[..., None], place, where)
            best = np.maximum(best, flat.max(axis=-1))
    assert best is not None  # an axis has a point
    return best, where


def _told(
    file: h5py.File,
    lead: tuple[int | slice, ...],
    names: tuple[str, str, str],
    at: tuple[int, int],
    value: float,
    place: np.ndarray,
) -> Largest:
    """One of them, its place in words."""
    if value == -np.inf:
        return Largest(*names, np.nan)
    point, record, *level = place.tolist()
    if names[-1] == "shear_demand":
        building, storey = _columns(file, level[0])
    else:
        building, storey = strings(file["building"])[level[0]], level[1] + 1
    sizes = [size for size, taken in zip(file["flags"].shape, lead, strict=False) if isinstance(taken, slice)]
    indices = iter(np.unravel_index(point, sizes) if sizes else ())
    there = tuple(int(next(indices)) if isinstance(taken, slice) else taken for taken in lead)
    flags = file["flags"].asstr()[(*there, *at, record)]
    worthless = any(map(is_meaningless, flags.splitlines()))
    return Largest(*names, float(value), building, storey, strings(file["record"])[record], point, worthless)


def _columns(file: h5py.File, link: int) -> tuple[str, int]:
    """Building and storey of the columns that a link strikes."""
    side = "left" if ", left" in strings(file["link"])[link] else "right"
    floor = "link_floor" if side == "left" else "link_right_floor"
    return strings(file[f"link_{side}"])[link], int(file[floor][link])
