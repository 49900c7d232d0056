"""Studies to start from: the commented templates, and writing one under a name of the user's."""

from __future__ import annotations

import json
import os
from importlib import resources
from pathlib import Path

from pounding_cli.errors import InputError, Problem
from pounding_cli.outputs import check_output

SCHEMA_FILE = "pound.schema.json"
"""Name of the JSON Schema that a study's first line points its editor to."""


TEMPLATES = {"pair": "run", "measures": "run", "connector": "connector", "wall": "wall"}
"""The studies to start from by name, the stem of the file in `templates/`, and the `pound` command that takes each."""


def start_study(name: str, schema: str, template: str = "pair") -> tuple[Path, ...]:
    """Write a study to start from; makes its folder.

    Parameters
    ----------
    name : path of the study file; `.yaml` is added to a name without it
    schema : the JSON Schema of study files, as text
    template : a key of TEMPLATES

    Returns
    -------
    The files written: the study, and for `pound run` the JSON Schema beside it.

    Raises
    ------
    InputError : the study exists already, or its folder cannot be written
    """
    path = Path(name) if Path(name).suffix in (".yaml", ".yml") else Path(f"{name}.yaml")
    title = path.stem.replace("-", " ").replace("_", " ").strip()
    if not (title.strip(". ") and os.path.basename(name)):
        raise InputError(Problem(f"'{name}' names no file", "write a name, e.g. `pound init my-study`"))
    if os.path.exists(path):  # False for a name that is too long: the next check refuses that
        raise InputError(Problem("is there already", "choose another name, or move it away", str(path)))
    source = resources.files(__package__) / "templates" / f"{template}.yaml"
    quoted = json.dumps(title[0].upper() + title[1:], ensure_ascii=False)
    texts = {path: source.read_text(encoding="utf-8").replace("TITLE", quoted, 1)}
    if TEMPLATES[template] == "run":
        texts[path.with_name(SCHEMA_FILE)] = schema
    for each in texts:
        check_output(each, mine=lambda place, head: head.startswith(texts[place].encode()[:60]))
    try:
        for each, text in texts.items():
            each.write_text(text, encoding="utf-8")
    except OSError as error:
        hint = "choose a place that can be written"
        raise InputError(Problem(f"cannot be written: {error.strerror or error}", hint, str(path))) from None
    return tuple(texts)
