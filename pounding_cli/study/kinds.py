"""Which command a study file is for, told by its keys."""

from __future__ import annotations

from pathlib import Path

from pounding_cli.errors import InputError, Problem
from pounding_cli.study.source import Node
from pounding_cli.study.yaml_file import read_source

_OWN = ("records", "buildings", "group", "cases")
_OTHERS = {
    "wall": ("wall", "frame", "striker", "concrete", "mesh"),
    "connector": ("first", "second", "connector", "frequencies"),
}


def kind_of(root: Node, unclear: str = "run") -> str:
    """The command that takes a study: "run", "connector" or "wall"; `unclear` where the keys do not tell."""
    keys = set(root.value) if root.is_mapping else set()
    if not keys.isdisjoint(_OWN):
        return "run"
    return next((command for command, marks in _OTHERS.items() if not keys.isdisjoint(marks)), unclear)


def kind_of_file(path: Path) -> str:
    """As `kind_of`, for a file.  Raises `InputError` where it cannot be read."""
    return kind_of(read_source(path)[1])


def refuse_other_kinds(root: Node, file: str, own: str = "run") -> None:
    """Raise `InputError` with the right command where a study is not one of `pound {own}`."""
    if (command := kind_of(root, own)) != own:
        raise InputError(Problem(f"is a study of `pound {command}`", f"write `pound {command} {file}`", file))
