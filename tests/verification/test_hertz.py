"""Hertz contact: blows of two all but free masses in closed form, and buildings against the event-located reference."""

from __future__ import annotations

import dataclasses
import math

import pytest
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.special import gamma

from pounding_cli.laws.hertz import Hertz, HertzDamp, HertzDamping
from pounding_cli.laws.program import MEMORY, RATE, work
from pounding_cli.laws.written import WrittenLaw
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Scene
from pounding_cli.solve import solve
from tests.helpers.scenes import (
    ELASTIC,
    FOUNDATION,
    INELASTIC,
    gather,
    links,
    oscillator,
    shake,
    shear_building,
    still,
)
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


def touching(gap: float, restitution: float | None = None, floors=(1, 2, 3), left: int = 0, k: float = K):
    """Hertz links, damped where a restitution is given."""
    law = Hertz(gap, k) if restitution is None else HertzDamp(gap, k, restitution)
    return tuple(Link(left, floor, floor, law) for floor in floors)


def hertz_pair(gap: float, restitution: float | None, motion, analysis=ELASTIC, foundation=None, **law) -> Scene:
    two = shear_building(0.36, foundation=foundation), shear_building(0.60, foundation=foundation)
    return Scene(two, touching(gap, restitution, **law), motion, analysis)


@pytest.mark.parametrize(("accuracy", "rel"), [(1e-6, 1e-10), (1e-12, 1e-14)])
def test_undamped_blow(accuracy, rel):
    """m' v0^2 / 2 = k v_m^2.5 / 2.5, and how long that lasts. Fails if q' = v' / b lacks its b, or the time that a step
    takes is not resolved."""
    found, rebound = blow(Hertz(GAP, K), accuracy)
    deepest = (2.5 * REDUCED * V0**2 / (2 * K)) ** 0.4
    lasts = 4 * math.sqrt(math.pi) * gamma(0.4) / (5 * gamma(0.9)) * deepest / V0
    assert found.links.max_closing[0] - GAP == pytest.approx(deepest, rel=rel)
    assert found.links.peak_force[0] == pytest.approx(K * deepest**1.5, rel=rel)
    assert found.links.contact_time[0] == pytest.approx(lasts, rel=rel)
    assert found.links.impulse[0] == pytest.approx(2 * REDUCED * V0, rel=rel)
    assert rebound == pytest.approx(V0, rel=rel)
    assert found.links.impacts[0] == 1


@pytest.mark.parametrize("accuracy", [1e-6, 1e-12])
@pytest.mark.parametrize("e", [0.05, 0.2, 0.5, 0.8, 0.99])
def test_the_restitution_asked_comes_out(e, accuracy):
    """Fails if zeta is a formula, or v0 is not the speed at which contact begins. Floors of e = 0.05 part slowly."""
    found, rebound = blow(HertzDamp(GAP, K, e), accuracy, 1.0)
    rel = max(1e-10, 1e-3 * accuracy)
    assert rebound == pytest.approx(e * V0, rel=rel)
    assert found.links.impulse[0] == pytest.approx((1 + e) * REDUCED * V0, rel=rel)
    assert found.links.impacts[0] == 1


@pytest.mark.parametrize("e", [0.1, 0.3, 0.5, 0.89, 0.91, 0.999])
def test_exact_damping(e):
    """By its equation as it is written. Fails if the two ways of solving it part where they meet."""
    zeta = HertzDamping.EXACT.ratio(e)
    assert 0 < zeta < 1 / e
    if e < 0.9:
        assert math.log1p(zeta) - math.log1p(-e * zeta) == pytest.approx(zeta * (1 + e), rel=1e-8)
    else:  # both sides cancel; the root of the first two powers of zeta
        assert zeta == pytest.approx(1.5 * (1 - e) / (1 - e + e**2), rel=(1 - e) ** 2)


def test_exact_damping_at_its_ends():
    assert HertzDamping.EXACT.ratio(0.5) == pytest.approx(1.43275, abs=5e-6)
    assert HertzDamping.EXACT.ratio(0.01) == pytest.approx(100.0, rel=1e-14)  # less by 100 exp(-101) / 101
    assert HertzDamping.EXACT.ratio(1.0) == 0.0


def restitution_that_comes_out(zeta: float) -> float:
    """With x = v' / v0 and F = k v^1.5 (1 + zeta x), the integrals of x / (1 + zeta x) over both halves of the blow are
    equal: both are k v_m^2.5 / (2.5 m' v0^2)."""

    def half(end: float) -> float:
        return quad(lambda x: x / (1 + zeta * x), 0, end, epsabs=1e-15, epsrel=1e-14)[0]

    return brentq(lambda e: half(1) - half(-e), 1e-6, min(1.0, (1 - 1e-9) / zeta), xtol=1e-15)


@pytest.mark.parametrize(("formula", "known"), [("ye", 0.470), ("muthukumar", 0.725)])
def test_published_damping(formula, known):
    """What the formulas of e = 0.5 give, by quadrature. Fails if they stand for each other."""
    law = HertzDamp(GAP, K, 0.5, HertzDamping(formula))
    expected = restitution_that_comes_out(law.damping_factor)
    assert round(expected, 3) == known
    assert blow(law, 1e-12)[1] == pytest.approx(expected * V0, rel=1e-12)


def test_a_hundred_blows_keep_the_energy():
    """An undamped oscillator against its neighbour, again and again. Fails if the work of a step leaves out how time
    runs in it."""
    one, other = oscillator(2e5, 2e5 * 20.0**2), oscillator(3e5, 3e5 * 13.0**2)
    scene = Scene((one, other), touching(0.0, floors=(1,)), still(25.0), ELASTIC)
    found = solve(scene, 1e-12, initial=([[0.0], [0.0]], [[1.0], [0.0]]))
    assert found.links.impacts[0] >= 100
    held = sum(
        0.5 * b.mass[0] * v[0] ** 2 + 0.5 * b.stiffness[0] * u[0] ** 2
        for b, (u, v) in zip(scene.buildings, found.final, strict=True)
    )
    assert held + found.energy["links_stored"] == pytest.approx(0.5 * 2e5, rel=1e-12)
    assert abs(found.energy["links"] / 1e5) < 1e-12


FIVE_STOREYS = {
    "hertz": lambda gap: Hertz(gap, K),
    "exact, e 0.5": lambda gap: HertzDamp(gap, K, 0.5),
    "exact, e 0.2": lambda gap: HertzDamp(gap, K, 0.2),
    "muthukumar": lambda gap: HertzDamp(gap, K, 0.5, HertzDamping.MUTHUKUMAR),
    "ye": lambda gap: HertzDamp(gap, K, 0.5, HertzDamping.YE),
}


@pytest.mark.parametrize("analysis", [ELASTIC, INELASTIC])
@pytest.mark.parametrize("gap", [0.0, 0.02])
def test_a_formula_against_the_reference(gap, analysis):
    """k v^1.5 as a study writes it, and as the reference knows it. Fails if a written power of v is another."""
    own, hertz = WrittenLaw(gap, "own", "k*v**1.5", (("k", K, (1.0, -0.5, -2.0)),)), Hertz(gap, K)
    scene, like = (contact_pair(law, shake(0.8, 9.0, 3), analysis, storeys=5) for law in (own, hertz))
    agrees_with_reference(scene, like=like)


@pytest.mark.parametrize("analysis", [ELASTIC, INELASTIC])
@pytest.mark.parametrize("gap", [0.0, 0.02])
@pytest.mark.parametrize("law", FIVE_STOREYS)
def test_five_storeys_against_the_reference(law, gap, analysis):
    """Dormand-Prince 8 from event to event. Fails if the damping looks at another speed than the largest approach speed
    of the present contact."""
    agrees_with_reference(contact_pair(FIVE_STOREYS[law](gap), shake(0.8, 9.0, 3), analysis, storeys=5))


@pytest.mark.parametrize("e", [None, 0.5])
def test_rocking_foundations_against_the_reference(e):
    """Fails if a program step leaves out what rocking does to the storeys."""
    agrees_with_reference(hertz_pair(0.004, e, shake(0.8), INELASTIC, FOUNDATION))


@pytest.mark.parametrize("kind", ["pounding", "infill", "connector"])
def test_mixed_links_against_the_reference(kind):
    """A Hertz contact at the top and another law below, in one scene."""
    scene = hertz_pair(0.004, 0.5, shake(0.8), INELASTIC)
    below = links(kind, 0.004 if kind == "pounding" else 0.02, (1, 2))
    agrees_with_reference(dataclasses.replace(scene, links=(*below, scene.links[2])))


@pytest.mark.parametrize("dt", [0.02, 0.05])
@pytest.mark.parametrize("e", [None, 0.01, 0.5])
@pytest.mark.parametrize("k", [1e4, 1e8, 1e12])
@pytest.mark.parametrize("gap", [0.0, 0.02])
def test_hard_contacts(gap, k, e, dt):
    """Soft as rubber to hard as rock, floors in touch from rest, samples far apart: an accuracy of 1e-6 is kept. Fails
    if floors that rest in touch are not asked in every step whether they press."""
    keeps_its_accuracy(hertz_pair(gap, e, shake(2.0, dt=dt), INELASTIC, k=k), 1e-13)


@pytest.mark.parametrize("gap", [0.0, 0.005])
def test_floors_that_strike_at_one_instant(gap):
    """A tower between two equal ones, at rest but for its own speed: blows of both sides never meet; twins alone never
    press."""
    twins = Scene((shear_building(0.5), shear_building(0.5)), touching(gap, 0.5), shake(1.0), INELASTIC)
    assert solve(twins, 1e-9).links.peak_force.tolist() == [0.0, 0.0, 0.0]
    row = tuple(map(shear_building, (0.36, 0.60, 0.36, 0.60)))
    joined = tuple(link for left in (0, 2) for link in touching(gap, 0.5, left=left))
    force = solve(Scene(row, joined, shake(1.0), ELASTIC), 1e-9, all_effects=True).links.peak_force
    assert force[:3].max() > 0
    assert force[3:] == pytest.approx(force[:3], rel=1e-9)


METHODS = {"rk4-events": 1e-6, "rk4": 1e-3, "newmark": 1e-2, "central-difference": 1e-2}


@pytest.mark.parametrize("method", METHODS)
def test_fixed_steps_agree(method):
    """Fails if a fixed-step method takes the force of a Hertz contact, or its tangent, as zero."""
    scene = hertz_pair(0.004, None, shake(0.8))
    exact, found = solve(scene, 1e-10), solve(scene, 1e-6, method, time_step=5e-5)
    assert found.status == "done"
    for name in ("drift", "acceleration"):
        assert gather(found, name) == pytest.approx(gather(exact, name), rel=METHODS[method]), name
    assert found.links.peak_force == pytest.approx(exact.links.peak_force, rel=METHODS[method])


@pytest.mark.parametrize("method", [name for name in METHODS if name != "rk4-events"])
def test_methods_that_cannot_keep_the_approach_speed_refuse(method):
    with pytest.raises(ValueError, match="hertz-damp depends on events before"):
        solve(hertz_pair(0.004, 0.5, shake(0.2)), 1e-6, method, time_step=1e-3)


@pytest.mark.parametrize("e", [None, 0.5])
def test_histories(e):
    """The force over time reaches the peak of the run. Fails if what a link remembers is lost between output times."""
    history_reaches_the_peak(hertz_pair(0.004, e, shake(0.8)), 2e-5, 1e-4)


def test_a_force_at_rest_needs_no_approach_speed():
    """k v^1.5 where v' / v0 is 0 / 0. Fails if the stiffness of a damped contact is no number."""
    assert HertzDamp(GAP, K, 0.5).stiffest >= Hertz(GAP, K).stiffest
    damped = Hertz(GAP, K).spring * (1.0 + 1.4 * RATE / MEMORY)
    assert work(lambda v: damped.at(v, 0.0), 0.0, 0.01) == pytest.approx(K * 0.01**2.5 / 2.5, rel=1e-12)
