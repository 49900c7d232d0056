"""Isolated buildings: published prototypes, the same building with the isolators as its lowest storey, energy."""

from __future__ import annotations

import math
import os
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from pounding_cli import InputError
from tests.adapter import Bearings, FrictionPendulum, Rubber, Run, Scene, refused, solve
from tests.physics.cases import shake
from tests.reference.sliding import Sliding

G = 9.80665
MASS, FLOOR, STIFFNESS, H = 3e5, 2e5, 1e8, 3.0
WEIGHT = G * (MASS + 2 * FLOOR)
PENDULUM = {"radius": 3.122, "friction": 0.0659}
LEAD = {"strength": 4e5, "stiffness": 4e6, "yield_displacement": 0.01}


def isolated(isolation: dict[str, Any], **keys: Any) -> dict[str, Any]:
    """Two elastic storeys on isolators."""
    usual = {"storeys": 2, "mass": FLOOR, "stiffness": [STIFFNESS] * 2, "height": H, "yield_shear": "never"}
    return usual | {"foundation": {"mass": MASS, "isolation": isolation}} | keys


@pytest.mark.parametrize(("amplitude", "period", "damping"), [(12.7, 2.77, 0.248), (24.3, 3.07, 0.159)])
def test_a_prototype(amplitude: float, period: float, damping: float) -> None:
    """Effective period and damping of a friction pendulum at an amplitude [in]."""
    law, d = FrictionPendulum(**PENDULUM), 0.0254 * amplitude
    found = law.effective(WEIGHT, d)
    assert found == (pytest.approx(period, abs=0.005), pytest.approx(damping, abs=0.0006))
    mu, radius = PENDULUM["friction"], PENDULUM["radius"]
    assert found[0] == pytest.approx(2 * math.pi / math.sqrt(G * (1 / radius + mu / d)), rel=1e-9)
    exact = 2 / math.pi * mu / (mu + d / radius)  # of a slider that sticks: the spring costs its share of the amplitude
    assert found[1] == pytest.approx(exact * (1 - law.yield_displacement / d), rel=1e-9)


def with_sticking(ground: np.ndarray, dt: float) -> float:
    """Largest displacement [m] of the base of a house of one storey on a slider that sticks, by an integrator of its
    own: two degrees of freedom, the base held while the friction that this takes is below mu W."""
    mu, w_r = PENDULUM["friction"] * G * (MASS + FLOOR), G * (MASS + FLOOR) / PENDULUM["radius"]
    k = STIFFNESS

    def pull(t: float, y: np.ndarray, a0: float, slope: float) -> float:
        """What moves the base but friction [N]."""
        return k * (y[2] - y[0]) - w_r * y[0] - MASS * (a0 + slope * t)

    def rates(t: float, y: np.ndarray, a0: float, slope: float, sign: float) -> list[float]:
        base = (pull(t, y, a0, slope) - sign * mu) / MASS if sign else 0.0
        return [y[1], base, y[3], -k * (y[2] - y[0]) / FLOOR - a0 - slope * t]

    def turns(t: float, y: np.ndarray, a0: float, slope: float, sign: float) -> float:
        return y[1] if sign else abs(pull(t, y, a0, slope)) - mu

    y, sign, largest = np.zeros(4), 0.0, 0.0
    for a0, a1 in pairwise(ground):
        t, slope = 0.0, (a1 - a0) / dt
        while t < dt * (1 - 1e-12):
            turns.terminal, turns.direction = True, -sign if sign else 1.0  # type: ignore[attr-defined]
            run = solve_ivp(rates, (t, dt), y, "DOP853", events=turns, args=(a0, slope, sign), rtol=1e-11, atol=1e-14)
            t, y = run.t[-1], run.y[:, -1]
            largest = max(largest, float(np.abs(run.y[0]).max()))
            if run.status == 1:
                if sign:
                    y[1] = 0.0
                push = pull(t, y, a0, slope)
                sign = float(np.sign(push)) if abs(push) >= mu * (1 - 1e-9) else 0.0
    return largest


def test_a_slider_that_sticks_is_the_limit_of_a_stiff_spring() -> None:
    """The peak of the base differs from that of a slider that sticks in proportion to the yield displacement."""
    ground = shake(4.0)
    exact, found = with_sticking(ground, 0.02), []
    for spring in (1e-4, 1e-5, 1e-6):
        house = {
            "storeys": 1, "mass": FLOOR, "stiffness": [STIFFNESS], "yield_shear": "never",
            "rayleigh": {"alpha": 0.0, "beta": 0.0},
            "foundation": {"mass": MASS, "isolation": PENDULUM | {"yield_displacement": spring}},
        }  # fmt: skip
        found.append(solve(Scene((house,), ground, 0.02), 1e-9).sway[0] / exact - 1)
    assert found[0] < 0.02
    assert found[1] < 0.0015
    assert found[2] < 1e-4
    assert found[1] / found[2] == pytest.approx(10, rel=0.6)


SLIDING, BETA, WALL, GAP, CONTACT, XI = {"radius": 2.0, "friction": 0.06}, 2e-3, (4e5, 1.75e8), 0.004, 2e9, 0.2


def on_a_slider(ground: np.ndarray, strikes: bool, accuracy: float = 1e-9, **settings: Any) -> Run:
    """A base of 300 t and three floors on friction pendulums that stick; `strikes`: a wall on soil strikes the base."""
    damped = {"alpha": 0.0, "beta": BETA}
    keys = {"storeys": 3, "stiffness": [2 * STIFFNESS] * 3, "rayleigh": damped}
    house = isolated(SLIDING, **keys)
    if not strikes:
        return solve(Scene((house,), ground, 0.02), accuracy, **settings)
    wall = {"wall": {"height": 0.0, "mass": WALL[0], "stiffness": WALL[1], "damping": 0.0}}
    case = {"link": "pounding", "gap": GAP, "floors": "base"}
    more = {"impact": {"stiffness": CONTACT, "damping_ratio": XI}}
    return solve(Scene((wall, house), ground, 0.02, case, more=more), accuracy, **settings)


@pytest.mark.parametrize("strikes", [False, True], ids=["alone", "struck"])
@pytest.mark.parametrize("method", ["taylor", "dop853"])
def test_a_slider_that_sticks(method: str, strikes: bool) -> None:
    """Against an integrator of its own. Fails if a spring takes the place of sticking."""
    if not (method == "taylor" and strikes) and "POUND_NIGHTLY" not in os.environ:
        pytest.skip("make reference runs it every night")
    ground = shake(2.5, 4.0)
    masses = [MASS, FLOOR, FLOOR, FLOOR]
    weight = G * sum(masses)
    surface, friction = weight / SLIDING["radius"], SLIDING["friction"] * weight
    one = Sliding(masses, [2 * STIFFNESS] * 3, surface, friction, BETA)
    if strikes:
        reduced = WALL[0] * MASS / (WALL[0] + MASS)
        dashpot = 2 * XI * math.sqrt(CONTACT * reduced)
        one = Sliding(one.masses, one.springs, surface, friction, BETA, WALL, GAP, CONTACT, dashpot)
    expected, run = one.run(ground, 0.02), on_a_slider(ground, strikes, method=method)
    assert run.status == "done"
    assert abs(run.energy["residual"]) < 1e-9
    assert run.sway[-1] == pytest.approx(expected["base"], rel=1e-7)
    np.testing.assert_allclose(run.drift[-3:], expected["drift"], rtol=1e-6)
    assert run.impacts.sum() == expected["impacts"]
    assert (run.impacts.sum() > 0) == strikes


def test_a_slider_keeps_the_base_where_it_stops() -> None:
    """At rest the surface pulls at the base with less than the friction."""
    run, late = (solve(Scene((isolated(SLIDING),), shake(3.0), 0.02, tail=tail)) for tail in (0.0, 20.0))
    assert (run.residual_drift == 0.0).all()
    assert abs(late.end_velocity).max() < 1e-6
    assert 0.0 < abs(late.end[0]) < SLIDING["friction"] * SLIDING["radius"]


def test_methods_of_fixed_steps_refuse_a_slider_that_sticks() -> None:
    ground = shake(0.2)
    with pytest.raises(InputError, match="yield_displacement"):
        on_a_slider(ground, False, method="newmark", time_step=1e-3)
    spring = isolated(SLIDING | {"yield_displacement": 1e-5})
    assert solve(Scene((spring,), ground, 0.02), method="newmark", time_step=1e-3).status == "done"


def test_high_damping_rubber_is_a_spring_and_a_dashpot() -> None:
    rubber = {"stiffness": 6e6, "damping_ratio": 0.12}
    c = 2 * 0.12 * math.sqrt(6e6 * WEIGHT / G)
    one = solve(Scene((isolated(rubber),), shake(3.0), 0.02), 1e-10)
    same = isolated(LEAD) | {"foundation": {"mass": MASS, "sway_stiffness": 6e6, "sway_damping": c}}
    other = solve(Scene((same,), shake(3.0), 0.02), 1e-10)
    assert one.sway[0] == pytest.approx(other.sway[0], rel=1e-12)
    np.testing.assert_allclose(one.shear, other.shear, rtol=1e-12)
    assert Rubber(**rubber).effective(WEIGHT, 0.3) == (2 * math.pi * math.sqrt(WEIGHT / G / 6e6), 0.12)


def test_sliding_period() -> None:
    law = FrictionPendulum(radius=30 * 0.0254, friction=0.05).law_under(WEIGHT)
    assert 2 * math.pi * math.sqrt(WEIGHT / G / law.stiffness) == pytest.approx(1.7514, abs=5e-5)


@pytest.mark.parametrize("isolation", [PENDULUM | {"yield_displacement": 1e-5}, LEAD], ids=["pendulum", "bearings"])
@pytest.mark.parametrize("analysis", ["elastic", "inelastic"])
def test_isolators_are_a_lowest_storey(isolation: dict[str, float], analysis: str) -> None:
    """In both analyses; the storeys above have the shears of those of a building of three."""
    law = (FrictionPendulum if "radius" in isolation else Bearings)(**isolation).law_under(WEIGHT)
    undamped = {"rayleigh": {"alpha": 0.0, "beta": 0.0}}
    three = {
        "storeys": 3, "mass": [MASS, FLOOR, FLOOR], "stiffness": [law.stiffness, STIFFNESS, STIFFNESS], "height": H,
        "yield_shear": [law.yield_shear, 1e12, 1e12], "hardening": [law.hardening, 0.0, 0.0], **undamped,
    }  # fmt: skip
    ground = shake(3.0)
    one = solve(Scene((isolated(isolation, **undamped),), ground, 0.02, analysis=analysis), 1e-10)
    other = solve(Scene((three,), ground, 0.02, analysis="inelastic"), 1e-10)
    assert one.sway[0] == pytest.approx(other.drift[0], rel=1e-7)
    assert one.sway[0] > 2 * law.yield_drift
    np.testing.assert_allclose(one.shear[:2], other.shear[1:3], rtol=1e-7)
    np.testing.assert_allclose(one.acceleration[:2], other.acceleration[1:3], rtol=1e-7)
    for name in ("input", "hysteresis", "kinetic", "stored"):
        assert one.energy[name] == pytest.approx(other.energy[name], rel=1e-6)
    assert abs(one.energy["residual"]) < 1e-9


def test_damping_of_the_building_does_not_reach_its_isolators() -> None:
    """A stiff building on isolators loses all energy in them, whatever its damping ratio."""
    stiff = isolated(PENDULUM, stiffness=[1e12, 1e12], damping=0.1)
    run = solve(Scene((stiff,), shake(3.0), 0.02), 1e-8)
    assert run.energy["damping"] < 1e-4 * run.energy["hysteresis"]


def test_a_base_that_moves_beyond_its_isolators() -> None:
    far = solve(Scene((isolated(PENDULUM),), shake(3.0), 0.02)).sway[0]
    runs = [solve(Scene((isolated(PENDULUM | {"capacity": part * far}),), shake(3.0), 0.02)) for part in (0.9, 1.1)]
    (said,), none = (run.flags for run in runs)
    assert said.startswith("isolators moved beyond their capacity: b0")
    assert said.endswith(f"by {100 * far:.3g} mm")
    assert none == ()


STUDY = """\
records: {use: [elcentro]}
buildings:
  A: {storeys: 2, period: 0.3 s}
  B: {like: A, foundation: FOUNDATION}
group: [A, B]
cases: {near: {link: pounding, gap: 1 cm}}
"""


@pytest.mark.parametrize(
    ("foundation", "word"),
    [
        ("{mass: 100 t, isolation: {radius: 3 m}}", "'friction' is missing"),
        ("{mass: 100 t, isolation: {strength: 800 kN, stiffness: 5 kN/mm}}", "'yield_displacement' is missing"),
        ("{mass: 100 t, isolation: {radius: 3 m, friction: 6 %, strength: 800 kN}}", "'strength' does not go with"),
        ("{mass: 100 t, isolation: {damping_ratio: 10 %}}", "'stiffness' is missing"),
        (
            "{mass: 100 t, isolation: {stiffness: 5 kN/mm, damping_ratio: 10 %, strength: 1 kN}}",
            "'strength' does not go with",
        ),
        ("{mass: 100 t, sway_stiffness: 5 kN/mm, isolation: {radius: 3 m, friction: 6 %}}", "both"),
        ("{isolation: {radius: 3 m, friction: 6 %}}", "mass"),
        ("{mass: 100 t, isolation: {radius: 3, friction: 600 %}}", "friction"),
    ],
)
def test_isolators_that_are_refused(foundation: str, word: str) -> None:
    problems = refused(STUDY.replace("FOUNDATION", foundation))
    assert {line for line, _, _ in problems} == {4}
    assert any(word in words for _, _, words in problems), problems
