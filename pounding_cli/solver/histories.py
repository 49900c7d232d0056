"""Histories: what a scene does over time, at a uniform step that has nothing to do with the solver's own steps."""

from __future__ import annotations

from typing import Any

import numpy as np

from pounding_cli.errors import InputError, Problem
from pounding_cli.model.links import link_label, link_places
from pounding_cli.model.parts import divide_scene
from pounding_cli.model.scene import Scene
from pounding_cli.solver import records
from pounding_cli.solver.layout import Layout
from pounding_cli.solver.outcome import ENDS, compute_energy_of_lines, compute_energy_of_storeys, to_closings
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
    """The times of a history [s]: from 0 in steps of `every` [s], the last not after the end of motion and tail."""
    return every * np.arange(int(np.floor(find_run_time(scene) / every + 1e-9)) + 1)


History = dict[str, tuple[tuple[str, ...], np.ndarray, dict[str, Any]]]
"""Dimensions, values and attributes of FIELDS, TWIST_FIELDS and their coordinates, by name."""


def solve_history(scene: Scene, accuracy: float = 1e-6, every: float = EVERY) -> History:
    """Run a scene from rest with Taylor steps and keep what it does, until a storey collapses if one does: FIELDS over
    the names of buildings and links (`left|right floor j`), and TWIST_FIELDS where floors twist; NaN pads buildings
    with fewer storeys and lines.

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
        raise InputError(Problem(f"the output step is {every:g} s; it must be above zero", "write e.g. `every: 2 ms`"))
    parts = divide_scene(scene)
    if parts:
        return join_histories(scene, parts, [solve_history(each.scene, accuracy, every) for each in parts])
    run = prepare_run([scene], accuracy, times=list_output_times(scene, every))
    run.integrate()
    outcome, advice = ENDS[int(run.data.run["status"][0])]
    if outcome not in OUTCOMES:
        raise InputError(Problem(f"no history of this scene: {outcome}", advice))
    return _build_history(run)


def _evaluate_ground(scene: Scene, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Acceleration [m/s2] and displacement from rest [m] of the ground, exact between samples."""
    starts, slopes = build_segments(scene)
    dt = scene.motion.dt
    velocity = np.concatenate(([0.0], np.cumsum((starts + 0.5 * slopes * dt) * dt)))
    moved = np.concatenate(([0.0], np.cumsum((velocity[:-1] + (starts / 2 + slopes * dt / 6) * dt) * dt)))
    at = np.minimum((times / dt * (1 + 1e-12)).astype(np.int64), starts.size - 1)
    since = times - dt * at
    acceleration = starts[at] + slopes[at] * since
    return acceleration, moved[at] + (velocity[at] + (starts[at] / 2 + slopes[at] * since / 6) * since) * since


def _build_history(run: SceneRun) -> History:
    """What is wanted, from what a run kept."""
    scene = run.scenes[0]
    layout = run.layout
    watch = run.data.watch
    kept = slice(0, int(run.data.run["output"][0]))  # a collapse ends it before the last time
    if int(run.data.run["status"][0]) == records.COLLAPSED:
        kept = slice(0, int(np.searchsorted(watch.times, float(run.data.run["time"][0]) * (1 - 1e-12))))
    times = watch.times[kept]
    dofs = watch.dofs[kept]
    elements = watch.elements[kept]
    energy = watch.energy[kept]
    ground, moved = _evaluate_ground(scene, times)
    u = dofs[..., 0]
    n = layout.number
    deformation = elements[:, :n, 0]
    force = elements[:, :n, 1]
    stored, yielding = compute_energy_of_storeys(layout, deformation, force, u)
    lines = elements[:, layout.of_lines]
    in_lines, in_yielding_lines = compute_energy_of_lines(layout, lines[..., 0], lines[..., 1])
    on_storeys = watch.storeys[kept].sum(axis=1)
    kinetic = 0.5 * (dofs[..., 1] ** 2 @ layout.dofs["mass"])
    of_links = elements[:, layout.of_links]

    def padded(by_dof: np.ndarray) -> np.ndarray:
        whole = np.full((times.size, len(layout.floors), max(b.storeys for b in scene.buildings)), np.nan)
        for b, span in enumerate(layout.floors):
            whole[:, b, : scene.buildings[b].storeys] = by_dof[:, span]
        return whole

    def of_foundation(places: tuple[int, ...], values: np.ndarray = u) -> np.ndarray:
        return np.stack([values[:, place] if place >= 0 else np.zeros(times.size) for place in places], axis=1)

    put_in, in_dashpots, of_all_links = (energy[:, k] for k in range(3))
    values = {
        "ground_acceleration": ground,
        "ground_displacement": moved,
        "displacement": padded(u),
        "total_acceleration": padded(dofs[..., 2]),
        "drift": padded(deformation),
        "shear": padded(force),
        "sway": of_foundation(layout.bases),
        "rocking": of_foundation(layout.feet),
        "base_force": of_foundation(layout.bases, force),
        "link_force": of_links[..., 1],
        "closing": to_closings(layout, of_links[..., 0], run.data.elements["offset"][0, layout.of_links]),
        "energy_input": put_in,
        "energy_kinetic": kinetic,
        "energy_stored": stored + in_lines,
        "energy_damping": in_dashpots,
        "energy_hysteresis": on_storeys - yielding - in_yielding_lines,
        "energy_links": of_all_links,
    }
    names = [building.name for building in scene.buildings]
    numbers = np.arange(1, values["drift"].shape[2] + 1)
    fields = FIELDS
    if layout.sums:
        fields = FIELDS | TWIST_FIELDS
        values["twist"] = _arrange_turns(layout, u)
        values["line_drift"] = _arrange_lines(layout, lines[..., 0])
        values["line_shear"] = _arrange_lines(layout, lines[..., 1])
    found: History = {
        name: (dims, values[name], {"units": unit, "long_name": text}) for name, (dims, unit, text) in fields.items()
    }
    links = np.array([link_label(names, place) for place in link_places(scene.links)], object)
    found["time"] = ("time",), times, {"units": "s", "long_name": "time since the motion began"}
    for name, each in (("building", np.array(names, object)), ("storey", numbers), ("floor", numbers), ("link", links)):
        found[name] = (name,), each, {}
    if layout.sums:
        found["line"] = ("line",), np.arange(1, layout.most_lines + 1), {}
    return found


def _arrange_turns(layout: Layout, u: np.ndarray) -> np.ndarray:
    """Return the rotations of floors [rad] from all displacements, shape (times, buildings, floors); NaN of floors that
    do not twist."""
    turns = np.full((len(u), len(layout.buildings), max(each.storeys for each in layout.buildings)), np.nan)
    for b in layout.sums:
        turns[:, b, : layout.buildings[b].storeys] = u[:, layout.turns[b]]
    return turns


def _arrange_lines(layout: Layout, values: np.ndarray) -> np.ndarray:
    """Return values of frame lines over time, shape (times, buildings, storeys, lines); NaN where there are none.

    values : in the order of `layout.lines`, shape (times, lines)
    """
    most_storeys = max(each.storeys for each in layout.buildings)
    whole = np.full((len(values), len(layout.buildings), most_storeys, layout.most_lines), np.nan)
    for place, (b, storey, number) in enumerate(layout.lines):
        whole[:, b, storey, number] = values[:, place]
    return whole
