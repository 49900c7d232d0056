"""The pages that are written from the code: commands, the API, keys, methods and laws."""

from __future__ import annotations

import pydoc
import re

import click
import pytest
import yaml
from pages import ROOT
from pages import hook as hook_named

import pounding_cli
from pounding_cli.cli.main import cli
from pounding_cli.notes import NOTES


@pytest.fixture(scope="module")
def hook():
    return hook_named("reference")


def test_every_command_and_option_is_told(hook):
    page = hook.commands_page()
    for name in cli.list_commands(None):
        command = cli.get_command(None, name)
        for inner, sub in getattr(command, "commands", {"": command}).items():
            part = page.split(f" {f'pound {name} {inner}'.strip()}\n\n```text\n")[1].split("```")[0]
            options = [each.opts[0] for each in sub.params if isinstance(each, click.Option)]
            assert all(option in part for option in options)


def test_every_note_has_an_entry():
    page = (ROOT / "docs" / "notes.md").read_text(encoding="utf-8")
    entries = dict(re.findall(r"^### (\S+)\n\n\*[^*]+\*\n\n(.+)$", page, re.MULTILINE))
    assert entries == {code: note.explanation for code, note in NOTES.items()}
    assert page == hook_named("notes").notes_page(), "python docs/hooks/notes.py writes it anew"


def test_the_api_exists_and_is_documented(hook):
    for name in (name for names in hook.API.values() for name in names):
        found = pydoc.locate(name)
        assert found is not None, name
        assert found.__doc__, name


def test_every_law_has_a_page_a_loop_and_an_example_that_runs(tmp_path):
    """Fails if a law declares no example or one that `pound check` refuses, or has no loop."""
    pages = dict(hook_named("laws").pages())
    words = [name for name in pages if name.endswith(".md") and name != "laws/index.md"]
    assert len(words) == 16
    for name in words:
        assert f"]({name.removeprefix('laws/')})" in pages["laws/index.md"]
        assert len(pages[name.replace(".md", ".svg")]) > 5_000
        example = yaml.safe_load(re.search(r"```yaml\n(.*?)```", pages[name], re.DOTALL)[1])
        study = {
            "title": "x",
            "records": {"use": ["elcentro"], "duration": "5 s"},
            "buildings": {"stiff": {"storeys": 5, "period": "0.36 s"}, **example.get("buildings", {})},
            "group": ["stiff", *example.get("buildings", {"stiff": {}})],
            "cases": example.get("cases", {"gap": {"link": "pounding", "gap": "1 cm"}}),
        }
        path = tmp_path / "study.yaml"
        path.write_text(yaml.safe_dump(study), encoding="utf-8")
        pounding_cli.load_study(path)


def test_keys_and_methods_are_told(hook):
    page = hook.keys_page()
    assert all(f"| `{key}` |" in page for key in ("gap", "restitution", "base_shear", "limits", "wen_gamma"))
    assert "base yield shear over weight" in page
    assert all(f"`{name}`" in hook.methods_page() for name in ("taylor", "dop853", "newmark"))
