"""Quantities: units in, SI numbers out, by conversion factors that stand in the SI brochure."""

from __future__ import annotations

import math
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic_core import PydanticCustomError

from pounding_cli.records.motion import GRAVITY
from pounding_cli.study import units
from pounding_cli.study.rules import StiffnessRule, read_stiffness

NUMBER = units.Quantity("number", "", "0.05")


@pytest.mark.parametrize(
    ("quantity", "text", "value"),
    [
        (units.GAP, "5 cm", 0.05),
        (units.GAP, "5cm", 0.05),
        (units.GAP, "50 mm", 0.05),
        (units.GAP, "2 in", 0.0508),
        (units.GAP, "1/2 ft", 0.1524),
        (units.GAP, 0.05, 0.05),
        (units.GAP, "0.05", 0.05),
        (units.MASS, "200 t", 2e5),
        (units.MASS, "200 kg", 200.0),
        (units.MASS, "3 kN s2/m", 3000.0),
        (units.TIME, "0.36 s", 0.36),
        (units.TIME, "10 ms", 0.01),
        (units.STIFFNESS, "1e10 N/m", 1e10),
        (units.STIFFNESS, "20 kN/mm", 2e7),
        (units.STIFFNESS, "2 MN/m", 2e6),
        (units.FORCE, "900 kN", 9e5),
        (units.ACCELERATION, "0.35 g", 0.35 * 9.80665),
        (units.ACCELERATION, "350 cm/s2", 3.5),
        (units.ACCELERATION, "3.5 m/s^2", 3.5),
        (units.ACCELERATION, "350 Gal", 3.5),
        (NUMBER, "5 %", 0.05),
        (NUMBER, "5%", 0.05),
        (NUMBER, "1/3", 1 / 3),
        (NUMBER, "1e-6", 1e-6),
        (NUMBER, " .5 ", 0.5),
    ],
)
def test_reads(quantity, text, value):
    assert quantity.read(text) == pytest.approx(value, rel=1e-14)


def test_common_units_are_what_pint_makes_of_them():
    """To the last bit, so that it does not matter which way a number was read; gravity is the program's own (`g` is a
    gram to pint)."""
    for si, factors in units._COMMON.items():
        for unit, factor in factors.items():
            if unit != "g":
                assert units._converted(unit, si) == factor, unit


def test_a_study_in_common_units_does_without_pint():
    """Fails if something else on the way of a run loads it: a quarter of a second."""
    read = "from pounding_cli.study import expand, load_study; expand(load_study('configs/fig6.yaml'))"
    code = f"import sys; {read}; sys.exit('pint' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], cwd=Path(__file__).parents[3]).returncode == 0


def test_gravity_is_that_of_the_records():
    assert units.GRAVITY == GRAVITY


@pytest.mark.parametrize("text", ["5 g", "5 t", "5 %", "5 N", "5 m2", "5 s", "1/m"])
def test_length_in_another_dimension_is_refused(text):
    with pytest.raises(PydanticCustomError):
        units.LENGTH.read(text)


def test_mass_in_grams_is_not_gravity():
    """`g` is standard gravity in an acceleration only."""
    assert units.MASS.read("5 g") == pytest.approx(0.005)


@given(st.floats(1e-6, 9.0), st.sampled_from([("m", 1.0), ("cm", 0.01), ("mm", 0.001)]))
def test_any_number_comes_back(number, unit):
    assert units.GAP.read(f"{number!r} {unit[0]}") == pytest.approx(number * unit[1], rel=1e-12)


@given(st.text(max_size=20))
def test_junk_is_read_or_refused(text):
    for read in (units.GAP.read, NUMBER.read, units.ACCELERATION.read, read_stiffness):
        try:
            found, hint = read(text), "read"
        except PydanticCustomError as refused:
            found, hint = 0.0, (refused.context or {}).get("hint")
        assert hint
        assert isinstance(found, StiffnessRule) or math.isfinite(found)


@pytest.mark.parametrize(
    ("text", "rule"),
    [
        ("20 x stiffest storey", StiffnessRule(20.0, "stiffest")),
        ("20x stiffest storey", StiffnessRule(20.0, "stiffest")),
        ("20 × stiffest storey of soft", StiffnessRule(20.0, "stiffest", "soft")),
        ("1/5 mean storey of stiff", StiffnessRule(0.2, "mean", "stiff")),
        ("0.2 x mean story of stiff tower", StiffnessRule(0.2, "mean", "stiff tower")),
        ("20 % mean storey", StiffnessRule(0.2, "mean")),
        ("mean storey", StiffnessRule(1.0, "mean")),
    ],
)
def test_stiffness_rules(text, rule):
    assert read_stiffness(text) == rule
    assert read_stiffness(str(rule)) == rule
