"""What a run holds of every scene: 100,000 scenes must fit into 500 MB, of which the libraries take up to 300."""

from __future__ import annotations

import dataclasses
import gc
import tracemalloc
from pathlib import Path

import h5py
import numpy as np

from pounding_cli.batch import run_plan
from pounding_cli.batch.attempt import Task
from pounding_cli.batch.bundles import solve_bundle
from pounding_cli.batch.families import order_of
from pounding_cli.digests import DigestTable, packed, pieces
from pounding_cli.solve import solve
from pounding_cli.store import PartStore
from pounding_cli.store.chunk import Chunk
from pounding_cli.store.codec import encode
from pounding_cli.store.datasets import Datasets
from pounding_cli.store.dense import facts, shape_of
from pounding_cli.study import load_study
from pounding_cli.study.kinds import load_for
from pounding_cli.workflows import expansion
from tests.helpers.plans import known, small_plan

from . import sweep

MOST = 1500.0
"""Held at the same time for each scene, at most [bytes]."""

MOST_OF_A_POINT = 150.0
"""What a plan and the order of its scenes keep of a point with one scene, at most [bytes]."""

MOST_OF_A_QUESTION = 160.0
"""What a plan of `pound fragility` keeps of every scene that it may ask for, at most [bytes]."""

MOST_OF_A_RESPONSE = 40.0
"""What is held of a response that is on disk, at most [bytes]."""

MOST_OF_A_POINTS_LINKS = 100.0
"""What writing takes of the five links of a point, at most [bytes]."""

MOST_OF_A_WORKER = 2000.0
"""What a worker keeps of each scene once it keeps as much as it may, at most [bytes]."""


def noisy(scene, **settings):
    """Shears and closings that differ from scene to scene."""
    found = known(scene, **settings)
    share = 1 + int(scene.digest[:4], 16) / 2**16
    buildings = tuple(dataclasses.replace(each, shear=share * each.shear) for each in found.buildings)
    links = dataclasses.replace(found.links, max_closing=np.full(len(scene.links), 0.01 * share))
    return dataclasses.replace(found, buildings=buildings, links=links)


def held(command: str, count: int, folder: Path) -> tuple[int, int]:
    """Scenes of a run, and what it held at most [bytes]."""
    path = folder / f"{count}.yaml"
    path.write_text(sweep.study_of(command, count))
    gc.collect()
    tracemalloc.start()
    plan = expansion(command)(load_study(path))
    run_plan(plan, path.with_suffix(".h5"), solve=noisy, engine_name="serial")
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return sweep.scenes_of(path.with_suffix(".h5")), peak


def test_little_is_held_of_every_scene(tmp_path, monkeypatch):
    """Fails if scenes or responses stay in memory: a response of two buildings of five storeys takes 10 kB."""
    monkeypatch.setattr("pounding_cli.study.sections.MOST_KEPT", 200)  # what is kept for scenes to come has a bound
    monkeypatch.setattr("pounding_cli.store.blocks.BLOCK_BYTES", 1 << 16)
    held("gap", 20, tmp_path)  # what is made once
    (few, low), (many, high) = (held("gap", count, tmp_path) for count in (200, 800))
    assert many > 3 * few
    assert (high - low) / (many - few) < MOST


def test_a_store_holds_little_of_every_response(tmp_path):
    """Fails if digests that the plan has are held once more, or where the numbers of a response stand."""
    random = np.random.default_rng(1)
    digests = [random.bytes(32).hex() for _ in range(20_000)]
    line, numbers = encode(known(next(iter(small_plan().scenes.values()))))
    written = PartStore(tmp_path / "r.h5", "key")
    for some in pieces(digests, 500):
        written.add(Chunk(some, [line], np.zeros(len(some), np.int64), np.tile(numbers, len(some))))
        written.flush()
    table = DigestTable(packed(digests))
    assert table.numbers(digests[:1]).tolist() == [0]  # the plan has it sorted
    gc.collect()
    tracemalloc.start()
    store = PartStore(tmp_path / "r.h5", "key", table)
    store.load()
    held = tracemalloc.get_traced_memory()[0]
    tracemalloc.stop()
    assert store.has(digests).all()
    assert held / len(digests) < MOST_OF_A_RESPONSE


def test_links_are_written_a_slab_at_a_time(tmp_path, monkeypatch):
    """A variable of the links of a million points takes 40 MB: fails if one is made whole."""
    monkeypatch.setattr("pounding_cli.store.packed.PIECE_BYTES", 1 << 12)
    path = tmp_path / "study.yaml"
    path.write_text(sweep.study_of("run", 6400))
    plan = expansion("run")(load_study(path))
    solved = PartStore.of({digest: noisy(plan.scenes[digest]) for digest in list(plan.scenes)[:2]})
    monkeypatch.setattr(PartStore, "storeys", lambda store, digests: 5)
    found = facts(plan, shape_of(plan, solved))
    with h5py.File(tmp_path / "r.h5", "w") as file:
        datasets = Datasets(file)
        tracemalloc.start()
        for name in ("kind", "gap"):
            dims, array = found[name]
            assert array.size == 5 * 6400
            datasets.write(name, dims, array, "", "")
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
    assert peak < 6400 * MOST_OF_A_POINTS_LINKS


def test_a_worker_stops_growing(tmp_path, monkeypatch):
    """Scenes of which no two share a law: whatever is kept of them has a bound."""
    monkeypatch.setattr("pounding_cli.study.sections.MOST_KEPT", 200)
    path = tmp_path / "study.yaml"
    path.write_text(sweep.study_of("run", 900))
    plan = expansion("run")(load_study(path))
    task, digests = Task(solve, plan.accuracy, plan.method, plan.estimate), list(plan.scenes)
    sizes = []
    tracemalloc.start()
    for some in (digests[:600], digests[600:750], digests[750:900]):
        solve_bundle(some, plan.scenes.__getitem__, task, work=600.0)
        gc.collect()
        sizes.append(tracemalloc.get_traced_memory()[0])
    tracemalloc.stop()
    assert sizes[2] - sizes[1] < 150 * MOST_OF_A_WORKER, sizes


def test_a_plan_holds_little_of_every_point(tmp_path, monkeypatch):
    """A million points must fit beside the rest: fails if digests are texts, or if rows, scenes or links are kept."""
    monkeypatch.setattr("pounding_cli.study.sections.MOST_KEPT", 200)
    monkeypatch.setattr("pounding_cli.study.links.MOST_KNOWN", 50)
    sizes = []
    for count in (400, 800, 2400):
        path = tmp_path / f"{count}.yaml"
        path.write_text(sweep.study_of("run", count))
        study = load_study(path)
        gc.collect()
        tracemalloc.start()
        plan = expansion("run")(study)
        order = order_of(plan, lambda digests: np.zeros(len(digests), bool))
        assert plan.scenes.place(order.digests[-1]) >= 0  # what is looked up once is kept
        gc.collect()
        sizes.append(tracemalloc.get_traced_memory()[0])
        tracemalloc.stop()
    assert (sizes[2] - sizes[1]) / 1600 < MOST_OF_A_POINT, sizes


def test_little_is_kept_of_what_may_be_asked(tmp_path, monkeypatch):
    """A search asks for some of its scenes. Fails if digests of all are texts, or demands are kept one by one."""
    monkeypatch.setattr("pounding_cli.study.sections.MOST_KEPT", 200)
    sizes, counts = [], []
    for count in (840, 2520, 5880):
        path = tmp_path / f"{count}.yaml"
        path.write_text(sweep.study_of("fragility", count))
        study = load_for(path, "fragility")
        gc.collect()
        tracemalloc.start()
        plan = expansion("fragility")(study)
        gc.collect()
        sizes.append(tracemalloc.get_traced_memory()[0])
        counts.append(len(plan.rows.table))
        tracemalloc.stop()
    assert (sizes[2] - sizes[1]) / (counts[2] - counts[1]) < MOST_OF_A_QUESTION, sizes
