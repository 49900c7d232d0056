"""The methods by name, and `solve`: one scene in, one response out, whatever the method."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

import numpy as np

from pounding_cli.kernels import layout
from pounding_cli.model.effects import effects_of
from pounding_cli.model.scene import Scene
from pounding_cli.solve import central_difference, taylor
from pounding_cli.solve.arrays import at_rest, empty_ledger, no_peaks, pack, unpack
from pounding_cli.solve.energy import balance, held
from pounding_cli.solve.flags import flags_of
from pounding_cli.solve.response import Response

METHODS: dict[str, Callable] = {
    "taylor": taylor.integrate,
    "central-difference": central_difference.integrate,
}

ACCOUNTING = {"taylor"}
"""Methods that keep an energy ledger."""

OUTCOMES = {
    layout.DONE: ("done", ""),
    layout.EVENT_BOUND: ("event bound reached", "the floors chatter: check the links' stiffness and damping"),
    layout.STEP_BOUND: (
        "step bound reached",
        "a part of the scene is far stiffer than the rest: check stiffnesses and masses",
    ),
    layout.NOT_FINITE: ("not finite", "the numbers left the range of doubles: check masses and stiffnesses"),
    layout.STALLED: (
        "stalled",
        "events follow one another without time going on: check for links that jump in force",
    ),
}
"""Kernel outcome to the words a user reads and what to do about it."""

MOST_STEPS = 20_000_000
MOST_EVENTS = 5_000_000

_compiled: set = set()


def is_compiled() -> bool:
    """Whether some kernel has run in this process, so that the next call does not compile."""
    return bool(_compiled)


def solve(
    scene: Scene,
    accuracy: float = 1e-6,
    method: str = "taylor",
    initial: tuple[Sequence[np.ndarray], Sequence[np.ndarray]] | None = None,
    bounds: tuple[int, int] = (MOST_STEPS, MOST_EVENTS),
) -> Response:
    """The response of a scene.

    Parameters ---------- scene : in SI units accuracy : wanted relative error of the peaks [-]; for fixed-step
    methods the time step [s] method : a key of METHODS initial : floor displacements [m] and velocities [m/s]
    relative to the ground, one array (n,) a building; None is rest bounds : most steps, most events

    Raises
    ------
    KeyError : unknown method
    """
    arrays = pack(scene)
    state, peaks = at_rest(arrays), no_peaks(arrays)
    if initial is not None:
        for span, u, v in zip(arrays.floors, *initial, strict=True):
            state.u[span], state.v[span] = u, v
            peaks.displacement_max[span], peaks.displacement_min[span] = u, u
    ledger, before = empty_ledger(arrays), held(scene, arrays, state)
    begin = time.perf_counter()
    status, steps, events, orders, _ = METHODS[method](scene, arrays, state, peaks, ledger, accuracy, bounds)
    seconds = time.perf_counter() - begin
    _compiled.add(method)
    if status == layout.DONE and not all(np.isfinite(p).all() for p in (*peaks[:7], *peaks[8:])):
        status = layout.NOT_FINITE
    buildings, links = unpack(scene, arrays, state, peaks)
    outcome, advice = OUTCOMES[status]
    effects = effects_of(scene)
    return Response(
        buildings, links, outcome, advice, method, accuracy, steps, events, seconds, orders=orders,
        energy=balance(scene, arrays, before, state, ledger) if method in ACCOUNTING else {},
        flags=flags_of(scene, links), effects=effects.kept, dropped=effects.dropped,
        final=tuple((state.u[span].copy(), state.v[span].copy()) for span in arrays.floors),
    )  # fmt: skip
