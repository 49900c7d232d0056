"""Shears in the columns that slabs strike, below and above the blow: closed form, event-located reference, methods,
islands and rows that fall apart."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from test_columns import struck

from pounding_cli.laws.hertz import HertzDamp
from pounding_cli.laws.pounding import Pounding
from pounding_cli.methods import METHODS
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Scene
from pounding_cli.solve import solve
from pounding_cli.solve.groups import GroupSolver
from tests.helpers.scenes import ELASTIC, FOUNDATION, INELASTIC, links, oscillator, pair, shake, shear_building, still
from tests.reference import events


def asked(scene: Scene, share: float = 0.2) -> Scene:
    """The scene with the shears of the columns that its links strike asked for."""
    return replace(scene, links=tuple(replace(k, columns=share) for k in scene.links))


def agree(scene: Scene, tolerance: float = 1e-7) -> None:
    """Against the reference, and the demand against the strength by hand."""
    want, run = events.integrate(scene), solve(scene, 1e-12)
    found = run.columns
    assert run.status == "done"
    assert np.ravel([found.shear_below, found.shear_above], "F") == pytest.approx(want.columns, rel=tolerance)
    for n, e in enumerate(found.link):
        link = scene.links[e]
        place, storey = (link.left + 1, link.right_floor) if link.right_at < 1 else (link.left, link.left_floor)
        strength = link.columns * scene.buildings[place].yield_shear[storey - 1]
        assert found.demand[n] == pytest.approx(max(found.shear_below[n], found.shear_above[n]) / strength)


@pytest.mark.parametrize("at", [0.001, 0.3, 0.5, 0.9])
def test_one_blow_on_columns_that_stand_still(at):
    """A mass strikes the columns of a building too heavy to move: the reactions of a clamped beam, b^2 (3a + b) / L^3
    and a^2 (3b + a) / L^3 of the force v0 sqrt(s m'). Fails if the two ends take each other's place."""
    m, s, v0 = 1e5, 1e8, 0.5
    two = oscillator(m, 1e-3), oscillator(1e16, 1e-3, yield_shear=1e6)
    scene = Scene(two, (Link(0, 1, 1, Pounding(0.0, s, 0.0), right_at=at, columns=0.25),), still(0.4), ELASTIC)
    found = solve(scene, 1e-12, initial=([np.zeros(1)] * 2, [np.array([v0]), np.zeros(1)])).columns
    force = v0 * np.sqrt(s * m)
    below, above = (1 - at) ** 2 * (3 * at + 1 - at), at**2 * (3 * (1 - at) + at)
    assert found.shear_below[0] == pytest.approx(force * below, rel=1e-9)
    assert found.shear_above[0] == pytest.approx(force * above, rel=1e-9)
    assert found.demand[0] == pytest.approx(force * max(below, above) / 0.25e6, rel=1e-9)


@pytest.mark.parametrize("analysis", [ELASTIC, INELASTIC])
@pytest.mark.parametrize("foundation", [None, FOUNDATION], ids=["fixed", "both"])
@pytest.mark.parametrize("ends", [(1.0, 0.4), (0.7, 1.0)], ids=["right", "left"])
def test_shears_against_the_reference(ends, foundation, analysis):
    """Fails if a side, a branch of the storey or the dashpot's force is missing."""
    agree(asked(struck("pounding", analysis, foundation, *ends)))


def test_two_slabs_strike_one_storey():
    """What both add between them and beyond. Fails if a blow is told of its own force alone."""
    scene = struck("pounding", INELASTIC, None, 1.0, 0.3)
    lower, upper = scene.links[0], replace(scene.links[1], right_floor=1, right_at=0.8)
    agree(asked(replace(scene, links=(lower, upper))))


def test_columns_of_two_sides_are_not_one():
    """The middle building is struck from both sides at one storey. Fails if both forces are given to either side."""
    row = shear_building(0.36), shear_building(0.60), shear_building(0.42)
    law = links("pounding", 0.002)[0].law
    both = Link(0, 2, 2, law, right_at=0.4, columns=0.2), Link(1, 2, 2, law, left_at=0.6, columns=0.3)
    agree(Scene(row, both, shake(0.5), INELASTIC))


def test_program_steps():
    """Hertz-damp contact. Fails if a program step leaves the shears out, or takes them in another unit of time."""
    scene = struck("pounding", INELASTIC)
    law = HertzDamp(0.002, 1e11, 0.5)
    agree(asked(replace(scene, links=tuple(replace(link, law=law) for link in scene.links))))


@pytest.mark.parametrize("name", [name for name, method in METHODS.items() if method.takes_step])
def test_fixed_steps(name):
    """Fails if a method of fixed steps leaves the shears at zero."""
    scene = asked(struck("pounding", ELASTIC))
    want, found = solve(scene, 1e-10), solve(scene, method=name, time_step=1e-6)
    assert found.columns.shear_below == pytest.approx(want.columns.shear_below, rel=2e-2)
    assert found.columns.shear_above == pytest.approx(want.columns.shear_above, rel=2e-2)


def test_islands():
    """A building whose neighbour is solved apart: its columns' share of the storey counts all the same."""
    row = tuple(shear_building(period, 3, FOUNDATION) for period in (0.36, 0.5, 0.42, 0.6, 0.3))
    law = links("pounding", 0.012)[0].law
    bridges = tuple(Link(b, j, j, law, right_at=0.6, columns=0.2) for b in range(4) for j in (2, 3))
    scene = Scene(row, bridges, shake(1.0), INELASTIC)
    together, apart = solve(scene, 1e-10, "taylor", all_effects=True), solve(scene, 1e-10, "taylor")
    assert together.links.impacts.sum() > 2
    for name in ("shear_below", "shear_above"):
        assert getattr(apart.columns, name) == pytest.approx(getattr(together.columns, name), rel=1e-7)


def test_columns_that_are_never_struck():
    """A row that falls apart tells what a run of all of it does. Fails if such columns have no shear, or that of
    another storey."""
    row = shear_building(0.36), shear_building(0.60), shear_building(0.42)
    near, far = links("pounding", 0.002)[0].law, links("pounding", 0.4)[0].law
    law = (Link(0, 2, 2, near, right_at=0.4, columns=0.2), Link(1, 1, 2, far, right_at=0.5, columns=0.3))
    scene = Scene(row, (*law, Link(1, 3, 3, far, left_at=0.5, columns=0.1)), shake(0.5), INELASTIC)
    solver = GroupSolver(lambda some, watch: solve(some, 1e-10, watch=watch), solve, 1e-10)
    apart, whole = solver(scene), solve(scene, 1e-10)
    assert any("never closes" in sentence for sentence in apart.dropped)
    assert apart.columns.link.tolist() == whole.columns.link.tolist() == [0, 1, 2]
    for name in ("shear_below", "shear_above", "demand"):
        assert getattr(apart.columns, name) == pytest.approx(getattr(whole.columns, name), rel=1e-7)


def test_no_strength_no_demand():
    """Fails if columns of a storey that cannot yield are said to have strength to spare."""
    scene = asked(struck("pounding", ELASTIC))
    endless = tuple(replace(b, yield_shear=np.full(3, np.inf)) for b in scene.buildings)
    assert np.isnan(solve(replace(scene, buildings=endless)).columns.demand).all()


@pytest.mark.parametrize(("at", "columns"), [((1.0, 1.0), 0.2), ((0.4, 0.4), 0.2), ((1.0, 0.4), 1.2)])
def test_shares_that_mean_nothing(at, columns):
    with pytest.raises(ValueError, match="give a part of 1 where one end stands between floors"):
        Link(0, 1, 1, pair("pounding", 0.0, shake(0.1)).links[0].law, *at, columns)
