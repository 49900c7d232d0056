"""The law of the storeys (`pounding_cli.laws.bilinear`), compiled for kernels."""

from __future__ import annotations

from numba import njit

from pounding_cli.kernels.layout import INLINE, PART
from pounding_cli.laws import bilinear

coefficients, transition = (njit(**PART)(piece) for piece in (bilinear.coefficients, bilinear.transition))

# The same for one-step methods, whose arithmetic may be fused.
fused_coefficients, fused_transition, return_mapping, yields = (
    njit(**INLINE)(piece)
    for piece in (bilinear.coefficients, bilinear.transition, bilinear.return_mapping, bilinear.yields)
)
