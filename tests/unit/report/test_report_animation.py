"""Films: floors stand where their displacements say, touch when they touch, and links flash when they push."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from pounding_cli.numbers import Unit
from pounding_cli.report.animation import Film, _Stage, fitting_scale, frames
from pounding_cli.report.picture import DrawnLink, Picture
from pounding_cli.solve.histories import ENERGIES, History

GAP = 0.05


@pytest.fixture
def scene():
    """Two buildings of two storeys 5 cm apart; the left leans over until its roof strikes at 0.5 s, for 10 ms."""
    time = 0.002 * np.arange(501)
    u = np.zeros((time.size, 2, 2))
    u[:, 0, 0], u[:, 0, 1] = 0.5 * GAP * time / 0.5, GAP * time / 0.5
    drift = np.diff(u, axis=2, prepend=0.0)
    force = np.zeros((time.size, 2))
    force[250:255, 1] = [1e6, 4e6, 5e6, 2e6, -1e6]
    zeros, still = np.zeros_like(u), np.zeros((time.size, 2))
    history = History(
        time, np.sin(time), 0 * time, u, zeros, drift, zeros, still, still, force,
        {name: 0 * time for name in ENERGIES}, ("one", "other"), ("floor 1", "floor 2"),
    )  # fmt: skip
    links = tuple(DrawnLink(0, floor, floor, "pounding", GAP) for floor in (1, 2))
    yields = (np.array([0.03, 1.0]), np.full(2, np.inf))
    picture = Picture((np.array([3.0, 6.0]),) * 2, yields, links, "t", "w", Unit("m/s2"))
    return history, picture


def stage(scene, scale=20.0, slow=1.0, begin=0.0, end=1.0):
    return _Stage(*scene, Film(begin, end, slow, 25, scale))


def faces(drawn, floor):
    """Right face of the left building and left face of the right one at a floor (0: base)."""
    slabs = [np.array(path.vertices) for path in drawn.slabs.get_paths()]
    return slabs[floor][1, 0], slabs[3 + floor][0, 0]


def test_floors_touch_in_the_film_when_they_touch_in_the_scene(scene):
    """Fails if gaps are drawn at another scale than displacements."""
    drawn = stage(scene)
    for time, apart in ((0.0, GAP), (0.25, GAP / 2), (0.5, 0.0)):
        drawn._pose(time, np.zeros(2), np.zeros(2, bool))
        left, right = faces(drawn, 2)
        assert right - left == pytest.approx(20 * apart, abs=1e-9)
        left, right = faces(drawn, 0)
        assert right - left == pytest.approx(20 * GAP)


def test_between_output_times_floors_move_straight(scene):
    drawn = stage(scene)
    drawn._pose(0.2510, np.zeros(2), np.zeros(2, bool))
    left, right = faces(drawn, 2)
    assert right - left == pytest.approx(20 * GAP * (1 - 0.502))


def test_storeys_beyond_their_yield_drift_change_colour(scene):
    """0.03 m is passed at 0.6 s by the first storey alone."""
    drawn = stage(scene)
    drawn._pose(0.55, np.zeros(2), np.zeros(2, bool))
    calm = drawn.walls.get_color()
    assert len({tuple(color) for color in calm}) == 1
    drawn._pose(0.65, np.zeros(2), np.zeros(2, bool))
    yielded = [tuple(color) != tuple(calm[0]) for color in drawn.walls.get_color()]
    assert yielded == [True, True] + [False] * 6  # two walls a storey


@pytest.mark.parametrize("slow", [1.0, 4.0])
def test_an_impact_shorter_than_a_frame_is_seen_and_fades(scene, slow):
    """Fails if only the forces at the frames' own times are drawn."""
    drawn = stage(scene, slow=slow)
    bright, pull = drawn._brightness()
    times = drawn.film.times
    assert (bright[:, 0] == 0).all()
    assert (bright[times < 0.499, 1] == 0).all()
    assert bright[:, 1].max() == 1.0
    first = int(np.argmax(bright[:, 1] == 1.0))
    assert times[first] == pytest.approx(0.504, abs=1 / 25 / slow)
    share = bright[first + 3, 1] / bright[first + 2, 1]
    assert share == pytest.approx(np.exp(-1 / (0.2 * 25)), rel=1e-6)
    assert not pull[first, 1]


def test_a_pull_is_told_from_a_push(scene):
    history, picture = scene
    history.link_force[:] = 0.0
    history.link_force[250:255, 1] = -3e6
    _, pull = stage((history, picture))._brightness()
    assert pull[:, 1].any()


def test_the_scale_is_round_and_shows_the_motion(scene):
    history, picture = scene
    scale = fitting_scale(history, picture)  # 0.1 m at the roof of 6 m
    assert scale == 5.0
    assert 0.04 < scale * 0.1 / 6.0 < 0.121
    history.displacement[:] = 0.0
    assert fitting_scale(history, picture) == 1.0


def test_frames_are_pictures_that_differ(scene):
    shown = list(frames(*scene, Film(0.0, 0.2, 1.0, 25, 20.0)))
    assert len(shown) == 6
    assert all(frame.dtype == np.uint8 and frame.shape[2] == 3 for frame in shown)
    assert all(size % 2 == 0 for size in shown[0].shape[:2])  # as video wants
    assert all((one != other).any() for one, other in pairwise(shown))


@pytest.mark.parametrize("turn", [0.0, 0.001])
def test_a_slab_that_strikes_columns_touches_them(scene, turn):
    """The link ends on the columns as they are drawn: clamped in the floors, which lean with a rocking base. Fails if
    the columns are straight, or the star stands at the floor."""
    history, picture = scene
    history.rocking[:, 1] = turn
    history.displacement[:, 1, 0], history.displacement[:, 1, 1] = 0.01, 0.03
    link = DrawnLink(0, 2, 2, "pounding", GAP, 1.0, 0.25)
    drawn = stage((history, replace(picture, links=(link, None), slabs=(0.3, 0.0))))
    drawn._pose(0.5, np.ones(2), np.zeros(2, bool))
    bent = 3 * 0.25**2 - 2 * 0.25**3
    struck = 20 * (0.01 + 0.02 * bent + turn * 3.0 * (0.25 - bent))
    middle = (drawn.left[0] + drawn.width + 20 * GAP + drawn.left[1] + struck) / 2
    height = (6.0 + 3.0 + 0.25 * 3.0) / 2
    assert drawn.flashes.get_offsets()[0] == pytest.approx((middle, height))
    wall = drawn.walls.get_segments()[6]  # the near one of the upper storey on the right
    assert wall[2] - (0.04 * drawn.width, 0.0) == pytest.approx((drawn.left[1] + struck, 3.75))
    plates = drawn.plates.get_paths()
    assert len(plates) == 2
    assert np.ptp(plates[0].vertices[:, 1]) == pytest.approx(0.3)
