"""docs/extending.md: its method of solution, put into a copy of the package as the page says."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys

import pytest
from pages import ROOT, blocks

PAGE = ROOT / "docs" / "extending.md"

KNOWN = """
from pathlib import Path
import pounding_cli.methods as methods
Path("study.yaml").write_text(Path("study.yaml").read_text() + "method: heun\\ntime_step: 1 ms\\n")
print(pound.load_study("study.yaml").to_plain_data()["method"])
print(methods.METHODS["heun"].order)
"""

STUDY = """
records: {use: [elcentro], duration: 1 s}
buildings: {stiff: {storeys: 1, period: 0.3 s}}
group: [stiff, stiff]
cases: {touching: {link: pounding, gap: 0 cm}}
"""


@pytest.fixture
def copied(tmp_path):
    """A copy of the package with the page's method, and the page's `use.py`."""
    if "POUND_NIGHTLY" not in os.environ:
        pytest.skip("a copy of the solver is compiled for it: make reference runs it every night")
    shutil.copytree(ROOT / "pounding_cli", tmp_path / "pounding_cli", ignore=shutil.ignore_patterns("__pycache__"))
    (tmp_path / "records").symlink_to(ROOT / "records")
    function, call, entry, use = (
        next(block.text for block in blocks(PAGE) if mark in block.text)
        for mark in ("def _step_by_heun(", "FIXED =", '"heun", "Heun", 2', "roofs = []")
    )
    listed, called = call.split("\n", 1)
    last, end = "            else:\n                has_root = _step_by_newmark", ")  # fmt: skip\n\nMETHODS"
    _replace(
        tmp_path / "pounding_cli" / "solver" / "fixed_step.py",
        ('FIXED = ("central-difference", "newmark")', listed),
        (last, called + last),
        ("@njit(**KERNEL)\ndef march", f"{function}\n\n@njit(**KERNEL)\ndef march"),
    )
    _replace(tmp_path / "pounding_cli" / "methods.py", (end, entry + end))
    (tmp_path / "study.yaml").write_text(STUDY)
    (tmp_path / "use.py").write_text(use + KNOWN)
    return tmp_path


def _replace(path, *pairs):
    text = path.read_text()
    for old, new in pairs:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    path.write_text(text)


def test_a_method_of_ones_own(copied):
    """Its order, and that studies know it. Fails if the driver gives a step the ground of
    another time, or if a list of methods stands anywhere else."""
    done = subprocess.run(
        [sys.executable, "use.py"],
        cwd=copied,
        env=os.environ | {"PYTHONPATH": str(copied), "NUMBA_CACHE_DIR": str(copied)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    ratio, method, order = done.stdout.split()
    assert float(ratio) == pytest.approx(4.0, abs=0.4)
    assert (method, order) == ("heun", "2")
