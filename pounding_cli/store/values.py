"""What the names, coordinates and building data of a results file may be: tables and pages rely on them.

The numbers of the scenes may be anything: they are shown, and nothing is found by them.
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence

import h5py
import numpy as np

from pounding_cli.model.links import APART
from pounding_cli.store.structure import check_structure, refused

ANALYSES = ("elastic", "inelastic")

PIECE = 1 << 16
"""Values read at a time: a million points have five million links, and each text takes some 150 bytes."""


def check_study(file: h5py.File) -> None:
    """Refuse a results file whose parts, names and coordinates do not fit together.

    Raises
    ------
    InputError : what does not fit, and where
    """
    swept = check_structure(file)
    for dim in ("storey", "floor"):
        if not np.array_equal(file[dim][()], np.arange(1, file[dim].size + 1)):
            raise refused(dim, "does not count from 1")
    for name in (name for names in swept for name in names):
        if file[name].dtype.kind != "O" and not np.isfinite(file[name][()]).all():
            raise refused(name, "is not finite")
    if not set(file["analysis"].asstr()[:]) <= set(ANALYSES):
        raise refused("analysis", f"is not one of {', '.join(ANALYSES)}")
    _check_names(file, swept)
    _check_buildings(file)
    if "link" in file:
        _check_places_of_links(file)


def _check_names(file: h5py.File, swept: Sequence[Sequence[str]]) -> None:
    """Refuse names that stand twice or are not those of the study."""
    resolved = json.loads(file["study/resolved"].asstr()[()])
    is_swept = {name.split(".")[0] for names in swept for name in names}
    for dim, key in (("building", "places"), ("case", "cases"), ("analysis", ""), ("record", "")):
        names = file[dim].asstr()[:].tolist()
        if len(set(names)) != len(names):
            raise refused(dim, "names one twice")
        if key in resolved and "group" not in is_swept and set(names) != set(resolved[key]):
            raise refused(dim, "is not that of its study")


def _check_buildings(file: h5py.File) -> None:
    """Refuse storeys without a mass, a height or a stiffness, and buildings without a period."""
    mass = file["mass"][()]
    there = ~np.isnan(mass)  # NaN: the building has fewer storeys
    for name in ("mass", "height", "stiffness"):
        values = file[name][()]
        if values.shape == mass.shape and not _positive(values[there]):
            raise refused(name, "is not positive and finite")
    period = file["period"][()]
    if period.shape == mass.shape[:-1] and not _positive(period[there.any(axis=-1)]):
        raise refused("period", "is not positive and finite")


def _positive(values: np.ndarray) -> bool:
    return bool(np.all((values > 0) & (values < np.inf)))


def _check_places_of_links(file: h5py.File) -> None:
    """Refuse links between buildings that do not stand side by side, or at floors that are none."""
    side_by_side = {*zip(buildings := file["building"].asstr()[:].tolist(), buildings[1:], strict=False)}
    left, right = (file[f"link_{side}"].asstr()[:] for side in ("left", "right"))
    if not {*zip(left.tolist(), right.tolist(), strict=True)} <= side_by_side:
        raise refused("link_left and link_right", "name no neighbours")
    for name in ("link_floor", "link_right_floor"):
        if not np.isin(file[name][()], file["floor"][()]).all():
            raise refused(name, "is not a floor")
    kinds, gaps = file["kind"], file["gap"]
    step = max(1, PIECE // max(1, math.prod(kinds.shape[1:])))
    for begin in range(0, kinds.shape[0] if gaps.shape == kinds.shape else 0, step):
        kind, gap = kinds.asstr()[begin : begin + step], gaps[begin : begin + step]
        if not np.isfinite(gap[(kind != "") & (kind != APART)]).all():
            raise refused("gap", "is not finite")
