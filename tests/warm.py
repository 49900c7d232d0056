"""Compiles the kernels before tests are timed: `python -m tests.warm`."""

from __future__ import annotations

import sys
from concurrent.futures import ProcessPoolExecutor

import numpy as np

from tests.adapter import Scene, solve

STOREY = {"storeys": 1, "mass": 1e5, "stiffness": [4e7]}
SMOOTH = {"link": "viscous", "force_at_1_m_s": 1e5, "exponent": 0.5}


TOGETHER = ("taylor", "smooth"), ("fixed steps",)
"""Kernels that one process compiles: the second has all functions of the first."""


def all_of(names: tuple[str, ...]) -> set[str]:
    """The outcomes of scenes that need these kernels."""
    return set(map(compiled, names))


def compiled(name: str) -> str:
    """The outcome of a scene that needs this kernel."""
    settings = {"method": "newmark", "time_step": 0.01} if name == "fixed steps" else {}
    case = SMOOTH if name == "smooth" else {"link": "connector"}
    scene = Scene([STOREY, STOREY], np.array([0.0, 1.0, 0.0]), 0.02, case | {"gap": 0.1})
    return solve(scene, **settings).status


def main() -> int:
    with ProcessPoolExecutor(len(TOGETHER)) as pool:
        return int(set().union(*pool.map(all_of, TOGETHER)) != {"done"})


if __name__ == "__main__":
    sys.exit(main())
