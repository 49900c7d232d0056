"""The results file that stands where new results will: which study it holds, and what of it can be used again."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import h5py

from pounding_cli.errors import InputError, Problem
from pounding_cli.numbers import counted
from pounding_cli.outputs import check_output
from pounding_cli.store.files import is_results, opened
from pounding_cli.store.keys import FORMAT_VERSION


class Source(Protocol):
    """What tells one study from another."""

    @property
    def path(self) -> Path: ...
    @property
    def title(self) -> str: ...


def written_place(study: Source, results: Path) -> str:
    """How a results file names the file of its study: the path from its own folder; "" for a study that is Python data.

    The path from the results file still fits where a project is moved, copied or sent.
    """
    if _is_data(study):
        return ""
    try:
        return os.path.relpath(study.path.resolve(), results.parent.resolve())
    except ValueError:  # another drive
        return str(study.path.resolve())


def check_results(path: Path, study: Source, kind: str = "", replace: bool = False) -> None:
    """Make sure that the results of a study can be written at `path`, before anything is computed; makes the folder.

    Results of the same study are replaced: those that came from the same file, whatever it says by now; or from a file
    that is no longer there, with the same title. A study that is Python data is known by its title.

    Parameters
    ----------
    path : the results file
    study : the study
    kind : the workflow, "" for `pound run`
    replace : replace the results of another study too

    Raises
    ------
    InputError : as `check_output`; results of another study or of a newer program; damaged results that do not tell
        their study
    """
    check_output(path, [study.path], lambda place, _: is_results(place))
    if not path.exists() or not path.stat().st_size:
        return
    name, what = str(path), _held(path)
    if what.version > FORMAT_VERSION:
        said = f"the output has format version {what.version:g}, newer than this program's {FORMAT_VERSION}"
        raise InputError(Problem(said, "choose another name with -o FILE.h5, or move it away", name))
    if replace or (what.kind == kind and what.is_of(study, path)):
        return
    same = what.is_of(study, path)
    held = f"results of `pound {what.kind or 'run'}`" if same else str(what)
    hint = f"name another file, e.g. -o {_free(path)}, or use --replace to delete it (in Python: replace=True)"
    raise InputError(Problem(f"the output holds {held}", hint, name))


def _is_data(study: Source) -> bool:
    """Whether a study is Python data."""
    return bool(getattr(study, "from_data", False))


@dataclass(frozen=True)
class _Held:
    """What a results file holds: kind, title, `written_place` of its study (None: not said), counts."""

    kind: str = ""
    title: str = ""
    file: str | None = None
    version: float = 0
    scenes: int = 0
    histories: int = 0
    damaged: bool = False

    def is_of(self, study: Source, path: Path) -> bool:
        """Whether it came from a study."""
        from_data = _is_data(study)
        if self.damaged:
            return False
        if self.file is None or not self.file:
            return (self.file is None or from_data) and self.title == study.title
        there = path.parent / self.file
        if from_data:
            return False
        return there.resolve() == study.path.resolve() or (not os.path.exists(there) and self.title == study.title)

    def __str__(self) -> str:
        if self.damaged:
            return "damaged results whose study cannot be read"
        command = f" of `pound {self.kind}`" if self.kind else ""
        source = f" ({self.file})" if self.file else ""
        counts = [counted(self.scenes, "scene")] if self.scenes else []
        counts += [counted(self.histories, "history", "histories")] if self.histories else []
        with_counts = f" with {' and '.join(counts)}" if counts else ""
        return f"another study{command}: '{self.title}'{source}{with_counts}"


def _held(path: Path) -> _Held:
    try:
        with opened(path, any_version=True) as file:
            facts = file.attrs
            return _Held(
                str(facts.get("workflow", facts.get("kind", ""))), str(facts["title"]), _place(file),
                float(facts.get("format_version", 0)),
                int(facts.get("scenes", 0)), len(file["histories"]) if "histories" in file else 0,
            )  # fmt: skip
    except InputError:
        return _Held(damaged=True)


def _place(file: h5py.File) -> str | None:
    place = file.attrs.get("study_file")
    return None if place is None else str(place).replace("\0", "")


def _free(path: Path) -> Path:
    """A name beside `path` that no file has."""
    number = 2
    while path.with_stem(f"{path.stem}-{number}").exists():
        number += 1
    return path.with_stem(f"{path.stem}-{number}")


@dataclass(frozen=True)
class FormerRun:
    """The results file that stands where new results will.

    differs : in words, what keeps its scenes from being used again; "" where nothing does
    scenes, failed : of its study
    """

    differs: str
    scenes: int
    failed: int


def former_run(path: Path, key: str) -> FormerRun | None:
    """What stands at `path`, if anything; `key`: the `solution_key` of the new run."""
    try:
        with opened(path, any_version=True) as file:
            its = _parts(str(file.attrs["solution_key"]))
            scenes, failed = int(file.attrs["scenes"]), int(file.attrs["scenes_failed"])
    except (InputError, OSError):
        return None
    changes = [f"{name} {its.get(name, '?')} (now {value})" for name, value in _parts(key).items()
               if its.get(name) != value]  # fmt: skip
    changes += [f"{name} {value}" for name, value in its.items() if name not in _parts(key)]
    return FormerRun(", ".join(changes), scenes, failed)


def _parts(key: str) -> dict[str, str]:
    return dict(part.partition(" ")[::2] for part in key.split(" | "))
