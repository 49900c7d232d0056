"""Reading a motion file: its format found, its samples read, its unit settled, what cannot be a motion refused."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pounding_cli.errors import InputError
from pounding_cli.records.columns import COLUMN_FORMATS, GIVE_UNIT, read_columns
from pounding_cli.records.formats import FORMATS_WITH_CHANNELS, NETWORKS, find_unread
from pounding_cli.records.motion import GRAVITY, Motion
from pounding_cli.records.text import MotionWarning, Samples, TextFile, load_text
from pounding_cli.records.units import ACCELERATION_UNITS, find_acceleration_unit, identify_unit

MOTION_FORMATS = (*NETWORKS, *COLUMN_FORMATS)
"""The formats, as users name them."""

_STRONGEST = 5.0 * GRAVITY
# The strongest ground accelerations ever recorded lie between 3 and 5 g; above that the unit is wrong.
_LONGEST_STEP = 0.05
# Accelerographs sample at 50 Hz at least; a longer step [s] is most often a sample number taken for a time.


@dataclass(frozen=True)
class Reading:
    """A motion and how it was read.

    words : its unit and where that comes from: "in g (as the file says)"
    stated : the other unit that the file states where the unit given is not that, else ""
    doubts : warnings about its time step
    """

    motion: Motion
    format: str
    unit: str
    words: str
    stated: str = ""
    doubts: tuple[MotionWarning, ...] = ()


def read_file(
    path: str | Path,
    *,
    name: str | None = None,
    unit: str | None = None,
    dt: float | None = None,
    format: str | None = None,
    channel: int | None = None,
    column: int | None = None,
    source: str = "user",
) -> Reading:
    """Read a ground motion from a text file, and say how it was read.

    Parameters
    ----------
    path : the file
    name : what to call the motion; the file's own `# name:` line or its stem unless given
    unit : unit of the acceleration (`records.units`); needed only where the file does not state it. In plain columns
        it comes before what the headings say. Elsewhere it is refused where it contradicts the file
    dt : time step [s]; needed where the file does not state it, otherwise checked against the file's own
    format : one of `MOTION_FORMATS`; default: detected
    channel : which channel of a file that holds several (COSMOS, CSMIP, GeoNet, ASA), from 1
    column : which column of a table holds the acceleration, from 1
    source : label of the motion

    Raises
    ------
    InputError : with file and line, for a file that is missing, empty or not text, a value that is no number, uneven
        or falling times, a count or peak other than the header's, a missing or contradicting time step or unit, a
        format that is known but not read, velocities, displacements, counts without a scale, and a peak above 5 g
        (a wrong unit)
    """
    text = load_text(Path(path))
    text.dt = dt
    text.channel = channel
    text.column = column
    text.unit = unit
    if unit is not None and find_acceleration_unit(unit) is None:
        raise text.refuse(
            f"unknown unit '{unit}' of acceleration", f"write one of {', '.join(ACCELERATION_UNITS)}, or 0.01 g"
        )
    kind, samples = _samples(text, format)
    used, why, stated = _unit(text, kind, samples, unit)
    said, _ = text.header.get("name", ("", 0))
    motion = Motion(name or said or Path(path).stem, samples.dt, _sound(text, samples, used), source)
    encoding = f", a file in {text.encoding}" if text.encoding else ""
    return Reading(motion, kind, used, f"in {used} ({why}){encoding}", stated, tuple(_find_doubts(samples)))


def _find_doubts(samples: Samples) -> Iterator[MotionWarning]:
    """Yield warnings about a time step that no accelerograph has, or that is not the header's."""
    if samples.doubt is not None:
        yield samples.doubt
    if samples.dt > _LONGEST_STEP * (1 + 1e-6):
        message = f"the time step is {samples.dt:g} s, longer than the {_LONGEST_STEP:g} s of any accelerograph"
        yield MotionWarning(
            message, "check that the column of times is no sample number; write `dt: 0.01 s` beside `file:` if it is"
        )


def _samples(text: TextFile, format: str | None) -> tuple[str, Samples]:
    """The format of a file and what it holds; raises `InputError` for channels and columns that it does not have."""
    tried = ((name, read(text)) for name, read in NETWORKS.items() if format in (None, name))
    kind, found = next(((name, found) for name, found in tried if found), ("", None))
    if found is None and format not in (None, *COLUMN_FORMATS):
        hint = f"leave 'format' out, or write one of {', '.join(MOTION_FORMATS)}"
        raise text.refuse(f"its first lines are not those of a file of format '{format}'", hint, 1)
    if found is None and format is None and (unread := find_unread(text)):
        raise _refuse_unread(text, *unread)
    if found is None:
        kind, found = read_columns(text, format)
    for given, what, kinds in ((text.channel, "channel", FORMATS_WITH_CHANNELS), (text.column, "column", ("table",))):
        if given is not None and kind not in kinds:
            raise text.refuse(f"a file of format '{kind}' has no {what}s to choose from", f"leave '{what}' out")
    return kind, found


def _refuse_unread(text: TextFile, name: str, line: int) -> InputError:
    example = "{file: a.txt, format: column, unit: cm/s2, dt: 0.01 s}"
    hint = f"export the acceleration as columns of text and give format, unit, dt: {example}"
    return text.refuse(f"the format is {name}, which is not read", hint, line)


def _unit(text: TextFile, kind: str, samples: Samples, given: str | None) -> tuple[str, str, str]:
    """The unit the samples are in, who says so, and another one that headings state, "" for none.

    Raises `InputError` for other quantities, and where a format that defines its unit contradicts the one given.
    """
    stated = samples.unit
    line = samples.unit_line
    if stated is None:
        if given is None:
            message = samples.unclear or "no line says in which unit the values are"
            raise text.refuse(message, GIVE_UNIT, samples.unclear_line or samples.line)
        return given, "as given", ""
    quantity = identify_unit(stated)[0]
    factor = find_acceleration_unit(stated)
    if quantity in ("velocity", "displacement"):
        raise text.refuse_quantity(quantity, line)
    if quantity == "counts":
        if given is None:
            hint = "download the processed record (V1 or V2), or say what one count is, e.g. unit: 6.34e-4 gal"
            raise text.refuse("the file holds recorder counts without their scale", hint, line)
        return given, "as given", ""
    if factor is None:
        if given is not None:
            return given, f"as given, although the file says {stated}", stated
        hint = f"{GIVE_UNIT}; known are {', '.join(ACCELERATION_UNITS)}"
        raise text.refuse(f"the file's unit '{stated}' is none of acceleration that is known", hint, line)
    if given is None or abs((find_acceleration_unit(given) or 0.0) / factor - 1.0) <= 1e-4:
        return stated, "as the file says", ""
    if kind in NETWORKS:
        hint = "leave the unit out, or correct the file's"
        raise text.refuse(f"the unit is given as {given}, but the file says {stated}", hint, line)
    return given, f"as given, although the file says {stated}", stated


def _sound(text: TextFile, samples: Samples, unit: str) -> np.ndarray:
    """The samples in m/s2; raises `InputError` where they can be no ground motion."""
    with np.errstate(over="ignore"):
        values = np.array(samples.values, dtype=float) * (find_acceleration_unit(unit) or 0.0)
    if values.size < 2:
        raise text.refuse("only one sample found", "a motion needs at least two samples", samples.line)
    peak = float(np.abs(values).max())
    if peak == 0.0:
        raise text.refuse("every sample is zero", "give a file that holds a ground motion", samples.line)
    if peak > _STRONGEST:
        message = f"the peak is {peak / GRAVITY:.4g} g read in {unit}: no ground motion is that strong"
        units = ", ".join(ACCELERATION_UNITS)
        hint = f"give the unit of the file: {units}; recorder counts need their scale, e.g. 6.34e-4 gal"
        raise text.refuse(message, hint, samples.line)
    return values
