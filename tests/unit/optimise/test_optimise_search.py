"""The search of `pound optimise` on functions whose least is known."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pounding_cli.optimise.search import MAP, POLISH, SEARCH, SLICES, WRITTEN, Search, Settings


def searched(function, options, written=None, error=0.0, **settings):
    """A search that is over."""
    search = Search(options, Settings(**settings), written)
    while (points := search.ask()) is not None:
        assert len(set(points)) == len(points)
        assert not set(points) & set(search.values)  # nothing is asked twice
        search.tell([function(point) for point in points], [error] * len(points))
    return search


def bowl(point, centre=(0.3, 0.7, 0.5)):
    return 1 + sum((u - c) ** 2 for u, c in zip(point, centre, strict=False))


def kinked(point):
    """The larger of two planes and a wall; least by hand where both planes meet on the kink: u = 0.3, v = 2/7."""
    return 1 + max(abs(point[0] - 0.3) + 0.1 * point[1], 2 * abs(point[1] - point[0]))


def waves(point):
    """Many valleys; the deepest at 0.37."""
    return 5 + sum((10 * (u - 0.37)) ** 2 - 4 * math.cos(14 * math.pi * (u - 0.37)) for u in point)


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize(
    ("function", "best", "least", "off"),
    [
        (bowl, (0.3, 0.7), 1.0, 3e-4),
        (bowl, (0.3, 0.7, 0.5), 1.0, 3e-4),
        (kinked, (0.3, 2 / 7), 1 + 0.2 / 7, 1e-4),
        (waves, (0.37, 0.37), -3.0, 1e-4),
    ],
)
def test_the_least_from_three_seeds(function, best, least, off, seed):
    search = searched(function, (0,) * len(best), seed=seed)
    assert search.best == pytest.approx(best, abs=off)
    assert search.values[search.best] == pytest.approx(least, abs=1e-6)
    assert search.is_settled


def test_a_choice_beside_a_range():
    search = searched(lambda point: bowl(point[:1]) + (0.3, 0.0, 0.5)[int(3 * point[1])], (0, 3))
    assert search.best == (pytest.approx(0.3, abs=3e-4), 0.5)
    assert {point[1] for point in search.values} == {1 / 6, 0.5, 5 / 6}


def test_few_choices_are_all_looked_at():
    search = searched(lambda point: 1 + point[0] - point[1], (2, 4))
    assert len(search.values) == 8
    assert search.best == (0.25, 0.875)


def test_the_flat_bottom():
    """1 + (u - 0.3)^2 leaves its bottom of 1 % at 0.2 and 0.4; with an error of 0.09 at 0 and 0.6."""
    assert searched(bowl, (0, 0)).flat[0] == pytest.approx((0.2, 0.4), abs=1e-3)
    assert searched(bowl, (0, 0), error=0.09).flat[0] == pytest.approx((0.0, 0.6), abs=1e-3)


def test_the_map_has_the_two_narrowest():
    search = searched(lambda p: 1 + 4 * (p[0] - 0.3) ** 2 + 0.1 * (p[1] - 0.5) ** 2 + (p[2] - 0.6) ** 2, (0, 0, 0))
    assert search.mapped == (0, 2)
    there = [point for point, stage in search.stages.items() if stage == MAP]
    assert len(there) > 200
    assert {point[1] for point in there} == {search.best[1]}


def test_an_error_that_is_known_nearby_only():
    search = Search((0, 0))
    while (points := search.ask()) is not None:
        errors = [0.03 if search.stages[point] == SEARCH else np.nan for point in points]
        search.tell([bowl(point) for point in points], errors)
    assert search.stages[search.best] == POLISH
    assert search.error == 0.03


def test_points_without_a_value_are_no_answer():
    search = searched(lambda point: math.nan if point[0] < 0.5 else bowl(point), (0, 0))
    assert search.best == pytest.approx((0.5, 0.7), abs=1e-3)
    assert search.flat[0][0] == pytest.approx(0.5, abs=1e-3)
    assert searched(lambda point: math.nan, (0, 0)).best is None


def test_a_lower_point_in_the_surroundings_is_followed():
    """A narrow hole that the population misses lies on a slice: the search goes on from there."""

    def hole(point):
        return bowl(point) - (5.0 if abs(point[0] - 0.85) < 0.004 else 0.0)

    search = searched(hole, (0,), population=5, generations=3)
    assert search.values[search.best] < -3.5
    assert SLICES in search.stages.values()


def test_the_written_point_is_looked_at_first():
    search = searched(bowl, (0, 0), written=(0.1, 0.2))
    assert next(iter(search.stages.items())) == ((0.1, 0.2), WRITTEN)


def test_the_same_points_again():
    assert list(searched(waves, (0, 0)).values) == list(searched(waves, (0, 0)).values)
    assert list(searched(waves, (0, 0)).values) != list(searched(waves, (0, 0), seed=2).values)


def test_generations_that_are_spent_are_told():
    assert not searched(waves, (0, 0), generations=2).is_settled


def test_the_points_of_the_generations_to_come_are_known():
    """A bound that falls by a generation each time, 0 from the last one on. Fails if spent generations count."""
    search, seen = Search((0, 0), Settings(population=20, generations=4)), []
    while (points := search.ask()) is not None:
        seen.append((search.stages[points[0]], search.ahead))
        search.tell([waves(point) for point in points], [0.0] * len(points))
    assert [ahead for stage, ahead in seen if stage == SEARCH] == [80, 60, 40, 20, 0]
    assert {ahead for stage, ahead in seen if stage != SEARCH} == {0}


def test_a_valley_that_is_found_early_leaves_nothing_ahead():
    search = Search((0,), Settings(population=20))
    while (points := search.ask()) is not None:
        ahead = search.ahead
        search.tell([1.0] * len(points), [0.0] * len(points))
    assert ahead == 0
