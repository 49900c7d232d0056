"""Bouc-Wen storeys: throws in closed form, an integrator that shares no code, rate independence, collapse, foundations,
histories, extremes of every parameter."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from scipy.optimize import brentq

from pounding_cli.errors import InputError
from pounding_cli.laws.bouc_wen import BoucWen
from pounding_cli.model.building import Building, weight_above
from pounding_cli.model.scene import Scene
from pounding_cli.solve import METHODS, solve
from pounding_cli.solve.assess import assess, difference
from pounding_cli.solve.histories import history
from tests.hard.random_scenes import random_scene
from tests.helpers.scenes import (
    ELASTIC,
    FOUNDATION,
    INELASTIC,
    links,
    oscillator,
    shake,
    shear_building,
    still,
)
from tests.reference import events
from tests.reference.agreement import agree
from tests.reference.rows import islands_equal_the_whole, row_of_ten, weaker

M, K, VY, A = 2e5, 2e7, 3e5, 0.1
DY = VY / K


def bouc_wen(building: Building, n: int = 2, gamma: float = 0.5, **changes) -> Building:
    parameters = ("wen_exponent", n), ("wen_gamma", gamma)
    return dataclasses.replace(building, storey_law=BoucWen, law_parameters=parameters, **changes)


def throw(speed: float, n: int, gamma: float = 0.5, mass: float = M, duration: float = 1.2):
    """An undamped storey thrown from rest."""
    scene = Scene((bouc_wen(oscillator(mass, K, 0.0, VY, A), n, gamma),), (), still(duration), INELASTIC)
    return solve(scene, 1e-12, initial=([[0.0]], [[speed]]))


def loading(n: int, x: float) -> tuple[float, float]:
    """z, and the integral of z over x = D / Dy, on loading from z = 0."""
    return (1 - np.exp(-x), x - 1 + np.exp(-x)) if n == 1 else (np.tanh(x), np.log(np.cosh(x)))


@pytest.mark.parametrize("n", [1, 2])
@pytest.mark.parametrize("speed", [0.05, 0.15, 0.25])
def test_throw_and_return(n, speed):
    """Out along 1 - exp(-x) or tanh x, back along the straight unloading line, and on along the same curve downwards:
    both turns by their energies. Fails if z grows by another law, unloading is not straight at gamma = 1/2, or z jumps
    where it changes its sign."""
    found = throw(speed, n)
    energy = 0.5 * M * speed**2

    def left(x: float) -> float:
        return energy - 0.5 * A * K * (x * DY) ** 2 - (1 - A) * VY * DY * loading(n, x)[1]

    first = brentq(left, 0.0, 100.0, xtol=1e-15)
    z = loading(n, first)[0]
    storey = found.buildings[0]
    assert storey.displacement_max[0] == pytest.approx(first * DY, rel=1e-11)
    assert storey.ductility[0] == pytest.approx(first, rel=1e-11)
    assert storey.shear[0] == pytest.approx(A * K * first * DY + (1 - A) * VY * z, rel=1e-11)
    zero = first - z  # where z is 0 again
    back = 0.5 * A * K * (first * DY) ** 2 + 0.5 * (1 - A) * VY * DY * z * z

    def left_down(x: float) -> float:
        return back - 0.5 * A * K * (x * DY) ** 2 - (1 - A) * VY * DY * loading(n, zero - x)[1]

    second = brentq(left_down, zero - 100.0, zero, xtol=1e-15)
    assert second < 0
    assert storey.displacement_min[0] == pytest.approx(second * DY, rel=1e-10)
    assert abs(found.energy["residual"]) < 1e-13


@pytest.mark.parametrize("gamma", [-1.0, -0.5, 0.2, 0.9, 0.99])
def test_unloading_by_gamma(gamma):
    """n = 1: unloading from z follows dz/dx = 1 - c z with c = 2 gamma - 1. Fails if gamma and beta change places."""
    speed, c = 0.08, 2 * gamma - 1
    found = throw(speed, 1, gamma).buildings[0]
    energy = 0.5 * M * speed**2

    def left(x: float) -> float:
        return energy - 0.5 * A * K * (x * DY) ** 2 - (1 - A) * VY * DY * loading(1, x)[1]

    first = brentq(left, 0.0, 100.0, xtol=1e-15)
    z = loading(1, first)[0]
    zero = first + np.log(1 - c * z) / c
    given_back = (first - zero - z) / c  # integral of z dx from there: dz = (1 - c z) dx
    back = 0.5 * A * K * (first * DY) ** 2 + (1 - A) * VY * DY * given_back

    def left_down(x: float) -> float:
        return back - 0.5 * A * K * (x * DY) ** 2 - (1 - A) * VY * DY * loading(1, zero - x)[1]

    second = brentq(left_down, zero - 100.0, zero, xtol=1e-15)
    assert second < 0
    assert found.displacement_max[0] == pytest.approx(first * DY, rel=1e-11)
    assert found.displacement_min[0] == pytest.approx(second * DY, rel=1e-9)


@pytest.mark.parametrize(("n", "gamma"), [(1, 0.5), (3, -0.5), (2, 0.9)])
def test_rate_independence(n, gamma):
    """A hundred times the mass at a tenth of the speed swings ten times as slowly through the same loop. Fails if the
    shear, or what is lost, depends on the rate."""
    fast, slow = throw(0.4, n, gamma), throw(0.04, n, gamma, mass=100 * M, duration=12.0)
    for name in ("drift", "shear", "displacement_min", "residual_drift"):
        values = (getattr(run.buildings[0], name) for run in (fast, slow))
        assert next(values) == pytest.approx(next(values), rel=1e-9), name
    assert fast.energy["hysteresis"] == pytest.approx(slow.energy["hysteresis"], rel=1e-10)
    assert 0.3 < fast.energy["hysteresis"] / fast.energy["input"] < 1.0


def test_a_closed_loop_loses_its_area():
    """Held between two equal springs of the same drift: what is lost from one turn to the next is the area between.
    With n = 1 and gamma = 1/2 the work of a half cycle from -X to X is that of the curve less what was stored. Fails if
    the ledger counts as lost what z stores."""
    speed, n = 0.4, 1
    found = throw(speed, n)
    kept = history(Scene((bouc_wen(oscillator(M, K, 0.0, VY, A), n),), (), shake(3.0, 6.0), INELASTIC), 1e-11, 0.001)
    drift, shear = kept.drift[:, 0, 0], kept.shear[:, 0, 0]
    area = np.concatenate(([0.0], np.cumsum(0.5 * (shear[1:] + shear[:-1]) * np.diff(drift))))
    z = (shear - A * K * drift) / ((1 - A) * VY)
    stored = 0.5 * A * K * drift**2 + 0.5 * (1 - A) * VY * DY * z**2
    assert np.abs(z).max() <= 1.0
    assert kept.energy["stored"] == pytest.approx(stored, rel=1e-9, abs=1e-6)
    assert kept.energy["hysteresis"] == pytest.approx(area - stored, abs=2e-5 * area[-1])
    assert np.diff(kept.energy["hysteresis"]).min() > -1e-9 * area[-1]
    assert found.energy["stored"] + found.energy["hysteresis"] + found.energy["kinetic"] == pytest.approx(
        found.energy["input"], rel=1e-12
    )


@pytest.mark.parametrize(("n", "gamma"), [(1, 0.5), (2, 0.5), (3, -0.5), (1, 0.9), (8, 0.0), (20, 0.5)])
def test_many_cycles(n, gamma):
    """Two storeys through many inner loops, against DOP853. Fails if a reversal or a zero of z is stepped over."""
    building = bouc_wen(shear_building(0.4, 2, strength=1.0, damping=0.02), n, gamma)
    scene = Scene((building,), (), shake(4.0, 4.0), INELASTIC)
    expected, run = events.integrate(scene), solve(scene, 1e-12)
    assert run.events > 60
    assert run.buildings[0].drift == pytest.approx(expected.drift, rel=1e-8)
    assert run.buildings[0].shear == pytest.approx(expected.shear, rel=1e-8)
    assert run.buildings[0].residual_drift == pytest.approx(expected.residual_drift, rel=1e-7)
    assert run.energy["input"] == pytest.approx(expected.energy["input"], rel=1e-8)


@pytest.mark.parametrize("gap", [0.0, 0.02])
def test_pair_of_five_storeys(gap):
    """Against DOP853 from event to event; upper storeys begin as quietly as rounding. Fails if a storey pushes one of
    its floors alone, or a plain contact beside it is left without its force."""
    two = tuple(bouc_wen(shear_building(period, 5, strength=2.5)) for period in (0.36, 0.60))
    scene = Scene(two, links("pounding", gap, (1, 2, 3, 4, 5)), shake(3.0, 5.0, seed=6), INELASTIC)
    assert agree(scene, 1e-7).impacts.sum() > 0
    run = solve(scene, 1e-6)
    assert max(b.ductility.max() for b in run.buildings) > 5
    assert abs(run.energy["residual"]) < 1e-8
    assert difference(run, solve(scene, 1e-11)) <= assess(scene, run, 1e-6).error_estimate <= 1e-6


def test_elastic_analysis_and_endless_strength():
    """Fails if z flows where no storey yields, or elastic analyses of such storeys are refused by exact steps."""
    building = shear_building(0.4, 3)
    scene = Scene((building,), (), shake(3.0), ELASTIC)
    smooth = dataclasses.replace(scene, buildings=(bouc_wen(building),))
    expected = solve(scene, 1e-11).buildings[0].drift
    assert solve(smooth, 1e-11).buildings[0].drift == pytest.approx(expected, rel=1e-13)
    assert solve(smooth, 1e-11, "exponential").buildings[0].drift == pytest.approx(expected, rel=1e-9)
    for strength in ([np.inf] * 3, [np.inf, 1e16, np.inf]):
        endless = bouc_wen(building, yield_shear=np.array(strength))
        found = solve(dataclasses.replace(smooth, buildings=(endless,), analysis=INELASTIC), 1e-11)
        assert found.status == "done"
        assert found.buildings[0].drift == pytest.approx(expected, rel=1e-9)


def test_a_sharp_storey_is_nearly_bilinear():
    """Fails if n = 20 rounds the corner more than (1 - z^n) can."""
    building = shear_building(0.4, 3, strength=1.0)
    runs = [
        solve(Scene((one,), (), shake(4.0), INELASTIC), 1e-9).buildings[0].drift
        for one in (building, bouc_wen(building, 20), bouc_wen(building, 2))
    ]
    assert np.abs(runs[1] / runs[0] - 1).max() < 0.05 < np.abs(runs[2] / runs[0] - 1).max()


@pytest.mark.parametrize("foundation", [None, FOUNDATION])
def test_p_delta_and_foundations(foundation):
    """Storeys that lean with their base, and carry weights. Fails if the point below a storey is not pushed."""
    plain = shear_building(0.5, 2, foundation, strength=1.0, damping=0.02)
    building = bouc_wen(plain, 2, 0.3, gravity_load=2 * weight_above(plain.mass), collapse=np.inf)
    other = bouc_wen(shear_building(0.3, 2, foundation, strength=1.0), 1)
    agree(Scene((building, other), links("pounding", 0.004, (1, 2)), shake(1.0), INELASTIC), 1e-7)


def test_collapse():
    """Fails if the drift of a smooth storey is not looked at within its steps."""
    building = bouc_wen(shear_building(0.6, 3, strength=0.3), collapse=0.02)
    found = solve(Scene((building,), (), shake(8.0, 6.0), INELASTIC), 1e-9)
    assert found.status == "collapsed"
    assert found.buildings[0].drift.max() == pytest.approx(0.06, rel=1e-12)
    assert abs(found.energy["residual"]) < 1e-9


@pytest.mark.parametrize("name", [name for name in METHODS if name != "taylor"])
def test_methods_that_keep_no_state_refuse_them(name):
    """Fails if a method runs the storeys on their first branch."""
    setting = {"time_step": 1e-4} if METHODS[name].takes_step else {}
    scene = Scene((bouc_wen(shear_building(0.4, 2)),), (), shake(1.0), INELASTIC)
    with pytest.raises(InputError, match="bouc-wen storeys depends on all that went before"):
        solve(scene, 1e-6, method=name, **setting)


def test_history_and_largest_values_agree():
    """Fails if z is lost between output times, or its energy."""
    building = bouc_wen(shear_building(0.4, 2, strength=1.0, damping=0.02))
    scene = Scene((building,), (), shake(5.0, 4.0), INELASTIC)
    run, kept = solve(scene, 1e-9), history(scene, 1e-9, 0.0005)
    assert np.abs(kept.shear[:, 0]).max(axis=0) == pytest.approx(run.buildings[0].shear, rel=2e-3)
    assert np.abs(kept.drift[:, 0]).max(axis=0) == pytest.approx(run.buildings[0].drift, rel=2e-3)
    spent = sum(kept.energy[key] for key in ("kinetic", "stored", "damping", "hysteresis", "links"))
    assert np.abs(spent - kept.energy["input"]).max() < 1e-9 * kept.energy["input"].max()


@pytest.mark.parametrize("n", range(24))
def test_hard_scenes(n):
    """Extremes of every parameter, strengths from a millionth to a million times. Fails if a storey that yields from
    the first instant takes steps of its yield drift for ever, or one at rest chatters between its branches."""
    rng = np.random.default_rng(n)
    exponent, gamma = int(rng.choice([1, 2, 3, 5, 10, 20])), float(rng.choice([-1, -0.5, 0, 0.5, 0.9, 0.99]))
    strength, hardening = rng.choice([1e-6, 1e-3, 1, 1e3, 1e6]), rng.choice([0, 1e-9, 0.05, 0.999])
    scene, _ = random_scene(n)
    buildings = tuple(
        bouc_wen(
            b, exponent, gamma, hardening=np.full(b.storeys, hardening), collapse=np.inf,
            yield_shear=strength * np.where(np.isfinite(b.yield_shear), b.yield_shear, 0.01 * b.stiffness),
        )
        for b in scene.buildings
    )  # fmt: skip
    run = solve(dataclasses.replace(scene, buildings=buildings, analysis=INELASTIC), 1e-7, bounds=(100_000, 20_000))
    assert run.status == "done"
    assert abs(run.energy["residual"]) < 1e-8


@pytest.mark.parametrize("n", [1, 2])
def test_chain_of_ten(n):
    """Fails if islands restore some of what a storey remembers."""
    islands_equal_the_whole(row_of_ten(changed=lambda b: bouc_wen(weaker(b), n)))


def test_a_still_start_and_a_long_rest():
    """Ground that is still before and after the motion. Fails if a storey without motion has events."""
    motion = shake(2.0)
    quiet = np.concatenate((np.zeros(50), motion.acceleration, np.zeros(500)))
    building = bouc_wen(shear_building(0.4, 3, strength=1.0, damping=0.2))
    run = solve(Scene((building,), (), dataclasses.replace(motion, acceleration=quiet), INELASTIC), 1e-9)
    assert run.status == "done"
    assert abs(run.energy["residual"]) < 1e-9


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("wen_exponent", 0, "at least 1 and at most 20"),
        ("wen_exponent", 21, "at least 1 and at most 20"),
        ("wen_exponent", 2.5, "a whole number"),
        ("wen_gamma", 1.0, "at least -1 and at most 0.99"),
        ("wen_gamma", -1.5, "at least -1 and at most 0.99"),
    ],
)
def test_parameters_outside_their_range(name, value, words):
    """Fails if a law is built that has no series, or no loop."""
    with pytest.raises(ValueError, match=words):
        BoucWen(K, VY, A, **{name: value})
