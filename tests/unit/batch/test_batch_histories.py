"""Histories in a run: kept beside the peaks, taken again from the file, never a reason to solve peaks anew."""

from __future__ import annotations

from dataclasses import replace

import h5py
import numpy as np
import pytest

from pounding_cli.batch import histories, run_plan
from pounding_cli.batch.progress import Quiet
from pounding_cli.errors import InputError, Problem
from pounding_cli.solve import solve
from pounding_cli.solve.histories import history
from pounding_cli.store import is_current, open_results
from pounding_cli.store.histories import FIELDS
from tests.helpers.plans import known, small_plan


@pytest.fixture
def plan():
    plan = small_plan()
    return replace(plan, kept=tuple(r for r in plan.rows if r.case == "touching"), every=0.01)


@pytest.fixture
def output(tmp_path):
    return tmp_path / "r.h5"


@pytest.fixture
def made(monkeypatch):
    """The scenes whose histories are run."""
    digests: list[str] = []

    def counted(scene, accuracy, every):
        digests.append(scene.digest)
        return history(scene, accuracy, every)

    monkeypatch.setattr(histories, "history", counted)
    return digests


class Told(Quiet):
    """Collects what a run says."""

    def __init__(self) -> None:
        self.said: list[str] = []

    def say(self, text: str) -> None:
        self.said.append(text)


class Peaks:
    """`known`, counting its calls."""

    def __init__(self) -> None:
        self.calls = 0

    def __call__(self, scene, accuracy, method, **_):
        self.calls += 1
        return known(scene, accuracy, method)


def run(plan, output, **options):
    return run_plan(plan, output, solve=options.pop("solve", known), engine_name="serial", **options)


def test_adding_keep_solves_no_peak_again(plan, output, made):
    run(replace(plan, kept=()), output)
    assert made == []
    assert not is_current(output, plan)
    peaks = Peaks()
    outcome = run(plan, output, solve=peaks)
    assert (peaks.calls, outcome.done, outcome.reused) == (0, 0, len(plan.scenes))
    assert made == [row.scene for row in plan.kept]
    assert len(open_results(output).histories()) == 4


def test_a_second_run_does_nothing(plan, output, made):
    run(plan, output)
    stamp = output.stat().st_mtime_ns
    assert is_current(output, plan)
    run(plan, output)
    assert len(made) == 4
    assert output.stat().st_mtime_ns == stamp


def test_histories_that_are_there_are_not_run_again(plan, output, made):
    run(plan, output)
    before = open_results(output).history("touching", "inelastic", "strong")
    wider = replace(plan, kept=plan.rows, study=replace(plan.study, text="all of them"))
    run(wider, output)
    assert made == [row.scene for row in wider.rows if row.case == "touching"] + [
        row.scene for row in wider.rows if row.case == "gap"
    ]
    after = open_results(output).history("touching", "inelastic", "strong")
    for name in ("shear", "displacement", "link_force", "total_acceleration"):
        assert np.array_equal(getattr(before, name), getattr(after, name), equal_nan=True), name
    assert (before.energy["input"] == after.energy["input"]).all()
    fewer = replace(plan, kept=plan.kept[:1])
    run(fewer, output)
    assert len(made) == 8
    assert len(open_results(output).histories()) == 8
    run(fewer, output, replace=True)
    assert len(open_results(output).histories()) == 1


def test_what_a_run_kept_stays_when_another_does_not_ask_for_it(plan, output, made):
    """The study without `keep`, then without the case, then as it was: nothing is run or solved again."""
    run(plan, output)
    before = open_results(output).history("touching", "inelastic", "strong")
    progress = Told()
    run(replace(plan, kept=()), output, progress=progress)
    assert len(open_results(output).histories()) == 4
    run(replace(small_plan(cases=(("gap", 0.05),)), every=0.01), output, progress=progress)
    results = open_results(output)
    assert len(results.histories()) == 0
    assert set(results.scene()["case"]) == {"gap"}
    assert "4 scenes no longer in the study stay in the file" in progress.said[-2]
    assert progress.said[-1].startswith("4 histories of scenes no longer in the study stay in the file; --replace")
    peaks = Peaks()
    run(plan, output, solve=peaks)
    assert (peaks.calls, len(made)) == (0, 4)
    after = open_results(output).history("touching", "inelastic", "strong")
    for name in FIELDS:
        if not name.startswith("energy"):
            assert np.array_equal(getattr(before, name), getattr(after, name), equal_nan=True), name
    assert open_results(output).attrs["scenes"] == len(plan.scenes)


def test_replace_leaves_out_what_the_study_does_not_have(plan, output):
    run(plan, output)
    small = small_plan(cases=(("gap", 0.05),))
    run(small, output)
    size = output.stat().st_size
    peaks = Peaks()
    run(small, output, replace=True, solve=peaks)
    assert peaks.calls == 0
    assert output.stat().st_size < 0.9 * size
    run(plan, output, solve=peaks)
    assert peaks.calls == 4


def test_histories_of_another_accuracy_are_not_dropped_unasked(plan, output):
    """They can be neither kept, since their tables are gone, nor made, since the study does not ask for them."""
    run(plan, output)
    content = output.read_bytes()
    finer = replace(plan, accuracy=1e-9, kept=plan.kept[:1])
    with pytest.raises(InputError, match=r"keeps 3 histories that this run would drop: .* accuracy 1e-06") as refused:
        run(finer, output)
    assert "--replace" in refused.value.problems[0].hint
    assert output.read_bytes() == content
    run(replace(plan, accuracy=1e-9), output)  # all are made anew
    run(replace(finer, accuracy=1e-8), output, replace=True)
    assert len(open_results(output).histories()) == 1


def test_damaged_histories_are_run_again(plan, output, made):
    run(plan, output)
    with h5py.File(output) as file:
        at = file["histories/1/shear"].id.get_chunk_info(0).byte_offset
    content = bytearray(output.read_bytes())
    content[at + 3] ^= 16
    output.write_bytes(content)
    with pytest.raises(InputError, match="is damaged: bytes "):
        open_results(output).history("touching", "elastic", "weak")
    run(plan, output)
    assert 4 < len(made) <= 8  # they are so short that damage to one may reach the next
    assert len(open_results(output).histories()) == 4


@pytest.mark.parametrize("change", [{"every": 0.005}, {"accuracy": 1e-9}])
def test_another_step_or_accuracy_runs_them_again(plan, output, made, change):
    run(plan, output)
    run(replace(plan, **change), output)
    assert len(made) == 8


def test_renamed_buildings_run_them_again(plan, output, made):
    """Links are known by their buildings' names."""
    run(plan, output)
    run(replace(plan, buildings=("one", "other")), output)
    assert len(made) == 8


def test_the_peaks_of_the_tables_are_those_of_the_histories(plan, output):
    run(replace(plan, every=1e-4), output, solve=solve)
    results = open_results(output)
    storey, floor, link = results.storey(), results.floor(), results.link()
    for case, analysis, record in {(row.case, row.analysis, row.record) for row in plan.kept}:
        found = results.history(case, analysis, record)
        for table, column, values in (
            (storey, "V", found.shear),
            (storey, "drift", found.drift),
            (floor, "acceleration", found.total_acceleration),
        ):
            rows = table[(table.case == case) & (table.analysis == analysis) & (table.record == record)]
            peaks = np.abs(values).max(axis=0)
            share = peaks[np.isfinite(peaks)] / rows[column].to_numpy()
            assert (share <= 1 + 1e-6).all()
            assert (share > 0.99).all()
        rows = link[(link.case == case) & (link.analysis == analysis) & (link.record == record)]
        reached = np.abs(found.link_force).max(axis=0)
        assert reached == pytest.approx(rows.peak_force.to_numpy(), rel=0.05, abs=1e-3)


def test_rows_that_share_a_scene_share_its_history(output, made):
    """Two cases that come to the same links."""
    plan = small_plan(cases=(("one", 0.05), ("same", 0.05)))
    run(replace(plan, kept=plan.rows, every=0.01), output)
    assert len(made) == 4
    results = open_results(output)
    assert len(results.histories()) == 8
    one, same = (results.history(case, "elastic", "weak") for case in ("one", "same"))
    assert (one.shear[:, 0] == same.shear[:, 0]).all()


def test_many_histories_are_told(plan, output, monkeypatch):
    monkeypatch.setattr(histories, "WORTH_TELLING", 4)
    said: list[str] = []
    found = list(histories.kept_histories(plan, {d: known(s) for d, s in plan.scenes.items()}, output, "", said.append))
    assert len(found) == 4
    assert said == ["running 4 scenes for their histories"]


def test_a_scene_that_failed_has_no_history(plan, output, made):
    def fails(scene, accuracy, method, **_):
        response = known(scene, accuracy, method)
        return replace(response, status="stalled") if scene.digest == plan.kept[0].scene else response

    run(plan, output, solve=fails)
    assert len(made) == 3
    assert len(open_results(output).histories()) == 3


def test_a_history_that_cannot_be_run_is_told_and_the_file_is_written(plan, output, monkeypatch):
    def fails(scene, accuracy, every):
        raise InputError(Problem("no history of this scene: stalled", "check"))

    class Listening:
        def __init__(self) -> None:
            self.said: list[str] = []

        def start(self, total, reused, ahead=0): ...

        def step(self, done, failed): ...

        def say(self, sentence):
            self.said.append(sentence)

        def compiled(self): ...

        def stop(self): ...

    monkeypatch.setattr(histories, "history", fails)
    progress = Listening()
    run(plan, output, progress=progress)
    assert len(progress.said) == 4
    assert progress.said[0].startswith("touching, elastic, weak: no history of this scene")
    with h5py.File(output) as file:
        assert "histories" not in file
