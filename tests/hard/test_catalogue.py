"""Every hard scene: finite, energy closed, as accurate as asked, at bounded cost."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pounding_cli.model.scene import Scene
from pounding_cli.solve import Response, solve

from .catalogue import HardStudy, studies
from .verdict import fault_of, scenes_of

STUDIES = studies()
TIGHTER = 1e-5
"""The reference's accuracy over the one asked, not below 1e-13."""


def peaks(run) -> np.ndarray:
    """Storey shears, drifts and floor accelerations of a response, or of an independent reference."""
    names = ("shear", "drift", "acceleration")
    if isinstance(run, Response):
        return np.concatenate([getattr(b, name) for name in names for b in run.buildings])
    return np.concatenate([getattr(run, name) for name in names])


def distance(one, other) -> float:
    """Largest relative difference of a peak [-]."""
    a, b = peaks(one), peaks(other)
    return float(np.max(np.abs(a - b) / np.where(b != 0, np.abs(b), 1.0)))


def nudged(scene: Scene, part: float = 1e-6) -> Scene:
    """The scene under a motion that grows by `part` from first sample to last.

    A plain factor would not do: touching elastic buildings answer it by the same factor, however chaotic they are.
    """
    samples = scene.motion.acceleration
    growing = samples * (1.0 + part * np.linspace(0.0, 1.0, samples.size))
    return replace(scene, motion=replace(scene.motion, acceleration=growing))


def linked(study: HardStudy) -> list[tuple[str, Scene, float]]:
    return [(where, scene, accuracy) for where, scene, accuracy in scenes_of(study.path) if scene.links]


@pytest.mark.parametrize("study", STUDIES, ids=lambda s: s.name)
def test_scene(study):
    """Fails if a peak is off by more than asked, energy leaks, the steps multiply, or the blow never comes."""
    expect = study.expect
    for where, scene, accuracy in scenes_of(study.path):
        response = solve(scene, accuracy, bounds=(expect.steps, expect.steps))
        assert response.status == "done", where
        assert fault_of(response) == "", where
        assert abs(response.energy["residual"]) <= expect.residual, where
        reference = solve(scene, max(accuracy * TIGHTER, 1e-13))
        assert reference.status == "done", where
        assert distance(response, reference) <= max(accuracy, expect.sensitive), where
        if scene.links:
            assert response.links.impacts.sum() >= expect.impacts, where


@pytest.mark.parametrize("study", [s for s in STUDIES if s.expect.independent], ids=lambda s: s.name)
def test_independent_reference(study):
    """Dormand-Prince 8 from event to event agrees. Fails if both accuracies of the solver share a wrong law."""
    from tests.reference import events

    for where, scene, accuracy in linked(study):
        expected, found = events.integrate(scene), solve(scene, accuracy)
        assert distance(found, expected) <= max(accuracy, study.expect.sensitive), where
        if not study.expect.sensitive:
            assert found.links.impacts.tolist() == expected.impacts.tolist(), where


@pytest.mark.parametrize("study", [s for s in STUDIES if s.expect.sensitive], ids=lambda s: s.name)
def test_what_is_called_sensitive_is(study):
    """A motion that grows by 1e-6 moves a peak by a tenth of the figure or more. Fails if the figure is an excuse."""
    moved = max(distance(solve(nudged(scene), 1e-12), solve(scene, 1e-12)) for _, scene, _ in linked(study))
    assert moved >= 0.1 * study.expect.sensitive
