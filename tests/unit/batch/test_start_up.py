"""What `pound run` keeps numba from doing when it starts."""

from __future__ import annotations

import subprocess
import sys

import pytest

PROGRAM = """
import sys
from pounding_cli.cli.run import _numba_without_blas
if {before}:
    import numba.np.arraymath
_numba_without_blas()
print(numba.np.arraymath._HAVE_BLAS if {before} else sys.modules["numba.np.arraymath"]._HAVE_BLAS)
print("scipy.linalg" in sys.modules)
import scipy.linalg.cython_blas, scipy.linalg.blas
print(scipy.linalg.blas.ddot([1.0, 2.0], [3.0, 4.0]))
"""


@pytest.mark.parametrize(("before", "words"), [(False, "False False 11.0"), (True, "True True 11.0")])
def test_numba_does_without_scipys_linear_algebra(before, words):
    """SciPy is not imported for it, and whole afterwards; who has numba already keeps what it found. Fails if SciPy's
    module stays hidden, or is hidden from a numba that is there."""
    program = PROGRAM.format(before=before)
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60, check=True)
    assert done.stdout.split() == words.split()
