"""A sweep of many scenes by `pound run`: time and memory of all its processes together.

`python -m tests.bench.sweep gap 100000` does the same with required gaps, every scene another pair of buildings."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

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


def run(count: int, command: str = "run") -> dict:
    """Sweep `count` scenes; memory is the largest sum over the processes, shared pages counted once [bytes].

    command : "run" or "gap"
    """
    first = round(count**0.5)
    while count % first:
        first -= 1
    with tempfile.TemporaryDirectory() as folder:
        study = Path(folder) / "sweep.yaml"
        text, ranges = (STUDY, ((0.3, 0.7), (0.0, 0.04))) if command == "run" else (GAP, ((0.2, 1.0), (0.3, 2.0)))
        study.write_text(text.format(first=numbers(*ranges[0], first), second=numbers(*ranges[1], count // first)))
        load, begin = f"{os.getloadavg()[0]:.1f}", time.perf_counter()
        process = subprocess.Popen(
            [*pound(), command, str(study), "-o", f"{folder}/sweep.h5", "-q"], cwd=ROOT, stdout=subprocess.DEVNULL
        )
        watcher = Watcher(process.pid)
        watcher.start()
        code = process.wait()
        wall = time.perf_counter() - begin
        watcher.join()
        if code:
            raise RuntimeError(f"pound {command} ended with {code}")
        size = (Path(folder) / "sweep.h5").stat().st_size
    return {"scenes": count, "wall": wall, "memory": watcher.largest, "file": size, "load": load}


def numbers(low: float, high: float, count: int) -> str:
    """So many evenly spaced numbers, as a YAML list without its brackets."""
    return ", ".join(f"{low + (high - low) * place / max(1, count - 1):.9f}" for place in range(count))


class Watcher(threading.Thread):
    """Looks at a process and its children twice a second until it ends."""

    def __init__(self, pid: int) -> None:
        super().__init__(daemon=True)
        self.pid, self.largest = pid, 0

    def run(self) -> None:
        while (now := family_memory(self.pid)) > 0:
            self.largest = max(self.largest, now)
            time.sleep(0.5)


def family_memory(pid: int) -> int:
    """Proportional set size of a process and all below it [bytes]; 0 when it is gone (Linux)."""
    total, waiting = 0, [pid]
    while waiting:
        here = waiting.pop()
        try:
            rollup = Path(f"/proc/{here}/smaps_rollup").read_text()
            for task in Path(f"/proc/{here}/task").iterdir():
                waiting += [int(child) for child in (task / "children").read_text().split()]
        except OSError:  # ended meanwhile
            continue
        total += sum(1024 * int(line.split()[1]) for line in rollup.splitlines() if line.startswith("Pss:"))
    return total


if __name__ == "__main__":
    print(run(int(sys.argv[2]), sys.argv[1]))
