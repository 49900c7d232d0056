"""The pieces that one-step and implicit methods are made of."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from numba import njit

from pounding_cli.kernels import cholesky, hermite
from pounding_cli.kernels import link_force as link_forces
from pounding_cli.laws import link_laws
from pounding_cli.laws.infill import Infill
from pounding_cli.model.building import Building
from pounding_cli.model.foundation import Foundation
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Analysis, Scene
from pounding_cli.records import Motion
from pounding_cli.solve.arrays import pack
from pounding_cli.solve.linear import central_difference_limit, matrices, runge_kutta_limit, with_links
from pounding_cli.solve.method import steps_a_sample
from tests.reference.modes import matrices as building_matrices


def called(piece):
    """A piece of a kernel in a kernel of its own, which Python may call."""

    @njit
    def kernel(*arguments):
        return piece(*arguments)

    return kernel


held_force, held_force_rate = map(called, (link_forces.held_force, link_forces.held_force_rate))
link_force = called(link_forces.link_force)
factorise, solve, cubic, quintic = map(called, (cholesky.factorise, cholesky.solve, hermite.cubic, hermite.quintic))

STILL = Motion("still", 0.01, np.zeros(3))


def tower(foundation: Foundation | None = None) -> Building:
    """Three unlike storeys with both kinds of damping."""
    return Building(
        "tower", [2e5, 1.5e5, 1e5], [4.0, 3.0, 3.5], [3e8, 2e8, 1e8], [1e6] * 3, [0.05] * 3, 0.3, 0.002, foundation
    )


def law_of(kind: str, gap: float, stiffness: float, impact: float):
    more = {"impact_stiffness": impact} if kind == "infill" else {}
    return link_laws()[kind](gap=gap, stiffness=stiffness, damping_ratio=0.2, **more)


def oscillator(alpha: float = 0.0, beta: float = 0.0) -> Building:
    return Building("one", [1e5], [3.0], [1e5 * 20.0**2], [np.inf], [0.0], alpha, beta)


def test_quintic_returns_a_polynomial_of_its_degree():
    """u, u', u'' of both ends of 1 - 2 t + 3 t^2 + t^3 - 4 t^4 + 2 t^5. Fails if h is left out of a derivative."""
    p = np.polynomial.Polynomial([1.0, -2.0, 3.0, 1.0, -4.0, 2.0])
    h = 0.7
    c = np.zeros(6)
    quintic(
        c, h, *(p.deriv(k)(0.0) if k else p(0.0) for k in range(3)), *(p.deriv(k)(h) if k else p(h) for k in range(3))
    )
    assert c == pytest.approx(p.coef * h ** np.arange(6), rel=1e-12)


def test_cubic_returns_a_polynomial_of_its_degree():
    """f and f' of both ends of 2 + t - 5 t^2 + 3 t^3."""
    p = np.polynomial.Polynomial([2.0, 1.0, -5.0, 3.0])
    h, c = 0.4, np.zeros(4)
    cubic(c, h, p(0.0), p.deriv()(0.0), p(h), p.deriv()(h))
    assert c == pytest.approx(p.coef * h ** np.arange(4), rel=1e-12)


def test_cholesky_against_numpy():
    """A random positive definite system; one with a negative eigenvalue is told. Fails if a sum starts one late."""
    rng = np.random.default_rng(3)
    root = rng.normal(size=(9, 9))
    matrix, right = root @ root.T + np.eye(9), rng.normal(size=9)
    a, x = matrix.ravel().copy(), right.copy()
    assert factorise(a, 9)
    solve(a, 9, x)
    assert x == pytest.approx(np.linalg.solve(matrix, right), rel=1e-10)
    assert not factorise((matrix - 2 * np.linalg.eigvalsh(matrix)[-1] * np.eye(9)).ravel().copy(), 9)


@pytest.mark.parametrize(
    ("kind", "branch", "v"),
    [
        ("pounding", 1, 0.003),
        ("connector", 0, -0.01),
        ("infill", 1, 0.02),
        ("infill", 2, 0.06),
    ],
)
@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_rate_of_a_held_force(kind, branch, v, scale):
    """Against a central difference along v(t), over six decades of stiffness; the force is that of the free law. Fails
    if the infill's dashpot is taken as constant."""
    link = Link(0, 1, 1, law_of(kind, 0.05, 2e8 * scale, 2e10 * scale))
    links = pack(Scene((tower(), tower()), (link,), STILL, Analysis.ELASTIC)).links
    rate, acceleration, dt = 0.4, -30.0, 1e-6
    branch += links.first[0]
    assert held_force(links, branch, v, rate) == pytest.approx(link_force(links, 0, v, rate), rel=1e-14)
    before, after = (
        held_force(links, branch, v + rate * t + 0.5 * acceleration * t**2, rate + acceleration * t) for t in (-dt, dt)
    )
    assert held_force_rate(links, branch, v, rate, acceleration) == pytest.approx((after - before) / (2 * dt), rel=1e-6)


@pytest.mark.parametrize(
    "foundation",
    [
        None,
        Foundation(3e5, 1e9, 2e7, 1e7, 5e10, 3e8),
        Foundation(3e5, 1e9, 2e7, rocks=False),
        Foundation(inertia=1e7, rocking_stiffness=5e10, rocking_damping=3e8, sways=False),
    ],
    ids=["fixed", "both", "sways", "rocks"],
)
def test_matrices_against_the_building(foundation):
    """From the arrays of the kernels as from T^T K T of the model. Fails if drag misses the base."""
    building = tower(foundation)
    arrays = pack(Scene((building,), (), STILL, Analysis.ELASTIC))
    mine, theirs = matrices(arrays), building_matrices(building)
    moving = [slot for slot in (arrays.bases[0], arrays.rocks[0]) if slot >= 0]
    wanted = [*range(*arrays.floors[0].indices(arrays.padded)), *moving]
    here = np.searchsorted(mine.slots, wanted)
    assert sorted(here) == list(range(mine.mass.size))
    scale = np.ones(mine.mass.size)  # theirs is the angle, mine the displacement of the roof by it
    if arrays.rocks[0] >= 0:
        scale[-1] = building.elevation[-1]
    both = np.outer(scale, scale)
    assert np.diag(mine.mass[here] * scale**2) == pytest.approx(theirs.mass)
    assert mine.stiffness[np.ix_(here, here)] * both == pytest.approx(theirs.stiffness, rel=1e-12, abs=1.0)
    assert mine.damping[np.ix_(here, here)] * both == pytest.approx(theirs.damping, rel=1e-12, abs=1e-3)
    assert mine.loaded[here] == pytest.approx(theirs.loaded)


def test_links_stiffen_the_scene_as_far_as_they_can():
    """An infill counts with the impact stiffness it ends at. Fails if s_mat is taken."""
    link = Link(0, 3, 3, Infill(0.05, 1e8, 2e10, 0.1))
    arrays = pack(Scene((tower(), tower()), (link,), STILL, Analysis.ELASTIC))
    system = matrices(arrays)
    damping, stiffness = with_links(arrays, system)
    assert stiffness[2, 5] - system.stiffness[2, 5] == pytest.approx(-2e10)
    assert damping[2, 2] - system.damping[2, 2] == pytest.approx(2 * 0.1 * np.sqrt(2e10 * 5e4))


def test_stability_limits_in_closed_form():
    """2 / omega and 2 sqrt(2) / omega without damping; with it 2 (sqrt(1 + 4 xi^2) - 2 xi) / omega."""
    undamped = pack(Scene((oscillator(),), (), STILL, Analysis.ELASTIC))
    assert central_difference_limit(undamped) == pytest.approx(2 / 20, rel=1e-12)
    assert runge_kutta_limit(undamped) == pytest.approx(2 * np.sqrt(2) / 20, rel=1e-6)
    damped = pack(Scene((oscillator(beta=2 * 0.3 / 20),), (), STILL, Analysis.ELASTIC))
    assert central_difference_limit(damped) == pytest.approx(2 * (np.sqrt(1.36) - 0.6) / 20, rel=1e-12)


@pytest.mark.parametrize(("step", "parts"), [(0.01, 1), (0.02, 1), (0.005, 2), (0.00501, 2), (0.004, 3), (1e-4, 100)])
def test_steps_divide_the_sample(step, parts):
    """The fewest equal parts that are no longer than asked. Fails if 0.01 / 1e-4 becomes 101."""
    scene = dataclasses.replace(Scene((tower(),), (), STILL, Analysis.ELASTIC))
    assert steps_a_sample(scene, step) == parts
