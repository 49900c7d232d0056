"""Polynomials through a step's two ends, for what happens between them: peaks and events of one-step methods."""

from __future__ import annotations

from numba import njit

from pounding_cli.kernels.layout import INLINE


@njit(**INLINE)
def quintic(c, h, u0, v0, a0, u1, v1, a1):
    """c[0..5] of the polynomial in s on [0, 1] that has u, u' and u'' of both ends of a step h [s]; error O(h^6)."""
    c[0] = u0
    c[1] = h * v0
    c[2] = 0.5 * h * h * a0
    gap = u1 - u0 - c[1] - c[2]
    slope = h * v1 - c[1] - 2.0 * c[2]
    bend = h * h * a1 - 2.0 * c[2]
    c[3] = 10.0 * gap - 4.0 * slope + 0.5 * bend
    c[4] = -15.0 * gap + 7.0 * slope - bend
    c[5] = 6.0 * gap - 3.0 * slope + 0.5 * bend


@njit(**INLINE)
def cubic(c, h, f0, g0, f1, g1):
    """c[0..3] of the polynomial in s on [0, 1] that has f and f' of both ends; error O(h^4)."""
    c[0] = f0
    c[1] = h * g0
    c[2] = 3.0 * (f1 - f0) - h * (2.0 * g0 + g1)
    c[3] = -2.0 * (f1 - f0) + h * (g0 + g1)
