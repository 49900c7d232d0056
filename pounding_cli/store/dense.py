"""From the rows of a plan and the responses of its scenes to dense arrays, one a variable."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from pounding_cli.model.scene import Scene
from pounding_cli.solve.response import Response
from pounding_cli.store.layout import BUILDINGS, LINKS, RECORDS, RESPONSES, SCENES, STATISTICS, Variable
from pounding_cli.store.statistics import over_records, ratio

if TYPE_CHECKING:
    from pounding_cli.study import Plan, Row

LinkPlace = tuple[int, int, int]
"""Place of the left building, its floor, the floor of the right building."""

STOREY_FIELDS = {"V": "shear", "mu": "ductility", "drift": "drift", "residual_drift": "residual_drift"}
FLOOR_FIELDS = {name: name for name in ("acceleration", "displacement_max", "displacement_min")}
LINK_FIELDS = ("impacts", "peak_force", "max_closing", "impulse", "contact_time")
ALONE = {"V0": "shear", "mu0": "ductility", "drift0": "drift", "acceleration0": "acceleration"}
RATIOS = {"V": "V0", "mu": "mu0", "acceleration": "acceleration0"}
ENERGIES = ("residual", "input", "kinetic", "stored", "damping", "hysteresis", "links")


@dataclass(frozen=True)
class Dense:
    """The arrays of a study.

    axes : dimension name of every swept axis
    sizes : size of every dimension
    links : the link dimension, place by place
    data : variable -> (dimensions, array)
    """

    axes: tuple[str, ...]
    sizes: dict[str, int]
    links: tuple[LinkPlace, ...]
    data: dict[str, tuple[tuple[str, ...], np.ndarray]]


def assemble(plan: Plan, responses: Mapping[str, Response]) -> Dense:
    """Fill every variable of the file.

    Parameters
    ----------
    plan : rows and scenes
    responses : by scene digest; every scene of the plan
    """
    axes = tuple(axis.names[0] for axis in plan.axes)
    scenes = [plan.scenes[row.scene] for row in plan.rows]
    storeys = max(b.storeys for scene in scenes for b in scene.buildings)
    links = tuple(sorted({_place(link) for scene in scenes for link in scene.links}))
    sizes = {name: len(axis.values) for name, axis in zip(axes, plan.axes, strict=True)}
    sizes |= {"case": len(plan.cases), "analysis": len(plan.analyses), "record": len(plan.records)}
    sizes |= {"building": len(plan.buildings), "storey": storeys, "floor": storeys, "link": len(links)}
    arrays = {
        v.name: _empty(v, tuple(sizes[d] for d in (*axes, *v.dims)))
        for v in (*RESPONSES, *SCENES, *LINKS, *BUILDINGS, *RECORDS)
    }
    places = {place: number for number, place in enumerate(links)}
    seen_points: set[tuple[int, ...]] = set()
    for row, scene in zip(plan.rows, scenes, strict=True):
        at = (*row.point, *_index(plan, row))
        _put_peaks(arrays, at, responses[row.scene], [responses[key] for key in row.baselines])
        _put_links(arrays, at, len(axes), scene, responses[row.scene], places)
        _put_scene(arrays, at, row, responses[row.scene])
        if row.point not in seen_points:
            seen_points.add(row.point)
            _put_buildings(arrays, row.point, scene)
            arrays["separation"][row.point] = plan.study.separations(row.point)
            _put_records(arrays, row.point, plan)
    for name, alone in RATIOS.items():
        arrays[f"{name}_ratio"][:] = ratio(arrays[name], arrays[alone])
    arrays["displacement"][:] = np.maximum(arrays["displacement_max"], -arrays["displacement_min"])
    _put_refusals(arrays, plan, responses)
    data = {v.name: ((*axes, *v.dims), arrays[v.name]) for v in (*RESPONSES, *SCENES, *LINKS)}
    data |= _without_constant_axes(axes, arrays, BUILDINGS) | _without_constant_axes(axes, arrays, RECORDS)
    data |= _statistics(axes, arrays)
    return Dense(axes, sizes, links, data)


def _place(link) -> LinkPlace:
    return link.left, link.left_floor, link.right_floor


def _empty(variable: Variable, shape: tuple[int, ...]) -> np.ndarray:
    if variable.kind == "s":
        return np.full(shape, "", dtype=object)
    return np.zeros(shape, np.int64) if variable.kind == "i" else np.full(shape, np.nan)


def _index(plan: Plan, row: Row) -> tuple[int, int, int]:
    return (
        plan.cases.index(row.case),
        plan.analyses.index(row.analysis),
        plan.records.index(row.record),
    )


def _put_peaks(arrays: dict[str, np.ndarray], at: tuple[int, ...], response: Response, alone: list[Response]) -> None:
    """Peaks of the scenes that are done; those of another leave NaN, whatever it reached."""
    for place, building in enumerate(response.buildings):
        span: tuple = (*at, place, slice(building.shear.size))
        if alone[place].status == "done":
            for name, field in ALONE.items():
                arrays[name][span] = getattr(alone[place].buildings[0], field)
        if response.status == "done":
            for name, field in (STOREY_FIELDS | FLOOR_FIELDS).items():
                arrays[name][span] = getattr(building, field)
            arrays["sway"][(*at, place)] = building.sway
            arrays["rocking"][(*at, place)] = building.rocking


def _put_links(
    arrays: dict[str, np.ndarray],
    at: tuple[int, ...],
    n_axes: int,
    scene: Scene,
    response: Response,
    places: dict[LinkPlace, int],
) -> None:
    if not scene.links:
        return
    chosen = [places[_place(link)] for link in scene.links]
    if response.status == "done":
        for name in LINK_FIELDS:
            arrays[name][at][chosen] = getattr(response.links, name)
    of_case = at[: n_axes + 1]
    arrays["kind"][of_case][chosen] = [str(link.kind) for link in scene.links]
    arrays["gap"][of_case][chosen] = [link.gap for link in scene.links]


def _put_scene(arrays: dict[str, np.ndarray], at: tuple[int, ...], row: Row, response: Response) -> None:
    arrays["scene"][at] = row.scene
    for name in ("status", "advice", "method", "tolerance", "steps", "events", "orders", "seconds"):
        arrays[name][at] = getattr(response, name)
    for name in ("error_estimate", "sensitivity"):  # measured on request only
        arrays[name][at] = getattr(response, name, np.nan)
    for name in ENERGIES:
        arrays[f"energy_{name}"][at] = response.energy.get(name, np.nan)
    for name in ("effects", "dropped", "flags"):
        arrays[name][at] = "\n".join(getattr(response, name))


def _put_buildings(arrays: dict[str, np.ndarray], point: tuple[int, ...], scene: Scene) -> None:
    for place, building in enumerate(scene.buildings):
        span: tuple = (*point, place, slice(building.storeys))
        for name in ("mass", "height", "stiffness", "yield_shear"):
            arrays[name][span] = getattr(building, name)
        arrays["period"][(*point, place)] = building.periods[0]


def _put_records(arrays: dict[str, np.ndarray], point: tuple[int, ...], plan: Plan) -> None:
    motions = plan.study.motions(point)
    for number, name in enumerate(plan.records):
        for variable in RECORDS:
            field = variable.name.removeprefix("record_")
            arrays[variable.name][(*point, number)] = getattr(motions[name].use, field)


def _put_refusals(arrays: dict[str, np.ndarray], plan: Plan, responses: Mapping[str, Response]) -> None:
    """Say in a scene's flags which of its ratios are missing and why."""
    for alone in RATIOS.values():
        zero = (arrays[alone] == 0).any(axis=(-2, -1))
        for at in zip(*np.nonzero(zero), strict=True):
            _flag(arrays["flags"], at, f"{alone} = 0: ratio refused")
    for row in plan.rows:
        for building, key in zip(plan.buildings, row.baselines, strict=True):
            if responses[key].status != "done":
                at = (*row.point, *_index(plan, row))
                _flag(arrays["flags"], at, f"{building} alone: {responses[key].status}, ratios refused")


def _flag(flags: np.ndarray, at: tuple, sentence: str) -> None:
    flags[at] = f"{flags[at]}\n{sentence}" if flags[at] else sentence


def _without_constant_axes(
    axes: tuple[str, ...], arrays: dict[str, np.ndarray], variables: tuple[Variable, ...]
) -> dict[str, tuple[tuple[str, ...], np.ndarray]]:
    """The variables without the swept axes that change none: a sweep of the gap leaves one building."""
    kept = list(axes)
    cut = {v.name: arrays[v.name] for v in variables}
    for axis in reversed(axes):
        number = kept.index(axis)
        first = {name: array.take([0], axis=number) for name, array in cut.items()}
        if all(_same(np.broadcast_to(first[name], cut[name].shape), cut[name]) for name in cut):
            cut = {name: array.take(0, axis=number) for name, array in cut.items()}
            kept.remove(axis)
    return {v.name: ((*kept, *v.dims), cut[v.name]) for v in variables}


def _same(one: np.ndarray, other: np.ndarray) -> bool:
    return np.array_equal(one, other, equal_nan=one.dtype != object)


def _statistics(axes: tuple[str, ...], arrays: dict[str, np.ndarray]) -> dict[str, tuple[tuple[str, ...], np.ndarray]]:
    found: dict[str, np.ndarray] = {}
    for ratio_name in (f"{name}_ratio" for name in RATIOS):
        found |= {
            f"{ratio_name}_{statistic}": values
            for statistic, values in over_records(arrays[ratio_name], axis=len(axes) + 2).items()
        }
    return {v.name: ((*axes, *v.dims), found[v.name]) for v in STATISTICS}
