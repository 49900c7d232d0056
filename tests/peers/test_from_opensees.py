"""docs/from-opensees.md: its script (docs/examples/opensees_pair.py) runs, and its table says what comes out."""

from __future__ import annotations

import re
import runpy
import shutil
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("openseespy.opensees", reason="openseespy is not installed (pip install -e .[peers])")

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "from-opensees.md").read_text(encoding="utf-8")
SHOWN = (0, 4, 5, 9)
"""Storeys in the table: 1 and 5 of each building."""


@pytest.fixture(scope="module")
def scripts(tmp_path_factory):
    """What the script and the page's study define, run in a folder that holds the motions."""
    folder = tmp_path_factory.mktemp("opensees")
    shutil.copytree(ROOT / "records", folder / "records")
    names: dict = runpy.run_path(str(ROOT / "docs" / "examples" / "opensees_pair.py"))
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        patch.delenv("POUND_RECORDS", raising=False)
        (block,) = re.findall(r"```python\n(from pounding_cli.*?)```", PAGE, flags=re.DOTALL)
        exec(compile(block, "docs/from-opensees.md", "exec"), names)
        yield names


def table() -> list[tuple[str, str, list[str]]]:
    """(analysis, solver, cells) of every row of the table of numbers."""
    rows, analysis = [], ""
    for line in PAGE.split("## Results of both programs", 1)[1].splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if re.fullmatch(r"\*\*\w+\*\*", cells[0]):
            analysis = cells[0].strip("*")
        elif re.match(r"OpenSees,|pound,", cells[0]):
            rows.append((analysis, cells[0], cells[1:]))
    return rows


def expected(scripts, analysis: str) -> np.ndarray:
    """Peak storey shears [kN] that pound found."""
    peaks = scripts["peaks"].sort_index()
    return np.concatenate([peaks[analysis, building].to_numpy() for building in ("stiff", "soft")])


@pytest.mark.parametrize(
    ("analysis", "solver", "cells"), table(), ids=lambda part: part if isinstance(part, str) else ""
)
def test_numbers(scripts, analysis, solver, cells):
    """Shears to the digits shown, errors to a factor of 1.5. Fails if the script's dashpot lacks its 2."""
    if solver.startswith("pound"):
        found = expected(scripts, analysis)
        assert scripts["results"].scene()["error_estimate"].max() < 1e-6
    else:
        step = float(re.search(r"[\d.]+", solver)[0]) * 1e-3
        if step < 4e-5:
            pytest.skip("ten seconds and more: by hand")
        if cells[0].startswith("failed at"):
            with pytest.raises(RuntimeError, match="failed at") as failure:
                scripts["march"](step, analysis == "inelastic")
            said, shown = (re.search(r"at ([\d.]+) s", text)[1] for text in (str(failure.value), cells[0]))
            assert float(said) == pytest.approx(float(shown), abs=0.051)
            return
        shears, _ = scripts["march"](step, analysis == "inelastic")
        found = shears / 1e3
        off = np.abs(found / expected(scripts, analysis) - 1).max()
        assert float(cells[4]) / 1.5 < off < 1.5 * float(cells[4])
    assert [f"{found[place]:.1f}" for place in SHOWN] == cells[:4]


def test_stiffnesses_and_yield_shears_are_those_of_the_study(scripts):
    frame = scripts["results"].buildings
    for period, name in ((0.36, "stiff"), (0.60, "soft")):
        rows = frame[frame["building"] == name]
        k, *_ = scripts["stiffness"](period)
        assert rows["stiffness"].to_numpy() == pytest.approx(k, rel=1e-9)
        assert rows["yield_shear"].to_numpy() == pytest.approx(scripts["yield_shears"](period), rel=1e-9)
