"""Studies to start from: the commented templates, those of published results and of the gallery, and writing one under
a name of the user's."""

from __future__ import annotations

import json
import os
from importlib import resources
from pathlib import Path

from pounding_cli.errors import InputError, Issue
from pounding_cli.outputs import check_output
from pounding_cli.study.text.file import Map, kind_of_file, nearest, read_study

SCHEMA_FILE = "pound.schema.json"
"""Name of the JSON Schema that a study's first line points its editor to."""

SCHEMA_LINE = f"# yaml-language-server: $schema={SCHEMA_FILE}"
"""First line of a study that an editor checks by the schema beside it."""

TEMPLATES = {"pair": "run", "measures": "run", "connector": "connector", "wall": "wall"}
"""The studies to start from by name, the stem of the file in `templates/`, and the `pound` command that takes each."""

EXAMPLE_FOLDERS = ("published", "gallery")
"""Folders of docs/ with studies that can be started from."""


def find_examples() -> dict[str, Path]:
    """Return the studies that come with the program by name: those of published results, and of the gallery."""
    package = Path(__file__).resolve().parents[2]
    installed = package / "data"
    folders = installed if (installed / EXAMPLE_FOLDERS[0]).is_dir() else package.parent / "docs"
    return {path.stem: path for folder in EXAMPLE_FOLDERS for path in sorted((folders / folder).glob("*.yaml"))}


def find_motions(study: Path) -> list[Path]:
    """Return the motion files that a study of the program names and that stand beside it."""
    text = study.read_text(encoding="utf-8")
    return [path for path in sorted(study.parent.glob("*.txt")) if f"file: {path.name}" in text]


def find_missing_motions(study: Path) -> list[str]:
    """Return the motion files that a study names and that are not there."""
    records = read_study(study)[1].get("records")
    used = records.get("use", ()) if isinstance(records, Map) else ()
    named = [entry.get("file") for entry in used if isinstance(entry, Map)]
    return [file for file in named if isinstance(file, str) and not (study.parent / file).exists()]


def start_study(name: str, schema: str, template: str = "pair", like: str | None = None) -> tuple[Path, ...]:
    """Write a study to start from; makes its folder.

    Parameters
    ----------
    name : path of the study file; `.yaml` is added to a name without it
    schema : the JSON Schema of study files, as text
    template : a key of TEMPLATES
    like : a key of `find_examples`, in place of a template

    Returns
    -------
    The files written: the study, its motions, and for `pound run` the JSON Schema beside it.

    Raises
    ------
    InputError : the study exists already, its folder cannot be written, or there is no such example
    """
    if like is not None and like not in find_examples():
        raise InputError(f"there is no study '{like}' to start from", nearest(like, find_examples()))
    path = Path(name) if Path(name).suffix in (".yaml", ".yml") else Path(f"{name}.yaml")
    title = path.stem.replace("-", " ").replace("_", " ").strip()
    if not (title.strip(". ") and os.path.basename(name)):
        raise InputError(f"'{name}' names no file", "write a name, e.g. `pound init my-study`")
    if os.path.exists(path):  # False for a name that is too long: the next check refuses that
        raise InputError(Issue((), "is there already", "choose another name, or move it away", file=str(path)))
    if like is None:
        source = resources.files(__package__) / "templates" / f"{template}.yaml"
        quoted = json.dumps(title[0].upper() + title[1:], ensure_ascii=False)
        texts = {path: source.read_text(encoding="utf-8").replace("TITLE", quoted, 1)}
        takes_schema = TEMPLATES[template] == "run"
    else:
        source = find_examples()[like]
        takes_schema = kind_of_file(source) == "run"
        head = f"{SCHEMA_LINE}\n" if takes_schema else ""
        texts = {path: head + source.read_text(encoding="utf-8")}
        for motion in find_motions(source):
            texts[path.with_name(motion.name)] = motion.read_text(encoding="utf-8")
    if takes_schema:
        texts[path.with_name(SCHEMA_FILE)] = schema
    for each in texts:
        check_output(each, mine=lambda place, head: head.startswith(texts[place].encode()[:60]))
    try:
        for each, text in texts.items():
            each.write_text(text, encoding="utf-8")
    except OSError as error:
        hint = "choose a place that can be written"
        raise InputError(Issue((), f"cannot be written: {error.strerror or error}", hint, file=str(path))) from None
    return tuple(texts)
