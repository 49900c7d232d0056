"""Tuples of arrays for many runs to fill, each a copy of one that stands for all, in one piece of memory."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from operator import itemgetter
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

    To make forty arrays takes as long as all else about a small scene; a copy makes one. Vectors of one type and size
    are rows of one table, which numpy makes together.

    Parameters
    ----------
    filled : the tuples; sizes of their vectors are multiples of LANES

    spans : by tuple, where in a copy its doubles stand
    """

    def __init__(self, *filled: Any) -> None:
        tables: dict[tuple[bool, int], list[tuple[int, int, np.ndarray]]] = {}
        self._shared: list[Any] = []
        places: dict[tuple[int, int], int] = {}
        for t, values in enumerate(filled):
            for field, value in enumerate(values):
                if isinstance(value, np.ndarray) and value.ndim == 1:
                    tables.setdefault((value.dtype == np.int64, value.size), []).append((t, field, value))
                else:
                    places[t, field] = len(self._shared)
                    self._shared.append(value)
        self.spans: list[list[slice]] = [[] for _ in filled]
        self._tables: list[tuple[bool, slice, tuple[int, int]]] = []
        memory: list[np.ndarray] = []
        place, end = len(self._shared), 0
        for (whole, size), rows in tables.items():
            begin = end
            for t, field, vector in rows:
                places[t, field] = place
                spans = self.spans[t]
                if not whole and spans and spans[-1].stop == end:
                    spans[-1] = slice(spans[-1].start, end + size)
                elif not whole:
                    spans.append(slice(end, end + size))
                memory.append(vector.view(np.float64))
                place, end = place + 1, end + size
            self._tables.append((whole, slice(begin, end), (len(rows), size)))
        self._memory = aligned(end)
        self._memory[:] = np.concatenate(memory)
        self._parts: list[tuple[Callable[[Iterable[Any]], Any], itemgetter]] = [
            (type(values)._make, itemgetter(*(places[t, field] for field in range(len(values)))))
            for t, values in enumerate(filled)
        ]

    def copy(self) -> np.ndarray:
        """The memory of all tuples, for a run to fill, shape (k,)."""
        memory = aligned(self._memory.size)
        memory[:] = self._memory
        return memory

    def tuples(self, memory: np.ndarray) -> list[Any]:
        """The tuples in such a memory, or with rows of arrays in those of several runs, shape (runs, k)."""
        values, whole = list(self._shared), memory.view(np.int64)
        for is_whole, span, shape in self._tables:
            table = (whole if is_whole else memory)[..., span].reshape(*memory.shape[:-1], *shape)
            values.extend(table if memory.ndim == 1 else table.swapaxes(0, 1))
        return [make(chosen(values)) for make, chosen in self._parts]
