"""Compiled kernels that are kept on disk and cannot be read."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

SOLVED = "from tests.warm import compiled; print(compiled('taylor'))"


@pytest.mark.parametrize("suffix", [".nbc", ".nbi"])
def test_damaged_kernels_are_compiled_anew(suffix, tmp_path):
    """Cut short, or other bytes. Fails if a run ends with an error of pickle, or takes its time without a word."""
    if "POUND_NIGHTLY" not in os.environ:
        pytest.skip("the solver is compiled twice for it: make reference runs it every night")
    words = [sys.executable, "-c", SOLVED]
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    root = Path(__file__).parents[2]
    assert subprocess.run(words, env=environment, cwd=root, capture_output=True, text=True).stdout == "done\n"
    kept = list(tmp_path.rglob(f"*{suffix}"))
    assert kept
    for file in kept:
        file.write_bytes(file.read_bytes()[:2000] if suffix == ".nbc" else b"damaged")
    again = subprocess.run(words, env=environment, cwd=root, capture_output=True, text=True)
    assert again.stdout == "done\n", again.stderr
    assert "are damaged: compiling the solver again" in again.stderr
