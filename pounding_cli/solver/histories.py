"""Histories: what a scene does over time, at a uniform step that has nothing to do with the solver's own steps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pounding_cli.errors import InputError, Problem
from pounding_cli.model.links import link_label, link_places
from pounding_cli.model.scene import Scene
from pounding_cli.solver import records
from pounding_cli.solver.assemble import segments
from pounding_cli.solver.outcome import ENDS, stored_in_storeys
from pounding_cli.solver.solve import Prepared, prepare

EVERY = 0.002
"""Output step unless asked otherwise [s]: contacts last some 5 to 20 ms."""

ENERGIES = ("input", "kinetic", "stored", "damping", "hysteresis", "links")


@dataclass(frozen=True, eq=False)
class History:
    """A scene over time; n buildings of up to s storeys, m links, t times. NaN pads buildings with fewer storeys.

    time : (t,) from 0 in equal steps [s]
    ground_acceleration : (t,) [m/s2]
    ground_displacement : (t,) the acceleration integrated twice from rest, without a baseline correction [m]
    displacement : (t, n, s) of floors, relative to the ground [m]
    total_acceleration : (t, n, s) of floors, ground included [m/s2]
    drift : (t, n, s) of storeys, without what sway and rocking of the foundation add [m]
    shear : (t, n, s) restoring force of storeys, without damping force [N]
    sway, rocking : (t, n) displacement [m] and rotation [rad] of the foundation, 0 on a fixed base
    base_force : (t, n) force of what is under a base, isolators included, without damping force [N]; 0 on a fixed base
    link_force : (t, m) [N]; pulling is negative; NaN where the scene has no such link
    energy : by ENERGIES, (t,) [J]: put in by the ground so far; kinetic and stored in storeys and foundations now;
        lost in dashpots of the structure and in yielding so far; what the links took, stored or lost. The first is
        the sum of the others.
    buildings, links : names, left to right; `left|right floor j`
    closing : (t, m) of the two ends of every link, gap not subtracted [m], NaN where the scene has no such link; None
        where a file of before does not tell it
    """

    time: np.ndarray
    ground_acceleration: np.ndarray
    ground_displacement: np.ndarray
    displacement: np.ndarray
    total_acceleration: np.ndarray
    drift: np.ndarray
    shear: np.ndarray
    sway: np.ndarray
    rocking: np.ndarray
    base_force: np.ndarray
    link_force: np.ndarray
    energy: dict[str, np.ndarray]
    buildings: tuple[str, ...]
    links: tuple[str, ...]
    closing: np.ndarray | None = None


def output_times(scene: Scene, every: float) -> np.ndarray:
    """The times of a history [s]: from 0 in steps of `every` [s], the last not after the end of motion and tail."""
    whole = segments(scene)[0].size * scene.motion.dt
    return every * np.arange(int(np.floor(whole / every + 1e-9)) + 1)


def history(scene: Scene, accuracy: float = 1e-6, every: float = EVERY) -> History:
    """Run a scene from rest with Taylor steps and keep what it does, until a storey collapses if one does.

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
    run = prepare(scene, accuracy, times=output_times(scene, every))
    run.integrate()
    if not run.is_done:
        outcome, advice = ENDS[int(run.data.run["status"][0])]
        raise InputError(Problem(f"no history of this scene: {outcome}", advice))
    return _evaluated(run)


def _ground(scene: Scene, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Acceleration [m/s2] and displacement from rest [m] of the ground, exact between samples."""
    starts, slopes = segments(scene)
    dt = scene.motion.dt
    velocity = np.concatenate(([0.0], np.cumsum((starts + 0.5 * slopes * dt) * dt)))
    moved = np.concatenate(([0.0], np.cumsum((velocity[:-1] + (starts / 2 + slopes * dt / 6) * dt) * dt)))
    at = np.minimum((times / dt * (1 + 1e-12)).astype(np.int64), starts.size - 1)
    since = times - dt * at
    acceleration = starts[at] + slopes[at] * since
    return acceleration, moved[at] + (velocity[at] + (starts[at] / 2 + slopes[at] * since / 6) * since) * since


def _evaluated(run: Prepared) -> History:
    """What is wanted, from what a run kept."""
    scene, layout, watch = run.scene, run.layout, run.data.watch
    kept = slice(0, int(run.data.run["output"][0]))  # a collapse ends it before the last time
    if int(run.data.run["status"][0]) == records.COLLAPSED:
        kept = slice(0, int(np.searchsorted(watch.times, float(run.data.run["time"][0]) * (1 - 1e-12))))
    times, dofs, elements, energy = watch.times[kept], watch.dofs[kept], watch.elements[kept], watch.energy[kept]
    ground, moved = _ground(scene, times)
    u, n = dofs[..., 0], layout.number
    deformation, force = elements[:, :n, 0], elements[:, :n, 1]
    stored, yielding = stored_in_storeys(layout, deformation, force, u)
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

    names = tuple(building.name for building in scene.buildings)
    return History(
        time=times,
        ground_acceleration=ground,
        ground_displacement=moved,
        displacement=padded(u),
        total_acceleration=padded(dofs[..., 2]),
        drift=padded(deformation),
        shear=padded(force),
        sway=of_foundation(layout.bases),
        rocking=of_foundation(layout.feet),
        base_force=of_foundation(layout.bases, force),
        link_force=of_links[..., 1],
        energy=dict(
            zip(
                ENERGIES,
                (energy[:, 0], kinetic, stored, energy[:, 1], on_storeys - yielding, energy[:, 2]),
                strict=True,
            )
        ),
        buildings=names,
        links=tuple(link_label(names, place) for place in link_places(scene.links)),
        closing=of_links[..., 0] + run.data.elements["offset"][layout.of_links],
    )
