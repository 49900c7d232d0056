"""Schedulers and workers of Dask on this machine, for tests that break them."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

TESTS = Path(__file__).parents[1]
IMPORTED = [str(TESTS / "cluster"), str(TESTS / "unit" / "store")]
"""Where the workers find the solver, as this process does."""

sys.path[:0] = IMPORTED
from study_plans import small_plan  # noqa: E402

WITHOUT = "import sys; sys.modules['pounding_cli'] = None; from distributed.cli.{0} import main; main()"
"""A Dask program where this package cannot be imported."""


class Machines:
    """Starts Dask's programs in a folder, and ends them.

    processes : those started
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.processes: list[subprocess.Popen] = []

    def _start(self, program: str, *arguments: str, without: bool) -> subprocess.Popen:
        how = ["-c", WITHOUT.format(program)] if without else ["-m", f"distributed.cli.{program}"]
        here = os.pathsep.join([*IMPORTED, os.environ.get("PYTHONPATH", "")])
        silent = subprocess.DEVNULL
        process = subprocess.Popen(
            [sys.executable, *how, *arguments],
            cwd=self.folder,
            env={**os.environ, "PYTHONPATH": here},
            stdout=silent,
            stderr=silent,
        )
        self.processes.append(process)
        return process

    def scheduler(self, *options: str, without: bool = False) -> tuple[str, subprocess.Popen]:
        """Its address, and its process; `without` this package."""
        file = self.folder / f"s{len(self.processes)}.json"
        local = ("--host", "127.0.0.1", "--port", "0", "--no-dashboard")
        process = self._start("dask_scheduler", *local, "--scheduler-file", str(file), *options, without=without)
        deadline = time.monotonic() + 180
        while time.monotonic() < deadline:
            try:
                return json.loads(file.read_text())["address"], process
            except (OSError, ValueError):  # not there yet, or half written
                time.sleep(0.05)
        raise TimeoutError("no scheduler")

    def worker(self, address: str, *options: str, without: bool = False) -> subprocess.Popen:
        """A worker of one thread."""
        how = ("--no-nanny", "--nthreads", "1", "--no-dashboard")
        return self._start("dask_worker", address, *how, *options, without=without)

    @staticmethod
    def wait(address: str, workers: int) -> None:
        """Until the scheduler has that many workers."""
        from distributed import Client

        with Client(address, timeout=180, set_as_default=False) as client:
            client.wait_for_workers(workers, timeout=180)

    def end(self) -> None:
        for process in reversed(self.processes):
            process.terminate()
        for process in self.processes:
            try:
                process.wait(timeout=20)
            except subprocess.TimeoutExpired:  # a busy machine; what the tests asked has been answered by now
                process.kill()
                process.wait()


@pytest.fixture(scope="module")
def shared(tmp_path_factory):
    """Machines for all tests of a module."""
    machines = Machines(tmp_path_factory.mktemp("cluster"))
    yield machines
    machines.end()


@pytest.fixture
def machines(tmp_path):
    """Machines of one test, which it may break."""
    machines = Machines(tmp_path)
    yield machines
    machines.end()


@pytest.fixture
def plan(monkeypatch):
    """120 scenes, given to workers though they take little time."""
    monkeypatch.setattr("pounding_cli.batch.runner.WORTH_WORKERS", 0.0)
    monkeypatch.setattr("pounding_cli.batch.cluster.WORK", 0.1)
    monkeypatch.setattr("pounding_cli.batch.cluster.PATIENCE", 180.0)  # a busy machine may take minutes to answer
    return small_plan(records=tuple((f"r{number}", float(number)) for number in range(1, 16)))


class AfterSome:
    """Progress that does something once, when some scenes are back."""

    def __init__(self, action) -> None:
        self.action, self.steps, self.at = action, 0, 0

    def start(self, total, reused, ahead=0): ...

    def step(self, done, failed):
        self.steps += done
        if not self.at and self.steps > 20:
            self.at = self.steps
            self.action()

    def say(self, sentence): ...

    def compiled(self): ...

    def stop(self): ...
