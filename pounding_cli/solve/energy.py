"""The energy ledger of runs: what came in, where it is, where it went, and what is missing.

States and peaks have a row for each run, ledgers a sum (`arrays.Ended`); the runs share buildings and analysis, and
have as many links."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pounding_cli.kernels.layout import Peaks, State
from pounding_cli.kernels.ledger import Ledger
from pounding_cli.model.scene import Scene
from pounding_cli.solve.arrays import Arrays, with_points
from pounding_cli.solve.storeys import shear_and_stored

Held = tuple[float, float, float]
"""What a scene holds [J]: kinetic energy, that stored in storeys and foundations, that stored in links."""

AT_REST: Held = (0.0, 0.0, 0.0)


def held(
    scenes: Sequence[Scene], runs: Sequence[Arrays], state: State, drift: np.ndarray, ledger: Ledger | None = None
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Energy in the scenes now [J], shape (runs,) each: kinetic, stored in storeys and foundations less what their
    weights have lost by leaning (P-Delta), stored in links. What storeys hold is in the ledger of a run that has come
    to this state; `drift` as of `drift_of` [m]."""
    arrays = runs[0]
    kinetic = 0.5 * _dots(arrays.slots.mass, state.v**2)
    if not arrays.yields:
        stored = np.add.reduce(0.5 * (arrays.slots.stiffness * drift) * drift, axis=1)
    elif ledger is None:
        stored = shear_and_stored(arrays, drift, state.storey_branch, state.storey_memory)[1]
    else:
        stored = ledger.stored
    if arrays.springs.number:
        springs = np.sum(arrays.springs.weight * state.u[:, arrays.springs.freedom], axis=1)
        stored = stored + 0.5 * _dots(arrays.springs.stiffness, springs**2)
    if arrays.leans:
        below = np.concatenate((np.zeros((len(scenes), 1)), state.u[:, :-1]), axis=1)
        leans = state.u - arrays.slots.couple * below
        stored = stored - 0.5 * _dots(arrays.slots.geometric, leans**2)
    return kinetic, stored, _in_links(scenes, runs, state)


def _dots(weights: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """The product of `weights` with every row."""
    return np.array([weights @ row for row in rows])


def _in_links(scenes: Sequence[Scene], runs: Sequence[Arrays], state: State) -> np.ndarray:
    """Energy in all links of each scene [J]."""
    links = runs[0].links
    count = links.number
    if not count:
        return np.zeros(len(scenes))
    u = with_points(runs[0], state.u)
    closings = u[:, links.left[:count]] - u[:, links.right[:count]]
    found = np.zeros(len(scenes))
    below = np.array([arrays.empty_below for arrays in runs])
    for row in np.flatnonzero(~(closings <= below).all(axis=1)).tolist():  # the others hold nothing
        memory, first = state.link_memory[row, :count].tolist(), runs[row].links.first[:count]
        branches = (state.link_branch[row, :count] - first).tolist()
        each = zip(scenes[row].links, branches, closings[row].tolist(), memory, strict=True)
        found[row] = float(sum([link.law.held(*of) for link, *of in each]))
    return found


def balance(
    scenes: Sequence[Scene],
    runs: Sequence[Arrays],
    before: Sequence[Held],
    state: State,
    drift: np.ndarray,
    peaks: Peaks,
    ledger: Ledger,
) -> dict[str, np.ndarray]:
    """The ledgers [J], shape (runs,) each; `residual` is what is missing over the largest entry [-], or over what
    storeys held at their peaks if that is more: a run may have given back what it took in.

    input : work of the ground, plus what the scene held at the start
    kinetic, stored, links_stored : held at the end; of P-Delta what the weights have lost in height counts as stored
        less than nothing
    damping, hysteresis, links : dissipated by structural and foundation dashpots, by yielding storeys, by the links
    """
    came, dashpots, drag, hysteresis, _, on_links = ledger
    kinetic, stored, in_links = held(scenes, runs, state, drift, ledger)
    start = np.array(before).T
    entries = {
        "input": came + (start[0] + start[1] + start[2]),
        "kinetic": kinetic,
        "stored": stored,
        "links_stored": in_links,
        "damping": dashpots + drag,
        "hysteresis": hysteresis,
        "links": on_links - in_links + start[2],
    }
    each = np.array(list(entries.values()))
    missing = each[0] - sum(each[1:])
    scale = np.fmax(np.fmax.reduce(np.abs(each)), _held_at_peaks(runs[0], peaks))
    residual = np.zeros(len(scale))
    np.divide(missing, scale, out=residual, where=(scale > 0) & ~np.isnan(each[0]))
    return entries | {"residual": residual}


def _held_at_peaks(arrays: Arrays, peaks: Peaks) -> np.ndarray:
    """What storeys held at their largest drifts, or, where they yield, at their largest shears V: V^2 / 2 k [J]."""
    stiffness = arrays.slots.stiffness
    if not arrays.yields:
        return 0.5 * _dots(stiffness, peaks.drift**2)
    firm = stiffness > 0
    return 0.5 * (np.ascontiguousarray(peaks.shear[:, firm]) ** 2 / stiffness[firm]).sum(axis=1)
