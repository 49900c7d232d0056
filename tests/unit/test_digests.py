"""Numbers by digest, and where digests stand in an array."""

from __future__ import annotations

import hashlib

import numpy as np
import pytest

from pounding_cli import digests as digests_module
from pounding_cli.digests import DigestList, DigestMap, DigestTable, Sorted, packed, texts


def digests(*numbers: int) -> list[str]:
    return [hashlib.sha256(str(number).encode()).hexdigest() for number in numbers]


def test_texts_and_bytes():
    some = digests(*range(5))
    assert texts(packed(some)) == some
    for wrong in ("", "ab", "zz" * 32, "ab" * 31 + "  "):
        with pytest.raises(ValueError, match=r"digest|hexadecimal|fromhex"):
            packed([*some, wrong])


@pytest.mark.parametrize("known", [0, 250, 600])
def test_a_map_is_a_dict(monkeypatch, known):
    """Against a dict, through many small steps, most digests known or none. Fails if a number is lost when digests are
    sorted in, or if the first number of a digest stays."""
    monkeypatch.setattr(digests_module, "_MOST_FRESH", 50)
    table = DigestTable(packed(digests(*range(known)))) if known else None
    random, mine, theirs = np.random.default_rng(1), DigestMap(table), {}
    for _ in range(60):
        some = list(dict.fromkeys(digests(*random.integers(400, size=20).tolist())))
        numbers = random.integers(10**9, size=len(some))
        mine.put(some, numbers)
        theirs |= zip(some, numbers.tolist(), strict=True)
        asked = digests(*random.integers(600, size=30).tolist())
        assert mine.of(asked).tolist() == [theirs.get(digest, -1) for digest in asked]
        assert mine.get(asked[0]) == theirs.get(asked[0], -1)
        assert len(mine) == len(theirs)
    if table is not None:
        numbers = np.append(random.integers(known, size=50), -1)
        asked = DigestList(table.digests, numbers)
        assert mine.of(asked).tolist() == [theirs.get(digest, -1) for digest in asked]
    first = [digest for digest in digests(*range(known)) if digest in theirs]
    assert list(mine) == [*first, *(digest for digest in theirs if digest not in set(first))]
    assert asked[0] not in DigestMap()


def test_texts_that_are_no_digests():
    mine = DigestMap()
    mine.put(["a", "b"], np.array([1, 2]))
    mine.put(digests(1), np.array([3]))
    assert mine.of(["b", *digests(1, 2), "c", "a"]).tolist() == [2, 3, -1, -1, 1]
    assert sorted(mine) == sorted(["a", "b", *digests(1)])


def test_digests_that_begin_alike():
    """Fails if eight bytes decide which digest it is."""
    rows = np.repeat(packed(digests(1, 2)), 4, axis=0)
    rows[:, 31] = np.arange(8)
    known = Sorted()
    known.grow(rows[:6])
    known.grow(rows)
    assert known.find(rows, ["", "no digest", *texts(rows[:1])]).tolist() == [-1, -1, 0]
    assert known.find(rows, texts(rows)).tolist() == list(range(8))
    other = rows.copy()
    other[:, 20] += 1
    assert known.find(rows, texts(other)).tolist() == [-1] * 8
