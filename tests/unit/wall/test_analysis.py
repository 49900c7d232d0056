"""What is read off a transient: separation, reach, stresses of beams and of columns."""

from __future__ import annotations

import numpy as np
import pytest

from pounding_cli.wall.analysis import reach, separation, strike
from pounding_cli.wall.model import Bond, Contact, Frame, Mesh, Section, Time, WallModel

MESH = Mesh(0.5, 0.2)


def test_separation_lies_on_the_line_between_steps():
    time = np.arange(6) * 0.1
    assert separation(time, np.array([0, 2, 3, 1, -3, -4.0])) == pytest.approx(0.325)
    # Cut off at zero: the fall of the step before goes on.
    assert separation(time, np.array([0, 2, 3, 1, 0, 0.0])) == pytest.approx(0.35)
    assert np.isnan(separation(time, np.array([0, 1, 2, 3, 2, 1.0])))
    assert np.isnan(separation(time, np.zeros(6)))


def test_separation_of_a_glued_striker_is_that_of_a_free_one():
    free = strike(WallModel(mesh=MESH))
    glued = strike(WallModel(mesh=MESH, contact=Contact(bond=Bond.GLUED)))
    assert glued.separation == pytest.approx(free.separation, abs=2e-5)
    assert glued.transient.force.min() < 0
    fine = strike(WallModel(mesh=MESH, time=Time(step=1e-5)))
    assert free.separation == pytest.approx(fine.separation, abs=2e-5)


def test_reach():
    distance = np.array([1.0, 0.5, 0.0, 0.5, 1.0, 1.5])
    assert reach(distance, np.array([1.0, 3.0, 10.0, 8.0, 6.0, 2.0])) == pytest.approx(1.125)


def test_slender_columns_bend_with_little_stress():
    """Bending stress goes with the depth: slender columns are relieved, the beams are not."""
    usual = strike(WallModel(mesh=MESH))
    slender = strike(WallModel(mesh=MESH, frame=Frame(column=Section(0.6, 0.02))))
    assert slender.column_stress < 0.4 * usual.column_stress
    assert slender.beam_stress > 0.6 * usual.beam_stress
    assert slender.column_stress_then < 0.4 * usual.column_stress_then
    assert slender.beam_stress_then > 0.6 * usual.beam_stress_then


def test_resultants_follow_the_force():
    """Struck between two floors, the wall carries the force to both: their shears differ by the whole of it."""
    found = strike(WallModel(mesh=Mesh(0.25, 0.1), time=Time(end=found_peak_time())))
    below = found.shear[(found.row_height > 12.5) & (found.row_height < 13)].max()
    above = found.shear[(found.row_height > 14) & (found.row_height < 14.5)].max()
    assert below + above == pytest.approx(found.peak_force, rel=0.02)


def found_peak_time() -> float:
    return strike(WallModel(mesh=Mesh(0.25, 0.1))).peak_time
