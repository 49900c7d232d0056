"""Frame lines of floors that twist: drifts at rest, edges, histories, parts, collapses, and plans that are refused."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import pounding_cli as pound
from tests.adapter import (
    Building,
    FloorPlan,
    FrameLine,
    Link,
    Scene,
    UnstableError,
    difference,
    estimates,
    solve,
    solve_scene,
)
from tests.hard.random_scenes import random_scene
from tests.hard.twisted import twist_scene
from tests.physics.cases import shake

SHARES = ((0.7, -7.0), (0.3, 8.0))
"""Part of the stiffness and y [m] of two lines."""

STRENGTHS = (0.45, 0.55)
HOUSE = {"storeys": 2, "period": 0.4, "mass": 2e5, "yield": {"base_shear": "0.15 W"}, "collapse": "never"}
MOTION = shake(3.0, 6.0)


def add_lines(building: Building, torsion: float = 1.0, **keys: Any) -> Building:
    """Return a building with two unequal lines, `torsion` times as stiff in torsion as at 8 m from the centre."""
    lines = tuple(
        FrameLine(f"line {number}", y, share * building.stiffness, strength * building.yield_shear)
        for number, ((share, y), strength) in enumerate(zip(SHARES, STRENGTHS, strict=True))
    )
    plan = FloorPlan(building.mass * 60.0, lines, torsion * building.stiffness * 64.0, low=-10.0, high=10.0)
    return replace(building, plan=plan, stiffness=plan.stiffness, yield_shear=plan.yield_shear, **keys)


def house(motion: np.ndarray = MOTION, analysis: str = "inelastic", tail: float = 0.0, **keys: Any) -> pound.Scene:
    """Return a scene of one building with two unequal lines."""
    built = Scene([{**HOUSE, **keys}], motion, 0.02, analysis=analysis, tail=tail).built
    return replace(built, buildings=tuple(add_lines(each) for each in built.buildings))


@pytest.mark.parametrize("law", ["bilinear", "peak-oriented", "bouc-wen"])
def test_drifts_of_lines_at_rest(law: str) -> None:
    """Fails if the drift at rest of a line or of a storey is not where a long tail leaves it."""
    found = solve(house(storey_law=law, hardening=0.05))
    late = solve(house(storey_law=law, hardening=0.05, tail=40.0))
    drifts = np.diff(late.end, prepend=0.0)
    turns = np.diff(late.end_twist, prepend=0.0)
    expected = np.array([drifts - y * turns for _, y in SHARES]).T.ravel()
    largest = np.abs(expected).max()
    assert largest > 1e-4
    assert found.line_residual_drift == pytest.approx(expected, abs=2e-3 * largest)
    assert found.residual_drift == pytest.approx(drifts, abs=2e-3 * largest)


def test_shears_and_edges_over_time() -> None:
    """Fails if a storey's shear is not the largest sum of its lines, its ductility not that of its governing line, or
    an edge drift not that of the moving floor; or if energies do not close at every time."""
    scene = house()
    run = solve(scene, 1e-9)
    kept = pound.history(scene, every=2e-4, accuracy=1e-9)
    of_lines = kept.line_shear[:, 0]
    assert kept.shear[:, 0] == pytest.approx(of_lines.sum(axis=2), abs=1e-6 * run.shear.max())
    assert run.shear == pytest.approx(np.abs(of_lines.sum(axis=2)).max(axis=0), rel=1e-4)
    assert run.line_shear == pytest.approx(np.abs(of_lines).max(axis=0).ravel(), rel=1e-4)
    assert run.ductility == pytest.approx(run.line_ductility.reshape(2, 2).max(axis=1), rel=1e-12)
    assert run.ductility.max() > 1.5
    drift, turn = (np.diff(values[:, 0], prepend=0.0, axis=1) for values in (kept.displacement, kept.twist))
    assert run.edge_drift_low == pytest.approx(np.abs(drift + 10.0 * turn).max(axis=0), rel=1e-4)
    assert run.edge_drift_high == pytest.approx(np.abs(drift - 10.0 * turn).max(axis=0), rel=1e-4)
    assert run.twist == pytest.approx(np.abs(kept.twist[:, 0]).max(axis=0), rel=1e-4)
    spent = kept.energy_kinetic + kept.energy_stored + kept.energy_damping + kept.energy_hysteresis
    assert kept.energy_input == pytest.approx(spent, abs=1e-9 * float(kept.energy_input.max()))


def test_parts_with_plans_move_as_alone() -> None:
    """Two buildings that nothing links, one of them with more lines. Fails if a number is not that of each alone."""
    built = Scene([HOUSE, {**HOUSE, "storeys": 3}, HOUSE], MOTION, 0.02, {"link": "none"}, "inelastic").built
    one, other, plain = built.buildings
    other = add_lines(other)
    plan = other.plan
    assert plan is not None
    across = FrameLine("across", 5.0, np.full(3, 1e8), np.full(3, 2e5))
    other = replace(other, plan=replace(plan, lines_across=(across,)))
    scene = replace(built, buildings=(add_lines(one), other, plain), links=())
    whole = solve_scene(scene)
    kept = pound.history(scene, every=0.05)
    for place in range(3):
        alone = solve_scene(scene.alone(place))
        for group in ("buildings", "lines", "turns"):
            first, second = getattr(whole, group)[place], getattr(alone, group)[0]
            for name in type(first).__slots__:
                assert np.array_equal(getattr(first, name), getattr(second, name), equal_nan=True), name
        own = pound.history(scene.alone(place), every=0.05)
        if place < 2:
            storeys, lines = own.line_shear.shape[2:]
            assert np.array_equal(kept.line_shear[:, place, :storeys, :lines], own.line_shear[:, 0])
    assert [each.drift.shape for each in whole.lines] == [(2, 2), (3, 3), (2, 0)]
    assert np.isnan(kept.twist[:, 2]).all()


def test_a_line_collapses_its_storey() -> None:
    """A limit that the line at the far side alone reaches. Fails if the drift of the centre decides."""
    run = solve(house(analysis="elastic"))
    lines = run.line_drift.reshape(2, 2)
    storey = int(np.argmax(lines.max(axis=1) / run.drift))
    limit = 0.5 * (lines[storey].max() + run.drift.max()) / 3.0
    scene = house(collapse=float(limit))
    scene = replace(scene, analysis="inelastic")
    scene = replace(scene, buildings=tuple(replace(each, collapse=float(limit)) for each in scene.buildings))
    found = solve(scene)
    if found.status == "collapsed":
        reached = found.line_drift.reshape(2, 2)
        assert reached.max() == pytest.approx(3.0 * limit, rel=1e-9)
        assert found.place == (0, 1 + int(np.argmax(reached.max(axis=1))))
    else:
        assert found.line_drift.max() < 3.0 * limit


@pytest.mark.parametrize("number", [5, 16, 26])
def test_two_methods_agree(number: int) -> None:
    """Random plans, lines across, links at places. Fails if methods that have little in common differ."""
    scene, _ = random_scene(number)
    twisted = twist_scene(scene.built, number)
    assert any(building.plan is not None for building in twisted.buildings)
    bounds = 60_000, 60_000
    run, other = (solve(twisted, 1e-9, method=method, bounds=bounds) for method in ("taylor", "dop853"))
    assert run.status == other.status == "done"
    assert difference(run, other, ("shear", "drift", "line_shear", "line_drift", "edge_drift_low")) < 1e-8
    assert np.nanmax(np.abs(run.twist - other.twist)) < 1e-8 * np.nanmax(run.twist)


def test_small_steps_come_to_the_same() -> None:
    """Fails if the methods of fixed steps move lines otherwise, or look at other numbers of them."""
    scene = house(analysis="inelastic", hardening=0.05)
    run = solve(scene)
    for method, step in (("newmark", 5e-4), ("central-difference", 1e-4)):
        other = solve(scene, method=method, time_step=step)
        names = ("shear", "drift", "line_shear", "line_drift", "edge_drift_high", "edge_drift_low", "twist")
        assert difference(run, other, names) < 5e-3


@pytest.mark.parametrize("base", ["sway", "slider", "rocking"])
@pytest.mark.parametrize("law", ["bilinear", "imk-peak-oriented", "bouc-wen"])
def test_bases_below_floors_that_twist(base: str, law: str) -> None:
    """Fails if energies do not close, or a coarser run differs by more than its accuracy."""
    bases: dict[str, dict[str, Any]] = {
        "sway": {"mass": 2e5, "sway_stiffness": 4e8, "sway_damping": 1e6},
        "slider": {"mass": 2e5, "isolation": {"radius": 3.1, "friction": 0.06}},
        "rocking": {"mass": 2e5, "sway_stiffness": 4e8, "sway_damping": 1e6, "inertia": 1e7,
                    "rocking_stiffness": 2e10, "rocking_damping": 1e8},
    }  # fmt: skip
    laws: dict[str, Any] = {"storey_law": law}
    if law == "imk-peak-oriented":
        laws |= {"capping_ductility": 3.0, "post_capping_slope": 0.05, "strength_capacity": 20.0}
    scene = house(foundation=bases[base], p_delta=True, hardening=0.03, **laws)
    scene = replace(scene, residual_drift=False)
    run, finer = (solve(scene, accuracy) for accuracy in (1e-6, 1e-10))
    assert abs(finer.energy["residual"]) < 1e-9
    assert difference(run, finer, ("shear", "drift", "line_shear", "line_drift", "sway", "rocking")) < 1e-6


def test_energy_of_a_start() -> None:
    """Floors that are let go displaced and turned. Fails if what they hold at first is not counted."""
    scene = replace(house(np.zeros(101), "elastic"), residual_drift=False)
    start = ([np.array([0.01, 0.02, 1e-3, 2e-3])], [np.array([0.1, 0.0, 0.0, 0.05])])
    found = solve_scene(scene, 1e-10, initial=start)
    assert abs(found.energy["residual"]) < 1e-10
    assert found.energy["input"] > 1e3


def test_struck_columns_share_the_sum_of_the_lines() -> None:
    """Fails if columns of a building whose floors twist have nothing of its storey's shear."""
    built = Scene([HOUSE, HOUSE], MOTION, 0.02, {"link": "pounding", "gap": 10.0}, "inelastic").built
    left, right = (add_lines(each) for each in built.buildings)
    law = built.links[0].law
    link = Link(0, 1, 1, law, right_at=0.5, columns=0.25, left_arm=5.0, right_arm=5.0)
    found = solve_scene(replace(built, buildings=(left, right), links=(link,)))
    assert found.columns.shear_below[0] == pytest.approx(0.25 * found.buildings[1].shear[0], rel=1e-12)


def test_lines_count_in_the_estimate() -> None:
    """Fails if two responses whose lines or edges differ are told as equal."""
    found = solve_scene(house())
    for name in ("line_drift", "line_shear", "twist", "edge_drift_low", "line_residual_drift"):
        peaks = found.peaks.copy()
        peaks[name] = peaks[name] * 1.01
        assert estimates.find_difference(found, replace(found, peaks=peaks)) > 1e-5


def test_plans_that_nothing_keeps_from_turning_are_refused() -> None:
    """Fails if floors without torsional stiffness are run, or the reason is not given."""
    building = house().buildings[0]
    plan = building.plan
    assert plan is not None
    one_line = (FrameLine("one", 3.0, plan.stiffness, plan.yield_shear),)
    with pytest.raises(ValueError, match="nothing keeps the floors of storey 1 from turning"):
        replace(building, plan=replace(plan, lines=one_line, torsional_stiffness=np.zeros(2)))
    replace(building, plan=replace(plan, torsional_stiffness=np.zeros(2)))  # two lines resist
    with pytest.raises(ValueError, match="its lines add up to"):
        replace(building, stiffness=2.0 * building.stiffness)


def test_weights_that_turn_the_floors_are_refused() -> None:
    """P-Delta takes P r^2 / h from the torsional stiffness. Fails if a building that its weight turns is run, or one
    that just stands is refused."""
    building = house().buildings[0]
    plan = building.plan
    assert plan is not None
    load = np.full(2, 2e6)
    taken = 2e6 * 60.0 / building.height  # r^2 is 60 m2
    symmetric = tuple(
        FrameLine(str(y), y, 0.5 * plan.stiffness, np.full(2, np.inf)) for y in (-0.1, 0.1)
    )  # 0.01 m2 of the stiffness
    needed = taken - 0.01 * plan.stiffness
    assert (needed > 0).all()

    def stands(torsion: np.ndarray) -> Building:
        own = replace(plan, lines=symmetric, torsional_stiffness=torsion)
        return replace(building, plan=own, yield_shear=own.yield_shear, gravity_load=load)

    stands(1.01 * needed)
    with pytest.raises(UnstableError, match="P-Delta turns the floors of storey"):
        stands(np.array([1.01, 0.99]) * needed)
    eccentric = replace(plan, torsional_stiffness=np.zeros(2))
    replace(building, plan=eccentric, gravity_load=load)
    with pytest.raises(UnstableError, match="outweigh the eccentricity"):
        replace(building, plan=eccentric, gravity_load=np.full(2, 0.65 * float(building.stiffness.min()) * 3.0))
