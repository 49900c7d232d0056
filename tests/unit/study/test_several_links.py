"""Several links between the same floors: a list in the study, its refusals, and their rows in tables."""

from __future__ import annotations

import numpy as np
import pytest

from pounding_cli.model.links import link_label, link_places
from pounding_cli.report.citations import citations
from pounding_cli.report.evidence import by_floor
from pounding_cli.study import expand

GAP = "gap: {link: pounding, gap: 5 cm}"
SPRING = "{link: connector, stiffness: 20 kN/mm}"


def links(study):
    return next(scene.links for scene in expand(study).scenes.values() if scene.links)


def shown(study):
    return [(link.left_floor, link.kind, link.gap) for link in links(study)]


def test_a_list_stands_on_every_floor(study):
    """Floor by floor, in the order of the list; the gap is that of the case. Fails if one of the list is left out."""
    found = shown(study((GAP, f"gap: {{gap: 5 cm, link: [pounding, {SPRING}]}}")))
    assert found == [(floor, kind, 0.05) for floor in (1, 2, 3) for kind in ("pounding", "connector")]


def test_an_entry_picks_its_floors(study):
    case = "gap: {gap: 5 cm, link: [pounding, {link: connector, floors: [2], gap: 1 cm, damping_ratio: 0.4}]}"
    read = study((GAP, case))
    assert shown(read) == [
        (1, "pounding", 0.05), (2, "pounding", 0.05), (2, "connector", 0.01), (3, "pounding", 0.05)
    ]  # fmt: skip
    assert [link.law.damping_ratio for link in links(read) if link.kind == "connector"] == [0.4]


def test_a_list_on_some_floors_and_another_link_elsewhere(study):
    case = f"gap: {{gap: 5 cm, floors: [3], link: [pounding, {SPRING}], elsewhere: pounding}}"
    assert [kind for _, kind, _ in shown(study((GAP, case)))] == ["pounding", "pounding", "pounding", "connector"]


def test_what_is_said_of_a_floor_holds_for_all_its_links(study):
    """by_floor is nearer than the entry of a list. Fails if the case's gap stays."""
    case = f"gap: {{gap: 5 cm, link: [pounding, {SPRING}], by_floor: {{3: {{gap: 2 cm}}}}}}"
    assert [gap for *_, gap in shown(study((GAP, case)))] == [0.05] * 4 + [0.02] * 2


def test_an_entry_of_the_list_is_swept(study):
    case = f"gap: {{gap: 5 cm, link: [pounding, {SPRING}]}}"
    sweep = "analyses: [elastic]\nsweep: {cases.gap.link.1.stiffness: [10 kN/mm, 30 kN/mm]}"
    plan = expand(study((GAP, case), ("analyses: [elastic]", sweep)))
    found = [plan.scenes[row.scene].links[1].law.stiffness for row in plan.rows[::2]]
    assert found == [1e7, 3e7]
    assert plan.axes[0].values == ((1e7,), (3e7,))


def test_the_resolved_study_and_citations_name_every_link(study):
    read = study((GAP, f"gap: {{gap: 5 cm, link: [pounding, {SPRING}]}}"))
    resolved = read.resolved()
    assert resolved["cases"]["gap"]["link"][0] == "pounding"
    assert resolved["cases"]["gap"]["link"][1]["stiffness"] == 2e7
    assert "westermo1989" in [each.reference.key for each in citations("run", resolved, {})]


@pytest.mark.parametrize(
    ("case", "message"),
    [
        ("link: [pounding, §none]", "link: 'none' is not known"),
        ("§stiffness: 3 kN/mm, link: [pounding, connector]", "'stiffness' beside several links does not say"),
        ("link: [pounding, §pounding]", "two pounding links alike between the same floors"),
        ("link: [pounding, §{stiffness: 3 kN/mm}]", "'link' is missing"),
        ("floors: [3], link: [pounding, {link: connector, floors: [3, §2]}]", "does not stand on floor 2"),
        ("§hertz_stiffness: 3e9 N/m^1.5, link: [pounding, connector]", "does not apply to links pounding, connector"),
        ("link: §[]", "'link' is empty"),
        ("link: [pounding, {link: connector, §law: printed}]", "'law' does not apply to link: connector"),
        ("link: [pounding, {link: §[connector]}]", "a list is not known"),
        ("link: [pounding, connector], by_floor: {3: {§stiffness: 3 kN/mm}}", "'stiffness' beside several links"),
        ("link: [pounding, {link: connector, gap: §5 s}]", "'5 s' is no gap"),
    ],
)
def test_refusals(refused, case, message):
    refused((GAP, f"gap: {{gap: 5 cm, {case}}}"), message=message)


def test_rows_of_tables(study):
    """What strikes keeps the row of its floors, wherever it stands in the list; others are named for their law."""
    second = "{link: connector, stiffness: 3 kN/mm}"
    several = links(study((GAP, f"gap: {{gap: 5 cm, floors: [2], link: [{SPRING}, pounding, {second}]}}")))
    labels = [link_label(("stiff", "soft"), place) for place in link_places(several)]
    assert labels == ["stiff|soft floor 2, connector", "stiff|soft floor 2", "stiff|soft floor 2, connector 2"]
    only = links(study((GAP, f"gap: {{gap: 5 cm, floors: [2], link: [{SPRING}, {second}]}}")))
    assert [name for *_, name in link_places(only)] == ["", "connector"]
    assert [name for *_, name in link_places(links(study()))] == ["", "", ""]


def test_results_histories_and_pictures(study, tmp_path, monkeypatch):
    """A run to its tables: every link has its own row and its own force. Fails if two links of a floor share a row."""
    from pounding_cli.api.studies import run

    monkeypatch.chdir(tmp_path)
    both = "gap: {gap: 1 cm, link: [pounding, {link: connector, stiffness: 20 kN/mm, floors: [3]}]}"
    kept = "analyses: [elastic]\nkeep: histories\nestimate: none"
    read = study((GAP, f"{both}\n  plain: {GAP[5:]}"), ("analyses: [elastic]", kept))
    results = run(read.path)
    table = results.link()
    here = table[(table["case"] == "gap") & (table["record"] == "elcentro")]
    assert here["link"].tolist() == [f"stiff|soft floor {n}" for n in (1, 2, 3)] + ["stiff|soft floor 3, connector"]
    assert here["kind"].tolist() == ["pounding"] * 3 + ["connector"]
    assert table[table["case"] == "plain"]["link"].nunique() == 3
    connector = here[here["kind"] == "connector"].iloc[0]
    history = results.history(case="gap", record="elcentro")
    assert history.links[3] == "stiff|soft floor 3, connector"
    force = np.abs(history.link_force[:, 3]).max()
    assert 0 < force <= connector["peak_force"] * (1 + 1e-6)
    assert history.closing[:, 3] == pytest.approx(history.closing[:, 2], abs=0)
    floor3 = here[here["floor"] == 3]
    for order in (1, -1):
        together = by_floor(here.iloc[::order]).set_index("floor")
        assert together.loc[3, "peak_force"] == floor3["peak_force"].max()
        assert together.loc[3, "impacts"] == floor3["impacts"].max() > 0
        assert len(together) == 3
