"""The command line in this process, in a folder of its own."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from pounding_cli.cli.main import main

TWO = """\
title: Two small buildings
records: {use: [elcentro, taft], duration: 3 s}
buildings:
  stiff: {storeys: 3, period: 0.3 s, mass: 200 t}
  soft: {like: stiff, storeys: 2, period: 0.5 s}
group: [stiff, soft]
cases:
  touching: {link: pounding, gap: 0 cm}
  gap: {link: pounding, gap: 5 mm}
analyses: [elastic, inelastic]
estimate: none
"""
"""8 rows of 16 time histories, in which both cases strike under El Centro's stand-in."""


@pytest.fixture
def folder(request, tmp_path, monkeypatch) -> Path:
    """A folder to stand in, with two.yaml, STUDY of the test module or TWO, and two motions of half a second [g]."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("POUND_RECORDS", raising=False)
    monkeypatch.setenv("POUND_HOME", str(tmp_path / "home"))
    time = np.arange(0.0, 0.5, 0.01)
    for name, peak in (("weak", 0.1), ("strong", 0.4)):
        np.savetxt(tmp_path / f"{name}.txt", peak * np.sin(12 * time), header="unit: g\ndt: 0.01 s")
    (tmp_path / "two.yaml").write_text(getattr(request.module, "STUDY", TWO))
    return tmp_path


@pytest.fixture
def pound(request, folder, monkeypatch, capsys) -> Callable[..., tuple[int, str, str]]:
    """Runs `pound ARGUMENTS` in `folder`; returns (exit code, output, errors).

    solve : in place of the solver, that of the test module (SOLVE) unless given
    """
    usual = getattr(request.module, "SOLVE", None)

    def run(*arguments: object, solve=usual) -> tuple[int, str, str]:
        if solve is not None:

            def solve_all(scenes, accuracy, method, **settings):
                return [solve(scene, accuracy=accuracy, method=method, **settings) for scene in scenes]

            monkeypatch.setattr("pounding_cli.solver.solve.solve", solve)
            monkeypatch.setattr("pounding_cli.solver.solve.solve_all", solve_all)
        monkeypatch.setattr("sys.argv", ["pound", *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            main()
        code, (out, err) = int(ended.value.code or 0), capsys.readouterr()
        request.node.add_report_section("call", f"pound {arguments}, exit code {code}", out + err)  # where a test fails
        return code, out, err

    return run
