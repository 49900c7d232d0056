"""Which command a study file is for, told by its keys."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pounding_cli.errors import InputError, Problem
from pounding_cli.study.source import Node
from pounding_cli.study.yaml_file import read_source
from pounding_cli.workflows import WORKFLOWS

_OTHERS = {
    "connector": ("first", "second", "connector", "frequencies"),
    "wall": ("wall", "frame", "striker", "concrete", "mesh"),
}
"""Top-level keys that only the studies of these commands have."""


def kind_of(root: Node, unclear: str = "run") -> str:
    """The command that takes a study, such as "run" or "wall"; `unclear` where the keys do not tell."""
    keys = set(root.value) if root.is_mapping else set()
    marks = {"run": WORKFLOWS["run"].marks, **_OTHERS}
    return next((name for name, own in marks.items() if not keys.isdisjoint(own)), unclear)


def kind_of_file(path: Path) -> str:
    """As `kind_of`, for a file.  Raises `InputError` where it cannot be read."""
    return kind_of(read_source(path)[1])


def refuse_other_kinds(root: Node, file: str, own: str = "run") -> None:
    """Raise `InputError` with the right command where a study is not one of `pound {own}`."""
    if (command := kind_of(root, own)) != own:
        raise InputError(Problem(f"is a study of `pound {command}`", f"write `pound {command} {file}`", file))


def load_for(path: Path, kind: str) -> Any:
    """The study of a file as the workflow `kind` takes it.  Raises `InputError` with every problem and its place."""
    from pounding_cli.study.load import load_study

    return load_study(path)
