"""A scene by `solve` and by the event-located reference."""

from __future__ import annotations

import numpy as np
import pytest

from pounding_cli.model.scene import Scene
from pounding_cli.solve import solve
from tests.helpers.scenes import gather

from . import events

BUILDING = ("shear", "drift", "acceleration", "displacement_max", "displacement_min")
LINK = ("peak_force", "max_closing", "impulse", "contact_time")


def agree(scene: Scene, tolerance: float = 1e-8) -> events.Result:
    """The result of the reference, once everything of `solve` has been found to agree with it."""
    expected, found = events.integrate(scene), solve(scene, 1e-12)
    assert found.status == "done"
    for name in BUILDING:
        assert gather(found, name) == pytest.approx(getattr(expected, name), rel=tolerance, abs=1e-13), name
    for name in LINK:
        assert getattr(found.links, name) == pytest.approx(getattr(expected, name), rel=tolerance, abs=1e-13), name
    assert found.links.impacts.tolist() == expected.impacts.tolist()
    work, ledger = expected.energy, found.energy
    for name in ("input", "kinetic", "damping"):
        assert ledger[name] == pytest.approx(work[name], rel=tolerance, abs=tolerance * work["input"]), name
    held = sum(ledger[name] for name in ("stored", "hysteresis", "links", "links_stored"))
    assert held == pytest.approx(work["storeys"] + work["springs"] + work["links"], rel=tolerance)
    size = np.abs(expected.drift).max()
    assert gather(found, "residual_drift") == pytest.approx(expected.residual_drift, abs=tolerance * size)
    end = np.concatenate([u for u, _ in found.final])
    assert end == pytest.approx(expected.displacement, abs=tolerance * np.abs(end).max())
    rate = np.concatenate([v for _, v in found.final])
    assert rate == pytest.approx(expected.velocity, abs=tolerance * np.abs(rate).max())
    return expected
