"""A profile by removal: the scene is timed with parts of the kernel left out, in turns with the whole kernel.

Everything is one compiled function, which no profiler takes apart. Each part is replaced by nothing in a process of
its own with a numba cache of its own, so that no crippled kernel is ever found by anyone else."""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator

from .clock import ROOT

PARTS = {
    "energy ledger": ("account",),
    "peaks": ("track",),
    "energy ledger and peaks": ("account", "track"),
}
"""What is left out, and the functions that do it in `kernels.plain_step`."""

TURNS = 12
"""Turns that the process of every kernel has; the least of its times counts."""


def measure() -> dict[str, float]:
    """Part of the time of the elastic touching pair that is gone without each part [-] (compiles four times)."""
    with contextlib.ExitStack() as stack:
        turns = [stack.enter_context(_process(functions)) for functions in ((), *PARTS.values())]
        times = [[turn() for turn in turns] for _ in range(TURNS)]
    whole, *without = (min(column) for column in zip(*times, strict=True))
    return {name: 1 - seconds / whole for name, seconds in zip(PARTS, without, strict=True)}


@contextlib.contextmanager
def _process(functions: tuple[str, ...]) -> Iterator[Callable[[], float]]:
    """A process without these functions; asked, it times the scene again [s]."""
    with tempfile.TemporaryDirectory() as cache:
        words = [sys.executable, "-m", "tests.bench.removal", *functions]
        environment = {**os.environ, "NUMBA_CACHE_DIR": cache}
        with subprocess.Popen(
            words, cwd=ROOT, env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        ) as process:
            assert process.stdin is not None
            assert process.stdout is not None
            to, back = process.stdin, process.stdout

            def turn() -> float:
                print(file=to, flush=True)
                return float(back.readline())

            yield turn
            to.close()


def _serve(functions: list[str]) -> None:
    """Time the scene with these functions of the kernel empty whenever a line comes in."""
    from numba import njit

    from pounding_cli.kernels import plain_step
    from pounding_cli.kernels.layout import PART
    from pounding_cli.solve import solve

    from . import scenes
    from .clock import in_solver, least

    @njit(**PART)
    def nothing(*anything):
        return None

    for name in functions:
        getattr(plain_step, name)  # an AttributeError here says that the kernel's parts have other names by now
        setattr(plain_step, name, nothing)
    scene = scenes.touching("elastic")
    for _ in sys.stdin:
        (seconds,) = least((in_solver(lambda: solve(scene, 1e-6, "taylor")),), budget=0.3)
        print(seconds, flush=True)


if __name__ == "__main__":
    _serve(sys.argv[1:])
