"""The written pages of the site: every command, option and key is on them, and every name of the API."""

from __future__ import annotations

import importlib.util
import pydoc
import re
from pathlib import Path

import click
import pytest
import yaml

from pounding_cli.cli.main import COMMANDS, cli
from pounding_cli.study.keys import key_tables, sections
from pounding_cli.study.schema import json_schema


@pytest.fixture(scope="module")
def hook():
    spec = importlib.util.spec_from_file_location("reference", Path("docs/hooks/reference.py"))
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def leaves():
    for name in COMMANDS:
        command = cli.get_command(None, name)
        for inner, sub in getattr(command, "commands", {"": command}).items():
            yield f"pound {name} {inner}".strip(), sub


def test_every_command_and_option_is_told(hook):
    page = hook.commands_page()
    for path, command in leaves():
        part = page.split(f" {path}\n\n```text\n")[1].split("```")[0]
        assert part.startswith(f"Usage: {path} "), path
        for parameter in command.params:
            if isinstance(parameter, click.Option):
                assert parameter.opts[0] in part, (path, parameter.name)
        assert "Example" in part


def test_every_key_of_the_schema_is_told():
    """Found in the JSON Schema, which pydantic writes, not by this program's own walk."""
    wanted = set(json_schema()["properties"])
    for definition in json_schema()["$defs"].values():
        wanted |= set(definition.get("properties", {}))
    assert len(wanted) > 50
    assert set(re.findall(r"^\| `(\w+)` \|", key_tables(), flags=re.MULTILINE)) == wanted


def test_every_mapping_stands_once_with_its_place():
    found = [path for path, _ in sections()]
    assert found[0] == ""
    assert "cases.NAME.pairs" in found
    assert "buildings.NAME.yield" in found
    assert len({model for _, model in sections()}) == len(found)


def test_the_api_exists_and_is_documented(hook):
    page = hook.api_page()
    for names in hook.API.values():
        for name in names:
            assert f"::: {name}\n" in page
            found = pydoc.locate(name)
            assert found is not None, name
            assert found.__doc__, name


def test_every_page_is_in_the_navigation(hook):
    config = yaml.load(Path("mkdocs.yml").read_text(encoding="utf-8"), Loader=yaml.BaseLoader)
    stack, listed = list(config["nav"]), []
    while stack:
        entry = stack.pop()
        if isinstance(entry, dict):
            stack += [item for items in entry.values() for item in items]
        else:
            listed.append(entry)
    there = [str(path.relative_to("docs")) for path in Path("docs").rglob("*.md")]
    assert sorted(listed) == sorted([*there, *(path for path, _ in hook.pages())])
