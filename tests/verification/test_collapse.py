"""Collapse: the run ends within a step, at the drift that a storey stands, by every method, in all kinds of scenes."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from test_p_delta import VY, A, H, K, M

from pounding_cli.kernels import layout
from pounding_cli.laws import link_laws
from pounding_cli.model.effects import effects_of
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Scene
from pounding_cli.records.motion import Motion
from pounding_cli.solve import METHODS, solve
from pounding_cli.solve.assess import assess, change, difference
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
    still,
)

THETA, SPEED = 0.25, 0.6
WHERE = ("collapse_time", "collapse_building", "collapse_storey")


def thrown(theta: float = THETA, **changes) -> Scene:
    """An undamped bilinear storey, to be thrown so that it does not come back."""
    building = dataclasses.replace(leaning(oscillator(M, K, 0.0, VY, A), theta), **changes)
    return Scene((building,), (), still(4.0), INELASTIC)


def run(scene: Scene, speed: float = SPEED, accuracy: float = 1e-12, **settings):
    zero = [np.zeros(b.storeys) for b in scene.buildings]
    return solve(scene, accuracy, initial=(zero, [z + speed for z in zero]), **settings)


def time_of_collapse(theta: float, limit: float) -> float:
    """By the closed forms on both lines of the law: a cosine, then exponentials."""
    dy, w = VY / K, np.sqrt(K * (1 - theta) / M)
    t1 = np.arcsin(dy * w / SPEED) / w
    v1 = SPEED * np.cos(w * t1)
    # u'' = g^2 (u - c): up the yield line, with the weight
    g = np.sqrt(K * (theta - A) / M)
    c = (1 - A) * VY / (K * (theta - A))
    p, q = 0.5 * (dy - c + v1 / g), 0.5 * (dy - c - v1 / g)
    top = limit - c
    return t1 + np.log((top + np.sqrt(top**2 - 4 * p * q)) / (2 * p)) / g


@pytest.mark.parametrize("limit", [0.02, 0.10, 0.5])
def test_time_in_closed_form(limit):
    """Fails if the collapse is found at the end of a step, or at another drift."""
    found = run(thrown(collapse=limit))
    assert (found.status, found.collapse_building, found.collapse_storey) == ("collapsed", 0, 1)
    assert found.collapse_time == pytest.approx(time_of_collapse(THETA, limit * H), rel=1e-11)
    assert found.buildings[0].drift[0] == pytest.approx(limit * H, rel=1e-14)
    assert found.buildings[0].residual_drift[0] == pytest.approx(limit * H, rel=1e-14)
    assert found.buildings[0].shear[0] == pytest.approx((1 - A) * VY + A * K * limit * H, rel=1e-12)
    assert abs(found.energy["residual"]) < 1e-12
    assert found.flags[0].startswith("collapsed: oscillator storey 1, at 0.")


def test_where_it_is_looked_for():
    """10 % where a storey that yields loses all resistance, what a building says elsewhere. Fails if elastic analyses
    end so, or storeys that harden more than they lose."""
    plain = oscillator(M, K, 0.0, VY, A)
    assert np.isinf(plain.collapse_drift).all()
    assert np.isinf(leaning(plain, 0.04).collapse_drift).all()
    assert leaning(plain, 0.06).collapse_drift == pytest.approx([0.3])
    assert np.isinf(leaning(oscillator(M, K), 0.5).collapse_drift).all()
    assert dataclasses.replace(plain, collapse=0.02).collapse_drift == pytest.approx([0.06])
    assert not effects_of(dataclasses.replace(thrown(), analysis=ELASTIC)).collapse
    assert run(dataclasses.replace(thrown(), analysis=ELASTIC)).status == "done"
    assert run(thrown(collapse=np.inf), 0.6).buildings[0].drift[0] > 10.0
    asked = dataclasses.replace(oscillator(M, K), collapse=0.001)  # a storey that cannot yield
    found = run(Scene((asked,), (), still(1.0), INELASTIC))
    assert found.collapse_time == pytest.approx(
        np.arcsin(0.001 * H * np.sqrt(K / M) / SPEED) / np.sqrt(K / M), rel=1e-11
    )


@pytest.mark.parametrize("name", [name for name, method in METHODS.items() if method.takes_step])
def test_methods_of_fixed_steps(name):
    """Fails if a method goes on beyond the collapse, or tells the time of the last step."""
    errors = []
    for step in (1e-3, 2.5e-4):
        found = run(thrown(), method=name, time_step=step)
        assert (found.status, found.collapse_storey) == ("collapsed", 1)
        assert 0.3 <= found.buildings[0].drift[0] < 0.3 + 10 * step
        errors.append(abs(found.collapse_time / time_of_collapse(THETA, 0.3) - 1))
    assert errors[1] < min(1e-4, errors[0])


def test_a_scene_without_collapse_keeps_its_bits():
    """Fails if looking for it changes a step."""
    two = tuple(shear_building(period, 3, FOUNDATION, strength=0.6) for period in (0.36, 0.60))
    scene = Scene(two, links("pounding", 0.004, (1, 2, 3)), shake(1.5, 6.0), INELASTIC)
    watched = dataclasses.replace(scene, buildings=tuple(dataclasses.replace(b, collapse=0.5) for b in two))
    assert effects_of(watched).collapse
    one, other = solve(scene, 1e-9), solve(watched, 1e-9)
    assert (one.steps, one.events, one.orders) == (other.steps, other.events, other.orders)
    assert difference(one, other) == 0.0


def independent(scene: Scene, limit: float) -> tuple[float, int]:
    """Time and storey of the collapse of a building alone, by DOP853 with events and a bilinear law of its own."""
    b = scene.buildings[0]
    n, k, a, dy = b.storeys, b.stiffness, b.hardening, b.yield_drift
    below = np.eye(n) - np.eye(n, k=-1)
    damping = b.alpha * np.diag(b.mass) + b.beta * b.stiffness_matrix
    plastic, way = np.zeros(n), np.zeros(n, int)
    y, t = np.zeros(2 * n), 0.0
    motion = scene.motion

    def slope(t, y, begin, at, rise):
        drift = below @ y[:n]
        shear = (
            a * k * drift
            + (1 - a) * k * np.where(way == 0, drift - plastic, way * dy)
            - b.gravity_load / b.height * drift
        )
        return np.concatenate((y[n:], -(below.T @ shear + damping @ y[n:]) / b.mass - (at + rise * (t - begin))))

    for sample, (at, after) in enumerate(zip(motion.acceleration[:-1], motion.acceleration[1:], strict=True)):
        begin, end = sample * motion.dt, (sample + 1) * motion.dt
        rise = (after - at) / motion.dt
        while t < end - 1e-13:
            ends = [lambda t, y, *_, i=i: limit * b.height[i] - abs((below @ y[:n])[i]) for i in range(n)]
            for i in range(n):
                if way[i]:
                    ends.append(lambda t, y, *_, i=i: way[i] * (below @ y[n:])[i])
                else:
                    ends.append(lambda t, y, *_, i=i: dy[i] - abs((below @ y[:n])[i] - plastic[i]))
            for one in ends:
                one.terminal, one.direction = True, -1
            found = solve_ivp(slope, (t, end), y, "DOP853", args=(begin, at, rise), events=ends, rtol=1e-12, atol=1e-15)
            y, t = found.y[:, -1], found.t[-1]
            if found.status == 1:
                e = next(e for e, times in enumerate(found.t_events) if times.size)
                if e < n:
                    return t, e + 1
                i = e - n
                drift = (below @ y[:n])[i]
                if way[i]:
                    plastic[i], way[i] = drift - way[i] * dy[i], 0
                else:
                    way[i] = 1 if drift > plastic[i] else -1
    raise AssertionError("it stands")


def test_shaken_building_against_another_integrator():
    """Three storeys under a motion that brings one down. Fails if another storey, or another instant, is named."""
    building = leaning(shear_building(0.9, 3, strength=0.25, damping=0.02), 0.12)
    scene = Scene((building,), (), shake(8.0, 6.0), INELASTIC)
    found = solve(scene, 1e-11)
    time, storey = independent(scene, 0.10)
    assert (found.status, found.collapse_storey) == ("collapsed", storey)
    assert found.collapse_time == pytest.approx(time, rel=1e-7)
    assert abs(found.energy["residual"]) < 1e-10
    coarse = solve(scene, 1e-6)
    told = assess(scene, coarse, 1e-6)
    assert abs(coarse.collapse_time / found.collapse_time - 1) <= told.error_estimate <= 1e-6


def falling_pair(kind: str = "pounding", gap: float = 0.02, foundation=None) -> Scene:
    """A building that comes down beside one that stands."""
    weak = leaning(shear_building(0.9, 3, foundation, strength=0.25, damping=0.02), 0.12)
    firm = shear_building(0.4, 3, foundation, strength=2.0)
    if kind == "hertz-damp":
        law = link_laws()[kind](gap=gap, hertz_stiffness=2e9, restitution=0.5)
        bridges = tuple(Link(0, j, j, law) for j in (1, 2, 3))
    else:
        bridges = links(kind, gap)
    return Scene((weak, firm), bridges, shake(8.0, 6.0), INELASTIC)


@pytest.mark.parametrize("foundation", [None, FOUNDATION])
@pytest.mark.parametrize(
    ("kind", "gap"), [("pounding", 0.0), ("pounding", 0.02), ("hertz-damp", 0.02), ("infill", 0.05)]
)
def test_beside_a_neighbour(kind, gap, foundation):
    """Fails if a contact keeps a collapse from being seen, or two accuracies name different ones."""
    scene = falling_pair(kind, gap, foundation)
    coarse, fine = solve(scene, 1e-7), solve(scene, 1e-10)
    assert coarse.status == "collapsed"
    assert [getattr(coarse, name) for name in WHERE[1:]] == [getattr(fine, name) for name in WHERE[1:]]
    assert coarse.collapse_building == 0
    assert coarse.collapse_time == pytest.approx(fine.collapse_time, rel=1e-7)
    assert difference(coarse, fine) < 1e-6
    assert abs(coarse.energy["residual"]) < 1e-8
    limits = scene.buildings[0].collapse_drift
    part = fine.buildings[0].drift / limits
    assert part.max() == pytest.approx(1.0, rel=1e-12)
    assert part.argmax() + 1 == fine.collapse_storey


@pytest.mark.parametrize("kind", ["pounding", "hertz-damp"])
def test_during_contact(kind):
    """A drift that is passed while the floors press. Fails if it is looked for between contacts alone."""
    weak, firm = (
        leaning(shear_building(0.5, 1, strength=0.25, damping=0.02), 0.12),
        shear_building(0.2, 1, strength=2.0),
    )
    bridges = falling_pair(kind, 0.0).links[:1]
    free = Scene((dataclasses.replace(weak, collapse=np.inf), firm), bridges, shake(4.0, 6.0), INELASTIC)
    kept = history(free, 1e-9, 0.0005)
    drift = np.abs(kept.drift[:, 0, 0])
    largest = np.maximum.accumulate(drift)
    new = np.flatnonzero((kept.link_force[1:, 0] > 0) & (drift[1:] > largest[:-1])) + 1
    at = new[len(new) // 2]
    ratio = float(0.5 * (largest[at] + largest[at - 1]) / 3.0)
    asked = dataclasses.replace(weak, collapse=ratio)
    found = solve(dataclasses.replace(free, buildings=(asked, firm)), 1e-9)
    assert found.status == "collapsed"
    assert kept.time[at - 1] <= found.collapse_time <= kept.time[at]
    assert found.buildings[0].drift[0] == pytest.approx(ratio * 3.0, rel=1e-12)


def test_chain_of_ten():
    """One building of ten comes down. Fails if the others are run on, or back, to another time."""
    weak = leaning(shear_building(0.9, 2, strength=0.25, damping=0.02), 0.12)
    row = [shear_building(0.3 + 0.05 * n, 2) for n in range(10)]
    row[6] = weak
    joined = tuple(link for left in range(9) for link in links("pounding", 0.01, (1, 2), left=left))
    scene = Scene(tuple(row), joined, shake(8.0, 6.0), INELASTIC)
    coarse, fine = solve(scene, 1e-7), solve(scene, 1e-10)
    assert (coarse.status, coarse.collapse_building) == ("collapsed", 6)
    assert difference(coarse, fine) < 1e-5
    cut = history(scene, 1e-9, 0.001)
    assert cut.time[-1] < fine.collapse_time <= cut.time[-1] + 0.0011
    assert np.nanmax(np.abs(cut.displacement[:, 0]), axis=0) == pytest.approx(
        np.maximum(fine.buildings[0].displacement_max, -fine.buildings[0].displacement_min), rel=1e-3
    )


def test_buildings_that_stand_apart_end_at_one_time():
    """Five buildings whose gaps stay open, so that each could take steps of its own. Fails if those beside the one that
    comes down are run on to the end of a sample, or stop at its beginning."""
    row = [shear_building(0.5 + 0.04 * n, 5, strength=2.0) for n in range(5)]
    row[2] = dataclasses.replace(leaning(shear_building(0.9, 5, strength=0.3, damping=0.02), 0.06), collapse=0.1)
    joined = tuple(link for left in range(4) for link in links("pounding", 2.0, (5,), left=left))
    scene = Scene(tuple(row), joined, shake(8.0, 6.0), INELASTIC)
    found, whole = solve(scene, 1e-10), solve(scene, 1e-10, all_effects=True)
    assert (found.status, found.collapse_building, found.links.impacts.sum()) == ("collapsed", 2, 0)
    assert found.collapse_time == pytest.approx(whole.collapse_time, rel=1e-8)
    for (u, _), (expected, _) in zip(found.final, whole.final, strict=True):
        assert u == pytest.approx(expected, abs=1e-9)


def test_in_the_first_step():
    """Fails if what is passed in the first step of all is seen in the second."""
    jolt = Motion("jolt", 0.01, np.array([1e4, 1e4, 0.0]))
    scene = Scene((dataclasses.replace(thrown().buildings[0], collapse=0.01),), (), jolt, INELASTIC)
    found = solve(scene, 1e-10)
    assert found.status == "collapsed"
    assert found.collapse_time < 0.01
    assert found.collapse_time == pytest.approx(np.sqrt(2 * 0.03 / 1e4), rel=2e-3)


@pytest.mark.parametrize("theta", [0.99, 1 - 1e-9])
def test_hardly_any_stiffness(theta):
    """Fails if a storey that just stands at rest is too hard to solve."""
    building = leaning(shear_building(0.5, 3, strength=0.5), theta)
    found = solve(Scene((building,), (), shake(4.0, 1.0), INELASTIC), 1e-9)
    assert found.status == "collapsed"
    assert abs(found.energy["residual"]) < 1e-9


def test_two_accuracies_that_disagree():
    """Fails if a run that stands, or in which another storey collapses, is taken to agree with one that collapses."""
    one, other = run(thrown()), run(thrown(collapse=np.inf))
    for unlike in (other, dataclasses.replace(one, collapse_storey=2), dataclasses.replace(one, collapse_building=1)):
        assert difference(one, unlike) == change(one, unlike) == np.inf
    assert change(one, one) == 0.0
    assert difference(one, run(thrown(collapse=0.09))) > 0.01
    assert layout.COLLAPSED not in (layout.DONE, layout.STALLED)


def test_an_outcome_that_is_open_is_flagged():
    """A collapse that a nudge of the motion decides, and one that no accuracy does. Fails if such a scene counts as
    well-conditioned, or its error as the difference of two peaks."""
    scene = thrown()
    falls, stands = run(scene), run(thrown(collapse=np.inf))
    nudged = assess(scene, falls, 1e-6, lambda asked, **_: falls if asked.motion is scene.motion else stands)
    assert (nudged.sensitivity, nudged.error_estimate) == (np.inf, 0.0)
    assert any("decides which storey collapses" in flag for flag in nudged.flags)
    unsettled = assess(scene, falls, 1e-6, lambda _, accuracy, **__: falls if 1e-13 < accuracy < 1e-10 else stands)
    assert unsettled.error_estimate == np.inf
    assert any("which storey collapses, or whether one does, is open" in flag for flag in unsettled.flags)
