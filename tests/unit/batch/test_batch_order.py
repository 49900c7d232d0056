"""In which order scenes are solved, and in what portions."""

from __future__ import annotations

import time
import tracemalloc
from types import SimpleNamespace

import numpy as np
import pytest
from study_plans import Axis, known, small_plan

from pounding_cli.batch.attempt import Task
from pounding_cli.batch.bundles import MOST, Queue, solve_bundle
from pounding_cli.batch.families import order_of
from pounding_cli.solve import solve
from pounding_cli.store.chunk import Chunk
from pounding_cli.store.codec import parse
from pounding_cli.study.plan import Row


def test_families_stand_together_baselines_first():
    axis = Axis(("impact.damping_ratio",), ((0.1,), (0.2,)))
    plan = small_plan(axes=(axis,))
    order = order_of(plan, ())
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
    order = order_of(plan, {row.scene for row in rows})
    assert order.counts == {
        ("", "elastic"): 4,
        ("", "inelastic"): 4,
        ("touching", "inelastic"): 2,
        ("gap", "inelastic"): 2,
    }
    assert all(len(digests) == 2 for digests in order.samples.values())
    assert not {row.scene for row in rows} & set(order.digests)


def test_rows_that_ask_for_nothing_cost_no_memory():
    """A round of a search asks for few of its rows, each with baselines of its own. Fails if every row has a family."""
    names = [str(n) for n in range(20_000)]
    rows = [Row((n,), "near", "elastic", "m", f"s{n}", (name,), ()) for n, name in enumerate(names)]
    plan = SimpleNamespace(rows=rows, scenes={"s7": None, "7": None})
    tracemalloc.start()
    order = order_of(plan, ())
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert order.digests == ["7", "s7"]
    assert peak < 100_000


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


@pytest.mark.parametrize("estimate", ["none", "all"])
def test_scenes_taken_together_give_what_each_gives_alone(estimate):
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
