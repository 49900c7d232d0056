"""P-Delta: closed forms of one storey, the overturning of rocking bases, every method, an independent integrator."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from pounding_cli.laws.peak_oriented import PeakOriented
from pounding_cli.model.building import Building, UnstableError, weight_above
from pounding_cli.model.foundation import Foundation
from pounding_cli.model.scene import Scene
from pounding_cli.solve import METHODS, solve
from pounding_cli.solve.assess import assess, difference
from pounding_cli.solve.histories import history
from tests.helpers.scenes import (
    ELASTIC,
    FOUNDATION,
    INELASTIC,
    leaning,
    links,
    oscillator,
    shake,
    shear_building,
    standing,
    still,
)
from tests.reference.agreement import agree
from tests.reference.rows import islands_equal_the_whole, row_of_ten, weaker

M, K, H, VY, A = 2e5, 2e7, 3.0, 3e5, 0.05
OMEGA = np.sqrt(K / M)


@pytest.mark.parametrize("theta", [0.1, 0.5, 0.99])
@pytest.mark.parametrize("method", METHODS)
def test_period(method, theta):
    """T' = T / sqrt(1 - theta), by every method. Fails if one of them leaves P-Delta out, or takes h for P / h."""
    scene = Scene((leaning(oscillator(M, K), theta),), (), still(1.0), ELASTIC)
    begin = [[0.01]], [[0.0]]
    if METHODS[method].takes_step:
        run = solve(scene, method=method, time_step=2e-4, initial=begin)
        tolerance = 2e-3
    else:
        run = solve(scene, 1e-12, method, initial=begin)
        tolerance = 1e-10
        assert abs(run.energy["residual"]) < 1e-11
        assert run.energy["input"] == pytest.approx(0.5 * K * (1 - theta) * 1e-4, rel=1e-12)
    phase = OMEGA * np.sqrt(1 - theta) * 1.0
    (u, v) = run.final[0]
    assert u[0] == pytest.approx(0.01 * np.cos(phase), abs=0.01 * tolerance)
    assert v[0] == pytest.approx(-0.01 * OMEGA * np.sqrt(1 - theta) * np.sin(phase), abs=0.01 * OMEGA * tolerance)


def throw(theta: float, speed: float, duration: float = 1.0):
    """An undamped bilinear storey thrown from rest."""
    scene = Scene((leaning(oscillator(M, K, 0.0, VY, A), theta),), (), still(duration), INELASTIC)
    return solve(scene, 1e-12, initial=([[0.0]], [[speed]]))


def test_slope_after_yield():
    """The drift of a throw by its energies, with slope (a - theta) k after the yield; the shear is the law's. Fails if
    P-Delta is part of the storey's shear, or ends at the yield."""
    theta, speed, dy = 0.2, 0.25, VY / K
    run = throw(theta, speed)
    # m v^2 / 2 = Vy dy / 2 + plateau (D - dy) + a k (D^2 - dy^2) / 2 - theta k D^2 / 2
    plateau = (1 - A) * VY
    rest = 0.5 * VY * dy - plateau * dy - 0.5 * A * K * dy**2 - 0.5 * M * speed**2
    expected = min(np.roots([0.5 * (A - theta) * K, plateau, rest]).real)
    assert run.buildings[0].drift[0] == pytest.approx(expected, rel=1e-11)
    assert run.buildings[0].shear[0] == pytest.approx(plateau + A * K * expected, rel=1e-11)
    assert run.buildings[0].ductility[0] == pytest.approx(expected / dy, rel=1e-11)
    assert abs(run.energy["residual"]) < 1e-11


def test_no_resistance_left():
    """At D (1 - a) / (theta - a) a pushed storey has no resistance left: what comes so far with speed goes on. Fails if
    the weight acts on another arm than the storey's height."""
    theta, dy = 0.25, VY / K
    limit = dy * (1 - A) / (theta - A)
    energy = 0.5 * VY * dy + (1 - A) * VY * (limit - dy) + 0.5 * A * K * (limit**2 - dy**2) - 0.5 * theta * K * limit**2
    speed = np.sqrt(2 * energy / M)
    back, on = throw(theta, speed * (1 - 1e-7), 4.0), throw(theta, speed * (1 + 1e-7), 4.0)
    assert limit * 0.999 < back.buildings[0].displacement_max[0] < limit
    assert on.buildings[0].displacement_max[0] > 3 * limit
    assert on.final[0][1][0] > 0.0


def test_rocking_base_overturns():
    """A rigid column on a rocking spring is an inverted pendulum: w^2 = (kphi - W h) / (I + m h^2). Fails if the weight
    acts on the storey's own drift alone."""
    stiff, inertia, spring = 1e14, 1e6, 2e7
    base = Foundation(inertia=inertia, rocking_stiffness=spring, sways=False)
    weight = weight_above(np.array([M]))
    column = Building("column", [M], [H], [stiff], [np.inf], [0.0], 0.0, 0.0, base, gravity_load=weight)
    square = (spring - 9.80665 * M * H) / (inertia + M * H**2)
    motion = still(2.0)
    motion = dataclasses.replace(motion, acceleration=np.where(np.arange(motion.acceleration.size) < 3, 0.0, 1.0))
    run = history(Scene((column,), (), motion, ELASTIC), 1e-9, 0.02)
    force, t = M * H / (spring - 9.80665 * M * H), run.time - 0.06
    ramp = 0.02  # the ground's acceleration rises to 1 m/s2 within a sample, then stays
    w = np.sqrt(square)
    expected = -force * (1 - (np.sin(w * (t + ramp)) - np.sin(w * t)) / (w * ramp))
    after = t > 1e-9
    assert run.rocking[after, 0] == pytest.approx(expected[after], abs=2e-6 * np.abs(expected[after]).max())


def test_unstable_at_rest_is_refused():
    """Fails if a storey, or a rocking base, that cannot stand is run."""
    with pytest.raises(UnstableError, match=r"storey 1 no stiffness: theta = P / \(k h\) is 1"):
        leaning(oscillator(M, K), 1.0)
    base = Foundation(inertia=1e6, rocking_stiffness=1e8, sways=False)
    building = dataclasses.replace(oscillator(M, K), foundation=base)
    needed = 0.5 * K * H**2 / (1 - 0.5)
    assert needed > 1e8
    with pytest.raises(UnstableError, match="overturns"):
        leaning(building, 0.5)
    enough = dataclasses.replace(base, rocking_stiffness=needed * (1 + 1e-9))
    leaning(dataclasses.replace(building, foundation=enough), 0.5)


@pytest.mark.parametrize("gap", [0.0, 0.02])
@pytest.mark.parametrize("analysis", [ELASTIC, INELASTIC])
def test_pair_of_five_storeys(analysis, gap):
    """Fails if a coupling of P-Delta has another sign, or the wrong storey's weight."""
    two = tuple(standing(leaning(shear_building(period, 5, strength=0.6), 0.15)) for period in (0.36, 0.60))
    scene = Scene(two, links("pounding", gap, (1, 2, 3, 4, 5)), shake(1.2, 9.0, seed=3), analysis)
    assert agree(scene, 1e-7).impacts.sum() > 0
    run = solve(scene, 1e-6)
    assert abs(run.energy["residual"]) < 1e-8
    assert difference(run, solve(scene, 1e-11)) <= assess(scene, run, 1e-6).error_estimate <= 1e-6


def test_chain_of_ten():
    """Fails if the stiffness of an island that is put back lacks P-Delta."""
    islands_equal_the_whole(row_of_ten(changed=lambda b: standing(leaning(weaker(b), 0.08))))


def test_pair_on_foundations():
    """Fails if the weight does not act on sway and rocking as it should."""
    two = tuple(standing(leaning(shear_building(period, 3, FOUNDATION, strength=0.6), 0.1)) for period in (0.36, 0.60))
    agree(Scene(two, links("pounding", 0.004, (1, 2, 3)), shake(1.0, 6.0), INELASTIC), 1e-7)


@pytest.mark.parametrize("name", [name for name, method in METHODS.items() if name not in ("taylor", "exponential")])
def test_every_method_that_takes_yielding_storeys(name):
    """Peak-oriented storeys on foundations with P-Delta. Fails if a method takes it for a part of the law."""
    building = dataclasses.replace(
        shear_building(0.4, 2, FOUNDATION, strength=0.3, damping=0.02), storey_law=PeakOriented
    )
    scene = Scene((leaning(building, 0.02),), (), shake(3.0, 4.0), INELASTIC)
    run = solve(scene, 1e-11)
    assert run.status == "done"
    exact = run.buildings[0]
    without = solve(dataclasses.replace(scene, buildings=(building,)), 1e-9).buildings[0]
    assert np.abs(without.drift / exact.drift - 1).max() > 0.01
    errors = []
    for step in (4e-4, 1e-4):
        found = solve(scene, method=name, time_step=step).buildings[0]
        errors.append(max(np.abs(found.drift / exact.drift - 1).max(), np.abs(found.shear / exact.shear - 1).max()))
    assert errors[1] < (1e-8 if METHODS[name].located else 5e-5)
    assert errors[1] < 0.5 * errors[0]


def test_history_keeps_the_balance():
    """Fails if the potential energy of the weights is missing over time."""
    two = tuple(leaning(shear_building(period, 3, FOUNDATION, strength=0.6)) for period in (0.36, 0.60))
    kept = history(Scene(two, links("pounding", 0.004, (1, 2, 3)), shake(1.0, 6.0), INELASTIC), 1e-10, 0.002)
    spent = sum(kept.energy[key] for key in ("kinetic", "stored", "damping", "hysteresis", "links"))
    assert np.abs(spent - kept.energy["input"]).max() < 1e-9 * kept.energy["input"].max()
