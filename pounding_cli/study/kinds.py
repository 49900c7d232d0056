"""Which command a study file is for, told by its keys."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pounding_cli.errors import InputError, Problem
from pounding_cli.study.file import read_study

_MARKS = {
    "run": ("records", "buildings", "group", "cases"),
    "connector": ("first", "second", "connector", "frequencies"),
    "wall": ("wall", "frame", "striker", "concrete", "mesh"),
}
"""Top-level keys that only the studies of these commands have."""


def kind_of(root: Any, unclear: str = "run") -> str:
    """The command that takes a study, such as "run" or "wall"; `unclear` where the keys do not tell."""
    keys = set(root)
    return next((name for name, own in _MARKS.items() if not keys.isdisjoint(own)), unclear)


def kind_of_file(path: Path) -> str:
    """As `kind_of`, for a file.  Raises `InputError` where it cannot be read."""
    return kind_of(read_study(path)[1])


def refuse_other_kinds(root: Any, file: str, own: str = "run") -> None:
    """Raise `InputError` with the right command where a study is not one of `pound {own}`."""
    if (command := kind_of(root, own)) != own:
        raise InputError(Problem(f"is a study of `pound {command}`", f"write `pound {command} {file}`", file))
