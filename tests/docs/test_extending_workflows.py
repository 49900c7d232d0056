"""The recipe for a model of one's own: the lines of docs/extending.md, put into the list of workflows."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import pytest
from pages import ROOT, blocks

PAGE = ROOT / "docs" / "extending.md"

STUDY = """\
title: Falls
restitution: 0.5
sweep:
  height: [50 cm, 2 m]
"""

WALK = """
import importlib.util, json, sys

spec = importlib.util.spec_from_file_location("pounding_cli.workflows", "workflows.py")
changed = sys.modules[spec.name] = importlib.util.module_from_spec(spec)
spec.loader.exec_module(changed)

import pounding_cli as pound
from pounding_cli.errors import InputError
from pounding_cli.report.build import write_report
from pathlib import Path

results = pound.run("ball.yaml", "ball.h5", workflow="ball", engine=sys.argv[1])
table = results.table("ball")
pages = [path.name for path in write_report(results, Path("report"), ())]
Path("ball.yaml").write_text(Path("ball.yaml").read_text().replace("0.5", "1"))
again = pound.run("ball.yaml", "again.h5", workflow="ball", engine=sys.argv[1]).table("ball")
try:
    Path("ball.yaml").write_text("title: Falls\\nheight: 3 kg\\n")
    pound.run("ball.yaml", "again.h5", workflow="ball")
except InputError as refused:
    told = str(refused)
print(json.dumps({
    "fall": table["fall"].tolist(),
    "speed": table["speed"].tolist(),
    "heights": results.dataset["heights"].to_numpy().tolist(),
    "dims": results.dataset["heights"].dims,
    "label": results.point_label((0,)),
    "status": again["status"].tolist(),
    "pages": pages,
    "told": told,
}))
"""


@pytest.fixture
def folder(tmp_path):
    """A folder with the new module, the list of workflows as the page changes it, and a study."""
    module, entry = (block.text for block in blocks(PAGE) if "Ball" in block.text)
    text = (ROOT / "pounding_cli" / "workflows.py").read_text(encoding="utf-8")
    before, end, after = text.partition(")\n\nWORKFLOWS:")
    assert end
    (tmp_path / "workflows.py").write_text(f"{before}{entry},\n{end}{after}")
    (tmp_path / "ball.py").write_text(module)
    (tmp_path / "ball.yaml").write_text(STUDY)
    return tmp_path


@pytest.mark.parametrize("engine", ["serial", "processes"])
def test_a_model_of_ones_own_runs_with_every_engine(folder, engine):
    """Fails if something beside the new module and its entry has to know the workflow."""
    environment = os.environ | {"PYTHONPATH": os.pathsep.join((str(folder), str(ROOT)))}
    command = [sys.executable, "-c", WALK, engine]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    said = json.loads(done.stdout.splitlines()[-1])
    assert said["fall"] == [0.5, 2.0]
    assert said["speed"] == pytest.approx([(2 * 9.81 * h) ** 0.5 for h in (0.5, 2.0)])
    assert said["dims"] == ["height", "bounce"]
    assert said["heights"] == [[h * 0.25**n for n in range(5)] for h in (0.5, 2.0)]
    assert said["label"] == "height = 50 cm"
    assert said["status"] == ["refused: the ball never rests"] * 2
    assert said["pages"] == ["ball.csv", "report.html"]
    assert "ball.yaml:2:9" in said["told"]
    assert "3 kg" in said["told"]
