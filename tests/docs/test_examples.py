"""The examples of the documentation run, and find what they say."""

from __future__ import annotations

import math
import runpy
from pathlib import Path

import numpy as np
import pytest

FOLDER = Path(__file__).parents[2] / "docs" / "examples"


@pytest.fixture
def example(tmp_path, monkeypatch):
    """Runs an example in a folder of its own; returns its names and what it printed."""

    def run(name: str, capture) -> tuple[dict, str]:
        monkeypatch.setenv("MPLBACKEND", "Agg")
        monkeypatch.delenv("POUND_RECORDS", raising=False)
        monkeypatch.chdir(tmp_path)
        names = runpy.run_path(str(FOLDER / name))
        assert (tmp_path / name).with_suffix(".png").stat().st_size > 10_000
        return names, capture.readouterr().out

    return run


def test_every_example_is_tested_and_told():
    names = {path.name for path in FOLDER.glob("*.py")}
    assert names == {"gap_sweep.py", "one_impact.py"}
    page = (FOLDER / "index.md").read_text(encoding="utf-8")
    assert all(f"]({name})" in page for name in names)


def test_gap_sweep(example, capsys):
    """Where nothing touches the ratio is one, and only there; the worst gap is not the smallest."""
    found, said = example("gap_sweep.py", capsys)
    ratios, impacts = found["ratios"], found["impacts"]
    for (analysis, _), line in ratios.items():
        free = impacts[analysis] == 0
        assert line[free].to_numpy() == pytest.approx(1.0, abs=1e-9)
        assert (line[~free] - 1).abs().max() > 0.01
    worst = ratios["elastic", "stiff"]
    assert worst.idxmax() == pytest.approx(0.06)
    assert worst.max() == pytest.approx(1.9, abs=0.01)
    assert found["separation"] == pytest.approx(0.069, abs=0.0005)  # the paper's "approximately 7 cm"
    assert "asks for 6.9 cm; from 4 cm on, inelastic, nothing touches" in said


def test_one_impact(example, capsys):
    """Duration, rebound and largest force against the closed form of a Kelvin-Voigt contact (eqs 6, 7)."""
    found, said = example("one_impact.py", capsys)
    spring = 20 * found["results"].buildings["stiffness"].max()
    mass, xi = 1e5, math.log(2) / math.hypot(math.pi, math.log(2))
    frequency = math.sqrt(spring / mass)
    duration = math.pi / (frequency * math.sqrt(1 - xi**2))
    assert found["lasted"] == pytest.approx(duration, abs=2e-4)  # seen every 0.1 ms
    assert -found["parted"] / found["met"] == pytest.approx(0.5, abs=0.02)
    assert np.max(found["force"]) == pytest.approx(0.816 * found["met"] * math.sqrt(spring * mass), rel=0.02)
    assert found["lost"] == pytest.approx(0.5 * mass * (found["met"] ** 2 - found["parted"] ** 2), rel=0.05)
    peak = found["results"].link()["peak_force"].max()
    assert np.max(found["history"].link_force) == pytest.approx(peak, rel=2e-3)
    assert "meet at 1.08 m/s and part at 0.53 m/s" in said
