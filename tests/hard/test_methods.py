"""Scenes whose finer runs by one method agreed with each other, and not with those of another method."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np
import pytest

import pounding_cli as pound
from tests.adapter import Scene, difference, events_until_stalled, scenes, solve

from .catalogue import expectation_of
from .random_scenes import random_cut_infill, random_touch

FOLDER = Path(__file__).parent / "methods"

NUMBERS = "shear", "drift", "acceleration", "peak_force", "max_closing", "impulse"
"""What methods are compared in; with the contact time, where Dormand-Prince tells that of grazing contacts as well."""

BELOW = 10.0
"""By so much an estimate may be below the true error."""

BOUND = 100_000
"""Most steps and events of a random scene."""


@dataclass(frozen=True)
class Expected:
    """What a scene of `methods/` must come to.

    peak_force, max_closing : by an integration of its own [N, m]; nan where there is none
    steps : most steps of a run
    flag : words of a flag that the scene has, or ""
    chance : what chance makes of the numbers of a flagged scene [-]
    """

    peak_force: float = math.nan
    max_closing: float = math.nan
    steps: int = 5000
    flag: str = ""
    chance: float = 0.0


def read_expected(path: Path) -> Expected:
    """Return what the head of a study expects.  Raises ValueError where it says nothing, or something unknown."""
    _, given = expectation_of(path, {field.name for field in fields(Expected)})
    return Expected(**given)


def linked_scene(path: Path) -> tuple[pound.Scene, float]:
    """Return the one scene of a study that has links, and the accuracy asked of it [-]."""
    ((scene, accuracy),) = [(scene, accuracy) for _, scene, accuracy in scenes(path) if scene.links]
    return scene, accuracy


def assert_methods_agree(
    scene: Scene | pound.Scene, accuracy: float, steps: int, numbers: Sequence[str] = NUMBERS, chance: float = 0.0
) -> tuple[str, ...]:
    """Fail if another method differs by more than the estimate and chance tell; return the flags of the scene."""
    bounds = steps, steps
    run = solve(scene, accuracy, estimate=True, bounds=bounds)
    other = solve(scene, max(1e-3 * accuracy, 1e-11), method="dop853", bounds=bounds)
    assert run.status == other.status
    if run.status == "done":
        error = difference(run, other, numbers)
        assert error <= max(BELOW * run.error, accuracy, chance), (error, run.error)
        assert run.error <= accuracy or run.flags
    return run.flags


STUDIES = pytest.mark.parametrize("path", sorted(FOLDER.glob("*.yaml")), ids=lambda path: path.stem)


@STUDIES
def test_methods_agree(path: Path) -> None:
    """Fails if runs that are to disagree are one run, or both miss an event that another method sees."""
    scene, accuracy = linked_scene(path)
    expected = read_expected(path)
    compared = NUMBERS if expected.flag else (*NUMBERS, "contact_time")  # rounding decides those of a flagged scene
    flags = assert_methods_agree(scene, accuracy, expected.steps, compared, expected.chance)
    assert expected.flag in "; ".join(flags)


@STUDIES
def test_own_integration(path: Path) -> None:
    """Fails if the force is not that of an integration of its own."""
    scene, accuracy = linked_scene(path)
    expected = read_expected(path)
    if math.isnan(expected.peak_force):
        pytest.skip("there is none of this scene")
    run = solve(scene, accuracy)
    assert run.peak_force.max() == pytest.approx(expected.peak_force, rel=1e-5)
    assert run.max_closing.max() == pytest.approx(expected.max_closing, rel=1e-5)


@pytest.mark.parametrize("name", ["infill-cut-pulls", "infill-cut-rocking"])
def test_what_is_cut_never_pulls(name: str) -> None:
    """Fails if a link pulls in spite of its cut."""
    scene, _ = linked_scene(FOLDER / f"{name}.yaml")
    assert pound.history(scene, every=1e-3).link_force.min() >= 0.0


@pytest.mark.parametrize("number", range(6))
def test_random_cut_infills(number: int) -> None:
    """Infills as printed that do not pull, by two methods. Fails if one pulls, or the methods differ by more than the
    estimate tells."""
    scene, accuracy = random_cut_infill(number)
    assert_methods_agree(scene, accuracy, BOUND)
    kept = pound.history(scene.built, every=0.25 * scene.dt, accuracy=accuracy)
    assert kept.link_force.min() >= -1e-9 * np.abs(kept.link_force).max()


def test_a_run_that_does_not_get_on_ends() -> None:
    """Events in a row, each a billionth or a tenth of its step behind the one before. Fails if a run goes on with the
    first, or is stopped for the second, as contacts may have them."""
    assert 1000 <= events_until_stalled(10, 1e-9, 20_000) < 20_000
    assert events_until_stalled(10, 0.1, 20_000) == 20_000


@pytest.mark.parametrize("number", [0, 1])
def test_random_smooth_touch(number: int) -> None:
    """Buildings that move nearly alike, in touch by laws that Dormand-Prince steps, at an accuracy where its tolerance
    ends. Fails if finer runs are one run: an estimate of exactly zero."""
    scene, accuracy = random_touch(number)
    run = solve(scene, accuracy, estimate=True, bounds=(BOUND, BOUND))
    assert run.status == "done"
    assert run.error > 0.0
    assert_methods_agree(scene, accuracy, BOUND, (*NUMBERS, "contact_time"))


def test_a_run_of_other_steps_differs() -> None:
    """The same accuracy in other steps. Fails if such a run is the one it is compared with, to the last digit."""
    scene, accuracy = linked_scene(FOLDER / "smooth-twins.yaml")
    runs = [solve(scene, accuracy, least_steps=steps) for steps in (1, 2, 3)]
    assert 0.0 < difference(runs[0], runs[1], ("shear",)) < 1e-6
    assert 0.0 < difference(runs[1], runs[2], ("shear",)) < 1e-6


def test_numbers_of_nothing_are_no_error() -> None:
    """Closings of rounding between twins in touch. Fails if their relative error, 1, is told as that of the scene."""
    scene, accuracy = linked_scene(FOLDER / "twins-by-rounding.yaml")
    run = solve(scene, accuracy, estimate=True)
    assert run.error <= accuracy
    assert not any("less accurate" in flag for flag in run.flags)


@pytest.mark.parametrize("tail", [0.0, 0.07, 0.3, 0.4])
@pytest.mark.parametrize("settings", [{}, {"method": "dop853"}, {"method": "newmark", "time_step": 1e-4}], ids=str)
def test_a_tail_ends_where_it_is_asked_to(tail: float, settings: dict) -> None:
    """A motion every 0.2 s, and the same every 0.01 s, end at the same displacement. Fails if a tail is rounded up to
    whole samples."""
    coarse = np.array([0.0, 2.0, -1.0, 3.0, 0.0, 0.0])
    fine = np.interp(np.arange(101) * 0.01, np.arange(6) * 0.2, coarse)
    building = {"storeys": 1, "mass": 2e5, "period": 0.37, "damping": 0.05, "yield_shear": "never"}
    ends = [
        solve(Scene((building,), ground, dt, tail=tail), **settings).end for ground, dt in ((coarse, 0.2), (fine, 0.01))
    ]
    assert ends[0] == pytest.approx(ends[1], rel=1e-6)


def test_a_history_ends_with_its_tail() -> None:
    """Fails if a history goes on beyond the tail, or stops before its end."""
    building = {"storeys": 1, "mass": 2e5, "period": 0.37, "damping": 0.05, "yield_shear": "never"}
    scene = Scene((building,), np.array([0.0, 2.0, -1.0, 0.0]), 0.2, tail=0.3)
    kept = pound.history(scene.built, every=0.1)
    run = solve(scene)
    assert float(kept.time[-1]) == pytest.approx(0.9)
    assert np.ravel(kept.displacement)[-1] == pytest.approx(run.end[0], rel=1e-6)
