"""A number for every scene digest, for a million of them: 44 bytes each, where a dict of texts takes 250."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property
from itertools import chain, islice
from typing import overload

import numpy as np

DIGEST = 32
"""Bytes of a SHA-256 digest."""

_DIGEST = re.compile("[0-9a-f]{64}")

_MOST_FRESH = 1 << 15
"""Digests that are kept as texts, at most, before they are sorted in among the others."""

AT_ONCE = 1000
"""Digests that are texts at a time."""


def packed(digests: Sequence[str]) -> np.ndarray:
    """SHA-256 digests as bytes, shape (digests, 32).  Raises `ValueError` where one is no such digest."""
    content = bytes.fromhex("".join(digests))
    if set(map(len, digests)) - {64} or len(content) != DIGEST * len(digests):
        raise ValueError("no SHA-256 digest")
    return np.frombuffer(content, np.uint8).reshape(-1, DIGEST)


def texts(digests: np.ndarray) -> list[str]:
    """`packed` digests as texts of 64 hexadecimal digits each."""
    whole = np.ascontiguousarray(digests).tobytes().hex()
    return [whole[begin : begin + 64] for begin in range(0, len(whole), 64)]


def pieces(digests: Iterable[str], size: int = AT_ONCE) -> Iterator[Sequence[str]]:
    """So many digests at a time; those of a table (`DigestList`, or what has one as `digests`) as such lists."""
    listed = digests if isinstance(digests, DigestList) else getattr(digests, "digests", None)
    if isinstance(listed, DigestList):
        for begin in range(0, len(listed), size):
            yield DigestList(listed.digests, listed.numbers[begin : begin + size])
        return
    left = iter(digests)
    while some := list(islice(left, size)):
        yield some


def runs(numbers: np.ndarray) -> list[np.ndarray]:
    """The places of equal numbers, for each of them in rising order, shape of `numbers` (n,)."""
    order = np.argsort(numbers, kind="stable")
    return np.split(order, np.flatnonzero(np.diff(numbers[order])) + 1) if order.size else []


def heads(digests: np.ndarray) -> np.ndarray:
    """The first eight bytes of `packed` digests as numbers, shape (digests,): two digests hardly ever share them."""
    return np.ascontiguousarray(digests).view(np.uint64)[:, 0]


class Sorted:
    """Where digests stand in an array of them, found by their heads.

    digests : `packed`, no two alike, shape (n, 32); they may grow behind the first n
    """

    def __init__(self) -> None:
        self._heads = np.empty(0, np.uint64)
        self._order = np.empty(0, np.int32)

    def __len__(self) -> int:
        return len(self._order)

    def grow(self, digests: np.ndarray) -> None:
        """Take in the digests from the number that are known on."""
        known = len(self._order)
        new = heads(digests[known:])
        order = np.argsort(new, kind="stable").astype(np.int32)
        new = new[order]
        if known:
            at = np.searchsorted(self._heads, new)
            self._order, self._heads = np.insert(self._order, at, order + known), np.insert(self._heads, at, new)
        else:
            self._order, self._heads = order, new

    def find(self, digests: np.ndarray, asked: Sequence[str]) -> np.ndarray:
        """Where the digests `asked` stand among `digests`, -1 for what is none of them, shape (asked,)."""
        found = np.full(len(asked), -1, np.int64)
        if not len(self._order) or not len(asked):
            return found
        try:
            return self._find(digests, packed(asked), found)
        except ValueError:
            good = [place for place, digest in enumerate(asked) if _DIGEST.fullmatch(digest)]
            found[good] = self.find(digests, [asked[place] for place in good])
            return found

    def _find(self, digests: np.ndarray, asked: np.ndarray, found: np.ndarray) -> np.ndarray:
        wanted, words = heads(asked), np.ascontiguousarray(asked).view(np.uint64)
        order, at = np.argsort(wanted), np.empty(len(wanted), np.int64)
        at[order] = np.searchsorted(self._heads, wanted[order])  # in rising order: a third of the time
        left = np.flatnonzero((at < len(self._heads)) & (self._heads[np.minimum(at, len(self._heads) - 1)] == wanted))
        while left.size:  # once, but where digests share a head
            places = self._order[at[left]]
            same = (digests[places].view(np.uint64) == words[left]).all(axis=1)
            found[left[same]] = places[same]
            left = left[~same]
            at[left] += 1
            left = left[at[left] < len(self._heads)]
            left = left[self._heads[at[left]] == wanted[left]]
        return found


class DigestList(Sequence[str]):
    """Digests as texts, made when they are looked at.

    digests : `packed`; numbers : which of them, in order, -1 for an empty text; all unless given
    """

    def __init__(self, digests: np.ndarray, numbers: np.ndarray | None = None) -> None:
        self.digests = digests
        self.numbers = np.arange(len(digests)) if numbers is None else numbers

    def __len__(self) -> int:
        return len(self.numbers)

    @overload
    def __getitem__(self, place: int) -> str: ...

    @overload
    def __getitem__(self, place: slice) -> list[str]: ...

    def __getitem__(self, place: int | slice) -> str | list[str]:
        if not isinstance(place, slice):
            return self._texts(self.numbers[[place]])[0]
        return self._texts(self.numbers[place])

    def __iter__(self) -> Iterator[str]:
        for begin in range(0, len(self), AT_ONCE):
            yield from self[begin : begin + AT_ONCE]

    def _texts(self, numbers: np.ndarray) -> list[str]:
        found = texts(self.digests[numbers])
        for place in np.flatnonzero(numbers < 0).tolist():
            found[place] = ""
        return found


class DigestTable:
    """Digests by number, and numbers by digest.

    digests : `packed`, no two alike, shape (scenes, 32)
    """

    def __init__(self, digests: np.ndarray) -> None:
        self.digests = digests

    def __len__(self) -> int:
        return len(self.digests)

    @cached_property
    def _sorted(self) -> Sorted:
        found = Sorted()
        found.grow(self.digests)
        return found

    def numbers(self, digests: Sequence[str]) -> np.ndarray:
        """Numbers of digests, -1 for one that is not there, shape (digests,)."""
        if isinstance(digests, DigestList) and digests.digests is self.digests:  # need not be looked up
            return digests.numbers
        return self._sorted.find(self.digests, digests)

    def texts(self, numbers: np.ndarray) -> list[str]:
        """Digests by number, "" for -1; shape of `numbers` (digests,)."""
        return DigestList(self.digests, numbers)[:]


class DigestMap:
    """Numbers by digest; texts that are no SHA-256 digests may be among them.

    Parameters
    ----------
    table : digests that most of them are, which are not held once more
    """

    def __init__(self, table: DigestTable | None = None) -> None:
        self._table = DigestTable(np.empty((0, DIGEST), np.uint8)) if table is None else table
        self._told = np.full(len(self._table), -1, np.int64)  # the numbers of those of the table
        self._digests = np.empty((0, DIGEST), np.uint8)
        self._numbers = np.empty(0, np.int64)
        self._sorted = Sorted()
        self._fresh: dict[str, int] = {}
        self._odd: dict[str, int] = {}

    def put(self, digests: Sequence[str], numbers: np.ndarray) -> None:
        """Give digests numbers, shape (digests,); a digest that has one gets the new one.  Numbers are not negative."""
        digests, numbers = self._put_in_table(digests, np.asarray(numbers))
        try:
            packed(digests)
        except ValueError:
            self._odd |= zip(digests, numbers.tolist(), strict=True)
            return
        known = self._sorted.find(self._digests, digests)
        self._numbers[known[known >= 0]] = numbers[known >= 0]
        new = np.flatnonzero(known < 0).tolist()
        for place in new:
            self._fresh[digests[place]] = int(numbers[place])
        if len(self._fresh) > _MOST_FRESH:
            self._settle()

    def _put_in_table(self, digests: Sequence[str], numbers: np.ndarray) -> tuple[Sequence[str], np.ndarray]:
        """Give those of the table their numbers; returns the others."""
        places = self._table.numbers(digests)
        self._told[places[places >= 0]] = numbers[places >= 0]
        others = np.flatnonzero(places < 0)
        return [digests[place] for place in others.tolist()], numbers[others]

    def get(self, digest: str) -> int:
        """The number of a digest; -1 where it has none."""
        number = self._fresh.get(digest, -1)
        return int(self.of([digest])[0]) if number < 0 else number

    def of(self, digests: Sequence[str]) -> np.ndarray:
        """The numbers of digests, -1 where one has none, shape (digests,)."""
        places = self._table.numbers(digests)
        found = np.where(places >= 0, self._told[places] if len(self._told) else -1, -1)
        others = np.flatnonzero(places < 0)
        if others.size:
            texts = digests[:]
            found[others] = self._of_others([texts[place] for place in others.tolist()])
        return found

    def _of_others(self, digests: Sequence[str]) -> np.ndarray:
        """As `of`, of digests that the table has not."""
        known = self._sorted.find(self._digests, digests)
        found = np.where(known >= 0, self._numbers[known] if len(self._numbers) else -1, -1)
        for some in (self._fresh, self._odd):
            for place in np.flatnonzero(found < 0).tolist() if some else ():
                found[place] = some.get(digests[place], -1)
        return found

    def _settle(self) -> None:
        if self._fresh:
            self._digests = np.concatenate([self._digests, packed(list(self._fresh))])
            self._numbers = np.concatenate([self._numbers, np.fromiter(self._fresh.values(), np.int64)])
            self._fresh = {}
            self._sorted.grow(self._digests)

    def __contains__(self, digest: object) -> bool:
        return isinstance(digest, str) and self.get(digest) >= 0

    def __len__(self) -> int:
        return int(np.count_nonzero(self._told >= 0)) + len(self._numbers) + len(self._fresh) + len(self._odd)

    def __iter__(self) -> Iterator[str]:
        return chain.from_iterable(self.pieces())

    def pieces(self) -> Iterator[Sequence[str]]:
        """Those of the table in its order, then the others in the order in which they came first; some at a time."""
        self._settle()
        yield from pieces(DigestList(self._table.digests, np.flatnonzero(self._told >= 0)))
        yield from pieces(DigestList(self._digests))
        yield from pieces(self._odd)
