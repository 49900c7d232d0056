"""The dask engine against a real scheduler and two worker processes on this machine, one of which is killed."""

from __future__ import annotations

import signal

import pytest

from pounding_cli.api import open_results
from pounding_cli.batch import run_plan
from tests.helpers.clusters import AfterSome
from tests.helpers.slow_solver import solve_slowly


@pytest.fixture(scope="module")
def cluster(shared):
    """A scheduler's address, and its two workers."""
    address, _ = shared.scheduler()
    return address, [shared.worker(address) for _ in range(2)]


def rows(path):
    results = open_results(path)
    return {
        name: getattr(results, name)().drop(columns="seconds", errors="ignore") for name in ("storey", "link", "scene")
    }


def test_same_rows_as_in_this_process_though_a_worker_is_killed(plan, cluster, tmp_path):
    address, workers = cluster
    killing = AfterSome(lambda: workers[0].send_signal(signal.SIGKILL))
    outcome = run_plan(
        plan, tmp_path / "d.h5", engine_name="dask", scheduler=address, solve=solve_slowly, progress=killing
    )
    assert killing.at < len(plan.scenes) - 20, "the worker died too late to show anything"
    workers[0].wait(timeout=60)
    assert workers[0].returncode == -signal.SIGKILL
    assert (outcome.engine, outcome.done, outcome.failed) == ("dask", len(plan.scenes), 0)
    run_plan(plan, tmp_path / "s.h5", engine_name="serial", solve=solve_slowly)
    one, other = rows(tmp_path / "d.h5"), rows(tmp_path / "s.h5")
    for name in one:
        assert one[name].equals(other[name]), name
