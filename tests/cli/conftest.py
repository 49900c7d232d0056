"""The command line in this process, in a folder of its own."""

from __future__ import annotations

import pytest

from pounding_cli.cli.main import main


@pytest.fixture
def pound(request, tmp_path, monkeypatch, capsys):
    """Runs `pound` beside two.yaml, the STUDY of the test module; returns (exit code, output, errors)."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "two.yaml").write_text(request.module.STUDY)

    def run(*words: str) -> tuple[int, str, str]:
        monkeypatch.setattr("sys.argv", ["pound", *words])
        with pytest.raises(SystemExit) as ended:
            main()
        return ended.value.code, *capsys.readouterr()

    return run
