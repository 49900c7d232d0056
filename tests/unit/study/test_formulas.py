"""Laws that a study writes as formulas: what they give, what is refused and where, what depends on their text."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from pounding_cli.errors import InputError
from pounding_cli.laws.infill import Infill
from pounding_cli.laws.pounding import Pounding
from pounding_cli.laws.written import WrittenFilling, WrittenJoint, WrittenLaw
from pounding_cli.solve import solve
from pounding_cli.study import expand, load_study

STUDY = """\
records: {{use: [elcentro], duration: 3 s}}
buildings: {{stiff: {{storeys: 2, period: 0.3 s}}, soft: {{storeys: 2, period: 0.5 s}}}}
group: [stiff, soft]
impact: {{stiffness: 20 kN/mm}}
laws:
  rubber: {law}
cases: {{pad: {{link: rubber, gap: 5 cm}}}}
analyses: [elastic]
"""
INFILL = (
    '{force: "k*v + k3*v**3 + 2*xi*sqrt(m*(k + 3*k3*v**2))*r", acts: compression, '
    "parameters: {k: 10 kN/mm, k3: 1.3333333333333333e9 N/m^3, xi: 0.2}}"
)


def study(tmp_path, law: str, **changes: str):
    text = STUDY.format(law=law)
    for old, new in changes.values():
        assert old in text
        text = text.replace(old, new)
    path = tmp_path / "study.yaml"
    path.write_text(text)
    return load_study(path)


def scene_of(read):
    return next(scene for scene in expand(read).scenes.values() if scene.links)


def with_law(scene, law):
    return dataclasses.replace(scene, links=tuple(dataclasses.replace(link, law=law) for link in scene.links))


def peaks(run):
    columns = [getattr(b, name) for b in run.buildings for name in ("shear", "drift", "acceleration")]
    return np.concatenate([*columns, run.links.peak_force, run.links.max_closing, run.links.impulse])


def test_the_infill_as_a_formula(tmp_path):
    """Eq. (9), with the reduced mass m, equals the law that is built in. Fails if sqrt is another power, or m another
    mass."""
    scene = scene_of(study(tmp_path, INFILL))
    law = scene.links[0].law
    assert isinstance(law, WrittenFilling)
    own = solve(scene, 1e-10, "taylor")
    built_in = solve(with_law(scene, Infill(0.05, 1e7, 2e7, 0.2)), 1e-10, "taylor")
    assert 0.001 < own.links.max_closing.max() < 0.05
    assert peaks(own) == pytest.approx(peaks(built_in), rel=1e-9)
    assert own.energy["links"] == pytest.approx(built_in.energy["links"], rel=1e-9)
    assert abs(own.energy["residual"]) < 1e-10


def test_a_straight_formula_is_no_program(tmp_path):
    """Kelvin-Voigt across a gap, cut off where it would pull, equals `pounding`; it is solved as fast."""
    force = '{force: "k*v + c*r", parameters: {k: 2 MN/mm, c: 20 kN s/mm}, tension_cut: true}'
    scene = scene_of(study(tmp_path, force, gap=("5 cm", "5 mm")))
    law = scene.links[0].law
    assert not law.general
    left, right = (building.mass[0] for building in scene.buildings)
    ratio = 2e7 / 2 / (2e9 * left * right / (left + right)) ** 0.5
    own, built_in = solve(scene, 1e-10), solve(with_law(scene, Pounding(0.005, 2e9, ratio, True)), 1e-10)
    assert own.links.impacts.sum() > 0
    assert peaks(own) == pytest.approx(peaks(built_in), rel=1e-9)


@pytest.mark.parametrize("method", ["rk4-events", "newmark"])
def test_other_methods_run_it(tmp_path, method):
    scene = scene_of(study(tmp_path, INFILL, short=("3 s", "1 s")))
    exact, found = solve(scene, 1e-10, "taylor"), solve(scene, method=method, time_step=2e-4)
    rel = 1e-5 if method == "rk4-events" else 2e-3
    assert found.buildings[0].drift == pytest.approx(exact.buildings[0].drift, rel=rel)


def test_a_broken_power_of_the_closing(tmp_path):
    """v**1.5 is stepped in the root of v. Fails if it is expanded where it has no series."""
    force = '{force: "k*v**1.5*(1 + 0.2*r/u)", parameters: {k: 1e9 N/m^1.5, u: 1 m/s}}'
    scene = scene_of(study(tmp_path, force, gap=("5 cm", "5 mm")))
    assert scene.links[0].law.branches(1.0, 1.0)[1].regular == 2
    run, finer = (solve(scene, accuracy) for accuracy in (1e-6, 1e-11))
    assert run.links.impacts.sum() > 0
    assert peaks(run) == pytest.approx(peaks(finer), rel=1e-6)
    assert abs(run.energy["residual"]) < 1e-9


def test_powers_without_a_common_root_are_refused():
    with pytest.raises(ValueError, match=r"the powers of v, 1\.37, are not whole multiples"):
        WrittenLaw(0.01, "own", "k*v**1.37*d**-0.37", (("k", 1.0, (1.0, 0.0, -2.0)),))


def test_a_joint_acts_both_ways(tmp_path):
    scene = scene_of(study(tmp_path, '{force: "k*v + c*r", parameters: {k: 1 kN/mm, c: 1 MN s/m}, acts: always}'))
    assert isinstance(scene.links[0].law, WrittenJoint)
    assert scene.links[0].law.is_linear


def test_the_digest_depends_on_the_text(tmp_path):
    """Results of another formula are not taken over. Fails if a law is known by its name."""
    one, other, third = (
        dict(expand(study(tmp_path, law)).scenes)
        for law in (INFILL, INFILL.replace("2*xi", "2.0*xi"), INFILL.replace("10 kN/mm", "11 kN/mm"))
    )
    assert len(one.keys() & other.keys()) == len(one) - 1  # the buildings alone are shared
    assert len(one.keys() & third.keys()) == len(one) - 1


SWEEP = "sweep: {laws.rubber.parameters.k: [5 kN/mm, 10 kN/mm]}"


def test_a_parameter_is_swept(tmp_path):
    read = study(tmp_path, INFILL, sweep=("analyses:", f"{SWEEP}\nanalyses:"))
    laws = {scene.links[0].law.constants[0][1] for scene in expand(read).scenes.values() if scene.links}
    assert laws == {5e6, 1e7}


@pytest.mark.parametrize(
    ("law", "said"),
    [
        ('{force: "§k*v*v", parameters: {k: 1 kN/mm}}', "the formula gives kg m^2 s^-2, not N"),
        ('{force: "§k*v + k*r", parameters: {k: 1 kN/mm}}', "'k*v' is in N, 'k*r' in kg m s^-3"),
        ('{force: "k*v + §q*r", parameters: {k: 1 kN/mm}}', "'q' is not known"),
        ('{force: "k*v + §open(1)", parameters: {k: 1 kN/mm}}', "'open(1)' is not allowed in a formula"),
        ('{force: "§k.real*v", parameters: {k: 1 kN/mm}}', "'k.real' is not allowed in a formula"),
        ('{force: "k*v/§v*d", parameters: {k: 1 kN/mm}}', "'v' is not above zero at v = 0 m"),
        ('{force: "k*v + c*sqrt(§r*d)", parameters: {k: 1 kN/mm, c: 1 kN s/m}}', "'r*d' is not above zero"),
        ('{force: "k*v**§k", parameters: {k: 1 kN/mm}}', "the power 'k' is not a plain number"),
        ('{force: §k*v +, parameters: {k: 1 kN/mm}}', "'k*v +' is not a formula"),
        ('{force: "k*v", parameters: {k: §1 kX/mm}}', "'kX/mm' is not a unit"),
        ('{force: "k*v", parameters: {k: 1 kN/mm, §v: 3}}', "'v' cannot be a parameter"),
        ('{force: "§1e999*v"}', "'1e999' is not a finite number"),
        ('{force: "§k*v + f", acts: always, parameters: {k: 1 kN/mm, f: 3 kN}}', "the force at rest, v = r = 0, is"),
    ],
)  # fmt: skip
def test_what_is_refused_and_where(tmp_path, law, said):
    """Line and column are those of the part of the formula that is wrong."""
    lines = STUDY.format(law=law).splitlines()
    line = next(number for number, text in enumerate(lines) if "§" in text)
    column = lines[line].index("§")
    with pytest.raises(InputError) as refused:
        study(tmp_path, law.replace("§", ""))
    found = {(p.line, p.column): p.message for p in refused.value.problems}
    assert (line + 1, column + 1) in found
    assert said in found[line + 1, column + 1]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("link: rubber", "link: ruber"), "link: 'ruber' is not known"),
        (("link: rubber", "link: rubber, stiffness: 3 kN/mm"), "'stiffness' does not apply to link: rubber"),
        (("  rubber:", "  infill:"), "'infill' is a law of this program"),
    ],
)
def test_what_a_case_may_not_say(tmp_path, change, said):
    with pytest.raises(InputError, match=said):
        study(tmp_path, INFILL, change=change)


def test_a_list_takes_it(tmp_path):
    read = study(tmp_path, INFILL, link=("link: rubber", "link: [pounding, {link: rubber, floors: [2]}]"))
    assert [link.kind for link in scene_of(read).links] == ["pounding", "pounding", "rubber"]


@pytest.mark.parametrize(
    ("case", "said"),
    [
        ("{link: hertz, gap: 1 cm, K, by_floor: {1: {stiffness: 1 kN/mm}}}", "'stiffness' does not apply"),
        ("{link: pounding, gap: 1 cm, by_floor: {1: {slip_force: 3 kN}}}", "'slip_force' does not apply"),
        ("{link: pounding, gap: 1 cm, pairs: [{K}]}", "'hertz_stiffness' does not apply to link: pounding"),
        ("{link: hertz-damp, gap: 1 cm, K, damping_ratio: 0.2}", "a hertz-damp takes 'restitution'"),
        ("{link: jankowski, gap: 1 cm, K, by_floor: {1: {damping_ratio: 0.2}}}", "a jankowski takes 'restitution'"),
    ],
)  # fmt: skip
def test_keys_that_would_be_ignored_are_refused(tmp_path, case, said):
    """A key in a nearer mapping is said of the link there. Fails if it is passed over, or a damping ratio of Kelvin
    and Voigt is turned into the e of another law."""
    case = case.replace("K", "hertz_stiffness: 1e9 N/m^1.5")
    with pytest.raises(InputError, match=said):
        study(tmp_path, INFILL, cases=("{link: rubber, gap: 5 cm}", case))


def test_a_damping_ratio_of_the_impact_element_is_not_that_of_another_law(tmp_path):
    change = "impact: {stiffness: 20 kN/mm}", "impact: {stiffness: 20 kN/mm, damping_ratio: 0.2}"
    case = "{link: rubber, gap: 5 cm}", "{link: hertz-damp, gap: 1 cm, hertz_stiffness: 1e9 N/m^1.5}"
    with pytest.raises(InputError, match=r"write `restitution: 0\.527`"):
        study(tmp_path, INFILL, impact=change, case=case)


def test_keys_of_an_outer_mapping_stay(tmp_path):
    """What a case says of its own link is no word about the link elsewhere."""
    case = "{link: infill, gap: 5 cm, law: printed, stiffness: 1 kN/mm, floors: [2], elsewhere: pounding}"
    read = study(tmp_path, INFILL, case=("{link: rubber, gap: 5 cm}", case))
    assert [link.kind for link in scene_of(read).links] == ["pounding", "infill"]
