"""Many scenes by one command: time and memory of all its processes together.

`python -m tests.bench.sweep COMMAND SCENES [ENGINE]` measures run, gap, fragility, sensitivity or optimise;
`python -m tests.bench.sweep resume SCENES [SECONDS]` how soon a run that was killed goes on."""

from __future__ import annotations

import math
import os
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path
from string import Template

import h5py

from pounding_cli.store.locks import lock_of

from .clock import ROOT
from .program import pound

STUDY = """\
records: {{use: [elcentro], duration: 2 s}}
buildings:
  stiff: {{storeys: 5, period: 0.36 s}}
  soft:  {{like: stiff, period: 0.60 s}}
group: [stiff, soft]
cases:
  gap: {{link: pounding, gap: 2 cm}}
analyses: [elastic]
accuracy: 1e-6
estimate: none
sweep:
  impact.restitution: [{first}]
  cases.gap.gap: [{second}]
"""

GAP = """\
records: {{use: [elcentro], duration: 2 s}}
buildings:
  stiff: {{storeys: 5, period: 0.36 s}}
  soft:  {{storeys: 5, period: 0.60 s}}
group: [stiff, soft]
cases: {{any: {{link: none}}}}
analyses: [elastic]
estimate: none
sweep:
  buildings.stiff.period: [{first}]
  buildings.soft.period: [{second}]
"""


_PAIR = """\
records: {use: [$motions], duration: 2 s}
buildings:
  stiff: {storeys: 1, period: 0.36 s}
  soft:  {storeys: 1, period: 0.60 s}
group: [stiff, soft]
cases: {gap: {link: pounding, gap: 2 cm}}
analyses: [elastic]
estimate: none
"""

FRAGILITY = """\
fragility: {limits: [drift > 1 %, contact], draws: 100}
sweep:
  buildings.soft.period: [$many]
  records.scale.pga: {from: 0.05 g, to: 1 g, step: 0.05 g}
"""

SENSITIVITY = """\
sensitivity: {outputs: [largest V_ratio], samples: $many}
uncertain:
  buildings.soft.period: {uniform: {from: 0.5 s, to: 1 s}}
  cases.gap.gap: {uniform: {from: 0 cm, to: 5 cm}}
  impact.restitution: {uniform: {from: 0.4, to: 0.65}}
"""

OPTIMISE = """\
optimise:
  least: largest V_ratio
  generations: 50
  population: $many
  over:
    buildings.soft.period: {from: 0.5 s, to: 1 s}
    cases.gap.gap: {from: 0 cm, to: 5 cm}
    impact.restitution: {from: 0.4, to: 0.65}
"""

COMMANDS = ("run", "gap", "fragility", "sensitivity", "optimise")


def study_of(command: str, count: int) -> str:
    """A study of about so many scenes; of `fragility` and `optimise` the answers decide how many."""
    motions = "elcentro"
    if command == "fragility":  # about 84 scenes a period
        text, many = FRAGILITY, numbers(0.5, 1.0, max(1, count // 84))
        motions = "elcentro, taft, eureka, olympia, parkfield"
    elif command == "sensitivity":  # Sobol: five points and two periods for each base sample
        text, many = SENSITIVITY, str(2 ** max(1, round(math.log2(count / 7))))
    elif command == "optimise":  # two scenes a point
        text, many = OPTIMISE, str(max(5, count // 100))
    else:
        return _grid(command, count)
    return Template(_PAIR + text).substitute(motions=motions, many=many)


def _grid(command: str, count: int) -> str:
    first = round(count**0.5)
    while count % first:
        first -= 1
    text, ranges = (STUDY, ((0.3, 0.7), (0.0, 0.04))) if command == "run" else (GAP, ((0.2, 1.0), (0.3, 2.0)))
    return text.format(first=numbers(*ranges[0], first), second=numbers(*ranges[1], count // first))


def run(count: int, command: str = "run", engine: str = "processes") -> dict:
    """Solve about `count` scenes; memory is the largest of all processes together (`family_memory`), in all and of
    every stage, and the largest resident set of the main process alone [bytes]."""
    with tempfile.TemporaryDirectory() as folder:
        study, results = Path(folder) / "sweep.yaml", Path(folder) / "sweep.h5"
        study.write_text(study_of(command, count))
        load, begin = f"{os.getloadavg()[0]:.1f}", time.perf_counter()
        process = subprocess.Popen(
            [*pound(), command, str(study), "-o", str(results), "--engine", engine],
            cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        watcher = Watcher(process.pid, results)
        watcher.start()
        code = process.wait()
        wall = time.perf_counter() - begin
        watcher.join()
        if code:
            raise RuntimeError(f"pound {command} ended with {code}")
        scenes, size = count if command == "run" else scenes_of(results), results.stat().st_size
    found = {"scenes": scenes, "wall": wall, "memory": watcher.largest, "stages": watcher.stages}
    return found | {"main": watcher.main, "file": size, "load": load}


def resume(count: int, seconds: float = 60.0) -> dict:
    """Kill `pound run` so long [s] after its first part, and begin it again: the parts it had, the time until the first
    new one [s], by the clock and of all cores, and the memory of all processes until it was killed [bytes]."""
    with tempfile.TemporaryDirectory() as folder:
        study, results = Path(folder) / "sweep.yaml", Path(folder) / "sweep.h5"
        study.write_text(study_of("run", count))
        found: dict = {}
        memory = 0
        for wait in (seconds, 0.0):
            had, begin = _parts(results), time.perf_counter()
            command = [*pound(), "run", str(study), "-o", str(results)]
            process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            watcher = Watcher(process.pid, results)
            watcher.start()
            while _parts(results) == had:
                if process.poll() is not None:
                    raise RuntimeError(f"pound run ended with {process.returncode} before it was killed")
                time.sleep(0.05)
            found = {"parts": had, "until_first": time.perf_counter() - begin, "on_cores": family_seconds(process.pid)}
            time.sleep(wait)
            memory = max(memory, watcher.largest)
            process.kill()
            process.wait()
            time.sleep(2.0)  # its workers end as they see that it is gone
    return found | {"memory": memory}


def _parts(results: Path) -> int:
    return sum(path.suffix == ".part" for path in Path(f"{results}.parts").glob("*"))


def family_seconds(pid: int) -> float:
    """Time on the cores of a process and all below it [s] (Linux)."""
    total, waiting = 0, [pid]
    while waiting:
        here = waiting.pop()
        try:
            user, system = Path(f"/proc/{here}/stat").read_text().rpartition(")")[2].split()[11:13]
            for task in Path(f"/proc/{here}/task").iterdir():
                waiting += [int(child) for child in (task / "children").read_text().split()]
        except OSError:  # ended meanwhile
            continue
        total += int(user) + int(system)
    return total / os.sysconf("SC_CLK_TCK")


def scenes_of(results: Path) -> int:
    """Scenes in a results file."""
    with h5py.File(results) as file:
        return int(file.attrs["scenes"])


def numbers(low: float, high: float, count: int) -> str:
    """So many evenly spaced numbers, as a YAML list without its brackets."""
    return ", ".join(f"{low + (high - low) * place / max(1, count - 1):.9f}" for place in range(count))


class Watcher(threading.Thread):
    """Looks at a process and its children twice a second until it ends.

    stages : the largest memory while the study is `expanded`, kernels are compiled and scenes `solved`, the file is
        `written`, and after that, while the summary is `told` [bytes]
    """

    def __init__(self, pid: int, results: Path) -> None:
        super().__init__(daemon=True)
        self.pid, self.main, self.stages = pid, 0, dict[str, int]()
        self._results = results

    @property
    def largest(self) -> int:
        """The largest memory of all stages [bytes]."""
        return max(self.stages.values(), default=0)

    def run(self) -> None:
        while (now := family_memory(self.pid)) > 0:
            stage = self._stage()
            self.stages[stage] = max(self.stages.get(stage, 0), now)
            self.main = max(self.main, resident(self.pid))
            time.sleep(0.5)

    def _stage(self) -> str:
        if self._results.with_name(f".{self._results.name}.tmp").exists():
            return "written"
        if self._results.exists():
            return "told"
        return "solved" if lock_of(self._results).exists() else "expanded"


def family_memory(pid: int) -> int:
    """Memory of a process and all below it, pages that they share counted once [bytes]; 0 when it is gone (Linux).

    Of files, such as libraries, what the process itself has mapped: other programs may share that too, which makes its
    proportional share smaller than on a machine of its own.
    """
    total, files, waiting = 0, 0, [pid]
    while waiting:
        here = waiting.pop()
        try:
            rollup = Path(f"/proc/{here}/smaps_rollup").read_text()
            status = Path(f"/proc/{here}/status").read_text()
            for task in Path(f"/proc/{here}/task").iterdir():
                waiting += [int(child) for child in (task / "children").read_text().split()]
        except OSError:  # ended meanwhile
            continue
        total += _bytes_of(rollup, "Pss_Anon") + _bytes_of(rollup, "Pss_Shmem")
        files = max(files, _bytes_of(status, "RssFile"))
    return total + files


def _bytes_of(text: str, name: str) -> int:
    """A line of kilobytes in a file of /proc [bytes]."""
    return sum(1024 * int(line.split()[1]) for line in text.splitlines() if line.startswith(f"{name}:"))


def resident(pid: int) -> int:
    """Largest resident set of a process so far [bytes]; 0 when it is gone (Linux)."""
    try:
        status = Path(f"/proc/{pid}/status").read_text()
    except OSError:
        return 0
    return _bytes_of(status, "VmHWM")


if __name__ == "__main__":
    if sys.argv[1] == "resume":
        print(resume(int(sys.argv[2]), *map(float, sys.argv[3:])))
    else:
        print(run(int(sys.argv[2]), *sys.argv[1:2], *sys.argv[3:]))
