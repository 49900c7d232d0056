"""Opening results files: what is damaged, made to mislead or no results file at all is refused here, nowhere else."""

from __future__ import annotations

import errno
import io
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5py

from pounding_cli.errors import InputError, Problem
from pounding_cli.store.keys import FORMAT, FORMAT_VERSION
from pounding_cli.store.seal import Sealed, Unsealed, is_sealed, open_regular
from pounding_cli.store.structure import number
from pounding_cli.store.values import check_study

if TYPE_CHECKING:
    import xarray

_AGAIN = "run the study again: what is whole in the file is kept, the rest is solved"


class Damaged(InputError):
    """A results file whose bytes are not those that were written."""


@contextmanager
def opened(path: Path, any_version: bool = False) -> Iterator[h5py.File]:
    """A results file, open for reading; whatever is read is verified against its checksums.

    Parameters
    ----------
    path : the file
    any_version : open one of another format version or without checksums too; only its attributes are to be read

    Raises
    ------
    InputError : missing, a folder, a pipe or a device, not HDF5, not ours, damaged (`Damaged`), made to mislead, or
        (unless `any_version`) of another format version; also for what cannot be read while the file is open
    """
    with _content(path) as (file, seal, unsealed):
        if not _is_ours(file):
            raise InputError(
                Problem("is HDF5 but not a results file of pound", "give a file that pound run wrote", str(path))
            )
        if not any_version:
            if kind := file.attrs.get("kind"):
                hint = "its table, figures and page are in the folder of its name; xarray.open_dataset opens the file"
                raise InputError(Problem(f"holds results of `pound {kind}`", hint, str(path)))
            _check_version(path, number(file.attrs, "format_version"), str(file.attrs.get("workflow", "run")))
            if unsealed:
                raise _damaged(path, unsealed)
            _once(check_study, file, seal)
        yield file


@contextmanager
def opened_dataset(path: Path) -> Iterator[xarray.Dataset]:
    """A results file of `pound run` as xarray reads it, every byte verified; errors as those of `opened`."""
    import xarray

    with opened(path):
        pass  # refuses what leads to other files
    stream: Any = Sealed(path)
    with stream, _told(stream, path), xarray.open_dataset(stream, engine="h5netcdf", decode_times=False) as data:
        yield data


_checked: set[tuple[Callable[[h5py.File], object], bytes]] = set()
"""Checks of structure that this process has made, and of which files: a seal stands for the whole content."""


def _once(check: Callable[[h5py.File], object], file: h5py.File, seal: bytes) -> None:
    """Check the structure of a file, unless that was done; a report opens the same file some fifty times."""
    done = (check, seal)
    if done not in _checked:
        check(file)
        _checked.add(done)


def _check_version(path: Path, version: float, command: str) -> None:
    """Refuse a file of another format version than this program's."""
    if version < FORMAT_VERSION:
        what = f"has the older format version {version:g} (now {FORMAT_VERSION}), whose files carry no checksums"
        hint = f"run the study again with this program: pound {command} STUDY -o FILE.h5"
    elif version > FORMAT_VERSION:
        what = f"has the newer format version {version:g}; this program reads version {FORMAT_VERSION}"
        hint = "install the pounding_cli that wrote it, or a newer one"
    else:
        return
    raise InputError(Problem(what, hint, str(path)))


def is_results(path: Path) -> bool:
    """Whether a pound command wrote this file as its results, damaged since or not."""
    if is_sealed(path):
        return True
    try:
        with _content(path) as (file, *_):
            return _is_ours(file)
    except InputError:
        return False


def _is_ours(file: h5py.File) -> bool:
    """Whether a pound command wrote it; `kind` stands in what `pound connector` and `pound wall` write."""
    return file.attrs.get("format") == FORMAT or file.attrs.get("kind") in ("connector", "wall")


def damage_of(path: Path) -> str:
    """What is damaged in a results file, in words; "" where every byte is the one that was written. Reads all of it."""
    try:
        with Sealed(path) as sealed:
            sealed.verify()
            return ""
    except OSError as error:
        return error.strerror or _first_line(error)


@contextmanager
def _content(path: Path) -> Iterator[tuple[h5py.File, bytes, str]]:
    """The HDF5 content, its seal, and why it cannot be verified ("" where it is); what cannot be read is refused."""
    name = str(path)
    if os.path.isdir(path):  # False too for a path that is too long: opening it says so
        raise InputError(Problem("is a folder, not a results file", "name the .h5 file in it", name))
    stream: Sealed | io.FileIO
    unsealed = ""
    try:
        try:
            stream = Sealed(path)
        except Unsealed as error:
            stream, unsealed = io.FileIO(open_regular(path)), str(error.strerror)
    except FileNotFoundError:
        hint = "make one with: pound run STUDY -o FILE.h5"
        raise InputError(Problem("there is no such results file", hint, name)) from None
    except (OSError, ValueError) as error:
        hint = "give the file that pound run wrote"
        raise InputError(Problem(f"cannot be read: {_reason(error)}", hint, name)) from None
    with stream:
        try:
            file = h5py.File(stream, "r")
        except Exception as error:
            if isinstance(stream, Sealed) and stream.damage:
                raise _damaged(path, stream.damage) from None
            hint = "give the file that pound run wrote; if it was damaged, run the study again"
            raise InputError(Problem(f"cannot be read as HDF5 ({_first_line(error)})", hint, name)) from None
        with _told(stream, path), file:
            yield file, stream.foot if isinstance(stream, Sealed) else b"", unsealed


@contextmanager
def _told(stream: Sealed | io.FileIO, path: Path) -> Iterator[None]:
    """Whatever reading a file comes upon, as an `InputError` that names it."""
    try:
        yield
        if isinstance(stream, Sealed) and stream.damage:  # the HDF5 library may have gone on
            raise _damaged(path, stream.damage)
    except InputError as refused:
        if all(problem.file for problem in refused.problems):
            raise
        raise InputError([replace(p, file=p.file or str(path)) for p in refused.problems]) from None
    except Exception as error:
        if isinstance(stream, Sealed) and stream.damage:
            raise _damaged(path, stream.damage) from None
        if isinstance(error, OSError) and error.errno is not None:
            raise  # of a file that the caller writes meanwhile
        what = f"does not hold what results hold ({_first_line(error)})"
        hint = "give the file that pound run wrote, or run the study again"
        raise InputError(Problem(what, hint, str(path))) from error


def _damaged(path: Path, what: str) -> Damaged:
    return Damaged(Problem(f"is damaged: {what}", _AGAIN, str(path)))


_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
_SHUT = (errno.EROFS, errno.EACCES, errno.EPERM)


def refused_write(error: OSError, path: Path, parts: Path) -> InputError:
    """A write that failed while a run was at work, in words: what is on disk is whole, and the run can go on."""
    if error.errno in _FULL or "No space left" in str(error):
        what, first = "there is no space left", "free some"
    elif error.errno in _SHUT:
        what, first = "may not be written", "give yourself the right to"
    else:
        what, first = error.strerror or _first_line(error), "see to that"
    hint = f"{first}, then run the same command again: what was solved is kept in {parts}, and no file was damaged"
    return InputError(Problem(f"cannot write results: {what} ({error.filename or path.parent})", hint, str(path)))


def _reason(error: OSError | ValueError) -> str:
    return getattr(error, "strerror", None) or _first_line(error)


def _first_line(error: Exception) -> str:
    return str(error).splitlines()[0] if str(error) else type(error).__name__
