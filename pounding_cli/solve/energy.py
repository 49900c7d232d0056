"""The energy ledger of a run: what came in, where it is, where it went, and what is missing."""

from __future__ import annotations

import numpy as np

from pounding_cli.kernels.layout import Peaks, State
from pounding_cli.kernels.ledger import Ledger
from pounding_cli.model.scene import Scene
from pounding_cli.solve.arrays import Arrays, drift_of, held_by_springs, with_points
from pounding_cli.solve.storeys import shear_and_stored

AT_REST = {"kinetic": 0.0, "stored": 0.0, "links_stored": 0.0}
"""What a scene at rest holds [J]."""


def held(scene: Scene, arrays: Arrays, state: State, ledger: Ledger | None = None) -> dict[str, float]:
    """Energy in the scene now [J]: kinetic, stored in storeys and foundations less what their weights have lost by
    leaning (P-Delta), stored in links. What storeys hold is in the ledger of a run that has come to this state."""
    kinetic = 0.5 * float(arrays.slots.mass @ state.v**2)
    if not arrays.yields:
        drift = drift_of(arrays, state.u)
        stored = float((0.5 * (arrays.slots.stiffness * drift) * drift).sum())
    elif ledger is None:
        drift = drift_of(arrays, state.u)
        stored = float(
            shear_and_stored(arrays, drift[None], state.storey_branch[None], state.storey_memory[None])[1][0]
        )
    else:
        stored = float(ledger.stored.sum())
    stored += held_by_springs(arrays, state.u)
    if arrays.leans:
        leans = state.u - arrays.slots.couple * np.concatenate(([0.0], state.u[:-1]))
        stored -= 0.5 * float(arrays.slots.geometric @ leans**2)  # fault: p-delta-energy
    return {"kinetic": kinetic, "stored": stored, "links_stored": _in_links(scene, arrays, state)}


def _in_links(scene: Scene, arrays: Arrays, state: State) -> float:
    """Energy in all links [J]."""
    if not scene.links:
        return 0.0
    links, count = arrays.links, arrays.links.number
    u = with_points(arrays, state.u)
    closings = u[links.left[:count]] - u[links.right[:count]]
    branches = state.link_branch[:count] - links.first[:count]
    each = zip(scene.links, branches.tolist(), closings.tolist(), state.link_memory[:count].tolist(), strict=True)
    return float(sum([link.law.held(*of) for link, *of in each]))


def balance(
    scene: Scene, arrays: Arrays, before: dict[str, float], state: State, peaks: Peaks, ledger: Ledger
) -> dict[str, float]:
    """The ledger [J]; `residual` is what is missing over the largest entry [-], or over what storeys held at
    their peaks if that is more: a run may have given back what it took in.

    input : work of the ground, plus what the scene held at the start
    kinetic, stored, links_stored : held at the end; of P-Delta what the weights have lost in height counts as stored
        less than nothing
    damping, hysteresis, links : dissipated by structural and foundation dashpots, by yielding storeys, by the links
    """
    now = held(scene, arrays, state, ledger)
    work_on_links = float(ledger.links.sum())
    book = {
        "input": float(ledger.input.sum()) + sum(before.values()),
        **now,
        "damping": float(ledger.dashpots.sum() + ledger.drag.sum()),
        "hysteresis": float(ledger.hysteresis.sum()),
        "links": work_on_links - now["links_stored"] + before["links_stored"],  # fault: links-energy
    }
    came, *went = book.values()
    missing, scale = came - sum(went), max(*map(abs, (came, *went)), _held_at_peaks(arrays, peaks))
    book["residual"] = missing / scale if scale > 0 else 0.0
    return book


def _held_at_peaks(arrays: Arrays, peaks: Peaks) -> float:
    """What storeys held at their largest drifts, or, where they yield, at their largest shears V: V^2 / 2 k [J]."""
    stiffness = arrays.slots.stiffness
    if not arrays.yields:
        return 0.5 * float(stiffness @ peaks.drift**2)
    return 0.5 * float((peaks.shear[stiffness > 0] ** 2 / stiffness[stiffness > 0]).sum())
