"""Method and setting for a wanted accuracy: what `pound accuracy` measured on the paper's scenes, put to use."""

from __future__ import annotations

from pounding_cli.model.scene import Scene
from pounding_cli.solve import exponential
from pounding_cli.solve.arrays import Arrays
from pounding_cli.solve.method import is_linear

AUTO = "auto"
"""As a method: of every scene the cheapest that keeps the accuracy. As an accuracy: see `cheap_accuracy`."""

COSTS = {1e-3: 1.0, 1e-4: 1.10, 1e-5: 1.23, 1e-6: 1.36, 1e-7: 1.49, 1e-8: 1.61, 1e-9: 1.73, 1e-10: 1.85, 1e-12: 2.10}
"""Taylor orders computed at an accuracy over those at 1e-3, below which nothing is saved: all linked scenes of Figs 6
and 7 that are not linear (tests/verification/test_choice.py counts them again)."""

WORTH = 1.4
"""Digits are taken as long as the run costs no more than this times the cheapest."""


def cheap_accuracy() -> float:
    """The finest accuracy [-] that costs next to nothing more than the coarsest: what `accuracy: auto` means."""
    return min(accuracy for accuracy, cost in COSTS.items() if cost <= WORTH)


def cheapest_method(scene: Scene, arrays: Arrays) -> str:
    """Key in METHODS of the cheapest method that meets any accuracy asked.

    Fixed steps need ten times the time of a series for 1 % and cannot reach 0.1 % at all where floors touch
    (docs/accuracy.md), so the choice is between exact steps, for linear scenes of moderate size, and series with
    events.
    """
    return "exponential" if is_linear(scene) and exponential.pays(scene, arrays) else "taylor"
