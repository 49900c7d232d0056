"""The tables of docs/published.md are those that its studies give; closed forms in them are those of the sources."""

from __future__ import annotations

import os
import re
import sys
from math import exp, pi, sqrt
from pathlib import Path

import numpy as np
import pytest
from pages import ROOT, hook
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import pounding_cli
from pounding_cli.errors import InputError

PUBLISHED = hook("published")
IMPACT_OSCILLATOR = sys.modules["impact_oscillator"]
ONE_SIDED_OSCILLATOR = sys.modules["one_sided_oscillator"]
ROD_AND_ROD = sys.modules["rod_and_rod"]
IMPACT_RESONANCE = sys.modules["impact_resonance"]
IMPACT_DOUBLING = sys.modules["impact_doubling"]
HERTZ_IMPACT = sys.modules["hertz_impact"]
STUDIES = sys.modules["comparison"].STUDIES
SLIDING_BLOCK = sys.modules["sliding_block"]
SUPERPOSITION = sys.modules["superposition"]
SOON = ("eccentric-blow", "sliding-block")
"""Studies that every run of the tests looks at; `make reference` and `make docs` run the others too."""

NUMBER = re.compile(r"[-+−]?\d+(?:\.\d+)?")


def test_every_study_has_a_table_on_the_page():
    text = PUBLISHED.PAGE.read_text(encoding="utf-8")
    assert {path.stem for path in STUDIES.glob("*.yaml")} <= set(PUBLISHED.ENTRIES)
    for name in PUBLISHED.ENTRIES:
        _, table, _ = PUBLISHED.split_page(text, name)
        assert table.startswith("| quantity | published | ours | difference | why |\n|---|"), name


def test_the_overview_is_that_of_the_tables():
    """Fails if a row, a heading or the largest difference of a study changes and the overview does not."""
    text = PUBLISHED.PAGE.read_text(encoding="utf-8")
    assert PUBLISHED.put_overview(text) == text
    assert f"[{len(PUBLISHED.ENTRIES)} studies](docs/published.md)" in (ROOT / "README.md").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("differences", "said"),
    [
        (["+0.10 %", "-0.39 %"], "0.39 %"),
        (["+0.15 µs", "none", "3 frequencies"], "0.15 µs, 1 of 2 statements hold"),
        (["4 blows"], "0 of 1 statements hold"),
        (["not known", "not known"], "not known"),
    ],
)
def test_the_overview_tells_the_largest_difference(differences, said):
    table = "\n".join(["| head |", "|---|", *(f"| x | 1 | 1 | {each} | why |" for each in differences)])
    assert PUBLISHED.summarise_table(table) == said


@pytest.mark.parametrize("name", PUBLISHED.ENTRIES)
def test_its_table_is_that_of_the_page(name):
    """Fails if a number of the page is another one than the study gives."""
    if name not in SOON and "POUND_NIGHTLY" not in os.environ:
        pytest.skip("make reference runs it every night")
    if missing := PUBLISHED.ENTRIES[name].find_missing_sources():
        pytest.skip(f"needs a motion of {', '.join(missing)}")
    _, table, _ = PUBLISHED.split_page(PUBLISHED.PAGE.read_text(encoding="utf-8"), name)
    assert PUBLISHED.format_rows(PUBLISHED.find_rows(name)) == table


def test_a_study_says_where_its_motions_come_from(monkeypatch, tmp_path):
    entry = sys.modules["comparison"].Entry
    packaged = entry(rows=iter, motions=("no_such_package/motion.csv", "numpy/motion.csv"))
    assert packaged.find_missing_sources() == ["`pip install no_such_package`"]
    public = entry(rows=iter, motions=("folder/motion.txt",), repository="owner/motions")
    monkeypatch.setenv("POUND_CHECKOUTS", str(tmp_path))
    assert public.find_missing_sources() == ["a checkout of github.com/owner/motions in the folder POUND_CHECKOUTS"]
    (tmp_path / "motions").mkdir()
    assert public.find_missing_sources() == []
    assert list(public.find_motions()) == [tmp_path / "motions" / "folder" / "motion.txt"]


@pytest.mark.parametrize(
    ("oscillator", "speed"),
    list(zip(IMPACT_OSCILLATOR.OSCILLATORS, (0.404864, 0.578378, 0.120573, 0.459357, 0.337333, 0.393713), strict=True)),
)
def test_speeds_on_a_rigid_wall(oscillator, speed):
    assert IMPACT_OSCILLATOR.find_rigid_speed(*oscillator) / (2 * pi) == pytest.approx(speed, abs=6e-7)


def test_frequency_beside_a_soft_stop():
    """Against the same oscillator step by step, from its rest on the free side to its rest on the stop."""
    energy, mass, stiffness, stop, gap = 0.0065, 1.0, 10.0, 50.0, 0.01

    def move(_time, state):
        return state[1], -(stiffness * state[0] + stop * max(state[0] - gap, 0.0)) / mass

    def rest(_time, state):
        return state[1]

    rest.terminal, rest.direction = True, -1
    start = (-((2 * energy / stiffness) ** 0.5), 1e-12)
    run = solve_ivp(move, (0, 10), start, events=rest, rtol=1e-10, atol=1e-14, max_step=1e-3)
    found = ONE_SIDED_OSCILLATOR.find_frequency(energy, mass, stiffness, stop, gap)
    assert found == pytest.approx(0.5 / run.t_events[0][0], rel=1e-7)


def test_end_of_a_rod_that_strikes_another():
    """Against a string of springs and masses in steps of the wave's time from one to the next, which has no error."""
    pieces = 200
    count = 2 * pieces + 1
    step = ROD_AND_ROD.WAVE / pieces
    here = np.zeros(count + 1)  # the free rod, then the fixed one; one place of both where they touch
    before = here.copy()
    before[: pieces + 1] = step  # the free rod moves towards the other at 1 m/s
    before[pieces] = step / 2  # of which the place in common has half
    for number in range(int(3.9 * pieces)):
        assert -here[pieces] == pytest.approx(-ROD_AND_ROD.find_displacement(number * step), abs=1.01 * step)
        left = np.concatenate([[here[1]], here[:-1]])  # the free end mirrors its neighbour
        right = np.concatenate([here[1:], [0.0]])
        here, before = left + right - before, here
        here[-1] = 0.0


def test_the_travel_of_the_block_is_that_of_its_source():
    """Within the rounding of a calculation by hand."""
    compression, way_back = SLIDING_BLOCK.find_travel()
    assert compression == pytest.approx(0.688, abs=5e-4)
    assert way_back == pytest.approx(1.73, abs=1e-2)


def test_superposed_modes_under_a_steady_acceleration():
    """Two oscillators side by side; each overshoots its static displacement by exp(-pi zeta / sqrt(1 - zeta^2))."""
    damping = 0.05
    mass, stiffness = np.array([4.0, 1.0]), np.array([36.0, 100.0])
    displacements = SUPERPOSITION.superpose_modes(
        np.diag(stiffness), np.diag(mass), np.ones(2), damping, samples=np.full(200, 0.5)
    )
    overshoot = exp(-pi * damping / sqrt(1 - damping**2))
    expected = 0.5 * mass / stiffness * (1 + overshoot)
    assert np.abs(displacements).max(axis=0) == pytest.approx(expected, rel=1e-5)


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


@pytest.mark.parametrize(("w", "r", "s", "periods"), IMPACT_RESONANCE.OSCILLATORS)
def test_speeds_of_blows_once_in_several_periods(w, r, s, periods):
    """Fails if the closed form is not the speed that blows on a rigid wall settle at."""
    times, speeds = find_blows(w, r, s, 60)
    assert speeds[-1] == pytest.approx(IMPACT_OSCILLATOR.find_rigid_speed(w, r, s, periods), rel=1e-6)
    assert times[-1] - times[-2] == pytest.approx(2 * pi * periods / w, rel=1e-6)


@pytest.mark.parametrize(("w", "r"), IMPACT_DOUBLING.OSCILLATORS)
def test_blows_alternate_beyond_the_wall_of_the_closed_form_only(w, r):
    s = IMPACT_DOUBLING.find_doubling_wall(w, r)
    _, before = find_blows(w, r, s - 1e-3, 800)
    _, beyond = find_blows(w, r, s + 1e-3, 800)
    assert abs(before[-1] - before[-2]) < 1e-5
    assert abs(beyond[-1] - beyond[-2]) > 3e-3


def test_blows_of_spheres_are_those_of_hertz(tmp_path):
    """As closely as the storeys, of 1e-6 N/m, leave the spheres free."""
    blows = PUBLISHED.solve_entry("hertz-impact", tmp_path).table("link").set_index("impact.hertz_stiffness")
    for _, mass, stiffness, speed, _, _ in HERTZ_IMPACT.BLOWS:
        exact = HERTZ_IMPACT.find_hertz_blow(mass, stiffness, speed)
        assert tuple(blows.loc[stiffness, ["peak_force", "contact_time"]]) == pytest.approx(exact, rel=3e-6)


def test_there_are_rows_with_numbers_on_both_sides():
    """At least ten; and what differs by more than a per cent says why."""
    text = PUBLISHED.PAGE.read_text(encoding="utf-8")
    rows = [row for name in PUBLISHED.ENTRIES for row in PUBLISHED.split_rows(PUBLISHED.split_page(text, name)[1])]
    assert all(len(row) == 5 for row in rows)
    numbers = [row for row in rows if NUMBER.fullmatch(row[1]) and NUMBER.fullmatch(row[2])]
    assert len(numbers) >= 10
    assert all(row[4] for row in rows)


@pytest.mark.parametrize("name", sorted(path.stem for path in STUDIES.glob("*.yaml")))
def test_its_study_is_sound(name):
    if name == "two-towers" and "POUND_NIGHTLY" not in os.environ:
        pytest.skip("reads 47 motions: make reference does every night")
    path = STUDIES / f"{name}.yaml"
    problems: list[str] = []
    try:
        pounding_cli.load_study(path)
    except InputError as error:
        problems = [str(each) for each in error.problems]
    missing = PUBLISHED.ENTRIES[name].motions
    assert len(problems) == len(missing), problems
    assert all(any(Path(motion).name in each for motion in missing) for each in problems)
