"""What a batch costs a scene: solver, estimates, and all that is around them.

`python -m tests.bench.batch [--periods 5] [--against TREE]` prints it for this tree, and for another one in turns with
it (a second checkout), so that both meet the same load."""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from .clock import ROOT

STUDY = """\
records: {{use: [elcentro, taft, parkfield], duration: table1}}
buildings:
  stiff: {{storeys: 5, period: 0.36 s, yield: {{code: UBC-1991}}}}
  soft: {{like: stiff, period: 0.60 s}}
group: [stiff, soft]
cases:
  gap: {{link: pounding, gap: 2 cm}}
analyses: [elastic, inelastic]
accuracy: 1e-6
estimate: {estimate}
sweep:
  buildings.soft.period: [{periods}]
  impact.restitution: [0.4, 0.6, 0.8]
  cases.gap.gap: [0.5 cm, 1 cm, 1.5 cm, 2 cm, 2.5 cm, 3 cm, 3.5 cm, 4 cm, 4.5 cm, 5 cm]
"""
"""Three motions of 10 to 15 s, two buildings; with 20 periods 3,726 scenes, buildings alone included."""

RUN = """\
import json, resource, sys, time
from pathlib import Path
from types import SimpleNamespace

from pounding_cli.batch import run_plan
from pounding_cli.study import expand, load_study

def used():
    both = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(each.ru_utime + each.ru_stime for each in both)

def run(study, output, workers):
    return run_plan(expand(load_study(Path(study))), Path(output), workers=workers)

warm, study, output, workers = sys.argv[1:]
run(warm, warm + ".h5", 1)
for name, module in list(sys.modules.items()):
    if name.startswith("pounding_cli.solve.") and getattr(module, "time", None) is time:
        module.time = SimpleNamespace(perf_counter=time.process_time)
core, wall = used(), time.perf_counter()
outcome = run(study, output, int(workers))
found = {"wall": time.perf_counter() - wall, "core": used() - core, "solver": outcome.solver_seconds}
print(json.dumps({"scenes": outcome.done, **found}))
"""
"""One run in a process of its own whose kernels are loaded: seconds by the clock, of all cores, and in the solver."""

ESTIMATES = ("none", "all")


def study_text(periods: int, estimate: str) -> str:
    """The study with so many periods of the second building."""
    values = ", ".join(f"{0.5 + 0.5 * place / max(1, periods - 1):.6f} s" for place in range(periods))
    return STUDY.format(estimate=estimate, periods=values)


def measure(periods: int = 20, turns: int = 6, trees: tuple[Path, ...] = (ROOT,)) -> list[dict]:
    """Rows of (estimate, workers): least seconds of several runs, all scenes together; each tree in turn."""
    asked = [(estimate, workers, tree) for estimate in ESTIMATES for workers in (1, 2) for tree in trees]
    found: dict[tuple, list[dict]] = {which: [] for which in asked}
    with tempfile.TemporaryDirectory() as folder:
        warm = Path(folder, "warm.yaml")
        warm.write_text(study_text(1, "none"))
        for estimate in ESTIMATES:
            Path(folder, f"{estimate}.yaml").write_text(study_text(periods, estimate))
        for turn in range(turns):
            for estimate, workers, tree in asked:
                study, output = f"{folder}/{estimate}.yaml", f"{folder}/{estimate}-{workers}-{turn}.h5"
                words = [sys.executable, "-c", RUN, str(warm), study, output, str(workers)]
                # as `pound run` sets it: other threads wait for work on a core, which counts
                environment = {**os.environ, "PYTHONPATH": str(tree), "OPENBLAS_NUM_THREADS": "1"}
                done = subprocess.run(words, cwd=tree, env=environment, check=True, capture_output=True, text=True)
                found[estimate, workers, tree].append(json.loads(done.stdout.splitlines()[-1]))
                for file in Path(folder).glob("*.h5"):
                    file.unlink()
    rows = []
    for (estimate, workers, tree), runs in found.items():
        least = {name: min(run[name] for run in runs) for name in runs[0]}
        rows.append({"estimate": estimate, "workers": workers, "tree": str(tree), **least})
    return rows


def parts(rows: list[dict]) -> dict:
    """Seconds a scene with one worker, and by how much two are quicker, of the rows of one tree."""
    of = {(row["estimate"], row["workers"]): row for row in rows}
    none, default = of["none", 1], of["all", 1]
    scenes = none["scenes"]
    return {
        "scenes": scenes,
        "solver": none["solver"] / scenes,
        "overhead": (none["core"] - none["solver"]) / scenes,
        "estimates": (default["core"] - none["core"]) / scenes,
        "default_over_none": default["core"] / none["core"],
        "two_workers": {name: of[name, 1]["wall"] / of[name, 2]["wall"] for name in ESTIMATES},
        "rows": [{name: value for name, value in row.items() if name != "tree"} for row in rows],
    }


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m tests.bench.batch", description=__doc__)
    parser.add_argument("--periods", type=int, default=20, help="periods of the second building")
    parser.add_argument("--turns", type=int, default=6, help="runs of each, of which the least counts")
    parser.add_argument("--against", type=Path, help="another checkout, measured in turns with this one")
    options = parser.parse_args()
    trees = (ROOT, *([options.against.resolve()] if options.against else []))
    rows = measure(options.periods, options.turns, trees)
    for tree in trees:
        found = parts([row for row in rows if row["tree"] == str(tree)])
        print(tree, json.dumps(found, indent=1))


if __name__ == "__main__":
    main()
