"""Jankowski's contact: blows of two all but free masses in closed form, and buildings against the event-located
reference."""

from __future__ import annotations

import math

import pytest
from scipy.integrate import solve_ivp

from pounding_cli.laws.jankowski import Jankowski, JankowskiDamping, restitution_of
from pounding_cli.model.scene import Scene
from pounding_cli.solve import solve
from tests.helpers.scenes import ELASTIC, FOUNDATION, INELASTIC, shake
from tests.reference.contacts import (
    GAP,
    REDUCED,
    V0,
    K,
    agrees_with_reference,
    blow,
    contact_pair,
    history_reaches_the_peak,
    keeps_its_accuracy,
)


def jankowski_pair(gap, e, motion, analysis=ELASTIC, storeys=3, foundation=None, k=K) -> Scene:
    return contact_pair(Jankowski(gap, k, e), motion, analysis, storeys, foundation)


@pytest.mark.parametrize(("e", "accuracy"), [(0.05, 1e-6), (0.3, 1e-9), (0.5, 1e-6), (0.5, 1e-12), (0.99, 1e-6)])
def test_the_restitution_asked_comes_out(e, accuracy):
    """Fails if xi is the formula, the dashpot acts while the floors part, or its mass is not the reduced one."""
    found, rebound = blow(Jankowski(GAP, K, e), accuracy, 1.0)
    assert rebound == pytest.approx(e * V0, rel=1e-10)
    assert found.links.impulse[0] == pytest.approx((1 + e) * REDUCED * V0, rel=1e-10)
    assert found.links.impacts[0] == 1


@pytest.mark.parametrize("xi", [0.05, 0.682, 1.0, 1.2, 5.0])
def test_restitution_in_closed_form(xi):
    """Against the blow as it is written, integrated by an independent method. Fails with another power of v."""

    def slope(_, y):
        v, r = max(y[0], 0.0), y[1]
        return r, -(v**1.5 + 2 * xi * v**0.25 * max(r, 0.0))

    parted = [lambda _, y: y[0] if y[1] < 0 else 1.0]
    parted[0].terminal = True
    run = solve_ivp(slope, (0, 500), (1e-30, 1.0), "DOP853", events=parted, rtol=1e-12, atol=1e-14, max_step=0.05)
    assert -run.y[1, -1] == pytest.approx(restitution_of(xi), rel=1e-7)


def test_his_formula_gives_what_it_gives():
    """At e = 0.5 his formula is 0.682, which gives 0.494517."""
    assert JankowskiDamping.JANKOWSKI.ratio(0.5) == pytest.approx(0.682, abs=5e-4)
    assert restitution_of(0.682) == pytest.approx(0.494517, abs=5e-7)
    law = Jankowski(GAP, K, 0.5, JankowskiDamping.JANKOWSKI)
    assert blow(law, 1e-9)[1] == pytest.approx(restitution_of(law.damping_ratio) * V0, rel=1e-10)


@pytest.mark.parametrize("e", [0.01, 0.3, math.exp(-1), 0.37, math.exp(-0.5), 0.61, 0.9, 0.999, 1 - 1e-9])
def test_exact_damping_inverts_its_closed_form(e):
    """Fails where one of the three ways of solving ends before the next begins."""
    assert restitution_of(JankowskiDamping.EXACT.ratio(e)) == pytest.approx(e, rel=2e-15)


def test_no_loss_at_a_restitution_of_one():
    assert JankowskiDamping.EXACT.ratio(1.0) == JankowskiDamping.JANKOWSKI.ratio(1.0) == 0.0
    assert blow(Jankowski(GAP, K, 1.0), 1e-9)[1] == pytest.approx(V0, rel=1e-12)


@pytest.mark.parametrize("analysis", [ELASTIC, INELASTIC])
@pytest.mark.parametrize("gap", [0.0, 0.02])
@pytest.mark.parametrize(("formula", "e"), [(JankowskiDamping.EXACT, 0.5), (JankowskiDamping.JANKOWSKI, 0.6)])
def test_five_storeys_against_the_reference(formula, e, gap, analysis):
    """Dormand-Prince 8 from event to event. Fails if the dashpot acts on after the floors have turned back."""
    law = Jankowski(gap, K, e, formula)
    agrees_with_reference(contact_pair(law, shake(0.8, 9.0, 3), analysis, storeys=5))


def test_rocking_foundations_against_the_reference():
    agrees_with_reference(jankowski_pair(0.004, 0.4, shake(0.8), INELASTIC, foundation=FOUNDATION))


@pytest.mark.parametrize("dt", [0.02, 0.05])
@pytest.mark.parametrize("e", [0.01, 0.5])
@pytest.mark.parametrize("k", [1e4, 1e8, 1e12])
@pytest.mark.parametrize("gap", [0.0, 0.02])
def test_hard_contacts(gap, k, e, dt):
    """Soft as rubber to hard as rock, floors in touch from rest, samples far apart: an accuracy of 1e-6 is kept. Fails
    if a run at 1e-13 does not find when floors at rest begin to press."""
    keeps_its_accuracy(jankowski_pair(gap, e, shake(2.0, dt=dt), INELASTIC, k=k), 1e-13)


@pytest.mark.parametrize("method", ["rk4-events", "rk4", "newmark", "central-difference"])
def test_methods_that_do_not_follow_the_approach_refuse(method):
    with pytest.raises(ValueError, match="jankowski depends on events before"):
        solve(jankowski_pair(0.004, 0.5, shake(0.2)), 1e-6, method, time_step=1e-3)


def test_histories():
    """The force over time reaches the peak of the run. Fails if the branch is lost between output times."""
    history_reaches_the_peak(jankowski_pair(0.004, 0.5, shake(0.8)), 2e-5, 1e-4)
