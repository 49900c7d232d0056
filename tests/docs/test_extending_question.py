"""docs/extending.md: its question, put into the program as the page says."""

from __future__ import annotations

import json
import os
import pkgutil
import shutil
import subprocess
import sys

import pytest
from pages import ROOT, blocks

from pounding_cli.questions import load_questions
from pounding_cli.questions.question import LateFunction
from tests.night import NIGHTLY

PAGE = ROOT / "docs" / "extending.md"

PROGRAM = """
import importlib.util, sys
import pounding_cli.questions as questions

questions.TITLES.update({LINE})
spec = importlib.util.spec_from_file_location("pounding_cli.questions.drift", "drift.py")
sys.modules[spec.name] = importlib.util.module_from_spec(spec)
spec.loader.exec_module(sys.modules[spec.name])

from pounding_cli.questions import load_questions
from pounding_cli.questions.question import LateFunction
from pounding_cli.cli.main import main
main()
"""
"""The program with the line and the file of the page; a copy of the package would compile its solver."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The question and the study of the page, and the program with them."""
    folder = tmp_path_factory.mktemp("question")
    shutil.copy(ROOT / "docs" / "examples" / "questions" / "drift.py", folder)
    line = next(block.text for block in blocks(PAGE) if block.text.startswith('    "drift": '))
    (folder / "program.py").write_text(PROGRAM.replace("LINE", line))
    study = next(block.text for block in blocks(PAGE) if "drift: {limit: 0.5 %}" in block.text)
    (folder / "study.yaml").write_text(study)
    return folder


def _pound(folder, *arguments):
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    command = [sys.executable, "program.py", *arguments]
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)


@NIGHTLY
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


def test_every_late_function_of_a_question_is_there():
    late = [
        value for question in load_questions() for value in vars(question).values() if isinstance(value, LateFunction)
    ]
    assert len(late) > 25
    assert all(callable(pkgutil.resolve_name(function.place)) for function in late)
