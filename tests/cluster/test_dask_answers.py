"""Each of the four answers is the same from this process, from worker processes and from a Dask cluster."""

from __future__ import annotations

from contextlib import contextmanager
from pathlib import Path

import pytest

import pounding_cli
from pounding_cli.batch import cluster
from pounding_cli.batch.local_cluster import local_cluster
from pounding_cli.store import Results

PAIR = """\
title: Two small buildings
records: {use: [elcentro, taft], duration: 3 s, scale: {pga: 0.3 g}}
buildings:
  A: {storeys: 2, period: 0.3 s}
  B: {like: A, storeys: 1, period: 0.5 s}
group: [A, B]
cases: {near: {link: pounding, gap: 3 mm}}
analyses: [inelastic]
"""

QUESTIONS = {
    "gap": "sweep: {buildings.B.period: {from: 0.4 s, to: 0.9 s, count: 6}}\ngap: {contact: 10 %}\n",
    "fragility": "sweep: {records.scale.pga: {from: 0.05 g, to: 1 g, step: 0.05 g}}\n"
    "fragility: {limits: [mu > 2, contact], draws: 100}\n",
    "sensitivity": "uncertain:\n  buildings.A.mass: {uniform: {from: 100 t, to: 200 t}}\n"
    "  cases.near.gap: {uniform: {from: 1 mm, to: 5 mm}}\n"
    "sensitivity: {outputs: [largest V_ratio], samples: 4, draws: 100}\n",
    "optimise": "optimise:\n  least: largest V_ratio\n  over: {cases.near.gap: {from: 1 mm, to: 9 mm}}\n"
    "  population: 6\n  generations: 2\n  slice_points: 5\n",
}


def tables(results: Results) -> dict:
    """The answer, and the scenes that it rests on without the time that they took."""
    found = {name: results.table(name) for name in results.answers}
    return found | {
        name: getattr(results, name)().drop(columns="seconds", errors="ignore") for name in ("storey", "link", "scene")
    }


@pytest.fixture(scope="module")
def scheduler(shared) -> str:
    """The address of a scheduler with two workers."""
    address, _ = shared.scheduler()
    for _ in range(2):
        shared.worker(address)
    shared.wait(address, 2)
    return address


@pytest.mark.parametrize("workflow", QUESTIONS)
def test_the_same_answer_from_every_engine(workflow, scheduler, tmp_path, monkeypatch):
    """Bit for bit. Fails if an answer depends on which worker solved a scene, or on the order in which they finish."""
    monkeypatch.setattr("pounding_cli.batch.runner.WORTH_WORKERS", 1e-9)  # but for rounds of nothing
    monkeypatch.setattr("pounding_cli.batch.cluster.WORK", 0.02)
    monkeypatch.setattr("pounding_cli.batch.cluster.PATIENCE", 180.0)
    study = Path(tmp_path, "pair.yaml")
    study.write_text(PAIR + QUESTIONS[workflow])
    found = {}
    for engine in ("serial", "processes", "dask"):
        output, address = tmp_path / f"{engine}.h5", scheduler if engine == "dask" else None
        results = pounding_cli.run(study, output, workflow=workflow, engine=engine, workers=2, scheduler=address)
        assert results.attrs["engine"] == engine
        found[engine] = tables(results)
    for engine in ("processes", "dask"):
        assert found[engine].keys() == found["serial"].keys()
        for name, table in found["serial"].items():
            assert len(table) > 0
            assert table.equals(found[engine][name]), (engine, name)


def test_a_search_starts_one_cluster(tmp_path, monkeypatch):
    """A local cluster lasts through all rounds of a search, and ends with it."""
    monkeypatch.setattr("pounding_cli.batch.runner.WORTH_WORKERS", 1e-9)
    monkeypatch.setattr("pounding_cli.batch.cluster.WORK", 0.02)
    monkeypatch.setattr("pounding_cli.batch.cluster.PATIENCE", 180.0)
    rounds, told = [], []
    solve = cluster.Cluster.solve

    @contextmanager
    def counted(workers):
        with local_cluster(workers) as address:
            told.append("started")
            yield address
        told.append("ended")

    monkeypatch.setattr(cluster, "local_cluster", counted)
    monkeypatch.setattr(cluster.Cluster, "solve", lambda *given: rounds.append(1) or solve(*given))
    study = tmp_path / "pair.yaml"
    study.write_text(PAIR + QUESTIONS["optimise"])
    pounding_cli.run(study, tmp_path / "r.h5", workflow="optimise", engine="dask", workers=2)
    assert len(rounds) > 3
    assert told == ["started", "ended"]
