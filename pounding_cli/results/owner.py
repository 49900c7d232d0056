"""Whose results stand where new ones will: those of another study are not overwritten."""

from __future__ import annotations

import os
from pathlib import Path

from pounding_cli.errors import InputError, Problem
from pounding_cli.outputs import check_output
from pounding_cli.results import file
from pounding_cli.results.keys import FORMAT_VERSION
from pounding_cli.study.study import Study


def written_place(study: Study, results: Path) -> str:
    """How a results file names the file of its study: the path from its own folder; "" for a study that is Python data.

    The path from the results file still fits where a project is moved, copied or sent.
    """
    if study.from_data:
        return ""
    try:
        return os.path.relpath(study.path.resolve(), results.parent.resolve())
    except ValueError:  # another drive
        return str(study.path.resolve())


def check_results(path: Path, study: Study, workflow: str = "run", replace: bool = False) -> None:
    """Make sure that the results of a study can be written at `path`, before anything is computed; makes the folder.

    Results of the same study are replaced: those that came from the same file, whatever it says by now; or from a file
    that is no longer there, with the same title. A study that is Python data is known by its title.

    Parameters
    ----------
    workflow : the command whose results they will be
    replace : replace results of another study too

    Raises
    ------
    InputError : as `outputs.check_output`; results of another study, another command or a newer program; damaged
        results that do not tell their study
    """
    check_output(path, [study.path], lambda place, _: file.is_results(place))
    held = _held(path, study, workflow)
    if held and not replace:
        hint = "name another file with -o, or use --replace to delete it (in Python: replace=True)"
        raise InputError(Problem(f"the output holds {held}", hint, str(path)))


def _held(path: Path, study: Study, workflow: str) -> str:
    """What other results than those of the same study and command stand at `path`, in words."""
    if not path.exists() or not path.stat().st_size:
        return ""
    try:
        facts = file.facts(path, version=None)
    except InputError:
        return "damaged results whose study cannot be read"
    version, command = int(facts.get("format_version", 0)), facts.get("workflow", facts.get("kind", "run"))
    if version > FORMAT_VERSION:
        return f"results of a newer program, of format version {version}"
    title, place = str(facts.get("title")), facts.get("study_file")
    there = path.parent / str(place).replace("\0", "")
    if place and not study.from_data and os.path.exists(there):
        is_same = there.resolve() == study.path.resolve()
    else:
        is_same = title == study.title and (place is None or bool(place) != study.from_data)
    if not is_same:
        return f"another study: '{title}'" + (f" ({place})" if place else "")
    return "" if command == workflow else f"results of `pound {command}`"
