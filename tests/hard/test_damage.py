"""A few mutations of results files and parts in every test run; `make fuzz` tries a thousand of each."""

from __future__ import annotations

import pytest

from .damage import Bench, hunt


@pytest.fixture(scope="module")
def bench(tmp_path_factory):
    return Bench(tmp_path_factory.mktemp("damage"))


@pytest.mark.parametrize(("name", "tries"), [("damaged", 12), ("parts", 12), ("forged", 6)])
def test_nothing_damaged_is_shown_or_used_again(bench, name, tries):
    told: list[str] = []
    found = hunt(bench, name, tries, tell=told.append)
    assert told == []
    assert found.total() == tries
