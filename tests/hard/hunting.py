"""Hunts for faults by seeds, a batch at a time in a few processes; outcomes in capitals are faults."""

from __future__ import annotations

import multiprocessing
import resource
from collections import Counter
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from functools import partial
from pathlib import Path

BATCH = 50
"""Seeds that one process tries before it says how it went."""

MEMORY = 2_000_000_000
"""Address space that a process may take beyond what it has when its batch begins [bytes]."""

Hunt = Callable[[int, int, Callable[[str], None]], Counter[str]]
"""A function of (number of tries, first seed, who is told of faults) that counts outcomes."""


def _batch(hunt: Hunt, tries: int, seed: int) -> tuple[Counter[str], list[str]]:
    there = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (there + MEMORY, resource.RLIM_INFINITY))
    told: list[str] = []
    return hunt(tries, seed, told.append), told


def pooled(name: str, hunt: Hunt, tries: int, seed: int, processes: int) -> Counter[str]:
    """What came of the seeds from `seed` on, said as it goes; a process that dies is a fault of its batch."""
    found: Counter[str] = Counter()
    context = multiprocessing.get_context("forkserver")
    with ProcessPoolExecutor(processes, context, max_tasks_per_child=1) as pool:
        batches = {}
        for first in range(seed, seed + tries, BATCH):
            count = min(BATCH, seed + tries - first)
            batches[pool.submit(partial(_batch, hunt, count, first))] = f"seeds {first} to {first + count - 1}"
        for batch in as_completed(batches):
            try:
                counts, told = batch.result()
            except BrokenProcessPool:
                counts, told = Counter({"CRASH": 1}), [f"{name}, {batches[batch]}: a process died"]
            found += counts
            for words in told:
                print(words, flush=True)
            print(f"{name}, {found.total()} tries: {dict(found.most_common())}", flush=True)
    return found


def faults(found: Counter[str]) -> int:
    """How many outcomes are faults."""
    return sum(count for outcome, count in found.items() if outcome.isupper())
