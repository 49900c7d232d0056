"""The answer at the head of the page: the cases side by side."""

from __future__ import annotations

import numpy as np
import pytest

from pounding_cli.laws.connector import Connector
from pounding_cli.numbers import Unit
from pounding_cli.records import GRAVITY
from pounding_cli.report.evidence import points
from pounding_cli.report.web import story
from pounding_cli.report.web.answer import answer
from tests.helpers.report_tables import LEVEL, MOTIONS, PERIODS, PUSH, make


def test_every_case_has_the_largest_means_with_their_place():
    results = make(cases=("touching", "connected"))
    results.floor().loc[results.floor()["floor"] == 4, "acceleration"] *= 1.5
    found = answer(points(results)[0])
    assert found.groups == [("stiff", 4), ("soft", 4)]
    assert found.heads[:4] == [("V/V₀", "elastic"), ("a", "elastic"), ("μ/μ₀", "inelastic"), ("a", "inelastic")]
    shear, acceleration, ductility, _ = found.rows[0].cells[:4]
    ratio = LEVEL["touching"] * np.mean(MOTIONS) * 1.04
    assert (shear.number, shear.where, shear.tone) == (story.digits(ratio, 3), "storey 5", "above")
    peak = 1.5 * 5.0 * PUSH["touching"] / GRAVITY
    assert acceleration.number == f"{story.digits(peak, 3)} g"
    assert acceleration.where == f"floor 4, {story.digits(PUSH['touching'], 3)}×"
    mu = 1.2 * ratio
    assert (ductility.number, ductility.where) == (story.digits(mu, 3), "storey 5")
    assert found.rows[0].cells[4].tone == "below"  # the soft building, V/V0 1 / 1.4


def test_closing_is_that_of_the_link_that_comes_closest_to_its_gap():
    results = make(cases=("touching", "gap", "connected"))
    link = results.link()
    gap = link["case"] == "gap"
    wide, narrow = gap & (link["floor"] == 2), gap & (link["floor"] == 3)
    link.loc[wide, ["gap", "max_closing"]] = [0.5, 0.3]
    link.loc[narrow & (link["record"] == "taft"), ["gap", "max_closing"]] = [0.05, 0.0612]
    link.loc[gap & (link["record"] != "taft"), "impacts"] = 0
    cells = {row.case: row.cells[-1] for row in answer(points(results)[0]).rows}
    assert (cells["gap"].number, cells["gap"].where) == ("61.2 / 50 mm", "contact: 2 of 10 runs")
    results.units = {"gap": Unit("cm", 0.01, "m")}
    assert answer(points(results)[0]).rows[1].cells[-1].number == "6.12 / 5 cm"
    assert cells["touching"].where == "contact: 10 of 10 runs"
    assert cells["connected"].where == "connector"
    link.loc[gap, "impacts"] = 0
    assert answer(points(results)[0]).rows[1].cells[-1].where == "no contact"


def test_a_case_whose_connector_strikes_is_marked_with_its_scenes():
    results = make(cases=("touching", "connected"))
    scene = results.scene()
    here = (scene["case"] == "connected") & (scene["analysis"] == "elastic") & (scene["record"] == "taft")
    scene.loc[here, "flags"] = f"{Connector.beyond_gap}: stiff | soft, floor 3, by 2 mm"
    scene.loc[scene["case"] == "touching", "flags"] = "ill-conditioned: sensitivity 300"
    scene.loc[2, "status"] = "event bound reached"
    touching, connected = answer(points(results)[0]).rows
    assert (touching.meaningless, connected.meaningless) == (False, True)
    assert connected.flags == [f"{Connector.beyond_gap}: elastic, 1 of 5 runs (taft)"]
    assert touching.flags[0] == "1 of 10 runs failed and are left out of the means"
    assert touching.flags[1] == "ill-conditioned: elastic, 5 of 5 runs"


def test_of_many_buildings_the_largest_is_shown_by_name(monkeypatch):
    names = ("stiff", "soft", "soft-1", "soft-2", "far")
    monkeypatch.setitem(PERIODS, "far", 0.6)
    results = make(names, ("touching",), v_ratio=lambda _, building, storey, __: 1.0 + storey * (building == "far"))
    found = answer(points(results)[0])
    assert found.groups == [("largest of the 5 buildings", 4)]
    assert found.rows[0].cells[0].where == "far, storey 5"
    assert found.rows[0].cells[0].number == "6.00"


@pytest.mark.parametrize(("analysis", "heads"), [("elastic", ["V/V₀", "a"]), ("inelastic", ["V/V₀", "μ/μ₀", "a"])])
def test_columns_follow_the_analyses(analysis, heads):
    results = make(cases=("touching",))
    for name in ("storey", "floor", "link", "scene"):
        frame = results._frames[name]
        results._frames[name] = frame[frame["analysis"] == analysis].reset_index(drop=True)
    assert [label for label, _ in answer(points(results)[0]).heads[: len(heads)]] == heads
