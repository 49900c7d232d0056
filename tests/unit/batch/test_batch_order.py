"""In which order scenes are solved, and in what portions."""

from __future__ import annotations

import dataclasses
import time

import numpy as np
import pytest

from pounding_cli.batch.attempt import Task
from pounding_cli.batch.bundles import MOST, Queue, solve_bundle
from pounding_cli.batch.families import order_of
from pounding_cli.solve import solve, tangent
from pounding_cli.store.chunk import Chunk
from pounding_cli.store.codec import parse
from pounding_cli.study import expand, load_study
from tests.helpers.plans import Axis, known, small_plan

MIXED = """\
records: {use: [elcentro, taft], duration: 2 s}
buildings:
  a: {storeys: 3, period: 0.3 s}
  b: {like: a, period: 0.5 s}
group: [a, b, a]
cases:
  gap: {link: pounding, gap: 2 cm}
  none: {link: none}
  far: {link: pounding, gap: 50 cm}
sweep:
  buildings.b.period: [0.4 s, 0.5 s]
  impact.restitution: [0.5, 0.6]
  records.scale.pga: [0.1 g, 0.2 g]
  cases.gap.gap: [1 cm, 2 cm, 50 cm]
"""


def solved_of(solved):
    """Whether scenes are among those."""
    return lambda digests: np.array([digest in solved for digest in digests], bool)


def test_families_stand_together_baselines_first():
    axis = Axis(("impact.damping_ratio",), ((0.1,), (0.2,)))
    plan = small_plan(axes=(axis,))
    order = order_of(plan, solved_of(()))
    assert sorted(order.digests) == sorted(plan.scenes)
    families = {row.baselines: None for row in plan.rows}
    place = {digest: number for number, digest in enumerate(order.digests)}
    ends = -1
    for family in families:
        linked = [row.scene for row in plan.rows if row.baselines == family]
        alone, others = [place[d] for d in family], [place[d] for d in dict.fromkeys(linked)]
        assert alone == list(range(ends + 1, ends + 1 + len(alone)))
        assert sorted(others) == list(range(max(alone) + 1, max(alone) + 1 + len(others)))
        ends = max(others)
    assert ends == len(plan.scenes) - 1


def test_what_is_solved_is_left_out_and_sorts_are_counted():
    plan = small_plan()
    rows = [row for row in plan.rows if row.analysis == "elastic"]
    order = order_of(plan, solved_of({row.scene for row in rows}))
    assert order.counts == {
        ("", "elastic"): 4,
        ("", "inelastic"): 4,
        ("touching", "inelastic"): 2,
        ("gap", "inelastic"): 2,
    }
    assert all(len(digests) == 2 for digests in order.samples.values())
    assert not {row.scene for row in rows} & set(order.digests)


def test_rows_that_ask_for_nothing_have_no_family():
    """A round of a search asks for few of its rows, each with baselines of its own."""
    plan = small_plan()
    row = plan.rows[5]
    asked = {digest: plan.scenes[digest] for digest in (row.scene, row.baselines[1])}
    order = order_of(dataclasses.replace(plan, scenes=asked), solved_of(()))
    assert list(order.digests) == [row.baselines[1], row.scene]
    assert order.counts == {("", row.analysis): 1, (row.case, row.analysis): 1}


def test_the_order_is_that_of_the_rows_taken_one_by_one(tmp_path):
    """Families by the first of their scenes that is left, baselines before linked scenes, each once; the first two of
    every sort are the samples. Fails if a family comes by a scene that is solved, or a sort takes another's samples."""
    path = tmp_path / "study.yaml"
    path.write_text(MIXED)
    plan = expand(load_study(path))
    solved = set(list(plan.scenes)[::3])
    families, samples, seen = {}, {}, set(solved)
    for row in plan.rows:
        for digest, sort in [*((d, ("", row.analysis)) for d in row.baselines), (row.scene, (row.case, row.analysis))]:
            if digest not in seen:
                seen.add(digest)
                families.setdefault(row.baselines, []).append(digest)
                samples.setdefault(sort, []).append(digest)
    order = order_of(plan, solved_of(solved))
    assert list(order.digests) == [digest for family in families.values() for digest in family]
    assert order.samples == {sort: digests[:2] for sort, digests in samples.items()}
    assert order.counts == {sort: len(digests) for sort, digests in samples.items()}
    sampled = {digest for digests in order.samples.values() for digest in digests}
    assert list(order.rest) == [digest for digest in order.digests if digest not in sampled]


def test_a_queue_gives_everything_once_in_order():
    names = [str(n) for n in range(5000)]
    queue, found = Queue(names, workers=2, seconds=0.001), []
    sizes = []
    while queue:
        bundle = queue.take()
        sizes.append(len(bundle))
        done = max(1, len(bundle) // 2)
        queue.give_back(bundle[done:])
        queue.learn(done, done * 0.001)
        found += bundle[:done]
    assert found == names
    assert sizes[0] == 500  # half a second of scenes of a millisecond
    assert sizes[-1] == 1
    assert max(sizes) <= MOST


def test_the_last_bundles_are_a_tenth_of_the_others_and_one_worker_has_no_need_of_them():
    """Fails if a run ends with twenty bundles of a few scenes, each of which is brought to the disk."""
    for workers, least in ((1, 500), (2, 50)):
        queue, sizes = Queue([str(n) for n in range(5000)], workers, seconds=0.001), []
        while queue:
            sizes.append(len(queue.take()))
        assert sizes[0] == 500
        assert sum(sizes) == 5000
        assert min(sizes[:-1]) == least


@pytest.mark.parametrize("family", [1, 31, 300, 3000])
def test_bundles_end_where_families_do(family):
    """So that baselines are solved by one worker alone. Fails if a family of a third of a bundle is cut, if a bundle
    grows or shrinks by more than half for one that is long, or if one is left out."""
    names = [str(n) for n in range(5000)]
    begins = np.arange(family - 2, 5000, family)
    queue, found, ends = Queue(names, 2, 0.001, begins), [], []
    while queue:
        wanted = min(500, max(len(queue) / 6, 50))
        bundle = queue.take()
        found += bundle
        ends.append(len(found))
        assert len(bundle) <= 1.5 * wanted + 1
        assert len(bundle) >= 0.5 * wanted or not queue
    assert found == names
    at_ends = np.isin(ends, [*begins, 5000])
    assert at_ends.all() if family <= 31 else at_ends.any()


def test_families_begin_among_the_scenes_that_are_left(tmp_path):
    """Fails if these places are those among all scenes where some are solved already."""
    (tmp_path / "study.yaml").write_text(MIXED)
    plan = expand(load_study(tmp_path / "study.yaml"))
    family: dict[str, tuple[str, ...]] = {}
    for row in plan.rows:
        for digest in (*row.baselines, row.scene):
            family.setdefault(digest, row.baselines)
    for solved in ((), list(plan.scenes)[::3]):
        order = order_of(plan, solved_of(solved))
        left = [family[digest] for digest in order.rest]
        assert order.begins.tolist() == [n for n in range(1, len(left)) if left[n] != left[n - 1]]
        assert len(order.begins) > 10


def test_bundles_follow_the_pace():
    queue = Queue([str(n) for n in range(100_000)], workers=2, seconds=0.001)
    queue.learn(1000, 100.0)
    assert len(queue.take()) == pytest.approx(5, abs=1)


def test_a_bundle_that_takes_too_long_comes_back_in_part():
    plan = small_plan()

    def slow(scene, accuracy, method, **_):
        time.sleep(0.02)
        return known(scene, accuracy, method)

    names = list(plan.scenes)
    begun: list[int] = []
    chunk, seconds = solve_bundle(names, plan.scenes.__getitem__, Task(slow, 1e-6, "taylor"), begun.append, work=0.03)
    assert 0 < len(chunk) < len(names)
    assert list(chunk.digests) == names[: len(chunk)]
    assert begun == list(range(len(chunk)))
    assert seconds > 0.06
    stopped, _ = solve_bundle(names, plan.scenes.__getitem__, Task(known, 1e-6, "taylor"), stopped=lambda: True)
    assert len(stopped) == 1


def without_times(chunk):
    return [
        (chunk.lines[n], np.delete(chunk.row(n), parse(chunk.lines[n]).columns["seconds"])) for n in range(len(chunk))
    ]


@pytest.mark.parametrize(("estimate", "cut"), [("none", tangent.CUT), ("all", tangent.CUT), ("all", 1.0)])
def test_scenes_taken_together_give_what_each_gives_alone(monkeypatch, estimate, cut):
    """Those too whose bounds are all too large (`cut`), so that finer runs judge them."""
    monkeypatch.setattr(tangent, "CUT", cut)
    plan = small_plan()
    task, names = Task(solve, 1e-6, "auto", estimate), list(plan.scenes)
    begun: list[int] = []
    together, _ = solve_bundle(names, plan.scenes.__getitem__, task, begun.append, work=60.0)
    alone = Chunk.of({name: task(plan.scenes[name]) for name in names})
    assert list(together.digests) == names
    assert set(begun) == set(range(len(names)))
    for (line, numbers), (other, others) in zip(without_times(together), without_times(alone), strict=True):
        assert line == other
        assert np.array_equal(numbers, others, equal_nan=True)


def test_scenes_taken_together_end_early_with_those_that_ran():
    plan = small_plan()
    linked = list(dict.fromkeys(row.scene for row in plan.rows))
    task = Task(solve, 1e-6, "taylor", all_effects=True)
    calls = iter([False] * len(linked) + [False, True, True])
    found = task.each([plan.scenes[name] for name in linked], lambda place: None, lambda: next(calls))
    assert [response.status for response in found] == ["done", "done"]


def test_a_scene_that_is_refused_leaves_the_others_taken_with_it():
    plan = small_plan()
    names = list(plan.scenes)
    task = Task(solve, 1e-6, "exponential")
    chunk, _ = solve_bundle(names, plan.scenes.__getitem__, task)
    refused = [not done for done in chunk.is_done]
    assert any(refused)
    assert not all(refused)
    assert all("does not run this scene" in parse(line).facts["status"] for line in np.array(chunk.lines)[refused])
