"""A few mutations of numba's cache in every test run; `make fuzz` makes a thousand."""

from __future__ import annotations

from .damage_cache import hunt


def test_no_damage_of_the_cache_is_seen_in_a_number():
    told: list[str] = []
    found = hunt(12, tell=told.append)
    assert told == []
    assert found["compiled"] + found["used"] == 12
    assert found["compiled"] > 0
