"""Reading untrusted files: regular files only, and up to a limit."""

from __future__ import annotations

import difflib
import stat
from itertools import islice
from pathlib import Path

from pounding_cli.errors import InputError, Issue

MAX_PATH_LENGTH = 4096
"""Characters of a path."""


def shorten_path(path: object) -> str:
    """Return a path for messages: whole where it is short, its ends where it is not; bytes that are no text as \\x."""
    text = str(path).encode("utf-8", "backslashreplace").decode("utf-8")
    return text if len(text) <= 300 else f"{text[:100]} ... {text[-100:]}"


def has_signature(path: Path, sign: bytes) -> bool:
    """Return whether a regular file of any size can be read and begins with these bytes."""
    try:
        if not path.is_file():
            return False
        with path.open("rb") as file:
            return file.read(len(sign)) == sign
    except (OSError, ValueError):
        return False


def read_bytes(path: Path, most: int, what: str) -> bytes:
    """The content of a regular file of at most `most` bytes.

    what : what is read, e.g. "study file"

    Raises
    ------
    InputError : it is not there, with the nearest name; no regular file, too large, or cannot be read
    """
    hint = f"give the path of a {what} of at most {most / 1e6:g} MB"
    try:
        facts = path.stat()
        if stat.S_ISREG(facts.st_mode) and facts.st_size <= most:
            with path.open("rb") as file:
                return file.read(most)
        message = "this is not a regular file"
        if stat.S_ISREG(facts.st_mode):
            message = f"the file has {facts.st_size / 1e6:.3g} MB"
    except FileNotFoundError:
        message = "no such file"
        beside = [each.name for each in islice(path.parent.glob("*"), 1000)]
        with_suffix = [name for name in beside if name in (f"{path.name}.yaml", f"{path.name}.yml")]
        if near := with_suffix or difflib.get_close_matches(path.name, beside, 1, cutoff=0.8):
            hint = f"did you mean {shorten_path(path.parent / near[0])}?"
    except (OSError, ValueError) as error:  # a name that is too long, or holds a NUL
        message = f"cannot be read: {getattr(error, 'strerror', None) or error}"
    raise InputError(Issue((), message, hint, file=shorten_path(path).replace("\0", "\\0")))
