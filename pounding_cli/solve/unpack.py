"""From the peaks of the kernels to those of buildings, links and columns: those of several runs at a time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pounding_cli.kernels.layout import Peaks
from pounding_cli.model.scene import Scene
from pounding_cli.solve.arrays import Arrays
from pounding_cli.solve.places import struck_columns
from pounding_cli.solve.response import ColumnResponse

OfBuilding = tuple[tuple[np.ndarray, ...], tuple[np.ndarray, np.ndarray]]
"""The fields of `BuildingResponse`, a row a run: those of every storey or floor, shape (runs, n); sway and rocking,
shape (runs,)."""

Unpacked = tuple[list[OfBuilding], tuple[np.ndarray, ...], list[ColumnResponse]]
"""Of every building; the fields of `LinkResponse`, shape (runs, links); of every run its struck columns, none where
nothing strikes columns."""


def unpack(scenes: Sequence[Scene], arrays: Arrays, drift_now: np.ndarray, peaks: Peaks) -> Unpacked:
    """Peaks by slot and link as those of buildings, links and struck columns, a row a scene. The scenes have the same
    buildings and analysis, and as many links.

    drift_now : at the end, by slot [m], shape (scenes, slots)
    """
    of_slots = (
        peaks.shear if arrays.yields else arrays.slots.stiffness * peaks.drift,  # elsewhere drifts alone are tracked
        peaks.drift,
        peaks.drift / arrays.yield_drift,
        peaks.acceleration,
        peaks.displacement_max,
        peaks.displacement_min,
        drift_now,
    )
    buildings: list[OfBuilding] = []
    for b, building in enumerate(scenes[0].buildings):
        sway, rocking = _furthest(peaks, arrays.bases[b]), _furthest(peaks, arrays.rocks[b])
        if arrays.rocks[b] >= 0:
            rocking /= float(building.elevation[-1])
        buildings.append((tuple([each[:, arrays.floors[b]] for each in of_slots]), (sway, rocking)))
    of_links = (peaks.impacts, peaks.force, peaks.closing, peaks.impulse, peaks.contact_time)
    columns = []
    if arrays.columns:
        shears = peaks.shear[:, arrays.points.shears.slot]
        columns = [columns_of(scene, *row.reshape(-1, 2).T) for scene, row in zip(scenes, shears, strict=True)]
    return buildings, tuple([each[:, : arrays.links.number] for each in of_links]), columns


def _furthest(peaks: Peaks, slot: int) -> np.ndarray:
    """Largest displacement of a slot, to either side [m], shape (scenes,); 0 of slot -1, which is none."""
    if slot < 0:
        return np.zeros(len(peaks.drift))
    return np.maximum(peaks.displacement_max[:, slot], -peaks.displacement_min[:, slot])


def columns_of(scene: Scene, below: np.ndarray, above: np.ndarray) -> ColumnResponse:
    """The response of struck columns from their largest shears below and above the blow [N], one for each link of the
    scene that asks for them."""
    columns = struck_columns(scene.links)
    if not columns:
        return ColumnResponse()
    strength = [each.share * scene.buildings[each.building].yield_shear[each.storey - 1] for each in columns]
    demand = np.maximum(below, above) / np.array(strength, float)
    demand[np.isinf(strength)] = np.nan
    return ColumnResponse(np.array([each.link for each in columns], np.int64), below, above, demand)
