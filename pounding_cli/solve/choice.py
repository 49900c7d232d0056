"""Method for a wanted accuracy: what `pound accuracy` measured on the paper's scenes, put to use."""

from __future__ import annotations

from pounding_cli.model.scene import Scene
from pounding_cli.solve import exponential
from pounding_cli.solve.arrays import Arrays
from pounding_cli.solve.method import is_linear


def cheapest_method(scene: Scene, arrays: Arrays) -> str:
    """Key in METHODS of the cheapest method that meets any accuracy asked.

    Fixed steps need ten times the time of a series for 1 % and cannot reach 0.1 % at all where floors touch
    (docs/accuracy.md), so the choice is between exact steps, for small linear scenes, and series with
    events.
    """
    return "exponential" if is_linear(scene) and exponential.pays(scene, arrays) else "taylor"
