"""How far a response can be trusted: its numerical error, and how much a small change of the motion moves it.

The two are different things. A tight tolerance removes the first; the second belongs to the scene, whatever the
method: a contact or a yielding storey that only just happens, or just does not, amplifies the last digit of the
record."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np

from pounding_cli.model.scene import Scene
from pounding_cli.records.motion import Motion
from pounding_cli.solve.methods import TAYLOR, chosen_method, solve
from pounding_cli.solve.response import Response

NUDGE = 1e-6
"""Relative change of the motion's amplitude, growing from nothing at its start to this at its end. The same factor
throughout would say little: elastic buildings in touch answer a motion twice as strong by a response twice as large,
however chaotic."""

ILL_CONDITIONED = 100.0
"""Sensitivity above which a scene is flagged: six digits of the record then give four of the response."""

TIGHTER = 1e-3
"""Accuracy of the second run over that of the first."""

FINEST = 1e-14
"""No run is asked for more than this: doubles hold little more."""

BESIDE_FIXED_STEPS = 1e-9
"""Accuracy of the Taylor run that a fixed-step method is judged by."""


def finer(accuracy: float) -> float:
    """Accuracy of the run that one at `accuracy` is judged by [-]."""
    return max(accuracy * TIGHTER, FINEST)


def nudged_motion(motion: Motion) -> Motion:
    """The motion, stronger by NUDGE at its end and by less before."""
    growth = 1 + NUDGE * np.linspace(0.0, 1.0, motion.acceleration.size)
    return Motion(motion.name, motion.dt, motion.acceleration * growth, motion.source)


def change(first: Response, second: Response) -> float:
    """Largest relative change of any storey's peak shear or drift between two responses of the same buildings [-].

    Storeys at rest in both do not count; nan when either run did not end.
    """
    if first.status != "done" or second.status != "done":
        return float("nan")
    worst = 0.0
    for a, b in zip(first.buildings, second.buildings, strict=True):
        for x, y in ((a.shear, b.shear), (a.drift, b.drift)):
            moving = (x != 0) | (y != 0)
            if moving.any():
                worst = max(worst, float(np.max(np.abs(x - y)[moving] / np.maximum(x, y)[moving])))
    return worst


def assess(scene: Scene, response: Response, accuracy: float, run: Callable[..., Response] = solve) -> Response:
    """The same response with its estimated error [-], its sensitivity [-] and, if that is large, a flag that says so.

    error_estimate : change against a run at an accuracy a thousand times finer; of a fixed-step method, against Taylor
    sensitivity : change when the motion grows by 1e-6 on its way, over 1e-6; at most about 1 for a linear scene
    """
    if response.status != "done":
        return response
    fixed_steps = chosen_method(response.method, accuracy).takes_step
    tight = BESIDE_FIXED_STEPS if fixed_steps else finer(accuracy)
    method = TAYLOR.name if fixed_steps else response.method
    second = run(scene, accuracy=tight, method=method)
    nudged = run(dataclasses.replace(scene, motion=nudged_motion(scene.motion)), accuracy=tight, method=method)
    error, sensitivity = change(response, second), change(second, nudged) / NUDGE
    flags = response.flags
    if sensitivity > ILL_CONDITIONED:
        flags = (
            *flags,
            f"ill-conditioned: a motion that grows by 1e-6 on its way changes a peak by {sensitivity * NUDGE:.1e}",
        )
    return dataclasses.replace(response, error_estimate=error, sensitivity=sensitivity, flags=flags)
