"""A profile by sampling: where the solver is when it is looked at, four thousand times a second, by Linux' `perf`.

A fresh kernel is compiled in a process of its own, since one from the disk cache has lost its functions' names. Where
there is no `perf` the part is left out."""

from __future__ import annotations

import bisect
import collections
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import warnings
from pathlib import Path

from .clock import ROOT

SECONDS = 6.0
RATE = 4000

LONGEST = 32768
"""No function is longer [bytes]: what lies further behind one is not the kernel's."""

GROUPS = {
    "series": ("recurrence.",),
    "energy ledger": ("ledger.",),
    "bounds for what may happen between a step's ends": ("summary.summarise", "summary._"),
    "events: roots of the series, change of branches": ("crossings.", "transitions.", "polynomial.first_crossing",
        "polynomial._march", "polynomial._bracketed", "summary.end_at_event"),
    "peaks": ("peaks.", "polynomial.highest", "polynomial._turn", "polynomial.slope", "polynomial.value"),
    "steps that were shortened": ("recurrence.rescale", "recurrence.shrink"),
    "links at a step's start": ("link_series.",),
    "steps and segments": ("taylor.", "plain_step.", "scratch.", "islands.", "cells."),
}  # fmt: skip
"""Parts of a step by the functions that do them (`kernels/`); of several that fit, the longest name counts."""


def measure() -> dict[str, float] | None:
    """Share of each part in the solver's time on the elastic touching pair of Fig. 6 [-]; None without `perf`."""
    if shutil.which("perf") is None:
        return None
    with tempfile.TemporaryDirectory() as cache:
        done = subprocess.run(
            [sys.executable, "-m", "tests.bench.sampling"], cwd=ROOT, env={**os.environ, "NUMBA_CACHE_DIR": cache},
            capture_output=True, text=True, check=True,
        )  # fmt: skip
    return json.loads(done.stdout.splitlines()[-1])


def _sampled() -> dict[str, float]:
    from pounding_cli.kernels import taylor
    from pounding_cli.solve import solve

    from . import scenes

    scene = scenes.touching("elastic")
    solve(scene, 1e-6, "taylor")
    functions = _functions(taylor.build(False))
    with tempfile.TemporaryDirectory() as folder:
        data = Path(folder) / "perf.data"
        words = ["perf", "record", "-e", "cpu-clock", "-F", str(RATE), "-p", str(os.getpid()), "-o", str(data)]
        watcher = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        begin = time.perf_counter()
        while time.perf_counter() - begin < SECONDS:
            solve(scene, 1e-6, "taylor")
        watcher.send_signal(signal.SIGINT)
        watcher.wait()
        script = ["perf", "script", "-i", str(data), "-F", "ip"]
        seen = subprocess.run(script, capture_output=True, text=True, check=True).stdout.split()
    return _shares([int(address, 16) for address in seen], functions)


def _functions(kernel) -> list[tuple[int, str]]:
    """(address, module.function) of everything the compiled kernel is made of, by address."""
    library = next(iter(kernel.overloads.values())).library
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        text = library.get_llvm_str()
    found = []
    for name in set(re.findall(r'define [^@]*@"?([^"(]+)"?\(', text)):
        address = library.get_pointer_to_function(name)
        if address:
            found.append((address, _plain(name)))
    return sorted(found)


def _plain(mangled: str) -> str:
    """`module.function` from a mangled name (Itanium ABI: every part stands behind its length)."""
    parts, rest = [], mangled.removeprefix("_ZN")
    while head := re.match(r"\d+", rest):
        length = int(head[0])
        parts.append(rest[head.end() : head.end() + length])
        rest = rest[head.end() + length :]
    return ".".join(parts[2:4])


def _shares(seen: list[int], functions: list[tuple[int, str]]) -> dict[str, float]:
    starts = [address for address, _ in functions]
    counts: collections.Counter[str] = collections.Counter()
    for address in seen:
        place = bisect.bisect(starts, address) - 1
        if place >= 0 and address - starts[place] < LONGEST:
            counts[_part(functions[place][1])] += 1
    total = sum(counts.values())
    return {part: counts[part] / total for part in (*GROUPS, "else")}


def _part(function: str) -> str:
    fits = [(len(start), part) for part, starts in GROUPS.items() for start in starts if function.startswith(start)]
    return max(fits)[1] if fits else "else"


if __name__ == "__main__":
    print(json.dumps(_sampled()))
