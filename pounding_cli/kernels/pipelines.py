"""Which compile pipelines the kernels go through: numba's own, or where its version is known to work with them the
quicker ones of `pieces`, which reach into the compiler's inside. Both give the same kernels; ours take a fifth of the
time."""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from typing import Any

import numba

KNOWN = ("0.68.",)
"""How the versions of numba begin with which `pieces` was tested."""

PLAIN_KERNELS = "POUND_PLAIN_KERNELS"
"""Environment variable: anything but empty or 0 compiles with numba's own pipeline, whatever its version."""

QUICK = numba.__version__.startswith(KNOWN) and os.environ.get(PLAIN_KERNELS, "") in ("", "0")
"""Whether kernels are compiled by the pipelines of `pieces`."""

KERNEL: dict[str, Any] = {}
"""Option of `numba.njit` for what is called from Python."""

PIECE: dict[str, Any] = {}
"""Option of `numba.njit` for what is called from kernels only."""

nothing_twice: Callable[[], AbstractContextManager[None]] = nullcontext
"""A context in which kernels are compiled or loaded."""


def in_two(name: str, pieces: dict[Any, Any]) -> dict[str, Any]:
    """Option of `numba.njit` for kernels some pieces of which are compiled in another process, where there can be one.

    name : of the machine code of these pieces, the same in every process and for nothing else
    pieces : those that are called, not copied, and their signatures
    """
    return {"pipeline_class": type("InTwo", (KernelCompiler,), {"share": Share(name, pieces)})} if QUICK else {}


if QUICK:
    from pounding_cli.kernels.passes import nothing_twice
    from pounding_cli.kernels.pieces import KernelCompiler, PieceCompiler, Share, teach_fields

    __all__ = ["KERNEL", "PIECE", "in_two", "nothing_twice", "teach_fields"]
    KERNEL, PIECE = {"pipeline_class": KernelCompiler}, {"pipeline_class": PieceCompiler}
