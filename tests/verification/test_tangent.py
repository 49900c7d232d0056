"""The tangent that a run carries along, against runs of motions that are a little stronger and weaker."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np
import pytest

from pounding_cli.batch.attempt import Task
from pounding_cli.laws.connector import Connector
from pounding_cli.laws.dashpot import damping_ratio
from pounding_cli.laws.hertz import Hertz
from pounding_cli.laws.peak_oriented import PeakOriented
from pounding_cli.laws.pounding import Pounding
from pounding_cli.model.foundation import Foundation
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Scene
from pounding_cli.records.motion import Motion
from pounding_cli.solve import Response, assess, solve
from pounding_cli.solve.arrays import pack, peaks_in
from pounding_cli.solve.assess import difference, nudged_motion
from pounding_cli.solve.response import BOUNDED, MEASURED
from pounding_cli.solve.run import prepare
from pounding_cli.solve.tangent import is_known
from tests.helpers.scenes import ELASTIC, INELASTIC, leaning, links, oscillator, shake, shear_building, standing

FINE = 1e-12
NUDGE = 1e-6
STIFF, SOFT = shear_building(0.36, 5), shear_building(0.60, 5)
WEAK = tuple(shear_building(period, 5, strength=0.4) for period in (0.36, 0.60))
FLOORS = (1, 2, 3, 4, 5)


def pairs(kind: str, gap: float, analysis, buildings=(STIFF, SOFT), seconds: float = 4.0) -> Scene:
    return Scene(tuple(buildings), links(kind, gap, FLOORS), shake(seconds), analysis)


def _cut(gap: float) -> Scene:
    stiffness = 20 * float(STIFF.stiffness.max())
    law = Pounding(gap, stiffness, damping_ratio(0.3), tension_cut=True)
    return Scene((STIFF, SOFT), tuple(Link(0, floor, floor, law) for floor in FLOORS), shake(4.0), INELASTIC)


def _struck(xi: float, kind: str = "pounding") -> Scene:
    """Two light oscillators that meet with little but a dashpot between them."""
    two = oscillator(1e4, 1e6, 0.02), oscillator(2e4, 4e6, 0.02)
    return Scene(two, links(kind, 0.02, (1,), xi=xi, stiffness=1e7 if kind == "pounding" else 1e5), shake(4.0), ELASTIC)


def _three() -> Scene:
    buildings = STIFF, SOFT, shear_building(0.47, 4)
    law = Pounding(0.002, 20 * float(STIFF.stiffness.max()), damping_ratio(0.65))
    between = tuple(Link(left, floor, floor, law) for left in (0, 1) for floor in (1, 2, 3, 4))
    return Scene(buildings, between, shake(4.0), INELASTIC)


def _unequal_floors() -> Scene:
    law = Pounding(0.002, 20 * float(STIFF.stiffness.max()), damping_ratio(0.5))
    return Scene((STIFF, SOFT), (Link(0, 2, 3, law), Link(0, 5, 4, law)), shake(4.0), INELASTIC)


def _founded() -> tuple:
    stiffness = float(STIFF.stiffness.max())
    base = Foundation(2e5, stiffness, 0.01 * stiffness, 1e7, 30 * stiffness, 0.3 * stiffness)
    return tuple(dataclasses.replace(building, foundation=base) for building in (STIFF, SOFT))


SCENES: dict[str, Callable[[], Scene]] = {
    "connector": lambda: pairs("connector", 0.01, INELASTIC),
    "elastic, gap": lambda: pairs("pounding", 0.01, ELASTIC),
    "inelastic, gap": lambda: pairs("pounding", 0.002, INELASTIC),
    "elastic, touching": lambda: pairs("pounding", 0.0, ELASTIC),
    "inelastic, touching": lambda: pairs("pounding", 0.0, INELASTIC),
    "weak, gap": lambda: pairs("pounding", 0.002, INELASTIC, WEAK),
    "no tension": lambda: _cut(0.002),
    "infill": lambda: pairs("infill", 0.02, INELASTIC),
    "thick infill": lambda: _struck(0.95, "infill"),
    "infill, elastic": lambda: pairs("infill", 0.02, ELASTIC),
    "three in a row": _three,
    "unequal floors": _unequal_floors,
    "dead blows": lambda: _struck(0.95),
    "P-Delta": lambda: pairs("pounding", 0.002, INELASTIC, (standing(leaning(STIFF)), standing(leaning(SOFT)))),
    "foundations": lambda: pairs("pounding", 0.002, INELASTIC, _founded()),
    "tail": lambda: dataclasses.replace(pairs("pounding", 0.002, INELASTIC), tail=1.0),
}


def moved(scene: Scene, accuracy: float = 1e-6) -> tuple[float, ...]:
    found = solve(scene, accuracy, method="taylor", tangent=True).moved
    assert found
    return found


def peaks(response: Response) -> np.ndarray:
    return np.concatenate([building.drift for building in response.buildings])


def stronger(scene: Scene, nudge: float) -> Response:
    growth = 1 + nudge * np.linspace(0.0, 1.0, scene.motion.acceleration.size)
    motion = Motion("nudged", scene.motion.dt, scene.motion.acceleration * growth)
    return solve(dataclasses.replace(scene, motion=motion), FINE, method="taylor")


@pytest.mark.parametrize("name", SCENES)
def test_change_of_the_peaks(name):
    """The largest relative change of any drift over that of the motion, against the difference of two runs at 1e-12. It
    is the larger one at the ends of the step in which the drift is largest; an infill has its mean slope in a step.
    Fails if a storey forgets where it turned back, if velocities do not jump where a force does, if an infill keeps
    its slope, or if a point of a rocking base does not follow."""
    scene = SCENES[name]()
    one, other = peaks(stronger(scene, NUDGE)), peaks(stronger(scene, -NUDGE))
    expected = np.max(np.abs(one - other) / (one + other) / NUDGE)
    assert 0.98 * expected <= moved(scene)[0] <= 1.07 * expected


def numbers(response: Response) -> dict[str, np.ndarray]:
    """By kind, in the order of the rows of `give_tangent`."""
    floors = response.buildings
    of_floors = {name: np.concatenate([getattr(each, name) for each in floors]) for name in ("drift", "acceleration")}
    named = {"max_closing": "closing", "peak_force": "force", "contact_time": "time", "impulse": "impulse"}
    return of_floors | {kind: getattr(response.links, name) for name, kind in named.items()}


@pytest.mark.parametrize("name", SCENES)
def test_no_number_changes_more(name):
    """Of every storey, floor and link the largest change over time is not below the difference of two runs, kind by
    kind, and the largest of all is above those of single numbers. Fails if links, floors or the times of events are
    left out."""
    scene = SCENES[name]()
    run = prepare(scene, 1e-6, "taylor", tangent=True)
    run.integrate()
    arrays, told = run.what.arrays, {}
    most = peaks_in(arrays, run.memory).tangent
    slots, linked = arrays.padded, arrays.links.size
    spans = [most[place * slots : (place + 1) * slots] for place in range(4)]
    told["drift"], told["acceleration"] = (np.concatenate([spans[at][span] for span in arrays.floors]) for at in (1, 3))
    for place, kind in enumerate(("closing", "force", "time", "impulse")):
        begin = 4 * slots + place * linked
        told[kind] = most[begin : begin + arrays.links.number]
    one, other = stronger(scene, NUDGE), stronger(scene, -NUDGE)
    for kind, values in numbers(one).items():
        change = np.abs(values - numbers(other)[kind]) / (2 * NUDGE)
        assert (change <= 1.05 * told[kind] + 1e-2 * np.abs(values).max(initial=0.0)).all(), kind
    assert difference(solve(scene, FINE, method="taylor"), one) <= 1.05 * NUDGE * run.response().moved[2]


def test_a_linear_scene_follows_the_growth_of_its_motion():
    """Closed form: the tangent of a linear scene is its response to the motion times t / T, whose largest displacements
    and drifts the exact method finds by itself."""
    scene = Scene((STIFF,), (), shake(4.0), ELASTIC)
    run = solve(scene, 1e-9, method="taylor", tangent=True)
    growth = np.linspace(0.0, 1.0, scene.motion.acceleration.size)
    grown = dataclasses.replace(scene, motion=Motion("grown", scene.motion.dt, scene.motion.acceleration * growth))
    exact = solve(grown, method="exponential").buildings[0]
    at_rest = solve(scene, method="exponential").buildings[0]
    largest = max(
        np.max(exact.drift / at_rest.drift),
        np.max(exact.displacement_max / np.maximum(at_rest.displacement_max, -at_rest.displacement_min)),
        np.max(-exact.displacement_min / np.maximum(at_rest.displacement_max, -at_rest.displacement_min)),
    )
    assert run.moved
    assert largest * 0.97 <= run.moved[1]
    assert run.moved[0] <= np.max(exact.drift / at_rest.drift) * 1.001


@pytest.mark.parametrize("name", ["inelastic, touching", "infill", "three in a row", "foundations"])
def test_a_run_that_carries_it_gives_the_same_numbers(name):
    """Bit for bit, and as many steps."""
    scene = SCENES[name]()
    with_it, without = solve(scene, tangent=True), solve(scene)
    assert with_it.moved is not None
    assert without.moved is None
    assert (with_it.steps, with_it.events, with_it.orders) == (without.steps, without.events, without.orders)
    assert with_it.energy == without.energy
    for one, other in ((with_it.buildings, without.buildings), ([with_it.links], [without.links])):
        for numbers, same in zip(one, other, strict=True):
            for x, y in zip(dataclasses.astuple(numbers), dataclasses.astuple(same), strict=True):
                assert np.array_equal(x, y)


@pytest.mark.parametrize("accuracy", [1e-3, 1e-6, 1e-9])
def test_it_hardly_depends_on_the_accuracy(accuracy):
    """Its series leave out what they may at any accuracy of the run."""
    scene = SCENES["inelastic, gap"]()
    assert moved(scene, accuracy) == pytest.approx(moved(scene, 1e-12), rel=0.01)


def test_floors_that_hardly_touch_stand_out():
    """Grazing: the smaller the closing beyond the gap, the more its duration changes. Fails if the change of an event's
    time is not that of the closing over its rate."""
    free = solve(Scene((STIFF, SOFT), links("pounding", np.inf, (5,)), shake(4.0), ELASTIC), FINE, method="taylor")
    largest, found = float(free.links.max_closing.max()), []
    for depth in (1e-2, 1e-4, 1e-6):
        scene = Scene((STIFF, SOFT), links("pounding", largest * (1 - depth), (5,)), shake(4.0), ELASTIC)
        found.append(moved(scene, 1e-9)[2])
    assert found[1] > 5 * found[0]
    assert found[2] > 50 * found[0]


def _known(law) -> bool:
    return is_known(pack(Scene((STIFF, SOFT), (Link(0, 5, 5, law),), shake(1.0), ELASTIC)))


def test_where_it_is_not_known_none_is_carried():
    """Laws written as operations, storeys whose slope depends on what they remember, rows that islands take apart."""
    assert _known(Connector(0.01, 1e7, 0.05))
    assert not _known(Hertz(0.01, 1e10))
    assert is_known(pack(Scene((STIFF,), (), shake(1.0), INELASTIC)))
    assert not is_known(pack(Scene((dataclasses.replace(STIFF, storey_law=PeakOriented),), (), shake(1.0), INELASTIC)))
    row = (STIFF, SOFT, STIFF, SOFT)
    law = Pounding(0.01, 1e9, 0.1)
    between = tuple(Link(left, 5, 5, law) for left in range(3))
    assert solve(Scene(row, between, shake(1.0), ELASTIC), tangent=True).moved is None


def test_at_rest_nothing_moves():
    """Still ground: no number, no change, nothing that is none."""
    still = Motion("still", 0.01, np.zeros(50))
    scene = Scene((STIFF, SOFT), links("pounding", 0.0, FLOORS), still, INELASTIC)
    assert solve(scene, method="taylor", tangent=True).moved == (0.0, 0.0, 0.0)


def test_bounds_are_above_the_true_error():
    """Fails if a bound is below the difference from a run at 1e-12."""
    for name, make in SCENES.items():
        scene = make()
        for accuracy in (1e-3, 1e-6):
            response = solve(scene, accuracy, method="taylor", tangent=True)
            found = assess(scene, response, accuracy)
            if found.estimated == BOUNDED:
                truth = solve(scene, FINE, method="taylor")
                assert difference(response, truth) <= found.error_estimate <= accuracy, name


def test_nudged_motion_is_the_one_it_follows():
    """`assess.nudged_motion` grows as the tangent's motion does."""
    motion = shake(1.0)
    change = nudged_motion(motion, 1e-3).acceleration - motion.acceleration
    growth = np.linspace(0.0, 1e-3, motion.acceleration.size)
    assert change == pytest.approx(growth * motion.acceleration, abs=1e-15)


def test_a_row_of_buildings_apart_is_as_sure_as_its_least_sure_part():
    """One building yields and is bounded, the other is stepped exactly and measured. Fails if the row counts as
    measured."""
    firm = dataclasses.replace(STIFF, yield_shear=np.full(5, np.inf))
    scene = Scene((WEAK[1], firm), links("pounding", 5.0, FLOORS), shake(2.0), INELASTIC)
    task = Task(solve, 1e-6, "auto", estimate="all")
    assert [task(Scene((each,), (), shake(2.0), INELASTIC)).estimated for each in (WEAK[1], firm)] == [
        BOUNDED,
        MEASURED,
    ]
    row = task(scene)
    assert (row.steps, row.estimated) == (0, BOUNDED)
