"""docs/extending.md: its question, put into a copy of the package as the page says."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys

import pytest
from pages import ROOT, blocks

PAGE = ROOT / "docs" / "extending.md"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A copy of the package with the question of the page, and its study."""
    copy = tmp_path_factory.mktemp("question")
    shutil.copytree(ROOT / "pounding_cli", copy / "pounding_cli", ignore=shutil.ignore_patterns("__pycache__"))
    (copy / "records").symlink_to(ROOT / "records")
    questions = copy / "pounding_cli" / "questions"
    shutil.copy(ROOT / "docs" / "examples" / "questions" / "drift.py", questions)
    line = next(block.text for block in blocks(PAGE) if block.text.startswith('    "drift": '))
    registry = questions / "__init__.py"
    before, start, after = registry.read_text().partition("TITLES = {\n")
    assert start
    registry.write_text(before + start + line + after)
    study = next(block.text for block in blocks(PAGE) if "drift: {limit: 0.5 %}" in block.text)
    (copy / "study.yaml").write_text(study)
    return copy


def _pound(folder, *arguments):
    environment = os.environ | {"PYTHONPATH": str(folder)}
    program = "from pounding_cli.cli.main import main; main()"
    command = [sys.executable, "-c", program, *arguments]
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)


def test_a_file_and_a_line_make_a_question(folder):
    """Fails where command, results file, table, report or the exit code need anything else."""
    assert "drift" in _pound(folder, "--help").stdout
    assert "pound drift" in _pound(folder, "check", "study.yaml").stdout
    done = _pound(folder, "drift", "study.yaml")
    assert done.returncode == 0, done.stderr
    assert "The largest interstorey drift is" in done.stdout
    rows = _pound(folder, "show", "results/study-drift.h5", "--format", "csv").stdout.splitlines()
    assert rows[0] == "case,analysis,building,storey,drift,limit,exceeded"
    assert {row.split(",")[-1] for row in rows[1:]} <= {"True", "False"}
    largest = max(float(row.split(",")[4]) for row in rows[1:])
    assert f"{100 * largest:.3g}" in done.stdout.split("drift is")[1].split("%")[0]
    assert ("more than" in done.stdout) == (largest > 0.005)
    page = _pound(folder, "report", "results/study-drift.h5", "--no-figures", "-q")
    assert page.returncode == 0, page.stderr
    assert "The largest interstorey drift is" in (folder / "results" / "study-drift" / "report.html").read_text()


def test_its_section_is_checked_and_in_the_schema(folder):
    """Fails where the keys of a section are read without the model that the question declares."""
    study = (folder / "study.yaml").read_text().replace("limit: 0.5 %", "limit: 0.5 m")
    (folder / "wrong.yaml").write_text(study)
    refused = _pound(folder, "run", "wrong.yaml")
    assert refused.returncode == 2
    assert "wrong.yaml:5:" in refused.stderr
    schema = json.loads(_pound(folder, "schema").stdout)
    assert "drift" in schema["properties"]
