"""The program as its user starts it: a study, the help, and the very first run, which compiles."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from .clock import ROOT


def started(*words: str, cache: str | None = None) -> tuple[float, float, str]:
    """Seconds by the clock, seconds of all cores, and what was said, of `pound` with these words."""
    environment = {**os.environ, **({"NUMBA_CACHE_DIR": cache} if cache else {})}
    before, begin = os.times(), time.perf_counter()
    done = subprocess.run(
        [*pound(), *words],
        cwd=ROOT,
        env=environment,
        check=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    wall, after = time.perf_counter() - begin, os.times()
    core = after.children_user + after.children_system - before.children_user - before.children_system
    return wall, core, done.stdout


def pound() -> list[str]:
    """The installed command beside this interpreter."""
    return [str(Path(sys.executable).parent / "pound")]


def measure() -> Iterator[dict]:
    """Rows of (work, wall [s], time of all cores [s], target [s])."""
    with tempfile.TemporaryDirectory() as folder:

        def study(n: int, cache: str | None = None) -> tuple[float, float, str]:
            return started("run", "configs/fig6.yaml", "-o", f"{folder}/{n}.h5", cache=cache)

        study(0)
        yield _least("`pound run configs/fig6.yaml`, warm caches", 1.5, [study(n) for n in range(1, 8)])
        yield _least("`pound --help`", 0.25, [started("--help") for _ in range(15)])
        first = study(100, cache=f"{folder}/cache")
        said = "compil" in first[2].lower()
        yield {**_least("first run ever of configs/fig6.yaml (compiles)", 10.0, [first]), "said": said}


def _least(work: str, most: float, runs: list[tuple[float, float, str]]) -> dict:
    wall, core = min(run[0] for run in runs), min(run[1] for run in runs)
    return {"work": work, "wall": wall, "core": core, "most": most, "met": wall <= most}
