"""What converges in Fig. 8 and what does not, and what the paper's number is."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
import pytest

from pounding_cli.wall.analysis import strike
from pounding_cli.wall.model import Bond, Contact, Frame, Mesh, Over, Shape, Time, WallModel

NODE = Contact(Over.NODE, Bond.GLUED)


def model(size: float, shape: Shape = Shape.LINEAR, contact: Contact | None = None, growth: float = 0.0) -> WallModel:
    return WallModel(mesh=Mesh(size, growth, shape), contact=contact or Contact(), time=Time(end=0.02))


def test_stress_under_a_node_grows_without_bound():
    stresses = [strike(model(h, contact=NODE)).wall_stress / 1e6 for h in (1.0, 0.5, 0.25, 0.125)]
    assert stresses == pytest.approx([22, 34, 63, 122], rel=0.1)
    # Doubling at every halving: the stress under a point load goes as 1 / r.
    assert stresses[-1] / stresses[-2] > 1.8


def test_the_papers_stress_is_its_mesh_of_half_a_metre():
    found = strike(model(0.5, contact=NODE))
    assert found.wall_stress / 1e6 == pytest.approx(33, rel=0.05)
    assert found.peak_force / 1e6 == pytest.approx(6.0, abs=0.3)
    assert found.peak_time == pytest.approx(7e-3, abs=1e-3)


def test_force_over_a_patch_converges_to_one_per_cent():
    coarse, fine = (strike(model(h, Shape.QUADRATIC, growth=0.2)) for h in (0.1, 0.025))
    assert coarse.peak_force == pytest.approx(fine.peak_force, rel=2e-3)
    assert coarse.averaged_stress == pytest.approx(fine.averaged_stress, rel=0.02)
    linear = strike(model(0.0625))
    assert linear.peak_force == pytest.approx(fine.peak_force, rel=0.01)
    assert linear.averaged_stress == pytest.approx(fine.averaged_stress, rel=0.01)


def test_stress_under_a_patch_stays_below_its_pressure():
    found = strike(model(0.025, Shape.QUADRATIC, growth=0.2))
    pressure = found.peak_force / (0.2 * 0.25)
    assert 0.9 < found.wall_stress / pressure < 1.1


def test_averaged_stress_is_the_papers():
    assert strike(model(0.05, Shape.QUADRATIC, growth=0.2)).averaged_stress / 1e6 == pytest.approx(33, rel=0.05)


def test_quadratic_elements_reach_the_same_force_sooner():
    exact = strike(model(0.025, Shape.QUADRATIC, growth=0.2)).peak_force
    errors = {shape: [abs(strike(model(h, shape)).peak_force / exact - 1) for h in (0.5, 0.25)] for shape in Shape}
    assert np.all(np.array(errors[Shape.QUADRATIC]) < 0.2 * np.array(errors[Shape.LINEAR]))


@pytest.mark.parametrize("rho", [1.0, 0.9, 0.5])
def test_force_against_step_and_numerical_damping(rho):
    exact = strike(replace(model(0.5), time=Time(0.02, 5e-6, 1.0))).peak_force
    errors = []
    for step in (4e-4, 2e-4):
        found = strike(replace(model(0.5), time=Time(0.02, step, rho)))
        errors.append(abs(found.peak_force / exact - 1))
    assert errors[1] < 1e-3
    assert errors[1] < errors[0]


def test_bays_hardly_matter_for_the_peak():
    """The paper does not say where the first bay begins: here at the struck face."""
    face = replace(model(0.25, Shape.QUADRATIC), frame=Frame(bays=(3.0, 5.0, 5.0)))
    assert strike(face).peak_force == pytest.approx(strike(model(0.25, Shape.QUADRATIC)).peak_force, rel=0.02)


def test_half_a_metre_takes_under_two_seconds():
    began = time.process_time()
    strike(replace(model(0.5, Shape.QUADRATIC), time=Time()))
    assert time.process_time() - began < 2.0
