"""Hard scenes as one processor's arithmetic solves them: `python -m tests.hard.processors FILE`; and whole folders of
tests as each of them: `python -m tests.hard.processors --tests FOLDER...`.

Fused multiply-add, the width of vectors and the kernels of OpenBLAS differ from one processor to the next, and with
them the last digits of every number. A process that is told another processor compiles for it, so its runs are made in
one of their own and kept in a file, which `test_processors` compares with runs of this processor.
"""

from __future__ import annotations

import os
import pickle
import platform
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import pounding_cli as pound
from tests.adapter import Run, scenes, solve

from .catalogue import SCENES

METHODS = Path(__file__).parent / "methods"
LARGE = ("chain-20", "hundred-storeys", "record-long", "record-fine")
"""Scenes that take longer than the others together."""

IS_X86 = platform.machine().lower() in ("x86_64", "amd64")
OTHER_BLAS = "PRESCOTT" if IS_X86 else "ARMV8"
"""A kernel of OpenBLAS that every processor of the kind has, and none of today chooses."""

PROCESSORS: dict[str, dict[str, str]] = {
    "generic": {"NUMBA_CPU_NAME": "generic"},
    "generic and another OpenBLAS kernel": {"NUMBA_CPU_NAME": "generic", "OPENBLAS_CORETYPE": OTHER_BLAS},
    "another OpenBLAS kernel": {"OPENBLAS_CORETYPE": OTHER_BLAS},
}
"""Names of processors, and the variables with which a process calculates like them."""

if IS_X86:
    VECTORS = "+sse3,+ssse3,+sse4.1,+sse4.2,+popcnt,+avx,+avx2,+bmi,+bmi2"
    PROCESSORS |= {
        "with fused multiply-add": {"NUMBA_CPU_NAME": "haswell", "NUMBA_CPU_FEATURES": f"{VECTORS},+fma"},
        "without fused multiply-add": {"NUMBA_CPU_NAME": "haswell", "NUMBA_CPU_FEATURES": f"{VECTORS},-fma"},
    }


def list_scenes() -> Iterator[tuple[str, pound.Scene, float]]:
    """Yield name, scene and accuracy of the linked hard scenes that are quickly solved."""
    for path in sorted([*SCENES.glob("*.yaml"), *METHODS.glob("*.yaml")]):
        if path.stem not in LARGE:
            yield from ((f"{path.stem}: {where}", scene, each) for where, scene, each in scenes(path) if scene.links)


def solve_here() -> dict[str, Run]:
    """Return the runs of this processor by name, each with the estimate of its error."""
    return {name: solve(scene, accuracy, estimate=True) for name, scene, accuracy in list_scenes()}


def solve_as(variables: Mapping[str, str], file: Path) -> dict[str, Run]:
    """Return the runs of a process with these variables."""
    command = [sys.executable, "-m", "tests.hard.processors", str(file)]
    subprocess.run(command, check=True, env=os.environ | variables)
    return pickle.loads(file.read_bytes())


def run_tests(folders: Sequence[str]) -> int:
    """Run the tests of folders as every processor; return how many of these runs failed."""
    failed = []
    for name, variables in PROCESSORS.items():
        print(f"\n{name}: {' '.join(f'{key}={value}' for key, value in variables.items())}", flush=True)
        command = [sys.executable, "-m", "pytest", "-q", "-n", "auto", "--dist", "loadgroup", *folders]
        if subprocess.run(command, env=os.environ | variables).returncode != 0:
            failed.append(name)
    print(f"\nfailed: {', '.join(failed) or 'none'}")
    return len(failed)


if __name__ == "__main__":
    if sys.argv[1] == "--tests":
        sys.exit(run_tests(sys.argv[2:]))
    Path(sys.argv[1]).write_bytes(pickle.dumps(solve_here()))
