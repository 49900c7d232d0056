"""The dask engine against a real scheduler and two worker processes on this machine, one of which is killed."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from pounding_cli.api import open_results
from pounding_cli.batch import run_plan
from pounding_cli.errors import InputError

TESTS = Path(__file__).parents[1]
IMPORTED = [str(TESTS / "cluster"), str(TESTS / "unit" / "store")]
"""Where the workers find the solver, as this process does."""

sys.path[:0] = IMPORTED
from slow_solver import solve_slowly  # noqa: E402
from study_plans import small_plan  # noqa: E402


@pytest.fixture
def plan(monkeypatch):
    """120 scenes, given to workers though they take little time."""
    monkeypatch.setattr("pounding_cli.batch.runner.WORTH_WORKERS", 0.0)
    monkeypatch.setattr("pounding_cli.batch.cluster.WORK", 0.1)
    return small_plan(records=tuple((f"r{number}", float(number)) for number in range(1, 16)))


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    """A scheduler's address, and its two workers."""
    folder = tmp_path_factory.mktemp("cluster")
    here = os.pathsep.join([*IMPORTED, os.environ.get("PYTHONPATH", "")])
    started = []

    def start(*arguments: str) -> subprocess.Popen:
        command = [sys.executable, "-m", f"distributed.cli.{arguments[0]}", *arguments[1:]]
        silent = subprocess.DEVNULL
        process = subprocess.Popen(
            command, cwd=folder, env={**os.environ, "PYTHONPATH": here}, stdout=silent, stderr=silent
        )
        started.append(process)
        return process

    start("dask_scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--scheduler-file", "s.json")
    while not (folder / "s.json").exists():
        time.sleep(0.05)
    time.sleep(0.1)
    address = json.loads((folder / "s.json").read_text())["address"]
    workers = [start("dask_worker", address, "--no-nanny", "--nthreads", "1", "--no-dashboard") for _ in range(2)]
    yield address, workers
    for process in reversed(started):
        process.terminate()
    for process in started:
        try:
            process.wait(timeout=20)
        except subprocess.TimeoutExpired:  # a busy machine; what the tests asked has been answered by now
            process.kill()
            process.wait()


class Killing:
    """Progress that kills a worker once some scenes are back."""

    def __init__(self, worker: subprocess.Popen) -> None:
        self.worker, self.steps, self.at_death = worker, 0, 0

    def start(self, total, reused): ...

    def step(self, done, failed):
        self.steps += done
        if not self.at_death and self.steps > 20:
            self.at_death = self.steps
            self.worker.send_signal(signal.SIGKILL)

    def say(self, sentence): ...

    def compiled(self): ...

    def stop(self): ...


def rows(path):
    results = open_results(path)
    return {
        name: getattr(results, name)().drop(columns="seconds", errors="ignore") for name in ("storey", "link", "scene")
    }


def test_same_rows_as_in_this_process_though_a_worker_is_killed(plan, cluster, tmp_path):
    address, workers = cluster
    killing = Killing(workers[0])
    outcome = run_plan(
        plan, tmp_path / "d.h5", engine_name="dask", scheduler=address, solve=solve_slowly, progress=killing
    )
    assert killing.at_death < len(plan.scenes) - 20, "the worker died too late to show anything"
    workers[0].wait(timeout=5)
    assert workers[0].returncode == -signal.SIGKILL
    assert (outcome.engine, outcome.done, outcome.failed) == ("dask", len(plan.scenes), 0)
    run_plan(plan, tmp_path / "s.h5", engine_name="serial", solve=solve_slowly)
    one, other = rows(tmp_path / "d.h5"), rows(tmp_path / "s.h5")
    for name in one:
        assert one[name].equals(other[name]), name


def test_a_scheduler_that_is_not_there(plan, tmp_path, monkeypatch):
    monkeypatch.setattr("pounding_cli.batch.cluster.PATIENCE", 0.3)
    with pytest.raises(InputError, match=r"tcp://127.0.0.1:9 does not answer") as refused:
        run_plan(plan, tmp_path / "d.h5", engine_name="dask", scheduler="tcp://127.0.0.1:9", solve=solve_slowly)
    assert "run the same command again" in refused.value.problems[0].hint
    assert [path.name for path in tmp_path.glob("d.h5*")] == ["d.h5.parts"]
