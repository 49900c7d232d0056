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


def check_regular(path: Path, most: int, what: str) -> None:
    """Refuse what is no regular file of at most `most` bytes; a file that is not there is left to who opens it.

    what : what is read, e.g. "study"

    Raises
    ------
    InputError : a pipe, device, socket or too large a file
    """
    shown = shortened(path)
    if len(os.fspath(path)) > LONGEST_PATH:
        raise InputError(Problem(f"the path has {len(os.fspath(path))} characters", "no path is that long", shown))
    try:
        facts = path.stat()
    except (OSError, ValueError):
        return
    if stat.S_ISDIR(facts.st_mode):
        return
    if not stat.S_ISREG(facts.st_mode):
        raise InputError(
            Problem(f"this is not a regular file: {_kind(facts.st_mode)}", f"name a {what} on disk", shown)
        )
    if facts.st_size > most:
        size = f"{facts.st_size / 1e6:.3g} MB"
        hint = f"a {what} has at most {most / 1e6:g} MB"
        raise InputError(Problem(f"the file has {size}", hint, shown))


def read_bytes(path: Path, most: int, what: str) -> bytes:
    """The content of a regular file of at most `most` bytes.

    Raises
    ------
    InputError : as `check_regular`
    OSError, ValueError : it is not there, or cannot be read
    """
    check_regular(path, most, what)
    with path.open("rb") as file:
        return file.read(most)


def _kind(mode: int) -> str:
    kinds = {stat.S_IFIFO: "a pipe", stat.S_IFCHR: "a device", stat.S_IFBLK: "a device", stat.S_IFSOCK: "a socket"}
    return kinds.get(stat.S_IFMT(mode), "a special file")
