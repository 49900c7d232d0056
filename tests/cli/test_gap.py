"""`pound gap`: what it prints, its table, its page, what it refuses, and that it goes on where it stopped."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy import stats

import pounding_cli
from pounding_cli import open_results
from pounding_cli.questions.gap.codes import estimate_contact
from pounding_cli.questions.gap.statistics import find_fit_factors
from pounding_cli.questions.reports import build_report as report

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
  # displacements of the codes are asked for in CODES
  gb50011: {intensity: 8}
sweep:
  buildings.B.period: [0.4 s, 0.5 s]
  cases.near.gap: [1 mm, 2 mm]
"""


CODES = """\
title: Two oscillators by codes
records: {use: [weak.txt, strong.txt], scale: 1}
buildings:
  A: {storeys: 1, mass: 100 t, height: 3 m, stiffness: [20 kN/mm],
      yield: {base_shear: 0.10 W, overstrength: 2, Cd: 5.5, Ie: 1.25, qd: 3, R: 5}}
  B: {like: A, stiffness: [8 kN/mm], yield: {base_shear: 0.08 W, Cd: 3, Ie: 1, qd: 1.5, R: 4}}
group: [A, B]
cases:
  near: {link: pounding, gap: 3 cm}
  wide: {link: pounding, gap: 5 cm}
  filled: {link: infill, gap: 3 cm}
  none: {link: none}
"""


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    folder = tmp_path_factory.mktemp("gap")
    (folder / "two.yaml").write_text(STUDY)
    return pounding_cli.run(folder / "two.yaml", folder / "two-gap.h5", workflow="gap", engine="serial")


def test_prints_what_the_floors_need_that_need_most(pound):
    code, out, _ = pound("gap", "two.yaml")
    assert code == 0
    assert re.search(r"^ 0\.4 +elastic +exact +[\d.]+ ", out, re.MULTILINE)
    assert "Time histories: 30 solved, 0 reused, 0 failed" in out
    assert "Results: results/two-gap.h5" in out
    rows = open_results("results/two-gap.h5").table("gap")
    mean = rows[(rows["rule"] == "exact") & (rows["analysis"] == "elastic") & (rows["floor"] == 2)]["mean"].iloc[0]
    assert f"{1000 * mean:.4g}" in out
    first, *_ = out.partition("\n\n")[0].splitlines()[1:]
    assert first.startswith("At buildings.B.period = 0.5 s: 1 mm and 2 mm are not enough: elastic buildings need ")
    assert "Required gap at the floors whose mean over the motions is the widest: A | B, floor 2" in out


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
        assert np.isnan([row["contact_20_low"], row["contact_20_high"]]).all()  # of three motions


def test_confidence_interval_holds_as_often_as_it_says():
    """Of lognormal samples of six. Fails if the interval is that of the mean, or one-sided; if it is not scipy's."""
    random = np.random.default_rng(3)
    logs = random.normal(0.3, 0.5, (20_000, 6))
    true = 0.3 + 0.5 * stats.norm.isf(0.1)
    z, low, high = find_fit_factors(6, 0.1)
    assert z == pytest.approx(stats.norm.isf(0.1), rel=1e-12)
    expected = stats.nct.ppf([0.05, 0.95], 5, stats.norm.isf(0.1) * np.sqrt(6)) / np.sqrt(6)
    assert (low, high) == pytest.approx(tuple(expected), rel=1e-9)
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
    assert mean["GB 50011-2010"] == 0.1
    assert mean["exact"] <= mean["ABS"]
    assert set(rows[rows["analysis"] == "inelastic"]["rule"]) == set(mean.index)
    assert (rows[rows["rule"].isin(["GB 50011-2010", "UBC-1991"])]["motions"] == 0).all()


def test_every_width_has_its_error(results):
    rows = results.table("gap")
    assert rows["error"].notna().all()
    exact = rows[rows["rule"] == "exact"]
    assert ((exact["error"] > 0) & (exact["error"] < 1e-6 * exact["largest"])).all()


def test_the_page_answers_first(pound):
    pound("gap", "two.yaml", "-q")
    code, _, _ = pound("report", "results/two-gap.h5", "--format", "png")
    assert code == 0
    page = Path("results/two-gap/report.html").read_text(encoding="utf-8")
    assert "1 mm and 2 mm are not enough: elastic buildings need" in page
    assert 'id="figure-required-gap"' in page
    assert 'id="explorer"' not in page
    assert "none: the buildings stand alone" in page
    assert "gap nan" not in page
    assert page.index('id="figure-required-gap"') < page.index('id="motions"')
    assert "Gaps of the cases and required gaps, both at the governing floors" in page
    assert "Distance to a property line" in page
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
    for name in ("Jeng, V.", "Der Kiureghian", "GB 50011-2010"):
        assert name in out
    assert "ASCE/SEI" not in out
    Path("codes.yaml").write_text(CODES)
    _, out, _ = pound("cite", "codes.yaml")
    assert "Uniform Building Code" not in out
    pound("gap", "codes.yaml", "-q")
    _, out, _ = pound("cite", "results/codes-gap.h5")
    assert "ASCE/SEI 7-16" in out
    assert "EN 1998-1:2004" in out


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
        ("asce7: {Cd: 5.5}", "10:3", "unknown key 'asce7'"),
        ("gb50011: {intensity: 5}", "10:24", "at least 6"),
        ("gb50011: {intensity: 8, structure: tower}", "10:38", "'tower' is not known"),
        ("probability: 5 %", "10:3", "unknown key 'probability'"),
        ("ntc2018: {soil: 1.2}", "10:12", "'ag' is missing"),
        ("ntc2018: {ag: 0.25}", "10:17", "'0.25' lacks its unit"),
        ("ntc2018: {ag: 25 g}", "10:17", "at most 30 m/s2"),
        ("ntc2008: {ag: 0.25 g, soil: C}", "10:31", "write a soil factor S"),
        ("codes: TBDY", "10:10", "'TBDY' is not known"),
        ("codes: [E.030, ASCE 7-16]", "10:18", "'ASCE 7-16' is not selected by its name"),
        ("codes: NTC 2018", "10:10", "write the key `ntc2018` in `gap`"),
        ("hazard: {k0: 1e-4, k: 2.5}", "10:3", "motions that are scaled to an intensity"),
    ],
)
def test_bad_questions_are_refused_at_their_place(pound, line, place, words):
    Path("two.yaml").write_text(STUDY[: STUDY.index("gap:\n  per")] + f"gap:\n  {line}\n")
    code, out, err = pound("gap", "two.yaml")
    assert (code, out) == (2, "")
    assert f"two.yaml:{place}: " in err
    assert words in err
    assert "error: a fault" not in err


def test_what_was_taken_of_a_file_of_a_hazard_curve_is_said(pound):
    """By `check` and by the question; OpenQuake's curve of another period than that of the study is refused."""
    Path("h.csv").write_text("PGA; p in 50 years\n0.05; 0.4\n0.5; 0.01\n")
    Path("oq.csv").write_text("# investigation_time=50, imt='SA(0.1)'\nlon,lat,poe-0.1,poe-0.5\n1,2,0.1,0.01\n")
    scaled = STUDY[: STUDY.index("  percentiles")].replace("duration: 3 s", "duration: 1 s, scale: {pga: 0.3 g}")
    Path("a.yaml").write_text(scaled + "  hazard: {file: h.csv, intensity: 1, unit: g, probability: 2, years: 50}\n")
    taken = "h.csv: hazard curve of 2 points, intensities from 0.05 to 0.5 g, annual rates from 0.01022 to 0.000201; "
    assert taken in pound("check", "a.yaml")[1]
    assert taken in pound("gap", "a.yaml")[2]
    assert f'"text": "{taken}' in pound("gap", "a.yaml", "--log-json", "-o", "b.h5")[1]
    of_period = scaled.replace("pga: 0.3 g", "sa: 0.3 g, period: 0.5 s")
    Path("b.yaml").write_text(of_period + "  hazard: oq.csv\nsweep: {records.scale.sa: [0.1 g, 0.3 g]}\n")
    code, _, err = pound("gap", "b.yaml")
    assert code == 2
    assert "the hazard is that of SA(0.1), the intensity is SA(0.5)" in err


def test_one_building_has_no_gap(pound):
    Path("two.yaml").write_text(STUDY.replace("group: [A, B]", "group: [A]"))
    code, _, err = pound("gap", "two.yaml")
    assert code == 2
    assert "two.yaml:6:8: the group has 1 building" in err


def test_the_question_cannot_be_swept(pound):
    Path("two.yaml").write_text(STUDY.replace("  cases.near.gap: [1 mm, 2 mm]", "  gap.contact: [1 %, 2 %]"))
    code, _, err = pound("gap", "two.yaml")
    assert code == 2
    assert "'gap.contact' cannot vary" in err


# The gaps of the cases


def test_gaps_of_the_cases_stand_beside_what_is_required(pound):
    """Every swept gap once for each point of what is left of the sweep. Fails if a case is compared with one point
    alone, or a gap with another rule's width."""
    code, out, _ = pound("gap", "two.yaml")
    assert code == 0
    results = open_results("results/two-gap.h5")
    cases, widths = results.table("gap_cases"), results.table("gap")
    assert sorted(set(cases["gap"])) == [0.001, 0.002]
    keys = ["buildings.B.period", "analysis", "floor", "rule"]
    assert not cases.duplicated([*keys[:2], "gap", "rule"]).any()
    largest = widths.set_index(keys)["largest"]
    for row in cases.to_dict("records"):
        required = largest.loc[tuple(row[key] for key in keys)]
        assert row["required"] == required
        assert (row["enough"] == "yes") == (required <= row["gap"])
    assert re.search(r"^ 0.4\d* +elastic +exact +1\.000 +[\d.]+ +no +0 of 3 *$", out, re.MULTILINE)
    _, out, _ = pound("show", "results/two-gap.h5", "gap_cases")
    assert "required [mm]" in out


RUNS = """\
title: Two small buildings
records: {use: [elcentro, taft, parkfield], duration: 5 s}
buildings:
  A: {storeys: 3, period: 0.3 s}
  B: {like: A, storeys: 2, period: 0.5 s}
group: [A, B]
cases:
  near: {link: pounding, gap: 15 mm}
  top: {gap: 15 mm, links: [{link: pounding, floors: rest}, {link: pounding, floors: 1, gap: 5 mm}]}
sweep:
  cases.near.gap: {from: 5 mm, to: 60 mm, step: 5 mm}
"""


def test_a_gap_that_is_enough_stays_open_and_one_that_is_not_closes(tmp_path):
    """Motion by motion, against the runs of the study itself. Fails if floors, motions or analyses are mixed up, or if
    a gap is judged at one floor alone."""
    (tmp_path / "s.yaml").write_text(RUNS)
    found = pounding_cli.run(tmp_path / "s.yaml", tmp_path / "gap.h5", workflow="gap", engine="serial")
    link = pounding_cli.run(tmp_path / "s.yaml", tmp_path / "run.h5", engine="serial").link()
    cases = found.table("gap_cases")
    exact = cases[cases["rule"] == "exact"]
    assert set(exact["enough"]) == {"yes", "no"}
    assert exact["enough_for"].between(1, 2).any()
    for row in exact.to_dict("records"):
        here = link[(link["case"] == row["case"]) & (link["analysis"] == row["analysis"])]
        if row["case"] == "near":
            here = here[here["cases.near.gap"] == row["gap"]]
        open_for = (here.groupby(["cases.near.gap", "record"])["impacts"].sum() == 0).groupby(level=0).sum()
        assert set(open_for) == {row["enough_for"]}, row
        assert (row["enough"] == "yes") == (row["enough_for"] == row["motions"] == 3)
    top = exact[(exact["case"] == "top") & (exact["analysis"] == "elastic")]
    assert top["gap"].tolist() == [0.005] or top["floor"].tolist() == [2]


def test_cases_whose_buildings_do_not_move_alone_are_not_compared(pound):
    Path("codes.yaml").write_text(CODES)
    _, out, _ = pound("gap", "codes.yaml")
    assert set(open_results("results/codes-gap.h5").table("gap_cases")["case"]) == {"near", "wide"}
    assert "Not compared: filled, none." in out
    Path("none.yaml").write_text(re.sub(r"  (near|wide): .*\n", "", CODES))
    code, out, _ = pound("gap", "none.yaml")
    assert code == 0
    assert open_results("results/none-gap.h5").table("gap_cases").empty
    assert "Gaps of the cases" not in out
    assert pound("report", "results/none-gap.h5", "--format", "png", "-q")[0] == 0


def test_a_row_of_three_says_when_a_pair_is_not_alone(pound):
    Path("three.yaml").write_text(CODES.replace("group: [A, B]", "group: [A, B, A]"))
    _, out, _ = pound("gap", "three.yaml")
    assert "Where the gap on one side is not enough, the answer for the other side does not hold." in " ".join(
        out.split()
    )


# Codes with factors of every building


def statics(share: float, stiffness: float) -> float:
    """Static displacement of 100 t under a share of its weight [m]."""
    return share * 9.80665 * 100e3 / stiffness


def test_rules_of_codes_by_hand(pound):
    """ASCE/SEI 7-16, 12.12.3, and EN 1998-1:2004, 4.4.2.7. Fails if a factor is taken from the neighbour, the strength
    from the yield shear, or 0.7 where it does not belong."""
    text = CODES.replace("R: 4", "R: 4, mu_d: 4, irregular: true")
    Path("codes.yaml").write_text(
        f"{text}gap: {{ntc2018: {{ag: 0.2 g, soil: 1.25}}, codes: [TBDY 2018, E.030, NBC 202]}}\n"
    )
    code, _, _ = pound("gap", "codes.yaml")
    assert code == 0
    a, b = statics(0.10, 20e6), statics(0.08, 8e6)
    moves = {"ASCE 7-16": (5.5 / 1.25 * a, 3 * b), "EN 1998-1": (3 * a, 1.5 * b)}
    results = open_results("results/codes-gap.h5")
    table, cases, line = (results.table(name) for name in ("gap", "gap_cases", "property_line"))
    of_others = {
        "NTC 2018": 0.03 * 0.25 + 4 * b,  # A by its height, B by its mu_d
        "TBDY 2018": 0.25 * np.hypot(5 / 1.25 * a, 4 * b),
        "E.030": 2 / 3 * (0.75 * 5 * a + 0.85 * 4 * b),
        "NBC 202": 0.04,
    }
    at_roof = table[table["analysis"] == "elastic"].set_index("rule")["mean"]
    least = {"TBDY 2018": 0.03}  # of a roof at 3 m
    expected = {rule: max(gap, least.get(rule, 0)) for rule, gap in of_others.items()}
    assert {rule: at_roof[rule] for rule in of_others} == pytest.approx(expected, rel=1e-12)
    peru = line[line["rule"] == "E.030"].groupby("building")["mean"].first().to_dict()
    expected = {"A": max(2 / 3 * 0.75 * 5 * a, 0.015), "B": max(2 / 3 * 0.85 * 4 * b, 0.015)}
    assert peru == pytest.approx(expected, rel=1e-12)
    for rule, (one, other) in moves.items():
        apart = np.hypot(one, other) * (0.7 if rule == "EN 1998-1" else 1.0)
        rows = table[table["rule"] == rule]
        assert rows["mean"].tolist() == pytest.approx([apart, apart], rel=1e-12)  # elastic and inelastic
        assert set(rows["motions"]) == {0}
        for name, moved in (("A", one), ("B", other)):
            rows = line[(line["rule"] == rule) & (line["building"] == name)]
            assert rows["mean"].tolist() == pytest.approx([moved] * 4, rel=1e-12)  # two sides, two analyses
        enough = cases[cases["rule"] == rule].set_index("case")["enough"].to_dict()
        assert enough == {"near": "yes" if apart <= 0.03 else "no", "wide": "yes" if apart <= 0.05 else "no"}
    assert moves["ASCE 7-16"][0] == pytest.approx(0.02157463)  # 5.5 / 1.25 x 0.1 x 9.80665 x 100e3 / 20e6


@pytest.mark.parametrize(
    ("b", "factor"),
    [("storeys: 2, stiffness: [16 kN/mm, 8 kN/mm]", 0.7), ("stiffness: [8 kN/mm], height: 3.5 m, columns: 20 %", 1.0)],
)
def test_seven_tenths_where_the_floors_have_the_same_elevations(tmp_path, b, factor):
    """EN 1998-1, 4.4.2.7(3); a half in TBDY 2018. Fails if the number of storeys, or one pair of floors,
    decides."""
    text = (
        CODES.replace("stiffness: [8 kN/mm]", b)
        .replace("weak.txt, strong.txt", "elcentro")
        .replace("scale: 1", "duration: 1 s")
    )
    text = text.replace("storeys: 1", "storeys: 1, columns: 20 %").replace("  filled: {link: infill, gap: 3 cm}\n", "")
    text = text.replace("R: 5", "R: 20").replace("R: 4", "R: 16")
    (tmp_path / "s.yaml").write_text(f"{text}gap: {{codes: [TBDY 2018]}}\n")
    found = pounding_cli.run(tmp_path / "s.yaml", tmp_path / "r.h5", workflow="gap", engine="serial")
    rows = found.table("gap").query("rule == 'EN 1998-1' and analysis == 'elastic'")
    one, other = (
        found.table("property_line")
        .query(f"rule == 'EN 1998-1' and building == '{name}' and floor == 1")["mean"]
        .iloc[0]
        for name in "AB"
    )
    if factor == 1.0:  # the slab of A beside the columns of B, at 3 m of 3.5 m
        at = 3 / 3.5
        other *= at * at * (3 - 2 * at)
    assert rows["mean"].iloc[0] == pytest.approx(factor * np.hypot(one, other), rel=1e-12)
    share = 0.5 if factor == 0.7 else 1.0
    gaps = found.table("gap").query("analysis == 'elastic'").groupby("rule")["mean"].first()
    turkish = 0.5 * share * np.hypot(20 / 1.25 / 3 * one, 16 / 1.5 * other)
    assert gaps["TBDY 2018"] == pytest.approx(turkish, rel=1e-12)
    assert turkish > 0.03


def test_a_rule_without_its_factors_is_not_evaluated(pound):
    Path("codes.yaml").write_text(CODES.replace("Cd: 3, Ie: 1, ", "").replace("Ie: 1.25, qd: 3", "qd: 3"))
    Path("codes.yaml").write_text(
        Path("codes.yaml").read_text().replace("like: A, ", "storeys: 1, mass: 100 t, height: 3 m, ")
    )
    assert pound("gap", "codes.yaml")[0] == 0
    assert "ASCE 7-16" not in set(open_results("results/codes-gap.h5").table("gap")["rule"])
    assert "EN 1998-1" in set(open_results("results/codes-gap.h5").table("gap")["rule"])


@pytest.mark.parametrize(
    ("line", "place", "words"),
    [
        ("yield: {code: UBC-1991, Cd: 5.5}", "4:42", "'code' does not go with the other keys here"),
        ("yield: {Cd: 5.5, Ie: 1}", "4:41", "'base_shear' is missing"),
        ("yield: {base_shear: 0.1, Cd: 0.5}", "4:63", "must be at least 1"),
        ("yield: {base_shear: 0.1, qd: q}", "4:63", "write a displacement behaviour factor q_d"),
        ("yield: {base_shear: 0.1, R: 0.5}", "4:62", "must be at least 1"),
        ("yield: {base_shear: 0.1, mu_d: 0}", "4:65", "must be at least 1"),
        ("yield: {code: UBC-1991, R: 5}", "4:42", "'code' does not go with the other keys here"),
    ],
)
def test_bad_factors_are_refused_at_their_place(pound, line, place, words):
    Path("two.yaml").write_text(
        STUDY.replace("  A: {storeys: 3, period: 0.3 s}", f"  A: {{storeys: 3, period: 0.3 s, {line}}}")
    )
    code, out, err = pound("gap", "two.yaml")
    assert (code, out) == (2, "")
    assert f"two.yaml:{place}: " in err
    assert words in err


# What the gaps of codes are worth


def test_a_gap_of_a_code_is_closed_by_as_many_motions_as_a_run_says(tmp_path):
    """With this gap in a case, motion by motion; the probability by a fit of scipy's. Fails if one floor is taken for
    all, or if motions are counted that the gap stands."""
    text = RUNS[: RUNS.index("cases:")].replace("duration: 5 s", "duration: 4 s, scale: {pga: 0.25 g}")
    text += "cases: {near: {link: pounding, gap: 15 mm}}\ngap: {codes: [E.030, NBC 202]}\n"
    text = text.replace("period: 0.3 s", "period: 0.3 s, yield: {base_shear: 0.1 W, overstrength: 3, R: 6}")
    (tmp_path / "s.yaml").write_text(text)
    found = pounding_cli.run(tmp_path / "s.yaml", tmp_path / "gap.h5", workflow="gap", engine="serial")
    codes = found.table("gap_codes")
    assert set(codes["rule"]) == {"E.030", "NBC 202"}
    assert codes["closed"].between(1, 2).any()
    assert codes["rate"].isna().all()
    largest = found.link().groupby(["analysis", "record"])["max_closing"].max()
    for gap, of_gap in codes.groupby("gap"):
        (tmp_path / "run.yaml").write_text(text.replace("15 mm", f"{1000 * gap!r} mm"))
        link = pounding_cli.run(tmp_path / "run.yaml", tmp_path / f"{gap}.h5", engine="serial").link()
        touched = link.groupby(["analysis", "record"])["impacts"].sum() > 0
        for row in of_gap.to_dict("records"):
            assert (row["closed"], row["motions"]) == (touched[row["analysis"]].sum(), 3)
            logs = np.log(largest[row["analysis"]])
            fitted = stats.norm(logs.mean(), logs.std(ddof=1)).sf(np.log(gap))
            assert row["probability"] == pytest.approx(fitted, rel=1e-9)


@pytest.mark.parametrize("motions", [5, 22])
def test_the_interval_of_a_probability_is_that_of_its_gap(motions):
    """The gap at an end of the interval of `contact` has the probability at an end of its own."""
    closings = np.exp(np.random.default_rng(2).normal(-3, 0.5, motions))
    logs = np.log(closings)
    for share in (0.5, 0.1, 0.01):
        gaps = np.exp(logs.mean() + np.array(find_fit_factors(motions, share)) * logs.std(ddof=1))
        assert estimate_contact(closings, gaps[0])[0] == pytest.approx(share, rel=1e-9)
        assert estimate_contact(closings, gaps[1])[1] == pytest.approx(share, rel=1e-6)
        assert estimate_contact(closings, gaps[2])[2] == pytest.approx(share, rel=1e-6)
    low, high = estimate_contact(closings, np.median(closings))[1:]
    assert 0 < low < high < 1
    assert np.isnan(estimate_contact(closings[:4], 0.05)[1:]).all()
    assert np.isnan(estimate_contact(closings[:1], 0.05)).all()


# The distance to a property line

ALONE = """title: An oscillator beside a property line
records: {{use: [{{file: push.txt, unit: m/s2, time: 1}}], scale: 1}}
buildings:
  A: {{storeys: 1, mass: 100 t, height: 3 m, period: 0.5 s, rayleigh: {{alpha: 1.2, beta: 0}}, yield_shear: never}}
  B: {{like: A, period: 0.9 s}}
group: [A, B]
cases: {{near: {{link: pounding, gap: 3 cm}}}}
analyses: [elastic]
tail: {tail} s
"""
PUSH = [(0.0, 0.0), (0.1, 3.0), (0.2, 0.5), (0.3, -1.0), (0.4, 0.0)]


def test_property_line_of_an_oscillator(tmp_path):
    """Against an integrator of the equation of motion that shares no code. Fails if the sides are mixed up, if the
    larger of both is taken for either, or if free vibration after the motion is left out."""
    from scipy.integrate import solve_ivp

    (tmp_path / "push.txt").write_text("time, value\n" + "".join(f"{t} {a}\n" for t, a in PUSH))
    (tmp_path / "s.yaml").write_text(ALONE.format(tail=2))
    found = pounding_cli.run(tmp_path / "s.yaml", tmp_path / "r.h5", workflow="gap", engine="serial")
    line = found.table("property_line").set_index(["building", "side"])
    times, ground = np.array(PUSH).T
    for name, period in (("A", 0.5), ("B", 0.9)):
        omega = 2 * np.pi / period

        def rate(t, y, omega=omega):
            return [y[1], -np.interp(t, times, ground, right=0.0) - 1.2 * y[1] - omega**2 * y[0]]

        u = solve_ivp(rate, (0, 2.4), [0, 0], rtol=1e-10, atol=1e-13, max_step=0.002, dense_output=True)
        u = u.sol(np.linspace(0, 2.4, 200_001))[0]
        assert line.loc[(name, "left"), "largest"] == pytest.approx(-u.min(), rel=1e-5)
        assert line.loc[(name, "right"), "largest"] == pytest.approx(u.max(), rel=1e-5)
        assert abs(u.max() + u.min()) > 0.05 * u.max()  # the sides differ
        assert (line.loc[name, "floor"] == 1).all()
        assert line.loc[(name, "left"), "height"] == 3.0


def test_property_line_is_printed_and_exported(pound):
    code, out, _ = pound("gap", "two.yaml")
    assert code == 0
    assert "Distance to a property line, at the floors whose mean over the motions is the largest" in out
    assert re.search(r"^ 0\.4 +B +right +2 +elastic +exact +[\d.]+ ", out, re.MULTILINE)
    results = open_results("results/two-gap.h5")
    line, floor = results.table("property_line"), results.floor()
    assert len(line) == 2 * 2 * (3 + 2) * 2
    keys = ["buildings.B.period", "analysis", "building", "floor"]
    for (*place, side), row in line.set_index([*keys, "side"]).iterrows():
        here = floor.set_index(keys).loc[tuple(place)]
        moved = here["displacement_max"] if side == "right" else -here["displacement_min"]
        assert row["mean"] == pytest.approx(moved.mean(), rel=1e-12)
        assert row["largest"] == moved.max()
        assert 0 < row["error"] < 1e-5 * here["displacement"].max()
    assert pound("export", "results/two-gap.h5", "property_line", "-o", "line.csv")[1] == "wrote line.csv\n"
    _, out, err = pound("show", "results/two-gap.h5", "optimise_points")
    assert "pound optimise STUDY" in err


# Intervals of few motions


@pytest.mark.parametrize("motions", [2, 4, 5])
def test_no_interval_of_few_motions(pound, motions):
    """Two motions gave "12.2 cm to 3300 cm"."""
    names = ["elcentro", "taft", "eureka", "olympia", "parkfield"][:motions]
    text = RUNS[: RUNS.index("sweep:")].replace("[elcentro, taft, parkfield]", str(names).replace("'", ""))
    Path("few.yaml").write_text(text)
    _, out, _ = pound("gap", "few.yaml")
    pound("report", "results/few-gap.h5", "--format", "png", "-q")
    page = " ".join(Path("results/few-gap/report.html").read_text(encoding="utf-8").split())
    said = " ".join(out.split())
    results = open_results("results/few-gap.h5")
    exact = pd.concat([results.table(name).query("rule == 'exact'") for name in ("gap", "property_line")])
    assert exact["contact_10"].notna().all()
    why = f"No confidence interval: it needs at least 5 motions, and there are {motions} motions."
    if motions < 5:
        assert exact[["contact_10_low", "contact_10_high"]].isna().all(axis=None)
        assert why in said
        assert why in page
        assert "In brackets" not in page
        assert re.search(r"\([\d.]+ to [\d.]+\)", said) is None
    else:
        assert (exact["contact_10_low"] < exact["contact_10"]).all()
        assert (exact["contact_10"] < exact["contact_10_high"]).all()
        assert "In brackets: 90 % confidence interval." in said
        assert "No confidence interval" not in said + page
        assert "In brackets: 90 % confidence interval." in page


def test_where_every_scene_collapses_nothing_is_required(pound):
    """Fails with a traceback where no motion has a value, or if the cases are said to have no link."""
    weak = "storeys: 2, period: 1 s, mass: 100 t, p_delta: true, hardening: 0, yield_shear: [20 kN, 20 kN]"
    text = (
        RUNS[: RUNS.index("sweep:")]
        .replace("storeys: 3, period: 0.3 s", weak)
        .replace("storeys: 2, period: 0.5", "period: 1.5")
    )
    text = text.replace("duration: 5 s", "duration: 12 s, scale: {pga: 3 g}") + "analyses: [inelastic]\n"
    Path("two.yaml").write_text(text)
    code, out, _ = pound("gap", "two.yaml")
    assert code == 0
    assert "All runs failed (3 collapsed); the gaps were not checked." in out
    assert "Not compared" not in out
    results = open_results("results/two-gap.h5")
    assert set(results.scene()["status"]) == {"collapsed"}
    assert results.table("gap").empty
    strength = "yield: {code: UBC-1991, zone: 0.1, soil: 1.2, Rw: 12}"
    Path("two.yaml").write_text(text.replace("yield_shear: [20 kN, 20 kN]", strength))
    code, out, _ = pound("gap", "two.yaml")
    assert code == 0
    assert set(open_results("results/two-gap.h5").scene()["status"]) == {"collapsed"}
    assert "the gaps were compared with the rules of codes only." in " ".join(out.split())
    assert "umerical error" not in out
    answer = report(open_results("results/two-gap.h5")).answer
    assert [set(table.frame["rule"]) for table in answer.tables] == [{"UBC-1991"}, {"UBC-1991"}]


def test_panels_of_unequal_pairs_show_all_floors(tmp_path):
    """Fails if the first pair, the lowest, sets the height of all panels, or if a panel with none beneath it has no
    numbers across."""
    storeys = {"A": 2, "B": 4, "C": 6, "D": 5, "E": 3, "F": 2}
    each = (f"  {name}: {{storeys: {count}, period: {0.1 * count:.1f} s}}\n" for name, count in storeys.items())
    buildings = "".join(each)
    head, rest = STUDY[: STUDY.index("buildings:")], STUDY[STUDY.index("cases:") : STUDY.index("sweep:")]
    text = f"{head}buildings:\n{buildings}group: [A, B, C, D, E, F]\n{rest}analyses: [elastic]\n"
    (tmp_path / "row.yaml").write_text(text)
    results = pounding_cli.run(tmp_path / "row.yaml", tmp_path / "row.h5", workflow="gap", engine="serial")
    axes = report(results).figures()[0].draw().axes
    heights = results.table("gap")["height"]
    assert axes[0].get_ylim()[0] == 0
    assert all(ax.get_ylim()[1] > heights.max() for ax in axes)
    assert [ax.xaxis.get_tick_params()["labelbottom"] for ax in axes] == [False, False, True, True, True]


TWIST = """\
records: {use: [taft], duration: 4 s, scale: {pga: 0.3 g}}
analyses: [inelastic]
estimate: none
buildings:
  corner:
    mass: [200 t, 180 t]
    damping: 5 %
    plan:
      width: 20 m
      inertia: [8000 t m2, 7000 t m2]
      torsional_stiffness: [4 GN m, 3 GN m]
      lines:
        - {y: -7 m, stiffness: [120 kN/mm, 100 kN/mm], yield_shear: [600 kN, 500 kN]}
        - {y: 6 m, stiffness: [70 kN/mm, 60 kN/mm], yield_shear: [300 kN, 250 kN]}
  soft:
    storeys: 2
    period: 0.6 s
    plan: {width: 16 m, depth: 12 m, shift: 3 m, eccentricity: 10 %, frequency_ratio: 1.1}
    yield: {base_shear: 0.1 W, Cd: 5, Ie: 1}
  even: {like: soft, plan: {width: 16 m, depth: 12 m, shift: 3 m, eccentricity: 0 %, frequency_ratio: 1.1}}
  off: {like: even, plan: {shift: 6 m}}
  plain: {storeys: 2, period: 0.6 s, yield: {base_shear: 0.1 W, Cd: 5, Ie: 1}}
  moat: {wall: fixed}
"""


def solve_twisting(
    folder: Path, group: str, link: str, workflow: str = "gap", further: str = ""
) -> pounding_cli.Results:
    """Return the answer of a study of buildings of TWIST; time histories of those before are not reused."""
    path = folder / f"{len(list(folder.iterdir()))}.yaml"
    path.write_text(f"{TWIST}group: [{group}]\ncases: {{near: {link}}}\n{further}\n")
    return pounding_cli.run(path, path.with_suffix(".h5"), workflow=workflow, engine="serial")


@pytest.fixture(scope="module")
def twisting(tmp_path_factory) -> pounding_cli.Results:
    return solve_twisting(tmp_path_factory.mktemp("twist"), "corner, soft", "{link: none}")


def test_the_gap_of_floors_that_twist_is_that_of_their_edges(twisting, tmp_path):
    """Against a search of the smallest gap without contact. Fails if the closing is that of the centres of mass, if one
    end of the shared edge is left out, or if a gap that stays open is judged without the twist."""
    gaps = twisting.table("gap")
    exact = gaps[gaps["rule"] == "exact"].sort_values("largest")
    needed = exact["largest"].iloc[-1]
    assert exact["end"].iloc[-1] == "low end"
    assert exact["street"].iloc[-1] == -5.0
    assert set(exact["street"]) == {-5.0, 10.0}
    tried = ", ".join(f"{float(needed) * share!r} m" for share in (1 - 1e-6, 1 + 1e-6, 2))
    sweep = f"sweep: {{cases.near.gap: [{tried}]}}"
    run = solve_twisting(tmp_path, "corner, soft", "{link: pounding, gap: 1 cm}", "run", sweep)
    impacts = run.link().groupby("cases.near.gap")["impacts"].sum()
    assert impacts.iloc[0] > 0
    assert (impacts.iloc[1:] == 0).all()
    here = run.link("max_closing", "street")
    open_gap = here[here["cases.near.gap"] == here["cases.near.gap"].max()].sort_values("max_closing")
    np.testing.assert_allclose(open_gap["max_closing"].to_numpy(), exact["largest"].to_numpy(), rtol=1e-9)
    bound = gaps[gaps["rule"] == "ABS"].set_index(["floor", "street"])["mean"].sort_index()
    assert (exact.set_index(["floor", "street"])["mean"].sort_index() <= bound).all()
    first = report(twisting).answer.sentences[0]
    assert "1 motion, at the low end of the shared edge of floor 2)" in first


def test_distances_of_floors_that_twist_are_those_of_their_edges(twisting, tmp_path):
    """Against the closing to a wall that they do not reach. Fails if a side or an end is taken for the other, or if the
    gap beside a wall is not the distance to its line."""
    line = twisting.table("property_line")
    line = line[(line["rule"] == "exact") & (line["floor"] == 2)].set_index(["building", "side", "end"])["mean"]
    run = solve_twisting(tmp_path, "moat, corner, moat", "{link: pounding, gap: 1 m}", "run")
    link = run.link()
    link = link[link["floor"] == 2].sort_values("street")
    to_left = link[link["left"] == "moat-1"]["max_closing"].tolist()
    to_right = link[link["left"] == "corner"]["max_closing"].tolist()
    for side, moved in (("left", to_left), ("right", to_right)):
        distances = [line["corner", side, end] for end in ("low end", "high end")]
        np.testing.assert_allclose(distances, moved, rtol=1e-9)


def test_plans_without_eccentricity_change_no_gap(tmp_path):
    """Fails if places along the street appear where no floor twists, or a neighbour that stands off turns a building
    that it does not touch."""
    plain = solve_twisting(tmp_path, "plain, plain", "{link: pounding, gap: 1 cm}")
    even = solve_twisting(tmp_path, "even, off", "{link: pounding, gap: 1 cm}")
    for name in ("gap", "gap_cases", "property_line"):
        table = even.table(name).replace({"even": "plain-1", "off": "plain-2"})
        pd.testing.assert_frame_equal(table, plain.table(name), rtol=1e-12)
        assert "end" not in table


def test_codes_count_the_twist_of_the_plan(tmp_path):
    """Against the static solution of all degrees of freedom at once. Fails if the twist has the wrong sign, or the gap
    of a code is that of the centres of mass."""
    line = solve_twisting(tmp_path, "plain, soft", "{link: pounding, gap: 1 cm}").table("property_line")
    asce = line[(line["rule"] == "ASCE 7-16") & (line["side"] == "left")]
    building = pounding_cli.load_study(tmp_path / "0.yaml").building((), 1)
    floors = building.plan
    stiffness = np.zeros((4, 4))
    for storey in range(2):
        drift = np.eye(4)[storey] - (np.eye(4)[storey - 1] if storey else 0.0)
        turn = np.roll(drift, 2)
        for each in floors.lines:
            v = drift - each.arm * turn
            stiffness += each.stiffness[storey] * np.outer(v, v)
        stiffness += floors.torsional_stiffness[storey] * np.outer(turn, turn)
    elastic = (
        asce[asce["building"] == "plain"].sort_values("floor")["mean"].to_numpy() / 5
    )  # of floors that do not twist
    shears = building.stiffness * np.diff(elastic, prepend=0.0)
    u = np.linalg.solve(stiffness, [*-np.diff(shears, append=0.0), 0.0, 0.0])
    for end, y in (("low end", floors.low), ("high end", floors.high)):
        at_end = asce[(asce["building"] == "soft") & (asce["end"] == end)].sort_values("floor")["mean"]
        np.testing.assert_allclose(at_end, 5 * np.abs(u[:2] - y * u[2:]), rtol=1e-9)


def test_a_row_without_a_shared_edge_is_refused(pound):
    beside = TWIST.replace("shift: 3 m", "shift: 30 m")
    Path("far.yaml").write_text(f"{beside}group: [corner, soft]\ncases: {{near: {{link: none}}}}\n")
    code, _, err = pound("gap", "far.yaml")
    assert code == 2
    assert "far.yaml:24:8: no two neighbours share an edge along the street" in err
    Path("near.yaml").write_text(f"{beside}group: [plain, corner, soft]\ncases: {{near: {{link: none}}}}\n")
    code, out, _ = pound("gap", "near.yaml")
    assert code == 0
    assert "corner and soft share no edge along the street, so that they need no gap." in " ".join(out.split())
    assert "plain and corner share an edge along the street, from its low end at -10 m to its" in " ".join(out.split())
