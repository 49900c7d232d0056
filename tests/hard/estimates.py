"""Estimated errors against true ones over random scenes: `python -m tests.hard.estimates --scenes 2000`.

The true error is the largest difference of any number from a run at 1e-12 by Taylor series and from one at 1e-11 by
Dormand-Prince: finer runs by one method may share a fault. An estimate may be at most ten times below it where it
matters: above a tenth of the accuracy asked. Exit code 1 if one is, or if a scene misses the accuracy by its own
estimate without a flag. `--kind` chooses the scenes: rows of buildings, infills that do not pull, or buildings in touch
that move nearly alike."""

from __future__ import annotations

import argparse
import sys

from tests.adapter import difference, solve

from .random_scenes import random_cut_infill, random_scene, random_touch

KINDS = {"rows": random_scene, "cut-infills": random_cut_infill, "touch": random_touch}

METHODS = (("taylor", 1e-12), ("dop853", 1e-11))
"""Methods and accuracies of the runs that tell the true error."""

BOUNDS = 500_000, 500_000
"""Most steps and events of a run."""

BELOW = 10.0
"""By so much an estimate may be below the true error."""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", type=int, default=2000, help="how many scenes")
    parser.add_argument("--first", type=int, default=0, help="number of the first")
    parser.add_argument("--kind", choices=KINDS, default="rows", help="kind of scenes")
    options = parser.parse_args()
    mattered = low = silent = 0
    for number in range(options.first, options.first + options.scenes):
        scene, accuracy = KINDS[options.kind](number)
        run = solve(scene, accuracy, estimate=True, bounds=BOUNDS)
        truths = [solve(scene, finest, method=method, bounds=BOUNDS) for method, finest in METHODS]
        if any(each.status != "done" for each in (run, *truths)):
            continue
        error = max(difference(run, truth) for truth in truths)
        silent += not run.error <= accuracy and not any("accura" in flag or "estimate" in flag for flag in run.flags)
        if error > 0.1 * accuracy:
            mattered += 1
            low += error > BELOW * run.error
            print(f"scene {number}: asked {accuracy:.0e}, estimate {run.error:.1e}, true error {error:.1e}", flush=True)
    print(f"{mattered} true errors above a tenth of the accuracy, {low} estimates too low, {silent} misses not flagged")
    return int(low + silent > 0)


if __name__ == "__main__":
    sys.exit(main())
