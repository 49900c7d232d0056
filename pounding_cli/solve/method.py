"""The code behind a method of `pounding_cli.methods`, and what several of them ask of a scene."""

from __future__ import annotations

import functools
import importlib
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from pounding_cli.methods import Method
from pounding_cli.model.effects import effects_of, memories_flow
from pounding_cli.model.scene import Scene
from pounding_cli.solve.arrays import Arrays

UNSTABLE, NO_ROOT = 20, 21
"""How a run ended, beyond the outcomes of `kernels.layout`: not begun because the time step is too long; an implicit
step without a solution however short it was made."""


def steps_a_sample(scene: Scene, time_step: float) -> int:
    """The fewest equal parts of the motion's time step that are not longer than `time_step` [s]."""
    return max(1, math.ceil(scene.motion.dt / time_step - 1e-9))


def step_taken(scene: Scene, time_step: float) -> float:
    """The largest time step [s] not above `time_step` that divides the motion's."""
    return scene.motion.dt / steps_a_sample(scene, time_step)


def any_step(arrays: Arrays) -> float:
    """No stability limit."""
    return float("inf")


def any_scene(scene: Scene) -> str:
    """Every scene is run."""
    return ""


def no_note(steps: int, events: int) -> str:
    """Nothing to tell about a run."""
    return ""


@dataclass(frozen=True)
class Integrator:
    """The code of a method (`pounding_cli.methods.Method`).

    Parameters
    ----------
    integrate : (scene, arrays, state, peaks, ledger, setting, bounds) -> (status, steps, events, orders, time [s]),
        filling state, peaks and, if it keeps one, the ledger
    largest_step : stability limit of the time step from the arrays [s]; inf where there is none
    refusal : why it does not run a scene, or "" when it does
    note : a sentence about a run from its counts of steps and events, or ""
    keeps_ledger : whether it fills the ledger where the method keeps one
    """

    integrate: Callable[..., tuple[int, int, int, int, float]]
    largest_step: Callable[[Arrays], float] = any_step
    refusal: Callable[[Scene], str] = any_scene
    note: Callable[[int, int], str] = no_note
    keeps_ledger: bool = True


def integrator_of(method: Method) -> Integrator:
    """The code of a method, imported when it is first asked for."""
    found = _loaded(method.code) if isinstance(method.code, str) else method.code
    assert isinstance(found, Integrator)
    return found


@functools.cache
def _loaded(code: str) -> Any:
    """What stands at "module:name"."""
    module, _, name = code.partition(":")
    return getattr(importlib.import_module(module), name)


def refusal_of(method: Method, scene: Scene) -> str:
    """Why a method does not run a scene; "" when it does."""
    if not method.remembers:
        laws = sorted({link.kind for link in scene.links if link.law.remembers})
        if laws:
            return f"the force of {' and '.join(laws)} depends on events before, which it does not keep"
        if memories_flow(scene):
            named = sorted({b.storey_law.name for b in scene.buildings if b.memory_flows})
            return f"the shear of {' and '.join(named)} storeys depends on all that went before, which it does not keep"
    return integrator_of(method).refusal(scene)


def is_linear(scene: Scene) -> bool:
    """Whether nothing in the scene can change its stiffness, or end its run: no storey can yield or collapse, links are
    linear or never close."""
    effects = effects_of(scene)
    return not (effects.yielding or effects.collapse) and all(link.law.is_linear for link in scene.links)


def not_linear(scene: Scene) -> str:
    """The refusal of a method that runs linear scenes only."""
    if effects_of(scene).yielding:
        return "its storeys can yield"
    if effects_of(scene).collapse:
        return "a drift is looked for at which its storeys count as collapsed"
    kinds = sorted({link.kind for link in scene.links if not link.law.is_linear})
    return f"it has {' and '.join(kinds)} links" if kinds else ""
