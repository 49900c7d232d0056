"""The recipe for a result variable: the lines of docs/extending.md, put into the list of variables."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import pytest
from pages import ROOT, blocks

from tests.night import NIGHTLY

PAGE = ROOT / "docs" / "extending.md"

STUDY = """
records: {use: [elcentro], duration: 3 s}
buildings: {stiff: {storeys: 2, period: 0.3 s}, soft: {storeys: 2, period: 0.5 s}}
group: [stiff, soft]
cases: {touching: {link: pounding, gap: 0 cm}, gap: {link: pounding, gap: 90 cm}}
analyses: [elastic]
"""

WALK = """
import importlib.util, json, sys
import numpy as np

spec = importlib.util.spec_from_file_location("pounding_cli.variables", "variables.py")
changed = sys.modules[spec.name] = importlib.util.module_from_spec(spec)
spec.loader.exec_module(changed)

import pounding_cli as pound
from pounding_cli.report.evidence import find_nominal
from pounding_cli.report.widgets import build_explorer_data
from pounding_cli.report.sweep import over_sweep
from pounding_cli.study.expressions.expression import Scope, parse_expression

results = pound.run("study.yaml", engine="serial")
link = results.link()
expected = link["impulse"] / link["contact_time"]
explorer = build_explorer_data(results, find_nominal(results))
struck = link["case"] == "touching"
column = results.column("link", "mean_force")
print(json.dumps({
    "equal": bool(np.array_equal(link["mean_force"][struck], expected[struck]) and struck.any()),
    "never closes": bool(link["mean_force"][~struck].isna().all()),
    "meaning": [column.unit.name, column.unit.si, column.text],
    "dataset": results.dataset["mean_force"].attrs["units"],
    "worst": float(over_sweep(results, "mean_force", {"case": "touching"})["mean"]),
    "largest": float(link["mean_force"].max()),
    "unit": parse_expression("largest mean_force", Scope(("stiff", "soft"))).unit,
    "charted": "mean_force" in [each["key"] for each in explorer["quantities"]],
}))
"""


@pytest.fixture
def folder(tmp_path):
    """A folder with the list of variables as the page changes it, and a study."""
    entry = next(block.text for block in blocks(PAGE) if "Variable(" in block.text)
    text = (ROOT / "pounding_cli" / "variables.py").read_text(encoding="utf-8")
    before, end, after = text.partition(')  # fmt: skip\n"""Variables of responses')
    assert end
    (tmp_path / "variables.py").write_text(before + entry + end + after)
    (tmp_path / "study.yaml").write_text(STUDY)
    (tmp_path / "walk.py").write_text(WALK)
    return tmp_path


@NIGHTLY
def test_one_entry_makes_a_variable_of_the_file_and_all_that_reads_it(folder):
    """Fails where the writer, a table, units, expressions, figures or the page keep a list of their own."""
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    command = [sys.executable, "walk.py"]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout.splitlines()[-1])
    assert found.pop("worst") == pytest.approx(found.pop("largest") / 1e3, rel=1e-12)  # figures show kN
    assert found == {
        "equal": True,
        "never closes": True,
        "meaning": ["kN", "N", "mean link force while there is one"],
        "dataset": "N",
        "unit": "N",
        "charted": True,
    }
