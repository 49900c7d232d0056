"""A few mutations of results files and parts in every test run; `make fuzz` tries a thousand of each."""

from __future__ import annotations

import pytest

from .damage import Bench, hunt


@pytest.fixture(scope="module")
def bench(tmp_path_factory):
    return Bench(tmp_path_factory.mktemp("damage"))


@pytest.mark.parametrize("name", ["damaged", "parts"])
def test_nothing_damaged_is_shown_or_used_again(bench, name):
    told: list[str] = []
    found = hunt(bench, name, 20, tell=told.append)
    assert told == []
    assert found.total() == 20
