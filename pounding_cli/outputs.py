"""Where a command may write: one check for all of them, made before anything is computed."""

from __future__ import annotations

import contextlib
import tempfile
from collections.abc import Callable, Iterable
from pathlib import Path

from pounding_cli.errors import InputError, Problem

Mine = Callable[[Path, bytes], bool]
"""mine(path, head) -> whether a file that begins with `head` is an older output of the same kind."""

_HEAD = 4096

_SIGNS: dict[str, tuple[bytes, ...]] = {
    ".png": (b"\x89PNG\r\n\x1a\n",),
    ".gif": (b"GIF87a", b"GIF89a"),
    ".pdf": (b"%PDF-",),
    ".svg": (b"<?xml", b"<svg"),
    ".xlsx": (b"PK\x03\x04",),
    ".parquet": (b"PAR1",),
}
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
        with contextlib.suppress(FileNotFoundError, NotADirectoryError):
            path.stat()  # raises for what no file can be called
        if path.is_dir():
            raise InputError(Problem("the output is a folder", f"name a file in it, e.g. {path / 'results.h5'}", name))
        if path.exists():
            if not path.is_file():
                raise InputError(Problem("the output is not a regular file", elsewhere, name))
            if any(path.samefile(each) for each in inputs if each.exists()):
                raise InputError(Problem("the output is the file that this command reads", elsewhere, name))
            with path.open("rb") as stream:
                head = stream.read(_HEAD)
            if head and not (mine or _by_suffix)(path, head):
                hint = f"it would be overwritten: choose another name with {option}, or move it away"
                raise InputError(Problem("the output exists and was not written by this command", hint, name))
        check_folder(path.parent, path, option)
    except InputError:  # a ValueError too
        raise
    except (OSError, ValueError) as error:  # a path that is too long, or holds a NUL
        raise InputError(
            Problem(f"cannot be written: {_reason(error)}", f"name another place with {option}", name)
        ) from None


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
        what = f"the output folder {folder} cannot be written ({_reason(error)})"
        raise InputError(Problem(what, f"choose another place with {option}", str(output or folder))) from None


def _by_suffix(path: Path, head: bytes) -> bool:
    suffix = path.suffix.lower()
    return head.startswith(_SIGNS.get(suffix, ())) or (suffix == ".mp4" and head[4:8] == b"ftyp")


def _reason(error: OSError | ValueError) -> str:
    return getattr(error, "strerror", None) or str(error)
