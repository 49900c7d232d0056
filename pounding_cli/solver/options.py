"""Options of numba for the pieces of a run, and numbers that all pieces share."""

from __future__ import annotations

from typing import Any

import numba
import numpy as np
from numba import carray, njit, types

from pounding_cli.solver.kernels import FOLDER, IS_INTERPRETED

INVERSE = np.concatenate(([0.0], 1.0 / np.arange(1.0, 64.0)))
"""1 / k."""

FLOAT = np.arange(64.0)
"""k."""

COMMON: dict[str, Any] = {"fastmath": {"contract", "nsz", "arcp", "reassoc"}, "error_model": "numpy"}
"""Fused products and free order of sums; values that are not finite keep their meaning."""

CALLED = COMMON
"""Of a function that is called."""

PART = {**COMMON, "forceinline": True}
"""Of one that becomes part of its callers."""

KERNEL = {**COMMON, "cache": True, "nogil": True}
"""Of a kernel: kept on disk, and other threads go on while it runs."""


@njit(**PART, locals={"address": types.voidptr})
def borrow_records(records):
    """Return the same records without counting references to them; whoever calls the kernel holds them.

    Counting them at every call takes a tenth of a run by series and a third of one by DOP853.
    """
    if IS_INTERPRETED:
        return records
    held = records.ctypes  # its reference ends with this name; cast at once, it would never end
    address = held
    return carray(address, records.shape, records.dtype)


# numba makes its settings as it is imported. Sums that stand side by side become vectors: 7 % of a run less.
for _name, _value in (("CACHE_DIR", str(FOLDER)), ("SLP_VECTORIZE", 1)):
    setattr(numba.config, _name, _value)
