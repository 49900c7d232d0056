"""The law of the storeys (`pounding_cli.laws.bilinear`), compiled for kernels."""

from __future__ import annotations

from numba import njit

from pounding_cli.kernels.layout import INLINE, PART
from pounding_cli.laws import bilinear

coefficients, transit = (njit(**PART)(piece) for piece in (bilinear.coefficients, bilinear.transit))

# The same for one-step methods, whose arithmetic may be fused.
held_coefficients, held_transit, returned, yields = (
    njit(**INLINE)(piece) for piece in (bilinear.coefficients, bilinear.transit, bilinear.returned, bilinear.yields)
)
