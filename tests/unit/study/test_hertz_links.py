"""Hertz links in a study file: their number and its unit, what they refuse, and what is said of them."""

from __future__ import annotations

import pytest

from pounding_cli.errors import InputError
from pounding_cli.laws.bilinear_contact import BilinearContact, BilinearDamping
from pounding_cli.laws.friction import Friction
from pounding_cli.laws.hertz import Hertz, HertzDamp, HertzDamping
from pounding_cli.laws.jankowski import Jankowski, JankowskiDamping
from pounding_cli.laws.maxwell import Maxwell
from pounding_cli.laws.viscous import Viscous
from pounding_cli.study import expand, load_study

STUDY = """\
records: {{use: [elcentro], duration: 3 s}}
buildings: {{stiff: {{storeys: 1, period: 0.3 s}}, soft: {{storeys: 1, period: 0.5 s}}}}
group: [stiff, soft]
cases: {{struck: {{gap: 1 cm, {link}}}}}
analyses: [elastic]
"""
K = "hertz_stiffness: 2 kN/mm^1.5"


def study(tmp_path, link: str):
    path = tmp_path / "study.yaml"
    path.write_text(STUDY.format(link=link))
    return load_study(path)


@pytest.mark.parametrize(
    ("link", "law"),
    [
        (f"link: hertz, {K}", Hertz(0.01, 2e3 * 1000**1.5)),
        (f"link: hertz-damp, {K}", HertzDamp(0.01, 2e3 * 1000**1.5, 0.5)),
        (
            f"link: bilinear, {K}, restitution: 0.6, penetration: 5 mm, damping_formula: muthukumar",
            BilinearContact(0.01, 2e3 * 1000**1.5, 0.005, 0.6, 0.1, BilinearDamping.MUTHUKUMAR),
        ),
        (
            f"link: jankowski, {K}, restitution: 0.6, damping_formula: jankowski",
            Jankowski(0.01, 2e3 * 1000**1.5, 0.6, JankowskiDamping.JANKOWSKI),
        ),
        (
            f"link: hertz-damp, {K}, restitution: 0.6, damping_formula: ye",
            HertzDamp(0.01, 2e3 * 1000**1.5, 0.6, HertzDamping.YE),
        ),
    ],
)
def test_a_law_is_read(tmp_path, link, law):
    """Fails if the unit's power is lost, or the restitution is not that of the case."""
    plan = expand(study(tmp_path, link))
    (found,) = (one.links[0].law for one in plan.scenes.values() if one.links)
    assert type(found) is type(law)
    assert found.hertz_stiffness == pytest.approx(law.hertz_stiffness, rel=1e-12)
    assert getattr(found, "restitution", None) == getattr(law, "restitution", None)
    assert getattr(found, "damping_formula", None) == getattr(law, "damping_formula", None)


@pytest.mark.parametrize(
    ("link", "law"),
    [
        ("link: friction, stiffness: 100 kN/mm, slip_force: 200 kN", Friction(0.01, 1e8, 2e5)),
        ("link: maxwell, stiffness: 100 kN/mm, damping_coefficient: 2 MN s/m", Maxwell(0.01, 1e8, 2e6)),
        ("link: viscous, force_at_1_m_s: 1 MN, exponent: 0.3", Viscous(0.01, 1e6, 0.3)),
        ("link: viscous, force_at_1_m_s: 1 MN, exponent: 0.3, straight_below: 0.1 mm/s", Viscous(0.01, 1e6, 0.3, 1e-4)),
    ],
)
def test_a_damper_is_read(tmp_path, link, law):
    plan = expand(study(tmp_path, link))
    (found,) = (one.links[0].law for one in plan.scenes.values() if one.links)
    assert found == law


def test_friction_and_maxwell_are_as_stiff_as_a_storey_unless_given(tmp_path):
    for link in ("link: friction, slip_force: 200 kN", "link: maxwell, damping_coefficient: 2 MN s/m"):
        plan = expand(study(tmp_path, link))
        (scene,) = (one for one in plan.scenes.values() if one.links)
        assert scene.links[0].law.stiffness == max(building.stiffness.mean() for building in scene.buildings)


@pytest.mark.parametrize(
    ("link", "said"),
    [
        ("link: hertz", "'hertz_stiffness' is missing"),
        (f"link: hertz, {K}, stiffness: 1e9 N/m", "'stiffness' does not apply to link: hertz"),
        (f"link: hertz, {K}, restitution: 0.5", "'restitution' does not apply to link: hertz"),
        (f"link: hertz-damp, {K}, restitution: 0", "restitution is 0; it must be above 0"),
        (f"link: hertz-damp, {K}, restitution: 0.005", "restitution is 0.005; it must be at least 0.01"),
        ("link: hertz, hertz_stiffness: 2e9 N/m", "expected N/m^1.5"),
        (f"link: hertz-damp, {K}, damping_formula: kelvin", "write 'exact', 'muthukumar', 'ye' or 'jankowski'"),
        (f"link: bilinear, {K}, penetration: 5 mm, restitution: 0.1", "yield_share must be below 0.0198"),
        (f"link: bilinear, {K}", "'penetration' is missing"),
        ("link: damper", "'damping_coefficient' is missing"),
        ("link: maxwell", "'damping_coefficient' is missing"),
        ("link: maxwell, stiffness: 1e8 N/m, damping_coefficient: 1 N s/m", "write `link: damper`"),
        ("link: friction", "'slip_force' is missing"),
        ("link: friction, slip_force: 0 kN", "the slip force is 0 N; it must be above 0 N"),
        ("link: friction, slip_force: 200 kN/m", "expected N"),
        ("link: friction, slip_force: 200 kN, damping_ratio: 0.1", "'damping_ratio' does not apply to link: friction"),
        ("link: viscous, exponent: 0.3", "'force_at_1_m_s' is missing"),
        ("link: viscous, force_at_1_m_s: 1 MN, exponent: 0.05", "exponent is 0.05; it must be at least 0.1"),
        ("link: viscous, force_at_1_m_s: 1 MN, exponent: 2", "exponent is 2; it must be at least 0.1 and at most 1"),
        ("link: viscous, force_at_1_m_s: 1 MN, exponent: 0.3, stiffness: 1e8 N/m", "'stiffness' does not apply"),
        ("link: damper, damping_coefficient: 2e6 N/m", "expected N s/m"),
        ("link: damper, damping_coefficient: 2 MN s/m, stiffness: 3 kN/mm", "'stiffness' does not apply"),
        ("link: damper, damping_coefficient: 2 MN s/m, damping_ratio: 0.2", "'damping_ratio' does not apply"),
        (f"link: jankowski, {K}, damping_formula: ye", "damping_formula: 'ye' is none of a jankowski"),
        (f"link: pounding, {K}", "it belongs to a hertz and a hertz-damp and a jankowski and a bilinear"),
    ],
)
def test_what_does_not_fit_is_refused(tmp_path, link, said):
    with pytest.raises(InputError) as refused:
        expand(study(tmp_path, link))
    assert said in str(refused.value)


IMPACT = f"impact: {{{{law: LAW, restitution: 0.6, {K}, penetration: 2 mm}}}}\n"


def struck(tmp_path, law: str, case: str = "link: pounding", more: str = ""):
    """The links of a study whose impact element has a law."""
    text = (STUDY + IMPACT.replace("LAW", law)).format(link=case) + more
    (tmp_path / "study.yaml").write_text(text)
    plan = expand(load_study(tmp_path / "study.yaml"))
    return [scene.links for scene in plan.scenes.values() if scene.links]


@pytest.mark.parametrize(
    ("law", "expected"),
    [
        ("kelvin-voigt", "pounding"),
        ("hertz", Hertz(0.01, 2e3 * 1000**1.5)),
        ("jankowski", Jankowski(0.01, 2e3 * 1000**1.5, 0.6)),
        ("bilinear", BilinearContact(0.01, 2e3 * 1000**1.5, 0.002, 0.6)),
    ],
)
def test_the_law_of_the_impact_element_is_that_of_pounding(tmp_path, law, expected):
    """And of no other link. Fails if a parameter under `impact` does not reach the law, or if an infill gets it."""
    ((link,),) = struck(tmp_path, law)
    assert link.law.words == expected.words if law != "kelvin-voigt" else link.law.name == expected
    ((infill,),) = struck(tmp_path, law, "link: infill")
    assert (infill.law.name, infill.law.law) == ("infill", "continuous")
    ((one, other),) = struck(tmp_path, law, "link: [pounding, {link: damper, damping_coefficient: 1 MN s/m}]")
    assert (one.law, other.law.name) == (link.law, "damper")


def test_a_link_that_names_its_law_takes_what_stands_under_impact(tmp_path):
    """What stands in the case is nearer."""
    ((link,),) = struck(tmp_path, "kelvin-voigt", "link: jankowski")
    assert link.law == Jankowski(0.01, 2e3 * 1000**1.5, 0.6)
    ((link,),) = struck(tmp_path, "kelvin-voigt", "link: hertz, hertz_stiffness: 5 N/m^1.5")
    assert link.law == Hertz(0.01, 5.0)


def test_the_law_is_an_axis(tmp_path):
    more = "sweep: {impact.law: [kelvin-voigt, hertz, hertz-damp, jankowski, bilinear]}\n"
    names = [links[0].law.name for links in struck(tmp_path, "kelvin-voigt", more=more)]
    assert names == ["pounding", "hertz", "hertz-damp", "jankowski", "bilinear"]


def test_a_law_of_the_study_strikes(tmp_path):
    spring = "force: k*v, parameters: {k: 1 kN/mm}"
    more = f"laws: {{pad: {{{spring}}}, glue: {{{spring}, acts: always}}}}"
    ((link,),) = struck(tmp_path, "pad", more=more)
    assert (link.law.name, link.law.gap) == ("pad", 0.01)
    with pytest.raises(InputError, match=r"'glue' is not a law of contact\n.*jankowski, bilinear, pad"):
        struck(tmp_path, "glue", more=more)


@pytest.mark.parametrize(
    ("law", "case", "said"),
    [
        ("pounding", "link: pounding", "write kelvin-voigt, hertz"),
        ("infill", "link: pounding", "'infill' is not a law of contact"),
        (
            "hertz",
            "link: pounding, stiffness: 1 kN/mm",
            "'stiffness' does not apply to link: pounding of the law hertz",
        ),
        (
            "hertz",
            "link: pounding, restitution: 0.4",
            "'restitution' does not apply to link: pounding of the law hertz",
        ),
        ("[hertz]", "link: pounding", "law: a list is not known"),
    ],
)
def test_what_is_no_law_of_contact_is_refused(tmp_path, law, case, said):
    with pytest.raises(InputError, match=said):
        struck(tmp_path, law, case)


def test_a_missing_parameter_says_where_it_may_stand(tmp_path):
    (tmp_path / "study.yaml").write_text(STUDY.format(link="link: pounding") + "impact: {law: hertz}\n")
    with pytest.raises(InputError, match="a hertz needs it here or under `impact`: stiffness k_h"):
        load_study(tmp_path / "study.yaml")
