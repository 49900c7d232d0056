"""Runs gathered to lines, the cheapest for a wish, the answer in words; errors of a made-up response."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from pounding_cli.errors import InputError
from pounding_cli.model.scene import Analysis, Scene
from pounding_cli.report.accuracy_page import aborted_in_words, cheapest, in_words, lines_of, reference_in_words
from pounding_cli.solve import solve, work_precision
from pounding_cli.solve.work_precision import (
    QUANTITIES,
    Confirmed,
    Run,
    Subject,
    WorkPrecision,
    chosen,
    errors_of,
    measure,
)
from tests.helpers.five_storeys import motion, pair, pounding


def run(case: str, method: str, setting: float, seconds: float, error: float, status: str = "done") -> Run:
    errors = dict.fromkeys(QUANTITIES, error if status == "done" else float("nan"))
    return Run(case, "elastic", "r", method, setting, status, "", seconds, 10, 1, errors, 3, 3, float("nan"))


CONFIRMED = tuple(Confirmed(case, "elastic", "r", dict.fromkeys(QUANTITIES, 1e-11), 0) for case in "ab")
FOUND = WorkPrecision(
    (
        run("a", "taylor", 1e-2, 0.001, 2e-5), run("b", "taylor", 1e-2, 0.003, 4e-4),
        run("a", "taylor", 1e-6, 0.004, 1e-8), run("b", "taylor", 1e-6, 0.006, 1e-7),
        run("a", "rk4", 1e-3, 0.0001, 5e-3), run("b", "rk4", 1e-3, 0.0002, 0.0, "not finite"),
        run("a", "rk4", 1e-4, 0.010, 1e-4), run("b", "rk4", 1e-4, 0.020, 8e-4),
        run("a", "exponential", 1e-6, 0.0001, 1e-14),
    ),
    CONFIRMED, (),
)  # fmt: skip


def test_a_line_takes_the_mean_time_and_the_worst_error():
    """Fails if the median error, or the time of one scene, is taken."""
    first = lines_of(FOUND.runs)[0]
    assert (first.method, first.setting, first.scenes, first.aborted) == ("taylor", 1e-2, 2, 0)
    assert first.milliseconds == pytest.approx(2.0)
    assert first.error == 4e-4


def test_aborted_runs_never_pass_for_fast_ones():
    """rk4 at 1e-3 is fastest and its only finished scene is good enough for 1 %. Fails if aborted runs are left out of
    the count."""
    lines = lines_of(FOUND.runs)
    best = cheapest(lines, 1e-2, 2)
    assert best is not None
    assert (best.method, best.setting) == ("taylor", 1e-2)
    aborted = aborted_in_words(FOUND)
    assert aborted == ["rk4 at 0.001 s: not finite on 1 scene"]


def test_the_answer_in_words():
    """What it says for 0.1 %: method, cost, cost of the next digit, what the others cost."""
    said = in_words(FOUND, [1e-3, 1e-12])
    assert said[0].startswith("For 0.1 % use taylor with accuracy 0.01: 2 ms a scene.")
    assert "The next digit (taylor with accuracy 1e-06) costs 3 ms more." in said[0]
    assert "rk4 15 ms" in said[0]
    assert "exponential" not in said[0]  # it ran one of the two scenes
    assert "no method" in said[1]
    assert "1.0e-11" in reference_in_words(FOUND)


def test_errors_of_a_response():
    """Relative to each storey's own peak; forces relative to the largest. Fails if a mean is taken."""
    reference = solve(Scene(pair(), pounding(pair(), 0.0), motion(), Analysis.ELASTIC), 1e-8)
    shear = reference.buildings[1].shear.copy()
    shear[4] *= 1.002
    changed = dataclasses.replace(reference.buildings[1], shear=shear)
    force = reference.links.peak_force.copy()
    smallest = int(np.argmin(force))
    force[smallest] += 0.01 * force.max()
    found = dataclasses.replace(
        reference,
        buildings=(reference.buildings[0], changed),
        links=dataclasses.replace(reference.links, peak_force=force),
    )
    errors = errors_of(found, reference)
    assert errors["V"] == pytest.approx(0.002)
    assert errors["mu"] == errors["acceleration"] == 0.0
    assert errors["force"] == pytest.approx(0.01)


def test_measure_runs_what_it_claims_and_tells_what_it_left_out():
    """Two methods on two motions, of which the budget reaches one. Fails if a refusal ends the whole."""
    scene = Scene(pair(), pounding(pair(), 0.0), motion(0.5), Analysis.ELASTIC)
    subjects = [Subject("touching", "elastic", record, scene) for record in ("one", "two")]
    found = measure(subjects, ("taylor", "exponential", "central-difference"), 1e-3)
    assert {run.method for run in found.runs} == {"taylor", "central-difference"}
    assert {run.record for run in found.runs} == {"one"}
    assert len(found.references) == 1
    assert max(found.references[0].differences.values()) < 1e-6
    assert found.left_out[0] == "1 of 2 scenes"
    methods = [text.split(" at ")[0] for text in found.left_out[1:]]
    assert methods == ["taylor", "central-difference"]  # each method once, its settings in one text
    assert "0.0001, 1e-06" in found.left_out[1]
    taylor = [run for run in found.runs if run.method == "taylor"]
    assert taylor[0].errors["V"] < 1e-2
    assert taylor[0].impacts == taylor[0].expected > 0


def test_the_budget_is_wall_time_and_compiling_is_told_apart(monkeypatch):
    """A clock that a run moves by a second each: the budget ends the runs, whatever the first motion has of scenes."""
    now = [0.0]
    response = work_precision.solve(Scene(pair(), pounding(pair(), 0.0), motion(0.5), Analysis.ELASTIC), 1e-4, "taylor")

    def solved(scene, method, **setting):
        now[0] += 5.0 if scene.motion.acceleration.size <= work_precision.WARM_UP + 1 else 1.0
        return dataclasses.replace(response, seconds=1.0, method=method)

    monkeypatch.setattr(work_precision.time, "perf_counter", lambda: now[0])
    monkeypatch.setattr(work_precision, "solve", solved)
    scene = Scene(pair(), pounding(pair(), 0.0), motion(0.5), Analysis.ELASTIC)
    subjects = [Subject(f"case {number}", "elastic", "one", scene) for number in range(8)]
    found = measure(subjects, ("taylor", "newmark"), 20.0)
    assert found.spent <= 20.0
    assert 2 <= len(found.references) < 8
    assert found.left_out[0] == f"{8 - len(found.references)} of 8 scenes"
    assert found.compiling == pytest.approx(5.0 * 3 * len(found.references))  # rk4-events confirms


def test_unknown_methods_are_refused_together():
    with pytest.raises(InputError) as refused:
        chosen(["taylor", "euler", "magic"])
    assert len(refused.value.problems) == 2
    assert chosen([])[0] == "taylor"
