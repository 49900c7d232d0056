"""Pieces of kernels: compiled into the kernel they stand in, and nowhere else."""

from __future__ import annotations

import itertools
import math
import os
import re
import subprocess
import sys

import numpy as np
import pytest
from numba import njit, types
from numba.core.errors import TypingError

from pounding_cli.kernels import central_difference, exponential, generalized_alpha, runge_kutta, taylor
from pounding_cli.kernels.layout import CALLED, OPTIONS, PART
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


@njit(**PART)
def extremes(a, b, c):
    return max(a, b), min(a, b), max(a, b, c), min(a, b, c)


@njit(**PART)
def place_of(values, k):
    return int(values[k])


@njit(**OPTIONS | {"cache": False})
def judge(values, places):
    v, p = pointer(values), pointer(places)
    found = place_of(v, 0) + place_of(v, 1) + place_of(v, p[0])
    return extremes(v[0], v[1], v[2]), extremes(p[0], p[1], p[2]), found


@pytest.mark.parametrize("values", list(itertools.permutations([1.5, -2.5, np.nan])))
def test_extremes_are_those_of_python(values):
    """Fails if what is not a number is passed over otherwise, if integers are compared as doubles, or if a number is
    rounded to its place."""
    whole = [2**62 + 1, 2**62, -(2**62)]
    if math.isnan(values[0] + values[1]):
        doubles, integers, _ = judge(np.array(values), np.array(whole))
    else:
        doubles, integers, place = judge(np.array(values), np.array([1, *whole[:2]]))
        whole = [1, *whole[:2]]
        assert place == int(values[0]) + 2 * int(values[1])
    np.testing.assert_array_equal(doubles, extremes.py_func(*values))
    assert list(integers) == list(extremes.py_func(*whole))


@by_our_pipeline
def test_a_piece_is_compiled_once_for_all_numbers():
    """Fails if each number that is written out in a call has a piece of its own to compile."""
    judge(np.ones(3), np.ones(3, np.int64))
    assert len(place_of.signatures) == 1


@by_our_pipeline
def test_what_unpacks_the_arguments_is_not_optimised():
    """It runs once a scene, and its code is as long as the kernel's. Fails if LLVM takes a second over it."""
    judge(np.ones(3), np.ones(3, np.int64))
    (text,) = judge.inspect_llvm().values()
    (line,) = (line for line in text.splitlines() if line.startswith("define") and "_ZN7cpython" in line)
    assert re.search(rf"^attributes {line.split()[-2]} = .*optnone", text, re.MULTILINE)


@by_our_pipeline
def test_numba_is_left_as_it_was():
    """Fails if an answer is remembered beyond the kernel, or where a kernel could not be compiled; or if the thread
    that works beside the compiler is given work when it has ended, which a forked worker would wait for for ever."""
    from llvmlite import binding
    from numba.core.caching import Cache
    from numba.core.cpu import CPUContext

    from pounding_cli.kernels import pieces

    def found():
        numbas = CPUContext.refresh, types.Function.get_call_type, types.Dispatcher.get_call_type, Cache.load_overload
        return numbas, binding.get_process_triple

    before = found()

    @njit(**OPTIONS | {"cache": False})
    def wrong(values):
        return extremes(values, 1.0, "two")

    with pytest.raises(TypingError):
        wrong(1.0)
    judge(np.ones(3), np.ones(3, np.int64))
    assert found() == before
    assert "refresh" not in vars(CPUContext)
    assert not pieces._BESIDE


@by_our_pipeline
def test_a_kept_kernel_is_loaded_without_what_compiles(tmp_path):
    """Fails if a run that finds its kernels on disk imports scipy.linalg and the rest of what numba compiles: half of
    the time of a small study."""
    source = (
        "from numba import njit\nfrom pounding_cli.kernels.layout import OPTIONS\n\n\n"
        "@njit(**OPTIONS)\ndef twice(x):\n    return 2 * x[0]\n"
    )
    (tmp_path / "kept_by_a_test.py").write_text(source)
    code = (
        "import sys, numpy as np, kept_by_a_test as m; from pounding_cli.kernels import kept; "
        "print(kept.loaded(lambda: m.twice(np.full(1, 21.0))), sum(m.twice.stats.cache_hits.values()), "
        "'scipy.linalg' in sys.modules)"
    )
    path = os.pathsep.join([str(tmp_path), *sys.path])
    variables = os.environ | {"PYTHONPATH": path, "NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    for told in ("42.0 0 True", "42.0 1 False"):
        done = subprocess.run([sys.executable, "-c", code], env=variables, capture_output=True, text=True, check=True)
        assert done.stdout.strip() == told


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
