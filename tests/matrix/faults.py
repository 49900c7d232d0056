"""What a run and its files stand, as counts: `python -m tests.matrix.faults [--kills 50] [--flips 200]`.

Kills: a run by SIGKILL at random moments, alone or with worker processes, and run again until it ends: the same tables.
Flips: a bit of a results file, or of a cache, changed at a random place: refused, or the same tables.
"""

from __future__ import annotations

import argparse
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pounding_cli as pound
from tests.matrix.test_matrix import same, tables
from tests.matrix.work import written


def main() -> int:
    """Count what went wrong."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=50)
    parser.add_argument("--flips", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    draw = random.Random(asked.seed)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        study = written("run", folder)
        _solve("serial", study, folder / "first.h5")  # compiles
        begin = time.perf_counter()
        wanted = _solve("serial", study, folder / "wanted.h5")
        span = time.perf_counter() - begin
        wrong = _kills(asked.kills, draw, study, folder, wanted, span) + _flips(
            asked.flips, draw, study, folder, wanted
        )
    return int(wrong > 0)


def _command(engine: str, study: Path, output: Path) -> list[str]:
    code = (
        "import sys; from pathlib import Path; from tests.matrix.work import answered; "
        "answered('run', sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3]))"
    )
    return [sys.executable, "-c", code, engine, str(study), str(output)]


def _solve(engine: str, study: Path, output: Path) -> dict:
    subprocess.run(_command(engine, study, output), check=True)
    return tables(pound.open_results(output))


def _kills(count: int, draw: random.Random, study: Path, folder: Path, wanted: dict, span: float) -> int:
    """Runs that are killed and run again; returns how many ended with other tables."""
    killed = finished = wrong = 0
    while killed < count:
        engine, output = draw.choice(("serial", "threads", "processes")), folder / f"killed{finished}.h5"
        while True:
            process = subprocess.Popen(_command(engine, study, output), start_new_session=True)
            try:
                process.wait(draw.uniform(0.3, 1.3) * span)
                break
            except subprocess.TimeoutExpired:
                os.kill(process.pid, signal.SIGKILL)  # its workers are to end by themselves
                process.wait()
                killed += 1
        finished += 1
        wrong += process.returncode != 0 or not same(tables(pound.open_results(output)), wanted)
    time.sleep(2.0)
    left = subprocess.run(["pgrep", "-fc", "tests.matrix.work"], capture_output=True, text=True).stdout.strip()
    print(f"{killed} kills, {finished} finishes, {wrong} with other tables; processes left: {left}")
    return wrong


def _flips(count: int, draw: random.Random, study: Path, folder: Path, wanted: dict) -> int:
    """Files of which a bit is changed; returns how many told other numbers."""
    refused = wrong = 0
    for _ in range(count):
        path = _flipped(folder / "wanted.h5", folder / "flipped.h5", draw)
        try:
            found = tables(pound.open_results(path))
        except pound.InputError:
            refused += 1
        else:
            wrong += not same(found, wanted)
    print(f"{count} flips of a results file: {refused} refused, {wrong} with other tables")
    again = 0
    for number in range(count // 20):
        output = folder / f"cache{number}.h5"
        cache = _flipped(folder / "wanted.h5.cache", output.with_name(f"{output.name}.cache"), draw, 30)
        results = pound.run(study, output, engine="serial")
        again += int(results.attrs["scenes_solved_last"])
        wrong += not same(tables(results), wanted)
        cache.unlink()
    print(
        f"{count // 20} caches with 30 flips each: {again} scenes solved again; {wrong} files with other tables in all"
    )
    return wrong


def _flipped(source: Path, path: Path, draw: random.Random, bits: int = 1) -> Path:
    shutil.copy(source, path)
    with path.open("r+b") as stream:
        for _ in range(bits):
            place = draw.randrange(source.stat().st_size)
            stream.seek(place)
            byte = stream.read(1)[0]
            stream.seek(place)
            stream.write(bytes([byte ^ (1 << draw.randrange(8))]))
    return path


if __name__ == "__main__":
    sys.exit(main())
