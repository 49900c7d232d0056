"""The catalogue of named motions: what is known of each, and where its samples are found.

A name is looked up first in the folders of the environment variable POUND_RECORDS, then in the user's own
folder (`user_folder`), then among the stand-ins that ship.  Motions from the first two are labelled "real",
shipped ones "stand-in"; the label travels with the motion into every table and figure.
"""

from __future__ import annotations

import difflib
import os
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import date
from fnmatch import fnmatch
from functools import cache
from pathlib import Path
from typing import Any

from pounding_cli.errors import InputError, Issue
from pounding_cli.records.declaration import Declaration
from pounding_cli.records.motion import Motion, arias
from pounding_cli.records.reading import read_file
from pounding_cli.units import GRAVITY


@dataclass(frozen=True)
class Entry:
    """One motion of the paper's Table 1, which prints `duration` [s] and `scale` [-].

    facts : as in the file, of the first `duration`; among them `peak_g` [g], `arias` [m/s], `dt_s` [s] of a motion at
        hand, and `of`: whether they were measured ("real") or estimated ("estimate") from `sources`
    files : patterns of names under which a raw file is known, each with how it is read
    """

    name: str
    title: str
    event: str
    date: date
    magnitude: float
    station: str
    component: str
    duration: float
    scale: float
    facts: Mapping[str, Any]
    sources: Sequence[str]
    files: Sequence[Mapping[str, Any]]

    def compare(self, motion: Motion) -> Iterator[str]:
        """Yield length, time step, peak and Arias intensity of a motion beside those of the catalogue, in words."""
        facts = self.facts
        window = motion.cut_to(self.duration)
        length = f"{window.duration:g} s"
        is_measured = facts["of"] == "real"
        origin = "measured on a public digitisation" if is_measured else "estimated from Table 1"
        yield f"length: {motion.duration:g} s; Table 1 uses {self.duration:g} s"
        step = f"; {facts['dt_s']:g} s {origin}" if "dt_s" in facts else ""
        yield f"time step: {motion.dt:g} s{step}"
        peak = f"{window.pga / GRAVITY:.3f} g in the first {length}"
        yield f"peak: {peak}; {facts['peak_g']:.3f} g {origin}"
        intensity = f"{arias(window):.3f} m/s in the first {length}"
        yield f"Arias intensity: {intensity}; {facts['arias']:.3f} m/s {origin}"


def shipped_folder() -> Path:
    """Folder of the catalogue and the stand-ins: inside an installed package, or at the top of a checkout."""
    package = Path(__file__).resolve().parents[1]
    installed = package / "data" / "records"
    return installed if installed.is_dir() else package.parent / "records"


def user_folder() -> Path:
    """The user's own motions: POUND_HOME/records, or `pound/records` in the platform's data folder."""
    if home := os.environ.get("POUND_HOME"):
        return Path(home).expanduser() / "records"
    base = os.environ.get("XDG_DATA_HOME") or "~/.local/share"
    if sys.platform == "win32":
        base = os.environ.get("LOCALAPPDATA") or "~/AppData/Local"
    elif sys.platform == "darwin":
        base = "~/Library/Application Support"
    return Path(base).expanduser() / "pound" / "records"


def real_folders() -> Iterator[Path]:
    """The folders named by POUND_RECORDS, in order; raises `InputError` for one that is not there."""
    for part in filter(str.strip, os.environ.get("POUND_RECORDS", "").split(os.pathsep)):
        folder = Path(part.strip()).expanduser()
        if not folder.is_dir():
            hint = "set POUND_RECORDS to a folder with motion files, or unset it"
            raise InputError(f"POUND_RECORDS names '{folder}', which is not a folder", hint)
        yield folder


@cache
def load_catalogue() -> Mapping[str, Entry]:
    """Every entry by name, in the order of Table 1."""
    import yaml

    loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
    entries = {}
    for name, facts in yaml.load((shipped_folder() / "catalogue.yaml").read_bytes(), Loader=loader)["motions"].items():
        table_row = facts.pop("table1")
        _ = facts.pop("stand_in")
        entries[name] = Entry(name, duration=float(table_row["duration_s"]), scale=table_row["scale"], **facts)
    return entries


def list_names() -> tuple[str, ...]:
    """Names of the catalogue, in the order of Table 1."""
    return tuple(load_catalogue())


def get_entry(name: str, set_names: Iterable[str] = ()) -> Entry:
    """Return the catalogue entry of `name`; raises `InputError` with the nearest name for an unknown one.

    set_names : sets of motions that may stand in place of a name, and may be meant
    """
    entries = load_catalogue()
    if name in entries:
        return entries[name]
    names = (*entries, *set_names)
    near = difflib.get_close_matches(name.lower().replace(" ", ""), names, n=1, cutoff=0.5)
    hint = f"did you mean '{near[0]}'? " if near else ""
    hint += f"known: {', '.join(names)}; for a file of your own write {{file: path/to/motion.AT2}}"
    raise InputError(f"no motion '{name}' in the catalogue", hint)


def locate_motion(name: str) -> tuple[Path, str, Mapping[str, Any]]:
    """Return the source of the samples of catalogue motion `name`: the file, its label, and how it is read.

    Raises `InputError` for an unknown name, and where two files of one folder both look like the motion.
    """
    patterns = get_entry(name).files
    for folder in real_folders():
        for hint in patterns:
            matches = [path for path in sorted(folder.iterdir()) if fnmatch(path.name.lower(), hint["pattern"])]
            if len(matches) > 1:
                message = f"more than one file looks like '{name}': {', '.join(path.name for path in matches)}"
                way_out = "leave one of them there, or name the file in the study: {file: ...}"
                raise InputError(Issue((), message, way_out, file=str(folder)))
            if matches:
                return matches[0], "real", {key: value for key, value in hint.items() if key != "pattern"}
    user_file = user_folder() / f"{name}.txt"
    if user_file.is_file():
        return user_file, "real", {}
    return shipped_folder() / f"{name}.txt", "stand-in", {}


def load_motion(name: str) -> Motion:
    """Return the catalogue motion `name`, whole, with its label in `Motion.source`: "real" or "stand-in".

    Raises `InputError` for an unknown name (with the nearest) or a file that cannot be read.
    """
    path, source, options = locate_motion(name)
    return read_file(path, Declaration(**options), name=name, source=source).motion


def save_motion(name: str, motion: Motion, origin: Path) -> Path:
    """Write a real motion into the user's folder as catalogue motion `name`, in m/s2 and in full: reading the file
    gives the very motion back.  The file."""
    details = get_entry(name)
    path = user_folder() / f"{name}.txt"
    head = (
        f"# motion: {details.title}\n# event: {details.event}, {details.date.isoformat()}\n"
        f"# station: {details.station}, {details.component}\n# imported from: {origin.name}\n# name: {name}\n"
        f"# unit: m/s2\n# dt: {motion.dt!r} s\n# samples: {motion.acceleration.size}\n"
    )
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(head + "".join(f"{float(each)!r}\n" for each in motion.acceleration), encoding="utf-8")
    return path
