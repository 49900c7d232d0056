"""What tests of contact laws share: a blow of two free masses, and comparisons of a scene with the event-located
reference, with a finer run and with its history."""

from __future__ import annotations

import numpy as np
import pytest

from pounding_cli.laws.law import LinkLaw
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Scene
from pounding_cli.records.motion import Motion
from pounding_cli.solve import solve
from pounding_cli.solve.histories import history
from pounding_cli.solve.response import Response
from tests.helpers.scenes import ELASTIC, gather, oscillator, shear_building, still

from . import events

M1, M2, K, V0, GAP = 2e5, 3e5, 2e9, 0.6, 0.01
"""Masses [kg], contact stiffness [N/m^b], approach speed [m/s] and gap [m] of a blow."""

REDUCED = M1 * M2 / (M1 + M2)
BUILDING = ("shear", "drift", "acceleration", "displacement_max", "displacement_min")
LINK = ("peak_force", "max_closing", "impulse", "contact_time")


def blow(law: LinkLaw, accuracy: float, duration: float = 0.2, speed: float = V0) -> tuple[Response, float]:
    """The run of two masses with hardly any springs, and the speed at which they part [m/s]."""
    masses = oscillator(M1, 1e-9), oscillator(M2, 1e-9)
    scene = Scene(masses, (Link(0, 1, 1, law),), still(duration), ELASTIC)
    found = solve(scene, accuracy, initial=([[0.0], [0.0]], [[speed], [0.0]]))
    assert found.status == "done"
    assert abs(found.energy["residual"]) < 1e-10
    (_, (left,)), (_, (right,)) = found.final
    return found, float(right - left)


def contact_pair(law: LinkLaw, motion: Motion, analysis=ELASTIC, storeys: int = 3, foundation=None) -> Scene:
    """Buildings of 0.36 s and 0.60 s with a law between all their floors."""
    two = shear_building(0.36, storeys, foundation), shear_building(0.60, storeys, foundation)
    return Scene(two, tuple(Link(0, floor, floor, law) for floor in range(1, storeys + 1)), motion, analysis)


def agrees_with_reference(scene: Scene, rel: float = 1e-7, like: Scene | None = None) -> events.Result:
    """The result of the event-located reference, once everything of `solve` has been found to agree with it; `like` is
    the scene as the reference knows it, where that is another."""
    expected, found = events.integrate(like or scene), solve(scene, 1e-12)
    assert found.status == "done"
    for name in BUILDING:
        assert gather(found, name) == pytest.approx(getattr(expected, name), rel=rel, abs=1e-13), name
    for name in LINK:
        value = getattr(expected, name)
        assert getattr(found.links, name) == pytest.approx(value, rel=rel, abs=1e-8 * np.abs(value).max()), name
    assert found.links.impacts.tolist() == expected.impacts.tolist()
    assert expected.impacts.sum() > 0
    assert abs(found.energy["residual"]) < 1e-9
    end = np.concatenate([u for u, _ in found.final])
    assert end == pytest.approx(expected.displacement, abs=rel * np.abs(end).max())
    return expected


def keeps_its_accuracy(scene: Scene, finest: float = 1e-10) -> None:
    """A run at an accuracy of 1e-6 agrees with one at `finest`."""
    coarse, fine = (solve(scene, accuracy, bounds=(50_000, 50_000)) for accuracy in (1e-6, finest))
    for found in (coarse, fine):
        assert found.status == "done"
        assert abs(found.energy["residual"]) < 1e-8
    for name in ("drift", "acceleration"):
        assert gather(coarse, name) == pytest.approx(gather(fine, name), rel=1e-5), name
    assert coarse.links.impacts.tolist() == fine.links.impacts.tolist()


def history_reaches_the_peak(scene: Scene, every: float, rel: float) -> None:
    """The link forces over time, sampled each `every` seconds, reach those of the run to `rel` and never pass them."""
    kept, found = history(scene, 1e-9, every), solve(scene, 1e-9)
    force = kept.link_force.max(axis=0)
    assert found.links.peak_force.max() > 0
    assert force == pytest.approx(found.links.peak_force, rel=rel)
    assert (force <= found.links.peak_force * (1 + 1e-9)).all()
    assert kept.link_force.min() >= -1e-9 * force.max()
