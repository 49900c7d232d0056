"""Schedulers and workers of Dask on this machine, which tests start, ask and kill."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from pathlib import Path

IMPORTED = [str(Path(__file__).parents[2])]
"""Where the workers find the solver, as this process does."""

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
