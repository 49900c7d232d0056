"""The plain path: kernels by numba's published interface and its own compile pipeline, for versions not known."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from numba import njit, types

from pounding_cli import kernels
from pounding_cli.kernels import pipelines
from pounding_cli.kernels.frame import DOUBLES, INTEGERS, Frame, filler, mover
from pounding_cli.kernels.layout import CALLED, PART
from pounding_cli.kernels.simd import fused, load, no_inline, pointer, store

FOLDER = Path(kernels.__file__).parent
ROOM = Frame(
    "room", {"number": types.int64, "share": types.float64, "values": DOUBLES, "order": INTEGERS}, movable=("number",)
)
room, renumber = filler(ROOM), mover(ROOM)


@njit(**CALLED)
def _count(r):
    no_inline()
    renumber(r, (r.number + r.order[0],))


@njit(**PART)
def _mixed(r):
    _count(r)
    return fused(load(r.values, 0), r.share, load(r.values, 8) * r.number)


@njit
def _kernel(memory, values, order, share, out):
    r = room(pointer(memory), (3, share, pointer(values), pointer(order)))
    store(pointer(out), 0, _mixed(r))
    _count(r)
    return r.number


def evaluate() -> str:
    """What the kernel finds, to the last bit."""
    values = np.random.default_rng(5).normal(size=16)
    out, order = np.zeros(8), np.array([4])
    number = _kernel(np.zeros(4, np.int64), values, order, 0.3, out)
    return f"{number} {out.tobytes().hex()}"


def _elsewhere(code: str, **environment: str) -> str:
    command = [sys.executable, "-c", code]
    variables = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)} | environment
    done = subprocess.run(command, env=variables, capture_output=True, text=True, check=True)
    return done.stdout.strip()


def test_a_frame_is_read_and_moved():
    """Fails if a field is read from another's place, or a movable one is read once and kept."""
    values = np.random.default_rng(5).normal(size=16)
    number, bits = evaluate().split()
    assert int(number) == 3 + 4 + 4
    assert np.frombuffer(bytes.fromhex(bits)) == pytest.approx(0.3 * values[:8] + 7 * values[8:], rel=1e-15)


def test_the_plain_path_finds_the_same_bits():
    """Fails if the plain path needs the private pipelines, or if it rounds otherwise."""
    code = (
        f"import sys; sys.path.insert(0, {str(Path(__file__).parent)!r}); import test_plain as t; "
        "print(t.pipelines.QUICK, 'pounding_cli.kernels.pieces' in sys.modules); print(t.evaluate())"
    )
    assert _elsewhere(code, POUND_PLAIN_KERNELS="1").splitlines() == ["False False", evaluate()]


@pytest.mark.parametrize(
    ("version", "variable", "quick"),
    [("0.68.1", "", True), ("0.68.1", "0", True), ("0.68.1", "1", False), ("0.67.0", "", False), ("0.69.0", "", False)],
)
def test_private_pipelines_only_where_the_version_is_known(version, variable, quick):
    """Fails if a version that nobody tested is compiled by the compiler's inside."""
    code = f"import numba; numba.__version__ = {version!r}; from pounding_cli.kernels import pipelines as p; "
    assert _elsewhere(code + "print(p.QUICK, p.PIECE != {})", POUND_PLAIN_KERNELS=variable) == f"{quick} {quick}"


@pytest.mark.parametrize("path", sorted(FOLDER.rglob("*.py")), ids=lambda path: path.name)
def test_kernels_import_what_numba_publishes(path):
    """All but the pipelines, which have a plain path beside them. Fails on `numba.core` and the like."""
    if path.name in ("pieces.py", "passes.py"):
        pytest.skip("reaches inside, where the version is known")
    tree = ast.parse(path.read_text())
    modules = {node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom) and node.module}
    modules |= {name.name for node in ast.walk(tree) if isinstance(node, ast.Import) for name in node.names}
    inside = {name for name in modules if name.split(".")[0] in ("numba", "llvmlite")}
    assert inside <= {"numba", "numba.extending", "numba.core.event", "llvmlite"}  # events are in numba's manual
    assert pipelines.KNOWN
