"""The energy ledger: closed forms of what each entry is, and a balance that closes for every law at once."""

from __future__ import annotations

import numpy as np
import pytest

from pounding_cli.laws.connector import Connector
from pounding_cli.laws.dashpot import damping_ratio
from pounding_cli.laws.infill import InfillLaw
from pounding_cli.laws.pounding import Pounding
from pounding_cli.model.building import Building
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Scene
from pounding_cli.records.motion import Motion
from pounding_cli.solve import solve
from tests.helpers.scenes import ELASTIC, FOUNDATION, INELASTIC, links, oscillator, pair, shake, shear_building, still
from tests.reference.closed_forms import kelvin_voigt, oscillator_under_ramp

pytestmark = pytest.mark.usefixtures("exact_steps_and_series")

M, K, V0 = 2e5, 8e7, 0.4
OMEGA = float(np.sqrt(K / M))


def thrown(alpha: float, beta: float, time: float = 0.3) -> dict[str, float]:
    """Ledger of one storey thrown from rest at V0 on still ground."""
    one = Building("one", [M], [3.0], [K], [np.inf], [0.0], alpha, beta)
    return solve(Scene((one,), (), still(time), ELASTIC), 1e-13, initial=([[0.0]], [[V0]])).energy


@pytest.mark.parametrize(
    ("alpha", "beta"), [(0.0, 0.0), (2.0, 0.0), (0.0, 0.005), (1.0, 0.002)], ids=["none", "mass", "stiffness", "both"]
)
def test_damping_of_a_free_oscillator(alpha, beta):
    """What dampers took is what the closed form has lost. Fails if drag or storey dashpot is left out or doubled."""
    energy = thrown(alpha, beta)
    u, v = oscillator_under_ramp(0.0, V0, 0.0, 0.0, OMEGA, 0.5 * (alpha / OMEGA + beta * OMEGA), 0.3)
    start, left = M * V0**2 / 2, K * u**2 / 2 + M * v**2 / 2
    assert energy["input"] == pytest.approx(start, rel=1e-12)
    assert energy["kinetic"] == pytest.approx(M * v**2 / 2, rel=1e-10)
    assert energy["stored"] == pytest.approx(K * u**2 / 2, rel=1e-10)
    assert energy["damping"] == pytest.approx(start - left, rel=1e-10, abs=1e-12 * start)


def test_work_of_the_ground():
    """Constant acceleration a on an undamped storey: input m a^2 (1 - cos wt) / w^2. Fails if sign or mass slips."""
    a, time = 1.7, 0.34
    motion = Motion("step", 0.02, np.full(18, a))
    energy = solve(Scene((oscillator(M, K),), (), motion, ELASTIC), 1e-13).energy
    assert energy["input"] == pytest.approx(M * a**2 * (1 - np.cos(OMEGA * time)) / OMEGA**2, rel=1e-11)
    assert energy["kinetic"] + energy["stored"] == pytest.approx(energy["input"], rel=1e-11)


@pytest.mark.parametrize("cut", [False, True])
@pytest.mark.parametrize("e", [0.1, 0.5, 0.9, 1.0])
def test_loss_of_an_impact(e, cut):
    """m' v0^2 (1 - rebound^2) / 2 goes into the link. Fails if the dashpot's pull at the end is not charged."""
    m1, m2, s = 2e5, 3e5, 2e9
    reduced, xi = m1 * m2 / (m1 + m2), damping_ratio(e)
    link = Link(0, 1, 1, Pounding(0.01, s, xi, cut))
    scene = Scene((oscillator(m1, 1e-3), oscillator(m2, 1e-3)), (link,), still(0.12), ELASTIC)
    energy = solve(scene, 1e-12, initial=([[0.0], [0.0]], [[0.6], [0.0]])).energy
    rebound = kelvin_voigt(s, xi, reduced, 0.6, tension_cut=cut and e < 1).rebound
    assert energy["links"] == pytest.approx(reduced * 0.6**2 / 2 * (1 - rebound**2), rel=1e-9, abs=1e-7)
    assert energy["links_stored"] == 0.0


def test_connector_dashpot_and_spring():
    """Two masses on a connector alone, a damped oscillator. Fails if its spring is not stored."""
    m1, m2, s, xi, time = 2e5, 3e5, 5e7, 0.2, 0.1
    reduced = m1 * m2 / (m1 + m2)
    link = Link(0, 1, 1, Connector(0.1, s, xi))
    scene = Scene((oscillator(m1, 1e-6), oscillator(m2, 1e-6)), (link,), still(time), ELASTIC)
    energy = solve(scene, 1e-13, initial=([[0.0], [0.0]], [[0.5], [0.0]])).energy
    v, rate = oscillator_under_ramp(0.0, 0.5, 0.0, 0.0, float(np.sqrt(s / reduced)), xi, time)
    assert energy["links_stored"] == pytest.approx(s * v**2 / 2, rel=1e-9)
    lost = reduced * 0.5**2 / 2 - s * v**2 / 2 - reduced * rate**2 / 2
    assert energy["links"] == pytest.approx(lost, rel=1e-9)


SCENES = {
    "pounding": lambda a: pair("pounding", 0.0, shake(0.7), a),
    "pounding, cut": lambda a: pair("pounding", 0.002, shake(0.7), a, tension_cut=True),
    "pounding, founded": lambda a: pair("pounding", 0.0, shake(0.7), a, FOUNDATION),
    "infill": lambda a: pair("infill", 0.004, shake(0.7), a),
    "infill, printed": lambda a: pair("infill", 0.004, shake(0.7), a, law=InfillLaw.PRINTED),
    "infill, cut": lambda a: pair("infill", 0.004, shake(0.7), a, tension_cut=True),
    "connector, founded": lambda a: pair("connector", 0.05, shake(0.7), a, FOUNDATION),
    "three": lambda a: Scene(
        (shear_building(0.6, 4), shear_building(0.3, 2, FOUNDATION), shear_building(0.2, 1)),
        (*links("pounding", 0.002, (1,)), *links("infill", 0.01, (2,)), *links("connector", 0.05, (1,), left=1)),
        shake(0.6), a, tail=0.2,
    ),
}  # fmt: skip


@pytest.mark.parametrize("analysis", [ELASTIC, INELASTIC])
@pytest.mark.parametrize("name", SCENES)
def test_balance_closes_with_the_accuracy(name, analysis):
    """Input is what is held plus what was taken, to 1e-8 at the usual accuracy and to rounding at the finest.

    Fails if any force of the equations of motion does work that no entry charges.
    """
    scene = SCENES[name](analysis)
    for accuracy, bound in ((1e-6, 1e-8), (1e-9, 1e-10), (1e-13, 1e-12)):
        energy = solve(scene, accuracy).energy
        assert abs(energy["residual"]) <= bound, accuracy
        sinks = sum(energy[key] for key in ("kinetic", "stored", "links_stored", "damping", "hysteresis", "links"))
        assert energy["input"] == pytest.approx(sinks, rel=10 * bound)


@pytest.mark.parametrize("analysis", [ELASTIC, INELASTIC])
@pytest.mark.parametrize("name", [n for n in SCENES if "printed" not in n])
def test_sinks_only_take(name, analysis):
    """Dampers, yielding and links give nothing back. Fails if a sink has the wrong sign.

    The printed infill law is left out: its jump at v = d lets a contact give more than it took.
    """
    energy = solve(SCENES[name](analysis), 1e-9).energy
    for sink in ("kinetic", "stored", "links_stored", "damping", "hysteresis", "links"):
        assert energy[sink] >= -1e-12 * energy["input"], sink
    assert (energy["hysteresis"] > 0) == (analysis == INELASTIC)


@pytest.mark.parametrize("analysis", [ELASTIC, INELASTIC])
def test_a_run_that_gives_back_what_it_took_in_closes(analysis):
    """An undamped oscillator whose period is the time step of the motion is at rest again at every sample. Fails if
    what is missing is measured by what is left, which is next to nothing."""
    mass = 2e3
    stiffness = mass * (2 * np.pi / 0.01) ** 2
    scene = Scene((oscillator(mass, stiffness, yield_shear=1e9),), (), shake(1.0, dt=0.01, seed=3), analysis)
    for accuracy in (1e-6, 1e-8):
        found = solve(scene, accuracy)
        assert found.status == "done"
        assert abs(found.energy["residual"]) < 1e-2 * accuracy
