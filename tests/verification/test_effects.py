"""What is left out changes nothing: every effect dropped against the same scene with the effect simulated but neutral,
and Figs 6 and 7 with and without all pruning."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from pounding_cli.batch.attempt import Task
from pounding_cli.kernels import layout
from pounding_cli.laws.pounding import Pounding
from pounding_cli.model.condense import condensed
from pounding_cli.model.effects import effects_of
from pounding_cli.model.foundation import Foundation
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Scene
from pounding_cli.records.motion import Motion
from pounding_cli.solve import solve, taylor
from pounding_cli.solve.arrays import at_rest, drift_of, ended, pack
from pounding_cli.solve.ground import segments
from pounding_cli.solve.groups import GroupSolver
from pounding_cli.solve.unpack import unpack
from pounding_cli.study import expand, load_study
from tests.helpers.scenes import ELASTIC, FOUNDATION, INELASTIC, changed, links, shake, shear_building

CONFIGS = Path(__file__).parents[2] / "configs"
ACCURACY = 1e-6
FLOORS = (1, 2, 3, 4, 5)
STIFF, SOFT = shear_building(0.36, 5), shear_building(0.60, 5)


def kernel(scene: Scene, everything: bool) -> list[np.ndarray]:
    """Every number of a run that looks for what the scene needs, or for everything."""
    arrays = pack(scene)
    begun = at_rest(arrays)
    run = taylor.prepare(scene, arrays, begun.state, ACCURACY, (10**6, 10**6), everything)
    status, *counts, _ = run(*begun[:3], *segments(scene))
    assert status == layout.DONE
    state, peaks, *_ = ended(arrays, [begun.memory])
    buildings, found, _ = unpack([scene], arrays, drift_of(arrays, state.u), peaks)
    return [*(value for most, base in buildings for value in (*most, *base)), *found, np.array(counts)]


@pytest.mark.parametrize("kind", ["pounding", "infill", "connector"])
@pytest.mark.parametrize("analysis", [ELASTIC, INELASTIC])
def test_a_run_without_a_ledger_gives_the_same_numbers(kind, analysis):
    """Bit for bit; it says nothing of energies. Fails if it steps otherwise, or shows energies that it did not book."""
    scene = Scene((STIFF, SOFT), links(kind, 0.02, FLOORS), shake(2.0), analysis)
    booked, left = solve(scene, ACCURACY), solve(scene, ACCURACY, ledger=False)
    assert booked.energy
    assert not left.energy
    assert (left.status, left.steps, left.events, left.orders) == ("done", booked.steps, booked.events, booked.orders)
    for one, other in ((booked.buildings, left.buildings), ([booked.links], [left.links])):
        for numbers, same in zip(one, other, strict=True):
            for x, y in zip(dataclasses.astuple(numbers), dataclasses.astuple(same), strict=True):
                assert np.array_equal(x, y)


@pytest.mark.parametrize("kind", ["pounding", "infill", "connector"])
def test_looking_for_yielding_changes_nothing_in_an_elastic_scene(kind):
    """Bit for bit, steps and orders too; all other effects are told by the scene's own arrays. Fails if storeys yield
    in an elastic analysis."""
    scene = Scene((STIFF, SOFT), links(kind, 0.02, FLOORS), shake(2.0), ELASTIC)
    for a, b in zip(kernel(scene, False), kernel(scene, True), strict=True):
        assert np.array_equal(a, b)
    strong = dataclasses.replace(scene, buildings=_rebuilt(yield_shear=lambda b: b.yield_shear * np.inf))
    found = solve(scene, ACCURACY).buildings
    assert max(building.ductility.max() for building in found) > 1.5  # inelastic storeys would yield
    for building, other in zip(found, solve(strong, ACCURACY).buildings, strict=True):
        assert np.array_equal(building.shear, other.shear)


def peaks(response) -> np.ndarray:
    fields = ("shear", "drift", "ductility", "acceleration", "displacement_max", "displacement_min")
    return np.concatenate([getattr(b, field) for b in response.buildings for field in fields])


def _rebuilt(**changes):
    return tuple(dataclasses.replace(b, **{k: v(b) for k, v in changes.items()}) for b in (STIFF, SOFT))


def _linked(kind="pounding", gap=0.01, **changes):
    return tuple(changed(link, **changes) for link in links(kind, gap, FLOORS))


RIGID = Foundation(2e5, 1e19, 0.0, 1e6, 1e21, 0.0)
NEUTRAL = {
    "yielding storeys": (_rebuilt(yield_shear=lambda b: b.yield_shear * np.inf), _linked(), INELASTIC,
                         _rebuilt(yield_shear=lambda b: b.yield_shear * 1e6), _linked()),
    "P-Delta": ((STIFF, SOFT), _linked(), INELASTIC,
                _rebuilt(gravity_load=lambda b: 1e-12 * b.stiffness * b.height), _linked()),
    "foundation motions": ((STIFF, SOFT), _linked(), INELASTIC, _rebuilt(foundation=lambda b: RIGID), _linked()),
    "mass-proportional damping": (_rebuilt(alpha=lambda b: 0.0), _linked(), ELASTIC,
                                  _rebuilt(alpha=lambda b: 1e-14), _linked()),
    "stiffness-proportional damping": (_rebuilt(beta=lambda b: 0.0), _linked(), ELASTIC,
                                       _rebuilt(beta=lambda b: 1e-16), _linked()),
    "pounding links": ((STIFF, SOFT), (), INELASTIC, (STIFF, SOFT), _linked(gap=9.0)),
    "infill links": ((STIFF, SOFT), (), ELASTIC,
                     (STIFF, SOFT), _linked("infill", 9.0, stiffness=1e-6, impact_stiffness=1e-6)),
    "connector links": ((STIFF, SOFT), (), ELASTIC, (STIFF, SOFT), _linked("connector", stiffness=1e-6)),
    "link dashpots": ((STIFF, SOFT), _linked(damping_ratio=0.0), ELASTIC, (STIFF, SOFT), _linked(damping_ratio=1e-13)),
    "tension cut-off": ((STIFF, SOFT), _linked(damping_ratio=0.0), ELASTIC,
                        (STIFF, SOFT), _linked(damping_ratio=0.0, tension_cut=True)),
}  # fmt: skip


@pytest.mark.parametrize("effect", NEUTRAL)
def test_an_effect_left_out_equals_the_effect_made_neutral(effect):
    """The scene without it, pruned, against the scene that has it with nothing to do, with everything simulated.

    Fails if the effect does something where it has nothing to do.
    """
    buildings, joined, analysis, neutral_buildings, neutral_links = NEUTRAL[effect]
    motion = shake(0.3 if effect == "foundation motions" else 1.0)  # rigid springs take a million steps a second
    without = Scene(buildings, joined, motion, analysis)
    neutral = Scene(neutral_buildings, neutral_links, motion, analysis)
    assert effect not in effects_of(without).kept
    pruned, full = solved_in_groups(without), solve(neutral, 1e-9, all_effects=True)
    assert pruned.status == full.status == "done"
    for a, b in zip(pruned.buildings, full.buildings, strict=True):
        for field in ("shear", "drift", "acceleration", "displacement_max", "displacement_min"):
            assert getattr(a, field) == pytest.approx(getattr(b, field), rel=2 * ACCURACY), field


@pytest.mark.parametrize("foundation", [None, FOUNDATION])
@pytest.mark.parametrize("kind", [None, "connector"])
def test_exact_steps_equal_the_series(kind, foundation):
    """The linear path against the event-located integrator, energies and forces too. Fails if the propagator's
    power series is one term short, or a connector's dashpot is left out of its energy."""
    left, right = shear_building(0.36, 5, foundation), shear_building(0.60, 4)
    joined = tuple(links(kind, 0.05, (1, 3, 4))) if kind else ()
    scene = Scene((left, right) if kind else (left,), joined, shake(3.0), ELASTIC, tail=0.5)
    exact, series = solve(scene, 1e-10, "exponential"), solve(scene, 1e-12, all_effects=True)
    assert (exact.method, series.method) == ("exponential", "taylor")
    assert peaks(exact) == pytest.approx(peaks(series), rel=1e-9)
    assert exact.links.peak_force == pytest.approx(series.links.peak_force, rel=1e-9)
    assert exact.links.impulse == pytest.approx(series.links.impulse, rel=1e-9)
    assert exact.buildings[0].sway == pytest.approx(series.buildings[0].sway, rel=1e-9)
    assert exact.buildings[0].rocking == pytest.approx(series.buildings[0].rocking, rel=1e-9)
    for entry, joule in series.energy.items():
        assert exact.energy[entry] == pytest.approx(joule, abs=1e-9 * series.energy["input"]), entry
    assert abs(exact.energy["residual"]) < 1e-12


@pytest.mark.parametrize("seed", range(6))
def test_exact_steps_find_peaks_between_spikes(seed):
    """Samples that jump at random, buildings of any damping: the largest values lie between samples of one sign of
    curvature and another. Fails if a peak is only looked for where the samples show one."""
    random = np.random.default_rng(seed)
    for damping in (0.0, 0.05, 0.5, 0.99):
        building = shear_building(random.uniform(0.3, 2.0), 3, damping=damping)
        jumps = random.normal(size=60) * (random.random(60) < 0.2)
        scene = Scene((building,), (), Motion("spikes", 0.01, np.append(jumps, 0.0)), ELASTIC)
        exact, series = solve(scene, 1e-10), solve(scene, 1e-13, method="taylor")
        assert exact.method == "exponential"
        assert peaks(exact) == pytest.approx(peaks(series), rel=1e-9)


@pytest.mark.parametrize("samples", range(6, 12))
def test_exact_steps_find_a_peak_just_before_the_ground_stops(samples):
    """A floor that a spike has set moving is turned back by the last sample, then the ground stands still. Fails if
    the floor's acceleration at the end of that step is taken with the still ground."""
    pushed = np.zeros(samples)
    pushed[1], pushed[-1] = 5.0, -40.0
    scene = Scene((shear_building(0.6, 1),), (), Motion("spike", 0.01, pushed), ELASTIC, tail=0.02)
    exact, series = solve(scene, 1e-10), solve(scene, 1e-13, method="taylor")
    assert exact.method == "exponential"
    assert peaks(exact) == pytest.approx(peaks(series), rel=1e-9)


@pytest.mark.parametrize(("spring", "held"), [(1e6, False), (1e9, True), (1e12, True)])
def test_rigid_foundation_is_held_fixed(spring, held):
    """Condensed only where that costs less than the accuracy. Fails if the bound leaves out the height of a rocking
    building, or condenses a million times the storeys' stiffness."""
    stiffness = spring * STIFF.stiffness.max()
    foundation = dataclasses.replace(
        FOUNDATION,
        sway_stiffness=stiffness,
        rocking_stiffness=stiffness * STIFF.elevation[-1] ** 2 * 4,
        inertia=1e3,  # so that the height decides, not the foundation's own inertia
    )
    building = dataclasses.replace(STIFF, foundation=foundation)
    scene = Scene((building,), (), shake(0.04), INELASTIC)
    left, said = condensed(scene, ACCURACY)
    assert (left.buildings[0].foundation is None) == held
    assert len(said) == 2 * held
    if spring == 1e9:
        assert peaks(solve(scene, ACCURACY)) == pytest.approx(
            peaks(solve(scene, ACCURACY, all_effects=True)), rel=ACCURACY
        )


def solved_in_groups(scene: Scene):
    return GroupSolver(lambda part, watch: solve(part, ACCURACY, watch=watch), solve, ACCURACY)(scene)


def test_a_row_falls_apart_where_nothing_closes():
    """Three buildings, touching on one side, far apart on the other: two groups, whose numbers are those of the whole.
    Fails if a group keeps the places its links had in the row, or a link that stays open loses its closing."""
    near = tuple(links("pounding", 0.0, FLOORS))
    far = tuple(changed(link, gap=0.5) for link in near)
    for row, left, right in (((STIFF, SOFT, SOFT), near, far), ((SOFT, STIFF, SOFT), far[:2], near[:3])):
        moved = tuple(dataclasses.replace(link, left=1) for link in right)
        scene = Scene(row, (*left, *moved), shake(2.0), INELASTIC)
        parted, whole = solved_in_groups(scene), solve(scene, ACCURACY, all_effects=True)
        assert parted.steps == 0
        assert "the gap never closes" in parted.dropped[-1]
        assert peaks(parted) == pytest.approx(peaks(whole), rel=ACCURACY)
        assert np.array_equal(parted.links.impacts, whole.links.impacts)
        assert parted.links.peak_force == pytest.approx(whole.links.peak_force, rel=ACCURACY, abs=1e-3)
        assert parted.links.max_closing == pytest.approx(whole.links.max_closing, rel=ACCURACY)
        assert parted.energy["input"] == pytest.approx(whole.energy["input"], rel=ACCURACY)
        assert abs(parted.energy["residual"]) < 1e-8


@pytest.mark.parametrize("analysis", [ELASTIC, INELASTIC])
def test_samples_are_displacements_at_the_ends_of_segments(analysis):
    """Both ways of solving; each sample is where a run that ends there ends. Fails if a sample stands a segment early
    or late, or holds what the step before it left."""
    scene = Scene((SOFT,), (), shake(3.0), analysis)
    found = solve(scene, ACCURACY, watch=True)
    assert found.method == ("exponential" if analysis == ELASTIC else "taylor")
    (samples,) = found.samples
    assert samples.shape == (scene.motion.acceleration.size - 1, 5)
    for count in (1, 2, 70, len(samples)):
        cut = Motion("cut", scene.motion.dt, scene.motion.acceleration[: count + 1])
        ((end, _),) = solve(dataclasses.replace(scene, motion=cut), ACCURACY).final
        assert samples[count - 1] == pytest.approx(end, rel=1e-9, abs=1e-15)


@pytest.mark.parametrize("share", [0.97, 0.999, 1 - 1e-6, 1 + 1e-6, 1.2])
def test_a_gap_is_only_called_open_when_it_is(share):
    """Gaps a little narrower and wider than the buildings' own motions need. Fails if the largest closing is one at a
    sample of the motion, or if a gap that is wide enough is simulated."""
    one = Link(0, 5, 5, Pounding(10.0, 1e9, 0.2))
    reach = float(solve(Scene((STIFF, SOFT), (one,), shake(2.0), INELASTIC), 1e-10).links.max_closing[0])
    link = changed(one, gap=reach * share)
    scene = Scene((STIFF, SOFT), (link,), shake(2.0), INELASTIC)
    found, whole = solved_in_groups(scene), solve(scene, ACCURACY, all_effects=True)
    assert found.links.impacts[0] == whole.links.impacts[0]
    assert peaks(found) == pytest.approx(peaks(whole), rel=ACCURACY)
    assert (found.steps == 0) == (share > 1)


@pytest.mark.parametrize("figure", ["fig6", "fig7"])
def test_figures_with_every_effect(figure):
    """Every scene of Figs 6 and 7, pruned and with every effect simulated: one answer to the accuracy asked.

    Fails if a gap that closes is taken for open.
    """
    plan = expand(load_study(CONFIGS / f"{figure}.yaml"))
    pruned, full = (Task(solve, ACCURACY, "taylor", all_effects=everything) for everything in (False, True))
    not_simulated = 0
    for scene in plan.scenes.values():
        a, b = pruned(scene), full(scene)
        assert a.status == b.status == "done"
        not_simulated += a.steps == 0
        for x, y in zip(a.buildings, b.buildings, strict=True):
            for field in ("shear", "drift", "ductility", "acceleration"):
                assert getattr(x, field) == pytest.approx(getattr(y, field), rel=ACCURACY), field
        assert np.array_equal(a.links.impacts, b.links.impacts)
        assert a.links.max_closing == pytest.approx(b.links.max_closing, rel=ACCURACY)
        largest = b.links.peak_force.max(initial=0.0)
        assert a.links.peak_force == pytest.approx(b.links.peak_force, abs=ACCURACY * largest)
    assert not_simulated == {"fig6": 4, "fig7": 8}[figure]


@pytest.mark.parametrize("kind", [None, "pounding", "connector"])
def test_storeys_that_never_yield_have_the_shears_of_an_elastic_analysis(kind):
    """Fails if an inelastic analysis takes its shears from a kernel that was compiled without yielding."""
    never = [dataclasses.replace(b, yield_shear=np.full(5, np.inf)) for b in (STIFF, SOFT)]
    joined = tuple(links(kind, 0.0, FLOORS)) if kind else ()
    row = tuple(never) if kind else (never[0],)
    for everything in (False, True):
        inelastic, elastic = (
            solve(Scene(row, joined, shake(1.0), analysis), all_effects=everything) for analysis in (INELASTIC, ELASTIC)
        )
        assert elastic.buildings[0].shear.min() > 0
        assert np.array_equal(peaks(inelastic), peaks(elastic), equal_nan=True)
