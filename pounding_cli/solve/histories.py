"""Histories: what a scene does over time, at a uniform step that has nothing to do with the solver's own steps.

The ground acceleration is a straight line between samples, so a run may be stopped at any output time and continued
from its state without loss. Forces and accelerations then follow from the states by eqs (1)-(10), each storey and
link on the branch it is on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pounding_cli.errors import InputError, Problem
from pounding_cli.kernels import layout
from pounding_cli.kernels.history import History as Entered
from pounding_cli.model.condense import condensed
from pounding_cli.model.links import link_label, link_places
from pounding_cli.model.scene import Scene
from pounding_cli.solve import law_tables, taylor
from pounding_cli.solve.arrays import Arrays, at_rest, pack
from pounding_cli.solve.elements import elements_of, term_matrix
from pounding_cli.solve.ground import segments
from pounding_cli.solve.read import OUTCOMES
from pounding_cli.solve.run import MAX_EVENTS, MAX_STEPS
from pounding_cli.solve.storeys import shear_and_stored

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
    link_force: np.ndarray
    energy: dict[str, np.ndarray]
    buildings: tuple[str, ...]
    links: tuple[str, ...]
    closing: np.ndarray | None = None


def output_times(scene: Scene, every: float) -> np.ndarray:
    """The times of a history [s]: from 0 in steps of `every` [s], the last not after the end of motion and tail."""
    starts, _, dt = segments(scene)
    return every * np.arange(int(np.floor(starts.size * dt / every + 1e-9)) + 1)


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
    scene, _ = condensed(scene, accuracy)
    arrays = pack(scene)
    times = output_times(scene, every)
    states = _march(scene, arrays, times, accuracy)
    return _evaluated(scene, arrays, times[: len(states.u)], states)


def _march(scene: Scene, arrays: Arrays, times: np.ndarray, accuracy: float) -> Entered:
    """The states at `times`, each run from one output time or sample of the motion to the next."""
    state, peaks, ledger, _ = at_rest(arrays)
    outputs, begins, rates, lengths = _pieces(scene, times)
    wanted = ("u", "v", "storey_branch", "storey_memory", "link_branch", "link_memory")
    kept = (np.repeat(getattr(state, name)[None], times.size, axis=0) for name in wanted)
    states = Entered(lengths.size, lengths, outputs, *kept, work=np.zeros((times.size, 4)))  # type: ignore[misc]
    run = taylor.prepare(scene, arrays, state, accuracy, (MAX_STEPS, MAX_EVENTS))
    status, *_, reached = run(state, peaks, ledger, begins, rates, 0.0, states)
    if status == layout.COLLAPSED:
        before = int(np.searchsorted(times, reached * (1 - 1e-12)))  # output times before it
        return states._replace(**{name: getattr(states, name)[:before] for name in (*wanted, "work")})
    if status != layout.DONE:
        outcome, advice = OUTCOMES[status]
        raise InputError(Problem(f"no history of this scene: {outcome}", advice))
    return states


def _pieces(scene: Scene, times: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """(output time that ends it or -1, acceleration at its start [m/s2], slope [m/s3], length [s]) of every straight
    piece of ground between neighbouring samples and output times."""
    starts, slopes, dt = segments(scene)
    samples = dt * np.arange(starts.size + 1)
    after = np.clip(np.searchsorted(times, samples), 1, times.size - 1)
    near = np.minimum(np.abs(samples - times[after - 1]), np.abs(samples - times[after]))
    between = samples[(near > 1e-6 * dt) & (samples < times[-1])]  # the others are output times
    cuts = np.concatenate((times, between))
    outputs = np.concatenate((np.arange(times.size), np.full(between.size, -1)))
    order = np.argsort(cuts)
    cuts, outputs = cuts[order], outputs[order]
    segment = np.minimum((0.5 * (cuts[:-1] + cuts[1:]) / dt).astype(np.int64), starts.size - 1)
    begins = starts[segment] + slopes[segment] * (cuts[:-1] - dt * segment)
    return outputs[1:].copy(), begins, slopes[segment], np.diff(cuts)


def _ground(scene: Scene, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Acceleration [m/s2] and displacement from rest [m] of the ground, exact between samples."""
    starts, slopes, dt = segments(scene)
    velocity = np.concatenate(([0.0], np.cumsum((starts + 0.5 * slopes * dt) * dt)))
    moved = np.concatenate(([0.0], np.cumsum((velocity[:-1] + (starts / 2 + slopes * dt / 6) * dt) * dt)))
    at = np.minimum((times / dt * (1 + 1e-12)).astype(np.int64), starts.size - 1)
    since = times - dt * at
    acceleration = starts[at] + slopes[at] * since
    return acceleration, moved[at] + (velocity[at] + (starts[at] / 2 + slopes[at] * since / 6) * since) * since


def _evaluated(scene: Scene, arrays: Arrays, times: np.ndarray, s: Entered) -> History:
    """What is wanted, from the states; the link branches say whether a link acts, also where it pulls at v' < 0."""
    elements, size = elements_of(arrays), arrays.padded
    terms = term_matrix(elements)
    ground, moved = _ground(scene, times)
    deformed, rate = s.u @ terms.T, s.v @ terms.T
    shear, stored = shear_and_stored(arrays, deformed[:, :size], s.storey_branch, s.storey_memory)
    springs, damped = slice(size, elements.springs), slice(elements.springs)
    force = np.empty_like(deformed)
    force[:, :size] = shear
    force[:, springs] = elements.stiffness[springs] * deformed[:, springs]
    force[:, damped] += elements.dashpot * rate[:, damped]
    links = force[:, elements.springs :]
    for e in range(arrays.links.number):
        v = deformed[:, elements.springs + e] - arrays.links.offset[e]
        on = s.link_branch[:, e], v, rate[:, elements.springs + e], s.link_memory[:, e]
        links[:, e] = law_tables.force_over_time(arrays.links, *on)
    acceleration = -(force @ terms + elements.drag * s.v) * elements.inverse_mass
    kinetic = 0.5 * (s.v**2 @ arrays.slots.mass)
    stored += 0.5 * (deformed[:, springs] ** 2 @ elements.stiffness[springs])

    def padded(by_slot: np.ndarray) -> np.ndarray:
        whole = np.full((times.size, len(arrays.floors), max(b.storeys for b in scene.buildings)), np.nan)
        for b, span in enumerate(arrays.floors):
            whole[:, b, : scene.buildings[b].storeys] = by_slot[:, span]
        return whole

    def of_foundation(slots: tuple[int, ...]) -> np.ndarray:
        return np.stack([s.u[:, slot] if slot >= 0 else np.zeros(times.size) for slot in slots], axis=1)

    names = tuple(building.name for building in scene.buildings)
    return History(
        time=times,
        ground_acceleration=ground,
        ground_displacement=moved,
        displacement=padded(s.u),
        total_acceleration=padded(acceleration),
        drift=padded(deformed[:, :size]),
        shear=padded(shear),
        sway=of_foundation(arrays.bases),
        rocking=of_foundation(arrays.rocks) / [building.elevation[-1] for building in scene.buildings],
        link_force=links,
        energy=dict(zip(ENERGIES, (s.work[:, 0], kinetic, stored, *s.work[:, 1:].T), strict=True)),
        buildings=names,
        links=tuple(link_label(names, place) for place in link_places(scene.links)),
        closing=deformed[:, elements.springs :],
    )


def link_ends(buildings: Sequence[str], links: Sequence[str]) -> list[tuple[int, int, int]]:
    """Of links in words as `History.links` has them: the place of the left building from 0, its floor from 1, and the
    floor of the building to its right."""
    ends = []
    for label in links:
        for left in range(len(buildings) - 1):
            start = f"{buildings[left]}|{buildings[left + 1]} floor "
            if label.startswith(start):
                floors = label.removeprefix(start).split(",")[0].split("|")
                ends.append((left, int(floors[0]), int(floors[-1])))
                break
    return ends
