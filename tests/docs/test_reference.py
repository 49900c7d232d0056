"""What is written from the code: tables in pages, and the pages of commands and of the API."""

from __future__ import annotations

import importlib.util
import pydoc
import subprocess
import sys

import click
import pytest
from pages import ROOT

from pounding_cli.cli.main import cli


@pytest.fixture(scope="module")
def hook():
    spec = importlib.util.spec_from_file_location("reference", ROOT / "docs" / "hooks" / "reference.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_tables_are_written_anew():
    """Stale? `python docs/hooks/tables.py` writes them."""
    command = [sys.executable, "docs/hooks/tables.py", "--check"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_every_command_and_option_is_told(hook):
    page = hook.commands_page()
    for name in cli.list_commands(None):
        command = cli.get_command(None, name)
        for inner, sub in getattr(command, "commands", {"": command}).items():
            part = page.split(f" {f'pound {name} {inner}'.strip()}\n\n```text\n")[1].split("```")[0]
            options = [each.opts[0] for each in sub.params if isinstance(each, click.Option)]
            assert all(option in part for option in options)


def test_the_api_exists_and_is_documented(hook):
    for name in (name for names in hook.API.values() for name in names):
        found = pydoc.locate(name)
        assert found is not None, name
        assert found.__doc__, name
