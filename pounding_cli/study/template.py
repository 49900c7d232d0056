"""Studies to start from: the commented templates, and writing one under a name of the user's."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from importlib import resources
from pathlib import Path

from pounding_cli.errors import InputError, Problem
from pounding_cli.outputs import check_output

SCHEMA_FILE = "pound.schema.json"
"""Name of the JSON Schema that a study's first line points its editor to."""


@dataclass(frozen=True)
class Template:
    """A study to start from.

    name : its key in TEMPLATES and the stem of its file in `templates/`
    command : the `pound` command that runs it
    text : what it is about
    """

    name: str
    command: str
    text: str

    def written(self, title: str) -> str:
        """The study file with this title."""
        source = resources.files(__package__) / "templates" / f"{self.name}.yaml"
        return source.read_text(encoding="utf-8").replace("TITLE", json.dumps(title, ensure_ascii=False), 1)


TEMPLATES = {
    template.name: template
    for template in (
        Template("pair", "run", "two buildings, touching and with a gap, every key explained"),
        Template("measures", "run", "the paper's measures: gap, infill, connectors, under its five motions"),
        Template("connector", "connector", "two connected oscillators in closed form"),
        Template("wall", "wall", "a floor striking a bumper wall"),
    )
}


def start_study(name: str, template: str = "pair") -> tuple[Path, ...]:
    """Write a study to start from; makes its folder.

    Parameters
    ----------
    name : path of the study file; `.yaml` is added to a name without it
    template : a key of TEMPLATES

    Returns
    -------
    The files written: the study, and for `pound run` the JSON Schema beside it.

    Raises
    ------
    InputError : the study exists already, or its folder cannot be written
    """
    path = Path(name) if Path(name).suffix in (".yaml", ".yml") else Path(f"{name}.yaml")
    stem = path.stem.replace("-", " ").replace("_", " ").strip()
    if not stem.strip(". "):
        raise InputError(Problem(f"'{name}' names no file", "write a name, e.g. `pound init my-study`"))
    chosen = TEMPLATES[template]
    schema = path.with_name(SCHEMA_FILE)
    if os.path.exists(path):  # False for a name that is too long: the next check refuses that
        raise InputError(Problem("is there already", "choose another name, or move it away", str(path)))
    check_output(path)
    text = schema_text() if chosen.command == "run" else ""
    if text:
        check_output(schema, mine=lambda _, head: head.startswith(text.encode()[:60]))
    try:
        path.write_text(chosen.written(stem[0].upper() + stem[1:]), encoding="utf-8")
        if not text:
            return (path,)
        schema.write_text(text, encoding="utf-8")
    except OSError as error:
        hint = "choose a place that can be written"
        raise InputError(Problem(f"cannot be written: {error.strerror or error}", hint, str(path))) from None
    return path, schema


def schema_text() -> str:
    """The JSON Schema of study files as it is written to SCHEMA_FILE."""
    from pounding_cli.study.schema import json_schema  # pydantic takes longer to load than the rest of `pound init`

    return json.dumps(json_schema(), indent=2, ensure_ascii=False) + "\n"
