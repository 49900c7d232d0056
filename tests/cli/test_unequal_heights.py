"""What commands say of links between floors of different heights, and on columns."""

from pathlib import Path

import numpy as np
import pytest

from pounding_cli import open_results

STUDY = """\
title: unequal
buildings:
  A: {storeys: 3, period: 0.6 s, yield: {base_shear: 5 %}, height: 3 m, columns: 50 %}
  B: {storeys: 2, period: 0.3 s, height: 4 m, columns: none}
group: [A, B]
records: {use: [elcentro], duration: 3 s}
analyses: [inelastic]
cases:
  tied: {link: connector, gap: 2 cm, floors: [[2 + 50 %, 2]], stiffness: 100 kN/mm}
  damped:
    gap: 2 cm
    links: [pounding, {link: damper, damping_coefficient: 100 kN s/m, floors: [[3, 2], [1, 1]], distance: 1 m}]
"""


@pytest.fixture
def study(tmp_path, monkeypatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("unequal.yaml").write_text(STUDY)
    return Path("unequal.yaml")


def test_check_names_law_ends_angle_bending_and_what_no_link_guards(pound, study):
    code, out, err = pound("check", study)
    assert code == 0
    lines = {line.split()[0]: line for line in out.splitlines() if line.startswith(("  tied ", "  damped "))}
    assert "1 x connector on columns, gap 2 cm" in lines["tied"]
    assert "floor 2 + 50 %|2, level, bending columns leave" in lines["tied"]
    assert lines["tied"].endswith("no link at floors 1 + 33.3 %|1, 2 + 66.7 %|2: collisions there are not simulated")
    assert "floors 1, 3|2, inclined 45 degrees" in lines["damped"]
    assert "2 x slab against columns, gap 2 cm" in lines["damped"]
    assert "not simulated" not in lines["damped"]
    assert "A|B  3 m: floor 1 of A meets storey 1 of B, which has no columns to strike" in out
    assert "left out" not in out.split("cases\n")[0] + err  # walls have no columns to strike
    assert "the connector from floor 2 + 50 % of A to floor 2 of B acts level" in err


def test_bending_columns_leave_what_two_springs_in_series_have(pound, study):
    """In the middle of a storey columns deflect by F / (64 k), k = 12 E I / L^3 of the columns."""
    Path("alone.yaml").write_text(STUDY.replace("period: 0.6 s", "stiffness: [400 kN/mm, 400 kN/mm, 400 kN/mm]"))
    _, out, _ = pound("check", "alone.yaml")
    flexibility = 4.0 * 0.25**3 / (0.5 * 400.0)
    left = 100.0 / (1.0 + 100.0 * flexibility)
    assert f"bending columns leave {left:.3g} % of its stiffness" in out


def test_a_place_that_a_slab_strikes_is_the_same_however_it_is_written(pound, study):
    """Floor 2 of B is 8 m high, 2 m above floor 2 of A: 2 / 3 of the storey is that but for rounding."""
    study.write_text(STUDY.replace("2 + 50 %", "2 + 2 m"))
    _, out, _ = pound("check", study)
    (line,) = [line for line in out.splitlines() if line.startswith("  tied ")]
    assert "floor 2 + 66.7 %|2, bending" in line
    assert line.endswith("no link at floor 1 + 33.3 %|1: collisions there are not simulated")


def test_results_tell_inclination_loaded_columns_and_no_gap_of_unaligned_joints(pound, study):
    _, out, _ = pound("run", study, "-o", "r.h5")
    text = " ".join(out.split())
    assert "loaded columns" in text
    assert "connector, ends at different heights" in text
    assert "damper" not in text.split("Ratios to the same building")[0]  # the blows tell whether floors touch
    results = open_results("r.h5")
    link = results.link().set_index(["case", "link"])
    assert link.loc[("damped", "A|B floor 3|2"), "inclination"] == pytest.approx(np.pi / 4)
    assert link.loc[("damped", "A|B floor 3|2"), "facing"] == 0.0
    assert link.loc[("damped", "A|B floor 2|1, left columns"), "facing"] == 1.0
    struck = results.struck().set_index(["case", "storey"])
    row = struck.loc[("tied", 3)]
    assert (row["kind"], row["by"], row["by_floor"], row["at"], row["impacts"]) == ("connector", "B", 2, 0.5, 0)
    assert row["shear_demand"] > 1.0
    flags = results.flagged().set_index("case")["code"]
    assert flags["tied"] == "columns"
    _, table, _ = pound("show", "r.h5", "link")
    assert "inclination [deg]" in table


def test_level_links_have_no_inclination(pound, study):
    study.write_text(STUDY.split("  tied")[0] + "  plain: {link: pounding, gap: 2 cm}\n")
    pound("run", study, "-o", "r.h5")
    assert not {"inclination", "facing"} & set(open_results("r.h5").link())


def test_a_joint_between_unequal_floors_tells_nothing_of_contact(pound, study):
    """Its ends close by far more than its gap of 1 mm; the blows beside it, with a gap of 1 m, never happen."""
    far = STUDY.replace("gap: 2 cm\n    links: [pounding", "gap: 1 mm\n    links: [{link: pounding, gap: 1 m}")
    assert far != STUDY
    text = far.replace("  tied" + far.split("  tied")[1].split("\n")[0] + "\n", "")
    study.write_text(text + "sweep: {records.scale.pga: [0.1 g, 0.2 g]}\nfragility: {limits: [contact]}\n")
    code, out, _ = pound("fragility", study, "-o", "f.h5")
    assert code == 0
    assert "median capacity above 0.200 g" in " ".join(out.split())


def test_a_gap_at_another_height_of_the_storey_is_not_compared(pound, study):
    """Floor 2 of B faces 2 / 3 of storey 3 of A; the other case strikes the same storey lower."""
    written = STUDY[STUDY.index("  tied:") :]
    cases = "  near: {gap: 1 mm, links: [{link: pounding, floors: [[2 + END, 2]]}]}\n"
    for end, is_compared in (("2 m", True), ("20 %", False)):
        study.write_text(STUDY.replace(written, cases.replace("END", end)))
        code, out, err = pound("gap", study, "-o", "g.h5")
        assert code == 0, err
        assert ("Gaps of the cases" in out) == is_compared
        assert "floor 2 beside storey 3 of A" in out


def test_a_link_of_all_pairs_that_one_lacks_is_told_of_pair(pound, study):
    study.write_text(STUDY.replace("[A, B]", "[B, A, B]").replace("[[2 + 50 %, 2]]", "[[2, 3]]"))
    code, _, err = pound("check", study)
    assert code == 2
    assert "B-2 has 2 floors, not 3\n    write a floor from 1 to 2, or add `pair:` where it stands between" in err
