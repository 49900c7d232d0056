"""`pound fragility` from study to tables, on scenes whose demands are known: asked, found, failed, resumed."""

from __future__ import annotations

import numpy as np
import pytest

from pounding_cli.batch import run_plan, runner
from pounding_cli.fragility import fit, of_counts
from pounding_cli.report.fragility_text import asked_of, notes
from pounding_cli.store import open_results
from pounding_cli.study import load_study
from pounding_cli.study.fragility import expand_fragility
from tests.helpers.answers import the_same_when_stopped
from tests.helpers.fragility_studies import MOTIONS, STUDY, fails_between, known, write_study

G = 9.80665


def solved(folder, text=STUDY, solve=known, name="r.h5", **more):
    """Outcome and results of a study."""
    path = write_study(folder, text)
    outcome = run_plan(expand_fragility(load_study(path)), folder / name, solve=solve, engine_name="serial", **more)
    return outcome, open_results(folder / name)


def tables(results):
    return [results.table(name) for name in ("fragility", "fragility_motions")]


def test_each_motion_is_bracketed_between_two_levels_of_the_study(tmp_path):
    outcome, results = solved(tmp_path)
    motions = results.table("fragility_motions")
    strength = 0.2 + 0.3 * np.arange(MOTIONS) / (MOTIONS - 1)
    for building, factor in (("A", 1.0), ("B", 1.5)):
        mine = motions[(motions["building"] == building) & (motions["limit"] == "mu > 4")]
        assert mine["record"].tolist() == [f"g{n}" for n in range(MOTIONS)]
        for suffix, less in (("0", 1.0), ("", 0.9)):
            capacity = factor * strength * less
            held, passed = mine["held" + suffix] / G, mine["passed" + suffix] / G
            assert ((held <= capacity + 1e-9) & (capacity <= passed + 1e-9)).all()
            assert (passed - held).to_numpy() == pytest.approx(0.02)
    assert outcome.done < 0.25 * 50 * 3 * MOTIONS  # of a plain grid: pair and both buildings alone


def test_curves_alone_and_with_pounding_are_paired_by_motion(tmp_path):
    _, results = solved(tmp_path)
    curve = results.table("fragility").set_index(["limit", "building"]).loc["mu > 4", "A"]
    strength = 0.2 + 0.3 * np.arange(MOTIONS) / (MOTIONS - 1)
    assert curve["median0"] / G == pytest.approx(np.exp(np.log(strength).mean()), rel=0.02)
    assert curve["spread0"] == pytest.approx(np.log(strength).std(), rel=0.08)  # levels of 0.02 g
    assert curve["ratio"] == pytest.approx(0.9, rel=0.02)
    assert curve["ratio_high"] - curve["ratio_low"] < 0.06  # the same motions: unpaired it would be 0.3
    assert curve["median_low0"] < curve["median0"] < curve["median_high0"]
    assert (curve["motions"], curve["failed"]) == (MOTIONS, 0)


def test_contact_is_of_pairs_and_never_alone(tmp_path):
    _, results = solved(tmp_path)
    curve = results.table("fragility").set_index("limit").loc["contact"]
    assert curve["building"] == "A|B"
    assert curve["outcome0"] == ""
    closes = 0.1 + 0.01 * np.arange(MOTIONS)
    assert curve["median"] / G == pytest.approx(np.exp(np.log(closes).mean()), rel=0.05)


def test_what_is_not_asked_is_not_in_the_tables(tmp_path):
    outcome, results = solved(tmp_path)
    assert len(results.scene()) < 0.4 * 50 * MOTIONS
    assert results.scene()["status"].unique().tolist() == ["done"]
    storey = results.storey()
    assert storey["mu"].notna().sum() == 5 * len(results.scene())  # three storeys and two
    assert results.attrs["scenes"] == outcome.done


def test_failed_scenes_widen_a_bracket_and_are_counted(tmp_path):
    outcome, results = solved(tmp_path, solve=fails_between)
    motions = results.table("fragility_motions")
    first = motions[(motions["record"] == "g0") & (motions["limit"] == "mu > 4") & (motions["building"] == "A")].iloc[0]
    assert (first["held"] / G, first["passed"] / G) == pytest.approx((0.14, 0.26))
    curve = results.table("fragility").set_index(["limit", "building"]).loc["mu > 4", "A"]
    assert (curve["failed"], curve["failed0"], curve["motions"]) == (outcome.failed, 0, MOTIONS)
    assert (curve["undecided"], curve["undecided0"]) == (0, 0)
    assert "15 scenes failed (a scene" in " ".join(notes(asked_of(results), results.table("fragility")))
    assert outcome.failed == 5  # 0.16 to 0.24 g: each was tried before the bracket was left open
    assert {failure.status for failure in outcome.failures} == {"event bound reached"}


def test_stopped_and_resumed_gives_the_same_bits(tmp_path):
    the_same_when_stopped(tmp_path, solved, known, tables, (30, 61))


@pytest.mark.parametrize("engine", ["threads", "processes"])
def test_every_engine_finds_the_same(tmp_path, monkeypatch, engine):
    monkeypatch.setattr(runner, "WORTH_WORKERS", 0.0)
    _, serial = solved(tmp_path)
    plan = expand_fragility(load_study(tmp_path / "known.yaml"))
    outcome = run_plan(plan, tmp_path / "e.h5", solve=known, engine_name=engine, workers=2)
    assert outcome.engine == engine
    for one, other in zip(tables(serial), tables(open_results(tmp_path / "e.h5")), strict=True):
        assert one.equals(other)


def test_stripes_solve_every_level_and_fit_counts(tmp_path):
    text = STUDY.replace("limits: [mu > 4, contact]", "{limits: mu > 4 in A, method: stripes}").replace(
        "fragility:\n  {", "fragility: {"
    )
    text = text.replace("{from: 0.02 g, to: 1 g, step: 0.02 g}", "[0.2 g, 0.3 g, 0.4 g, 0.5 g]")
    outcome, results = solved(tmp_path, text)
    assert outcome.done == 4 * 3 * MOTIONS
    motions = results.table("fragility_motions")
    assert {"ratio", "ratio_low", "ratio_high", "median_low0", "spread_high0"} <= set(results.table("fragility"))
    counts = (motions["demand0"] > 1).groupby(motions["intensity"]).sum()
    curve = results.table("fragility").iloc[0]
    wanted = fit(of_counts(counts.index.to_numpy(), np.full(4, MOTIONS), counts.to_numpy()))
    assert (curve["median0"], curve["spread0"]) == pytest.approx((wanted.median, wanted.spread))


def test_failed_scenes_of_stripes_count_neither_as_holding_nor_as_passing(tmp_path):
    text = STUDY.replace("limits: [mu > 4, contact]", "limits: mu > 4 in A\n  method: stripes")
    text = text.replace("{from: 0.02 g, to: 1 g, step: 0.02 g}", "[0.2 g, 0.3 g, 0.4 g, 0.5 g]")
    _, results = solved(tmp_path, text, fails_between)
    demand = results.table("fragility_motions").groupby("intensity")["demand"]
    counts, passed = demand.count(), demand.agg(lambda each: (each > 1).sum())
    assert counts.tolist() == [MOTIONS - 1, MOTIONS, MOTIONS, MOTIONS]
    wanted = fit(of_counts(counts.index.to_numpy(), counts.to_numpy(), passed.to_numpy()))
    curve = results.table("fragility").iloc[0]
    assert (curve["median"], curve["spread"]) == pytest.approx((wanted.median, wanted.spread))
    assert (curve["failed"], curve["undecided"]) == (1, 0)


def test_a_cloud_takes_motions_as_they_are(tmp_path):
    """Ductility is proportional to the peak, and each motion has its own factor: slope 1 by construction."""
    text = STUDY[: STUDY.index("sweep:")].replace(", scale: {pga: 0.1 g}", ", scale: 3") + (
        "fragility: {limits: mu > 4 in A, method: cloud, intensity: sa(0.3 s)}\n"
    )
    outcome, results = solved(tmp_path, text)
    assert outcome.done == 3 * MOTIONS
    motions = results.table("fragility_motions")
    assert (motions["intensity"] > 0).all()
    assert motions["intensity"].nunique() == MOTIONS
    assert "records.scale.pga" not in motions
    assert results.table("fragility").iloc[0]["outcome"] in ("fitted", "no trend")


def test_an_intensity_is_measured_on_each_motion(tmp_path):
    """Scaled by a factor, the curves may be over sa(0.3 s): the bracket of a motion is its own Sa at factor 1 times
    that of its factors."""
    from pounding_cli import records

    text = STUDY.replace(", scale: {pga: 0.1 g}", ", scale: 1").replace(
        "records.scale.pga: {from: 0.02 g, to: 1 g, step: 0.02 g}", "records.scale: {from: 0.2, to: 9.8, step: 0.2}"
    )
    one = solved(tmp_path, text)[1].table("fragility_motions")
    text = text.replace("limits: [mu > 4, contact]", "limits: [mu > 4, contact]\n  intensity: sa(0.3 s)")
    other = solved(tmp_path, text, replace=True)[1].table("fragility_motions")
    used = load_study(tmp_path / "known.yaml").motions((4,))  # factor 1
    for name, each in used.items():
        sa = records.spectrum(each.motion, (0.3,), 0.05)[0]
        ratio = other[other["record"] == name]["passed"] / one[one["record"] == name]["passed"]
        assert ratio.to_numpy() == pytest.approx(sa, rel=1e-9)


def test_other_axes_have_curves_of_their_own(tmp_path):
    text = STUDY.replace("sweep:\n", "sweep:\n  cases.near.gap: [10 mm, 30 mm]\n")
    outcome, results = solved(tmp_path, text)
    curves = results.table("fragility")
    assert curves["cases.near.gap"].tolist() == [0.01] * 3 + [0.03] * 3
    first, second = (curves[curves["cases.near.gap"] == gap].drop(columns="cases.near.gap") for gap in (0.01, 0.03))
    alone = [column for column in curves if column.endswith("0") and column != "unfitted"]
    assert first[alone].reset_index(drop=True).equals(second[alone].reset_index(drop=True))
    one_gap, _ = solved(tmp_path, STUDY, replace=True)
    assert outcome.done < 1.7 * (one_gap.done + one_gap.reused)  # both buildings alone are solved once


def test_contact_alone_makes_the_same_columns(tmp_path):
    """No curve of this study has a ratio or stands alone; whoever reads the table need not care."""
    columns = list(solved(tmp_path)[1].table("fragility"))
    _, only = solved(tmp_path, STUDY.replace("[mu > 4, contact]", "contact"), replace=True)
    assert list(only.table("fragility")) == columns
    assert np.isnan(only.table("fragility")["ratio"]).all()
