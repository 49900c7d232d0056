"""Tuples of arrays for many runs to fill, each a copy of one that stands for all, in one piece of memory."""

from __future__ import annotations

from collections.abc import Callable, Iterable
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
    """Named tuples of vectors of doubles or of 64-bit integers, to be copied, and of other values, which are shared.

    To make forty arrays takes as long as all else about a small scene; a copy makes one.

    Parameters
    ----------
    filled : the tuples

    spans : where in a copy each tuple stands, padding included
    places : where in a copy each vector stands, by its name in the first tuple that has it
    """

    def __init__(self, *filled: Any) -> None:
        self.spans: list[slice] = []
        self.places: dict[str, slice] = {}
        self._parts: list[tuple[Callable[[Iterable[Any]], Any], list[tuple[bool, Any]]]] = []
        vectors: list[tuple[slice, np.ndarray]] = []
        end = 0
        for each in filled:
            begin, values = end, []
            for name, value in zip(each._fields, each, strict=True):
                if isinstance(value, np.ndarray) and value.ndim == 1:
                    span = slice(end, end + value.size)
                    vectors.append((span, value))
                    self.places.setdefault(name, span)
                    end += -(-value.size // LANES) * LANES
                    values.append((value.dtype == np.int64, span))
                else:
                    values.append((False, value))
            self._parts.append((type(each)._make, values))
            self.spans.append(slice(begin, end))
        self._memory = aligned(end)
        for span, vector in vectors:
            self._memory[span] = vector.view(np.float64)

    def copy(self) -> np.ndarray:
        """The memory of all tuples, for a run to fill, shape (k,)."""
        memory = aligned(self._memory.size)
        memory[:] = self._memory
        return memory

    def tuples(self, memory: np.ndarray, first: int | None = None) -> list[Any]:
        """The tuples in such a memory, or with rows of arrays in those of several runs, shape (runs, k); the `first`
        ones or all."""
        whole = memory.view(np.int64)
        return [
            make([v if type(v) is not slice else (whole if is_whole else memory)[..., v] for is_whole, v in values])
            for make, values in self._parts[:first]
        ]
