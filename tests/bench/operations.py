"""Floating-point operations of a scene, the core's multiply-add peak.

Counted is what the method needs whatever the code: every coefficient of every order of every step. Evaluating the
series for events, peaks and the energy ledger comes on top; it is work of the program, not of the series."""

from __future__ import annotations

import numpy as np
from numba import njit

from pounding_cli.kernels.simd import load, pointer, splat, store
from pounding_cli.model.scene import Scene
from pounding_cli.solve import solve

from . import scenes
from .clock import in_solver, least, timed

A_FLOOR = 13
"""An order of a floor: six products and five sums of its stencil, and a division by k + 1 for rate and displacement."""

A_LINK = 9
"""An order of a pounding link: closing's rate (1), its integral (1), spring and dashpot (3), the push on both floors
with their inverse masses (4)."""

CHAINS, TURNS = 12, 100_000
"""Independent multiply-adds in flight, and how often each is done."""


@njit(cache=True)
def _multiply_adds(room, turns):
    """Twelve vectors of eight doubles, each times x plus y again and again: nothing but multiply-adds."""
    place = pointer(room)
    x, y = splat(0.999999), splat(1e-6)
    a, b, c, d = load(place, 0), load(place, 8), load(place, 16), load(place, 24)
    e, f, g, h = load(place, 32), load(place, 40), load(place, 48), load(place, 56)
    i, j, k, m = load(place, 64), load(place, 72), load(place, 80), load(place, 88)
    for _ in range(turns):
        a, b, c, d = a * x + y, b * x + y, c * x + y, d * x + y
        e, f, g, h = e * x + y, f * x + y, g * x + y, h * x + y
        i, j, k, m = i * x + y, j * x + y, k * x + y, m * x + y
    store(place, 0, a + b + c + d + e + f + g + h + i + j + k + m)


@njit(cache=True)
def _chain(room, turns):
    """One vector times x plus y again and again: each multiply-add waits for the one before."""
    place = pointer(room)
    x, y = splat(0.999999), splat(1e-6)
    a = load(place, 0)
    for _ in range(turns):
        a = a * x + y
    store(place, 0, a)


def peak() -> tuple[float, float]:
    """Operations a second of independent multiply-adds [1/s], and the time of one that waits for another [s]."""
    room = np.ones(8 * CHAINS)
    _multiply_adds(room, 1)
    _chain(room, 1)

    both = timed(lambda: _multiply_adds(room, TURNS)), timed(lambda: _chain(room, TURNS))
    spread, waiting = least(both, budget=2.0, fewest=50, most=1000)
    return 2 * 8 * CHAINS * TURNS / spread, waiting / TURNS


def counted(scene: Scene, orders: int) -> int:
    """Operations of so many orders [-], every link closed all the time."""
    return orders * (A_FLOOR * sum(b.storeys for b in scene.buildings) + A_LINK * len(scene.links))


def of_a_scene(accuracy: float = 1e-6) -> dict:
    """The elastic touching pair of Fig. 6: operations, the time they need at the peak, and the time they take."""
    scene = scenes.touching("elastic")
    response = solve(scene, accuracy)
    rate, waiting = peak()
    (seconds,) = least((in_solver(lambda: solve(scene, accuracy)),))
    work = counted(scene, response.orders)
    return {
        "accuracy": accuracy, "steps": response.steps, "orders": response.orders, "events": response.events,
        "operations": work, "peak": rate, "waiting": waiting, "at_peak": work / rate, "seconds": seconds,
        "ratio": seconds * rate / work,
    }  # fmt: skip
