"""Which command a study file is for, told by its keys."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pounding_cli.errors import InputError, Problem
from pounding_cli.study.file import read_study
from pounding_cli.workflows import WORKFLOWS


def kind_of(root: Any, unclear: str = "run") -> str:
    """The command that takes a study, such as "run" or "wall"; `unclear` where the keys do not tell."""
    keys = set(root)
    return next((name for name, workflow in WORKFLOWS.items() if not keys.isdisjoint(workflow.marks)), unclear)


def kind_of_file(path: Path) -> str:
    """As `kind_of`, for a file.  Raises `InputError` where it cannot be read."""
    return kind_of(read_study(path)[1])


def refuse_other_kinds(root: Any, file: str, own: str = "run") -> None:
    """Raise `InputError` with the right command where a study is not one of `pound {own}`."""
    if (command := kind_of(root, own)) != own:
        raise InputError(Problem(f"is a study of `pound {command}`", f"write `pound {command} {file}`", file))


def load_for(path: Path, kind: str) -> Any:
    """The study of a file as the workflow `kind` takes it.  Raises `InputError` with every problem and its place."""
    if WORKFLOWS[kind].solve:
        from pounding_cli.study.system_study import load_system

        return load_system(path, kind)
    from pounding_cli.study.study import load_study

    return load_study(path)
