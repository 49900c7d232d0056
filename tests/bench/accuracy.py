"""The results and figures of docs/accuracy.md: what an error costs by every method on the scenes of Figs 6 and 7."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from pathlib import Path

from tests.bench.pages import FIGURES, POUND, ROOT

CASES = "touching,gap,infill,connected"


def measure_accuracy() -> str:
    """Return what an error costs on the scenes of Fig. 6, and draw the diagrams of Figs 6 and 7 anew."""
    text = measure_figure("fig6", "600s")  # in which all methods reach 0.1 %
    measure_figure("fig7", "75s")
    return text


def measure_figure(name: str, budget: str) -> str:
    """Return the command that measures a figure's scenes with its answer, and replace its diagrams in docs/figures."""
    command = ["accuracy", f"configs/{name}.yaml", "--cases", CASES, "--records", "elcentro", "--budget", budget]
    with tempfile.TemporaryDirectory() as folder:
        printed = subprocess.run(
            [*POUND, *command, "--quiet", "-o", folder], cwd=ROOT, check=True, capture_output=True, text=True
        ).stdout
        for diagram in Path(folder).rglob("accuracy-*.png"):
            analysis = diagram.stem.removeprefix("accuracy-")
            shutil.copy(diagram, FIGURES / f"accuracy-{name}-{analysis}.png")
    sentences = [f"- {sentence}" for sentence in printed.splitlines()]
    return "\n".join([f"`pound {' '.join(command)}` says:", "", *sentences])
