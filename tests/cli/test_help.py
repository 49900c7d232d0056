"""`pound --help` is quick, and every command explains itself with an example."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest
from click.testing import CliRunner

from pounding_cli.cli.main import COMMANDS, FIRST, cli

HEAVY = ("numba", "numpy", "scipy", "pandas", "matplotlib", "h5py", "pint")


def test_help_imports_nothing_heavy():
    code = (
        "import sys; from pounding_cli.cli.main import main; sys.argv = ['pound', '--help']\n"
        "try:\n    main()\nexcept SystemExit:\n    pass\n"
        f"print('loaded:', [name for name in {HEAVY} if name in sys.modules])"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert out.endswith("loaded: []\n")
    assert all(name in out for name in COMMANDS)


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_has_help_and_an_example(name):
    command = cli.get_command(None, name)
    leaves = getattr(command, "commands", {"": command})
    for sub in leaves:
        shown = CliRunner().invoke(cli, [name, *([sub] if sub else []), "--help"])
        assert shown.exit_code == 0
        assert "Example" in shown.output
        assert "pound " + name in shown.output.split("Example", 1)[1]


def test_an_unknown_command_is_refused_with_exit_code_2():
    assert CliRunner().invoke(cli, ["rnu"]).exit_code == 2


@pytest.mark.parametrize(
    ("typed", "meant"),
    [
        ("rnu", "Did you mean `pound run`?"),
        ("Report", "Did you mean `pound report`?"),
        ("study.yaml", "Did you mean `pound run study.yaml`?"),
        ("results/fig6.h5", "Did you mean `pound show results/fig6.h5`?"),
        ("zzzzzz", "`pound --help` lists them."),
    ],
)
def test_an_unknown_command_is_answered_with_what_was_meant(typed, meant):
    refused = CliRunner().invoke(cli, [typed])
    assert refused.exit_code == 2
    assert f"there is no command '{typed}'. {meant}" in refused.output


def test_help_shows_the_first_steps_first():
    shown = CliRunner().invoke(cli, ["--help"]).output
    first, more = shown.split("First steps:\n")[1].split("More:\n")
    assert tuple(line.split()[0] for line in first.splitlines() if line.strip()) == FIRST
    assert len(FIRST) == 5
    assert {line.split()[0] for line in more.splitlines() if line.startswith("  ")} >= set(COMMANDS) - set(FIRST)


def test_shell_completion_names_the_commands():
    """What a shell asks when TAB is pressed after `pound r`."""
    asked = {"_POUND_COMPLETE": "bash_complete", "COMP_WORDS": "pound r", "COMP_CWORD": "1"}
    code = "import sys; from pounding_cli.cli.main import main; sys.argv = ['pound']; main()"
    out = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, env=os.environ | asked
    ).stdout
    assert {line.split(",")[1] for line in out.splitlines()} == {"run", "report", "records"}
