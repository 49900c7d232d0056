"""A small symmetric positive definite system in place: of ten to forty unknowns a call to LAPACK costs more than the
work."""

from __future__ import annotations

import math

from numba import njit

from pounding_cli.kernels.layout import INLINE


@njit(**INLINE)
def factorise(a, n):
    """Replace the lower triangle of the n x n matrix (row by row) by its Cholesky factor; False if it has none."""
    for j in range(n):
        for i in range(j, n):
            total = a[i * n + j]
            for k in range(j):
                total -= a[i * n + k] * a[j * n + k]
            if i == j:
                if not total > 0.0:
                    return False
                a[j * n + j] = math.sqrt(total)
            else:
                a[i * n + j] = total / a[j * n + j]
    return True


@njit(**INLINE)
def solve(a, n, x):
    """Replace x by the solution of L L^T y = x, with L from `factorise`."""
    for i in range(n):
        total = x[i]
        for k in range(i):
            total -= a[i * n + k] * x[k]
        x[i] = total / a[i * n + i]
    for i in range(n - 1, -1, -1):
        total = x[i]
        for k in range(i + 1, n):
            total -= a[k * n + i] * x[k]
        x[i] = total / a[i * n + i]
