"""A neighbour that is only seen: what `pound check` lists, and how gaps, curves and indices answer with it."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.stats import norm

import pounding_cli
from pounding_cli.questions import load_question
from pounding_cli.questions.gap.figures import list_figures
from pounding_cli.questions.gap.neighbours import Closings

STUDY = """\
title: A house and what stands beside it
records: {use: [elcentro, taft, parkfield], duration: 3 s, scale: {pga: 0.3 g}}
buildings:
  ours: {storeys: 2, period: 0.25 s, height: 3.66 m}
  theirs: {archetype: {type: W2, design: low-code, storeys: 2, neighbours: 4}, mass: 100 t}
group: [ours, theirs]
cases: {near: {link: pounding, gap: 20 mm}, wide: {link: pounding, gap: 35 mm}}
analyses: [inelastic]
estimate: none
fragility: {limits: [contact, slight damage], method: stripes, draws: 100}
sensitivity: {outputs: [largest drift in ours], samples: 4}
"""


@pytest.fixture(scope="module")
def gap(tmp_path_factory):
    folder = tmp_path_factory.mktemp("seen")
    (folder / "seen.yaml").write_text(STUDY)
    return pounding_cli.run(folder / "seen.yaml", folder / "seen-gap.h5", workflow="gap", engine="serial")


def test_check_lists_every_number_with_its_source(pound):
    Path("two.yaml").write_text(STUDY.replace("mass: 100 t", "damping: 6 %").split("fragility")[0])
    code, out, _ = pound("check", "two.yaml")
    assert code == 0
    lines = {line.split("  ")[1].strip(): line for line in out.splitlines() if line.startswith("  ")}
    assert "seen       theirs: W2, wood, commercial and industrial" in out
    assert re.search(r"0\.4000 s +0\.24 +0\.2000 s a storey; Table 5\.5.*β: assumed here", lines["period"])
    assert re.search(r"0\.0947 +0\.25 +Cs 0\.05, .*Tables 5\.4.*; β: HAZUS of 1999", lines["base shear V/W"])
    assert "Ay 0.1 g" in lines["base shear V/W"]
    assert re.search(r"6\.00 % +given in the study; of the type: 10 %", lines["damping"])
    assert "Table 5.1" in lines["storey height"]
    assert "HAZUS has none: write `mass`" in lines["floor mass"]
    assert re.search(r"3\.06 % +0\.40 +Table 5\.9; β: Hazus 5\.1", lines["drift, extensive"])
    assert "draw 4, `pound sensitivity` varies them" in out


def test_gaps_are_judged_over_neighbours_and_motions(gap):
    """Against numpy, from the closings of all runs. Fails if the median building counts as one that is drawn."""
    sample = "buildings.theirs.archetype.sample"
    link = gap.link()
    drawn = link[link[sample] > 0]
    closings = drawn.pivot_table("max_closing", sample, "record", "max").to_numpy()
    assert closings.shape == (4, 3)
    (row,) = gap.table("gap_neighbours").to_dict("records")
    assert (row["neighbours"], row["motions"], row["failed"]) == (4, 3, 0)
    values = np.sort(closings.ravel())
    assert row["enough_50"] == values[5]
    assert row["enough_84"] == values[10]
    assert row["enough_95"] == values[11]
    logs = np.log(closings)
    assert row["spread"] == pytest.approx(logs.std(), rel=1e-9)
    assert row["spread_neighbours"] == pytest.approx(logs.mean(axis=1).std(), rel=1e-9)
    assert row["spread_motions"] ** 2 + row["spread_neighbours"] ** 2 == pytest.approx(logs.var(), rel=1e-9)
    cases = gap.table("gap_neighbour_cases").set_index("case")
    for case, width in (("near", 0.02), ("wide", 0.035)):
        assert cases.loc[case, "gap"] == width
        assert cases.loc[case, "enough"] == pytest.approx((closings <= width).mean(), rel=1e-12)
    assert 0 < cases.loc["near", "enough"] < 1


def test_other_tables_are_of_the_median_building(gap):
    """As those of a study that takes the neighbour as certain."""
    folder = gap.path.parent
    (folder / "certain.yaml").write_text(STUDY.replace("neighbours: 4", "uncertain: false"))
    certain = pounding_cli.run(folder / "certain.yaml", folder / "certain.h5", workflow="gap", engine="serial")
    assert "gap_neighbours" not in certain.answers
    for name in ("gap", "gap_cases", "property_line"):
        pd.testing.assert_frame_equal(gap.table(name), certain.table(name))


def test_the_page_draws_how_likely_a_gap_is_enough(gap):
    """The curve of drawn neighbours has a step for every run, at its largest closing; the other for the median one."""
    figure = list_figures(gap)[0].draw()
    (ax,) = [each for each in figure.axes if each.get_title(loc="left")]
    median, drawn = ax.get_lines()[:2]
    link = gap.link()
    sample = "buildings.theirs.archetype.sample"
    largest = link.groupby([sample, "record"])["max_closing"].max()
    is_median = largest.index.get_level_values(0) == 0
    for line, part in ((median, largest[is_median]), (drawn, largest[~is_median])):
        widths = np.sort(part.to_numpy()) * 1e3
        assert np.asarray(line.get_xdata()) == pytest.approx([0.0, *widths], rel=1e-9)
        assert np.asarray(line.get_ydata())[-1] == 1.0
    assert {line.get_xdata()[0] for line in ax.get_lines()[2:]} == {20.0, 35.0}


def test_rates_are_over_neighbours_and_motions(tmp_path):
    """The rate at the gap that is told, with the scatter of all drawn neighbours and motions at each intensity."""
    rated = STUDY + "gap: {hazard: {k0: 1e-3, k: 2}, rate: 1/100}\nsweep: {records.scale.pga: [0.15 g, 0.3 g, 0.6 g]}\n"
    (tmp_path / "rate.yaml").write_text(rated)
    results = pounding_cli.run(tmp_path / "rate.yaml", tmp_path / "rate.h5", workflow="gap", engine="serial")
    (row,) = results.table("gap_rate").to_dict("records")
    link = results.link()
    drawn = link[link["buildings.theirs.archetype.sample"] > 0]
    runs = ["records.scale.pga", "buildings.theirs.archetype.sample", "record"]
    logs = np.log(drawn.groupby(runs)["max_closing"].max())
    means, spreads = (getattr(logs.groupby(level=0), name)() for name in ("mean", "std"))
    intensity = np.geomspace(1e-5, 1e3, 400_001)  # in g
    score = (means.to_numpy() - np.log(row["gap"])) / spreads.to_numpy()
    levels = np.log(means.index.to_numpy() / 9.80665)
    x = np.log(intensity)
    slopes = np.diff(score) / np.diff(levels)
    low = score[0] + (x - levels[0]) / spreads.to_numpy()[0]
    high = score[-1] + (x - levels[-1]) * slopes[-1]
    line = np.where(x < levels[0], low, np.where(x > levels[-1], high, np.interp(x, levels, score)))
    exceeded = 1e-3 * intensity**-2.0
    rate = -np.sum(norm.cdf(line[:-1]) * np.diff(exceeded))
    assert rate == pytest.approx(0.01, rel=2e-3)
    rates = results.table("gap_neighbour_cases").groupby("case")["rate"]
    assert (rates.max() == rates.min()).all()  # the same at every intensity
    assert rates.first()["near"] > rates.first()["wide"] > 0


def test_the_answer_comes_first_and_says_of_which_building(pound):
    Path("two.yaml").write_text(STUDY)
    code, out, _ = pound("gap", "two.yaml")
    assert code == 0
    text = re.sub(r"\s+", " ", out)
    first = text.partition("A house and what stands beside it ")[2]
    over = "Over 4 buildings that theirs (W2, low-code, 2 storeys) may be and over 3 motions: 20 mm (near)"
    assert first.startswith(over)
    assert re.search(r"is enough with a probability of 0\.\d+ as yielding buildings; 35 mm \(wide\)", text)
    assert "At the median building theirs: " in text
    assert "which `pound run` simulates" in text
    _, out, _ = pound("run", "two.yaml")
    assert "theirs (W2, low-code, 2 storeys) is the median building of what it may be" in re.sub(r"\s+", " ", out)


def test_two_neighbours_are_told_as_two(pound):
    """And a study without a hazard curve has no rates to speak of."""
    Path("seen.yaml").write_text(
        STUDY.replace("  ours:", "  ours: {archetype: {type: W2, design: low-code, storeys: 2, neighbours: 4}}\n  was:")
    )
    code, out, _ = pound("gap", "seen.yaml")
    assert code == 0
    text = re.sub(r"\s+", " ", out)
    assert "Over 4 buildings that ours (W2, low-code, 2 storeys) and theirs (W2, low-code, 2 storeys) may be" in text
    assert "over both buildings, " in text
    assert "At the median buildings ours and theirs: " in text
    assert "All other numbers but the first ones are of the median buildings" in text
    _, out, _ = pound("run", "seen.yaml")
    assert "are the median buildings of what they may be" in re.sub(r"\s+", " ", out)


def test_a_swept_type_is_told_as_it_is_there(pound):
    """Fails where the type that the study writes is told of a point with another one."""
    text = STUDY.replace("height: 3.66 m", "height: 3.05 m").replace("type: W2", "type: RM1L")
    Path("seen.yaml").write_text(text + "sweep: {buildings.theirs.archetype.type: [C1L, C3L]}\n")
    code, out, _ = pound("gap", "seen.yaml")
    assert code == 0
    told = re.findall(r"archetype\.type = (\w+), over 4 buildings that theirs \((\w+), low-code", " ".join(out.split()))
    assert told
    assert all(here == named for here, named in told)
    _, out, _ = pound("run", "seen.yaml")
    assert "theirs (low-code, 2 storeys) is the median building" in " ".join(out.split())


def test_check_lists_the_first_point_of_a_sweep_and_warns_along_it(pound):
    text = STUDY.replace("type: W2", "type: C1L").replace("height: 3.66 m", "height: 3.05 m").split("fragility")[0]
    Path("two.yaml").write_text(text + "sweep: {buildings.theirs.archetype.storeys: [1, 3, 5]}\n")
    code, out, err = pound("check", "two.yaml")
    assert code == 0
    assert "low-code, 1 storey (Hazus" in out
    assert "at the first value of buildings.theirs.archetype.storeys" in out
    assert re.search(r"period +0\.2000 s", out)
    assert "two.yaml:10:52: [archetype] theirs has 5 storeys, but C1L of HAZUS is of 1 to 3 storeys" in err


def test_what_sensitivity_does_not_vary_of_a_swept_neighbour_is_told(pound):
    study = STUDY.replace("height: 3.66 m", "height: 3.05 m").replace("type: W2", "type: C3L")
    sweep = "sweep: {buildings.theirs.archetype.storeys: [1, 2]}\n"
    Path("two.yaml").write_text(study + sweep)
    code, _, err = pound("sensitivity", "two.yaml")
    assert code == 2
    assert "nothing of theirs is varied, as `archetype` is swept there" in err
    uncertain = (
        "uncertain: {impact.restitution: {uniform: {from: 0.4, to: 0.6}}, cases.near.gap: {choice: [1 cm, 2 cm]}}\n"
    )
    Path("two.yaml").write_text(study + sweep + uncertain)
    code, out, _ = pound("sensitivity", "two.yaml")
    assert code == 0
    assert "Nothing of theirs is varied, as `archetype` is swept there." in " ".join(out.split())


def test_ends_of_what_nobody_wrote_are_not_doubted(pound):
    """A damping of 42 % is 10 % times what nearly nobody exceeds."""
    study = STUDY.replace("height: 3.66 m", "height: 3.05 m").replace("type: W2", "type: C3L").split("fragility")[0]
    Path("two.yaml").write_text(study + "uncertain: {impact.restitution: {uniform: {from: 0.4, to: 0.6}}}\n")
    code, _, err = pound("check", "two.yaml")
    assert (code, err) == (0, "")
    written = study.replace("{storeys: 2, period: 0.25 s, ", "{storeys: 2, period: 0.25 s, damping: 5 %, ")
    Path("two.yaml").write_text(written + "uncertain: {buildings.ours.damping: {uniform: {from: 2 %, to: 45 %}}}\n")
    assert "damping ratio is 45 %" in pound("check", "two.yaml")[2]


def test_bootstrap_draws_neighbours_and_motions():
    """The interval of a probability covers that of many tables of both as often as it says, nearly."""
    random = np.random.default_rng(5)
    inside = []
    for _ in range(150):
        neighbours, motions = random.normal(0, 0.5, (12, 1)), random.normal(0, 0.5, (1, 12))
        closings = np.exp(neighbours + motions + random.normal(0, 0.1, (12, 12)))
        row = Closings.of(closings).find_probability(closings <= 1.5)
        true = 0.7143  # Phi(ln 1.5 / sqrt(0.51))
        inside.append(row["enough_low"] <= true <= row["enough_high"])
    assert 0.75 < np.mean(inside) <= 1.0


def test_curves_are_wider_over_what_the_neighbour_may_be(pound):
    sweep = "sweep: {records.scale.pga: {from: 0.08 g, to: 0.52 g, count: 12}}\n"
    Path("two.yaml").write_text(STUDY.replace(", wide: {link: pounding, gap: 35 mm}", "") + sweep)
    code, out, _ = pound("fragility", "two.yaml")
    assert code == 0
    results = pounding_cli.open_results("results/two-fragility.h5")
    rows = results.table("fragility_neighbours").set_index(["case", "limit", "state"])
    curves = results.table("fragility").set_index(["case", "limit", "state"])
    assert (curves["motions"] == 3).all()
    assert (rows["neighbours"] == 4).all()
    for place, row in rows.iterrows():
        if np.isfinite(row["widening"]):
            added = row["spread"] ** 2 - row["spread_of_median"] ** 2
            assert row["widening"] ** 2 == pytest.approx(max(added, 0.0), rel=1e-9)
        assert (row["spread"] == curves.loc[place, "spread"]) or np.isnan(row["spread"])
        assert np.isfinite([row["spread"], row["median"]]).all() == (curves.loc[place, "outcome"] == "fitted")
    assert "motions less than a step of the intensities" in re.sub(r"\s+", " ", out)
    assert rows["widening"].max() > 0
    # all of the 4 x 3 motions, with the drift capacity of each building, and by itself
    damage = results.table("fragility_motions").query("limit == 'slight damage' and state == 'alone'")
    assert len(damage) == 4 * 3 * 12
    drift = results.storey().query("building == 'theirs'")
    sample = "buildings.theirs.archetype.sample"
    alone = drift.groupby([sample, "record", "records.scale.pga"])["drift0"].max()
    places = pd.MultiIndex.from_product([range(1, 5), results.names("record"), results.axes["records.scale.pga"]])
    ratios = alone.reindex(places).to_numpy() / damage["demand"].to_numpy()
    by_building = ratios.reshape(4, -1)
    assert by_building.std(axis=1) == pytest.approx(np.zeros(4), abs=1e-9)
    assert np.log(by_building[:, 0] / (0.004 * 3.66)).std() == pytest.approx(0.40, rel=1e-6)
    assert "Curves are over 4 buildings that theirs (W2, low-code, 2 storeys) may be, and over 3 motions." in out


@pytest.mark.parametrize(("old", "new", "varied"), [
    ("mass: 100 t", "mass: 100 t", {"period", "yield.base_shear", "damping"}),
    ("mass: 100 t", "period: 0.4 s", {"yield.base_shear", "damping"}),
    ("neighbours: 4", "uncertain: false", set()),
    ("neighbours: 4", "neighbours: 4, sample: 2", set()),
    ("estimate: none", "sweep: {buildings.theirs.period: [0.3 s, 0.5 s]}", {"yield.base_shear", "damping"}),
])  # fmt: skip
def test_what_is_uncertain_of_it_is_varied(tmp_path, old, new, varied):
    """`pound sensitivity` varies what the study leaves to the type, beside what `uncertain:` names."""
    uncertain = "uncertain: [{impact.restitution: {uniform: {from: 0.4, to: 0.6}}}, {motion: any}]\n"
    (tmp_path / "two.yaml").write_text(STUDY.replace(old, new) + uncertain)
    question = load_question("sensitivity").ask(pounding_cli.load_study(tmp_path / "two.yaml"))
    keys = [each.key for each in question.inputs]
    assert keys[:2] == ["impact.restitution", "motion"]
    assert set(keys[2:]) == {f"buildings.theirs.{key}" for key in varied}
