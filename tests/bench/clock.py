"""Least times of runs that take turns, and the machine they were taken on."""

from __future__ import annotations

import datetime
import os
import platform
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from types import SimpleNamespace

ROOT = Path(__file__).parents[2]
PACKAGES = ("numpy", "numba", "scipy", "heyoka", "openseespy")


def least(runs: Sequence[Callable[[], float]], budget: float = 4.0, fewest: int = 5, most: int = 2000) -> list[float]:
    """Least time [s] of each run. Every round calls each of them once, so that all meet the same load.

    A machine that is shared has slow seconds: short runs go on for several.

    `runs` : functions that return what they took [s]
    `budget` : rounds go on until so much time is spent [s], though at least `fewest` and at most `most` of them
    """
    found = [float("inf")] * len(runs)
    begin, rounds = time.perf_counter(), 0
    while rounds < fewest or (rounds < most and time.perf_counter() - begin < budget):
        for place, run in enumerate(runs):
            found[place] = min(found[place], run())
        rounds += 1
    return found


def timed(work: Callable[[], object]) -> Callable[[], float]:
    """A run that says for how long `work` had the core [s]."""

    def run() -> float:
        begin = time.process_time()
        work()
        return time.process_time() - begin

    return run


def in_solver(work: Callable[[], object]) -> Callable[[], float]:
    """A run that says for how long its responses had the core in the solver [s].

    Other programs may hold the core meanwhile, so the solver's clock is replaced by one of this process' time on it.

    `work` : gives a `Response`, or a list of them
    """

    def run() -> float:
        _replace_clock()
        found = work()
        return sum(response.seconds for response in (found if isinstance(found, list) else [found]))

    return run


def _replace_clock() -> None:
    for name, module in list(sys.modules.items()):
        if name.startswith("pounding_cli.solve.") and getattr(module, "time", None) is time:
            module.time = SimpleNamespace(perf_counter=time.process_time)  # type: ignore[attr-defined]


def machine() -> dict[str, str]:
    """Processor, load, versions, commit and day."""
    here = {"processor": processor(), "cores": str(os.cpu_count()), "load": f"{os.getloadavg()[0]:.1f}"}
    here["python"] = platform.python_version()
    for name in PACKAGES:
        try:
            here[name] = version(name)
        except PackageNotFoundError:
            here[name] = "not installed"
    changed = " and changes" if _git("status", "--porcelain", "--untracked-files=no", "pounding_cli") else ""
    here["commit"] = (_git("rev-parse", "--short", "HEAD") or "unknown") + changed
    here["day"] = datetime.datetime.now(datetime.UTC).strftime("%Y-%m-%d %H:%M UTC")
    return here


def _git(*words: str) -> str:
    return subprocess.run(["git", "-C", str(ROOT), *words], capture_output=True, text=True).stdout.strip()


def processor() -> str:
    """The processor's name."""
    for line in Path("/proc/cpuinfo").read_text().splitlines() if Path("/proc/cpuinfo").exists() else ():
        if line.startswith("model name"):
            return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()
