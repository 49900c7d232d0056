"""Kernels that Python runs itself, so that a debugger can stop in them: NUMBA_DISABLE_JIT=1."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np

from tests.adapter import solve
from tests.hard.test_stopping import METHODS
from tests.physics.cases import PERIODS, Row, shake

SOLVE = "from tests.hard.test_interpreted import solve_brief; solve_brief()"


def solve_brief() -> list[list[float]]:
    """Print and return drifts and impacts of a pair that strikes at once, under two samples, by every method."""
    pair = Row("pounding").row(PERIODS, 1, shake(0.04, peak=9.0), 0.0, "inelastic")
    runs = [solve(pair, **settings) for settings in METHODS.values()]
    numbers = [[*np.ravel(run.drift).tolist(), *np.ravel(run.impacts).tolist()] for run in runs]
    print(json.dumps(numbers))
    return numbers


def test_python_runs_the_kernels():
    run = subprocess.run(
        [sys.executable, "-c", SOLVE], env={**os.environ, "NUMBA_DISABLE_JIT": "1"},
        cwd=Path(__file__).parents[2], capture_output=True, text=True,
    )  # fmt: skip
    assert (run.returncode, run.stderr) == (0, "")
    compiled = solve_brief()
    assert min(numbers[-1] for numbers in compiled) > 0
    np.testing.assert_allclose(json.loads(run.stdout), compiled, rtol=1e-9)
