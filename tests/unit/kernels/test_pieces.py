"""Pieces of kernels: compiled into the kernel they stand in, and nowhere else."""

from __future__ import annotations

import numpy as np
import pytest
from numba import njit

from pounding_cli.kernels import central_difference, exponential, generalized_alpha, runge_kutta, taylor
from pounding_cli.kernels.layout import CALLED, PART
from pounding_cli.kernels.pipelines import QUICK
from pounding_cli.kernels.simd import no_inline, pointer

by_our_pipeline = pytest.mark.skipif(not QUICK, reason="numba's own pipeline compiles every piece by itself")


@njit(**CALLED)
def weight(k):
    no_inline()
    return 1.0 / (k + 1.0)


@njit(**PART)
def weighted(values, n):
    total = 0.0
    for k in range(n):
        total += weight(k) * values[k]
    return total


@njit(**PART)
def shifted(values, n):
    return weighted(values, n) + weight(n)


@njit
def kernel(values):
    return shifted(pointer(values), values.size) + weighted(values, values.size)


def test_a_kernel_is_made_of_its_pieces():
    """Pieces in pieces, on pointers and on arrays, against the sums by hand; the piece that stands alone is there once
    though three pieces call it, the inlined ones are gone. Fails if a piece's callees are not linked with it."""
    values = np.array([3.0, -4.0, 12.0])
    once = 3.0 - 4.0 / 2 + 12.0 / 3
    assert kernel(values) == pytest.approx(2 * once + 1 / 4, rel=1e-15)
    (text,) = kernel.inspect_llvm().values()
    defined = [line for line in text.splitlines() if line.startswith("define")]
    assert sum("weight" in line and "weighted" not in line for line in defined) == 1
    assert not any("weighted" in line or "shifted" in line for line in defined)


@by_our_pipeline
def test_a_piece_is_not_compiled_by_itself():
    """Fails if numba makes machine code of it: that is most of what a first run would wait for."""
    kernel(np.ones(2))
    for piece in (weighted, shifted):
        for compiled in piece.overloads.values():
            assert not compiled.library.codegen._engine.is_symbol_defined(compiled.fndesc.llvm_func_name)


@by_our_pipeline
@pytest.mark.parametrize("number", [1, 2.0])
def test_a_piece_called_from_python_is_refused(number):
    """Whether a kernel has it already (integers) or not. Fails, by a crash, if there is no entry at all."""
    kernel(np.ones(2))
    for _ in range(2):
        with pytest.raises(TypeError):
            weight(number)


@pytest.mark.parametrize(
    "built",
    [
        taylor.build(False),
        exponential.build(),
        runge_kutta.build(True, True),
        central_difference.build(True),
        generalized_alpha.build(True),
    ],
    ids=["taylor", "exponential", "rk4", "central-difference", "generalized-alpha"],
)
def test_a_kernel_is_found_again_by_another_process(built):
    """What it captures is part of its name in numba's cache, so it must be the same in every process. Fails if a piece
    is captured: each process has one of its own, and compiles anew."""
    captured = [cell.cell_contents for cell in built.py_func.__closure__]
    assert captured
    assert all(isinstance(value, bool | str) for value in captured)
