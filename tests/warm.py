"""Compiles the kernels, two at a time, before tests are timed: `python -m tests.warm`."""

from __future__ import annotations

import sys
from concurrent.futures import ProcessPoolExecutor

import numpy as np

from tests.adapter import Scene, solve

STOREY = {"storeys": 1, "mass": 1e5, "stiffness": [4e7]}
SMOOTH = {"link": "viscous", "force_at_1_m_s": 1e5, "exponent": 0.5}


def compiled(name: str) -> str:
    """The outcome of a scene that needs this kernel."""
    settings = {"method": "newmark", "time_step": 0.01} if name == "fixed steps" else {}
    case = SMOOTH if name == "smooth" else {"link": "connector"}
    scene = Scene([STOREY, STOREY], np.array([0.0, 1.0, 0.0]), 0.02, case | {"gap": 0.1})
    return solve(scene, **settings).status


def main() -> int:
    with ProcessPoolExecutor(2) as pool:
        return int(set(pool.map(compiled, ("smooth", "taylor", "fixed steps"))) != {"done"})


if __name__ == "__main__":
    sys.exit(main())
