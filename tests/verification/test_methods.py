"""The family of methods: declared orders, stability limits, agreement with one another and with other programs."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from pounding_cli.errors import InputError
from pounding_cli.methods import METHODS
from pounding_cli.model.scene import Scene
from pounding_cli.solve import generalized_alpha as family
from pounding_cli.solve import solve
from pounding_cli.solve.arrays import at_rest, pack
from pounding_cli.solve.method import integrator_of
from tests.helpers.scenes import (
    ELASTIC,
    FOUNDATION,
    INELASTIC,
    gather,
    links,
    oscillator,
    pair,
    shake,
    shear_building,
    still,
)
from tests.reference import events, exponential

STEPPING = [name for name, method in METHODS.items() if method.takes_step]
FOLLOWING = [name for name, method in METHODS.items() if not method.takes_step]


def order(errors, ratio: float = 2.0) -> float:
    """Slope of log error over log step, by least squares."""
    steps = -np.arange(len(errors)) * np.log(ratio)
    return float(np.polyfit(steps, np.log(errors), 1)[0])


def final_error(found, u, v) -> float:
    """Largest error of a displacement at the end over the largest displacement there."""
    floors = np.concatenate([pair[0] for pair in found.final])
    return float(np.abs(floors - u).max() / np.abs(u).max())


@pytest.fixture(scope="module")
def smooth():
    """A connected elastic pair on foundations with its exact end."""
    scene = pair("connector", 0.05, shake(1.0), foundation=FOUNDATION)
    _, u, v = exponential.march(scene)
    floors = [0, 1, 2, 5, 6, 7]
    return scene, u[-1, floors], v[-1, floors]


@pytest.mark.parametrize("name", STEPPING)
def test_declared_order_where_nothing_jumps(smooth, name):
    """Fails if a stage weight, beta or gamma is off, or the ground is held constant over a step."""
    scene, u, v = smooth
    errors = [final_error(solve(scene, method=name, time_step=0.02 / parts), u, v) for parts in (16, 32, 64, 128)]
    declared = METHODS[name].order
    assert order(errors) == pytest.approx(declared, abs=0.15)
    assert errors[-1] < {2: 2e-4, 4: 2e-9}[declared]


@pytest.mark.parametrize("name", FOLLOWING)
def test_methods_that_follow_the_accuracy(smooth, name):
    """Fails if a Taylor order or a power of the propagator is dropped."""
    scene, u, v = smooth
    for accuracy in (1e-4, 1e-7, 1e-10):
        assert final_error(solve(scene, accuracy, name), u, v) < accuracy


HARD = {
    "touching": dict(kind="pounding", gap=0.0, analysis=INELASTIC),
    "tension cut": dict(kind="pounding", gap=0.005, analysis=ELASTIC, foundation=FOUNDATION, tension_cut=True),
    "infill": dict(kind="infill", gap=0.01, analysis=INELASTIC),
}


@pytest.fixture(scope="module", params=HARD, ids=str)
def hard(request):
    """A scene with contacts and an independent event-located solution of it."""
    options = dict(HARD[request.param])
    scene = pair(options.pop("kind"), options.pop("gap"), shake(1.2), **options)
    return scene, events.integrate(scene)


def test_location_keeps_the_order_at_contacts(hard):
    """Fourth order between contacts and yields. Fails if an event is booked at the end of its step."""
    scene, reference = hard
    runs = [solve(scene, method="rk4-events", time_step=0.02 / parts) for parts in (50, 100, 200, 400)]
    errors = [final_error(run, reference.displacement, reference.velocity) for run in runs]
    assert order(errors) > 3.5
    assert errors[-1] < 1e-8
    last = runs[-1]
    assert gather(last, "shear") == pytest.approx(reference.shear, rel=1e-7)
    assert gather(last, "acceleration") == pytest.approx(reference.acceleration, rel=2e-6)
    assert last.links.peak_force == pytest.approx(reference.peak_force, rel=2e-6, abs=1.0)
    assert last.links.impulse == pytest.approx(reference.impulse, rel=1e-6, abs=1.0)
    assert last.links.contact_time == pytest.approx(reference.contact_time, rel=1e-6, abs=1e-9)
    assert list(last.links.impacts) == list(reference.impacts)


def test_fixed_steps_lose_their_order_at_contacts():
    """Without location a method of fourth order is worse than second where floors touch: the error follows the step."""
    scene = pair("pounding", 0.0, shake(1.2), INELASTIC)
    reference = events.integrate(scene)
    runs = [solve(scene, method="rk4", time_step=0.02 / parts) for parts in (50, 100, 200, 400, 800)]
    errors = [final_error(run, reference.displacement, reference.velocity) for run in runs]
    assert 0.3 < order(errors) < 2.0
    located = solve(scene, method="rk4-events", time_step=0.02 / 800)
    assert errors[-1] > 1e3 * final_error(located, reference.displacement, reference.velocity)


@pytest.mark.parametrize("name", [n for n in STEPPING if n != "rk4-events"])
def test_every_method_runs_every_scene_it_claims(hard, name):
    """Coarse, as such methods are at contacts, but the same scene. Fails if a link law or the gap is left out."""
    scene, reference = hard
    found = solve(scene, method=name, time_step=2e-5)
    assert found.status == "done"
    assert gather(found, "shear") == pytest.approx(reference.shear, rel=0.02)
    assert gather(found, "acceleration") == pytest.approx(reference.acceleration, rel=0.05)
    assert found.links.peak_force == pytest.approx(reference.peak_force, rel=0.05, abs=1e4)
    assert found.links.impulse == pytest.approx(reference.impulse, rel=0.05, abs=1e3)


def paper(kind: str, gap: float, analysis, **law) -> Scene:
    """Two five-storey buildings as in Fig. 6, linked at every floor, for 2 s."""
    floors = (3, 5) if kind == "connector" else (1, 2, 3, 4, 5)
    buildings = shear_building(0.36, 5), shear_building(0.60, 5)
    return Scene(buildings, links(kind, gap, floors, **law), shake(2.0), analysis)


@pytest.mark.parametrize("analysis", [ELASTIC, INELASTIC])
@pytest.mark.parametrize(
    ("kind", "gap"), [("pounding", 0.0), ("pounding", 0.01), ("infill", 0.05), ("connector", 0.05)]
)
def test_all_methods_agree_on_the_scenes_of_the_paper(kind, gap, analysis):
    """Two located methods to 1e-6, the others to what their step allows. Fails if any method scales a motion."""
    scene = paper(kind, gap, analysis)
    exact = gather(solve(scene, 1e-10), "shear")
    assert gather(solve(scene, method="rk4-events", time_step=1e-4), "shear") == pytest.approx(exact, rel=1e-6)
    for name in STEPPING:
        bound = 2e-2 if kind == "pounding" else 1e-3
        assert gather(solve(scene, method=name, time_step=1e-4), "shear") == pytest.approx(exact, rel=bound), name
    if kind == "connector" and analysis == ELASTIC:
        assert gather(solve(scene, 1e-6, "exponential"), "shear") == pytest.approx(exact, rel=1e-9)


def test_coinciding_events_leave_no_false_peaks():
    """Two equal buildings around a third yield at the same instant, or all but: steps of 1e-17 s lie between. Fails if
    the mean acceleration of such a step is asked for."""
    buildings = shear_building(0.60), shear_building(0.36), shear_building(0.60)
    scene = Scene(buildings, links("pounding", 0.07) + links("pounding", 0.07, left=1), shake(4.0), INELASTIC)
    found = solve(scene, method="rk4-events", time_step=2e-4)
    assert found.events > 50
    assert gather(found, "acceleration") == pytest.approx(gather(solve(scene, 1e-10), "acceleration"), rel=1e-5)


def test_exact_stepping_finds_peaks_between_samples():
    """Against exact states on a grid 40 times finer. Fails if only record samples are looked at."""
    scene = pair("connector", 0.05, shake(1.0), foundation=FOUNDATION)
    motion = scene.motion
    times = np.arange(40 * (motion.acceleration.size - 1) + 1) * motion.dt / 40
    fine = np.interp(times, np.arange(motion.acceleration.size) * motion.dt, motion.acceleration)
    _, u, v = exponential.march(
        dataclasses.replace(scene, motion=dataclasses.replace(motion, dt=motion.dt / 40, acceleration=fine))
    )
    found = solve(scene, 1e-8, "exponential")
    largest = u.max(axis=0)[[0, 1, 2, 5, 6, 7]]
    assert gather(found, "displacement_max") == pytest.approx(largest, rel=1e-4)
    assert (gather(found, "displacement_max") >= largest * (1 - 1e-12)).all()
    closing = u[:, [0, 1, 2]] - u[:, [5, 6, 7]]
    rate = v[:, [0, 1, 2]] - v[:, [5, 6, 7]]
    link = scene.links[0]
    force = link.law.stiffness * closing + link.law.branches(2e5, 2e5)[0].dashpot * rate
    assert found.links.peak_force == pytest.approx(np.abs(force).max(axis=0), rel=1e-3)
    assert found.links.impulse == pytest.approx(np.trapezoid(force, times, axis=0), rel=1e-3)
    taylor = solve(scene, 1e-12)
    for name in ("shear", "drift", "acceleration", "displacement_min"):
        assert gather(found, name) == pytest.approx(gather(taylor, name), rel=1e-8), name
    assert found.links.impulse == pytest.approx(taylor.links.impulse, rel=1e-9)
    assert found.buildings[0].rocking == pytest.approx(taylor.buildings[0].rocking, rel=1e-8)


def free(xi: float) -> Scene:
    """An oscillator and a stiffer building, let go."""
    return Scene((oscillator(2e5, 2e5 * 40.0**2, xi), shear_building(0.36, damping=xi)), (), still(20.0), ELASTIC)


def largest(scene: Scene, name: str, step: float) -> float:
    """Largest displacement of a run whose stability nobody asked about."""
    arrays = pack(scene)
    state, peaks, ledger, _ = at_rest(arrays)
    state.u[0], state.u[3] = 0.01, 0.01
    integrator_of(METHODS[name]).integrate(scene, arrays, state, peaks, ledger, step, (10**8, 10**8))
    return float(np.abs(state.u).max()) if np.isfinite(state.u).all() else np.inf


@pytest.mark.parametrize("xi", [0.0, 0.05, 0.3])
@pytest.mark.parametrize("name", ["central-difference", "rk4", "rk4-events"])
def test_stability_limit(name, xi):
    """Bounded just below it, without bound just above. Fails if the damping in the limit is forgotten."""
    scene = free(xi)
    limit = integrator_of(METHODS[name]).largest_step(pack(scene))

    def at(step: float) -> Scene:
        return dataclasses.replace(scene, motion=still(60.0, step))

    assert largest(at(0.98 * limit), name, 0.98 * limit) < 0.1
    assert largest(at(1.03 * limit), name, 1.03 * limit) > 1.0


@pytest.mark.parametrize("name", ["central-difference", "rk4", "rk4-events"])
def test_a_step_above_the_limit_is_not_run(name):
    """Fails if the limit forgets that links close."""
    scene = pair("pounding", 0.02, shake(1.0), stiffness=2e12)
    found = solve(scene, method=name, time_step=0.02)
    assert found.status == "unstable step"
    assert "use a time step below" in found.advice
    assert np.isnan(gather(found, "shear")).all()
    limit = float(found.advice.split("below ")[1].split()[0])
    assert solve(scene, method=name, time_step=0.9 * limit).status == "done"


def test_newmark_cuts_steps_without_a_root():
    """The dashpot's force jumps as a link closes, so a step may have no solution; halves of it have. Fails if such a
    step is accepted as it is."""
    scene = pair("pounding", 0.0, shake(4.0))
    for name in ("newmark", "hht-alpha", "generalized-alpha"):
        found = solve(scene, method=name, time_step=2e-3)
        assert found.status == "done"
        assert found.events > 0, name
        assert any("no root" in flag for flag in found.flags), name
        assert gather(found, "shear") == pytest.approx(gather(solve(scene, 1e-8), "shear"), rel=0.2)


def test_newmark_says_where_it_has_to_give_up(monkeypatch):
    """Without cuts the same scene ends in a named outcome with advice, not in numbers."""
    monkeypatch.setattr(family, "MAX_CUTS", 0)
    found = solve(pair("pounding", 0.0, shake(4.0)), method="newmark", time_step=2e-3)
    assert found.status == "no root"
    assert "taylor" in found.advice
    assert np.isnan(gather(found, "shear")).all()


def test_closed_form_of_a_step_without_a_root():
    """One Newmark step of a mass at v just below contact: closed and open contradict each other where
    0 < v_open < beta h^2 F / m', which is found and cut."""
    h, v0, s, xi = 1e-3, 0.5, 2e9, 0.2
    scene = Scene(
        (oscillator(2e5, 1e-3), oscillator(2e5, 1e-3)),
        links("pounding", 0.0, (1,), xi=xi, stiffness=s),
        still(h, h),
        ELASTIC,
    )
    dashpot = scene.links[0].law.branches(2e5, 2e5)[1].dashpot
    push = 0.25 * h**2 * dashpot * v0 / 1e5  # how far the force of a closed contact moves the floors back in the step
    for inside, cut in ((0.3 * push, True), (5.0 * push, False)):
        start = inside - h * v0
        found = solve(scene, method="newmark", time_step=h, initial=([[start], [0.0]], [[v0], [0.0]]))
        assert (found.events > 0) == cut


@pytest.mark.parametrize(
    ("scene", "reason"),
    [
        (pair("pounding", 0.01, shake(0.4)), "pounding links"),
        (pair("infill", 0.01, shake(0.4)), "infill links"),
        (pair("connector", 0.01, shake(0.4), INELASTIC), "storeys can yield"),
    ],
)
def test_exact_stepping_refuses_what_is_not_linear(scene, reason):
    """Fails if a contact is stepped over as if it were not there."""
    with pytest.raises(InputError, match=reason):
        solve(scene, 1e-6, "exponential")


@pytest.mark.parametrize(
    ("method", "told", "why"),
    [
        ("euler", {}, "there is no method euler"),
        ("rk4", {"time_step": 0.0}, "time step is 0; it must be above zero"),
        ("rk4", {"time_step": np.inf}, "time step is inf; it must be above zero"),
        ("rk4", {"time_step": np.nan}, "time step is nan"),
        ("taylor", {"accuracy": -1e-6}, "accuracy is -1e-06"),
        ("rk4", {}, "method rk4 takes a time step"),
        ("newmark", {"accuracy": 1e-4}, "method newmark takes a time step"),
        ("taylor", {"time_step": 1e-4}, "method taylor does not use a time step"),
        ("auto", {"time_step": 1e-4}, "method auto does not use a time step"),
    ],
)
def test_refused_settings(method, told, why):
    """An unknown method, a setting that it does not take, or one that is no number above zero."""
    with pytest.raises(InputError, match=why):
        solve(pair("pounding", 0.01, shake(0.4)), method=method, **told)


@pytest.mark.parametrize("name", METHODS)
def test_a_response_says_the_setting_that_it_was_solved_by(name):
    """An accuracy or a time step, never the one under the name of the other."""
    setting = METHODS[name].setting
    found = solve(pair("connector", 0.05, shake(0.4)), method=name, **{setting.key: 1e-3})
    assert {"accuracy": found.accuracy, "time_step": found.time_step} == pytest.approx(
        {"accuracy": np.nan, "time_step": np.nan} | {setting.key: 1e-3}, nan_ok=True
    )


def test_methods_state_what_they_are():
    """Every entry of the table under its own name, with a citation and a stability limit in words."""
    for name, method in METHODS.items():
        assert method.name == name
        assert any(year in method.source for year in map(str, range(1900, 2030)))
        assert method.stability
        assert (method.order > 0) == method.takes_step
