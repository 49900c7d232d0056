"""`pound gap`: what it prints, its table, its page, what it refuses, and that it goes on where it stopped."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

import pounding_cli
from pounding_cli.store import open_results

STUDY = """\
title: Two small buildings
records: {use: [elcentro, taft, parkfield], duration: 3 s}
buildings:
  A: {storeys: 3, period: 0.3 s}
  B: {like: A, storeys: 2, period: 0.5 s}
group: [A, B]
cases:
  near: {link: pounding, gap: 15 mm}
gap:
  percentiles: [25 %, 84 %]
  contact: 20 %
  asce7: {Cd: 5.5, R: 8}
  gb50011: {intensity: 8}
sweep:
  buildings.B.period: [0.4 s, 0.5 s]
  cases.near.gap: [1 mm, 2 mm]
"""


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    folder = tmp_path_factory.mktemp("gap")
    (folder / "two.yaml").write_text(STUDY)
    return pounding_cli.run(folder / "two.yaml", folder / "two-gap.h5", workflow="gap", engine="serial")


def test_prints_what_the_floors_need_that_need_most(pound):
    code, out, _ = pound("gap", "two.yaml")
    assert code == 0
    assert "A | B, floor 2, buildings.B.period = 0.4 s" in out
    assert re.search(r"^ elastic +exact +[\d.]+ ", out, re.MULTILINE)
    assert "3 motions; buildings alone: 30 solved, 0 reused, 0 failed" in out
    assert "Results: results/two-gap.h5" in out
    rows = open_results("results/two-gap.h5").table("gap")
    mean = rows[(rows["rule"] == "exact") & (rows["analysis"] == "elastic") & (rows["floor"] == 2)]["mean"].iloc[0]
    assert f"{1000 * mean:.4g}" in out


def test_swept_links_are_left_out_and_swept_buildings_stay(results):
    assert list(results.axes) == ["buildings.B.period"]
    assert set(results.table("gap")["buildings.B.period"]) == {0.4, 0.5}
    assert set(results.scene()["case"]) == {"apart"}


def test_statistics_are_those_of_the_closings(results):
    """Against numpy and scipy. Fails if a statistic runs over floors or points, or takes n for n - 1."""
    keys = ["buildings.B.period", "analysis", "left", "right", "floor"]
    rows = results.table("gap")
    exact = rows[rows["rule"] == "exact"].set_index(keys)
    closings = results.link().groupby(keys)["max_closing"]
    assert len(exact) == 2 * 2 * 2
    for place, values in closings:
        row, logs = exact.loc[place], np.log(values)
        assert row["motions"] == 3
        assert row["mean"] == pytest.approx(values.mean(), rel=1e-12)
        assert row["std"] == pytest.approx(values.std(ddof=1), rel=1e-12)
        assert row["mean_plus_std"] == pytest.approx(values.mean() + values.std(ddof=1), rel=1e-12)
        assert row["largest"] == values.max()
        assert row["percentile_25"] == pytest.approx(np.percentile(values, 25), rel=1e-12)
        assert row["percentile_84"] == pytest.approx(np.percentile(values, 84), rel=1e-12)
        assert row["median"] == pytest.approx(stats.gmean(values), rel=1e-12)
        assert row["dispersion"] == pytest.approx(logs.std(ddof=1), rel=1e-12)
        fitted = stats.lognorm(logs.std(ddof=1), scale=stats.gmean(values))
        assert fitted.sf(row["contact_20"]) == pytest.approx(0.2, rel=1e-9)
        assert row["contact_20_low"] < row["contact_20"] < row["contact_20_high"]


def test_confidence_interval_holds_as_often_as_it_says():
    """Of lognormal samples of six. Fails if the interval is that of the mean, or one-sided."""
    from pounding_cli.store.gap import _factors

    random = np.random.default_rng(3)
    logs = random.normal(0.3, 0.5, (20_000, 6))
    true = 0.3 + 0.5 * stats.norm.isf(0.1)
    _, low, high = _factors(6, 0.1)
    mean, spread = logs.mean(axis=1), logs.std(axis=1, ddof=1)
    assert np.mean(mean + low * spread > true) == pytest.approx(0.05, abs=0.006)
    assert np.mean(mean + high * spread < true) == pytest.approx(0.05, abs=0.006)


def test_rules_take_the_peaks_of_the_buildings_alone(results):
    rows = results.table("gap")
    at = (rows["buildings.B.period"] == 0.4) & (rows["analysis"] == "elastic") & (rows["floor"] == 2)
    mean = rows[at].set_index("rule")["mean"]
    floor = results.floor()
    here = floor[(floor["buildings.B.period"] == 0.4) & (floor["analysis"] == "elastic") & (floor["floor"] == 2)]
    a, b = (here[here["building"] == name].set_index("record")["displacement"] for name in "AB")
    assert mean["ABS"] == pytest.approx((a + b).mean(), rel=1e-12)
    assert mean["SRSS"] == pytest.approx(np.hypot(a, b).mean(), rel=1e-12)
    assert mean["ASCE 7-10"] == pytest.approx(5.5 / 8 * mean["SRSS"], rel=1e-12)
    assert mean["GB 50011-2010"] == 0.1
    assert mean["exact"] <= mean["ABS"]
    assert set(rows[rows["analysis"] == "inelastic"]["rule"]) == set(mean.index) - {"ASCE 7-10"}
    assert (rows[rows["rule"].isin(["GB 50011-2010", "UBC-1991"])]["motions"] == 0).all()


def test_every_width_has_its_error(results):
    rows = results.table("gap")
    assert rows["error"].notna().all()
    exact = rows[rows["rule"] == "exact"]
    assert ((exact["error"] > 0) & (exact["error"] < 1e-6 * exact["largest"])).all()


@pytest.mark.parametrize("engine", ["threads", "processes", "dask"])
def test_same_widths_from_every_engine(results, tmp_path, monkeypatch, engine):
    """Bit for bit. Fails if a closing depends on what was solved before it."""
    monkeypatch.setattr("pounding_cli.batch.runner.WORTH_WORKERS", 0.0)
    study = results.path.with_name("two.yaml")
    found = pounding_cli.run(study, tmp_path / "r.h5", workflow="gap", engine=engine, workers=2)
    assert found.attrs["engine"] == engine
    assert found.table("gap").equals(results.table("gap"))


def test_goes_on_where_it_stopped(pound, monkeypatch):
    """Fails if what was solved is lost: then all 30 are solved again."""
    from pounding_cli.batch import attempt

    solve, calls = attempt.Task.__call__, []

    def stops(task, scene):
        calls.append(scene)
        if len(calls) == 8:
            raise KeyboardInterrupt
        return solve(task, scene)

    monkeypatch.setattr(attempt.Task, "__call__", stops)
    code, _, err = pound("gap", "two.yaml", "--engine", "serial")
    assert code == 130
    assert "7 of 30 scenes kept" in err
    monkeypatch.setattr(attempt.Task, "__call__", solve)
    _, out, _ = pound("gap", "two.yaml", "--engine", "serial")
    assert "23 solved, 7 reused" in out


def test_the_page_answers_first(pound):
    pound("gap", "two.yaml", "-q")
    code, _, _ = pound("report", "results/two-gap.h5", "--format", "png")
    assert code == 0
    page = Path("results/two-gap/report.html").read_text(encoding="utf-8")
    assert "A | B: required gap at the floors that require the widest gap, 3 motions. Elastic: mean" in page
    assert 'id="figure-required-gap"' in page
    assert 'id="figure-required-gap-sweep"' in page
    assert 'id="explore"' not in page
    assert "none: the buildings stand alone" in page
    assert "gap nan" not in page
    assert "pound accuracy two.yaml -o" in page
    assert page.index('id="figure-required-gap"') < page.index('id="motions-head"')
    assert "NZS 1170.5" in page
    table = Path("results/two-gap/tables/gap.csv").read_text(encoding="utf-8")
    assert len(table.splitlines()) == 1 + len(open_results("results/two-gap.h5").table("gap"))


def test_shown_and_exported(pound):
    pound("gap", "two.yaml", "-q")
    _, out, _ = pound("show", "results/two-gap.h5")
    assert "mean [mm]" in out
    _, out, _ = pound("export", "results/two-gap.h5", "gap", "-o", "gap.csv")
    assert out == "wrote gap.csv\n"


def test_cites_the_rules(pound):
    pound("gap", "two.yaml", "-q")
    _, out, _ = pound("cite", "results/two-gap.h5")
    for name in ("Jeng, V.", "Der Kiureghian", "ASCE/SEI 7-10", "GB 50011-2010"):
        assert name in out


def test_results_of_a_run_are_not_overwritten(pound):
    pound("run", "two.yaml", "-q", "-o", "r.h5")
    code, _, err = pound("gap", "two.yaml", "-q", "-o", "r.h5")
    assert code == 2
    assert "the output holds results of `pound run`" in err
    code, _, err = pound("show", "r.h5", "gap")
    assert code == 2
    assert "has no table gap" in err


@pytest.mark.parametrize(
    ("line", "place", "words"),
    [
        ("percentiles: 84", "10:16", "'84' is not a percentile: it lacks its %"),
        ("percentiles: [84 %, 0.5]", "10:23", "'0.5' is not a percentile"),
        ("percentiles: 100 %", "10:16", "must be above 0 % and below 100 %"),
        ("contact: []", "10:12", "'contact' is empty"),
        ("contact: often", "10:12", "'often' is not a probability of contact"),
        ("asce7: {Cd: 5.5}", "10:10", "'R' is missing"),
        ("gb50011: {intensity: 5}", "10:24", "it must be at least 6"),
        ("gb50011: {intensity: 8, structure: tower}", "10:38", "'tower' is not known"),
        ("probability: 5 %", "10:3", "unknown key 'probability'"),
    ],
)
def test_bad_questions_are_refused_at_their_place(pound, line, place, words):
    Path("two.yaml").write_text(STUDY[: STUDY.index("gap:\n  per")] + f"gap:\n  {line}\n")
    code, out, err = pound("gap", "two.yaml")
    assert (code, out) == (2, "")
    assert f"two.yaml:{place}: " in err
    assert words in err
    assert "error: a fault" not in err


def test_one_building_has_no_gap(pound):
    Path("two.yaml").write_text(STUDY.replace("group: [A, B]", "group: [A]"))
    code, _, err = pound("gap", "two.yaml")
    assert code == 2
    assert "two.yaml:6:8: the group has 1 building" in err


def test_the_question_cannot_be_swept(pound):
    Path("two.yaml").write_text(STUDY.replace("  cases.near.gap: [1 mm, 2 mm]", "  gap.contact: [1 %, 2 %]"))
    code, _, err = pound("gap", "two.yaml")
    assert code == 2
    assert "'gap.contact' cannot be an axis" in err


def test_of_a_long_sweep_the_first_rows_are_read(pound, tmp_path, monkeypatch):
    """The table of a long sweep takes more memory than the run: what is printed is the same from its first rows."""
    text = STUDY.replace("[0.4 s, 0.5 s]", "{from: 0.4 s, to: 0.9 s, count: 11}")
    (tmp_path / "two.yaml").write_text(text)
    _, whole, _ = pound("gap", "two.yaml")
    assert "7 further pairs and points of the sweep" in whole
    found = open_results(tmp_path / "results" / "two-gap.h5")
    table = found.table("gap")
    rows = int(0.6 * len(table))
    assert found.answer_head("gap", rows).frame.equals(table[:rows])
    assert found.largest_in_answer("gap", "error") == table["error"].max()
    monkeypatch.setattr("pounding_cli.cli.gap.HEAD", rows)
    _, head, _ = pound("gap", "two.yaml")
    parts = [text.split("buildings alone: ")[0] for text in (whole, head)]
    assert parts[0] == parts[1]
