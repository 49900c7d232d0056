"""The catalogue of named motions: what is known of each, and where its samples are found.

A name is looked up first in the folders of the environment variable POUND_RECORDS, then in the user's own
folder (`user_folder`), then among the stand-ins that ship.  Motions from the first two are labelled "real",
shipped ones "stand-in"; the label travels with the motion into every table and figure.
"""

from __future__ import annotations

import difflib
import os
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import date
from fnmatch import fnmatch
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Any

from pounding_cli.errors import InputError, Problem
from pounding_cli.records.motion import GRAVITY, Motion
from pounding_cli.records.readers import read_motion

RECORDS_VARIABLE = "POUND_RECORDS"
"""Environment variable: folders with real motions, separated as in PATH."""

HOME_VARIABLE = "POUND_HOME"
"""Environment variable: replaces the user's data folder."""


@dataclass(frozen=True)
class Facts:
    """Facts of a motion within its window, or, for one not at hand, what its stand-in aims at (SI).

    `spectrum` is the 5 % damped pseudo-acceleration [m/s2] at `periods` [s]; `husid_times` [s] are where the
    Husid curve passes `husid_fractions`.  `dt`, `samples` and `arias_whole` are None where no digitisation is
    at hand.
    """

    pga: float
    arias: float
    significant_duration: float
    husid_fractions: tuple[float, ...]
    husid_times: tuple[float, ...]
    periods: tuple[float, ...]
    spectrum: tuple[float, ...]
    pgv: float | None = None
    dt: float | None = None
    samples: int | None = None
    arias_whole: float | None = None


@dataclass(frozen=True)
class FileHint:
    """How to know a raw file of this motion by its name, and how to read it."""

    pattern: str
    unit: str | None = None
    dt: float | None = None
    format: str | None = None


@dataclass(frozen=True)
class Entry:
    """One motion of the paper's Table 1.

    `peak` [m/s2], `duration` [s] and `scale` [-] are what Table 1 prints; `facts` says more, and `facts_of`
    whether they were measured on the real motion ("real") or estimated ("estimate"), from `sources`.
    `seed` and `step` [s] are those of the shipped stand-in.
    """

    name: str
    title: str
    event: str
    date: date
    magnitude: float
    station: str
    component: str
    peak: float
    duration: float
    scale: float
    facts: Facts
    facts_of: str
    seed: int
    step: float
    sources: tuple[str, ...] = ()
    files: tuple[FileHint, ...] = field(default_factory=tuple)


@dataclass(frozen=True)
class Place:
    """Where a catalogue name is found: the file, its label, and how to read it."""

    path: Path
    source: str
    hint: FileHint


def shipped_folder() -> Path:
    """Folder of the catalogue and the stand-ins: inside an installed package, or at the top of a checkout."""
    package = Path(__file__).resolve().parents[1]
    installed = package / "data" / "records"
    return installed if installed.is_dir() else package.parent / "records"


def user_folder() -> Path:
    """The user's own motions: POUND_HOME/records, or `pound/records` in the platform's data folder."""
    home = os.environ.get(HOME_VARIABLE)
    if home:
        return Path(home).expanduser() / "records"
    if sys.platform == "win32":
        base = Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
    elif sys.platform == "darwin":
        base = Path.home() / "Library" / "Application Support"
    else:
        base = Path(os.environ.get("XDG_DATA_HOME") or Path.home() / ".local" / "share")
    return base / "pound" / "records"


def real_folders() -> tuple[Path, ...]:
    """The folders named by POUND_RECORDS, in order; raises `InputError` for one that is not there."""
    folders = []
    for part in os.environ.get(RECORDS_VARIABLE, "").split(os.pathsep):
        if not part.strip():
            continue
        folder = Path(part.strip()).expanduser()
        if not folder.is_dir():
            raise InputError(
                Problem(
                    f"{RECORDS_VARIABLE} names '{folder}', which is not a folder",
                    f"set {RECORDS_VARIABLE} to a folder with motion files, or unset it",
                )
            )
        folders.append(folder)
    return tuple(folders)


@cache
def catalogue() -> Mapping[str, Entry]:
    """Every entry by name, in the order of Table 1."""
    import yaml

    path = shipped_folder() / "catalogue.yaml"
    loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
    with path.open(encoding="utf-8") as stream:
        raw = yaml.load(stream, Loader=loader)
    return MappingProxyType({name: _entry(name, told) for name, told in raw["motions"].items()})


def names() -> tuple[str, ...]:
    """Names of the catalogue, in the order of Table 1."""
    return tuple(catalogue())


def entry(name: str) -> Entry:
    """What the catalogue knows of `name`; raises `InputError` with the nearest name for an unknown one."""
    known = catalogue()
    if name in known:
        return known[name]
    near = difflib.get_close_matches(name.lower().replace(" ", ""), known, n=1, cutoff=0.5)
    hint = f"did you mean '{near[0]}'? " if near else ""
    raise InputError(
        Problem(
            f"no motion '{name}' in the catalogue",
            f"{hint}known: {', '.join(known)}; for a file of your own write {{file: path/to/motion.AT2}}",
        )
    )


def locate(name: str) -> Place:
    """Where the samples of catalogue motion `name` come from.

    Raises `InputError` for an unknown name, and where two files of one folder both look like the motion.
    """
    wanted = entry(name)
    for folder in real_folders():
        for hint in wanted.files:
            found = [path for path in sorted(folder.iterdir()) if fnmatch(path.name.lower(), hint.pattern)]
            if len(found) > 1:
                raise InputError(
                    Problem(
                        f"more than one file looks like '{name}': {', '.join(path.name for path in found)}",
                        "leave one of them there, or name the file in the study: {file: ...}",
                        str(folder),
                    )
                )
            if found:
                return Place(found[0], "real", hint)
    own = user_folder() / f"{name}.txt"
    if own.is_file():
        return Place(own, "real", FileHint(own.name))
    return Place(shipped_folder() / f"{name}.txt", "stand-in", FileHint(f"{name}.txt"))


def find(name: str) -> Motion:
    """The catalogue motion `name`, whole, with its label in `Motion.source`: "real" or "stand-in".

    Raises `InputError` for an unknown name (with the nearest) or a file that cannot be read.
    """
    place = locate(name)
    hint = place.hint
    return read_motion(place.path, name=name, unit=hint.unit, dt=hint.dt, format=hint.format, source=place.source)


def _entry(name: str, told: dict[str, Any]) -> Entry:
    facts = dict(told["facts"])
    return Entry(
        name=name,
        title=told["title"],
        event=told["event"],
        date=told["date"],
        magnitude=told["magnitude"],
        station=told["station"],
        component=told["component"],
        peak=told["table1"]["peak_g"] * GRAVITY,
        duration=float(told["table1"]["duration_s"]),
        scale=told["table1"]["scale"],
        facts=Facts(
            pga=facts["peak_g"] * GRAVITY,
            arias=facts["arias"],
            significant_duration=facts["d5_95_s"],
            husid_fractions=tuple(facts["husid"]),
            husid_times=tuple(facts["husid"].values()),
            periods=tuple(facts["spectrum_g"]),
            spectrum=tuple(value * GRAVITY for value in facts["spectrum_g"].values()),
            pgv=facts.get("pgv"),
            dt=facts.get("dt_s"),
            samples=facts.get("samples"),
            arias_whole=facts.get("arias_whole"),
        ),
        facts_of=facts["of"],
        seed=told["stand_in"]["seed"],
        step=told["stand_in"]["dt_s"],
        sources=tuple(told["sources"]),
        files=tuple(FileHint(**hint) for hint in told.get("files", ())),
    )
