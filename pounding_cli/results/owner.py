"""Whose results stand where new ones will: those of another study are not overwritten."""

from __future__ import annotations

import os
from pathlib import Path

from pounding_cli.errors import InputError, Problem
from pounding_cli.numbers import counted
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
    InputError : as `outputs.check_output`; results of another study or of a newer program; damaged results that do not
        tell their study
    """
    check_output(path, [study.path], lambda place, _: file.is_results(place))
    if not path.exists() or not path.stat().st_size:
        return
    held, facts = "damaged results whose study cannot be read", {}
    try:
        facts = file.facts(path, version=None)
    except InputError:
        pass
    else:
        version, command = int(facts.get("format_version", 0)), facts.get("workflow", facts.get("kind", "run"))
        if version > FORMAT_VERSION:
            said = f"the output has format version {version}, newer than this program's {FORMAT_VERSION}"
            raise InputError(Problem(said, "choose another name with -o FILE.h5, or move it away", str(path)))
        of = "" if command == "run" else f" of `pound {command}`"
        if not _is_of(facts, study, path):
            source = f" ({facts['study_file']})" if facts.get("study_file") else ""
            scenes = f" with {counted(int(facts['scenes']), 'scene')}" if "scenes" in facts else ""
            held = f"another study{of}: '{facts.get('title')}'{source}{scenes}"
        elif command == workflow:
            return
        else:
            held = f"results of `pound {command}`"
    if not replace:
        free = next(name for n in range(2, 1000) if not (name := path.with_stem(f"{path.stem}-{n}")).exists())
        hint = f"name another file, e.g. -o {free}, or use --replace to delete it (in Python: replace=True)"
        raise InputError(Problem(f"the output holds {held}", hint, str(path)))


def _is_of(facts: dict, study: Study, path: Path) -> bool:
    """Whether the results in `path` came from a study."""
    place, same_title = facts.get("study_file"), str(facts.get("title")) == study.title
    if not place:
        return (place is None or study.from_data) and same_title
    there = path.parent / str(place).replace("\0", "")
    if study.from_data:
        return False
    return there.resolve() == study.path.resolve() or (not os.path.exists(there) and same_title)
