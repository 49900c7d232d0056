"""The integrator against closed forms: a striker on a spring, and on a spring in front of a mass."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp

from pounding_cli.wall.assembly import System
from pounding_cli.wall.model import Bond, Concrete, Mesh, Striker, WallModel
from pounding_cli.wall.transient import integrate, natural_step

K1, K2, M2 = 4e8, 1.5e8, 3e5
STRIKER = Striker(mass=2e5, speed=0.5)


def system(stiffness, mass):
    n = len(mass)
    push = np.zeros(n)
    push[0] = 1.0
    empty = sp.csr_matrix((0, n))
    return System(sp.csc_matrix(np.array(stiffness, dtype=float)), np.array(mass, dtype=float), push, empty, empty, 0)


def on_a_spring(step, rho, bond=Bond.UNILATERAL, end=0.12):
    return integrate(system([[K1]], [0.0]), STRIKER, bond, end, step, rho)


def before_a_mass(step, rho, end=0.04):
    return integrate(system([[K1, -K1], [-K1, K1 + K2]], [0.0, M2]), STRIKER, Bond.GLUED, end, step, rho)


def exact_force(t):
    """Modal solution of striker and mass joined by K1, the mass on K2."""
    m = np.diag([STRIKER.mass, M2])
    k = np.array([[K1, -K1], [-K1, K1 + K2]])
    half = np.diag(1 / np.sqrt(np.diag(m)))
    squares, shapes = np.linalg.eigh(half @ k @ half)
    modes = half @ shapes
    start = modes.T @ m @ np.array([STRIKER.speed, 0.0])
    w = np.sqrt(squares)
    x, y = modes @ (start[:, None] / w[:, None] * np.sin(np.outer(w, t)))
    return K1 * (x - y)


def test_striker_on_a_spring():
    run = on_a_spring(1e-5, 1.0)
    w = np.sqrt(K1 / STRIKER.mass)
    assert run.force.max() == pytest.approx(0.5 * np.sqrt(K1 * STRIKER.mass), rel=1e-5)
    assert run.velocity[-1] == pytest.approx(-0.5, rel=1e-5)
    last = run.time[np.flatnonzero(run.force > 0)[-1]]
    assert last == pytest.approx(np.pi / w, abs=2e-5)


def test_glued_striker_swings():
    run = on_a_spring(1e-5, 1.0, Bond.GLUED)
    w = np.sqrt(K1 / STRIKER.mass)
    assert run.force == pytest.approx(
        0.5 * np.sqrt(K1 * STRIKER.mass) * np.sin(w * run.time), abs=2e-4 * run.force.max()
    )


@pytest.mark.parametrize("rho", [1.0, 0.9, 0.5])
def test_second_order(rho):
    steps = np.array([4e-4, 2e-4, 1e-4])
    errors = []
    for step in steps:
        run = before_a_mass(step, rho)
        errors.append(np.abs(run.force - exact_force(run.time)).max() / run.force.max())
    rate = np.polyfit(np.log(steps), np.log(errors), 1)[0]
    assert rate == pytest.approx(2.0, abs=0.1)
    assert errors[-1] < 2e-4


def test_energy_is_kept_without_numerical_damping():
    run = before_a_mass(1e-4, 1.0)
    total = run.striker_energy + run.kinetic_energy + run.strain_energy
    assert total == pytest.approx(total[0], rel=1e-11)
    damped = before_a_mass(4e-3, 0.3)
    lost = damped.striker_energy + damped.kinetic_energy + damped.strain_energy
    assert lost[-1] < 0.99 * lost[0]


def test_unilateral_force_never_pulls_and_the_gap_never_closes_through():
    # With K2 the mass comes back to the striker: it strikes more than once.
    heavy = Striker(mass=6e5, speed=0.5)
    run = integrate(system([[K1, -K1], [-K1, K1 + K2]], [0.0, M2]), heavy, Bond.UNILATERAL, 0.4, 2e-5, 0.9)
    assert run.force.min() == 0.0
    gap = run.indentation - run.position
    assert gap.min() > -1e-12
    assert np.abs(run.force * gap).max() < 1e-6 * run.force.max() * np.abs(gap).max()
    assert np.diff((run.force > 0).astype(int)).clip(0).sum() >= 2


def test_impulse_is_the_change_of_momentum():
    run = before_a_mass(1e-4, 1.0)
    assert np.trapezoid(run.force, run.time) == pytest.approx(2e5 * (0.5 - run.velocity[-1]), rel=1e-10)


def test_natural_step():
    """A hundredth of the half period of a striker on a spring; half an element for the wave of a wall with mass."""
    spring = system([[K1]], [0.0])
    light = WallModel(striker=Striker(mass=100.0))
    assert natural_step(spring, light) == pytest.approx(np.pi * np.sqrt(100.0 / K1) / 100)
    assert natural_step(spring, WallModel()) == 1e-4
    dense = WallModel(mesh=Mesh(0.25), concrete=Concrete(young=30e9, poisson=0.0, density=3000.0))
    assert natural_step(spring, dense) == pytest.approx(0.5 * 0.25 / np.sqrt(1e7))
