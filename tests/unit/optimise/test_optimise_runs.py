"""`pound optimise` from study to tables, on scenes whose numbers are known: a bowl over a mass and a gap."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from pounding_cli.batch import run_plan, runner
from pounding_cli.store import open_results
from pounding_cli.store.optimise import FOUND, NOTHING
from pounding_cli.study import load_study
from pounding_cli.study.optimise import expand_optimise
from tests.helpers.answers import the_same_when_stopped
from tests.helpers.optimise_studies import GAP, KEYS, MASS, STUDY, bowl, fails_near_the_bottom, known, write_study


def solved(folder, text=STUDY, solve=known, motions=1, **more):
    """Outcome and results of a study."""
    plan = expand_optimise(load_study(write_study(folder, text, motions)))
    more = {"engine_name": "serial", **more}
    outcome = run_plan(plan, folder / "r.h5", solve=solve, **more)
    return outcome, open_results(folder / "r.h5")


def tables(results):
    return [results.table(name) for name in results.answers]


def rows_of(results):
    return results.table("optimise").set_index("key").loc[KEYS]


def test_the_bottom_of_the_bowl(tmp_path):
    outcome, results = solved(tmp_path)
    rows = rows_of(results)
    assert rows["optimum"].tolist() == pytest.approx([1.0] * 2, abs=1e-6)
    assert rows["value"].tolist() == pytest.approx([MASS, GAP], rel=1e-3)
    assert rows["flat_from"].tolist() == pytest.approx([120e3, 0.016], rel=2e-3)  # by 1 %: a tenth of each range
    assert rows["flat_to"].tolist() == pytest.approx([140e3, 0.018], rel=2e-3)
    assert (rows["together_from"] >= [120e3 - 1, 0.016 - 1e-7]).all()
    assert (rows["together_to"] <= [140e3 + 1, 0.018 + 1e-7]).all()
    assert rows["as_written"].tolist() == pytest.approx([bowl(150e3, 0.012)] * 2)
    assert rows["written"].tolist() == pytest.approx([150e3, 0.012])
    assert rows[["range_from", "range_to"]].to_numpy() == pytest.approx(np.array([[1e5, 2e5], [0.01, 0.02]]))
    assert set(rows["outcome"]) == {FOUND}
    assert outcome.failed == 0


def test_the_points_are_those_that_were_solved(tmp_path):
    _, results = solved(tmp_path)
    tried = results.table("optimise_points")
    wanted = [bowl(mass, gap) for mass, gap in tried[KEYS].to_numpy()]
    assert tried["value"].to_numpy() == pytest.approx(wanted, abs=1e-9)
    assert tried["stage"].tolist()[0] == "as written"
    assert len(tried) == len(results.axes[KEYS[0]]) == rows_of(results)["points"].iloc[0]
    assert list(results.axes[KEYS[0]]) == pytest.approx(tried[KEYS[0]].tolist())


def test_the_points_that_lead_to_the_valley_are_not_solved_twice(tmp_path):
    _, results = solved(tmp_path, STUDY.replace("estimate: none", "estimate: all"))
    stage = results.table("optimise_points")["stage"]
    assert set(stage) >= {"search", "polish", "slices", "map"}
    assert results.scene()["error_estimate"].isna().tolist() == (stage == "search").tolist()
    assert rows_of(results)["error"].notna().all()


def test_the_most_is_sought_too(tmp_path):
    text = STUDY.replace("least: residual_drift in A", "most: 3 - residual_drift in A")
    _, results = solved(tmp_path, text)
    rows = rows_of(results)
    assert rows["optimum"].tolist() == pytest.approx([2.0] * 2, abs=1e-6)
    assert rows["value"].tolist() == pytest.approx([MASS, GAP], rel=1e-3)
    assert set(rows["sought"]) == {"most 3 - residual_drift in A"}


@pytest.mark.parametrize(("over", "factor"), [("mean", 2.0), ("largest", 3.0)])
def test_of_motions_the_mean_or_the_largest(tmp_path, over, factor):
    _, results = solved(tmp_path, STUDY + f"  over_motions: {over}\n", motions=3)
    assert rows_of(results)["optimum"].tolist() == pytest.approx([factor] * 2, rel=1e-6)


@pytest.mark.parametrize(("over", "factor"), [("worst", 2.0), ("mean", 1.5)])
def test_of_a_sweep_beside_the_worst_or_the_mean(tmp_path, over, factor):
    text = STUDY + f"  over_sweep: {over}\nsweep: {{records.scale.pga: [1 m/s2, 2 m/s2]}}\n"
    _, results = solved(tmp_path, text.replace(", scale: 1}", ", scale: {pga: 1 m/s2}}"))
    assert rows_of(results)["optimum"].tolist() == pytest.approx([factor] * 2, rel=1e-6)


def test_a_choice(tmp_path):
    text = STUDY.replace("{from: 10 mm, to: 20 mm}", "{choice: [10 mm, 12 mm, 18 mm]}")
    _, results = solved(tmp_path, text)
    rows = rows_of(results)
    assert rows["option"].tolist() == ["", "18 mm"]
    assert rows["written_option"].tolist() == ["", "12 mm"]
    assert rows["optimum"].iloc[0] == pytest.approx(bowl(MASS, 0.018), abs=1e-6)
    assert set(results.table("optimise_points")[KEYS[1]]) == {"10 mm", "12 mm", "18 mm"}


def test_one_of_several_cases(tmp_path):
    """Only the case and the analysis that are looked at are solved."""
    text = STUDY.replace("cases: {near:", "cases: {far: {link: pounding, gap: 1 m}, near:")
    text = text.replace("[inelastic]", "[elastic, inelastic]") + "  case: near\n  analysis: inelastic\n"
    _, results = solved(tmp_path, text)
    assert rows_of(results)["optimum"].tolist() == pytest.approx([1.0] * 2, abs=1e-6)
    scene = results.scene()
    assert set(scene["case"]) == {"near"}
    assert set(scene["analysis"]) == {"inelastic"}


def test_points_that_fail_are_no_answer_and_told(tmp_path):
    outcome, results = solved(tmp_path, solve=fails_near_the_bottom)
    rows = rows_of(results)
    assert outcome.failed > 0
    assert rows["value"].tolist() == pytest.approx([MASS, 0.016], rel=1e-3)
    assert rows["optimum"].iloc[0] == pytest.approx(1.01, abs=1e-4)
    assert rows["failed"].iloc[0] == results.table("optimise_points")["value"].isna().sum() > 0
    again, _ = solved(tmp_path)  # what failed is tried again, and the search goes on from there
    assert again.failed == 0
    assert rows_of(open_results(tmp_path / "r.h5"))["value"].tolist() == pytest.approx([MASS, GAP], rel=1e-3)


def test_points_without_meaning_are_no_answer(tmp_path):
    """A connector that closes more than its gap leaves out the blow: such scenes mean nothing."""

    def closes(scene, **more):
        found = known(scene, **more)
        if scene.links and scene.links[0].gap > 0.016:
            flag = "connector closes more than the gap, so the floors would have struck: A | B, floor 1, by 2 mm"
            return dataclasses.replace(found, flags=(flag,))
        return found

    text = STUDY.replace("{link: pounding, gap: 12 mm}", "{link: connector, gap: 12 mm, stiffness: 1 MN/m}")
    _, results = solved(tmp_path, text, solve=closes)
    rows = rows_of(results)
    assert rows["value"].tolist() == pytest.approx([MASS, 0.016], rel=1e-3)
    assert rows["failed"].iloc[0] == 0
    assert rows["meaningless"].iloc[0] == results.table("optimise_points")["meaningless"].sum() > 0


def test_no_point_with_a_number(tmp_path):
    _, results = solved(tmp_path, STUDY.replace("residual_drift in A", "sqrt(0 - residual_drift in A)"))
    assert set(rows_of(results)["outcome"]) == {NOTHING}


def test_stopped_and_resumed_gives_the_same_bits(tmp_path):
    first, last, again = the_same_when_stopped(tmp_path, solved, known, tables, (50, 301))
    assert last.reused > 200
    assert last.done + last.reused == first.done
    assert again.engine == "none"


def test_a_finished_search_is_not_made_again(tmp_path):
    """Fails if the file is compared with the plan of another round than the first: then the same command searches again
    and writes the same file once more."""
    solved(tmp_path)
    before = (tmp_path / "r.h5").stat()
    again, _ = solved(tmp_path)
    after = (tmp_path / "r.h5").stat()
    assert again.done == 0
    assert (after.st_ino, after.st_mtime_ns) == (before.st_ino, before.st_mtime_ns)
    changed, _ = solved(tmp_path, STUDY + "  seed: 2\n")
    assert changed.done > 0


@pytest.mark.parametrize("engine", ["threads", "processes"])
def test_every_engine_finds_the_same(tmp_path, monkeypatch, engine):
    monkeypatch.setattr(runner, "WORTH_WORKERS", 0.0)
    (tmp_path / "e").mkdir()
    _, serial = solved(tmp_path, solve=fails_near_the_bottom)
    outcome, other = solved(tmp_path / "e", solve=fails_near_the_bottom, engine_name=engine, workers=2)
    assert outcome.engine == engine
    for one, same in zip(tables(serial), tables(other), strict=True):
        assert one.equals(same)
