"""What a study file comes to: buildings derived, links placed, motions cut and scaled."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pounding_cli import records
from pounding_cli.laws.dashpot import DashpotLaw
from pounding_cli.laws.infill import InfillLaw
from pounding_cli.records.motion import GRAVITY
from pounding_cli.study import expand

STIFF = "stiff: {storeys: 3, period: 0.36 s, mass: 200 t}"
SOFT = "soft: {like: stiff, period: 0.60 s}"
GAP = "gap: {link: pounding, gap: 5 cm}"
GROUP = "group: [stiff, soft]"


def buildings(study):
    return expand(study).scenes[expand(study).rows[0].scene].buildings


def links(study, case="gap"):
    plan = expand(study)
    return plan.scenes[next(row for row in plan.rows if row.case == case).scene].links


def test_derived_building(study):
    """The period comes back from the eigenvalues, the taper from the ends, the base shear from the code."""
    stiff, soft = buildings(study())
    assert stiff.periods[0] == pytest.approx(0.36, rel=1e-12)
    assert soft.periods[0] == pytest.approx(0.60, rel=1e-12)
    assert stiff.stiffness[-1] / stiff.stiffness[0] == pytest.approx(1 / 3)
    assert np.diff(stiff.stiffness, 2) == pytest.approx(0, abs=1e-3)
    weight = 3 * 200e3 * GRAVITY
    assert stiff.yield_shear[0] == pytest.approx(0.4 * 2.75 / 12 * weight)
    assert soft.yield_shear[0] == pytest.approx(0.4 * 1.25 * 1.2 / 0.6 ** (2 / 3) / 12 * weight)
    omega = 2 * math.pi / stiff.periods[:2]
    assert (stiff.alpha / omega + stiff.beta * omega) / 2 == pytest.approx(0.05)
    assert stiff.hardening.tolist() == [0.05] * 3
    assert stiff.foundation is None


def test_separation_of_the_paper(tmp_path):
    """The 5-storey pair of Fig. 6: about 7 cm, 6.9 cm with a taper of 1/3."""
    from pounding_cli.study import load_study

    resolved = load_study("configs/fig6.yaml").resolved()
    assert resolved["separation"][0] == pytest.approx(0.069, abs=5e-4)
    assert resolved["claims"] == "fig6"
    assert resolved["report"]["plot"] == ["touching", "gap", "infill", "connected"]
    assert resolved["cases"]["gap"]["gap"] == pytest.approx(0.05)
    given = {key: value for key, value in resolved["impact"].items() if value is not None or key == "damping_ratio"}
    assert given == {
        "law": "kelvin-voigt", "stiffness": "20 x stiffest storey", "restitution": 0.5, "damping_ratio": None,
        "tension_cut": False, "dashpot": "reduced-mass",
    }  # fmt: skip


def test_given_outright(study):
    one, _ = buildings(
        study(
            (
                STIFF,
                "stiff: {mass: [3 t, 2 t], height: [4 m, 3 m], stiffness: [2 MN/m, 1 MN/m],"
                " yield_shear: [9 kN, 5 kN],"
                " rayleigh: {alpha: 0.5, beta: 1 ms}, hardening: [0.1, 0], foundation: {mass: 5 t,"
                " sway_stiffness: 1 MN/m, sway_damping: 3 kN s/m}}",
            ),
            (SOFT, "soft: {like: stiff, yield_shear: never}"),
        )
    )
    assert one.mass.tolist() == [3000, 2000]
    assert one.elevation.tolist() == [4, 7]
    assert one.stiffness.tolist() == [2e6, 1e6]
    assert one.yield_shear.tolist() == [9000, 5000]
    assert (one.alpha, one.beta) == (0.5, 0.001)
    assert one.hardening.tolist() == [0.1, 0]
    assert one.foundation.sways
    assert not one.foundation.rocks
    assert (one.foundation.mass, one.foundation.sway_damping) == (5000, 3000)
    assert np.isinf(_.yield_shear).all()


def test_nearer_wins(study):
    """An inherited stiffness list gives way to a period, an inherited period to a list, Rw to K."""
    plan = study(
        (STIFF, "stiff: {storeys: 3, stiffness: [3e8, 2e8, 1e8], yield: {zone: 0.3, Rw: 8}, damping: 2 %}"),
        (
            SOFT,
            "soft: {like: stiff, period: 0.6 s, rayleigh: {alpha: 1, beta: 0}, yield: {code: UBC-1985, zone: 1, K: 1}}",
        ),
        (
            GROUP,
            "  third: {like: soft, stiffness: [3e8, 2e8, 1e8], yield_shear: never}\ngroup: [stiff, soft, third]",
        ),
    )
    stiff, soft, third = buildings(plan)
    assert stiff.stiffness.tolist() == third.stiffness.tolist() == [3e8, 2e8, 1e8]
    assert soft.periods[0] == pytest.approx(0.6)
    assert (soft.alpha, soft.beta) == (third.alpha, third.beta) == (1, 0)
    weight = 3 * 200e3 * GRAVITY
    c = min(1.25 * 1.2 / stiff.periods[0] ** (2 / 3), 2.75)
    assert stiff.yield_shear[0] == pytest.approx(0.3 * c / 8 * weight)
    assert soft.yield_shear[0] == pytest.approx(1 / (15 * math.sqrt(0.6)) * 1.2 * weight)


def test_like_chain_merges_mappings(study):
    stiff, soft = buildings(
        study(
            (STIFF, "stiff: {storeys: 3, period: 0.3 s, yield: {Rw: 6}}"),
            (SOFT, "soft: {like: stiff, yield: {zone: 0.2}}"),
        )
    )
    assert soft.yield_shear == pytest.approx(stiff.yield_shear / 2)


def test_pounding_links(study):
    found = links(study())
    assert [(link.left, link.left_floor, link.right_floor) for link in found] == [
        (0, 1, 1),
        (0, 2, 2),
        (0, 3, 3),
    ]
    stiffest = buildings(study())[0].stiffness[0]
    for link in found:
        assert link.kind == "pounding"
        assert link.gap == 0.05
        assert link.law.stiffness == pytest.approx(20 * stiffest)
        assert link.law.damping_ratio == pytest.approx(math.log(2) / math.sqrt(math.pi**2 + math.log(2) ** 2))
        assert not link.law.tension_cut
        assert link.law.dashpot is DashpotLaw.REDUCED_MASS


def test_connector_on_listed_floors_leaves_the_others_free(study):
    case = "gap: {link: connector, gap: 5 cm, floors: [3, 1], stiffness: 1/5 mean storey of stiff}"
    plan = study((GAP, case))
    assert [(link.left_floor, link.kind) for link in links(plan)] == [(1, "connector"), (3, "connector")]
    assert links(plan)[0].law.stiffness == pytest.approx(np.mean(buildings(plan)[0].stiffness) / 5)
    default = study((GAP, "gap: {link: connector, gap: 5 cm}"))
    assert links(default)[0].law.stiffness == pytest.approx(np.mean(buildings(plan)[0].stiffness) / 5)


def test_elsewhere_inherits_the_gap_but_not_the_connector_s_stiffness(study):
    case = "gap: {link: connector, gap: 5 cm, floors: [3], stiffness: 1 MN/m, restitution: 0.8, elsewhere: pounding}"
    first, second, third = links(study((GAP, case)))
    assert third.kind == "connector"
    assert third.law.stiffness == 1e6
    assert first.kind == second.kind == "pounding"
    assert first.law.stiffness > 1e9
    assert first.gap == third.gap == 0.05
    xi = -math.log(0.8) / math.hypot(math.pi, math.log(0.8))
    assert first.law.damping_ratio == third.law.damping_ratio == pytest.approx(xi)
    own = "elsewhere: {link: infill, gap: 7 cm, stiffness: 2 MN/m, damping_ratio: 0.3, law: printed, tension_cut: true}"
    first = links(study((GAP, case.replace("elsewhere: pounding", own))))[0]
    assert (first.kind, first.gap, first.law.stiffness, first.law.damping_ratio) == ("infill", 0.07, 2e6, 0.3)
    assert first.law.law is InfillLaw.PRINTED
    assert first.law.tension_cut


def test_by_floor(study):
    case = "gap: {link: infill, gap: 5 cm, stiffness: 3 MN/m, by_floor: {2: none, 3: {stiffness: 4 MN/m}}}"
    assert [(link.left_floor, link.kind, link.law.stiffness) for link in links(study((GAP, case)))] == [
        (1, "infill", 3e6),
        (3, "infill", 4e6),
    ]


def test_pairs(study):
    """Each pair its own links; what an entry leaves out comes from the case."""
    case = "gap: {link: pounding, gap: 5 cm, pairs: [{gap: 2 cm, floors: [3]}, connector]}"
    found = links(study((GAP, case), (GROUP, "group: [soft, stiff, soft]")))
    assert [(link.left, link.left_floor, link.kind, link.gap) for link in found] == [
        (0, 3, "pounding", 0.02), (1, 1, "connector", 0.05),
        (1, 2, "connector", 0.05), (1, 3, "connector", 0.05),
    ]  # fmt: skip


def test_connector_in_a_group_of_three_joins_both_pairs(study):
    case = "gap: {link: connector, gap: 5 cm, floors: [1, 3]}"
    plan = study((GAP, case), (GROUP, "group: [soft, stiff, soft]"))
    assert [(link.left, link.left_floor) for link in links(plan)] == [(0, 1), (0, 3), (1, 1), (1, 3)]
    assert expand(plan).buildings == ("soft-1", "stiff", "soft-2")


def test_floors_meet_by_elevation(study):
    """Floors at 4, 6, 8 m and at 2, 4.0009, 7.0009, 8, 11 m: two pairs agree within 1 mm."""
    plan = study(
        (STIFF, "stiff: {storeys: 3, period: 0.36 s, height: [4 m, 2 m, 2 m]}"),
        (SOFT, "soft: {storeys: 5, period: 0.60 s, height: [2 m, 2.0009 m, 3 m, 0.9991 m, 3 m]}"),
    )
    assert [(link.left_floor, link.right_floor) for link in links(plan)] == [(1, 2), (3, 4)]


def test_printed_laws_and_overrides_reach_the_links(study):
    plan = study(
        ("restitution: 0.5", "damping_ratio: 0.14, tension_cut: true, dashpot: printed"),
        ("20 x stiffest storey", "1e10"),
    )
    link = links(plan)[0]
    assert (link.law.damping_ratio, link.law.tension_cut, link.law.stiffness) == (0.14, True, 1e10)
    assert link.law.dashpot is DashpotLaw.PRINTED
    assert [(w.line, "eq. (7)" in w.message) for w in plan.warnings] == [(10, True)]


def test_elastic_impact_has_no_dashpot(study):
    assert repr(links(study(("restitution: 0.5", "restitution: 1")))[0].law.damping_ratio) == "0.0"


def test_arias_scale_brings_every_motion_to_the_reference(study):
    plan = expand(study(("scale: 1.0", "scale: {arias: elcentro}"), ("duration: 5 s", "duration: table1")))
    target = records.arias(records.find("elcentro").windowed(10.0))
    assert [use.name for use in plan.motions] == ["elcentro", "taft"]
    for use in plan.motions:
        assert use.arias == pytest.approx(target, rel=1e-12)
    assert plan.motions[0].scale == 1.0
    assert plan.motions[1].window == pytest.approx(15.0)


def test_arias_window_of_its_own(study):
    """The factor from 4 s windows, the analysis over 5 s."""
    plan = expand(study(("scale: 1.0", "scale: {arias: elcentro, window: 4 s}")))
    one, other = (records.find(name).windowed(4.0) for name in ("elcentro", "taft"))
    assert plan.motions[1].scale == pytest.approx(math.sqrt(records.arias(one) / records.arias(other)))
    assert plan.motions[1].window == pytest.approx(5.0)


@pytest.mark.parametrize(("scale", "pga"), [("{pga: 0.2 g}", 0.2 * GRAVITY), ("{pga: 3}", 3.0)])
def test_pga_scale(study, scale, pga):
    for use in expand(study(("scale: 1.0", f"scale: {scale}"))).motions:
        assert use.pga == pytest.approx(pga)


def test_table1_scale(study):
    plan = expand(study(("scale: 1.0", "scale: table1")))
    assert [use.scale for use in plan.motions] == [1.00, 1.75]


def test_own_record(study, tmp_path):
    """Two columns, t in s and a in g; longer windows than the record use all of it, and say so."""
    (tmp_path / "m.txt").write_text("".join(f"{i * 0.01:.2f} {0.1 * math.sin(i)}\n" for i in range(101)))
    read = study(("[elcentro, taft]", "[{file: m.txt, name: mine}]"), ("scale: 1.0", "scale: 2"))
    (use,) = expand(read).motions
    assert (use.name, use.scale, use.source) == ("mine", 2.0, "user, unit g assumed")
    assert use.window == pytest.approx(1.0)
    assert use.pga == pytest.approx(0.2 * GRAVITY, rel=1e-3)
    assert ["'mine' lasts 1 s" in w.message for w in read.warnings] == [True]
