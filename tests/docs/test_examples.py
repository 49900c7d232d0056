"""The examples of the documentation run, and find what they say."""

from __future__ import annotations

import json
import math
import os
import runpy
from pathlib import Path

import pytest

from tests.night import NIGHTLY

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


NOTEBOOKS = ("first_study.ipynb", "one_impact.ipynb")


@pytest.fixture
def notebook(tmp_path, monkeypatch):
    """Runs a notebook in a kernel of its own, as a reader would; returns values and what its cells show."""
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    monkeypatch.delenv("POUND_RECORDS", raising=False)
    monkeypatch.delenv("MPLBACKEND", raising=False)
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(FOLDER.parents[1]), os.environ.get("PYTHONPATH", "")]))

    def run(name: str, *expressions: str) -> tuple[list, list]:
        book = nbformat.read(FOLDER / name, as_version=4)
        asked = f"import json\nprint(json.dumps([{', '.join(expressions)}], default=float))"
        book.cells.append(nbformat.v4.new_code_cell(asked))
        client = nbclient.NotebookClient(book, timeout=240, resources={"metadata": {"path": str(tmp_path)}})
        client.execute()
        *shown, last = [cell.outputs for cell in book.cells if cell.cell_type == "code"]
        return json.loads("".join(output.text for output in last)), shown

    return run


def figures(outputs) -> int:
    return sum("image/png" in output.get("data", {}) for output in outputs)


def test_every_example_is_tested_and_told():
    names = {path.name for path in (*FOLDER.glob("*.py"), *FOLDER.glob("*.ipynb"))}
    assert names == {"gap_sweep.py", "opensees_pair.py", *NOTEBOOKS}  # the second: tests/peers/test_from_opensees.py
    page = (FOLDER / "index.md").read_text(encoding="utf-8")
    assert all(f"]({name})" in page for name in names)


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_notebooks_are_kept_plain(name):
    """Without outputs and counts, so that a change of text is all that a change shows; below 10 kB."""
    text = (FOLDER / name).read_text(encoding="utf-8")
    assert len(text) < 10_000
    for cell in json.loads(text)["cells"]:
        assert set(cell["metadata"]) == set()
        assert cell.get("outputs", []) == []
        assert cell.get("execution_count") is None


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


@NIGHTLY
def test_first_study(notebook):
    """Tables and figures are shown; a gap that is too narrow makes it worse than none."""
    (shears, blows, errors, worst), shown = notebook(
        "first_study.ipynb",
        "shears.loc[5].to_dict()",
        "float(blows['impacts'].min())",
        "accuracy['error_estimate'].max()",
        "worst.values.tolist()",
    )
    assert "text/html" in shown[0][-1].data
    assert "Results(&#x27;A first study&#x27;" in shown[0][-1].data["text/html"]
    assert [figures(outputs) for outputs in shown] == [0, 1, 0, 0, 0, 1, 0]
    assert shears["touching"] > 1.2
    assert blows >= 0
    assert errors < 1e-5
    assert max(worst) > worst[0] + 0.05


@NIGHTLY
def test_one_impact(notebook):
    """Duration, rebound and largest force against the closed form of a Kelvin-Voigt contact (eqs 6, 7)."""
    (spring, lasted, met, parted, largest, lost, peak, pulls), shown = notebook(
        "one_impact.ipynb",
        "20 * max(stiff.stiffness)",
        "lasted",
        "met",
        "parted",
        "force.max()",
        "lost",
        "pound.solve(scene).links.peak_force.max()",
        "[force.min(), softened.min()]",
    )
    mass, xi = 1e5, math.log(2) / math.hypot(math.pi, math.log(2))
    frequency = math.sqrt(spring / mass)
    duration = math.pi / (frequency * math.sqrt(1 - xi**2))
    assert lasted == pytest.approx(duration, abs=2e-4)  # seen every 0.1 ms
    assert -parted / met == pytest.approx(0.5, abs=0.02)
    assert largest == pytest.approx(0.816 * met * math.sqrt(spring * mass), rel=0.02)
    assert lost == pytest.approx(0.5 * mass * (met**2 - parted**2), rel=0.05)
    assert largest == pytest.approx(peak, rel=2e-3)
    assert pulls[0] < 0 == pulls[1]
    said = "".join(output.get("text", "") for outputs in shown for output in outputs)
    assert "meet at 1.08 m/s and part at 0.53 m/s" in said
    assert [figures(outputs) for outputs in shown] == [0, 1, 0, 0, 1, 1]
