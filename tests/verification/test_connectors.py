"""Connectors and dampers between floors: closed forms of friction, Maxwell and viscous ones; the event-located
reference, rows of ten, hard scenes of all."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pounding_cli.laws.connector import Connector
from pounding_cli.laws.damper import Damper
from pounding_cli.laws.friction import Friction
from pounding_cli.laws.law import LinkLaw
from pounding_cli.laws.maxwell import Maxwell
from pounding_cli.laws.viscous import Viscous
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Scene
from pounding_cli.solve import solve
from pounding_cli.solve.assess import assess
from pounding_cli.solve.histories import history
from tests.helpers.scenes import ELASTIC, INELASTIC, gather, links, oscillator, shake, shear_building, still
from tests.reference import events
from tests.reference.rows import islands_equal_the_whole, row_of_ten, struck

M1, M2, SPEED, T = 2e5, 3e5, 0.3, 0.2
REDUCED = M1 * M2 / (M1 + M2)
FRICTION, MAXWELL, VISCOUS = Friction(0.05, 1e8, 2e5), Maxwell(0.05, 1e8, 2e6), Viscous(0.05, 1e5, 0.5, 1e-7)
CONNECTOR, DAMPER = Connector(0.05, 3e7, 0.05), Damper(0.05, 2e6)
LAWS = pytest.mark.parametrize("law", [CONNECTOR, DAMPER, FRICTION, MAXWELL, VISCOUS], ids=lambda law: law.name)


def joined(law: LinkLaw, storeys: int = 3, gap: float | None = None, motion=None, analysis=INELASTIC) -> Scene:
    """Two buildings with the damper from the second floor on; `gap` [m]: with pounding on all floors."""
    two = shear_building(0.36, storeys), shear_building(0.60, storeys)
    dampers = tuple(Link(0, j, j, law) for j in range(2, storeys + 1))
    strike = () if gap is None else links("pounding", gap, range(1, storeys + 1), stiffness=2e9)
    return Scene(two, (*dampers, *strike), shake(1.2, 9.0, 3) if motion is None else motion, analysis)


def free_masses(law: LinkLaw, duration: float = T):
    """A run of two masses without storeys to speak of, the left one moving, and their closing and its rate at the
    end."""
    masses = oscillator(M1, 1e-9), oscillator(M2, 1e-9)
    scene = Scene(masses, (Link(0, 1, 1, law),), still(duration), ELASTIC)
    found = solve(scene, 1e-12, initial=([[0.0], [0.0]], [[SPEED], [0.0]]))
    assert found.status == "done"
    assert abs(found.energy["residual"]) < 1e-12
    (left, right) = found.final
    return found, left[0][0] - right[0][0], left[1][0] - right[1][0]


def test_friction_of_two_free_masses():
    """The spring up to the slip force, a constant force until they turn back, and the spring again: a vibration about
    the slip, in which nothing more is lost. Fails if the slip is forgotten or the force goes on."""
    k, force = 1e8, 4e5
    omega, limit = math.sqrt(k / REDUCED), force / k
    at_slip = math.sqrt(SPEED**2 - (omega * limit) ** 2)
    slip = REDUCED * at_slip**2 / 2 / force
    t_slip = math.asin(omega * limit / SPEED) / omega
    t_turn = t_slip + REDUCED * at_slip / force
    found, v, rate = free_masses(Friction(0.05, k, force))
    assert found.energy["links"] == pytest.approx(force * slip, rel=1e-9)
    assert found.links.max_closing[0] == pytest.approx(limit + slip, rel=1e-10)
    assert v == pytest.approx(slip + limit * math.cos(omega * (T - t_turn)), rel=1e-9)
    assert rate == pytest.approx(-omega * limit * math.sin(omega * (T - t_turn)), rel=1e-9)
    assert found.energy["links_stored"] == pytest.approx(k * (v - slip) ** 2 / 2, rel=1e-8)
    assert found.links.peak_force[0] == pytest.approx(force, rel=1e-12)


@pytest.mark.parametrize("c", [1e5, 1e6, 2e7])
def test_maxwell_of_two_free_masses(c):
    """m' r' = -f, f' = k (r - f / c): an oscillator in f, damped or overdamped. Fails with a spring beside the
    dashpot."""
    k = 1e8
    system = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, -1 / REDUCED], [0.0, k, -k / c]])
    values, vectors = np.linalg.eig(system)
    start = np.linalg.solve(vectors, np.array([0.0, SPEED, 0.0], complex))
    expected = np.real(vectors @ (start * np.exp(values * T)))
    found, v, rate = free_masses(Maxwell(0.05, k, c))
    assert (v, rate) == pytest.approx(tuple(expected[:2]), rel=1e-9, abs=1e-10)
    held = expected[2] ** 2 / (2 * k)
    assert found.energy["links_stored"] == pytest.approx(held, rel=1e-7, abs=1e-9)
    spent = REDUCED * (SPEED**2 - expected[1] ** 2) / 2 - held
    assert found.energy["links"] == pytest.approx(spent, rel=1e-10)


@pytest.mark.parametrize("a", [0.1, 0.5, 0.9, 1.0])
def test_viscous_of_two_free_masses(a):
    """m' r' = -c r^a: r^(1 - a) falls in a straight line. Fails with another power."""
    c = 5e4
    found, _, rate = free_masses(Viscous(0.05, c, a))
    lost = c * T / REDUCED
    expected = SPEED * math.exp(-lost) if a == 1.0 else (SPEED ** (1 - a) - (1 - a) * lost) ** (1 / (1 - a))
    assert rate == pytest.approx(expected, rel=1e-11)
    assert found.links.peak_force[0] == pytest.approx(c * SPEED**a, rel=1e-12)
    assert found.energy["links"] == pytest.approx(REDUCED * (SPEED**2 - expected**2) / 2, rel=1e-10)


@pytest.mark.parametrize("analysis", [ELASTIC, INELASTIC])
@pytest.mark.parametrize("gap", [None, 0.0, 0.02], ids=["alone", "touching", "gap"])
@LAWS
def test_five_storeys_against_the_reference(law, gap, analysis):
    """Dormand-Prince 8 from event to event, the viscous damper by its power as it is written, split where its rate
    changes sign; alone and beside pounding."""
    motion = shake(0.7 if law is VISCOUS else 1.2, 9.0, 3)  # its reference takes many steps
    scene = joined(law, 5, gap, motion, analysis)
    expected, found = events.integrate(scene), solve(scene, 1e-12)
    assert found.status == "done"
    for name in ("shear", "drift", "acceleration", "displacement_max", "displacement_min"):
        assert gather(found, name) == pytest.approx(getattr(expected, name), rel=1e-7, abs=1e-13), name
    for name in ("peak_force", "max_closing", "impulse"):
        value = getattr(expected, name)
        assert getattr(found.links, name) == pytest.approx(value, rel=1e-7, abs=2e-7 * np.abs(value).max()), name
    assert found.links.impacts.tolist() == expected.impacts.tolist()
    assert (expected.impacts.sum() > 0) == (gap is not None)
    if law is FRICTION:
        assert {to for _, (what, _, to) in expected.changes if what == "link"} >= {"up", "down"}
    assert abs(found.energy["residual"]) < 1e-10


HARD = (
    *(Connector(0.05, k, xi) for k, xi in ((1.0, 0.0), (1e8, 0.99), (1e13, 0.05))),
    *(Damper(0.05, c) for c in (1.0, 1e9)),
    *(Friction(0.05, k, force) for k in (1e4, 1e12) for force in (1.0, 1e5, 1e9)),
    *(Maxwell(0.05, k, c) for k, c in ((1e4, 1.0), (1e4, 1e9), (1e8, 1e4), (1e12, 1e9))),
    *(Viscous(0.05, c, a) for c, a in ((1.0, 0.1), (1e5, 0.3), (1e7, 0.999))),
)


@pytest.mark.parametrize("law", HARD, ids=lambda law: law.words.replace(" ", "-"))
def test_hard_dampers(law):
    """Weak to rigid beside floors that touch, samples far apart: an accuracy of 1e-6 is kept."""
    scene = joined(law, gap=0.0, motion=shake(2.0, dt=0.05))
    coarse, fine = solve(scene, 1e-6), solve(scene, 1e-10)
    for found in (coarse, fine):
        assert found.status == "done"
        assert abs(found.energy["residual"]) < 1e-8
    for name in ("drift", "acceleration"):
        assert gather(coarse, name) == pytest.approx(gather(fine, name), rel=1e-6), name
    assert coarse.links.impacts.tolist() == fine.links.impacts.tolist()


@LAWS
def test_a_chain_of_ten(law):
    """Every second pair has dampers, the others strike. Fails if an island that is put back forgets a slip or a
    force."""
    islands_equal_the_whole(row_of_ten(lambda left: [Link(left, 3, 3, law)] if left % 2 else struck(left)))


@LAWS
def test_the_error_estimate_covers_the_error(law):
    scene = joined(law, gap=0.004)
    found, fine = assess(scene, solve(scene, 1e-6), 1e-6), solve(scene, 1e-12)
    errors = [np.abs(gather(found, n) / gather(fine, n) - 1).max() for n in ("drift", "acceleration", "shear")]
    assert found.error_estimate >= max(errors)
    assert found.error_estimate < 1e-5


@LAWS
def test_histories(law):
    """The force over time reaches the peak of the run, and the energies close at every instant. Fails if what the
    damper remembers is lost between output times."""
    scene = joined(law)
    kept, found = history(scene, 1e-9, 1e-4), solve(scene, 1e-9)
    force = np.abs(kept.link_force).max(axis=0)
    assert force == pytest.approx(found.links.peak_force, rel=1e-4)
    assert (force <= found.links.peak_force * (1 + 1e-9)).all()
    rest = kept.energy["input"] - sum(kept.energy[n] for n in ("kinetic", "stored", "damping", "hysteresis", "links"))
    assert np.abs(rest).max() < 1e-9 * kept.energy["input"].max()


@LAWS
def test_nothing_moves_at_rest(law):
    found = solve(joined(law, gap=0.0, motion=still(1.0)), 1e-6)
    assert found.status == "done"
    assert gather(found, "drift").max() == 0.0
    assert found.links.peak_force.max() == 0.0


@pytest.mark.parametrize("method", ["rk4", "rk4-events", "newmark", "central-difference"])
def test_methods_run_a_viscous_damper(method):
    """It remembers nothing. Fails if the force of an expression of the rate is lost."""
    scene = joined(Viscous(0.05, 1e5, 0.5, 1e-2), motion=shake(0.4))
    exact, found = solve(scene, 1e-10, "taylor"), solve(scene, 1e-6, method, time_step=1e-4)
    assert found.status == "done"
    rel = 1e-6 if method.startswith("rk4") else 2e-3
    assert gather(found, "drift") == pytest.approx(gather(exact, "drift"), rel=rel)


@pytest.mark.parametrize("law", [FRICTION, MAXWELL], ids=lambda law: law.name)
@pytest.mark.parametrize("method", ["rk4-events", "rk4", "newmark", "central-difference", "exponential"])
def test_methods_that_do_not_remember_refuse(method, law):
    with pytest.raises(ValueError, match=f"{law.name}.* depends on events before|linear"):
        solve(joined(law, motion=shake(0.2)), 1e-6, method, time_step=1e-3 if method != "exponential" else None)


def test_a_relaxation_too_short_to_follow_is_refused():
    with pytest.raises(ValueError, match=r"relaxes in 1e-08 s .* write `link: damper`"):
        Maxwell(0.05, 1e8, 1.0)


def test_what_the_straight_part_changes():
    """The numbers of docs/theory.md: a tenth of the rate w changes the peaks a tenth or less. Fails if the power is
    straight over more than it says."""
    drifts = [gather(solve(joined(Viscous(0.05, 1e5, 0.3, w)), 1e-9), "drift") for w in (1e-4, 1e-6, 1e-8)]
    assert np.abs(drifts[0] / drifts[2] - 1).max() < 1e-4
    assert np.abs(drifts[1] / drifts[2] - 1).max() < 1e-6
