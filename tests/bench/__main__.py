"""`python -m tests.bench [--only PART ...] [--huge] [--periods N]`, from the repository root; `make bench` runs all."""

from __future__ import annotations

import argparse
import os
import time

from . import batch, growth, laws, operations, page, picture, program, removal, sampling, sweep, versus
from .clock import machine

SWEEPS, HUGE = (100, 1000, 10_000), 100_000


def sweeps(counts: tuple[int, ...]) -> list[dict]:
    """Sweeps of these sizes, and of those measured before that are not among them."""
    sweep.run(4)  # compiles, if nothing did before
    before = page.read().get("sweeps", {}).get("found", [])
    found = [one for one in before if one["scenes"] not in counts] + [sweep.run(count) for count in counts]
    return sorted(found, key=lambda one: one["scenes"])


def main() -> None:
    """Measure, keep, write the page and draw."""
    parts = {
        "peers": lambda: [*versus.heyoka(), *versus.opensees(), *versus.baseline()],
        "figures": lambda: list(versus.figures()),
        "program": lambda: list(program.measure()),
        "laws": laws.measure,
        "operations": operations.of_a_scene,
        "profile": removal.measure,
        "sampled": sampling.measure,
        "growth": lambda: list(growth.measure()),
        "batch": lambda: batch.parts(batch.measure(options.periods)),
        "sweeps": lambda: sweeps((HUGE,) if options.huge else SWEEPS),
    }
    parser = argparse.ArgumentParser(prog="python -m tests.bench", description=__doc__)
    parser.add_argument("--only", nargs="+", choices=parts, default=list(parts), help="parts to measure")
    parser.add_argument("--huge", action="store_true", help=f"the sweep of {HUGE} scenes instead of the smaller ones")
    parser.add_argument("--periods", type=int, default=20, help="periods of the second building in the part batch")
    parser.add_argument("--draw", action="store_true", help="measure nothing: write page and figure anew")
    options = parser.parse_args()
    for name in () if options.draw else options.only:
        if name in ("sweeps", "program", "batch"):
            os.sched_setaffinity(0, range(os.cpu_count() or 1))
        else:
            os.sched_setaffinity(0, {0})
        begin, here = time.perf_counter(), machine()
        found = parts[name]()
        if found is not None:
            page.keep({**page.read(), name: {"machine": here, "found": found}})
        print(f"{name}: {time.perf_counter() - begin:.0f} s", flush=True)
    kept = page.read()
    page.write(kept)
    if {"growth", "sweeps"} <= kept.keys():
        picture.draw(kept["growth"]["found"], kept["sweeps"]["found"])


if __name__ == "__main__":
    main()
