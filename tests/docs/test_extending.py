"""docs/extending.md: its recipes run from outside the package, as they stand on the page."""

from __future__ import annotations

import os
import subprocess
import sys

import numpy as np
import pytest
from pages import ROOT, blocks

PAGE = ROOT / "docs" / "extending.md"

MEASURED = """
import heun
from pounding_cli.report.accuracy_figures import draw_accuracy
from pounding_cli.report.accuracy_page import lines_frame
from pounding_cli.solve.work_precision import Subject, measure

touching = pound.scene([stiff, soft], pound.motion("elcentro", duration=2), link="pounding", gap=0.0)
found = measure([Subject("touching", "elastic", "elcentro", touching)], ("heun",), 1.0)
print(lines_frame(found)[["method", "setting"]].iloc[0].tolist())
from pathlib import Path
draw_accuracy(found, Path("."), ("svg",))
print("Heun" in Path("accuracy-elastic.svg").read_text())
"""


@pytest.fixture
def outside(tmp_path):
    """Runs Python text in a folder that has the page's file and nothing else."""
    method, use = (block.text for block in blocks(PAGE) if block.word == "python" and not block.reason)
    (tmp_path / "heun.py").write_text(method)
    (tmp_path / "use.py").write_text(use)

    def run(*more: str) -> list[str]:
        (tmp_path / "all.py").write_text("\n".join((use, *more)))
        environment = os.environ | {"PYTHONPATH": os.pathsep.join((str(tmp_path), str(ROOT)))}
        command = [sys.executable, "all.py"]
        done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return done.stdout.splitlines()

    return run


def test_a_method_of_ones_own(outside):
    """Its order, and `pound accuracy` on a scene whose floors touch. Fails if the driver gives a step the ground
    of another time, or if figures know this program's methods only."""
    said = outside(MEASURED)
    steps, errors = np.array([line.split() for line in said[:3]], float).T
    assert np.polyfit(np.log(steps), np.log(errors), 1)[0] == pytest.approx(2.0, abs=0.2)
    assert said[3:] == ["['heun', '0.002 s']", "True"]
