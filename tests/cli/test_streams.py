"""What a command does where its output goes nowhere, is cut short, or knows few characters; and the last catch."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

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


@pytest.mark.parametrize("stream", ["1", "2"])
@pytest.mark.parametrize("arguments", [("show", "results/two.h5"), ("check", "two.yaml")])
def test_a_closed_stream_is_as_good_as_one_that_leads_nowhere(done, arguments, stream):
    words = " ".join(arguments)
    shell = f"'{sys.executable}' -c '{MAIN}' {words} {stream}>&-"
    found = subprocess.run(shell, shell=True, capture_output=True, text=True, check=False)
    assert found.returncode == 0
    assert "Traceback" not in found.stderr


def test_a_stream_of_few_characters_gets_all_of_them(done):
    """In UTF-8. Fails if a character that its encoding lacks ends the command."""
    environment = {**os.environ, "PYTHONIOENCODING": "ascii"}
    process = command("run", "two.yaml", stdout=subprocess.PIPE, env=environment)
    said = process.communicate(timeout=60)[0].decode("utf-8")
    assert process.returncode == 0
    assert "V/V₀ elastic" in said


def test_a_full_disk_behind_the_output_is_told(done):
    if not os.path.exists("/dev/full"):
        pytest.skip("no /dev/full here")
    with open("/dev/full", "w") as full:
        process = command("show", "results/two.h5", stdout=full, stderr=subprocess.PIPE, text=True)
    said = process.communicate(timeout=60)[1]
    assert process.returncode == 2
    assert said.startswith("error: there is no space left on the disk")
    assert "Traceback" not in said


@pytest.mark.parametrize("fault", [ZeroDivisionError("of a kind\nthat nobody foresaw"), EOFError("ran out of input")])
def test_what_nobody_foresaw_is_one_line_with_the_command_to_report(done, pound, monkeypatch, fault):
    """click takes an EOFError, which reading a file may raise, for Ctrl-D at a question."""

    def fails(*_, **__):
        raise fault

    monkeypatch.setattr("pounding_cli.texts.escape_formulas", fails)
    code, out, err = pound("show", "results/two.h5", "storey", "--format", "csv", "--case", "gap")
    assert (code, out) == (70, "")
    assert err.lstrip().startswith(f"internal error: {type(fault).__name__}: ")
    assert "pound --debug show results/two.h5 storey --format csv --case gap\n" in err
    assert "Traceback" not in err
    code, _, err = pound("--debug", "show", "results/two.h5", "storey", "--format", "csv")
    assert code == 70
    assert "Traceback" in err


def test_the_exit_codes_are_told_in_the_help(folder, pound):
    out = pound("--help")[1]
    for code in ("70 an internal error", "141 the program that read the output"):
        assert code in out
