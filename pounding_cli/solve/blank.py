"""Tuples of arrays for many runs to fill, each a copy of one that stands for all, in one piece of memory."""

from __future__ import annotations

from typing import Any

import numpy as np

LANES = 8
"""Doubles in a cache line."""


def aligned(count: int) -> np.ndarray:
    """Zeros that begin at a cache line, so that no vector lies across two."""
    memory = np.zeros(count + LANES)
    skip = (-memory.__array_interface__["data"][0] // 8) % LANES
    return memory[skip : skip + count]


class Blank:
    """A named tuple of vectors of doubles or of 64-bit integers, and of numbers, to be copied.

    Making forty arrays takes as long as all else about a small scene; a copy makes one.
    """

    def __init__(self, filled: Any) -> None:
        self._make = type(filled)._make
        self._numbers = [None if isinstance(value, np.ndarray) else value for value in filled]
        self._spans: list[tuple[bool, slice]] = []
        vectors, end = [value for value in filled if isinstance(value, np.ndarray)], 0
        for vector in vectors:
            self._spans.append((vector.dtype == np.int64, slice(end, end + vector.size)))
            end += -(-vector.size // LANES) * LANES
        self._memory = aligned(end)
        for (whole, span), vector in zip(self._spans, vectors, strict=True):
            (self._memory.view(np.int64) if whole else self._memory)[span] = vector
        self._places = [place for place, value in enumerate(filled) if isinstance(value, np.ndarray)]

    def copy(self) -> Any:
        """The tuple with arrays of its own."""
        memory = aligned(self._memory.size)
        memory[:] = self._memory
        integers, values = memory.view(np.int64), self._numbers.copy()
        for place, (whole, span) in zip(self._places, self._spans, strict=True):
            values[place] = integers[span] if whole else memory[span]
        return self._make(values)
