"""A sweep of many scenes by `pound run`: time and memory of all its processes together."""

from __future__ import annotations

import os
import subprocess
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


def run(count: int) -> dict:
    """Sweep `count` scenes; memory is the largest sum over the processes, shared pages counted once [bytes]."""
    first = round(count**0.5)
    while count % first:
        first -= 1
    with tempfile.TemporaryDirectory() as folder:
        study = Path(folder) / "sweep.yaml"
        study.write_text(STUDY.format(first=numbers(0.3, 0.7, first), second=numbers(0.0, 0.04, count // first)))
        load, begin = f"{os.getloadavg()[0]:.1f}", time.perf_counter()
        process = subprocess.Popen(
            [*pound(), "run", str(study), "-o", f"{folder}/sweep.h5", "-q"], cwd=ROOT, stdout=subprocess.DEVNULL
        )
        watcher = Watcher(process.pid)
        watcher.start()
        code = process.wait()
        wall = time.perf_counter() - begin
        watcher.join()
        if code:
            raise RuntimeError(f"pound run ended with {code}")
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
