"""A scheduler and workers of Dask on this machine."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from pathlib import Path

SOURCE = str(Path(__file__).parents[2])


class Machines:
    """Starts Dask's programs in a folder, and ends them.

    processes : those started
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.processes: list[subprocess.Popen] = []

    def _start(self, program: str, *arguments: str) -> subprocess.Popen:
        """Its workers find the package where this process does."""
        paths = {"PYTHONPATH": os.pathsep.join([SOURCE, os.environ.get("PYTHONPATH", "")])}
        process = subprocess.Popen(
            [sys.executable, "-m", f"distributed.cli.{program}", *arguments],
            cwd=self.folder,
            env={**os.environ, **paths},
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        self.processes.append(process)
        return process

    def scheduler(self) -> str:
        """The address of a new one."""
        file = self.folder / f"s{len(self.processes)}.json"
        local = ("--host", "127.0.0.1", "--port", "0", "--no-dashboard")
        self._start("dask_scheduler", *local, "--scheduler-file", str(file))
        deadline = time.monotonic() + 180
        while time.monotonic() < deadline:
            try:
                return json.loads(file.read_text())["address"]
            except (OSError, ValueError):  # not there yet, or half written
                time.sleep(0.05)
        raise TimeoutError("no scheduler")

    def workers(self, address: str, count: int) -> list[subprocess.Popen]:
        """Workers of one thread, once the scheduler has them all."""
        from distributed import Client

        how = ("--no-nanny", "--nthreads", "1", "--no-dashboard")
        found = [self._start("dask_worker", address, *how) for _ in range(count)]
        with Client(address, timeout=180, set_as_default=False) as client:
            client.wait_for_workers(count, timeout=180)
        return found

    def end(self) -> None:
        """End them all, at once: nobody asks them anything more."""
        for process in self.processes:
            process.kill()
        for process in self.processes:
            process.wait()
