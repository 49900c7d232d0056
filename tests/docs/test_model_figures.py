"""The loops in the figures of docs/theory.md are those of the laws."""

from __future__ import annotations

import runpy

import numpy as np
import pytest
from pages import ROOT


@pytest.fixture(scope="module")
def script():
    return runpy.run_path(str(ROOT / "docs" / "figures" / "model.py"))


def test_a_bilinear_loop_stays_within_its_yield_lines_and_reaches_them(script):
    """Fails if drifts or shears are divided by something else than those at the yield."""
    drift, shear = script["loop_of_storey"](script["storey_laws"]()["bilinear"])
    above, below = 0.95 + 0.05 * drift, -0.95 + 0.05 * drift
    assert (shear < above + 1e-9).all()
    assert (shear > below - 1e-9).all()
    assert np.isclose(shear, above, atol=1e-9).sum() > 50
    assert np.isclose(shear, below, atol=1e-9).sum() > 50


@pytest.mark.parametrize(("name", "pulls"), [("pounding", True), ("pounding, tension cut", False)])
def test_a_loop_of_contact_begins_at_the_gap(script, name, pulls):
    """Fails if the gap is not subtracted, or if the loop goes beyond one contact."""
    closing, force = script["loop_of_link"](script["LINKS"][name])
    assert closing[1] == pytest.approx(0.0, abs=0.02 * closing.max())
    assert (force[1:-1] != 0.0).all()
    assert (force.min() < 0.0) == pulls
