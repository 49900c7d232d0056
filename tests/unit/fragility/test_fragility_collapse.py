"""`collapse` as a limit, and collapsed scenes under the other limits, in rounds and tables alike."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from test_fragility_runs import G, solved

from pounding_cli.errors import InputError
from pounding_cli.report.fragility_text import asked_of, notes
from tests.helpers.fragility_studies import MOTIONS, STUDY, ductility, known

FALLS = STUDY.replace(
    "A: {storeys: 3, period: 0.3 s}", "A: {storeys: 3, period: 0.3 s, p_delta: true, hardening: 0}"
).replace("limits: [mu > 4, contact]", "limits: [collapse, mu > 4, mu > 12 in A]")


def collapses(scene, **settings):
    """As `known`; A collapses where its ductility passes 8."""
    response = known(scene)
    place = next((n for n, b in enumerate(scene.buildings) if b.name == "A"), -1)
    if place < 0 or ductility(scene, place) <= 8:
        return response
    return replace(response, status="collapsed", collapse_time=0.05, collapse_building=place, collapse_storey=1)


def test_a_collapse_leaves_contact_undecided(tmp_path):
    """Fails if a collapse counts as a failed scene, as a contact, or as none."""
    text = FALLS.replace("fragility:\n", "fragility:\n  method: stripes\n").replace("[collapse, ", "[contact, ")
    _, results = solved(tmp_path, text, collapses)
    curve = results.table("fragility").set_index("limit").loc["contact"]
    fell = results.scene()["status"] == "collapsed"
    assert (curve["failed"], curve["undecided"]) == (0, fell.sum())
    motions = results.table("fragility_motions")
    assert motions[motions["limit"] == "contact"]["demand"].isna().sum() == fell.sum() > 0


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
    assert curves.loc["collapse", "B"]["outcome"] == curves.loc["collapse", "B"]["outcome0"] == "never passed"
    beside = curves.loc["collapse", "B"]  # where A falls first nobody knows whether B would
    assert (beside["failed"], beside["failed0"], beside["undecided0"]) == (0, 0, 0)
    assert beside["undecided"] == (results.scene()["status"] == "collapsed").sum() > 0
    said = " ".join(notes(asked_of(results), results.table("fragility")))
    assert f"{beside['undecided']:.0f} scenes ended with a collapse before the limit was decided" in said
    assert "scenes failed" not in said


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
