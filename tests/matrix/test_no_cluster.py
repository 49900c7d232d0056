"""A cluster that is not there, or goes: refused in one sentence, and what is solved is kept."""

from __future__ import annotations

import pytest

import pounding_cli as pound
from tests.matrix import work
from tests.matrix.machines import Machines
from tests.night import NIGHTLY

pytestmark = pytest.mark.xdist_group("matrix")


@pytest.fixture
def refused(tmp_path, monkeypatch):
    """Gives the one problem of a run on a scheduler."""

    def of(address: str, patience: float = 2.0, progress=None):
        monkeypatch.setitem(work.THRESHOLDS, "pounding_cli.batch.pool.DASK_TIMEOUT", patience)
        study = work.written("run", tmp_path)
        with pytest.raises(pound.InputError) as caught:
            work.answered("run", "dask", study, tmp_path / "r.h5", address, progress)
        assert not (tmp_path / "r.h5").exists()
        (problem,) = caught.value.issues
        return problem

    return of


@pytest.mark.parametrize(
    ("address", "word"),
    [
        ("http://127.0.0.1:8786", "http"),
        ("tcp://127.0.0.1", "port"),
        ("127.0.0.1:dask", "answer"),
        ("tcp://127.0.0.1:9", "answer"),
    ],
)
def test_an_address_without_a_scheduler(refused, address, word):
    problem = refused(address)
    assert word in problem.message
    assert problem.hint


@NIGHTLY
def test_workers_that_are_all_killed(refused, tmp_path):
    """Fails if the scenes they were at are waited for, or those that were back are lost."""
    machines = Machines(tmp_path)
    try:
        address = machines.scheduler()
        workers = machines.workers(address, 1)
        killing = work.Interrupting(30, lambda: [each.kill() for each in workers])
        assert "worker" in refused(address, 5.0, killing).message
    finally:
        machines.end()
    results = work.answered("run", "serial", tmp_path / "pair.yaml", tmp_path / "r.h5")
    assert results.attrs["scenes_reused_last"] >= 30
