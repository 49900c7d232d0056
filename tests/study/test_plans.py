"""Plans of floors as studies write them: what short forms, shares and inherited keys come to, and what `check` says."""

from __future__ import annotations

import re

import numpy as np
import pytest
from click.testing import CliRunner

import pounding_cli as pound
from pounding_cli.cli.main import cli
from pounding_cli.model.effects import effects_of
from pounding_cli.model.twist import find_twisting
from pounding_cli.numbers import format_range
from pounding_cli.study.data import building_of
from tests.adapter import scenes

STUDY = """\
records: {use: [elcentro], duration: 5 s}
analyses: [elastic]
buildings:
  corner:
    storeys: 3
    period: 0.4 s
    plan: {width: 20 m, depth: 12 m, lines: [{y: -8 m, stiffness: 60 %}, {y: 8 m, stiffness: 40 %}]}
  plain: {storeys: 3, period: 0.5 s, plan: {width: 14 m, depth: 12 m, eccentricity: 0 %, frequency_ratio: 1.2}}
group: [corner, plain]
cases:
  near: {link: pounding, gap: 2 cm}
"""


def build(**plan):
    keys = {"storeys": 3, "period": "0.4 s", "yield_shear": [9e5, 7e5, 4e5], "mass": ["200 t", "200 t", "120 t"]}
    return building_of("a", {**keys, "plan": plan})


def lowest_frequency(mass, stiffness):
    """Return the lowest circular frequency of a chain, by its full matrices."""
    above = np.append(stiffness[1:], 0.0)
    matrix = np.diag(stiffness + above) - np.diag(above[:-1], 1) - np.diag(above[:-1], -1)
    return np.sqrt(np.linalg.eigvals(matrix / mass[:, None]).real.min())


@pytest.mark.parametrize(
    "inertia", [None, ["9000 t m2", "9000 t m2", "3000 t m2"], ["4000 t m2", "9000 t m2", "2500 t m2"]]
)
@pytest.mark.parametrize(("eccentricity", "ratio"), [(0.0, 0.8), (0.1, 1.1), (-0.2, 0.9), (0.3, 1.6)])
def test_a_short_form_has_the_eccentricity_and_the_ratio_that_it_asks_for(inertia, eccentricity, ratio):
    """Fails if the torsional stiffness is that about the centre of stiffness, or follows each floor's own radius."""
    keys = {"depth": "12 m"} if inertia is None else {"inertia": inertia}
    building = build(width="20 m", eccentricity=eccentricity, frequency_ratio=ratio, **keys)
    plan = building.plan
    torsional = plan.torsional_stiffness + sum(line.stiffness * line.arm**2 for line in plan.lines)
    asked = ratio * lowest_frequency(building.mass, building.stiffness)
    assert lowest_frequency(plan.inertia, torsional) == pytest.approx(asked, rel=1e-10)
    assert plan.eccentricity == pytest.approx(20.0 * eccentricity, abs=1e-10)
    assert sum(line.stiffness for line in plan.lines) == pytest.approx(building.stiffness, rel=1e-12)
    assert all(plan.low <= line.arm <= plan.high for line in plan.lines)
    assert (plan.torsional_stiffness >= 0.0).all()


def test_what_is_accidental_moves_the_centres_of_mass_and_not_the_lines():
    """Fails if the lines of a short form move along with them, so that nothing becomes eccentric."""
    for keys in ({"eccentricity": 0.1, "frequency_ratio": 1.1}, {"lines": [{"y": -4.0, "stiffness": "100 %"}]}):
        keys = {"torsional_stiffness": 5e9, **keys} if "lines" in keys else keys
        without, moved = (build(width=20.0, depth=12.0, accidental=share, **keys).plan for share in (0.0, 0.05))
        assert moved.eccentricity == pytest.approx(without.eccentricity - 1.0)
        assert (moved.street - without.street, moved.low - without.low) == pytest.approx((1.0, -1.0))
        assert moved.torsional_stiffness == pytest.approx(without.torsional_stiffness)


def test_both_sides_of_an_accidental_eccentricity_are_an_unknown_value_of_the_sweep(tmp_path):
    """Fails if `+-5 %` is one value, or its axis does not say which building it is of."""
    written = STUDY.replace("width: 14 m,", "width: 14 m, accidental: +-5 %,")
    path = tmp_path / "study.yaml"
    path.write_text(written)
    study = pound.load_study(path)
    (axis,) = study.axes
    assert axis.names == ("buildings.plain.plan.accidental",)
    assert [value for (value,) in axis.values] == [-0.05, 0.0, 0.05]
    places = [study.building((place,), 1).plan.street for place in range(3)]
    assert places == pytest.approx([-0.7, 0.0, 0.7])
    path.write_text(written + "sweep: {buildings.plain.plan.accidental: [1 %, 2 %]}\n")
    with pytest.raises(pound.InputError, match="is an axis of the sweep, which also has"):
        pound.load_study(path)


def test_shares_that_differ_by_rounding_are_one():
    """Fails if the same share of two storeys is told as "68.6 to 68.7" where it stands at a half."""
    share = 68.65
    assert format_range(share - 1e-13, share + 1e-13, ".3g") in ("68.6", "68.7")
    assert format_range(60.0, 63.0, ".3g") == "60 to 63"


def test_the_rest_is_what_other_lines_leave(tmp_path):
    """Fails if a share can be swept in no study, since all others would have to move with it."""
    path = tmp_path / "study.yaml"
    swept = "sweep: {buildings.corner.plan.lines.0.stiffness: [50 %, 70 %]}\n"
    path.write_text(STUDY.replace("stiffness: 40 %", "stiffness: rest") + swept)
    study = pound.load_study(path)
    for place, share in enumerate((0.5, 0.7)):
        building = study.building((place,), 0)
        assert building.plan.lines[0].stiffness == pytest.approx(share * building.stiffness)
        assert building.plan.lines[1].stiffness == pytest.approx((1.0 - share) * building.stiffness)


NUMBERS = "stiffness: [1e8, 1e8, 1e8], yield_shear: never"
LINES = f"lines: [{{y: -6 m, {NUMBERS}}}, {{y: 6 m, {NUMBERS}}}]"


@pytest.mark.parametrize(
    ("keys", "holds"),
    [
        ("plan: {eccentricity: 5 %, frequency_ratio: 1.3}", lambda b: b.plan.eccentricity == pytest.approx([1.0] * 3)),
        ("plan: {inertia: 1e7 kg m2}", lambda b: b.plan.inertia.tolist() == [1e7] * 3),
        ("plan: {shift: 2 m}", lambda b: b.plan.street == 2.0 and len(b.plan.lines) == 2),
        (f"plan: {{{LINES}}}", lambda b: b.stiffness.tolist() == [2e8] * 3 and np.isinf(b.yield_shear).all()),
        ("plan: null", lambda b: b.plan is None),
    ],
)
def test_a_plan_that_a_building_takes_over_changes_by_key(tmp_path, keys, holds):
    """Fails if a key that stands in place of an inherited one is refused beside it."""
    path = tmp_path / "study.yaml"
    other = f"  other: {{like: corner, {keys}}}\ngroup: [other"
    path.write_text(STUDY.replace("group: [corner", other))
    assert holds(pound.load_study(path).building((), 0))


@pytest.mark.parametrize(
    ("lines", "is_eccentric"),
    [
        ([(-5, 50), (5, 50)], False),
        ([(-5, 40), (5, 60)], True),
        ([(5, 25), (5, 25), (-5, 25), (-5, 25)], False),
        ([(5, 30), (5, 30), (-5, 30), (0, 10)], True),
        ([(5, 40), (-5, 40), (0, 20)], False),
    ],
)
def test_lines_are_eccentric_unless_each_has_one_like_it_on_the_other_side(lines, is_eccentric):
    """Fails if one line answers for two on the other side."""
    building = build(width=20.0, depth=12.0, lines=[{"y": y, "stiffness": f"{share} %"} for y, share in lines])
    assert find_twisting((building,), ()) == (is_eccentric,)


def test_edges_tell_buildings_apart():
    """Fails if the results of one width are reused for another, whose edges drift further."""
    narrow, wide = (
        build(width=width, inertia=1e7, lines=[{"y": -5, "stiffness": "70 %"}, {"y": 5, "stiffness": "30 %"}])
        for width in (12.0, 20.0)
    )
    assert narrow.digest != wide.digest


@pytest.mark.parametrize("key", ["lines", "across"])
def test_a_building_yields_where_one_of_its_lines_does(tmp_path, key):
    """Fails if lines stay elastic because the sum of their storey, of which another line never yields, does."""
    lines = "lines: [{y: -6 m, %s}, {y: 6 m, %s}]" % ((NUMBERS,) * 2)
    yielding = NUMBERS.replace("never", "[2e5, 2e5, 2e5]")
    if key == "lines":
        plan = lines.replace(NUMBERS, yielding, 1)
    else:
        plan = f"twist: always, {lines}, across: [{{x: 5 m, {yielding}}}]"
    path = tmp_path / "study.yaml"
    corner = STUDY[STUDY.index("    period: 0.4 s") : STUDY.index("  plain")]
    study = STUDY.replace(corner, f"    plan: {{width: 20 m, depth: 12 m, {plan}}}\n").replace(
        "[elastic]", "[inelastic]"
    )
    path.write_text(study.replace("period: 0.5 s,", "period: 0.5 s, yield_shear: never,"))
    for _, scene, _ in scenes(path):
        assert ("yielding storeys" in effects_of(scene).kept) == (scene.buildings[0].name == "corner")


def check(path, study):
    path.write_text(study)
    return CliRunner().invoke(cli, ["check", str(path)], catch_exceptions=False).stdout


def section(said, name):
    """Return the lines of a section of what `check` says, each entry on one line."""
    block = re.split(r"\n(?=\S)", said.split(f"\n{name}")[1])[0]
    return re.sub(r"\n {15,}", " ", block)


def test_check_tells_plans_and_which_floors_twist_why(tmp_path):
    """Fails if a neighbour that is not eccentric itself has no reason, or parts of links count as links."""
    path = tmp_path / "study.yaml"
    said = check(path, STUDY)
    plans = section(said, "plans")
    assert "20 m wide, -10 to 10 m along the street; lines from the middle: -8 m (60 %), 8 m (40 %)" in plans
    assert "centres of stiffness -1.6 m (-8 % of the width) from those of mass" in plans
    assert "turns 1.2 times as fast as it moves along the row" in plans
    twist = section(said, "twist")
    assert "corner: its lines are eccentric by 1.6 m (8 % of the width)" in twist
    assert "plain: its neighbour corner may turn it at both ends of the edge that they share" in twist
    cases = section(said, "cases")
    assert "3 x pounding" in cases
    assert "half at each end of the edge that they share, -7 m and 7 m along the street" in cases
    assert re.search(r"twist of floors +simulated in 1\n", said)

    shifted = section(check(path, STUDY.replace("width: 14 m,", "width: 14 m, shift: 6 m,")), "twist")
    assert "plain: its links to corner act 1.5 m off its centre of mass" in shifted

    uneven = STUDY.replace("2 cm}", "2 cm, places: [-3 m, 3 m], shares: [30 %, rest]}")
    uneven = section(check(path, uneven), "twist")
    assert "plain: its links to corner act 1.2 m off its centre of mass" in uneven

    apart = STUDY.replace("[corner, plain]", "[corner, plain, plain]").replace("2 cm}", "2 cm, pair: 2}")
    said = check(path, apart)
    assert "plain-1, plain-2: nothing is eccentric, run without their plans" in section(said, "twist")

    still = STUDY.replace("60 %", "50 %").replace("40 %", "50 %")
    said = check(path, still)
    assert re.search(r"twist of floors +left out in 1: nothing is eccentric", said)
    assert section(said, "twist").count("nothing is eccentric, and buildings run without their plans") == 2
    assert "along the street" not in section(said, "cases")
    (scene,) = [scene for _, scene, _ in scenes(path) if scene.links]
    assert [building.plan for building in scene.buildings] == [None, None]


def test_check_says_nothing_of_plans_without_them(tmp_path):
    """Fails if studies of floors that do not twist are told of the twist that they leave out."""
    without = re.sub(r",? *\n? *plan: \{.*\}\}?(?=\n)", "", STUDY.replace("}}", "}")).replace("0.5 s\n", "0.5 s}\n")
    said = check(tmp_path / "study.yaml", without)
    assert "OK" in said
    assert "twist" not in said


def test_check_tells_where_links_stand_with_their_shares(tmp_path):
    """Fails if the shares of places are not those written, or a level link is told by its part."""
    path = tmp_path / "study.yaml"
    link = "{link: connector, gap: 2 cm, stiffness: 10 kN/mm, "
    for written, told in (
        ("places: [-5 m, 5 m], shares: [30 %, rest]}", "30 % at -5 m, 70 % at 5 m along the street"),
        ("places: 3 m}", "at 3 m along the street"),
        ("places: [[2 m, -1 m]]}", "at 2 m | -1 m along the street"),
        ("places: [-4 m, 0 m, 5 m]}", "1/3 at each of -4 m, 0 m, 5 m along the street"),
    ):
        cases = section(check(path, STUDY.replace("{link: pounding, gap: 2 cm}", link + written)), "cases")
        assert "3 x connector, gap 2 cm, 10 kN/mm" in cases
        assert told in cases


ISOLATED = """\
records: {use: [elcentro], scale: {pga: 0.6 g}, duration: 4 s}
analyses: [elastic]
estimate: none
buildings:
  tower:
    storeys: 2
    period: 0.3 s
    foundation: {mass: 200 t, isolation: {radius: 3.1 m, friction: 6 %, capacity: 40 cm}}
    plan: {width: 30 m, depth: 20 m, eccentricity: 12 %, frequency_ratio: 1.1}
  moat: {wall: {height: 3 m}}
group: [tower, moat]
cases:
  near: {link: pounding, gap: 4 cm}
"""


def test_a_base_does_not_turn_and_is_struck_once(tmp_path):
    """Fails if a base has a contact at both ends of the edge, whose dashpots add up to more than that of the whole."""
    path = tmp_path / "study.yaml"
    cases = section(check(path, ISOLATED), "cases")
    assert "2 x pounding" in cases
    assert "whole at the base, which does not turn, half at each end of the edge that they share" in cases
    (scene,) = [scene for _, scene, _ in scenes(path) if scene.links]
    at_base = [link for link in scene.links if link.left_floor == 0]
    above = [link for link in scene.links if link.left_floor == 1]
    assert [link.law for link in at_base] == [above[0].whole_law]
    assert len(above) == 2

    link = pound.run(path, tmp_path / "study.h5", workers=1).link()
    base = link[link["floor"] == 0]
    assert base["impacts"].tolist() == [base["impacts"].max()]
    assert base["impacts"].max() > 0
    assert base["street"].isna().all()


def test_a_link_off_the_centre_of_a_base_turns_nothing(tmp_path):
    """Fails if a link that ends on bases alone makes a plan twist in which nothing is eccentric."""
    path = tmp_path / "study.yaml"
    still = ISOLATED.replace("12 %", "0 %").replace("4 cm}", "4 cm, floors: [base], places: 6 m}")
    twist = section(check(path, still), "twist")
    assert twist.count("nothing is eccentric, and buildings run without their plans") == 2
