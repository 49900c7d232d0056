"""Storeys that lose strength (Ibarra, Medina & Krawinkler): throws by their energies, an integrator that shares no
code, every method, collapse without P-Delta, hard parameters."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from pounding_cli.laws.imk import PeakOrientedImk, PinchingImk
from pounding_cli.model.building import Building
from pounding_cli.model.effects import effects_of
from pounding_cli.model.scene import Scene
from pounding_cli.solve import METHODS, solve
from pounding_cli.solve.assess import assess, difference
from pounding_cli.solve.histories import history
from tests.hard.random_scenes import random_scene
from tests.helpers.scenes import INELASTIC, links, oscillator, shake, shear_building, still
from tests.reference import events
from tests.reference.agreement import agree
from tests.reference.drawn import shears
from tests.reference.rows import islands_equal_the_whole, row_of_ten, weaker

M, K, VY, V0 = 2e5, 2e7, 3e5, 0.25
CAPPED = {"capping_ductility": 3.0, "post_capping_slope": 0.1, "residual_strength": 0.3}
LOST = {
    "strength_capacity": 60.0,
    "capping_capacity": 50.0,
    "unloading_capacity": 90.0,
    "reloading_capacity": 70.0,
    "deterioration_exponent": 1.2,
}
PINCHED = {"pinching_force": 0.3, "pinching_drift": 0.6}
BOTH = pytest.mark.parametrize("law", [PeakOrientedImk, PinchingImk], ids=lambda law: law.name)


def imk(building: Building, law=PeakOrientedImk, **parameters) -> Building:
    """The building with storeys of a law, run on however far they drift unless `collapse` is given."""
    collapse = parameters.pop("collapse", np.inf)
    given = CAPPED | (PINCHED if law is PinchingImk else {}) | parameters
    return dataclasses.replace(building, storey_law=law, law_parameters=tuple(given.items()), collapse=collapse)


def throw(speed: float, hardening: float, duration: float = 1.2, **parameters):
    """An undamped storey thrown from rest."""
    scene = Scene((imk(oscillator(M, K, 0.0, VY, hardening), **parameters),), (), still(duration), INELASTIC)
    return solve(scene, 1e-12, initial=([[0.0]], [[speed]]))


@pytest.mark.parametrize(("speed", "piece"), [(0.3, "hardening"), (0.45, "capping"), (0.7, "residual")])
def test_backbone_by_its_energies(speed, piece):
    """How far a throw goes along the three lines. Fails if the capping drift, the post-capping slope or the residual
    strength is another, or the peak shear is looked for where the storey turns."""
    a, dy = 0.1, VY / K
    cap, top = 3 * dy, VY + a * K * 2 * dy
    level = cap + (top - 0.3 * VY) / (0.1 * K)
    left = 0.5 * M * speed**2 - 0.5 * VY * dy
    to_cap = 0.5 * (VY + top) * (cap - dy)
    to_level = 0.5 * (top + 0.3 * VY) * (level - cap)
    if piece == "hardening":
        expected = dy + (-VY + np.sqrt(VY**2 + 2 * a * K * left)) / (a * K)
    elif piece == "capping":
        expected = cap + (top - np.sqrt(top**2 - 2 * 0.1 * K * (left - to_cap))) / (0.1 * K)
    else:
        expected = level + (left - to_cap - to_level) / (0.3 * VY)
    assert [expected < cap, cap < expected < level, level < expected][["hardening", "capping", "residual"].index(piece)]
    run = throw(speed, a)
    assert run.buildings[0].displacement_max[0] == pytest.approx(expected, rel=1e-10)
    largest = VY + a * K * (min(expected, cap) - dy)
    assert run.buildings[0].shear[0] == pytest.approx(largest, rel=1e-11)
    assert abs(run.energy["residual"]) < 1e-11


@pytest.mark.parametrize("mode", ["none", "strength", "reloading", "unloading"])
def test_what_the_first_excursion_takes(mode):
    """A perfectly plastic storey is thrown, comes back through zero shear and turns on the line towards the yield on
    the other side; beta = E / (Et - E). Fails if a mode deteriorates by another energy, or the wrong quantity."""
    capacity, dy = 12.0, VY / K
    more = {} if mode == "none" else {f"{mode}_capacity": capacity}
    run = throw(V0, 0.0, capping_ductility=1e3, **more)
    first = dy + (0.5 * M * V0**2 - 0.5 * VY * dy) / VY
    energy = VY * (first - dy)
    beta = 0.0 if mode == "none" else energy / (capacity * VY * dy - energy)
    unloading = K * (1 - beta) if mode == "unloading" else K
    zero = first - VY / unloading
    target = dy * (1 + beta) if mode == "reloading" else dy
    shear = VY * (1 - beta) if mode == "strength" else VY
    if mode == "unloading":  # reloading no stiffer than unloading
        target = max(target, VY / unloading - zero)
    slope = shear / (zero + target)
    assert run.buildings[0].displacement_max[0] == pytest.approx(first, rel=1e-10)
    assert run.buildings[0].displacement_min[0] == pytest.approx(zero - VY / np.sqrt(unloading * slope), rel=1e-9)
    assert abs(run.energy["residual"]) < 1e-11


def test_pinching_breaks_where_it_should():
    """The same with two reloading lines: the first kappa_F as stiff as the straight one, up to zero drift, since the
    yield that it aims at has no plastic drift. Fails if the second line misses the target."""
    speed, dy = 0.33, VY / K
    run = throw(speed, 0.0, law=PinchingImk, capping_ductility=1e3)
    first = dy + (0.5 * M * speed**2 - 0.5 * VY * dy) / VY
    assert run.buildings[0].displacement_max[0] == pytest.approx(first, rel=1e-10)
    zero = first - dy
    straight = VY / (zero + dy)
    at_break = 0.3 * straight * zero
    second = (VY - at_break) / dy
    left = 0.5 * VY * dy - 0.5 * at_break * zero
    assert left > 0
    turned = (-at_break + np.sqrt(at_break**2 + 2 * second * left)) / second
    assert run.buildings[0].displacement_min[0] == pytest.approx(-turned, rel=1e-9)


@BOTH
@pytest.mark.parametrize("gap", [0.0, 0.02])
def test_pair_of_five_storeys(law, gap):
    """Against DOP853 from event to event, with a law of its own. Fails if an inner loop or a target is lost."""
    softly = LOST | {"capping_ductility": 4.0, "post_capping_slope": 0.05}
    two = tuple(imk(shear_building(period, 5, strength=2.5), law, **softly) for period in (0.36, 0.60))
    scene = Scene(two, links("pounding", gap, (1, 2, 3, 4, 5)), shake(3.0, 5.0, seed=6), INELASTIC)
    assert agree(scene, 1e-7).impacts.sum() > 0
    run = solve(scene, 1e-6)
    assert run.events > 300
    assert max(b.ductility.max() for b in run.buildings) < 40
    assert abs(run.energy["residual"]) < 1e-8
    assert difference(run, solve(scene, 1e-11)) <= assess(scene, run, 1e-6).error_estimate <= 1e-6


@BOTH
@pytest.mark.parametrize("lost", [{}, LOST], ids=["kept", "lost"])
def test_many_cycles(law, lost):
    """Two storeys through many inner loops. Fails if a reversal on a reloading line is forgotten."""
    scene = Scene(
        (imk(shear_building(0.4, 2, strength=1.0, damping=0.02), law, **lost),), (), shake(8.0, 3.5), INELASTIC
    )
    expected, run = events.integrate(scene), solve(scene, 1e-12)
    assert run.events == len(expected.changes) > 40
    assert run.buildings[0].drift == pytest.approx(expected.drift, rel=1e-9)
    assert run.buildings[0].shear == pytest.approx(expected.shear, rel=1e-9)
    assert run.buildings[0].residual_drift == pytest.approx(expected.residual_drift, rel=1e-8)
    assert run.energy["input"] == pytest.approx(expected.energy["input"], rel=1e-9)


@BOTH
@pytest.mark.parametrize("name", [name for name, method in METHODS.items() if name not in ("taylor", "exponential")])
def test_every_method_that_takes_yielding_storeys_runs_them(name, law):
    """Fails if a method that sees events at samples alone passes two corners of the backbone as one."""
    scene = Scene(
        (imk(shear_building(0.4, 2, strength=1.0, damping=0.02), law, **LOST),), (), shake(3.0, 4.0), INELASTIC
    )
    exact = solve(scene, 1e-11).buildings[0]
    errors = []
    for step in (4e-4, 1e-4):
        found = solve(scene, method=name, time_step=step).buildings[0]
        errors.append(np.abs(found.drift / exact.drift - 1).max())
    assert errors[1] < (1e-8 if METHODS[name].located else 1e-4)
    assert errors[1] < max(0.5 * errors[0], 1e-6)


def test_collapse_without_p_delta():
    """Fails if it is looked for under P-Delta alone, or the strengths of elastic analyses count."""
    building = imk(shear_building(0.6, 3, strength=0.5), residual_strength=0.0, collapse=None)
    assert building.collapse_drift == pytest.approx(0.3)
    scene = Scene((building,), (), shake(8.0, 6.0), INELASTIC)
    assert effects_of(scene).collapse
    found = solve(scene, 1e-9)
    assert found.status == "collapsed"
    assert found.buildings[0].drift.max() == pytest.approx(0.3, rel=1e-12)
    assert abs(found.energy["residual"]) < 1e-9
    assert solve(dataclasses.replace(scene, analysis="elastic"), 1e-9).status == "done"
    never = dataclasses.replace(building, yield_shear=np.full(3, np.inf))
    assert np.isinf(never.collapse_drift).all()


def test_a_reversal_gives_back_no_more_than_was_put_in():
    """Reloading down from 3 Dy and back, where a reversal takes most of the unloading stiffness. Fails if the unloading
    is softer than the line that it leaves."""
    dy = VY / K
    lost = {"unloading_capacity": 500.0, "deterioration_exponent": 0.1}
    law = PeakOrientedImk(K, VY, 0.0, capping_ductility=5.0, post_capping_slope=0.1, **lost)
    path = dy * np.array([3.0, -0.2, -0.4, -0.41, -0.4, -0.3])
    slopes = np.diff(shears(law, path)) / np.diff(path) / K
    loading, unloading = slopes[2], slopes[3:]
    assert 0.1 < loading < 0.9
    assert unloading == pytest.approx(loading, rel=1e-9)


@BOTH
def test_history_and_largest_values_agree(law):
    """Fails if what a storey remembers is lost between output times, or its energy."""
    scene = Scene(
        (imk(shear_building(0.4, 2, strength=1.0, damping=0.02), law, **LOST),), (), shake(5.0, 4.0), INELASTIC
    )
    run, kept = solve(scene, 1e-9), history(scene, 1e-9, 0.0005)
    assert np.abs(kept.shear[:, 0]).max(axis=0) == pytest.approx(run.buildings[0].shear, rel=2e-3)
    spent = sum(kept.energy[key] for key in ("kinetic", "stored", "damping", "hysteresis", "links"))
    assert np.abs(spent - kept.energy["input"]).max() < 1e-9 * kept.energy["input"].max()


def hard_parameters(n: int) -> dict[str, float]:
    """Extremes of every parameter."""
    rng = np.random.default_rng(n)
    found = {
        "capping_ductility": 1.0 + (10 ** rng.uniform(-6, 1.5) if n % 3 else 0.0),
        "post_capping_slope": 10 ** rng.uniform(-4, 6),
        "residual_strength": (0.0, 0.1, 0.999)[rng.integers(3)],
        "deterioration_exponent": rng.uniform(0.3, 3),
    }
    modes = [mode for mode in ("strength", "capping", "unloading", "reloading") if rng.random() < 0.7]
    return {key: float(value) for key, value in found.items()} | {
        f"{mode}_capacity": float(10 ** rng.uniform(-2, 4)) for mode in modes
    }


@BOTH
@pytest.mark.parametrize("n", range(12))
def test_hard_scenes(law, n):
    """Fails if a storey without strength or stiffness, or one that has spent its energy at once, stops a run."""
    pinched = {"pinching_force": (1e-3, 1.0)[n % 2], "pinching_drift": (0.0, 0.5, 1.0)[n % 3]}
    scene, _ = random_scene(n)
    parameters = hard_parameters(n) | (pinched if law is PinchingImk else {})
    buildings = tuple(imk(b, law, **parameters) for b in scene.buildings)
    run = solve(dataclasses.replace(scene, buildings=buildings, analysis=INELASTIC), 1e-7, bounds=(300_000, 60_000))
    assert run.status == "done"
    assert abs(run.energy["residual"]) < 1e-8


@BOTH
def test_chain_of_ten(law):
    """Fails if islands restore some of what a storey remembers."""
    islands_equal_the_whole(row_of_ten(changed=lambda b: imk(weaker(b), law, **LOST)))
