"""Mutations of numba's cache: `python -m tests.hard.damage_cache --tries 1000` counts what comes of them.

The cache holds kernels small enough to be compiled a thousand times, kept by the program's own `kernels/kept.py`. In
each try files are damaged, cut, emptied, exchanged or taken away, as disks, full ones and killed processes leave them;
a process of its own then calls the kernels. They give the numbers they gave before; anything else is a fault.
"""

from __future__ import annotations

import argparse
import importlib.util
import random
import shutil
import sys
import tempfile
from collections import Counter
from collections.abc import Callable
from pathlib import Path

from numba import njit

from pounding_cli.kernels import kept

from .damage import damaged_bytes
from .guarded import guarded
from .hunting import faults, pooled

SOURCE = """\
from numba import njit


@njit(cache=True)
def twice(x):
    return 2 * x


@njit(cache=True)
def total(values):
    found = 0.0
    for value in values:
        found += twice(value)
    return found
"""
EXPECTED = 2 * (1.5 + 2.5 - 7.0)


def called(folder: Path) -> str:
    """Load the kernels as a new process does, and call them: "used", "compiled", or what else came of it."""
    import numpy as np

    kept.FOLDER = folder / "__pycache__"
    kept._seen.clear()
    kept.notes.clear()
    spec = importlib.util.spec_from_file_location("kernels_of_a_test", folder / "kernels_of_a_test.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["kernels_of_a_test"] = module
    spec.loader.exec_module(module)
    found = kept.loaded(lambda: module.total(np.array([1.5, 2.5, -7.0])))
    if found != EXPECTED:
        return f"SILENT: {found}, not {EXPECTED}"
    return "used" if sum(module.total.stats.cache_hits.values()) else "compiled"


def told(folder: Path) -> str:
    """What `called` says in a process of its own; a traceback, a crash or a hang in capitals."""
    said = folder / "said"
    said.unlink(missing_ok=True)
    came = guarded(lambda: said.write_text(called(folder)), seconds=20)
    if came != "done":
        return f"{came.partition(':')[0].upper()}: {came}"
    return said.read_text()


def spoil(cache: Path, whole: dict[str, bytes], chance: random.Random) -> str:
    """Do something to the files of a cache; what it was."""
    shutil.rmtree(cache, ignore_errors=True)
    cache.mkdir()
    for name, content in whole.items():
        (cache / name).write_bytes(content)
    names = sorted(whole)
    some = chance.sample(names, chance.choice((1, 1, 1, 2, len(names))))
    kind = chance.choice(("bytes", "bytes", "bytes", "empty", "exchanged", "gone", "folder", "strange"))
    for name in some:
        path = cache / name
        if kind == "bytes":
            path.write_bytes(damaged_bytes(whole[name], chance))
        elif kind == "empty":
            path.write_bytes(b"")
        elif kind == "exchanged":
            path.write_bytes(whole[chance.choice(names)])
        elif kind == "gone":
            path.unlink()
        elif kind == "folder":
            path.unlink()
            path.mkdir()
        else:
            path.write_bytes(chance.choice((b"\x80\x05.", b"garbage\n", b"ffffffff\n", bytes(4096))))
    return kind


def hunt(tries: int, start: int = 0, tell: Callable[[str], None] = print) -> Counter[str]:
    """What came of so many mutations, each from a seed of its own; `tell` hears of each that is a fault."""
    found: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "kernels_of_a_test.py").write_text(SOURCE)
        njit(lambda x: x + 1)(1.0)  # here once, so that the processes split off find the compiler ready
        cache = folder / "__pycache__"
        assert (first := told(folder)) == "compiled", first
        assert (again := told(folder)) == "used", again
        whole = {path.name: path.read_bytes() for path in cache.iterdir() if path.suffix != ".pyc"}
        for seed in range(start, start + tries):
            kind = spoil(cache, whole, random.Random(f"cache {seed}"))
            outcome = told(folder)
            if outcome in ("used", "compiled") and (again := told(folder)) != "used":
                outcome = f"NOT MENDED: {kind}, then {again}"
            if outcome.split(":")[0].isupper():
                tell(f"cache, seed {seed} ({kind}): {outcome[:1500]}")
            found[outcome.split(":")[0]] += 1
    return found


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tries", type=int, default=1000, help="mutations")
    parser.add_argument("--seed", type=int, default=0, help="the first seed")
    parser.add_argument("--processes", type=int, default=2, help="processes at once")
    options = parser.parse_args()
    return 1 if faults(pooled("cache", hunt, options.tries, options.seed, options.processes)) else 0


if __name__ == "__main__":
    sys.exit(main())
