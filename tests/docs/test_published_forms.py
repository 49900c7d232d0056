"""The closed forms in statements of docs/published/ are those of their sources, and agree with second methods."""

from __future__ import annotations

import re
from functools import cache
from math import pi
from typing import Any

import numpy as np
import pytest
import yaml
from pages import ROOT
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import pounding_cli as pound
from pounding_cli.study.schema.quantity import written_unit
from pounding_cli.units import parse_unit
from tests.reference import published

STUDIES = ROOT / "docs" / "published"
CLOSED_FORM = "closed form"
"""Begins the source of a statement whose number a formula gives that its source does not evaluate."""

INCH, POUND = 0.0254, 4.4482216152605
"""[m] and [N]"""
OSCILLATORS = ((2.0, 0.5, 0.1), (2.0, 0.65, 0.1), (2.3, 0.5, 0.1), (1.7, 0.5, 0.3), (1.5, 0.5, 0.2), (1.2, 0.5, 1.0))
"""w [-], r [-] and s [-] of impact-oscillator."""
RESONANT = ((4.0, 0.5, 0.02, 2), (4.0, 0.65, 0.02, 2), (6.0, 0.5, 0.01, 3), (6.0, 0.3, 0.01, 3))
"""w, r, s and the periods of the force from blow to blow of impact-resonance."""
DOUBLING = ((2.5, 0.5), (2.6, 0.5), (2.6, 0.6))
"""w and r of impact-doubling."""
SPHERES = {"glass": (5.864306e-3, 2.357023e9, 20.0), "aluminium": (11.305545, 3.243367e10, 0.2)}
"""Mass [kg], stiffness k_h [N/m^1.5] and speed [m/s] of hertz-impact."""
WAVE = published.find_wave_time(1.0, 2e11, 7800.0)


def list_forms() -> dict[tuple[str, str], float]:
    """The numbers of closed forms by study and statement, in SI, or in the unit that the statement's words have."""
    forms: dict[tuple[str, str], float] = {}
    for w, r, s in OSCILLATORS:
        forms["impact-oscillator", f"speed w {w:g} r {r:g}"] = published.find_rigid_speed(w, r, s) / (2 * pi)
    for w, r, s, periods in RESONANT:
        forms["impact-resonance", f"speed w {w:g} r {r:g}"] = published.find_rigid_speed(w, r, s, periods) / (2 * pi)
    for w, r in DOUBLING:
        for side in ("before", "beyond"):
            forms["impact-doubling", f"{side} w {w:g} r {r:g}"] = published.find_doubling_wall(w, r)
    plate = published.find_plate_blow(mass=2e5, width=30.0, depth=20.0, place=10.0, speed=0.5, e=0.5)
    for name, number in zip(("impulse", "twist", "speed", "loss"), plate, strict=True):
        forms["eccentric-blow", name] = number
    travel = published.find_travel(mass=8e3, stiffness=2e5, friction=0.25, speed=5.0, way=2.0)
    for name, number in zip(("compression", "way back"), travel, strict=True):
        forms["sliding-block", f"{name} by energy"] = number
    deepest = published.find_deepest(0.5 * POUND / INCH, 1973.92 * POUND / INCH, INCH, 386 * INCH)
    forms["dropped-container", "its time by the equation"] = deepest
    forms["elastic-stop", "impulse by the equation"] = published.find_stop_impulse(100.0, 1e4, 1e6, 1.0)
    frequency = published.find_frequency(0.00650108331626, 1.0, 10.0, 50.0, 0.01)
    forms["one-sided-oscillator", "frequency by quarters"] = frequency
    for name, sphere in SPHERES.items():
        force, duration = published.find_hertz_blow(*sphere)
        forms["hertz-impact", f"{name} force by Hertz"] = force
        forms["hertz-impact", f"{name} duration by Hertz"] = duration
    for time in (0.2, 0.4, 0.6, 1.0):
        forms["rod-and-rod", f"wave at {time:g} ms"] = published.find_rod_displacement(time / 1000, WAVE)
    forms["rod-and-rod", "end by the wave"] = 4 * WAVE
    for speed in (0.2, 5.0):
        for law in ("pounding", "hertz-damp", "jankowski", "bilinear"):
            forms["restitution-speed", f"{law} at {speed:g} cm per s"] = published.find_ice_restitution(speed / 100)
    largest = published.find_sudden_displacement(45.286, 83.4, 30.0) * INCH
    forms["sudden-force", "largest by the work"] = largest
    return forms


FORMS = list_forms()


@cache
def read_study(name: str) -> dict[str, Any]:
    return yaml.safe_load((STUDIES / f"{name}.yaml").read_text(encoding="utf-8"))


def read_statements() -> dict[tuple[str, str], dict[str, Any]]:
    """The statements of closed forms by study and name."""
    return {
        (path.stem, each.get("name", "")): each
        for path in sorted(STUDIES.glob("*.yaml"))
        for each in read_study(path.stem).get("statements", ())
        if each.get("source", "").startswith(CLOSED_FORM)
    }


STATEMENTS = read_statements()


def read_number(statement: dict[str, Any]) -> float:
    """What a statement's number should be; of one that compares, the one that its source names."""
    if "is" not in statement:
        return float(re.search(r"s = ([\d.]+)", statement["source"])[1])
    written = str(statement["is"])
    unit = written_unit(written)
    return float(written.removesuffix(unit)) * (parse_unit(unit)[0] if unit else 1.0)


@pytest.mark.parametrize(("study", "name"), FORMS)
def test_a_closed_form_is_that_of_its_source(study, name):
    """Fails if a literal of a study is mistyped, or a formula changes."""
    assert read_number(STATEMENTS[study, name]) == pytest.approx(FORMS[study, name], rel=1e-5)


def test_every_closed_form_of_a_study_has_its_function():
    studies = {study for study, _ in FORMS}
    assert {key for key in STATEMENTS if key[0] in studies} == set(FORMS)


@pytest.mark.parametrize(("w", "r"), DOUBLING)
def test_the_nearest_walls_stand_on_both_sides_of_the_place(w, r):
    """Fails if a gap of the study is not the place that its statement tells, or stands on the other side."""
    wall = published.find_doubling_wall(w, r)
    gaps = {}
    for side in ("before", "beyond"):
        statement = STATEMENTS["impact-doubling", f"{side} w {w:g} r {r:g}"]
        gap = str(statement["at"]["cases.wall.gap"])
        assert gap in read_study("impact-doubling")["sweep"][0]["cases.wall.gap"]
        gaps[side] = float(gap.removesuffix(" mm")) / 1000 * 4 * pi**2 / w**2
        assert gaps[side] == pytest.approx(float(re.search(r"wall at s = ([\d.]+)", statement["reading"])[1]), rel=1e-5)
    assert gaps["before"] < wall < gaps["beyond"]
    assert gaps["beyond"] - gaps["before"] == pytest.approx(0.004, abs=1e-6)


# Formulas against second methods


@pytest.mark.parametrize(
    ("oscillator", "speed"),
    list(zip(OSCILLATORS, (0.404864, 0.578378, 0.120573, 0.459357, 0.337333, 0.393713), strict=True)),
)
def test_speeds_on_a_rigid_wall(oscillator, speed):
    assert published.find_rigid_speed(*oscillator) / (2 * pi) == pytest.approx(speed, abs=6e-7)


def find_blows(w: float, r: float, s: float, number: int) -> tuple[list[float], list[float]]:
    """Return times and speeds of blows of x'' + x = cos(w t) on a rigid wall at s, each found from the one before."""
    amplitude = 1 / (1 - w**2)
    times, speeds = [0.1], [0.3]
    for _ in range(number):
        start = times[-1]
        even = s - amplitude * np.cos(w * start)
        odd = w * amplitude * np.sin(w * start) - r * speeds[-1]

        def reach(t, start=start, even=even, odd=odd):
            return even * np.cos(t - start) + odd * np.sin(t - start) + amplitude * np.cos(w * t) - s

        grid = start + np.linspace(1e-3, 20 * pi / w, 2000)
        first = int(np.argmax(reach(grid) > 0))
        end = brentq(reach, grid[first - 1], grid[first], xtol=1e-15)
        times.append(end)
        free = odd * np.cos(end - start) - even * np.sin(end - start)
        speeds.append(float(free - w * amplitude * np.sin(w * end)))
    return times, speeds


@pytest.mark.parametrize(("w", "r", "s", "periods"), RESONANT)
def test_speeds_of_blows_once_in_several_periods(w, r, s, periods):
    """Fails if the closed form is not the speed that blows on a rigid wall settle at."""
    times, speeds = find_blows(w, r, s, 60)
    assert speeds[-1] == pytest.approx(published.find_rigid_speed(w, r, s, periods), rel=1e-6)
    assert times[-1] - times[-2] == pytest.approx(2 * pi * periods / w, rel=1e-6)


@pytest.mark.parametrize(("w", "r"), DOUBLING)
def test_blows_alternate_beyond_the_wall_of_the_closed_form_only(w, r):
    s = published.find_doubling_wall(w, r)
    _, before = find_blows(w, r, s - 1e-3, 800)
    _, beyond = find_blows(w, r, s + 1e-3, 800)
    assert abs(before[-1] - before[-2]) < 1e-5
    assert abs(beyond[-1] - beyond[-2]) > 3e-3


def test_the_blow_of_a_plate_keeps_momentum_and_loses_energy():
    """Against the kinetic energy before and after, and the speed with which the point that strikes leaves the wall."""
    mass, place, speed, e = 2e5, 10.0, 0.5, 0.5
    inertia = mass * (30.0**2 + 20.0**2) / 12
    impulse, turning, after, loss = published.find_plate_blow(mass, 30.0, 20.0, place, speed, e)
    assert mass * (speed - after) == pytest.approx(impulse)
    assert after - place * turning == pytest.approx(-e * speed)
    assert mass * (speed**2 - after**2) / 2 - inertia * turning**2 / 2 == pytest.approx(loss)


def test_the_travel_of_the_block_is_that_of_its_source():
    """Within the rounding of a calculation by hand."""
    compression, way_back = published.find_travel(8e3, 2e5, 0.25, 5.0, 2.0)
    assert compression == pytest.approx(0.688, abs=5e-4)
    assert way_back == pytest.approx(1.73, abs=1e-2)


def at_rest(move, start, direction) -> float:
    """Return when the speed, the second of a state, next passes zero."""

    def rest(_time, state):
        return state[1]

    rest.terminal, rest.direction = True, direction
    run = solve_ivp(move, (0, 10), start, events=rest, rtol=1e-10, atol=1e-14, max_step=1e-3)
    return float(run.t_events[0][0])


def test_the_fall_on_a_spring_is_deepest_at_the_time_of_the_closed_form():
    """Against the fall step by step."""
    mass, stiffness, height, gravity = 2.0, 500.0, 0.1, 9.81

    def move(_time, state):
        return state[1], gravity - stiffness * max(state[0] - height, 0.0) / mass

    found = published.find_deepest(mass, stiffness, height, gravity)
    assert found == pytest.approx(at_rest(move, (0.0, 1e-12), -1), rel=1e-7)


def test_the_impulse_on_a_stop_is_that_of_its_force():
    mass, stiffness, stop, speed = 3.0, 20.0, 700.0, 0.4
    frequency = ((stiffness + stop) / mass) ** 0.5
    times = np.linspace(0, pi / frequency, 20001)
    force = stop * speed / frequency * np.sin(frequency * times)
    found = published.find_stop_impulse(mass, stiffness, stop, speed)
    assert found == pytest.approx(np.trapezoid(force, times), rel=1e-7)


def test_frequency_beside_a_soft_stop():
    """Against the same oscillator step by step, from its rest on the free side to its rest on the stop."""
    energy, mass, stiffness, stop, gap = 0.0065, 1.0, 10.0, 50.0, 0.01

    def move(_time, state):
        return state[1], -(stiffness * state[0] + stop * max(state[0] - gap, 0.0)) / mass

    start = (-((2 * energy / stiffness) ** 0.5), 1e-12)
    found = published.find_frequency(energy, mass, stiffness, stop, gap)
    assert found == pytest.approx(0.5 / at_rest(move, start, -1), rel=1e-7)


def test_the_largest_displacement_under_a_sudden_force():
    """Against the yielding oscillator step by step."""
    strength, stiffness, force = 2.0, 3.0, 1.4

    def move(_time, state):
        return state[1], force - min(stiffness * state[0], strength)

    time = at_rest(move, (0.0, 1e-12), -1)
    run = solve_ivp(move, (0, time), (0.0, 0.0), rtol=1e-10, atol=1e-14, max_step=1e-3)
    assert published.find_sudden_displacement(strength, stiffness, force) == pytest.approx(run.y[0, -1], rel=1e-7)


def test_end_of_a_rod_that_strikes_another():
    """Against a string of springs and masses in steps of the wave's time from one to the next, which has no error."""
    pieces = 200
    count = 2 * pieces + 1
    step = WAVE / pieces
    here = np.zeros(count + 1)  # the free rod, then the fixed one; one place of both where they touch
    before = here.copy()
    before[: pieces + 1] = step  # the free rod moves towards the other at 1 m/s
    before[pieces] = step / 2  # of which the place in common has half
    for number in range(int(3.9 * pieces)):
        found = published.find_rod_displacement(number * step, WAVE)
        assert here[pieces] == pytest.approx(found, abs=1.01 * step)
        left = np.concatenate([[here[1]], here[:-1]])  # the free end mirrors its neighbour
        right = np.concatenate([here[1:], [0.0]])
        here, before = left + right - before, here
        here[-1] = 0.0


def test_blows_of_spheres_are_those_of_hertz(tmp_path):
    """As closely as the storeys, of 1e-6 N/m, leave the spheres free."""
    results = pound.run(STUDIES / "hertz-impact.yaml", tmp_path / "hertz.h5")
    blows = results.link().set_index("impact.hertz_stiffness")
    for mass, stiffness, speed in SPHERES.values():
        exact = published.find_hertz_blow(mass, stiffness, speed)
        assert tuple(blows.loc[stiffness, ["peak_force", "contact_time"]]) == pytest.approx(exact, rel=3e-6)


def test_the_motion_of_sdnd102_starts_the_oscillator_as_its_header_says():
    """Fails if the file is not that of the formula, or leaves the oscillator with another place or speed at 0.1 s."""
    motion = np.loadtxt(STUDIES / "sdnd102.txt")
    step, lead, damping, w = 0.5e-3, 0.1, 0.07, 20 * pi
    times = step * np.arange(len(motion))
    harmonic = np.sin(w * (times - lead)) + 2 * damping * np.cos(w * (times - lead))
    start = round(lead / step)
    assert motion[start:] == pytest.approx(harmonic[start:], abs=1e-6)

    def move(time, state):
        return state[1], -np.interp(time, times, motion) - 2 * damping * w * state[1] - w**2 * state[0]

    run = solve_ivp(move, (0, lead), (0.0, 0.0), rtol=1e-9, atol=1e-14, max_step=step)
    assert run.y[0, -1] == pytest.approx(0.0, abs=1e-8)
    assert run.y[1, -1] == pytest.approx(-1 / w, rel=1e-4)
    assert run.y[0].max() < 0.5e-3  # no contact before
