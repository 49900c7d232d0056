"""The largest closing of floors that never meet is a peak like any other: rows answered by their groups have the one
that simulating them gives, and it tells which gaps close."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from pounding_cli.batch.attempt import Task
from pounding_cli.laws.pounding import Pounding
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Scene
from pounding_cli.records.motion import Motion
from pounding_cli.solve import solve
from pounding_cli.solve.groups import GroupSolver
from pounding_cli.study import expand, load_study
from tests.helpers.scenes import ELASTIC, FOUNDATION, INELASTIC, changed, links, shake, shear_building
from tests.reference import events

CONFIGS = Path(__file__).parents[2] / "configs"
ACCURACY = 1e-6

WIDE = """\
records: {use: [parkfield], duration: 10 s, scale: 1.3}
buildings: {A: {storeys: 8, period: 0.85 s}, B: {storeys: 5, period: 0.45 s}}
group: [A, B]
cases: {wide: {link: pounding, gap: 1 m}}
analyses: [inelastic]
"""


def peak_closings(left, right, floors, motion: Motion, analysis) -> np.ndarray:
    """Largest closing of two neighbours with nothing between them [m], of pairs of floors that face each other."""
    links = tuple(Link.apart(0, *pair) for pair in floors)
    response = solve(Scene((left, right), links, motion, analysis), 1e-9)
    assert response.status == "done"
    return response.links.max_closing


def by_groups(scene: Scene):
    return GroupSolver(lambda part, watch: solve(part, ACCURACY, watch=watch), solve, ACCURACY)(scene)


def test_a_wide_gap_on_a_strong_motion(tmp_path):
    """Two buildings 1 m apart whose roofs come 0.19 m closer. Fails if a bound stands for the closing: those of whole
    segments gave 0.1997 m at the top floor."""
    (tmp_path / "wide.yaml").write_text(WIDE)
    plan = expand(load_study(tmp_path / "wide.yaml"))
    (row,) = plan.rows
    scene = plan.scenes[row.scene]
    found, whole = by_groups(scene), solve(scene, ACCURACY, all_effects=True)
    assert (found.steps, whole.links.impacts.sum()) == (0, 0)
    assert found.links.max_closing == pytest.approx(whole.links.max_closing, rel=ACCURACY)
    assert whole.links.max_closing[-1] == pytest.approx(0.1911, abs=1e-4)


MIXED = {
    "three": ((0.36, 0.60, 0.45), ("pounding", "pounding"), (0.3, 0.4)),
    "a connected pair and one apart": ((0.36, 0.60, 0.45), ("connector", "pounding"), (0.05, 0.4)),
    "two touching pairs": ((0.36, 0.60, 0.45, 0.30), ("pounding", "pounding", "infill"), (0.0, 0.4, 0.02)),
    "one, an infilled pair, two": ((0.36, 0.60, 0.30, 0.45, 0.52), ("pounding", "infill", "pounding", "pounding"),
                                   (0.3, 0.02, 0.3, 0.4)),
    "equal buildings among others": ((0.36, 0.36, 0.60, 0.60), ("pounding", "pounding", "pounding"), (0.0, 0.3, 0.3)),
}  # fmt: skip


@pytest.mark.parametrize("foundation", [None, FOUNDATION])
@pytest.mark.parametrize("analysis", [ELASTIC, INELASTIC])
@pytest.mark.parametrize("row", MIXED)
def test_rows_of_several_buildings(row, analysis, foundation):
    """Every link, floors of one building against another floor of the next too. Fails if closings are handed to the
    wrong pair or floor, or if a group is left out of what is run between its neighbour and it."""
    periods, kinds, gaps = MIXED[row]
    buildings = tuple(shear_building(period, foundation=foundation) for period in periods)
    joined = tuple(
        link
        for left, (kind, gap) in enumerate(zip(kinds, gaps, strict=True))
        for link in (*links(kind, gap, (1, 3), left), *links("pounding", 0.5, (2,), left))
    )
    joined += (dataclasses.replace(links("pounding", 0.4, (2,))[0], right_floor=3),)
    scene = Scene(buildings, joined, shake(2.0), analysis)
    found, whole = by_groups(scene), solve(scene, ACCURACY, all_effects=True)
    assert found.steps == 0
    assert found.links.impacts.tolist() == whole.links.impacts.tolist()
    scale = np.abs(whole.links.max_closing).max()
    assert found.links.max_closing == pytest.approx(whole.links.max_closing, rel=ACCURACY, abs=1e-12 * scale)


@pytest.mark.parametrize(
    ("share", "assessed", "accuracies"),
    [(1.5, False, [1e-6]), (1 + 1e-6, False, [1e-6, 1e-9]), (1.5, True, [1e-6, 1e-9]), (1 - 1e-5, False, [1e-6, 1e-9])],
)
def test_a_finer_run_only_where_the_first_does_not_tell(share, assessed, accuracies):
    """Gaps over the largest closing. Fails if the finer run always follows, if a gap within the first one's error is
    decided without it, or if the error of closings is left out of an assessed scene's."""
    two, motion = (shear_building(0.36), shear_building(0.60)), shake(2.0)
    closing = peak_closings(*two, [(3, 3)], motion, INELASTIC).max()
    asked = []

    def free(scene, accuracy):
        asked.append(accuracy)
        return solve(scene, accuracy)

    def respond(part, watch):
        return dataclasses.replace(solve(part, ACCURACY, watch=watch), error_estimate=0.0)

    scene = Scene(two, links("pounding", closing * share, (3,)), motion, INELASTIC)
    found = GroupSolver(respond, free, ACCURACY, lambda scene: assessed)(scene)
    assert asked == accuracies
    assert (found.steps == 0) == (share > 1)
    if share > 1:
        assert found.links.max_closing == pytest.approx(closing, rel=1e-7)
        assert (found.error_estimate > 0) == assessed


def test_the_energy_of_a_row_that_ends_at_rest():
    """Undamped oscillators of 0.01 s, which have given back at the end what they took in. Fails if what is missing in
    the row is set against the energies at its end alone, where each building's is set against those at its peaks."""
    short = dataclasses.replace(shear_building(0.01, 1), alpha=0.0, beta=0.0)
    motion = Motion("hump", 0.05, np.concatenate([np.sin(np.linspace(0, np.pi, 21)) ** 2, np.zeros(3)]))
    alone = solve(Scene((short,), (), motion, ELASTIC), ACCURACY)
    found = by_groups(Scene((short, short, short), (), motion, ELASTIC))
    assert abs(alone.energy["residual"]) < 1e-6
    assert found.energy["residual"] == pytest.approx(alone.energy["residual"], rel=1e-6)


def test_two_contacts_on_the_same_floors():
    """Fails if the floors are watched once for each of the two, which is refused, or if one link gets no closing."""
    two, motion = tuple(map(shear_building, (0.36, 0.60, 0.36))), shake(2.0)
    left = Link(0, 3, 3, Pounding(0.5, 2e10, 0.2)), Link(0, 3, 3, Pounding(0.6, 3e10, 0.2))
    scene = Scene(two, (*left, Link(1, 3, 3, Pounding(0.5, 2e10, 0.2))), motion, ELASTIC)
    found, whole = by_groups(scene), solve(scene, ACCURACY, all_effects=True)
    assert found.steps == 0
    assert found.links.max_closing == pytest.approx(whole.links.max_closing, rel=ACCURACY)
    assert found.links.max_closing[0] == found.links.max_closing[1] != found.links.max_closing[2]


@pytest.mark.parametrize("storeys", [1, 2, 3])
def test_linear_neighbours_by_exact_steps(storeys):
    """Links that never close leave a scene linear. Fails if the propagator gives them a spring, or tells of a force."""
    left, right = shear_building(0.36, storeys), shear_building(0.60, 2)
    floors = [(floor, floor) for floor in range(1, min(storeys, 2) + 1)]
    free = Scene((left, right), tuple(Link.apart(0, *pair) for pair in floors), shake(3.0), ELASTIC)
    exact, series = solve(free, 1e-10), solve(free, 1e-12, method="taylor")
    assert (exact.method, series.method) == ("exponential", "taylor")
    assert exact.links.max_closing == pytest.approx(series.links.max_closing, rel=1e-9)
    assert not np.any([exact.links.impacts, exact.links.peak_force, exact.links.impulse, exact.links.contact_time])
    for place in (0, 1):
        alone = solve(free.alone(place), 1e-10, method="exponential")
        assert exact.buildings[place].drift == pytest.approx(alone.buildings[0].drift, rel=1e-12)


@pytest.mark.parametrize("foundation", [None, FOUNDATION])
@pytest.mark.parametrize("analysis", [ELASTIC, INELASTIC])
def test_closings_against_the_reference(analysis, foundation):
    """Dormand-Prince 8 from event to event, on gaps that never close. Fails if a closing is the largest at a sample."""
    left, right = (shear_building(period, foundation=foundation) for period in (0.36, 0.60))
    motion = shake(1.5)
    found = peak_closings(left, right, [(1, 1), (2, 3)], motion, analysis)
    wide = tuple(Link(0, *pair, Pounding(5.0, 2e10, 0.2)) for pair in ((1, 1), (2, 3)))
    expected = events.integrate(Scene((left, right), wide, motion, analysis))
    assert found == pytest.approx(expected.max_closing, rel=1e-8)


@pytest.mark.parametrize("figure", ["fig6", "fig7"])
def test_the_closing_is_the_required_gap(figure):
    """All scenes of Figs 6 and 7 with gaps, their neighbours two by two: a gap a millionth wider than the largest
    closing never closes, and is answered without simulating contact; one a thousandth narrower closes.

    Fails if closings are bounds, or as coarse as the study's accuracy."""
    plan = expand(load_study(CONFIGS / f"{figure}.yaml"))
    task = Task(solve, ACCURACY, plan.method)
    gaps = {row.scene for row in plan.rows if row.case == "gap"}
    assert len(gaps) == 10
    for scene in map(plan.scenes.__getitem__, gaps):
        for left in range(len(scene.buildings) - 1):
            two = scene.buildings[left : left + 2]
            floors = [(link.left_floor, link.right_floor) for link in scene.links if link.left == left]
            closing = peak_closings(*two, floors, scene.motion, scene.analysis).max()
            for share, closes in ((1 + 1e-6, False), (1 - 1e-3, True)):
                between = (link for link in scene.links if link.left == left)
                joined = tuple(dataclasses.replace(changed(link, gap=closing * share), left=0) for link in between)
                pair = Scene(two, joined, scene.motion, scene.analysis)
                found = task(pair)
                assert found.status == "done"
                assert (found.links.impacts.sum() > 0) == closes
                assert (found.steps > 0) == closes
                if not closes:
                    assert found.links.max_closing.max() == pytest.approx(closing, rel=1e-12)
                    assert solve(pair, ACCURACY, all_effects=True).links.impacts.sum() == 0
