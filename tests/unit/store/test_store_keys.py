"""What results that are on disk are found again by."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

import pounding_cli
from pounding_cli.store import keys


@pytest.mark.parametrize("changed", ["laws/bilinear.py", "kernels/taylor.py", "model/scene.py", "solve/run.py"])
def test_a_change_of_the_solver_is_another_solver(changed, tmp_path, monkeypatch):
    """Fails if a changed law takes over the results of the former one."""
    shutil.copytree(Path(pounding_cli.__file__).parent, tmp_path / "pounding_cli", ignore=lambda *_: ["__pycache__"])
    monkeypatch.setattr(keys, "__file__", str(tmp_path / "pounding_cli" / "store" / "keys.py"))
    version = keys.solver_version.__wrapped__
    before = version()
    assert version() == before
    (tmp_path / "pounding_cli" / changed).open("a").write("\n")
    assert version() != before


def test_a_change_of_a_law_of_another_package_is_another_solver(tmp_path, monkeypatch):
    """Fails likewise."""
    law = tmp_path / "rubber.py"
    law.write_text("STIFFNESS = 1\n")
    monkeypatch.setattr(keys, "sources_elsewhere", lambda: [law])
    before = keys.solver_version.__wrapped__()
    law.write_text("STIFFNESS = 2\n")
    assert keys.solver_version.__wrapped__() != before


def test_a_change_of_a_model_of_its_own_is_another_solver(tmp_path, monkeypatch):
    """Fails if a changed wall takes over the points of the former one, or a row of buildings asks for the wall."""
    package = tmp_path / "bridge"
    package.mkdir()
    for name in ("__init__", "model", "mesh"):
        (package / f"{name}.py").write_text("")
    monkeypatch.syspath_prepend(tmp_path)
    version = keys.solver_version.__wrapped__
    before, rows = version("bridge.model:solve"), version()
    (package / "mesh.py").write_text("SIZE = 2\n")
    assert version("bridge.model:solve") != before
    assert version() == rows
