"""OpenSees, which steps over every contact, has to come nearer to the event-located solver as its step shrinks.

Each test halves OpenSees' step three times, asks for the order the method has on such a scene (two where nothing
is abrupt, one where contacts are stepped over) and bounds the last difference; bounds are two to three times what was
measured with OpenSees 3.7.1."""

from __future__ import annotations

import numpy as np
import pytest

from tests.adapter import solve
from tests.peers.scenes import pair

opensees = pytest.importorskip("opensees", reason="openseespy is not installed (pip install -e .[peers])")


def differences(scene, steps):
    """Root mean square relative differences of storey shears, drifts and link forces, one row a step."""
    expected, rows = solve(scene, 1e-10), []
    force = expected.peak_force
    assert force.max() > 0  # the buildings do meet
    for dt in steps:
        found = opensees.march(scene.built, dt)
        pairs = (
            (found.shear - expected.shear, expected.shear),
            (found.drift - expected.drift, expected.drift),
            (found.link_force - force, np.full(force.size, force.max())),
        )
        rows.append([np.sqrt(np.mean((off / size) ** 2)) for off, size in pairs])
    return np.array(rows)


def order(steps, errors):
    """Slope of the straight line through log error over log step."""
    return np.polyfit(np.log(steps), np.log(errors), 1)[0]


@pytest.mark.parametrize("analysis", ["elastic", "inelastic"])
def test_connected_pair(analysis):
    """Connectors and bilinear storeys, second order. Fails if the connector's dashpot lacks its 2."""
    steps = (8e-4, 4e-4, 2e-4, 1e-4)
    off = differences(pair({"link": "connector", "gap": 0.05, "stiffness": 1.5e8}, analysis), steps)
    assert order(steps, off[:, 0]) > 1.9
    assert (off[-1] < [2e-6, 3e-6, 6e-6]).all()


@pytest.mark.parametrize(
    "damper",
    [
        {"link": "maxwell", "stiffness": 1e8, "damping_coefficient": 2e6},
        {"link": "friction", "stiffness": 1e8, "slip_force": 2e5},
    ],
    ids=lambda damper: damper["link"],
)
def test_dampers(damper):
    """Second order. Fails if the dashpot of a Maxwell damper or the slip force is another."""
    steps = (8e-4, 4e-4, 2e-4, 1e-4)
    off = differences(pair({"gap": 0.05, **damper}), steps)
    assert order(steps, off[:, 0]) > 1.8
    assert (off[-1] < [1.5e-6, 1.5e-6, 1.5e-6]).all()


def test_viscous_damper():
    """OpenSees' has a spring in series, 1e10 N/m here; its shears stay 8e-5 away, whatever the step. Fails with another
    exponent."""
    viscous = {"link": "viscous", "gap": 0.05, "force_at_1_m_s": 1e5, "exponent": 0.5}
    off = differences(pair(viscous), (8e-4, 4e-4))
    assert (off < [1.5e-4, 1.5e-4, 3e-5]).all()


@pytest.mark.parametrize("gap", [0.0, 0.004])
def test_elastic_pounding(gap):
    """Six contacts at the top, first order. Fails if the dashpot's mass is turned upside down."""
    steps = (2e-4, 1e-4, 5e-5, 2.5e-5)
    off = differences(pair({"link": "pounding", "gap": gap}), steps)
    assert order(steps, off[:, 0]) > 0.8
    assert (off[-1] < [6e-4, 6e-4, 3e-3]).all()


@pytest.mark.parametrize(("gap", "peak", "bounds"), [(0.0, 4.0, [1e-7, 3e-7, 3e-6]), (0.001, 8.0, [2e-6, 3e-6, 1e-3])])
def test_inelastic_pounding(gap, peak, bounds):
    """Steel01 storeys, far beyond yield, in contact. Fails if unloading follows the hardened stiffness."""
    steps = (2e-4, 1e-4, 5e-5, 2.5e-5)
    off = differences(pair({"link": "pounding", "gap": gap}, "inelastic", peak=peak), steps)
    assert order(steps, off[:, 2]) > 0.8
    assert (off[-1] < bounds).all()
