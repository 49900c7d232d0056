"""The command line in this process, in a folder of its own."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from pounding_cli.cli.main import main
from tests.helpers import two_buildings


@pytest.fixture
def folder(request, tmp_path, monkeypatch) -> Path:
    """A folder to stand in, with two short motions and two.yaml: STUDY of the test module, or two small buildings."""
    monkeypatch.chdir(tmp_path)
    two_buildings.write_motions(tmp_path)
    (tmp_path / "two.yaml").write_text(getattr(request.module, "STUDY", two_buildings.STUDY))
    return tmp_path


@pytest.fixture
def pound(request, folder, monkeypatch, capsys) -> Callable[..., tuple[int, str, str]]:
    """Runs `pound ARGUMENTS` in `folder`; returns (exit code, output, errors).

    solve : in place of the solver, that of the test module (SOLVE) unless given; None for the real one
    """

    usual = getattr(request.module, "SOLVE", None)

    def run(*arguments: object, solve=usual) -> tuple[int, str, str]:
        if solve is not None:
            monkeypatch.setattr("pounding_cli.solve.solve", solve)
        monkeypatch.setattr("sys.argv", ["pound", *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            main()
        code, (out, err) = int(ended.value.code or 0), capsys.readouterr()
        request.node.add_report_section("call", f"pound {arguments}, exit code {code}", out + err)  # where a test fails
        return code, out, err

    return run
