"""`pound sensitivity` from study to tables, on scenes whose numbers are known: Ishigami's function."""

from __future__ import annotations

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest

from pounding_cli.batch import run_plan, runner
from pounding_cli.store import indices as store_indices
from pounding_cli.store import open_results
from pounding_cli.store.indices import CONSTANT, FOUND, draws, indices
from pounding_cli.study import load_study
from pounding_cli.study.sensitivity import expand_sensitivity, question_of
from tests.helpers.answers import the_same_when_stopped
from tests.helpers.sensitivity_studies import FIRST, STUDY, TOTAL, fails_in_a_corner, ishigami, known, write_study

KEYS = ["buildings.A.mass", "cases.near.gap", "buildings.A.hardening"]


def solved(folder, text=STUDY, solve=known, motions=1, **more):
    """Outcome and results of a study."""
    path = write_study(folder, text, motions)
    plan = expand_sensitivity(load_study(path))
    outcome = run_plan(plan, folder / "r.h5", solve=solve, engine_name="serial", **more)
    return outcome, open_results(folder / "r.h5")


def tables(results):
    return [results.table(name) for name in results.answers]


def test_ishigami_within_the_confidence_given(tmp_path):
    outcome, results = solved(tmp_path, STUDY.replace("samples: 64", "samples: 256"))
    rows = results.table("sensitivity").set_index("key").loc[KEYS]
    for name, wanted in (("first", FIRST), ("total", TOTAL)):
        assert rows[name].to_numpy() == pytest.approx(wanted, abs=0.06)
        assert (rows[f"{name}_low"].to_numpy() <= wanted).all()
        assert (rows[f"{name}_high"].to_numpy() >= wanted).all()
        assert (rows[f"{name}_high"] - rows[f"{name}_low"]).max() < 0.5
    assert set(rows["outcome"]) == {FOUND}
    assert rows["samples"].tolist() == [5 * 256] * 3
    (output,) = results.table("sensitivity_outputs").to_dict("records")
    assert output["mean"] == pytest.approx(3.5, abs=0.1)  # a / 2
    variance = 49 / 8 + 0.1 * np.pi**4 / 5 + 0.01 * np.pi**8 / 18 + 0.5
    assert output["deviation"] == pytest.approx(np.sqrt(variance), rel=0.05)
    assert output["mean_low"] < 3.5 < output["mean_high"]
    width = 2 * 1.96 * np.sqrt(variance / 512)  # of a mean of 512 independent samples, 95 % confidence
    assert output["mean_high"] - output["mean_low"] == pytest.approx(width, rel=0.15)
    assert outcome.failed == 0


def test_the_interval_of_an_index_holds_the_truth_as_often_as_it_says(tmp_path):
    """95 % asked, Ishigami's function itself with forty seeds. Fails if the interval is too narrow or too wide."""
    question, held = question_of(load_study(write_study(tmp_path))), []
    for seed in range(1, 41):
        spec = question.spec.model_copy(update={"seed": seed, "draws": 200})
        each = dataclasses.replace(question, spec=spec)
        _, rows = indices(each, np.array([ishigami(np.pi * (2 * u - 1)) for u in each.cube]))
        for name, wanted in (("first", FIRST), ("total", TOTAL)):
            held += [
                row[f"{name}_low"] <= index <= row[f"{name}_high"] for row, index in zip(rows, wanted, strict=True)
            ]
    assert 0.92 < np.mean(held) < 0.99


def test_the_samples_are_those_that_were_solved(tmp_path):
    _, results = solved(tmp_path)
    samples = results.table("sensitivity_samples")
    x = np.stack([(samples[KEYS[0]] - 1e5) / 1e5, (samples[KEYS[1]] - 0.01) / 0.01, 2 * samples[KEYS[2]]], axis=1)
    wanted = [ishigami(np.pi * (2 * u - 1)) for u in x]
    assert samples["output residual_drift in A"].to_numpy() == pytest.approx(wanted, abs=1e-8)
    assert samples["independent"].sum() == 2 * 64


def test_morris_ranks_the_keys(tmp_path):
    text = STUDY.replace("samples: 64", "samples: 100\n  method: morris")
    outcome, results = solved(tmp_path, text)
    rows = results.table("sensitivity").set_index("key").loc[KEYS]
    assert outcome.done <= 4**3 * 2 + 1  # the levels are few: linked and A alone, B once
    # at the levels -3 pi / 4, -pi / 4, pi / 4, 3 pi / 4 the gap has the same sine squared: no effect at all
    assert rows["mu_star"].to_numpy()[1] == pytest.approx(0.0, abs=1e-6)
    # x3 jumps between them by two levels, x1 has the sine of pi / 4 up to its sign: one size of effect, over 2/3
    size = 1.5 * 0.1 * ((3 * np.pi / 4) ** 4 - (np.pi / 4) ** 4) * np.sin(np.pi / 4)
    assert rows.loc[KEYS[2], "mu_star"] == pytest.approx(size, rel=1e-6)
    assert rows.loc[KEYS[0], "mu_star"] > rows.loc[KEYS[2], "mu_star"]
    assert rows.loc[KEYS[2], "sigma"] > abs(rows.loc[KEYS[2], "mu"])  # it acts through mass alone
    assert (rows["mu_star_low"] <= rows["mu_star"]).all()


def test_the_choice_of_motion_is_a_factor(tmp_path):
    """Of two motions of equal share, peaks 1 and 3: the output is Ishigami times the peak. By hand: with mean m and
    variance v of Ishigami, the motion explains m^2 var(p) of (v + m^2) E(p^2) - m^2 E(p)^2."""
    text = STUDY.replace("uncertain:\n", "uncertain:\n  motion: any\n").replace("samples: 64", "samples: 256")
    write_study(tmp_path, text, 3)
    (tmp_path / "g2.txt").unlink()
    outcome, results = solved_as_written(tmp_path)
    rows = results.table("sensitivity").set_index("key")
    mean, variance = 3.5, 49 / 8 + 0.1 * np.pi**4 / 5 + 0.01 * np.pi**8 / 18 + 0.5
    whole = (variance + mean**2) * 5 - mean**2 * 4
    for name, wanted in (("first", mean**2 / whole), ("total", (mean**2 + variance) / whole)):
        half = (rows.loc["motion", f"{name}_high"] - rows.loc["motion", f"{name}_low"]) / 2
        assert rows.loc["motion", name] == pytest.approx(wanted, abs=min(0.12, 1.5 * half))
    assert set(results.table("sensitivity_samples")["motion"]) == {"g1", "g3"}
    solved_rows = results.scene()
    assert len(solved_rows) < 0.75 * 2 * len(results.axes[KEYS[0]])  # each point with the motions of its samples
    assert outcome.failed == 0


def solved_as_written(folder, solve=known):
    plan = expand_sensitivity(load_study(folder / "ishigami.yaml"))
    outcome = run_plan(plan, folder / "r.h5", solve=solve, engine_name="serial")
    return outcome, open_results(folder / "r.h5")


def test_without_the_factor_all_motions_are_averaged(tmp_path):
    text = STUDY
    one = solved(tmp_path, text)[1].table("sensitivity_samples")["output residual_drift in A"]
    two = solved(tmp_path, text, motions=2, replace=True)[1].table("sensitivity_samples")["output residual_drift in A"]
    assert two.to_numpy() == pytest.approx(1.5 * one.to_numpy())
    text = text.replace("samples: 64", "samples: 64\n  over_motions: largest")
    most = solved(tmp_path, text, motions=2, replace=True)[1].table("sensitivity_samples")["output residual_drift in A"]
    assert most.to_numpy() == pytest.approx(np.maximum(one, 2 * one).to_numpy())


def test_a_failing_scene_is_solved_harder_and_then_refuses_the_index(tmp_path):
    """Scenes near one corner fail; some of them not at a finer accuracy, which the others cannot cure."""
    outcome, results = solved(tmp_path, solve=fails_in_a_corner)
    rows = results.table("sensitivity")
    assert outcome.failed > 0
    failed = int(rows["failed"].iloc[0])
    assert failed >= outcome.failed
    assert set(rows["outcome"]) == {f"refused: {failed} of {5 * 64} samples gave no number"}
    assert rows[["first", "total", "at_low"]].isna().all().all()
    assert results.table("sensitivity_outputs")["mean"].isna().all()
    scene = results.scene()
    again = scene[scene["flags"].str.startswith("solved once more, 100 times as finely: event bound reached")]
    assert len(again) > 0
    assert set(again["accuracy"]) == {1e-6 * 0.01}
    assert (scene["status"] != "done").sum() == outcome.failed
    samples = results.table("sensitivity_samples")
    assert samples["output residual_drift in A"].isna().sum() == failed


def test_scenes_that_a_harder_try_cures_cost_no_index(tmp_path):
    def cured(scene, accuracy=1e-6, **more):
        if accuracy > 1e-7:
            return fails_in_a_corner(scene, accuracy)
        return known(scene, accuracy)

    outcome, results = solved(tmp_path, solve=cured)
    assert outcome.failed == 0
    assert set(results.table("sensitivity")["outcome"]) == {FOUND}


def test_an_output_that_does_not_change_has_no_index(tmp_path):
    _, results = solved(tmp_path, STUDY.replace("[residual_drift in A]", "[mu in B]"))
    assert set(results.table("sensitivity")["outcome"]) == {CONSTANT}


def test_stopped_and_resumed_gives_the_same_bits(tmp_path):
    the_same_when_stopped(tmp_path, solved, known, tables, (100, 301))


@pytest.mark.parametrize("engine", ["threads", "processes"])
def test_every_engine_finds_the_same(tmp_path, monkeypatch, engine):
    monkeypatch.setattr(runner, "WORTH_WORKERS", 0.0)
    text = STUDY
    _, serial = solved(tmp_path, text, solve=fails_in_a_corner)
    plan = expand_sensitivity(load_study(tmp_path / "ishigami.yaml"))
    outcome = run_plan(plan, tmp_path / "e.h5", solve=fails_in_a_corner, engine_name=engine, workers=2)
    assert outcome.engine == engine
    for one, other in zip(tables(serial), tables(open_results(tmp_path / "e.h5")), strict=True):
        assert one.equals(other)


def test_other_axes_have_indices_of_their_own(tmp_path):
    text = STUDY + "sweep: {buildings.B.period: [0.5 s, 0.6 s]}\n"
    _, results = solved(tmp_path, text)
    rows = results.table("sensitivity")
    assert rows["buildings.B.period"].tolist() == [0.5] * 3 + [0.6] * 3
    first, second = (rows[rows["buildings.B.period"] == period]["total"].to_numpy() for period in (0.5, 0.6))
    assert np.array_equal(first, second)  # the solver does not look at B


def test_a_seed_makes_other_samples(tmp_path):
    one = solved(tmp_path)[1].table("sensitivity_samples")
    other = solved(tmp_path, STUDY + "  seed: 2\n", replace=True)[1].table("sensitivity_samples")
    assert not np.isclose(one[KEYS[0]], other[KEYS[0]]).any()


def test_points_with_equal_values_are_solved_once(tmp_path):
    text = STUDY.replace("{uniform: {from: 10 mm, to: 20 mm}}", "{choice: [10 mm, 20 mm]}")
    plan = expand_sensitivity(load_study(write_study(tmp_path, text)))
    assert len(plan.axes[-1].values) < 5 * 64 * 0.95
    assert len(set(plan.axes[-1].values)) == len(plan.axes[-1].values)
    assert dataclasses.asdict(plan.axes[-1])["names"] == tuple(KEYS)


def test_draws_looked_at_in_parts_are_the_same_draws(monkeypatch):
    """Fails if parts are drawn one by one, or a part is a single column, which numpy adds up in another order."""
    question = SimpleNamespace(spec=SimpleNamespace(seed=3, draws=50))
    whole = np.concatenate(list(draws(question, 999)()), axis=1)
    monkeypatch.setattr(store_indices, "_AT_ONCE", 999)
    parts = list(draws(question, 999)())
    assert min(part.shape[1] for part in parts) == 2
    assert np.array_equal(np.concatenate(parts, axis=1), whole)
