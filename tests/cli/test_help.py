"""`pound --help` is quick, and every command explains itself with an example."""

from __future__ import annotations

import subprocess
import sys

import pytest
from click.testing import CliRunner

from pounding_cli.cli.main import COMMANDS, cli

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
