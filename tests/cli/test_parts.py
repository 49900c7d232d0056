"""Rows of parts that nothing links: in a batch each part is solved once, and the tables have its numbers."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from pounding_cli import open_results
from tests.adapter import solver

STUDY = """\
title: A row that a wall divides
records: {use: [elcentro, taft], duration: 3 s, scale: {pga: 0.5 g}}
buildings:
  stiff: {storeys: 3, period: 0.3 s}
  soft: {storeys: 2, period: 0.5 s}
  rigid: {wall: fixed}
group: [stiff, soft, rigid, soft, stiff]
impact: {stiffness: 2e9 N/m}
cases:
  near:
    gap: 1 cm
    links:
      - {link: pounding, pair: 1}
      - {link: pounding, pair: 2, gap: 4 mm}
      - {link: pounding, pair: 3, gap: 4 mm}
      - {link: pounding, pair: 4, gap: 4 mm}
analyses: [inelastic]
estimate: all
"""
SWEEP = "sweep: {cases.near.gap: [1 mm, 2 mm, 3 mm]}\n"
RIGHT = STUDY.replace("group: [stiff, soft, rigid, soft, stiff]", "group: [rigid, soft, stiff]").replace(
    STUDY[STUDY.index("cases:") : STUDY.index("analyses:")], "cases:\n  near: {link: pounding, gap: 4 mm}\n"
)


def count_solved(pound, *arguments: object) -> Counter[str]:
    """Return how often the solver was called for each row of buildings, other than with nothing between them."""
    solved: Counter[str] = Counter()
    solve = solver.solve

    def count(scene, **settings):
        if all(link.law.can_act for link in scene.links):
            solved["|".join(building.name for building in scene.buildings)] += 1
        return solve(scene, **settings)

    code, _, err = pound(*arguments, solve=count)
    assert code == 0, err
    return solved


def test_a_sweep_over_one_gap_solves_the_other_part_once(pound, folder):
    (folder / "two.yaml").write_text(STUDY.replace("estimate: all", "estimate: none") + SWEEP)
    solved = count_solved(pound, "run", "two.yaml", "-q", "-o", "r.h5")
    by_part = {name: count for name, count in solved.items() if "|" in name}
    assert by_part == {"stiff-1|soft-1|rigid": 3 * 2, "rigid|soft-2|stiff-2": 2}
    for gaps in ("4 mm", "5 mm"):
        (folder / "two.yaml").write_text(STUDY.replace("estimate: all", "estimate: none") + SWEEP.replace("3 mm", gaps))
        assert count_solved(pound, "run", "two.yaml", "-q", "-o", "r.h5", "--replace") == {"stiff-1|soft-1|rigid": 2}


def test_counts_tell_what_is_solved_by_parts(pound, folder):
    """A row of parts that other rows had is put together from them: nothing is left to solve."""

    def run(left: str, right: str) -> tuple[str, str]:
        text = STUDY.replace("estimate: all", "estimate: none").replace("gap: 1 cm", f"gap: {left}")
        (folder / "two.yaml").write_text(text.replace("pair: 3, gap: 4 mm", f"pair: 3, gap: {right}"))
        return tuple(pound(command, "two.yaml", "-o", "r.h5")[1] for command in ("check", "run"))

    check, out = run("1 cm", "4 mm")
    assert "2 of these by parts that nothing links, each part once" in check
    assert "Time histories: 8 solved, 2 of them by parts that nothing links (4 parts solved), 0 reused" in out
    check, out = run("2 cm", "5 mm")
    assert "6 solved, 2 to solve" in check
    check, out = run("1 cm", "5 mm")
    assert "8 time histories; 8 solved, 0 to solve" in check
    assert "Time histories: 0 solved, 8 reused, 0 failed" in out


def test_a_row_says_which_gaps_of_its_parts_stay_open_and_what_its_parts_cost(pound, folder):
    """Fails if what a part leaves out, or the time that it took, is lost where its row is put together."""
    (folder / "two.yaml").write_text(STUDY.replace("estimate: all", "estimate: none").replace("4 mm", "50 cm"))
    assert pound("run", "two.yaml", "-q", "-o", "r.h5")[0] == 0
    scenes = open_results("r.h5").scene()
    for names in scenes["dropped_links"]:
        assert [each for each in names.splitlines() if each] == ["soft-1 | rigid", "rigid | soft-2", "soft-2 | stiff-2"]
    assert scenes["dropped_reasons"].str.contains("the gap never closes").all()
    assert (scenes["seconds"] > 0.0).all()


def test_buildings_that_nothing_links_are_those_alone(pound, folder):
    """They are in the tables anyway: no scene of the two is solved."""
    (folder / "two.yaml").write_text(
        "records: {use: [elcentro], duration: 2 s}\nbuildings: {a: {storeys: 2, period: 0.3 s}, b: {storeys: 2, "
        "period: 0.4 s}}\ngroup: [a, b]\ncases: {free: {link: none}}\nanalyses: [elastic]\nestimate: none\n"
    )
    assert count_solved(pound, "run", "two.yaml", "-q", "-o", "r.h5") == {"a": 1, "b": 1}
    assert (open_results("r.h5").storey()["V_ratio"] == 1.0).all()


@pytest.mark.parametrize("engine", ["serial", "threads"])
def test_a_part_has_the_numbers_of_its_own_study(pound, folder, engine):
    (folder / "two.yaml").write_text(STUDY)
    (folder / "right.yaml").write_text(RIGHT)
    for name in ("two", "right"):
        assert pound("run", f"{name}.yaml", "-q", "-o", f"{name}.h5", "--engine", engine)[0] == 0
    row, part = (open_results(f"{name}.h5") for name in ("two", "right"))
    names = {"soft": "soft-2", "stiff": "stiff-2"}
    for table in ("storey", "floor"):
        expected = getattr(part, table)().replace({"building": names})
        found = getattr(row, table)()
        found = found[found["building"].isin(names.values())].reset_index(drop=True)
        numbers = expected.select_dtypes(float).columns
        assert np.array_equal(found[numbers], expected[numbers], equal_nan=True)
    scenes = row.scene()
    assert (scenes["status"] == "done").all()
    assert (scenes["error_estimate"] >= part.scene()["error_estimate"]).all()
    assert (scenes["energy_residual"].abs() < 1e-8).all()
    dropped = "no force passes between stiff-1|soft-1|rigid and rigid|soft-2|stiff-2, and each is solved by itself"
    assert scenes["dropped_reasons"].str.contains(dropped, regex=False).all()


def test_flags_name_the_building_of_each_part(pound, folder):
    """Both parts are alike and solved once; the flags of the second are not those of the first."""
    weak = "{storeys: 2, period: 0.9 s, p_delta: true, hardening: 0, yield: {base_shear: 0.03 W}}"
    (folder / "two.yaml").write_text(
        f"records: {{use: [elcentro], duration: 8 s, scale: {{pga: 0.8 g}}}}\nbuildings: {{weak: {weak}}}\n"
        "group: [weak, weak]\ncases: {free: {link: none}}\nanalyses: [inelastic]\nestimate: none\n"
    )
    assert pound("run", "two.yaml", "-q", "-o", "r.h5")[0] == 0
    flags = open_results("r.h5").flagged()
    assert flags["code"].tolist()[:2] == ["collapse"] * 2
    assert [detail.split(" storey")[0] for detail in flags["detail"][:2]] == ["weak-1", "weak-2"]


def test_a_check_tells_what_is_solved_by_itself(pound, folder):
    code, out, _ = pound("check", "two.yaml")
    assert code == 0
    line = "no force passes between stiff-1|soft-1|rigid and rigid|soft-2|stiff-2, and each is solved by itself"
    assert f"  coupling of the whole row      left out in 2: {line}\n" in out


def test_histories_of_a_divided_row_are_kept(pound, folder):
    (folder / "two.yaml").write_text(STUDY + "keep: {histories: {records: [elcentro]}}\n")
    (folder / "right.yaml").write_text(RIGHT + "keep: {histories: {records: [elcentro]}}\n")
    for name in ("two", "right"):
        assert pound("run", f"{name}.yaml", "-q", "-o", f"{name}.h5")[0] == 0
    row, part = (open_results(f"{name}.h5").history() for name in ("two", "right"))
    assert np.array_equal(row.drift[:, 2:, :], part.drift, equal_nan=True)
    assert row.buildings == ("stiff-1", "soft-1", "rigid", "soft-2", "stiff-2")


@pytest.mark.parametrize(
    ("group", "place", "words"),
    [
        ("[stiff, rigid, rigid, soft]", "7:23", "rigid-1 and rigid-2 are two walls side by side"),
        ("[stiff, low, soft]", "7:16", "no floor meets the wall low, which reaches 1 m above the ground"),
    ],
)
def test_walls_that_mean_nothing_are_refused(pound, folder, group, place, words):
    text = STUDY.replace("group: [stiff, soft, rigid, soft, stiff]", f"group: {group}")
    text = text.replace("  rigid: {wall: fixed}", "  rigid: {wall: fixed}\n  low: {wall: {height: 1 m}}")
    line, column = place.split(":")
    (folder / "two.yaml").write_text(text)
    code, _, err = pound("check", "two.yaml")
    assert code == 2
    assert f"two.yaml:{int(line) + 1}:{column}: {words}" in err


MOAT = """\
records: {use: [elcentro], duration: 2 s}
buildings:
  moat: {wall: {height: 0 m}}
  house: {storeys: 2, period: 0.3 s, foundation: {mass: 200 t, isolation: {radius: 3.1 m, friction: 6 %}}}
  frame: {storeys: 2, period: 0.5 s}
group: [moat, house, moat, frame]
cases: {near: LINK}
estimate: none
"""


def test_a_moat_that_ends_at_the_ground_has_no_link_to_a_frame_beyond(pound, folder):
    (folder / "two.yaml").write_text(MOAT.replace("LINK", "{link: pounding, gap: 2 cm, floors: base}"))
    code, out, _ = pound("run", "two.yaml", "-o", "r.h5")
    assert code == 0
    link = open_results("r.h5").link()
    assert set(link["left"] + "|" + link["right"]) == {"moat-1|house", "house|moat-2"}
    assert "frame by less than 0.5 %" in out.replace("\n", " ")
    (folder / "two.yaml").write_text(MOAT.replace("LINK", "{gap: 2 cm, links: [{link: pounding, pair: 3}]}"))
    code, _, err = pound("check", "two.yaml")
    assert code == 2
    assert "two.yaml:7:" in err
    assert "moat-2 and frame meet at no floor: the link stands nowhere" in err


FALLING = """\
records: {use: [elcentro], duration: 8 s, scale: {pga: 0.8 g}}
buildings:
  weak: {storeys: 2, period: 0.9 s, p_delta: true, hardening: 0, yield: {base_shear: 0.03 W}}
  frail: {storeys: 2, period: 0.8 s, p_delta: true, hardening: 0, yield: {base_shear: 0.05 W}}
  house: {storeys: 2, period: 0.3 s, yield: {base_shear: 0.3 W}, collapse: never}
  rigid: {wall: fixed}
group: [weak, rigid, BUILDING]
cases: {near: {gap: 1 cm, links: [{link: pounding, pair: 1}, {link: pounding, pair: 2}]}}
analyses: [inelastic]
estimate: none
"""
ITSELF = FALLING.replace("weak, rigid", "rigid").replace(", {link: pounding, pair: 2}", "")


def test_a_building_that_stands_has_its_numbers_where_another_part_collapses(pound, folder):
    (folder / "two.yaml").write_text(FALLING.replace("BUILDING", "house"))
    (folder / "right.yaml").write_text(ITSELF.replace("BUILDING", "house"))
    for name in ("two", "right"):
        code, _, err = pound("run", f"{name}.yaml", "-o", f"{name}.h5")
        assert code == 0, err
    row, part = (open_results(f"{name}.h5") for name in ("two", "right"))
    assert row.scene()["status"].tolist() == ["collapsed"]
    storey, link = row.storey(), row.link()
    is_house = storey["building"] == "house"
    assert storey["V"].notna().tolist() == is_house.tolist()
    assert storey[is_house]["V"].tolist() == part.storey().query("building == 'house'")["V"].tolist()
    assert link["peak_force"].notna().tolist() == (link["right"] == "house").tolist()
    assert link["peak_force"].dropna().tolist() == part.link()["peak_force"].tolist()
    summary = row.summary().groupby("building")[["records_used", "records_collapsed"]].first()
    assert summary.T.to_dict("list") == {"weak": [0, 1], "house": [1, 0]}


def test_every_collapse_of_a_row_is_told(pound, folder):
    (folder / "two.yaml").write_text(FALLING.replace("BUILDING", "frail"))
    assert pound("run", "two.yaml", "-q", "-o", "r.h5")[0] == 0
    collapsed = open_results("r.h5").values("collapsed")
    assert ((collapsed > 0).ravel().tolist()) == [True, False, True]


@pytest.mark.parametrize(("building", "limit"), [("frail", "collapse in frail"), ("house", "mu in house > 20")])
def test_a_limit_is_met_by_its_own_part_alone(pound, folder, building, limit):
    """The other part collapses before."""
    curves = []
    for name, text in (("two", FALLING), ("right", ITSELF)):
        question = f"sweep: {{records.scale.pga: [0.1 g, 0.4 g, 0.8 g]}}\nfragility: {{limits: [{limit}]}}\n"
        text = text.replace("BUILDING", building)
        (folder / f"{name}.yaml").write_text(text + question)
        code, _, err = pound("fragility", f"{name}.yaml", "-o", f"{name}.h5")
        assert code == 0, err
        frame = open_results(f"{name}.h5").answer("fragility").frame
        curves.append(frame[["state", "low", "high", "undecided"]].to_dict("list"))
    assert curves[0] == curves[1]


def test_the_gap_of_a_pair_that_stands_is_told_beside_a_collapse(pound, folder):
    (folder / "two.yaml").write_text(FALLING.replace("BUILDING", "house"))
    _, out, _ = pound("gap", "two.yaml", "-o", "r.h5")
    out = " ".join(out.split())
    assert "Between weak | rigid all runs of yielding buildings failed" in out
    assert "(1 motion)" in out  # of the other pair, without a failed one
    assert "1 of 1 run failed (1 collapsed) and are left out, but for pairs that nothing links to the collapse." in out
