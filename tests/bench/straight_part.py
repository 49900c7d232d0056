"""What the straight part of a viscous damper changes: the table of docs/theory.md.

Run it with `python -m tests.bench.straight_part`.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from pounding_cli.laws.viscous import Viscous
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Scene
from pounding_cli.solve import solve
from tests.helpers.scenes import INELASTIC, gather, shake, shear_building


def run(law: Viscous):
    """Two buildings of five storeys with a damper at every floor, 6 s."""
    two = shear_building(0.36, 5), shear_building(0.60, 5)
    return solve(Scene(two, tuple(Link(0, j, j, law) for j in range(1, 6)), shake(6.0, 6.0), INELASTIC), 1e-8)


if __name__ == "__main__":
    for a, c in ((0.5, 1e5), (0.3, 1e5), (0.5, 1e6), (0.3, 1e6)):
        law = Viscous(0.05, c, a, 1e-7)
        finest = run(law)
        print(f"{c / 1e3:g} kN, {a:g}: peak closing {1e3 * finest.links.max_closing.max():.2g} mm")
        for w in (1e-3, 1e-4, 1e-5, 1e-6):
            found = run(dataclasses.replace(law, straight_below=w))
            change = np.abs(gather(found, "drift") / gather(finest, "drift") - 1).max()
            print(f"  {w:g} m/s: {change:.1e} of the drifts, {found.steps} steps")
