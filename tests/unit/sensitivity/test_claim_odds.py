"""`claims:` of `pound sensitivity`: the paper's statements over uncertain keys, on scenes whose numbers are known."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import binomtest

from pounding_cli.batch import run_plan
from pounding_cli.errors import InputError
from pounding_cli.report.claim_samples import ODDS, THRESHOLDS, VERDICTS
from pounding_cli.report.claims import CLAIMS, judge
from pounding_cli.report.evidence import points
from pounding_cli.solve.response import BuildingResponse, LinkResponse, Response
from pounding_cli.store import open_results
from pounding_cli.store.codec import failed
from pounding_cli.study import claim_names, load_study
from pounding_cli.study.expand import expand
from pounding_cli.study.sensitivity import expand_sensitivity, question_of
from tests.helpers.sensitivity_studies import write_study

STUDY = """\
title: Two small buildings
claims: fig6
records: {use: [g*.txt], scale: 1}
buildings:
  stiff: {storeys: 1, period: 0.3 s, mass: 100 t}
  soft: {like: stiff, period: 0.5 s}
group: [stiff, soft]
cases:
  touching: {link: pounding, gap: 0 cm}
  connected: {link: connector, gap: 5 cm, stiffness: 1e7 N/m}
estimate: none
uncertain:
  buildings.soft.mass: {uniform: {from: 100 t, to: 200 t}}
  impact.restitution: {uniform: {from: 0.4, to: 0.6}}
sensitivity: {claims: [connection-other, connection-always], samples: 16}
"""


def known(scene, accuracy=1e-6, method="taylor", **_):
    """Connected, the soft building has 0.8 + x of its shear alone, where x runs from 0 to 0.5 with its mass; times
    1.2 for motions of more than 2 m/s2. The stiff one has 1.5 of its own."""
    parts = []
    for building in scene.buildings:
        value = 1.0
        if len(scene.buildings) > 1 and building.name == "soft":
            value = (0.8 + (building.mass[0] - 1e5) / 2e5) * (1.2 if scene.motion.pga > 2 else 1.0)
        elif len(scene.buildings) > 1:
            value = 1.5
        one = np.full(1, value)
        parts.append(BuildingResponse(one, one, one, one, one, -one, 0 * one))
    number = np.full(len(scene.links), 0.01)
    links = LinkResponse(number, number, number, number, number)
    return Response(tuple(parts), links, "done", "", "taylor", accuracy, 1, 0, 1e-6)


def solved(folder, text=STUDY, solve=known, motions=1):
    plan = expand_sensitivity(load_study(write_study(folder, text, motions)))
    outcome = run_plan(plan, folder / "r.h5", solve=solve, engine_name="serial", replace=True)
    return outcome, open_results(folder / "r.h5")


def test_every_name_has_one_claim_that_is_judged():
    assert [claim.key for claim in CLAIMS] == list(claim_names.CLAIMS)


def test_a_probability_is_that_of_the_key_which_decides(tmp_path):
    """The soft building is relieved below a mass of 140 t, in 2 of 5 samples; nothing else matters."""
    _, results = solved(tmp_path)
    rows = results.table(ODDS).set_index("claim")
    assert list(rows.index) == ["connection-other", "connection-always"]
    for claim in rows.index:
        row = rows.loc[claim]
        assert row["samples"] == 32
        assert row["holds"] == pytest.approx(0.4, abs=0.04)  # quasi-random samples are nearer than chance
        exact = binomtest(round(row["holds"] * 32), 32).proportion_ci(0.95)
        assert (row["holds_low"], row["holds_high"]) == pytest.approx((exact.low, exact.high))
        assert row["holds"] + row["partly"] + row["fails"] == pytest.approx(1)
        assert (row["decided_by"], row["failed"]) == ("buildings.soft.mass", 0)
        assert row["share_low"] < 1 < row["share_high"]
    numbers = results.table(THRESHOLDS)
    mine = numbers[numbers["number"].str.startswith("V/V0, elastic: mean over the storeys of soft")].iloc[0]
    assert mine["met"] == pytest.approx(0.4, abs=0.04)
    assert mine["percentile_50"] == pytest.approx(1.05, abs=0.04)
    assert (mine["percentile_5"], mine["percentile_95"]) == pytest.approx((0.825, 1.275), abs=0.04)
    indices = results.table("sensitivity")
    assert set(indices["output"]) == {"claim connection-other", "claim connection-always"}
    assert set(indices["case"]) == {""}
    free = indices[indices["key"] == "impact.restitution"]
    assert free["total"].to_numpy() == pytest.approx(0.0, abs=1e-12)


def test_verdicts_of_a_sample_are_those_of_the_report(tmp_path):
    """A sample's verdict is what `pound report` says of a study with these values. Fails if a sample is judged by
    another one's scenes, or by other means."""
    text = STUDY.replace("[connection-other, connection-always]", "all").replace("samples: 16", "samples: 4")
    _, results = solved(tmp_path, text, motions=3)
    samples = results.table(VERDICTS)
    for row in samples.to_dict("records")[:3]:
        plain = text[: text.index("uncertain:")]
        plain = plain.replace("period: 0.5 s", f"period: 0.5 s, mass: {row['buildings.soft.mass']!r} kg")
        plan = expand(load_study(write_study(tmp_path, plain, 3)))
        run_plan(plan, tmp_path / "one.h5", solve=known, engine_name="serial", replace=True)
        judged = {j.claim.key: str(j.verdict) for j in judge(points(open_results(tmp_path / "one.h5"))[0])}
        assert {key: row[f"claim {key}"] for key in judged} == judged
    assert results.table(ODDS)["samples"].min() == 0  # there is no infill to be tested


def test_a_bootstrap_draws_the_motions_of_every_sample_anew(tmp_path):
    """Of three motions the third raises the soft building by 1.2. Drawn k times of 3, the mean is 1 + 0.2 k / 3 of
    that, and the building is relieved below a mass that follows from k."""
    text = STUDY.replace("uncertain:\n", "uncertain:\n  motion: bootstrap\n").replace("samples: 16", "samples: 64")
    _, results = solved(tmp_path, text, motions=3)
    row = results.table(ODDS).set_index("claim").loc["connection-other"]
    drawn = question_of(load_study(tmp_path / "ishigami.yaml")).drawn
    assert drawn.shape == (64, 3)
    wanted = np.mean([2 * (1 / (1 + 0.2 * k / 3) - 0.8) for k in (drawn == 2).sum(axis=1)])
    assert row["holds"] == pytest.approx(wanted, abs=0.04)
    samples = results.table(VERDICTS)
    assert samples["motion"].nunique() == len(np.unique(drawn, axis=0))
    assert set(samples[samples["motion"] == "g1 + g2 + g3"]["claim connection-other"]) >= {"holds"}
    indices = results.table("sensitivity").set_index(["output", "key"])
    assert indices.loc[("claim connection-other", "motion"), "total"] > 0.02
    for _, each in samples.iterrows():
        drawn = {name: int(count or 1) for count, _, name in (w.rpartition(" ") for w in each["motion"].split(" + "))}
        ratio = 0.3 + each["buildings.soft.mass"] / 2e5
        holds = ratio * (1 + 0.2 * drawn.get("g3", 0) / 3) < 1
        assert (each["claim connection-other"] == "holds") == holds


def test_outputs_rest_on_the_motions_that_a_bootstrap_drew(tmp_path):
    text = STUDY.replace("uncertain:\n", "uncertain:\n  motion: bootstrap\n")
    text = text.replace("claims: [connection-other, connection-always]", "outputs: [V_ratio in soft]")
    _, results = solved(tmp_path, text, motions=3)
    samples = results.table("sensitivity_samples")
    mine = samples[(samples["case"] == "connected") & (samples["analysis"] == "elastic")]
    counts = mine["motion"].map(
        lambda said: sum(int(w.split(" ")[0]) if " " in w else 1 for w in said.split(" + ") if w.endswith("g3"))
    )
    wanted = (0.3 + mine["buildings.soft.mass"] / 2e5) * (1 + 0.2 * counts / 3)
    assert mine["output V_ratio in soft"].to_numpy() == pytest.approx(wanted.to_numpy())
    assert counts.nunique() == 4


def test_a_sample_with_a_failed_scene_has_no_verdict_and_the_index_is_refused(tmp_path):
    def fails(scene, accuracy=1e-6, **more):
        if scene.links and scene.buildings[1].mass[0] > 1.9e5:
            return failed([1, 1], len(scene.links), "event bound reached", "write more", "taylor", accuracy, np.nan)
        return known(scene, accuracy)

    outcome, results = solved(tmp_path, solve=fails)
    assert outcome.failed > 0
    row = results.table(ODDS).iloc[0]
    assert row["failed"] == (results.table(VERDICTS)["claim connection-other"] == "").sum() > 0
    assert row["samples"] < 32
    assert row["decided_by"] == ""
    assert results.table("sensitivity")["outcome"].str.startswith("refused: ").all()


def test_keys_of_one_entry_move_together(tmp_path):
    together = """\
uncertain:
  - buildings.soft.mass: {uniform: {from: 100 t, to: 200 t}}
    buildings.stiff.hardening: {uniform: {from: 0, to: 0.5}}
  - impact.restitution: {choice: [0.4, 0.5]}
    impact.stiffness: {choice: [1e8 N/m, 1e9 N/m]}
"""
    text = STUDY[: STUDY.index("uncertain:")] + together + STUDY[STUDY.index("sensitivity:") :]
    study = load_study(write_study(tmp_path, text))
    assert [len(factor.members) for factor in question_of(study).factors] == [2, 2]
    _, results = solved(tmp_path, text)
    samples = results.table(VERDICTS)
    share = samples["buildings.soft.mass"] / 1e5 - 1
    assert samples["buildings.stiff.hardening"].to_numpy() == pytest.approx(share.to_numpy() / 2)
    pairs = set(zip(samples["impact.restitution"], samples["impact.stiffness"], strict=True))
    assert pairs == {("0.4", "1e8 N/m"), ("0.5", "1e9 N/m")}
    assert set(results.table("sensitivity")["key"]) == {"buildings.soft.mass", "impact.restitution"}


MASS = "buildings.soft.mass: {uniform: {from: 100 t, to: 200 t}}"
RESTITUTION = "impact.restitution: {uniform: {from: 0.4, to: 0.6}}"
NAMES = "[connection-other, connection-always]"


@pytest.mark.parametrize(
    ("old", "new", "line", "column", "said", "hint"),
    [
        (NAMES, "[connection-othr]", 15, 24, "'connection-othr' is not a claim", "did you mean 'connection-other'"),
        (NAMES, "code-gap", 15, 23, "not a claim about fig6", "known: infill-response"),
        (NAMES, "[separation, separation]", 15, 36, "occurs twice", "remove one"),
        ("claims: fig6\n", "", 14, 15, "names no figure whose claims", "claims: fig6"),
        (f"  {MASS}\n  {RESTITUTION}", "  - motion: bootstrap\n    " + MASS, 14, 5, "moves by itself", "of its own"),
        (
            f"  {MASS}\n  {RESTITUTION}", f"  - {MASS}\n    impact.restitution: {{choice: [0.4, 0.5]}}", 14, 5,
            "as many options each", "as many of each",
        ),
        (f"  {MASS}\n  {RESTITUTION}", f"  - {MASS}\n  - {MASS}", 14, 5, "is also in line 13", "remove one"),
        (RESTITUTION, "motion: all", 14, 11, "'all' is not known", "motion: bootstrap"),
    ],
)  # fmt: skip
def test_a_bad_question(tmp_path, old, new, line, column, said, hint):
    assert old in STUDY
    path = write_study(tmp_path, STUDY.replace(old, new), motions=2)
    with pytest.raises(InputError) as error:
        expand_sensitivity(load_study(path))
    problem = error.value.problems[0]
    assert said in problem.message
    assert hint in problem.hint
    assert (problem.line, problem.column) == (line, column)
