"""The UBC's forces and displacements, against numbers worked out from its clauses by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pounding_cli.model.code_design import EDITIONS, UbcDesign, code_separation
from pounding_cli.model.stiffness import stiffness_for_period

G = 9.80665
MASS, HEIGHT = np.full(5, 2e5), np.full(5, 3.0)


@pytest.mark.parametrize(
    ("design", "period", "expected"),
    [
        (UbcDesign(1991, 0.4), 0.36, 0.4 * 2.75 / 12),  # C = 2.96, cut at 2.75
        (UbcDesign(1991, 0.4), 0.60, 0.4 * 1.5 / 0.60 ** (2 / 3) / 12),
        (UbcDesign(1988, 0.3, soil=1.5, importance=1.25, rw=8), 2.0, 0.3 * 1.25 * 1.875 / 2 ** (2 / 3) / 8),
        (UbcDesign(1994, 0.4), 3.0, 0.4 * 0.075),  # C / Rw = 0.060, raised to 0.075
        (UbcDesign(1985, 1.0, soil=1.2, k=1.0), 0.60, 1.2 / (15 * math.sqrt(0.6))),
        (UbcDesign(1985, 1.0, soil=1.0, k=0.67), 0.10, 0.67 * 0.12),  # C = 0.211, cut at 0.12
        (UbcDesign(1985, 0.75, soil=1.5, k=1.0), 0.30, 0.75 * 0.14),  # C S = 0.18, cut at 0.14
    ],
)
def test_base_shear_coefficient(design, period, expected):
    """Fails if any of the four bounds is dropped."""
    assert design.base_shear_coefficient(period) == pytest.approx(expected, rel=1e-12)


def test_base_shear_of_the_paper_s_buildings():
    """V/W 0.092 and 0.070 in zone 4 on soil S = 1.2, the lower bound far away. Fails with T^(3/2)."""
    design = UbcDesign(1991, 0.4)
    assert round(design.base_shear_coefficient(0.36), 3) == 0.092
    assert round(design.base_shear_coefficient(0.60), 3) == 0.070
    assert design.base_shear_coefficient(2.14) > 0.4 * 0.075 == design.base_shear_coefficient(2.16)


@pytest.mark.parametrize("edition", EDITIONS)
def test_storey_shears_below_the_top_force_s_period(edition):
    """With equal floors, F_j = V j / 15 on five floors. Fails if the sum runs from the ground up."""
    design = UbcDesign(edition, 0.4)
    base = design.base_shear_coefficient(0.6) * G * 1e6
    assert design.yield_shears(MASS, HEIGHT, 0.6) == pytest.approx(base * np.array([15, 14, 12, 9, 5]) / 15, rel=1e-12)


@pytest.mark.parametrize(("period", "share"), [(0.7, 0.0), (1.0, 0.07), (4.0, 0.25)])
def test_top_force(period, share):
    """F_t = 0.07 T V above 0.7 s and at most V / 4; the rest by w_x h_x. Fails if the bound is dropped."""
    design = UbcDesign(1991, 0.4)
    base = design.base_shear_coefficient(period) * G * 1e6
    shears = design.yield_shears(MASS, HEIGHT, period)
    assert shears[-1] == pytest.approx(base * (share + (1 - share) / 3), rel=1e-12)
    assert shears[0] == pytest.approx(base, rel=1e-12)


@given(st.lists(st.tuples(st.floats(1e3, 1e6), st.floats(2, 6)), min_size=1, max_size=20), st.floats(0.1, 5))
def test_the_base_carries_the_base_shear(floors, period):
    """Fails if the top force is added on top of V."""
    mass, height = map(np.array, zip(*floors, strict=True))
    design = UbcDesign(1994, 0.3)
    shears = design.yield_shears(mass, height, period)
    assert shears[0] == pytest.approx(design.base_shear_coefficient(period) * G * mass.sum(), rel=1e-12)
    assert (np.diff(shears) < 0).all()


def test_separation_of_the_paper_s_pair():
    """The paper says "approximately 7 cm" (parametric studies). Fails with the amplification 3 Rw / 4."""
    design = UbcDesign(1991, 0.4)
    displacements = []
    for period in (0.36, 0.60):
        k = stiffness_for_period(MASS, period, 1 / 3)
        found = design.design_displacements(MASS, HEIGHT, k, period)
        # Second way: the flexibility of the whole building, K u = F, times 3 Rw / 8 = 4.5.
        above = np.append(k[1:], 0.0)
        matrix = np.diag(k + above) - np.diag(above[:-1], 1) - np.diag(above[:-1], -1)
        forces = design.base_shear_coefficient(period) * G * 1e6 * np.arange(1, 6) / 15
        assert found == pytest.approx(4.5 * np.linalg.solve(matrix, forces), rel=1e-10)
        displacements.append(found)
    assert round(code_separation(*displacements)[-1], 3) == 0.069


def test_separation_in_1985_amplifies_by_three_over_k():
    """Fails with 1 / K."""
    design = UbcDesign(1985, 1.0, k=0.8)
    k = np.full(5, 5e8)
    expected = 3 / 0.8 * np.cumsum(design.yield_shears(MASS, HEIGHT, 0.5) / k)
    assert design.design_displacements(MASS, HEIGHT, k, 0.5) == pytest.approx(expected, rel=1e-12)


def test_separation_stands_at_common_floors_only():
    """Fails if the taller building's roof is taken."""
    assert code_separation([0.01, 0.02], [0.01, 0.03, 0.09]).tolist() == pytest.approx([0.02, 0.05])


@pytest.mark.parametrize(
    ("call", "word"),
    [
        (lambda: UbcDesign(1997, 0.4), "1985, 1988, 1991, 1994"),
        (lambda: UbcDesign(1991, 4), "not its number"),
        (lambda: UbcDesign(1991, 0.0), "Z is 0"),
        (lambda: UbcDesign(1991, 0.4, rw=-12), "Rw"),
        (lambda: UbcDesign(1985, 0.4, k=math.nan), "K is nan"),
        (lambda: UbcDesign(1991, 0.4).base_shear_coefficient(0.0), "period"),
        (lambda: UbcDesign(1991, 0.4).yield_shears([1.0, 1.0], [3.0], 0.5), "one value of each"),
        (lambda: UbcDesign(1991, 0.4).yield_shears([-1.0], [3.0], 0.5), "mass"),
    ],
)
def test_impossible_design_is_refused(call, word):
    with pytest.raises(ValueError, match=word):
        call()
