"""Check the places where commands write, before anything is computed."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterable
from pathlib import Path

from pounding_cli.errors import InputError, Issue

Mine = Callable[[Path, bytes], bool]
"""mine(path, head) -> whether a file that begins with `head` is an older output of the same kind."""

_SIGNS = {".png": b"\x89PNG", ".pdf": b"%PDF-", ".svg": b"<?xml", ".xlsx": b"PK\x03\x04"}
"""Suffix -> what a file of that kind begins with."""


def check_output(path: Path, inputs: Iterable[Path] = (), mine: Mine | None = None, option: str = "-o") -> None:
    """Make sure that a file can be written at `path`, and that nothing but an older output is lost; makes its folder.

    Parameters
    ----------
    path : the file
    inputs : what the command reads
    mine : tells an older output from any other file; by the suffix of `path` unless given
    option : of the command that names the file

    Raises
    ------
    InputError : the path is a folder, a device, one of `inputs`, or a file of another kind; its folder cannot be made
        or written
    """
    name = str(path)
    elsewhere = f"name another file with {option}"
    try:
        if path.is_dir():
            raise InputError(
                Issue((), "the output is a folder", f"name a file in it, e.g. {path / 'results.h5'}", file=name)
            )
        if path.exists():
            if not path.is_file():
                raise InputError(Issue((), "the output is not a regular file", elsewhere, file=name))
            if any(path.samefile(each) for each in inputs if each.exists()):
                raise InputError(Issue((), "the output is the file that this command reads", elsewhere, file=name))
            with path.open("rb") as stream:
                head = stream.read(4096)
            sign = _SIGNS.get(path.suffix.lower())
            if head and not (mine(path, head) if mine else sign and head.startswith(sign)):
                hint = f"it would be overwritten: choose another name with {option}, or move it away"
                raise InputError(Issue((), "the output exists and was not written by this command", hint, file=name))
    except OSError as error:  # a path that is too long
        raise InputError(Issue((), f"cannot be written: {error.strerror}", elsewhere, file=name)) from None
    check_folder(path.parent, path, option)


def check_folder(folder: Path, output: Path | None = None, option: str = "-o") -> None:
    """Make sure that files can be written in a folder; makes it.

    Parameters
    ----------
    folder : the folder
    output : what errors call the output; the folder unless given
    option : of the command that names the output

    Raises
    ------
    InputError : it is a file, or cannot be made or written
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):  # a name of its own: two commands may start at once
            pass
    except (OSError, ValueError) as error:
        reason = "it is a file" if isinstance(error, FileExistsError) else getattr(error, "strerror", None) or error
        what = f"the output folder {folder} cannot be written: {reason}"
        raise InputError(Issue((), what, f"choose another place with {option}", file=str(output or folder))) from None
