"""A profile by removal: the scene is timed with parts of the kernel left out.

Everything is one compiled function, which no profiler takes apart. Each part is replaced by nothing in a process of
its own with a numba cache of its own, so that no crippled kernel is ever found by anyone else."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile

from .clock import ROOT

PARTS = {
    "energy ledger": ("account",),
    "peaks": ("track",),
    "energy ledger and peaks": ("account", "track"),
}
"""What is left out, and the functions of `kernels.taylor` that do it."""


def measure() -> dict[str, float]:
    """Part of the time of the elastic touching pair that is gone without each part [-] (compiles three times)."""
    whole, found = _without([]), {}
    for name, functions in PARTS.items():
        with tempfile.TemporaryDirectory() as cache:
            words = [sys.executable, "-m", "tests.bench.removal", *functions]
            done = subprocess.run(
                words,
                cwd=ROOT,
                env={**os.environ, "NUMBA_CACHE_DIR": cache},
                capture_output=True,
                text=True,
                check=True,
            )
        found[name] = 1 - json.loads(done.stdout) / whole
    return found


def _without(functions: list[str]) -> float:
    """Time of the scene with these functions of the kernel empty [s]."""
    from numba import njit

    from pounding_cli.kernels import taylor
    from pounding_cli.kernels.layout import PART
    from pounding_cli.solve import solve

    from . import scenes
    from .clock import in_solver, least

    @njit(**PART)
    def nothing(*anything):
        return None

    for name in functions:
        getattr(taylor, name)  # an AttributeError here says that the kernel's parts have other names by now
        setattr(taylor, name, nothing)
    scene = scenes.touching("elastic")
    (seconds,) = least((in_solver(lambda: solve(scene, 1e-6, "taylor")),))
    return seconds


if __name__ == "__main__":
    print(json.dumps(_without(sys.argv[1:])))
