"""Scenes that are solved together: the same numbers as one by one, and one that fails takes no other with it."""

from __future__ import annotations

import contextlib
import json
import math
import pickle
import subprocess
import sys
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

import pounding_cli as pound
from pounding_cli.batch import solve as batch
from pounding_cli.batch.apart import ApartResponses
from pounding_cli.batch.attempt import GroupSolver, Task
from pounding_cli.batch.cache import Cache
from pounding_cli.batch.pool import open_pool
from pounding_cli.batch.progress import Progress
from pounding_cli.model.effects import effects_of, summarize_effects
from pounding_cli.model.links import Link, link_places
from pounding_cli.results.responses import TEXTS, decode_dropped, encode_response
from pounding_cli.solver import solve as solver
from pounding_cli.solver.layout import build_layout
from pounding_cli.study import make_plan, study_of

STIFF, SOFT = (pound.building(name, storeys=n, period=t) for name, n, t in (("stiff", 2, 0.2), ("soft", 3, 0.5)))
TIME = np.arange(0.0, 2.0, 0.02)
WEAK, STRONG = (pound.motion(a * np.sin(12 * TIME[:n]), dt=0.02) for a, n in ((1.0, 60), (4.0, 100)))


def scenes():
    """Four layouts, two motions of different length, with a tail, gaps that close and one that does not."""
    pair = [STIFF, SOFT]
    made = [
        pound.scene(pair, STRONG, gap=0.0),
        pound.scene(pair, WEAK, gap=0.001, tail=0.5),
        pound.scene([SOFT], STRONG),
        pound.scene(pair, STRONG, gap=0.5),
        pound.scene(pair, WEAK, gap=0.001, analysis="elastic"),
        pound.scene(pair, STRONG, gap=0.002, link="infill"),
        pound.scene(pair, STRONG, gap=0.0, impact={"law": "hertz", "hertz_stiffness": 1e9}),
        pound.scene(pair, WEAK, gap=0.001, impact={"law": "hertz", "hertz_stiffness": 2e9}),
    ]
    row = made[0].buildings  # scenes of a study share them
    return [replace(scene, buildings=row) if len(scene.buildings) == 2 else scene for scene in made]


def sweep_of_gaps(gaps):
    """Return a study of two buildings on two motions."""
    return {
        "records": {"use": ["elcentro", "taft"], "duration": "10 s"},
        "buildings": {"a": {"storeys": 5, "period": "0.36 s"}, "b": {"like": "a", "period": "0.6 s"}},
        "group": ["a", "b"],
        "cases": {"near": {"link": "pounding", "gap": "0 cm"}},
        "sweep": {"cases.near.gap": gaps},
    }


def solve_group(task, scenes):
    """Return the responses of scenes that are solved together."""
    return GroupSolver(task, ApartResponses()).solve(task.list_attempts(scenes))


def numbers(response):
    kept = response.status, response.steps, response.events, response.flags, response.energy["residual"]
    return (*kept, response.peaks.tobytes())


def test_scenes_solved_together_have_the_numbers_of_each_alone():
    mine = scenes()
    assert len({build_layout(scene) for scene in mine}) < len(mine)
    together = solver.solve_all(mine)
    assert [numbers(each) for each in together] == [numbers(pound.solve(scene)) for scene in mine]
    assert all(each.seconds > 0 for each in together)


@pytest.mark.parametrize("method", ["newmark", "central-difference"])
def test_scenes_of_fixed_steps_have_the_numbers_of_each_alone(method):
    some = [scene for scene in scenes() if all(link.kind == "pounding" for link in scene.links)]
    how = {"accuracy": 1e-6, "method": method, "time_step": 1e-4}
    together = solver.solve_all(some, **how)
    assert [each.peaks.tobytes() for each in together] == [pound.solve(one, **how).peaks.tobytes() for one in some]
    assert {each.status for each in together} == {"done"}


def test_a_scene_that_fails_takes_no_other_of_its_group_with_it(monkeypatch):
    usual, some = solver.solve_all, scenes()[:3]

    def solve_all(scenes, *of, **settings):
        if some[1] in scenes:
            raise ZeroDivisionError("of a motion")
        return usual(scenes, *of, **settings)

    monkeypatch.setattr(solver, "solve_all", solve_all)
    found = solve_group(Task(1e-6, "taylor"), some)
    assert [each.status for each in found] == ["done", "error: ZeroDivisionError: of a motion", "done"]
    assert np.isnan(found[1].buildings[0].shear).all()
    assert found[2].peaks.tobytes() == pound.solve(some[2]).peaks.tobytes()


def test_neighbours_with_nothing_between_them_answer_whatever_group_a_scene_is_in():
    """A gap of 50 cm never closes; nor does one of 40 cm of the same scene otherwise, which is not run."""
    wide, other = (pound.scene([STIFF, SOFT], STRONG, gap=gap) for gap in (0.5, 0.4))
    together = solve_group(Task(1e-6, "taylor", "all"), [*scenes(), wide, other])
    alone = solve_group(Task(1e-6, "taylor", "all", retry_failed_finer=True), [other])
    assert together[-1].peaks.tobytes() == alone[0].peaks.tobytes()
    assert together[-1].error_estimate == alone[0].error_estimate < 1e-6
    assert together[-1].seconds == 0.0
    last = together[-1].dropped[-1]
    assert (last.effect, last.links) == ("links", "stiff | soft")
    assert last.reason.startswith("the gap never closes, ")


def test_neighbours_solved_for_one_group_answer_those_after_it_in_any_process():
    """Fails if a worker does not get what others found, or does not give back what it found; and if scenes that answer
    no scene of its group are sent to it."""
    task = Task(1e-6, "taylor")
    wide = pound.scene([STIFF, SOFT], STRONG, gap=0.5)
    on_weak_motion = pound.scene([STIFF, SOFT], WEAK, gap=0.5)
    known = ApartResponses()
    digests = []
    for scene in (wide, on_weak_motion):
        found = task.run(task.list_attempts([scene]), ApartResponses()).apart_responses
        digests += found
        known.add(found)
    (attempt,) = task.list_attempts([pound.scene([STIFF, SOFT], STRONG, gap=0.6)])
    sent = pickle.loads(pickle.dumps(known.select([attempt.apart.scene])))
    assert [known.find(digest) is None for digest in digests] == [False, False]
    assert [sent.find(digest) is None for digest in digests] == [False, True]
    second = task.run([attempt], sent)
    assert second.apart_responses == {}
    assert second.rows[0][1] == task.run([attempt], known).rows[0][1]
    assert GroupSolver(task, sent).solve([attempt])[0].seconds == 0.0


def test_links_between_the_same_floors_have_the_closing_of_these():
    """Fails if a link gets the closing of another, where two of three have the same ends."""
    ends = ((1, 0.5), (2, 0.5), (2, 0.7))
    links = [Link(0, floor, floor, pound.Pounding(gap, 1e9, 0.0)) for floor, gap in ends]
    scene = pound.scene([STIFF, SOFT], STRONG, links=links)
    (response,) = solve_group(Task(1e-6, "taylor"), [scene])
    closings = response.links.max_closing
    assert closings == pytest.approx(pound.solve(scene).links.max_closing, rel=1e-5)
    assert closings[0] < 0.9 * closings[1] == 0.9 * closings[2]


def test_the_oldest_responses_of_neighbours_are_forgotten_before_they_become_too_many(monkeypatch):
    monkeypatch.setattr("pounding_cli.batch.apart.MAX_REMEMBERED", 2)
    known = ApartResponses()
    for digest in "abc":
        known.add({digest: digest})
    assert [known.find(digest) for digest in "abc"] == [None, None, "c"]


@pytest.mark.parametrize("engine", ["serial", "threads", "processes"])
def test_neighbours_with_nothing_between_them_are_solved_once_in_a_run(engine, tmp_path, monkeypatch):
    """Of a sweep of gaps that stay open, one scene an analysis takes time. Fails if a group forgets what one before
    found."""
    monkeypatch.setattr(batch, "MIN_PARALLEL_SECONDS", 0.0)
    monkeypatch.setattr(batch, "GROUP_SECONDS", 0.0)
    monkeypatch.setattr(batch, "TIMED_SCENES", 1)
    plan = make_plan(study_of(sweep_of_gaps([f"{gap} cm" for gap in range(50, 70)])))
    with contextlib.closing(Cache(tmp_path / "cache")) as cache:
        solver_of_run = batch.Solver(cache, open_pool(engine, 1), Progress())
        with contextlib.closing(solver_of_run):
            solved = solver_of_run.solve_plan(plan)
        assert solver_of_run.engine == ("processes" if engine == "processes" else "serial")
    seconds = solved.values["seconds"][:-1][plan.first[1] == 0]
    assert np.count_nonzero(seconds) == 4 < len(seconds)  # two motions, two analyses


class Notes(Progress):
    """Progress that keeps its notes."""

    def __init__(self):
        super().__init__()
        self.notes = []

    def write_note(self, sentence):
        self.notes.append(sentence)


@pytest.mark.parametrize(
    ("keys", "compiled", "kernels"),
    [
        ({}, (), ["the solver"]),
        (
            {"impact": {"law": "hertz", "hertz_stiffness": "1 GN/m^1.5"}},
            (),
            ["the solver for smooth laws", "the solver"],
        ),
        ({}, ("the solver",), []),
        ({"method": "newmark", "time_step": "1 ms"}, (), ["the methods of fixed time steps", "the solver"]),
        ({"method": "newmark", "time_step": "1 ms", "estimate": "none"}, (), ["the methods of fixed time steps"]),
        ({"method": "dop853"}, (), ["the solver for smooth laws"]),
    ],
)
def test_kernels_that_a_run_compiles_are_told_once(keys, compiled, kernels, tmp_path, monkeypatch):
    """Fails if a kernel is left out that solves or assesses a scene, or one is told that none needs."""
    monkeypatch.setattr(batch, "is_compiled", lambda kernel: kernel in compiled)
    plan = make_plan(study_of(sweep_of_gaps(["0 mm", "5 mm"]) | keys))
    progress = Notes()
    with contextlib.closing(Cache(tmp_path / "cache")) as cache:
        batch.Solver(cache, open_pool("serial"), progress).solve_plan(plan)
    assert [note.split(", ")[0] for note in progress.notes] == [f"compiling {kernel}" for kernel in kernels]


def test_links_that_never_act_are_named_by_their_neighbours_and_are_no_effect():
    """In a row of three one pair strikes, whose gap is closed; the other, whose names look like sentences, does not.
    Fails if a name is taken for an effect, or a pair that strikes hides one that does not."""
    names = "P-Delta: the gap never closes", "links: b"
    row = [STIFF, *(replace(SOFT, name=name) for name in names)]
    links = [Link(left, 2, 2, pound.Pounding(gap, 1e9, 0.0)) for left, gap in ((0, 0.0), (1, 0.5))]
    (response,) = solve_group(Task(1e-6, "taylor"), [pound.scene(row, STRONG, links=links)])
    assert [each.links for each in response.dropped if each.links] == [" | ".join(names)]
    texts = dict(zip(TEXTS, json.loads(encode_response(response)[0])[0], strict=True))
    kept = decode_dropped(*(texts[name] for name in ("dropped", "dropped_links", "dropped_reasons")))
    assert tuple(kept) == response.dropped
    rows = summarize_effects(Counter(response.effects), Counter(response.dropped))
    told = {name: reason for name, *_, reason in rows}
    assert [name for name in told if "links" in name] == ["pounding links"]
    assert "links, " not in told["all others"]


@pytest.mark.parametrize(
    ("keys", "analysis", "effect", "is_called_for"),
    [
        ({"collapse": "3 %"}, "elastic", "collapse", True),
        ({}, "elastic", "collapse", False),
        ({}, "inelastic", "collapse", False),
    ],
)
def test_an_effect_that_is_asked_for_is_not_said_to_be_uncalled_for(keys, analysis, effect, is_called_for):
    """Fails if an effect is "not used in this study" that only the analysis leaves out."""
    frames = [pound.building(name, storeys=2, period=t, **keys) for name, t in (("a", 0.2), ("b", 0.5))]
    effects = effects_of(pound.scene(frames, WEAK, gap=0.01, analysis=analysis))
    rows = {name: reason for name, *_, reason in summarize_effects(Counter(effects.kept), Counter(effects.dropped))}
    assert (effect in rows) == is_called_for
    assert (effect in rows["all others"]) != is_called_for


def test_a_scene_takes_as_much_room_in_a_group_as_alone():
    """For the states of DOP853. Fails if it grows with the square of the group."""
    yielding = [
        pound.building(name, storeys=3, period=t, storey_law="bouc-wen") for name, t in (("a", 0.2), ("b", 0.5))
    ]
    scene = pound.scene(yielding, WEAK, gap=0.001)
    alone, among_six = (solver.prepare_run([scene] * count).data.room.states for count in (1, 6))
    assert among_six[0].nbytes == alone[0].nbytes


def test_workers_are_taken_after_a_round_of_few_scenes(tmp_path, monkeypatch):
    """Of a question whose first round is one scene. Fails if the time that a scene takes is not learned from it; or if
    the next round opens other workers."""
    monkeypatch.setattr(batch, "MIN_PARALLEL_SECONDS", 10 * batch.HISTORY_OVERHEAD)
    plan = make_plan(study_of(sweep_of_gaps([f"{gap} mm" for gap in range(8)])))
    with contextlib.closing(Cache(tmp_path / "cache")) as cache:
        asked = batch.Solver(cache, open_pool("threads", 2), Progress())
        with contextlib.closing(asked):
            asked.solve_plan(plan, np.arange(1))
            assert asked.engine == "serial"
            asked.solve_plan(plan, np.arange(9))
            first = asked._executor
            asked.solve_plan(plan)
            assert (asked.engine, asked._executor) == ("threads", first)
        assert asked._executor is None


def test_a_run_without_a_report_imports_neither_xarray_nor_pandas(tmp_path):
    """These two take half of its time where a study is small."""
    (tmp_path / "a.yaml").write_text(
        "title: A\nrecords: {use: [elcentro], duration: 1 s}\nbuildings: {a: {storeys: 2, period: 0.3 s}, "
        "b: {like: a, period: 0.5 s}}\ngroup: [a, b]\ncases: {near: {link: pounding, gap: 1 mm}}\n"
        "keep: {histories: {analyses: [elastic]}}\n"
    )
    run = "import sys; from pounding_cli.cli.main import cli; cli(['run', 'a.yaml', '-q'], standalone_mode=False); "
    told = run + "print(sorted({'xarray', 'pandas', 'dask', 'matplotlib'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", told], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
    assert pound.open_results(tmp_path / "results" / "a.h5").history(analysis="elastic").drift.any()


def test_floors_with_nothing_between_have_a_law_of_their_own():
    """Fails if a gap without end stands for it, or a place takes its sides from its name."""
    with pytest.raises(ValueError, match="gap is inf m"):
        pound.Pounding(math.inf, 1e9, 0.0)
    link = pound.Link.apart(0, 2, 3, 0.4)
    assert pickle.loads(pickle.dumps(link)) == link
    assert (link.kind, link.law.can_act, link.law.free_below) == ("apart", False, math.inf)
    (place,) = link_places([link])
    assert (place.name, place.struck_sides, place.struck_storey) == ("left columns", "left", (0, 2))
    assert not place._replace(left_on_columns=False).is_on_columns
