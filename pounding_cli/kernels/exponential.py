"""The march of an exact linear propagator, one matrix-vector product a step, and peaks between its steps."""

from __future__ import annotations

import functools

import numpy as np
from numba import njit

from pounding_cli.kernels.layout import OPTIONS
from pounding_cli.kernels.polynomial import highest
from pounding_cli.kernels.simd import further, pointer
from pounding_cli.kernels.source import source_digest

MARGIN = 0.25
"""How far, in the largest second difference on the grid, a peak can lie above the grid's values: an eighth for a
parabola, twice that to be safe."""


@functools.cache
def build():
    """(march, refine), compiled on first use."""
    source = source_digest()

    @njit(**OPTIONS)
    def march(columns, z):
        """z[k + 1, :n] = P z[k], with the last two entries of every row (the ground and its slope) given.

        columns : P transposed, its first n columns, shape (n + 2, n)
        z : shape (steps + 1, n + 2), the first row complete
        """
        _ = source  # a captured value joins numba's cache key: a change in any kernel file compiles anew
        total = columns.shape[0]
        n = columns.shape[1]
        matrix = pointer(columns)
        rows = pointer(z)
        for k in range(z.shape[0] - 1):
            here = further(rows, k * total)
            there = further(rows, (k + 1) * total)
            for i in range(n):
                there[i] = 0.0
            for j in range(total):
                x = here[j]
                column = further(matrix, j * n)
                for i in range(n):
                    there[i] += column[i] * x

    @njit(**OPTIONS)
    def refine(values, z, places, powers):
        """Largest and smallest value over time of every column of `values`, also between its rows.

        values : shape (steps parts + 1, M), the tracked quantities at every place of the grid
        z, places, powers : as in `solve.exponential.Propagator`
        """
        _ = source
        rows, tracked = values.shape
        high = values[0].copy()
        low = values[0].copy()
        bends = np.zeros(tracked)
        for r in range(1, rows):
            for m in range(tracked):
                high[m] = max(high[m], values[r, m])
                low[m] = min(low[m], values[r, m])
                if r < rows - 1:
                    bend = abs(values[r + 1, m] - 2.0 * values[r, m] + values[r - 1, m])
                    bends[m] = max(bends[m], bend)
        parts = places.shape[0]
        orders = powers.shape[1]
        total = z.shape[1]
        c = powers[0, :, 0].copy()
        here = z[0].copy()
        for m in range(tracked):
            for side in (1.0, -1.0):
                best = high[m] if side > 0.0 else -low[m]
                for r in range(rows):
                    top = side * values[r, m]
                    if top < best - MARGIN * bends[m]:
                        continue
                    if (r > 0 and side * values[r - 1, m] > top) or (r < rows - 1 and side * values[r + 1, m] > top):
                        continue
                    for start in (r - 1, r):  # the two intervals beside a place that is higher than its neighbours
                        if start < 0 or start >= rows - 1:
                            continue
                        step = start // parts
                        place = places[start - step * parts]
                        for i in range(total):
                            here[i] = 0.0
                            for j in range(total):
                                here[i] += place[i, j] * z[step, j]
                        for k in range(orders):
                            c[k] = 0.0
                            for j in range(total):
                                c[k] += side * powers[m, k, j] * here[j]
                        best = highest(c, orders - 1, 1.0, best, False)
                if side > 0.0:
                    high[m] = best
                else:
                    low[m] = -best
        return high, low

    return march, refine
