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
    if ledger is None or not arrays.slots.branch.any():
        at_once = drift_of(arrays, state)[None], state.storey_branch[None], state.storey_memory[None]
        stored = float(shear_and_stored(arrays, *at_once)[1][0])
    else:
        stored = float(ledger.stored.sum())
    stored += held_by_springs(arrays, state.u)
    leans = state.u - arrays.slots.couple * np.concatenate(([0.0], state.u[:-1]))
    stored -= 0.5 * float(arrays.slots.geometric @ leans**2)  # fault: p-delta-energy
    return {"kinetic": kinetic, "stored": stored, "links_stored": _in_links(scene, arrays, state)}


def _in_links(scene: Scene, arrays: Arrays, state: State) -> float:
    """Energy in all links [J]."""
    links, count = arrays.links, arrays.links.number
    u = with_points(arrays, state.u)
    closings = u[links.left[:count]] - u[links.right[:count]]
    branches = state.link_branch[:count] - links.first[:count]
    each = zip(scene.links, branches.tolist(), closings.tolist(), state.link_memory[:count].tolist(), strict=True)
    return float(sum(link.law.held(*of) for link, *of in each))


RETURNED = 1e-4
"""Part of the energy that storeys have held at once [-]: a run whose entries are all smaller at its end has given back
what it took in, and what is missing is measured by what was held."""


def balance(
    scene: Scene, arrays: Arrays, before: dict[str, float], state: State, peaks: Peaks, ledger: Ledger
) -> dict[str, float]:
    """The ledger [J]; `residual` is what is missing over the largest entry [-], or over what storeys have held
    (`RETURNED`).

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
    missing, scale = came - sum(went), max(map(abs, (came, *went)))
    most = 0.5 * float(arrays.slots.stiffness @ peaks.drift**2) if not arrays.slots.branch.any() else 0.0
    if scale < RETURNED * most:
        scale = most
    book["residual"] = missing / scale if scale > 0 else 0.0
    return book
