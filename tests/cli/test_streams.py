"""What a command does where its output goes nowhere, is cut short, or knows few characters; and the last catch."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from pounding_cli.cli import streams
from tests.helpers.two_buildings import STUDY, known

SOLVE = known

MAIN = "import sys; from pounding_cli.cli.main import main; main()"
"""Without numba where the study is finished, so each process takes a second."""


def command(*arguments: str, **more) -> subprocess.Popen:
    return subprocess.Popen([sys.executable, "-c", MAIN, *arguments], **more)


@pytest.fixture
def done(folder, pound):
    """A finished study: `results/two.h5` of `two.yaml`."""
    pound("run", "two.yaml", "-q")
    return folder


@pytest.mark.parametrize("arguments", [("show", "results/two.h5", "storey"), ("run", "two.yaml"), ("--help",)])
def test_a_reader_that_has_gone_ends_a_command_without_a_word(done, arguments):
    read, write = os.pipe()
    os.close(read)
    process = command(*arguments, stdout=write, stderr=subprocess.PIPE, text=True)
    os.close(write)
    said = process.communicate(timeout=60)[1]
    assert process.returncode == 141
    assert "Traceback" not in said
    assert "BrokenPipe" not in said


def test_a_table_whose_reader_has_gone_is_no_exit_code_of_rich(monkeypatch):
    """rich ends the process with exit code 1; `main` must hear of it."""
    from rich.table import Table

    read, write = os.pipe()
    os.close(read)
    with os.fdopen(write, "w", buffering=1) as gone:
        monkeypatch.setattr(sys, "stdout", gone)
        table = Table("a")
        table.add_row("1")
        with pytest.raises(BrokenPipeError):
            streams.echo_table(table)
        monkeypatch.undo()
        os.dup2(os.open(os.devnull, os.O_WRONLY), gone.fileno())


def test_no_command_prints_with_rich_itself():
    """`streams.echo_table` is the one place; the bar of `pound run` goes to a terminal."""
    sources = (Path(streams.__file__).parent).glob("*.py")
    assert [path.name for path in sources if "Console" in path.read_text()] == ["streams.py"]


@pytest.mark.parametrize("stream", ["1", "2"])
@pytest.mark.parametrize("arguments", [("show", "results/two.h5"), ("run", "two.yaml"), ("check", "two.yaml")])
def test_a_closed_stream_is_as_good_as_one_that_leads_nowhere(done, arguments, stream):
    words = " ".join(arguments)
    shell = f"'{sys.executable}' -c '{MAIN}' {words} {stream}>&-"
    found = subprocess.run(shell, shell=True, capture_output=True, text=True, check=False)
    assert found.returncode == 0
    assert "Traceback" not in found.stderr


def test_an_ascii_terminal_gets_what_stands_for_a_character(done):
    environment = {**os.environ, "PYTHONIOENCODING": "ascii"}
    process = command("run", "two.yaml", stdout=subprocess.PIPE, env=environment)
    said = process.communicate(timeout=60)[0].decode("ascii")
    assert process.returncode == 0
    assert "+- numerical" in said


def test_a_log_that_nobody_reads_does_not_stop_a_run(folder):
    (folder / "two.yaml").write_text(STUDY.replace("gap: 1 cm", "gap: 0 cm"))
    read, write = os.pipe()
    os.close(read)
    script = (
        "import sys; sys.path.insert(0, sys.argv.pop(1)); import pounding_cli.solve as s; "
        "from tests.helpers.two_buildings import known; s.solve = known; " + MAIN
    )
    arguments = [sys.executable, "-c", script, str(Path(__file__).parents[2]), "run", "two.yaml", "--log-json"]
    buffered = {name: value for name, value in os.environ.items() if name != "PYTHONUNBUFFERED"}
    process = subprocess.Popen(arguments, stdout=write, stderr=subprocess.PIPE, text=True, env=buffered)
    os.close(write)
    said = process.communicate(timeout=120)[1]
    assert (process.returncode, said) == (0, "")
    assert (folder / "results" / "two.h5").is_file()


def test_a_full_disk_behind_the_output_is_told(done):
    if not os.path.exists("/dev/full"):
        pytest.skip("no /dev/full here")
    with open("/dev/full", "w") as full:
        process = command("show", "results/two.h5", stdout=full, stderr=subprocess.PIPE, text=True)
    said = process.communicate(timeout=60)[1]
    assert process.returncode == 2
    assert said.startswith("error: there is no space left on the disk")
    assert "Traceback" not in said


def test_what_nobody_foresaw_is_one_line_with_the_command_to_report(done, pound, monkeypatch):
    def fault(*_):
        raise ZeroDivisionError("of a kind\nthat nobody foresaw")

    monkeypatch.setattr("pounding_cli.store.open_results", fault)
    code, out, err = pound("show", "results/two.h5", "storey", "--case", "a b", solve=None)
    assert (code, out) == (70, "")
    assert err.startswith("internal error: ZeroDivisionError: of a kind\n")
    assert "what this command shows: pound --debug show results/two.h5 storey --case 'a b'\n" in err
    assert "Traceback" not in err
    code, _, err = pound("--debug", "show", "results/two.h5", solve=None)
    assert code == 70
    assert "Traceback" in err
    assert "that nobody foresaw" in err


def test_an_end_of_file_is_not_taken_for_ctrl_c(done, pound, monkeypatch):
    """click takes an EOFError, which reading a file may raise, for Ctrl-D at a question."""

    def fault(*_):
        raise EOFError("ran out of input")

    monkeypatch.setattr("pounding_cli.store.open_results", fault)
    code, _, err = pound("show", "results/two.h5", "storey", solve=None)
    assert code == 70
    assert "internal error: EOFError: ran out of input\n" in err


def test_the_exit_codes_are_told_in_the_help(folder, pound):
    _, out, _ = pound("--help", solve=None)
    for code in ("70 an internal error", "141 the program that read the output"):
        assert code in out
