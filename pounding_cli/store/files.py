"""Opening results files, and refusing what is not one."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import h5py

from pounding_cli.errors import InputError, Problem
from pounding_cli.store.keys import FORMAT, FORMAT_VERSION


@contextmanager
def opened(path: Path, any_version: bool = False) -> Iterator[h5py.File]:
    """A results file, open for reading.

    Raises
    ------
    InputError : missing, a folder, not HDF5, not ours, or (unless `any_version`) of another format version
    """
    name = str(path)
    if not path.exists():
        raise InputError(Problem("there is no such results file", "make one with: pound run STUDY -o FILE.h5", name))
    if path.is_dir():
        raise InputError(Problem("is a folder, not a results file", "name the .h5 file in it", name))
    try:
        file = h5py.File(path, "r")
    except OSError as error:
        advice = "give the file that pound run wrote; if it was damaged, run the study again"
        raise InputError(Problem(f"cannot be read as HDF5 ({_first_line(error)})", advice, name)) from None
    with file:
        if file.attrs.get("format") != FORMAT:
            advice = "give a file that pound run wrote"
            raise InputError(Problem("is HDF5 but not a results file of pound", advice, name))
        version = int(file.attrs.get("format_version", 0))
        if version != FORMAT_VERSION and not any_version:
            raise InputError(
                Problem(
                    f"has format version {version}, this program reads version {FORMAT_VERSION}",
                    "run the study again with this program: pound run STUDY -o FILE.h5",
                    name,
                )
            )
        yield file


def check_output(path: Path) -> None:
    """Make sure that results can be written at `path`, before anything is simulated; makes the folder.

    Raises
    ------
    InputError : a folder stands there, or another file; the folder cannot be made or written
    """
    name = str(path)
    if path.is_dir():
        raise InputError(Problem("the output is a folder", f"name a file, e.g. {path / 'results.h5'}", name))
    if path.exists():
        try:
            with opened(path, any_version=True):
                pass
        except InputError:
            advice = "it would be overwritten: choose another name, or move it away"
            raise InputError(Problem("the output exists and is not a results file of pound", advice, name)) from None
    advice = "choose another place with -o FILE.h5"
    probe = path.with_name(f".{path.name}.probe")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        probe.touch()
        probe.unlink()
    except OSError as error:
        what = f"the output folder {path.parent} cannot be written ({error.strerror or error})"
        raise InputError(Problem(what, advice, name)) from None


def _first_line(error: Exception) -> str:
    return str(error).splitlines()[0] if str(error) else type(error).__name__
