"""Samples of the unit cube for `pound sensitivity`, as SALib draws them."""

from __future__ import annotations

import functools
import io
import subprocess
import sys
from typing import Any

import numpy as np

MANY = 20_000
"""From so many points on they are drawn in a process of their own: SALib brings pandas and SciPy's statistics, some
75 MB that the run would hold to its end. Starting it takes as long as importing SALib here, and the analysis after the
run imports it once more: a second that few points are not worth."""

_PROGRAM = """\
import io, sys, numpy
from SALib.sample import {method}
found = io.BytesIO()  # numpy does not write to a buffered pipe
numpy.save(found, {method}.sample(**{settings!r}))
sys.stdout.buffer.write(found.getbuffer())
"""


@functools.lru_cache(maxsize=2)
def grid(method: str, factors: int, samples: int, levels: int, seed: int) -> np.ndarray:
    """The samples, shape (points, factors).

    Parameters
    ----------
    method : sobol (with the points for first-order and total indices) or morris
    factors : dimensions of the cube
    samples : base samples of Sobol, trajectories of Morris
    levels : of Morris
    seed : of the random numbers
    """
    problem = {
        "num_vars": factors,
        "names": [f"x{number}" for number in range(factors)],
        "bounds": [[0.0, 1.0]] * factors,
    }
    settings: dict[str, Any] = {"problem": problem, "N": samples, "seed": seed}
    settings |= {"num_levels": levels} if method == "morris" else {"calc_second_order": False}
    found = _elsewhere(method, settings) if samples * (factors + 2) >= MANY else None
    if found is None:
        from SALib.sample import morris, sobol

        found = (morris if method == "morris" else sobol).sample(**settings)
    found.setflags(write=False)
    return found


def _elsewhere(method: str, settings: dict[str, Any]) -> np.ndarray | None:
    """Drawn by another Python; None where there is none, or where it has no SALib."""
    program = _PROGRAM.format(method=method, settings=settings)
    try:
        done = subprocess.run([sys.executable, "-P", "-c", program], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    except (OSError, TypeError):  # a program without an interpreter of its own
        return None
    return None if done.returncode else np.load(io.BytesIO(done.stdout), allow_pickle=False)
