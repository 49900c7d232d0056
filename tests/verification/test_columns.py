"""Links that end on columns between floors: elements with more than two terms, in every method."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pounding_cli.laws.hertz import HertzDamp
from pounding_cli.methods import METHODS
from pounding_cli.model.foundation import Foundation
from pounding_cli.model.links import Link, link_places
from pounding_cli.model.scene import Scene
from pounding_cli.solve import solve
from pounding_cli.solve.assess import assess, difference
from pounding_cli.solve.groups import GroupSolver
from tests.helpers.scenes import ELASTIC, FOUNDATION, INELASTIC, gather, links, pair, shake, shear_building
from tests.reference.agreement import agree
from tests.reference.rows import islands_equal_the_whole, row_of_ten
from tests.reference.rows import struck as struck_floors

ROCKS = Foundation(inertia=1e7, rocking_stiffness=1e11, rocking_damping=1e8, sways=False)


def struck(kind: str, analysis, foundation=None, left_at: float = 1.0, right_at: float = 0.4, gap: float = 0.002):
    """Floors of the left building that strike the columns of the right one."""
    scene = pair(kind, gap, shake(0.5), analysis, foundation)
    ends = tuple(replace(link, left_at=left_at, right_at=right_at) for link in scene.links)
    return replace(scene, links=ends)


@pytest.mark.parametrize("analysis", [ELASTIC, INELASTIC])
@pytest.mark.parametrize("foundation", [None, FOUNDATION, ROCKS], ids=["fixed", "both", "rocks"])
@pytest.mark.parametrize("kind", ["pounding", "infill"])
def test_floors_that_strike_columns(kind, foundation, analysis):
    """Against the event-located reference. Fails if a force goes back by other weights than the closing."""
    agree(struck(kind, analysis, foundation))


@pytest.mark.parametrize("analysis", [ELASTIC, INELASTIC])
@pytest.mark.parametrize("gap", [0.0, 0.02])
def test_pair_of_five_storeys(gap, analysis):
    """Slabs of the left building strike columns at mid-height, whose shears are asked for. Fails if a column below the
    lowest slab, or above the highest, is another's; or if the error estimate leaves the error open."""
    two = shear_building(0.36, 5), shear_building(0.60, 5)
    bridges = tuple(replace(link, right_at=0.5, columns=0.2) for link in links("pounding", gap, (1, 2, 3, 4, 5)))
    scene = Scene(two, bridges, shake(1.2, 9.0, 3), analysis)
    assert agree(scene, 1e-7).impacts.sum() > 0
    run = solve(scene, 1e-6)
    assert abs(run.energy["residual"]) < 1e-8
    assert difference(run, solve(scene, 1e-11)) <= assess(scene, run, 1e-6).error_estimate <= 1e-6


def test_chain_of_ten():
    """Fails if an island that is put back forgets the points that its links end on."""
    islands_equal_the_whole(
        row_of_ten(lambda left: [replace(link, right_at=0.5, columns=0.2) for link in struck_floors(left)])
    )


def test_columns_that_strike_columns():
    """Both ends between floors. Fails if a point of the left building is taken for a floor."""
    agree(struck("pounding", INELASTIC, FOUNDATION, 0.7, 0.25))


def test_a_connector_between_columns_and_a_floor_beside_pounding_of_floors():
    """Fails if links of one pair that end at floors and between them take each other's places."""
    scene = pair("pounding", 0.004, shake(0.5), INELASTIC)
    tie = replace(links("connector", 0.05, (2,))[0], right_at=0.5)
    agree(replace(scene, links=(*scene.links, tie)))


def test_a_point_at_the_floor_is_the_floor():
    """Fails if the columns' shape does not end in the floor."""
    near = struck("pounding", INELASTIC, right_at=1.0 - 1e-9)
    at = struck("pounding", INELASTIC, right_at=1.0)
    for name in ("shear", "drift", "acceleration"):
        assert gather(solve(near, 1e-10), name) == pytest.approx(gather(solve(at, 1e-10), name), rel=1e-6)


def test_program_steps_take_points():
    """Hertz-damp contact on columns loses no energy. Fails if a program step leaves points behind."""
    law = HertzDamp(0.002, 1e11, 0.5)
    two = shear_building(0.36, foundation=FOUNDATION), shear_building(0.60, foundation=ROCKS)
    scene = Scene(two, tuple(Link(0, j, j, law, right_at=0.4) for j in (1, 2, 3)), shake(0.5), INELASTIC)
    coarse, fine = solve(scene, 1e-8), solve(scene, 1e-11)
    assert fine.status == "done"
    assert abs(fine.energy["residual"]) < 1e-9
    assert fine.links.impacts.sum() > 2
    for name in ("shear", "drift", "acceleration"):
        assert gather(coarse, name) == pytest.approx(gather(fine, name), rel=1e-9)


@pytest.mark.parametrize("name", [name for name, method in METHODS.items() if method.takes_step])
def test_fixed_steps_take_points(name):
    """Every method of fixed steps comes near. Fails if one leaves a term of a link out."""
    scene = struck("infill", ELASTIC, FOUNDATION)
    want, found = solve(scene, 1e-10), solve(scene, method=name, time_step=1e-5)
    assert gather(found, "drift") == pytest.approx(gather(want, "drift"), rel=2e-3)
    assert found.links.peak_force == pytest.approx(want.links.peak_force, rel=2e-2)


def test_rows_with_points_are_solved_in_islands():
    """Five buildings, each on its own foundation, floors against columns. Fails if an island forgets its points."""
    row = tuple(shear_building(period, 3, FOUNDATION) for period in (0.36, 0.5, 0.42, 0.6, 0.3))
    bridges = tuple(Link(b, j, j, links("pounding", 0.012)[0].law, right_at=0.6) for b in range(4) for j in (2, 3))
    scene = Scene(row, bridges, shake(1.0), INELASTIC)
    together, apart = solve(scene, 1e-10, "taylor", all_effects=True), solve(scene, 1e-10, "taylor")
    assert apart.status == "done"
    assert together.links.impacts.sum() > 2
    assert abs(apart.energy["residual"]) < 1e-9
    for name in ("shear", "drift", "acceleration"):
        assert gather(apart, name) == pytest.approx(gather(together, name), rel=1e-7)


@pytest.mark.parametrize("gap", [0.004, 0.5])
def test_rows_answered_by_groups_keep_the_ends_of_their_links(gap):
    """A gap that closes and one that never does. Fails if a group takes the floor for the columns below it."""
    row = struck("pounding", INELASTIC, FOUNDATION, gap=gap)
    whole, parted = solve(row, 1e-9), by_groups(row)
    assert (parted.steps == 0) == (gap == 0.5)
    assert parted.links.max_closing == pytest.approx(whole.links.max_closing, rel=1e-6)
    assert parted.links.impacts.tolist() == whole.links.impacts.tolist()


def by_groups(row):
    """The response of a row whose groups are solved alone where no gap between them closes."""
    solver = GroupSolver(
        lambda scene, watch: solve(scene, 1e-9, watch=watch), lambda scene, finer: solve(scene, finer), 1e-9
    )
    return solver(row)


def test_links_between_floors_are_named_for_where():
    """Fails if two links of the same floors have one name."""
    law = links("pounding", 0.002)[0].law
    ends = (1.0, 1.0), (1.0, 0.4), (1.0, 0.5), (0.5, 0.5)
    places = link_places([Link(0, 1, 1, law, *end) for end in ends])
    assert [name for *_, name in places] == ["", "right columns", "right columns 2", "left and right columns"]


@pytest.mark.parametrize("at", [0.0, -0.1, 1.5, np.nan])
def test_places_outside_the_storey_are_refused(at):
    with pytest.raises(ValueError, match="part above 0, 1 at the floor"):
        Link(0, 1, 1, links("pounding", 0.002)[0].law, right_at=at)
