"""What a law of storeys costs beside the bilinear one: `python -m tests.bench.storey_laws`.

The touching pair of Fig. 6 with one motion, every law in turn, seven rounds; the least time of each."""

from __future__ import annotations

import dataclasses
import time
from pathlib import Path

import numpy as np

from pounding_cli.laws import storey_laws
from pounding_cli.model.scene import Analysis
from pounding_cli.solve import solve
from pounding_cli.study import expand, load_study

PARAMETERS = {
    "capping_ductility": 6.0,
    "post_capping_slope": 0.05,
    "residual_strength": 0.4,
    "strength_capacity": 200.0,
    "capping_capacity": 200.0,
    "unloading_capacity": 200.0,
    "reloading_capacity": 200.0,
    "pinching_force": 0.4,
    "pinching_drift": 0.5,
}


def main() -> None:
    """Print a table: law, milliseconds, steps, events."""
    plan = expand(load_study(Path("configs/fig6.yaml")))
    plain = next(s for s in plan.scenes.values() if s.links and s.analysis == Analysis.INELASTIC)
    scenes = {}
    for name, law in storey_laws().items():
        own = tuple((key, value) for key, value in PARAMETERS.items() if key in law.parameters())
        change = {"storey_law": law, "law_parameters": own, "collapse": np.inf}
        scenes[name] = dataclasses.replace(
            plain, buildings=tuple(dataclasses.replace(b, **change) for b in plain.buildings)
        )
    least = dict.fromkeys(scenes, np.inf)
    for _ in range(7):
        for name, scene in scenes.items():
            begin = time.thread_time()
            run = solve(scene, 1e-6)
            least[name] = min(least[name], time.thread_time() - begin)
    for name, scene in scenes.items():
        run = solve(scene, 1e-6)
        mu = max(float(b.ductility.max()) for b in run.buildings)
        print(f"{name:20} {1e3 * least[name]:7.2f} ms {run.steps:6} steps {run.events:5} events  ductility {mu:.1f}")


if __name__ == "__main__":
    main()
