"""A study killed with SIGKILL at random moments and run again: `python -m tests.batch.kills --kills 50`.

Every trial begins from nothing, is killed once (its workers learn of it by themselves), and is run again to the end.
Its results file must then be that of a run nobody disturbed, byte for byte in every variable but the times, nothing
else may lie beside it, and no process may have had more than one chunk of its work done a second time."""

from __future__ import annotations

import argparse
import contextlib
import os
import random
import signal
import sys
import tempfile
import time
from collections import Counter, defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np

from pounding_cli.api import load_study
from pounding_cli.batch import attempt, bundles, run_plan, runner
from pounding_cli.store import open_results
from pounding_cli.study import expand

STUDY = """\
title: Two small buildings at many gaps
records: {use: [{file: shake.txt}, {file: rattle.txt}], duration: whole, scale: 1.0}
buildings:
  stiff: {storeys: 3, period: 0.3 s}
  soft: {like: stiff, storeys: 2, period: 0.5 s}
group: [stiff, soft]
cases:
  gap: {link: pounding, gap: 1 cm}
  infill: {link: infill, gap: 1 cm}
analyses: [elastic, inelastic]
estimate: none
sweep:
  - {cases.gap.gap: [GAPS], cases.infill.gap: [GAPS]}
"""
WORKERS = 2
TIMES = {"seconds"}


@dataclass
class Trial:
    """What became of one kill.

    moment : when it came [s]; missed : the run had ended before
    again : scenes solved a second time, by the process that had solved them; most : scenes in the largest bundle
    kept : scenes that the second run found solved
    """

    moment: float
    missed: bool
    again: dict[int, int]
    most: int
    kept: int


@contextlib.contextmanager
def small_chunks() -> Iterator[None]:
    """Workers whatever the work, and chunks of a twentieth of a second, so that there is something to interrupt."""
    before = runner.WORTH_WORKERS, bundles.CHUNK_SECONDS
    runner.WORTH_WORKERS, bundles.CHUNK_SECONDS = 0.0, 0.05
    try:
        yield
    finally:
        runner.WORTH_WORKERS, bundles.CHUNK_SECONDS = before


class Bench:
    """A study in a folder, a run of it nobody disturbs, and trials against that."""

    def __init__(self, folder: Path, gaps: int, pause: float) -> None:
        """`pause`: time added to every scene [s], so that there is a study to kill."""
        t = np.arange(0.0, 1.0, 0.02)
        np.savetxt(folder / "shake.txt", np.column_stack([t, 0.3 * np.sin(15 * t)]))
        np.savetxt(folder / "rattle.txt", np.column_stack([t, 0.4 * np.sin(25 * t)]))
        listed = ", ".join(f"{0.05 * (n + 1):.2f} cm" for n in range(gaps))
        (folder / "study.yaml").write_text(STUDY.replace("GAPS", listed))
        self.folder, self.pause = folder, pause
        self.plan = expand(load_study(folder / "study.yaml"))
        whole = folder / "whole.h5"
        run_plan(self.plan, whole, engine_name="serial")  # compiles, so that forks need not
        self.wanted = contents(whole)
        begin = time.monotonic()
        self.run(folder / "timed.h5", folder / "timed.log")
        self.seconds = time.monotonic() - begin
        assert contents(folder / "timed.h5") == self.wanted

    def run(self, output: Path, log: Path, moment: float | None = None) -> bool:
        """Run in a fork, and kill it at `moment` [s]; whether it had ended before."""
        child = os.fork()
        if child == 0:
            self._child(output, log)
        begin = time.monotonic()
        while True:
            pid, status = os.waitpid(child, os.WNOHANG)
            if pid:
                assert status == 0, f"the run ended with {status}"
                return True
            if moment is not None and time.monotonic() - begin >= moment:
                os.kill(child, signal.SIGKILL)
                os.waitpid(child, 0)
                return False
            time.sleep(0.001)

    def _child(self, output: Path, log: Path) -> None:
        """Solve, noting every scene and every bundle as they begin; never returns."""
        note = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_APPEND)
        solve, take, pause = attempt.Task.__call__, bundles.Queue.take, self.pause

        def noted_solve(task, scene):
            os.write(note, f"scene {os.getpid()} {scene.digest}\n".encode())
            time.sleep(pause)
            return solve(task, scene)

        def noted_take(queue, work=None):
            bundle = take(queue, work)
            os.write(note, f"bundle {os.getpid()} {len(bundle)}\n".encode())
            return bundle

        attempt.Task.__call__, bundles.Queue.take = noted_solve, noted_take  # type: ignore[method-assign]
        code = 1
        try:
            run_plan(self.plan, output, workers=WORKERS)
            code = 0
        finally:
            os._exit(code)

    def trial(self, number: int, moment: float) -> Trial:
        """Kill at a moment, run again, compare.  Raises AssertionError where something is not as it should be."""
        folder = self.folder / f"trial{number}"
        folder.mkdir()
        output = folder / "r.h5"
        missed = self.run(output, folder / "first.log", moment)
        if output.exists():
            assert contents(output) == self.wanted, "a results file that is not whole"
        assert self.run(output, folder / "second.log")
        assert contents(output) == self.wanted, "other tables"
        assert {path.name for path in folder.iterdir()} - {"first.log", "second.log"} == {"r.h5"}, "something is left"
        first = [(pid, digest) for pid, digest in pairs(folder / "first.log", "scene")]
        second = Counter(digest for _, digest in pairs(folder / "second.log", "scene"))
        again: dict[int, int] = defaultdict(int)
        for pid, digest in first:
            again[int(pid)] += digest in second
        sizes = [int(size) for _, size in pairs(folder / "first.log", "bundle")]
        kept = len(self.plan.scenes) - len(second)
        return Trial(moment, missed, dict(again), max(sizes, default=0), kept)


def pairs(log: Path, word: str) -> list[tuple[str, str]]:
    """The notes of one kind."""
    found = [line.split() for line in log.read_text().splitlines()] if log.exists() else []
    return [(pid, what) for kind, pid, what in found if kind == word]


def contents(path: Path) -> dict[str, bytes]:
    """Every variable of a results file as bytes, times left out, and every table's columns."""
    found: dict[str, bytes] = {}
    with h5py.File(path) as file:
        for name in file:
            if isinstance(file[name], h5py.Dataset) and name not in TIMES:
                values = file[name][()]
                found[name] = repr(values.tolist()).encode() if values.dtype == object else values.tobytes()
        found["digest"] = file["solutions/digest"][()].tobytes()
    results = open_results(path)
    for name in ("storey", "floor", "link", "scene", "summary", "records"):
        table = getattr(results, name)().drop(columns=TIMES, errors="ignore")
        found[f"table {name}"] = table.to_csv().encode()
    return found


def hunt(kills: int, seed: int, gaps: int, pause: float) -> list[Trial]:
    """Trials at random moments until so many runs were killed; those that ended before do not count."""
    chance = random.Random(seed)
    with tempfile.TemporaryDirectory() as name, small_chunks():
        bench = Bench(Path(name), gaps, pause)
        found: list[Trial] = []
        while sum(not trial.missed for trial in found) < kills:
            trial = bench.trial(len(found), chance.uniform(0.0, bench.seconds))
            # The scenes solved to compile and to estimate the time are the parent's chunk.
            worst = max(trial.again.values(), default=0)
            assert worst <= max(trial.most, SAMPLES), f"{worst} scenes run again by one process"
            assert sum(count > 0 for count in trial.again.values()) <= WORKERS + 1
            found.append(trial)
        return found


SAMPLES = 12
"""Two scenes of every sort: two cases and the buildings alone, elastic and inelastic."""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--gaps", type=int, default=60)
    options = parser.parse_args()
    found = hunt(options.kills, options.seed, options.gaps, 0.002)
    for trial in found:
        again = sum(trial.again.values())
        what = "ended before" if trial.missed else "killed"
        print(f"{trial.moment:6.3f} s  {what:12}  kept {trial.kept:4}  again {again:3}  bundle at most {trial.most:3}")
    ended = sum(trial.missed for trial in found)
    print(f"{len(found)} runs, {len(found) - ended} killed, every table as of an undisturbed run")
    return 0


if __name__ == "__main__":
    sys.exit(main())
