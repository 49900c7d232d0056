"""Building types of HAZUS: the numbers of the manual, buildings made from them, and how they are drawn."""

from __future__ import annotations

import numpy as np
import pytest

from pounding_cli import load_study
from pounding_cli.model.archetypes import (
    DAMAGE_STATES,
    DESIGNS,
    UNCERTAIN,
    draw_factors,
    find_archetype,
    first_mode_share,
    list_designs,
    list_types,
    stiffness_factor,
)

GRAVITY = 9.80665


def test_the_types_of_the_manual_at_their_design_levels():
    """36 types; those with infill and of unreinforced masonry were built to low codes or none."""
    assert len(list_types()) == 36
    two = {name for name in list_types() if list_designs(name) == DESIGNS[2:]}
    assert two == {"S5L", "S5M", "S5H", "C3L", "C3M", "C3H", "URML", "URMM"}
    assert all(list_designs(name) == DESIGNS for name in set(list_types()) - two)


def test_numbers_of_a_concrete_frame_of_high_code():
    """Five storeys of C1M, high-code, as a published generator of shear buildings has them."""
    frame = find_archetype("C1M", "high-code")
    assert frame.period_per_storey == pytest.approx(0.15)
    assert frame.yield_acceleration == 0.208
    assert frame.hardening == pytest.approx(0.133, abs=5e-4)
    assert frame.damping == 0.07
    assert list(frame.drift_limits.values()) == [0.0033, 0.0067, 0.02, 0.0533]
    assert frame.storey_height == 3.05
    assert frame.period(5) == pytest.approx(0.75)
    assert frame.base_shear(5) == pytest.approx(0.183, abs=5e-4)
    assert stiffness_factor(5) == pytest.approx(12.344, abs=5e-4)
    building = frame.build("theirs", 5, 200e3)
    assert building.stiffness == pytest.approx(np.full(5, 1.732634e8), rel=1e-6)


@pytest.mark.parametrize("name", list_types())
def test_tables_of_the_manual_agree_with_each_other(name):
    """Ay = gamma Cs / alpha1 within three digits of Cs, and of all but pre-codes the ductility of Table 5.6.

    Weaker designs are no stronger, and their damage begins no later.
    """
    found = [find_archetype(name, design) for design in list_designs(name)]
    for each in found:
        expected = each.gamma * each.design_strength / each.alpha1
        assert each.yield_acceleration == pytest.approx(expected, abs=1.1e-3 * each.gamma / each.alpha1)
        drifts = [each.drift_limits[state] for state in DAMAGE_STATES]
        assert drifts == sorted(drifts)
    strengths = [each.yield_acceleration for each in found]
    assert strengths == sorted(strengths, reverse=True)
    for state in DAMAGE_STATES:
        limits = [each.drift_limits[state] for each in found]
        assert limits == sorted(limits, reverse=True)


@pytest.mark.parametrize(("name", "design", "ductility"), [
    ("C1M", "high-code", 5.33), ("S1L", "high-code", 8.0), ("S4H", "high-code", 4.0), ("C1M", "moderate-code", 4.0),
    ("W1", "moderate-code", 6.0), ("C3M", "low-code", 3.3), ("URML", "pre-code", 5.0),
])  # fmt: skip
def test_ultimate_point_is_at_the_ductility_of_the_manual(name, design, ductility):
    """The displacement at the ultimate point is lambda mu times that at yield (Table 5.6)."""
    archetype = find_archetype(name, design)
    assert archetype.ultimate_ductility == pytest.approx(archetype.lambda_ * ductility, rel=0.015)


@pytest.mark.parametrize(("name", "design", "yielding", "ultimate"), [
    ("W1", "high-code", (0.48, 0.400), (11.51, 1.200)), ("W2", "moderate-code", (0.31, 0.200), (4.70, 0.500)),
    ("S1L", "high-code", (0.61, 0.250), (14.67, 0.749)), ("S1M", "pre-code", (0.44, 0.039), (5.33, 0.117)),
    ("S2H", "low-code", (1.94, 0.063), (9.68, 0.127)), ("S4L", "moderate-code", (0.19, 0.160), (2.59, 0.360)),
    ("S5M", "low-code", (0.34, 0.083), (2.27, 0.167)), ("C1M", "high-code", (1.15, 0.208), (18.44, 0.624)),
    ("C1M", "pre-code", (0.29, 0.052), (3.46, 0.156)), ("C2H", "high-code", (2.94, 0.254), (29.39, 0.635)),
    ("C3M", "pre-code", (0.26, 0.083), (1.95, 0.188)), ("PC1", "high-code", (0.72, 0.600), (11.51, 1.200)),
    ("PC2M", "moderate-code", (0.52, 0.167), (4.15, 0.333)), ("RM1M", "low-code", (0.35, 0.111), (2.31, 0.222)),
    ("RM2H", "moderate-code", (1.96, 0.169), (11.76, 0.338)), ("URMM", "pre-code", (0.27, 0.111), (1.81, 0.222)),
])  # fmt: skip
def test_capacity_curves_of_table_5_7(name, design, yielding, ultimate):
    """Yield and ultimate point in inches and g, as another program has them (steva44/Rts on github.com)."""
    archetype = find_archetype(name, design)
    (yield_displacement, yield_acceleration), (displacement, acceleration) = yielding, ultimate
    assert archetype.yield_acceleration == yield_acceleration
    assert archetype.lambda_ == pytest.approx(acceleration / yield_acceleration, rel=0.02)
    slope = (acceleration - yield_acceleration) / (displacement - yield_displacement)
    assert archetype.hardening == pytest.approx(slope * yield_displacement / yield_acceleration, rel=0.02)
    elastic = yield_acceleration * GRAVITY * (archetype.typical_period / (2 * np.pi)) ** 2 / 0.0254
    assert elastic == pytest.approx(yield_displacement, abs=0.02 + 0.01 * yield_displacement)


def test_the_building_yields_at_the_capacity_curve():
    """In its first mode the base shear at yield is that of an oscillator of the mode's mass at Ay, found by modes.

    Fails if the share of the mode is left out, or taken of another shape.
    """
    frame = find_archetype("C1M", "pre-code")
    building = frame.build("theirs", 6, 250e3)
    mass = np.diag(building.mass)
    values, modes = np.linalg.eig(np.linalg.solve(mass, building.stiffness_matrix))
    mode = modes[:, np.argmin(values)]
    modal_mass = (mode @ building.mass) ** 2 / (mode @ mass @ mode)
    assert building.yield_shear[0] == pytest.approx(frame.yield_acceleration * GRAVITY * modal_mass, rel=1e-9)
    assert first_mode_share(6) == pytest.approx(modal_mass / building.mass.sum(), rel=1e-9)
    assert 2 * np.pi / np.sqrt(values.min()) == pytest.approx(0.9, rel=1e-9)
    # the shears of forces that grow with the height
    above = np.cumsum(np.arange(1, 7)[::-1])[::-1] / 21
    assert building.yield_shear / building.yield_shear[0] == pytest.approx(above, rel=1e-9)


STUDY = {
    "records": {"use": ["elcentro"], "duration": "1 s"},
    "buildings": {"theirs": {"mass": "250 t", "archetype": {"type": "C1M", "design": "pre-code", "storeys": 6}}},
    "cases": {"near": {"link": "pounding", "gap": "4 cm"}},
    "group": ["theirs", "theirs"],
}


def study_with(**keys):
    theirs = {**STUDY["buildings"]["theirs"], **keys}
    return load_study({**STUDY, "buildings": {"theirs": theirs}})


def test_the_building_of_a_study_is_that_of_the_type():
    study = study_with()
    building = study.building((), 0)
    expected = find_archetype("C1M", "pre-code").build("theirs", 6, 250e3)
    for name in ("mass", "height", "stiffness", "yield_shear", "hardening", "alpha", "beta"):
        assert getattr(building, name) == pytest.approx(getattr(expected, name), rel=1e-9), name
    sample = {**STUDY["buildings"]["theirs"]["archetype"], "sample": 7}
    drawn = study_with(archetype=sample).building((), 0)
    factors = draw_factors(find_archetype("C1M", "pre-code").spreads, "theirs", 7, 30)
    expected = find_archetype("C1M", "pre-code").build("theirs", 6, 250e3, factors)
    for name in ("stiffness", "yield_shear", "alpha", "beta"):
        assert getattr(drawn, name) == pytest.approx(getattr(expected, name), rel=1e-9), name


@pytest.mark.parametrize(("keys", "period", "shear", "damping"), [
    ({"period": "0.62 s"}, 0.62, None, None),
    ({"stiffness": ["200 kN/mm"] * 6}, None, None, None),
    ({"yield_shear": ["900 kN"] * 6}, None, 900e3, None),
    ({"yield": {"base_shear": "0.10 W"}}, None, 0.10 * 6 * 250e3 * GRAVITY, None),
    ({"yield": {"overstrength": 2}}, None, 2 * 0.052 * GRAVITY * 6 * 250e3 * first_mode_share(6), None),
    ({"damping": "3 %"}, None, None, 0.03),
    ({"height": "2.9 m"}, None, None, None),
])  # fmt: skip
def test_what_is_known_stands_in_place_of_the_type(keys, period, shear, damping):
    """A measured value overrides one of the type and its dispersion, and nothing else."""
    study = study_with(**keys)
    building = study.building((), 0)
    archetype = find_archetype("C1M", "pre-code")
    if "stiffness" not in keys:
        assert building.periods[0] == pytest.approx(period or 0.9, rel=1e-9)
    expected = shear or 0.052 * GRAVITY * 6 * 250e3 * first_mode_share(6)
    assert building.yield_shear[0] == pytest.approx(expected, rel=1e-9)
    spec = study.spec.buildings["theirs"]
    assert spec.damping == (damping or archetype.damping)
    assert building.height[0] == (2.9 if "height" in keys else 3.05)
    from pounding_cli.study.vary.uncertain import list_seen_inputs

    known = {
        "period": {"period", "stiffness"} & keys.keys(),
        "yield.base_shear": "yield_shear" in keys or "base_shear" in keys.get("yield", {}),
        "damping": "damping" in keys,
    }
    expected_keys = [f"buildings.theirs.{key}" for key, is_known in known.items() if not is_known]
    assert [each.key for each in list_seen_inputs(study.tree)] == expected_keys


def test_drawn_buildings_are_a_latin_hypercube():
    """Of every quantity one in each of 30 equally likely parts, with the dispersion that is stated, apart by name."""
    spreads = find_archetype("C1M", "pre-code").spreads
    drawn = {name: [draw_factors(spreads, name, number, 30) for number in range(1, 31)] for name in ("a", "b")}
    for quantity in UNCERTAIN:
        logs = np.log([factors[quantity] for factors in drawn["a"]])
        assert np.mean(logs) == pytest.approx(0.0, abs=1e-12)
        assert np.std(logs) == pytest.approx(spreads[quantity], rel=1e-9)
        assert len(set(logs.round(9))) == 30
    periods, strengths = (np.log([factors[name] for factors in drawn["a"]]) for name in ("period", "strength"))
    assert abs(np.corrcoef(periods, strengths)[0, 1]) < 0.5
    assert [each["period"] for each in drawn["a"]] != [each["period"] for each in drawn["b"]]
    assert draw_factors(spreads, "a", 0, 30) == dict.fromkeys(UNCERTAIN, 1.0)
