"""What a scene will cost, before it is solved: from its size, its motion and its links."""

from __future__ import annotations

from pounding_cli.model.effects import memories_flow
from pounding_cli.model.scene import Scene
from pounding_cli.solve.arrays import pack
from pounding_cli.solve.choice import cheapest_method
from pounding_cli.solve.ground import segments_of
from pounding_cli.solve.method import steps_a_sample
from pounding_cli.solve.tangent import FINEST_BOUNDED
from pounding_cli.solve.taylor import carries_tangent

SERIES = 66e-9
"""Time of a Taylor run a floor and record sample [s], on one core of an AMD EPYC at an accuracy of 1e-6; median over
Figs 6 and 7."""

SMOOTH = 7e-6
"""The same with storeys whose memory flows (Bouc-Wen), all of which takes program steps: a building of five storeys
took 16 ms for 500 samples, two that pound each other 50 to 65 ms."""

LINKED = 1.6
"""The same with links over without. Links far stiffer than the storeys cost more."""

EXACT = 30e-9, 2e-9
"""Time of exact steps a floor and sample, and a floor squared and sample [s]."""

STEP = 25e-9
"""Time of a fixed step a floor [s]; implicit methods take more."""

START = 1.0
"""Time of a run besides its scenes [s]: imports, compiled kernels loaded, a file with its summary."""

BESIDE = 0.15e-3
"""Time a scene spends outside the solver [s]: peaks out, kept on disk, written."""

NEW_LINKS = 0.25e-3
"""Time that links take which no scene before had [s]: expanded and laid out."""

ASSESSED = 2.4
"""Runs of a scene whose error and sensitivity are asked for: one more, and two more where that one cannot tell both."""

CARRIED = 1.45
"""The same where a run carries its tangent, which tells both, and a finer one follows where its bound is too large."""


def method_of(scene: Scene) -> str:
    """Key in METHODS of what `method: auto` takes for a scene."""
    return cheapest_method(scene, pack(scene))


def runs_assessed(scene: Scene, method: str, accuracy: float, all_effects: bool) -> float:
    """Times the cost of one run that a scene takes whose error and sensitivity are asked for."""
    bounded = method == "taylor" and accuracy >= FINEST_BOUNDED and not all_effects
    carried = bounded and carries_tangent(pack(scene))
    return CARRIED if carried else ASSESSED


def cost(scene: Scene, method: str, time_step: float | None = None) -> float:
    """Expected time of one run on one core [s].

    Parameters
    ----------
    scene : in SI units
    method : a key of METHODS
    time_step : of a method that takes one [s]; an accuracy hardly matters
    """
    floors = sum(building.storeys for building in scene.buildings)
    if time_step is not None:
        return steps_a_sample(scene, time_step) * segments_of(scene) * STEP * floors
    if method == "exponential":
        return segments_of(scene) * (EXACT[0] + EXACT[1] * floors) * floors
    series = SMOOTH if memories_flow(scene) else SERIES
    return segments_of(scene) * series * floors * (LINKED if any(link.law.can_close for link in scene.links) else 1.0)
