"""Schedulers and workers of Dask on this machine, for tests that break them."""

from __future__ import annotations

import pytest

from tests.helpers.clusters import Machines
from tests.helpers.plans import small_plan


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
