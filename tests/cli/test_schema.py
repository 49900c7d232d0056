"""`pound schema`: the committed schema is up to date, and every shipped study names it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

from pounding_cli.cli.main import cli
from pounding_cli.errors import InputError

COMMITTED = Path("configs/pound.schema.json")


def test_committed_schema_is_up_to_date():
    """Stale?  `pound schema -o configs/pound.schema.json`."""
    result = CliRunner().invoke(cli, ["schema"], catch_exceptions=False)
    assert result.output == COMMITTED.read_text(encoding="utf-8")


def test_every_key_is_described():
    schema = json.loads(COMMITTED.read_text(encoding="utf-8"))
    for model in (schema, *(part for part in schema["$defs"].values() if "properties" in part)):
        assert model["description"]
        for name, key in model["properties"].items():
            assert key.get("description") or "$ref" in key, name
        assert model["additionalProperties"] is False


def test_studies_name_the_schema():
    for path in Path("configs").rglob("*.yaml"):
        text = path.read_text(encoding="utf-8")
        if "\ncases:" not in text:
            continue
        first = text.splitlines()[0]
        assert first.startswith("# yaml-language-server: $schema=")
        assert (path.parent / first.split("=", 1)[1]).resolve() == COMMITTED.resolve()


def test_writes_a_file(tmp_path):
    out = tmp_path / "s.json"
    CliRunner().invoke(cli, ["schema", "-o", str(out)], catch_exceptions=False)
    assert json.loads(out.read_text(encoding="utf-8"))["title"] == "pound study"
    CliRunner().invoke(cli, ["schema", "-o", str(out)], catch_exceptions=False)  # its own file is replaced
    out.write_text("mine")
    with pytest.raises(InputError, match="was not written by this command"):
        CliRunner().invoke(cli, ["schema", "-o", str(out)], catch_exceptions=False)
    assert out.read_text() == "mine"
    with pytest.raises(InputError, match="cannot be written"):
        CliRunner().invoke(cli, ["schema", "-o", str(out / "s.json")], catch_exceptions=False)
