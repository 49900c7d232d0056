"""The bilinear contact: blows of two all but free masses in closed form, and buildings against the event-located
reference."""

from __future__ import annotations

import math

import pytest

from pounding_cli.laws.bilinear_contact import BilinearContact, BilinearDamping
from pounding_cli.model.scene import Scene
from pounding_cli.solve import solve
from tests.helpers.scenes import ELASTIC, INELASTIC, shake
from tests.reference.contacts import (
    GAP,
    REDUCED,
    K,
    agrees_with_reference,
    blow,
    contact_pair,
    history_reaches_the_peak,
    keeps_its_accuracy,
)

DEPTH = 0.01
"""Of the blow that the contacts are laid out for [m]."""


def speed_of(law: BilinearContact, depth: float) -> float:
    """The approach speed of a blow that presses the floors to a depth [m/s]."""
    (k1, k2), limit = law.stiffnesses, law.yield_closing
    beyond = max(depth - limit, 0.0)
    within = min(depth, limit)
    return math.sqrt((k1 * within**2 + 2 * k1 * limit * beyond + k2 * beyond**2) / REDUCED)


def restitution_at(law: BilinearContact, depth: float) -> float:
    """e^2 = 1 - lost / (m' v0^2 / 2); lost is the parallelogram of the sides K1 and K2."""
    (k1, k2), limit = law.stiffnesses, law.yield_closing
    lost = (k1 - k2) * limit * max(depth - limit, 0.0)
    return math.sqrt(1 - 2 * lost / (REDUCED * speed_of(law, depth) ** 2))


def struck(law: BilinearContact, depth: float):
    """`blow` to a depth [m]."""
    return blow(law, 1e-9, 1.0, speed_of(law, depth))


def bilinear_pair(gap, e, motion, analysis=ELASTIC, storeys=3, k=K, depth=0.002) -> Scene:
    return contact_pair(BilinearContact(gap, k, depth, e), motion, analysis, storeys)


@pytest.mark.parametrize("e", [0.3, 0.5, 0.8, 1.0])
def test_the_restitution_asked_comes_out_of_the_blow_it_is_laid_out_for(e):
    """Fails if E is that of the formula, or the way back leaves the line K2 v."""
    law = BilinearContact(GAP, K, DEPTH, e)
    found, rebound = struck(law, DEPTH)
    assert rebound == pytest.approx(e * speed_of(law, DEPTH), rel=1e-9)
    assert found.links.max_closing[0] - GAP == pytest.approx(DEPTH, rel=1e-9)
    assert found.links.peak_force[0] == pytest.approx(K * DEPTH**1.5, rel=1e-9)
    assert found.energy["links"] == pytest.approx(REDUCED * speed_of(law, DEPTH) ** 2 / 2 * (1 - e * e), abs=1e-6)


@pytest.mark.parametrize("depth", [0.3, 1.0, 1.1, 1.5, 5.0, 30.0])
def test_other_blows_in_closed_form(depth):
    """Depths over the yield closing. Fails if a blow within it loses energy, or the loop is another."""
    law = BilinearContact(GAP, K, DEPTH, 0.5)
    depth *= law.yield_closing
    _, rebound = struck(law, depth)
    assert rebound == pytest.approx(restitution_at(law, depth) * speed_of(law, depth), rel=1e-9)


def test_the_published_energy_gives_another_restitution():
    """At e = 0.5 E is that of the spring times 0.3, which leaves sqrt(0.7 / 1.3) = 0.734."""
    law = BilinearContact(GAP, K, DEPTH, 0.5, damping_formula=BilinearDamping.MUTHUKUMAR)
    assert restitution_at(law, DEPTH) == pytest.approx(math.sqrt(0.7 / 1.3), rel=1e-12)
    assert struck(law, DEPTH)[1] == pytest.approx(0.7338 * speed_of(law, DEPTH), rel=1e-4)


def test_a_contact_that_would_soften_is_refused():
    with pytest.raises(ValueError, match=r"with restitution 0\.1 yield_share must be below 0\.0198"):
        BilinearContact(GAP, K, DEPTH, 0.1)


@pytest.mark.parametrize("analysis", [ELASTIC, INELASTIC])
@pytest.mark.parametrize("gap", [0.0, 0.02])
def test_five_storeys_against_the_reference(gap, analysis):
    """Dormand-Prince 8 from event to event. Fails if a floor that turns within the contact takes another line back."""
    scene = bilinear_pair(gap, 0.5, shake(1.2, 9.0, 3), analysis, storeys=5)
    expected = agrees_with_reference(scene)
    assert {to for _, (what, _, to) in expected.changes if what == "link"} >= {"yielding", "unloading", "returning"}


@pytest.mark.parametrize("e", [0.35, 0.9])
@pytest.mark.parametrize("k", [1e6, 1e9, 1e12])
@pytest.mark.parametrize("gap", [0.0, 0.01])
def test_hard_contacts(gap, k, e):
    """Soft to hard, floors in touch from rest: an accuracy of 1e-6 is kept."""
    keeps_its_accuracy(bilinear_pair(gap, e, shake(1.5, dt=0.05), INELASTIC, k=k))


def test_histories():
    """Fails if what the contact remembers is lost between output times."""
    history_reaches_the_peak(bilinear_pair(0.004, 0.5, shake(0.8), depth=0.0005), 5e-5, 1e-2)


@pytest.mark.parametrize("method", ["rk4-events", "rk4", "newmark"])
def test_methods_that_do_not_remember_refuse(method):
    with pytest.raises(ValueError, match="bilinear depends on events before"):
        solve(bilinear_pair(0.004, 0.5, shake(0.2)), 1e-6, method, time_step=1e-3)
