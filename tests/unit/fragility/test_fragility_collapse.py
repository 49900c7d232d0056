"""`collapse` as a limit, and collapsed scenes under the other limits, in rounds and tables alike."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import CensoredData, ecdf, lognorm
from test_fragility_runs import G, solved

from pounding_cli.errors import InputError
from pounding_cli.fragility import fit, of_counts
from pounding_cli.report.answer_page import answer_page
from pounding_cli.report.evidence import points
from pounding_cli.report.fragility_text import asked_of, notes
from tests.helpers.fragility_studies import MOTIONS, STUDY, ductility, known, number_of

FALLS = STUDY.replace(
    "A: {storeys: 3, period: 0.3 s}", "A: {storeys: 3, period: 0.3 s, p_delta: true, hardening: 0}"
).replace("limits: [mu > 4, contact]", "limits: [collapse, mu > 4, mu > 12 in A]")


def collapses(scene, **settings):
    """As `known`; A collapses where its ductility reaches 8, the largest values being those of that moment."""
    return until_collapse(scene, 8.0)


def collapses_early(scene, **settings):
    """A collapses where its ductility reaches 8, under motions 1 and 4 at 5, which is before B passes 4."""
    return until_collapse(scene, 5.0 if number_of(scene) in (1, 4) else 8.0)


def until_collapse(scene, most):
    """As `known`; where the ductility of A passes `most`, A collapses when it is `most`, in storey 1."""
    response = known(scene)
    place = next((n for n, b in enumerate(scene.buildings) if b.name == "A"), -1)
    if place < 0 or (reached := ductility(scene, place)) <= most:
        return response
    motion = replace(scene.motion, acceleration=scene.motion.acceleration * most / reached)
    weaker = known(replace(scene, motion=motion))
    return replace(weaker, status="collapsed", collapse_time=0.05, collapse_building=place, collapse_storey=1)


@pytest.mark.parametrize("method", ["ida", "stripes"])
def test_contact_before_a_collapse_counts(tmp_path, method):
    """The gap closes long before A falls. Fails if a collapse leaves open what happened before it."""
    text = FALLS.replace("fragility:\n", f"fragility:\n  method: {method}\n").replace("[collapse, ", "[contact, ")
    _, results = solved(tmp_path, text, collapses)
    curve = results.table("fragility").set_index("limit").loc["contact"]
    assert (results.scene()["status"] == "collapsed").sum() > 0
    assert (curve["outcome"], curve["failed"], curve["undecided"]) == ("fitted", 0, 0)
    assert curve["median"] / G == pytest.approx(np.exp(np.log(0.1 + 0.01 * np.arange(MOTIONS)).mean()), rel=0.05)


@pytest.mark.parametrize("method", ["ida", "stripes"])
def test_a_building_that_falls(tmp_path, method):
    """A falls at ductility 8, B stands. Fails if a collapsed scene counts as failed, or the collapse of one building as
    that of the other."""
    text = FALLS.replace("fragility:\n", f"fragility:\n  method: {method}\n")
    outcome, results = solved(tmp_path, text, collapses)
    assert outcome.failed == 0
    strength = 0.2 + 0.3 * np.arange(MOTIONS) / (MOTIONS - 1)
    curves = results.table("fragility").set_index(["limit", "building"])
    assert list(curves.index) == [
        ("collapse", "A"), ("collapse", "B"), ("mu > 4", "A"), ("mu > 4", "B"), ("mu > 12 in A", "A"),
    ]  # fmt: skip
    for limit, times in (("collapse", 2.0), ("mu > 4", 1.0), ("mu > 12 in A", 2.0)):
        curve = curves.loc[limit, "A"]
        assert curve["median0"] / G == pytest.approx(times * np.exp(np.log(strength).mean()), rel=0.03)
        assert curve["ratio"] == pytest.approx(0.9, rel=0.02)
        assert (curve["failed"], curve["failed0"]) == (0, 0)
    other = curves.loc["mu > 4", "B"]  # passes at 1.5 times A's strength, before A falls at twice
    assert other["median"] / G == pytest.approx(0.9 * 1.5 * np.exp(np.log(strength).mean()), rel=0.03)
    assert (other["failed"], other["failed0"]) == (0, 0)
    beside = curves.loc["collapse", "B"]  # where A falls first nobody knows whether B would
    assert (beside["outcome"], beside["outcome0"]) == ("undecided", "never passed")
    assert (beside["undecided_motions"], beside["undecided_motions0"]) == (MOTIONS, 0)
    assert (beside["failed"], beside["failed0"], beside["undecided0"]) == (0, 0, 0)
    assert beside["undecided"] == (results.scene()["status"] == "collapsed").sum() > 0
    said = " ".join(notes(asked_of(results), results.table("fragility")))
    assert f"{beside['undecided']:.0f} scenes ended with a collapse before the limit was passed" in said
    assert "scenes failed" not in said


def test_one_building_passes_what_its_collapsed_storey_passes(tmp_path):
    """A falls in storey 1 at ductility 8, and storey 3 has half of that. Fails if the limits of other storeys count as
    passed where storey 1 collapses, or those of storey 1 as open."""
    limits = "[collapse in A, mu > 30 in A, mu > 30 in A storey 1, mu > 30 in A storey 3, mu > 3 in A storey 3]"
    _, results = solved(tmp_path, FALLS.replace("[collapse, mu > 4, mu > 12 in A]", limits), collapses)
    curves = results.table("fragility").set_index("limit")
    falls = curves.loc["collapse in A"]
    for limit in ("mu > 30 in A", "mu > 30 in A storey 1"):
        for name in ("median", "spread", "median0", "spread0", "ratio"):
            assert curves.loc[limit, name] == falls[name]
    open_ = curves.loc["mu > 30 in A storey 3"]
    assert (open_["outcome"], open_["outcome0"]) == ("undecided", "undecided")
    assert np.isnan(open_["ratio"])
    passed = curves.loc["mu > 3 in A storey 3"]  # at ductility 6 of storey 1
    assert passed["median"] == pytest.approx(0.75 * falls["median"], rel=0.05)
    assert (passed["undecided_motions"], passed["undecided_motions0"]) == (0, 0)


def test_undecided_motions_are_censored(tmp_path):
    """B passes at 1.5 times A's strength, and A falls before that under two motions of eight: of them it is known that
    B holds up to there. Median and spread as scipy's of the same brackets. Fails if such motions are left out, or count
    as passing, or as holding at the highest intensity."""
    _, results = solved(tmp_path, FALLS.replace("[collapse, mu > 4, mu > 12 in A]", "mu > 4 in B"), collapses_early)
    (curve,) = results.table("fragility").to_dict("records")
    motions = results.table("fragility_motions").set_index("record")
    strength = 0.2 + 0.3 * np.arange(MOTIONS) / (MOTIONS - 1)
    lost = ["g1", "g4"]
    assert np.isinf(motions.loc[lost, "passed"]).all()
    falls = 0.9 * 1.25 * strength[[1, 4]]  # where the ductility of A is 5
    assert (motions.loc[lost, "held"] / G < falls).all()
    assert (motions.loc[lost, "held"] / G > falls - 0.0201).all()
    assert (motions.loc[lost, "undecided"] > 0).all()
    assert (curve["outcome"], curve["undecided_motions"], curve["undecided_motions0"]) == ("fitted", 2, 0)
    wanted = by_scipy(motions.drop(lost)[["held", "passed"]].to_numpy(), motions.loc[lost, "held"].to_numpy())
    assert (curve["median"], curve["spread"]) == pytest.approx(wanted, rel=1e-3)
    assert curve["ratio"] == pytest.approx(curve["median"] / curve["median0"])
    said = " ".join(notes(asked_of(results), results.table("fragility")))
    assert "holding up to the highest intensity at which it is decided" in said


def test_markers_are_those_of_kaplan_and_meier(tmp_path):
    """Fails if the share of motions that have passed counts those as holding whose scenes a collapse ended before."""
    _, results = solved(tmp_path, FALLS.replace("[collapse, mu > 4, mu > 12 in A]", "mu > 4 in B"), collapses_early)
    motions = results.table("fragility_motions")
    lost = np.isinf(motions["passed"])
    times = np.where(lost, motions["held"], motions["passed"])
    wanted = ecdf(CensoredData(uncensored=times[~lost], right=times[lost])).cdf
    (ax,) = answer_page(results, points(results)[0]).figures["fragility-inelastic"].figure.axes
    (drawn,) = [line for line in ax.lines if line.get_ls() == "None" and line.get_color() != "#777777"]
    x, share = drawn.get_data()
    assert len(x) > 3
    assert share == pytest.approx(wanted.evaluate(np.asarray(x) * G + 1e-9))


def by_scipy(brackets, held):
    """Median and spread of the lognormal distribution of capacities: in brackets, shape (n, 2), or above `held`."""
    spread, _, median = lognorm.fit(CensoredData(interval=brackets, right=held), floc=0)
    return median, spread


def test_undecided_scenes_of_stripes_are_left_out_of_the_counts(tmp_path):
    """Fails if a stripe counts them as trials."""
    text = FALLS.replace("limits: [collapse, mu > 4, mu > 12 in A]", "limits: mu > 4 in B\n  method: stripes")
    _, results = solved(tmp_path, text, collapses_early)
    motions = results.table("fragility_motions")
    undecided, demand = motions["undecided"] == 1, motions["demand"]
    assert demand[undecided].isna().all()
    assert demand[~undecided].notna().all()
    trials, passed = (each.groupby(motions["intensity"]).sum() for each in (~undecided, demand > 1))
    assert 0 < undecided.sum() < len(motions) / 4
    wanted = fit(of_counts(trials.index.to_numpy(), trials.to_numpy(), passed.to_numpy()))
    (curve,) = results.table("fragility").to_dict("records")
    assert (curve["median"], curve["spread"]) == pytest.approx((wanted.median, wanted.spread))
    assert (curve["undecided"], curve["undecided_motions"]) == (undecided.sum(), 2)


@pytest.mark.parametrize(("number", "outcome"), [(3, "fitted"), (4, "undecided")])
def test_half_of_the_motions_undecided_give_no_curve(tmp_path, number, outcome):
    """Fails if a curve is drawn where nobody knows whether half of the motions pass."""

    def early(scene, **settings):
        return until_collapse(scene, 5.0 if number_of(scene) < number else 8.0)

    _, results = solved(tmp_path, FALLS.replace("[collapse, mu > 4, mu > 12 in A]", "mu > 4 in B"), early)
    (curve,) = results.table("fragility").to_dict("records")
    assert (curve["outcome"], curve["undecided_motions"]) == (outcome, number)
    assert np.isnan(curve["ratio"]) == (outcome == "undecided")
    if outcome == "undecided":  # what is known all the same: five of eight hold, and five of eight pass
        motions = results.table("fragility_motions")
        assert curve["low"] == motions["held"].sort_values().iloc[3]
        assert curve["high"] == motions["passed"].sort_values().iloc[4] == np.inf


def test_tables_leave_collapsed_scenes_out(tmp_path):
    """Fails if a peak up to the collapse is taken for that of the motion, or a collapse for a failure."""
    outcome, results = solved(tmp_path, FALLS.replace("fragility:\n", "fragility:\n  method: stripes\n"), collapses)
    scene, storey, summary = results.scene(), results.storey(), results.summary()
    fell = scene["status"] == "collapsed"
    assert 0 < fell.sum() < len(scene)
    assert (scene["collapse_time"].notna() == fell).all()
    assert scene.loc[fell, "collapse_time"].unique() == pytest.approx([0.05])
    place = ["records.scale.pga", "case", "analysis", "record"]
    joined = storey.merge(scene[[*place, "status"]], on=place)
    assert joined.loc[joined["status"] == "collapsed", ["V", "mu", "drift", "V_ratio"]].isna().all().all()
    assert joined.loc[joined["status"] == "done", ["V", "mu", "drift"]].notna().all().all()
    counted = summary.groupby("records.scale.pga")["records_collapsed"].max()
    assert counted.to_numpy() == pytest.approx(fell.groupby(scene["records.scale.pga"]).sum().to_numpy())
    assert (summary["records_used"] + summary["records_collapsed"] <= MOTIONS).all()
    flags = scene["flags"].str.split("\n").explode()
    assert "A alone collapsed: its ratios are left out" in set(flags)
    assert (outcome.failed, results.attrs["scenes_failed"]) == (0, 0)


def test_where_nothing_can_fall(tmp_path):
    """Fails if a curve is sought that can have no pass."""
    stands = FALLS.replace("B: {like: A, ", "B: {like: A, p_delta: false, ").replace("[collapse, ", "[collapse in B, ")
    with pytest.raises(InputError, match="no storey of B can collapse"):
        solved(tmp_path, stands, collapses)
