"""Histories: a scene over time, at a uniform output step that has nothing to do with the solver's own steps."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from pounding_cli.errors import InputError
from pounding_cli.model.links import link_label, link_places
from pounding_cli.model.parts import divide_scene
from pounding_cli.model.scene import Scene
from pounding_cli.solver import records
from pounding_cli.solver.balance import compute_energy_of_lines, compute_energy_of_storeys
from pounding_cli.solver.layout import Layout
from pounding_cli.solver.outcome import ENDS, to_closings
from pounding_cli.solver.parts import join_histories
from pounding_cli.solver.response import OUTCOMES
from pounding_cli.solver.segments import build_segments, find_run_time
from pounding_cli.solver.solve import SceneRun, prepare_run

EVERY = 0.002
"""Output step unless asked otherwise [s]: contacts last some 5 to 20 ms."""

FIELDS: dict[str, tuple[tuple[str, ...], str, str]] = {
    "ground_acceleration": (("time",), "m/s2", "ground acceleration"),
    "ground_displacement": (("time",), "m", "ground acceleration integrated twice from rest, no baseline correction"),
    "displacement": (("time", "building", "floor"), "m", "floor displacement relative to the ground"),
    "total_acceleration": (("time", "building", "floor"), "m/s2", "floor acceleration, ground included"),
    "drift": (("time", "building", "storey"), "m", "storey drift"),
    "shear": (("time", "building", "storey"), "N", "storey shear, without damping force"),
    "sway": (("time", "building"), "m", "translation of the foundation"),
    "rocking": (("time", "building"), "rad", "rotation of the foundation"),
    "base_force": (("time", "building"), "N", "force of springs or isolators under the base, without damping force"),
    "link_force": (("time", "link"), "N", "link force, pulling negative"),
    "closing": (("time", "link"), "m", "closing of the two ends of a link, gap not subtracted"),
    "energy_input": (("time",), "J", "energy put in by the ground so far"),
    "energy_kinetic": (("time",), "J", "kinetic energy"),
    "energy_stored": (("time",), "J", "elastic energy in storeys and foundations"),
    "energy_damping": (("time",), "J", "energy lost in structural damping so far"),
    "energy_hysteresis": (("time",), "J", "energy lost in yielding storeys so far"),
    "energy_links": (("time",), "J", "energy the links took so far, stored or lost"),
}
"""Variable -> dimensions, unit, meaning."""

TWIST_FIELDS: dict[str, tuple[tuple[str, ...], str, str]] = {
    "twist": (("time", "building", "floor"), "rad", "floor rotation about the vertical axis at its centre of mass"),
    "line_drift": (("time", "building", "storey", "line"), "m", "drift of a frame line, in its plane"),
    "line_shear": (("time", "building", "storey", "line"), "N", "shear of a frame line, without damping force"),
}
"""Those of floors that twist; a scene where none does has none of them."""


def list_output_times(scene: Scene, every: float) -> np.ndarray:
    """Return the times of a history [s]: from 0 in steps of `every` [s] up to the end of motion and tail."""
    return every * np.arange(int(np.floor(find_run_time(scene) / every + 1e-9)) + 1)


History = dict[str, tuple[tuple[str, ...], np.ndarray, dict[str, Any]]]
"""Dimensions, values and attributes of FIELDS, TWIST_FIELDS and their coordinates, by name."""


def solve_history(scene: Scene, accuracy: float = 1e-6, every: float = EVERY) -> History:
    """Return what a scene does from rest, by Taylor steps, until a storey collapses if one does.

    It has FIELDS over the names of buildings and links (`left|right floor j`), and TWIST_FIELDS where floors twist; NaN
    pads buildings with fewer storeys and lines.

    Parameters
    ----------
    scene : in SI units
    accuracy : as in `solve` [-]
    every : output step [s], > 0

    Raises
    ------
    InputError : the output step is not above zero; the run did not end, and why
    """
    if not (np.isfinite(every) and every > 0):
        raise InputError(f"the output step is {every:g} s; it must be above zero", "write e.g. `every: 2 ms`")
    parts = divide_scene(scene)
    if parts:
        return join_histories(scene, parts, [solve_history(each.scene, accuracy, every) for each in parts])
    run = prepare_run([scene], accuracy, times=list_output_times(scene, every))
    run.integrate()
    outcome, advice = ENDS[int(run.data.run["status"][0])]
    if outcome not in OUTCOMES:
        raise InputError(f"no history of this scene: {outcome}", advice)
    return _build_history(run)


def _evaluate_ground(scene: Scene, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return acceleration [m/s2] and displacement from rest [m] of the ground at times [s], exact between samples."""
    starts, slopes = build_segments(scene)
    dt = scene.motion.dt
    velocity = np.concatenate(([0.0], np.cumsum((starts + 0.5 * slopes * dt) * dt)))
    displacement = np.concatenate(([0.0], np.cumsum((velocity[:-1] + (starts / 2 + slopes * dt / 6) * dt) * dt)))
    segment = np.minimum((times / dt * (1 + 1e-12)).astype(np.int64), starts.size - 1)
    since = times - dt * segment
    jerk = slopes[segment]
    start = starts[segment]
    moved_since = (velocity[segment] + (start / 2 + jerk * since / 6) * since) * since
    return start + jerk * since, displacement[segment] + moved_since


def _build_history(run: SceneRun) -> History:
    """Return the history of the one scene of a run, from what the run kept."""
    scene = run.scenes[0]
    layout = run.layout
    times = run.data.watch.times[_find_span(run)]
    fields = FIELDS | TWIST_FIELDS if layout.sums else FIELDS
    values = _build_values(run)
    history: History = {
        name: (dims, values[name], {"units": unit, "long_name": text}) for name, (dims, unit, text) in fields.items()
    }
    names = [building.name for building in scene.buildings]
    links = [link_label(names, place) for place in link_places(scene.links)]
    storeys = np.arange(1, _count_storeys(layout) + 1)
    history["time"] = ("time",), times, {"units": "s", "long_name": "time since the motion began"}
    history["building"] = ("building",), np.array(names, object), {}
    history["storey"] = ("storey",), storeys, {}
    history["floor"] = ("floor",), storeys, {}
    history["link"] = ("link",), np.array(links, object), {}
    if layout.sums:
        history["line"] = ("line",), np.arange(1, layout.most_lines + 1), {}
    return history


def _find_span(run: SceneRun) -> slice:
    """Return the output times that a run has reached, as a slice: a collapse ends it before the last of them."""
    if int(run.data.run["status"][0]) == records.COLLAPSED:
        end = float(run.data.run["time"][0])
        return slice(0, int(np.searchsorted(run.data.watch.times, end * (1 - 1e-12))))
    return slice(0, int(run.data.run["output"][0]))


def _build_values(run: SceneRun) -> dict[str, np.ndarray]:
    """Return the values of all fields over time, those of TWIST_FIELDS where floors twist."""
    scene = run.scenes[0]
    layout = run.layout
    watch = run.data.watch
    span = _find_span(run)
    u = watch.dofs[span, :, 0]
    velocity = watch.dofs[span, :, 1]
    acceleration = watch.dofs[span, :, 2]
    deformation = watch.elements[span, :, 0]
    force = watch.elements[span, :, 1]
    storeys = slice(0, layout.number)
    lines = layout.of_lines
    links = layout.of_links
    ground_acceleration, ground_displacement = _evaluate_ground(scene, watch.times[span])
    stored, yielding = compute_energy_of_storeys(layout, deformation[:, storeys], force[:, storeys], u)
    in_lines, in_yielding_lines = compute_energy_of_lines(layout, deformation[:, lines], force[:, lines])
    values = {
        "ground_acceleration": ground_acceleration,
        "ground_displacement": ground_displacement,
        "displacement": _arrange_floors(layout, u),
        "total_acceleration": _arrange_floors(layout, acceleration),
        "drift": _arrange_floors(layout, deformation),
        "shear": _arrange_floors(layout, force),
        "sway": _arrange_bases(layout.bases, u),
        "rocking": _arrange_bases(layout.feet, u),
        "base_force": _arrange_bases(layout.bases, force),
        "link_force": force[:, links],
        "closing": to_closings(layout, deformation[:, links], run.data.elements["offset"][0, links]),
        "energy_input": watch.energy[span, 0],
        "energy_kinetic": 0.5 * (velocity**2 @ layout.dofs["mass"]),
        "energy_stored": stored + in_lines,
        "energy_damping": watch.energy[span, 1],
        "energy_hysteresis": watch.storeys[span].sum(axis=1) - yielding - in_yielding_lines,
        "energy_links": watch.energy[span, 2],
    }
    if layout.sums:
        values["twist"] = _arrange_turns(layout, u)
        values["line_drift"] = _arrange_lines(layout, deformation[:, lines])
        values["line_shear"] = _arrange_lines(layout, force[:, lines])
    return values


def _count_storeys(layout: Layout) -> int:
    """Return the most storeys of a building."""
    return max(building.storeys for building in layout.buildings)


def _arrange_floors(layout: Layout, values: np.ndarray) -> np.ndarray:
    """Return values of floors, or of the storeys below them, over time, shape (times, buildings, floors).

    values : of degrees of freedom or elements, shape (times, those)
    """
    whole = np.full((len(values), len(layout.buildings), _count_storeys(layout)), np.nan)
    for number, floors in enumerate(layout.floors):
        whole[:, number, : layout.buildings[number].storeys] = values[:, floors]
    return whole


def _arrange_bases(places: Sequence[int], values: np.ndarray) -> np.ndarray:
    """Return values of bases over time, shape (times, buildings); 0 of those that do not move.

    places : of the bases among the values, -1 of those that do not move
    """
    nothing = np.zeros(len(values))
    return np.stack([values[:, place] if place >= 0 else nothing for place in places], axis=1)


def _arrange_turns(layout: Layout, u: np.ndarray) -> np.ndarray:
    """Return the rotations of floors over time [rad], shape (times, buildings, floors); NaN of those that do not twist.

    u : displacements and rotations, shape (times, degrees of freedom)
    """
    whole = np.full((len(u), len(layout.buildings), _count_storeys(layout)), np.nan)
    for number in layout.sums:
        whole[:, number, : layout.buildings[number].storeys] = u[:, layout.turns[number]]
    return whole


def _arrange_lines(layout: Layout, values: np.ndarray) -> np.ndarray:
    """Return values of frame lines over time, shape (times, buildings, storeys, lines); NaN where there are none.

    values : in the order of `layout.lines`, shape (times, lines)
    """
    whole = np.full((len(values), len(layout.buildings), _count_storeys(layout), layout.most_lines), np.nan)
    for place, (building, storey, number) in enumerate(layout.lines):
        whole[:, building, storey, number] = values[:, place]
    return whole
