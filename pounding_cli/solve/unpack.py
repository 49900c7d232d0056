"""From the peaks of the kernels to those of buildings, links and columns: those of several runs at a time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pounding_cli.kernels.layout import Peaks
from pounding_cli.model.scene import Scene
from pounding_cli.solve.arrays import Arrays
from pounding_cli.solve.places import struck_columns
from pounding_cli.solve.response import BuildingResponse, ColumnResponse, LinkResponse

Unpacked = tuple[tuple[BuildingResponse, ...], LinkResponse, ColumnResponse]

_NO_COLUMNS = ColumnResponse()


def unpack(scenes: Sequence[Scene], arrays: Arrays, drift_now: np.ndarray, peaks: Peaks) -> list[Unpacked]:
    """Peaks by slot and link, a row a scene, as responses by building, link and struck column, which share their
    memory. The scenes have the same buildings and analysis, and as many links.

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
    buildings = []
    for b, building in enumerate(scenes[0].buildings):
        rows = zip(*[each[:, arrays.floors[b]] for each in of_slots], strict=True)
        if building.foundation is None:
            buildings.append([BuildingResponse(*row) for row in rows])
            continue
        sway, rocking = _furthest(peaks, arrays.bases[b]), _furthest(peaks, arrays.rocks[b])
        moving = zip(rows, sway.tolist(), (rocking / float(building.elevation[-1])).tolist(), strict=True)
        buildings.append([BuildingResponse(*row, *moved) for row, *moved in moving])
    of_links = (peaks.impacts, peaks.force, peaks.closing, peaks.impulse, peaks.contact_time)
    links = [LinkResponse(*row) for row in zip(*[each[:, : arrays.links.number] for each in of_links], strict=True)]
    columns = [_NO_COLUMNS] * len(scenes)
    if arrays.columns:
        shears = peaks.shear[:, arrays.points.shears.slot]
        columns = [columns_of(scene, *row.reshape(-1, 2).T) for scene, row in zip(scenes, shears, strict=True)]
    return list(zip(zip(*buildings, strict=True), links, columns, strict=True))


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
        return _NO_COLUMNS
    strength = [each.share * scene.buildings[each.building].yield_shear[each.storey - 1] for each in columns]
    demand = np.maximum(below, above) / np.array(strength, float)
    demand[np.isinf(strength)] = np.nan
    return ColumnResponse(np.array([each.link for each in columns], np.int64), below, above, demand)
