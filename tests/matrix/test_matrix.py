"""Every question, from every engine, killed and run again: the same tables as from one process that nobody disturbs."""

from __future__ import annotations

import multiprocessing
import os
import signal
from functools import cache

import psutil
import pytest

import pounding_cli as pound
from tests.matrix.machines import Machines
from tests.matrix.work import STUDIES, Interrupting, answered, killed, written

pytestmark = pytest.mark.xdist_group("matrix")  # one cluster for all of them

SCENES = ("storey", "floor", "link", "scene", "records")
HALF = {"run": 33, "gap": 25, "fragility": 10, "sensitivity": 64, "optimise": 32}
"""Half of the scenes of each question."""


@pytest.fixture(scope="module")
def machines(tmp_path_factory):
    """Where schedulers and workers are started."""
    machines = Machines(tmp_path_factory.mktemp("cluster"))
    yield machines
    machines.end()


@pytest.fixture(scope="module")
def scheduler(machines):
    """Gives the address of a scheduler with two workers, started when it is first asked for."""

    @cache
    def started() -> str:
        address = machines.scheduler()
        machines.workers(address, 2)
        return address

    return lambda engine: started() if engine == "dask" else ""


@pytest.fixture(scope="module")
def forks():
    """Starts processes that have what they need loaded."""
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["tests.matrix.ready"])
    return context


@pytest.fixture(scope="module")
def wanted(tmp_path_factory):
    """Gives the tables of a question from one process."""

    @cache
    def of(workflow: str) -> dict:
        folder = tmp_path_factory.mktemp(workflow)
        return tables(answered(workflow, "serial", written(workflow, folder), folder / "r.h5"))

    return of


def tables(results: pound.Results) -> dict:
    """Every table, without the time that scenes took; and a history, as bytes."""
    found = {name: results.table(name).drop(columns="seconds", errors="ignore") for name in (*SCENES, *results.answers)}
    if len(results.histories()):
        found["history"] = results.history(record="taft").frame("displacement")
    return found


def differences(one: dict, other: dict) -> list[str]:
    """Columns that differ in a bit, and tables without anything to compare; few motions give no curves."""
    assert one.keys() == other.keys()
    found = [f"{name} is empty" for name, frame in one.items() if frame.empty and name != "fragility_curves"]
    for name, frame in one.items():
        if not frame.equals(other[name]):
            found += [
                f"{name}.{column}: {frame[column].compare(other[name][column]).head(3).to_dict('list')}"
                for column in frame
                if not frame[column].equals(other[name][column])
            ]
    return found


def skip_by_day(workflow: str, by_day: tuple[str, ...]) -> None:
    """Skip what `make reference` runs every night."""
    if workflow not in by_day and "POUND_NIGHTLY" not in os.environ:
        pytest.skip("make reference runs it every night")


@pytest.mark.parametrize("engine", ["threads", "processes", "dask"])
@pytest.mark.parametrize("workflow", STUDIES)
def test_every_engine_gives_the_same_tables(workflow, engine, wanted, scheduler, tmp_path):
    if engine != "threads":
        skip_by_day(workflow, ("run",))
    results = answered(workflow, engine, written(workflow, tmp_path), tmp_path / "r.h5", scheduler(engine))
    assert results.attrs["engine"] == engine
    assert not differences(tables(results), wanted(workflow))


@pytest.mark.parametrize("engine", ["serial", "processes", "dask"])
@pytest.mark.parametrize("workflow", STUDIES)
def test_killed_and_run_again_it_gives_the_same_tables(workflow, engine, wanted, scheduler, forks, tmp_path):
    """Killed when half of its scenes are back; the second run solves only the rest."""
    skip_by_day(workflow, ("run", "gap") if engine == "serial" else ("run",))
    study, output, address = written(workflow, tmp_path), tmp_path / "r.h5", scheduler(engine)
    run = forks.Process(target=killed, args=(workflow, engine, study, output, address, HALF[workflow]))
    run.start()
    run.join()
    assert run.exitcode == -signal.SIGKILL
    assert not output.exists()
    results = answered(workflow, engine, study, output, address)
    assert results.attrs["scenes_reused_last"] >= HALF[workflow] / 2
    assert results.attrs["scenes_solved_last"] > 0
    assert not differences(tables(results), wanted(workflow))


def test_a_worker_process_that_is_killed_costs_nothing(wanted, tmp_path):
    def kill() -> None:
        workers = [each for each in me.children(recursive=True) if each.ppid() != me.pid and each not in before]
        dead.append(workers.pop())
        dead[0].kill()

    me = psutil.Process()
    before, dead = set(me.children(recursive=True)), []
    study = written("run", tmp_path)
    results = answered("run", "processes", study, tmp_path / "r.h5", progress=Interrupting(40, kill))
    assert dead
    assert not differences(tables(results), wanted("run"))


def test_a_dask_worker_that_is_killed_costs_nothing(wanted, machines, scheduler, tmp_path):
    address = scheduler("dask")
    (doomed,) = machines.workers(address, 1)
    study = written("run", tmp_path)
    results = answered("run", "dask", study, tmp_path / "r.h5", address, Interrupting(40, doomed.kill))
    assert doomed.wait(20) == -signal.SIGKILL
    assert not differences(tables(results), wanted("run"))
