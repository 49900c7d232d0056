"""Reading untrusted files: regular files only, and up to a limit."""

from __future__ import annotations

import os
import stat
from pathlib import Path

from pounding_cli.errors import InputError, Problem

LONGEST_PATH = 4096
"""Characters of a path."""


def shortened(path: object) -> str:
    """A path for messages: whole where it is short, its ends where it is not; bytes that are no text as \\x."""
    text = str(path).encode("utf-8", "backslashreplace").decode("utf-8")
    return text if len(text) <= 300 else f"{text[:100]} ... {text[-100:]}"


def read_bytes(path: Path, most: int, what: str) -> bytes:
    """The content of a regular file of at most `most` bytes.

    what : what is read, e.g. "study file"

    Raises
    ------
    InputError : a pipe, device or socket, or too large a file
    OSError, ValueError : it is not there, or cannot be read
    """
    wrong, hint = "", f"a {what} has at most {most / 1e6:g} MB"
    if len(os.fspath(path)) > LONGEST_PATH:
        wrong, hint = f"the path has {len(os.fspath(path))} characters", "no path is that long"
    elif not path.is_dir() and not stat.S_ISREG((facts := path.stat()).st_mode):
        wrong, hint = "this is not a regular file", f"name a {what} on disk"
    elif not path.is_dir() and facts.st_size > most:
        wrong = f"the file has {facts.st_size / 1e6:.3g} MB"
    if wrong:
        raise InputError(Problem(wrong, hint, shortened(path)))
    with path.open("rb") as file:
        return file.read(most)
