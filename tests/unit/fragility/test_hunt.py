"""Hunting for the level at which a motion first passes a limit: against the whole grid, on curves of any shape."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pounding_cli.fragility.hunt import UNDECIDED, Found, found, next_levels

LEVELS = np.linspace(0.02, 2.0, 100)


def hunt(intensity, demand, fill=4):
    """Levels looked at, round by round, until nothing is asked any more."""
    seen, rounds = {}, 0
    while new := next_levels(intensity, seen, fill):
        assert not new & seen.keys()
        assert all(0 <= level < len(intensity) for level in new)
        seen |= {level: demand[level] for level in new}
        rounds += 1
    return seen, rounds


def of_grid(demand):
    """What looking at every level tells."""
    return found(dict(enumerate(demand)), len(demand))


@pytest.mark.parametrize("shape", [1.0, 0.6, 1.8])
@pytest.mark.parametrize("capacity", [0.05, 0.31, 0.9, 1.7])
def test_a_growing_demand_is_bracketed_with_few_scenes(shape, capacity):
    demand = (LEVELS / capacity) ** shape
    seen, rounds = hunt(LEVELS, demand)
    assert found(seen, 100) == of_grid(demand)
    assert len(seen) <= 18  # of 100
    assert rounds <= 8


def test_it_stops_at_the_last_level_where_nothing_passes():
    seen, _ = hunt(LEVELS, LEVELS / 5)
    assert found(seen, 100) == Found(99, 100, False)
    assert len(seen) <= 6


def test_what_passes_at_the_first_level_is_seen_at_once():
    assert hunt(LEVELS, np.full(100, 2.0)) == ({0: 2.0}, 1)


def test_a_pass_below_the_bracket_is_found():
    """Demand that passes the limit from level 40 to 60, holds above, and passes for good from 90 on."""
    demand = LEVELS / LEVELS[89]
    demand[40:60] = 1.5
    seen, _ = hunt(LEVELS, demand, fill=9)
    assert found(seen, 100) == Found(39, 40, True)
    assert found(hunt(LEVELS, demand, fill=0)[0], 100).passed >= 40


def test_failed_scenes_widen_the_bracket_and_end_nothing():
    demand = LEVELS / LEVELS[49] * 0.999
    demand[45:55] = np.nan
    seen, _ = hunt(LEVELS, demand)
    assert found(seen, 100) == Found(44, 55, False)
    assert found(hunt(LEVELS, np.full(100, np.nan))[0], 100) == Found(-1, 100, False)


def test_undecided_scenes_are_closed_in_with_few_scenes():
    """A collapse leaves levels 40 to 69 undecided. Fails if all of them are looked at, or one counts as holding."""
    demand = LEVELS / LEVELS[99]
    demand[40:70] = UNDECIDED
    demand[70:] = np.inf
    seen, _ = hunt(LEVELS, demand)
    assert found(seen, 100) == Found(39, 70, False)
    assert len(seen) <= 26
    demand[70:] = UNDECIDED
    seen, _ = hunt(LEVELS, demand)
    assert found(seen, 100) == Found(39, 100, False)
    assert len(seen) <= 26
    assert max(np.diff(sorted(level for level in seen if level >= 40))) <= 12  # one that passes there may be found
    assert found(hunt(LEVELS, np.full(100, UNDECIDED))[0], 100) == Found(-1, 100, False)


def test_a_pass_among_undecided_levels_is_found():
    demand = LEVELS / LEVELS[99]
    demand[40:] = UNDECIDED
    demand[60:75] = np.inf
    seen, _ = hunt(LEVELS, demand)
    assert found(seen, 100) == Found(39, 60, False)


def test_a_demand_without_bounds_is_bracketed_too():
    demand = np.where(LEVELS < 0.777, 0.2, np.inf)
    seen, _ = hunt(LEVELS, demand)
    assert found(seen, 100) == of_grid(demand)


@settings(max_examples=300, deadline=None)
@given(st.data())
def test_any_curve_ends_in_a_closed_bracket_filled_below(data):
    count = data.draw(st.integers(1, 60))
    fill = data.draw(st.integers(0, 6))
    value = st.one_of(st.floats(0, 3), st.just(np.nan), st.just(np.inf), st.just(UNDECIDED))
    demand = np.array(data.draw(st.lists(value, min_size=count, max_size=count)))
    intensity = np.cumsum(np.array(data.draw(st.lists(st.floats(0.01, 1), min_size=count, max_size=count))))
    seen, _ = hunt(intensity, demand, fill)
    known = found(seen, count)
    between = range(known.held + 1, known.passed)
    lost = [level for level in between if seen.get(level) == UNDECIDED]
    around = [level for level in between if not lost or not lost[0] < level < lost[-1]]
    assert all((np.isnan(demand[level]) or level in lost) and level in seen for level in around)
    if known.passed < count and known.held > 0 and fill:
        looked = sorted({-1, *(level for level in seen if level <= known.held)})
        assert max(np.diff(looked)) <= max(1, -(-known.held // (fill + 1)))
