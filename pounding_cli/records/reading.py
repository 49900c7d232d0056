"""Read a motion file: find its format, read its samples, settle their unit, refuse what cannot be a motion."""

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

MAX_PEAK = 5.0 * GRAVITY
"""The strongest ground accelerations ever recorded lie between 3 and 5 g; above that the unit is wrong [m/s2]."""

MAX_USUAL_STEP = 0.05
"""Accelerographs sample at 50 Hz at least; a longer step is most often a sample number taken for a time [s]."""


@dataclass(frozen=True)
class Reading:
    """A motion and how it was read.

    motion : the motion
    format : one of `MOTION_FORMATS`
    unit : unit in which its samples were read
    words : that unit and where it comes from: "in g (as the file says)"
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
        hint = f"write one of {', '.join(ACCELERATION_UNITS)}, or 0.01 g"
        raise text.refuse(f"unknown unit '{unit}' of acceleration", hint)
    file_format, samples = _read_samples(text, format)
    used_unit, why, stated_unit = _choose_unit(text, file_format, samples, unit)
    acceleration = _convert_samples(text, samples, used_unit)
    name_in_file, _ = text.header.get("name", ("", 0))
    motion = Motion(name or name_in_file or Path(path).stem, samples.dt, acceleration, source)
    encoding = f", a file in {text.encoding}" if text.encoding else ""
    words = f"in {used_unit} ({why}){encoding}"
    doubts = tuple(_iter_doubts(samples))
    return Reading(motion, file_format, used_unit, words, stated_unit, doubts)


def _iter_doubts(samples: Samples) -> Iterator[MotionWarning]:
    """Yield warnings about a time step that no accelerograph has, or that is not the header's."""
    if samples.doubt is not None:
        yield samples.doubt
    if samples.dt > MAX_USUAL_STEP * (1 + 1e-6):
        message = f"the time step is {samples.dt:g} s, longer than the {MAX_USUAL_STEP:g} s of any accelerograph"
        hint = "check that the column of times is no sample number; write `dt: 0.01 s` beside `file:` if it is"
        yield MotionWarning(message, hint)


def _read_samples(text: TextFile, format: str | None) -> tuple[str, Samples]:
    """Return the format of a file and its samples.

    Raises
    ------
    InputError : the file is not of the format given or of one that is read, or a channel or column is selected in a
        format without them
    """
    file_format = ""
    samples = None
    for name, read in NETWORKS.items():
        if format in (None, name):
            samples = read(text)
            if samples:
                file_format = name
                break
    if not samples:
        if format not in (None, *COLUMN_FORMATS):
            hint = f"leave 'format' out, or write one of {', '.join(MOTION_FORMATS)}"
            message = f"its first lines are not those of a file of format '{format}'"
            raise text.refuse(message, hint, 1)
        unread = find_unread(text) if format is None else None
        if unread:
            raise _refuse_unread(text, *unread)
        file_format, samples = read_columns(text, format)
    if text.channel is not None and file_format not in FORMATS_WITH_CHANNELS:
        raise _refuse_selection(text, file_format, "channel")
    if text.column is not None and file_format != "table":
        raise _refuse_selection(text, file_format, "column")
    return file_format, samples


def _refuse_selection(text: TextFile, file_format: str, key: str) -> InputError:
    """Return the refusal of a channel or column in a format that has none to choose from."""
    message = f"a file of format '{file_format}' has no {key}s to choose from"
    return text.refuse(message, f"leave '{key}' out")


def _refuse_unread(text: TextFile, name: str, line: int) -> InputError:
    """Return the refusal of a format that is known but not read."""
    example = "{file: a.txt, format: column, unit: cm/s2, dt: 0.01 s}"
    hint = f"export the acceleration as columns of text and give format, unit, dt: {example}"
    return text.refuse(f"the format is {name}, which is not read", hint, line)


def _choose_unit(
    text: TextFile,
    file_format: str,
    samples: Samples,
    users_unit: str | None,
) -> tuple[str, str, str]:
    """Return the unit of the samples, the reason in words, and another one that headings state, "" for none.

    Raises
    ------
    InputError : no unit, a unit of another quantity, or one of the user that contradicts a format which defines its own
    """
    stated = samples.unit
    line = samples.unit_line
    if stated is None:
        if users_unit is None:
            message = samples.unclear or "no line says in which unit the values are"
            raise text.refuse(message, GIVE_UNIT, samples.unclear_line or samples.line)
        return users_unit, "as given", ""
    quantity, _ = identify_unit(stated)
    factor = find_acceleration_unit(stated)
    if quantity in ("velocity", "displacement"):
        raise text.refuse_quantity(quantity, line)
    if quantity == "counts":
        if users_unit is None:
            hint = "download the processed record (V1 or V2), or say what one count is, e.g. unit: 6.34e-4 gal"
            raise text.refuse("the file holds recorder counts without their scale", hint, line)
        return users_unit, "as given", ""
    if factor is None:
        if users_unit is not None:
            return users_unit, f"as given, although the file says {stated}", stated
        message = f"the file's unit '{stated}' is none of acceleration that is known"
        hint = f"{GIVE_UNIT}; known are {', '.join(ACCELERATION_UNITS)}"
        raise text.refuse(message, hint, line)
    if users_unit is None:
        return stated, "as the file says", ""
    users_factor = find_acceleration_unit(users_unit) or 0.0
    if abs(users_factor / factor - 1.0) <= 1e-4:
        return stated, "as the file says", ""
    if file_format in NETWORKS:
        message = f"the unit is given as {users_unit}, but the file says {stated}"
        raise text.refuse(message, "leave the unit out, or correct the file's", line)
    return users_unit, f"as given, although the file says {stated}", stated


def _convert_samples(text: TextFile, samples: Samples, unit: str) -> np.ndarray:
    """Return the samples in m/s2, shape (n,).

    Raises
    ------
    InputError : they can be no ground motion
    """
    with np.errstate(over="ignore"):
        values = np.array(samples.values, dtype=float) * (find_acceleration_unit(unit) or 0.0)
    if values.size < 2:
        hint = "a motion needs at least two samples"
        raise text.refuse("only one sample found", hint, samples.line)
    peak = float(np.abs(values).max())
    if peak == 0.0:
        hint = "give a file that holds a ground motion"
        raise text.refuse("every sample is zero", hint, samples.line)
    if peak > MAX_PEAK:
        peak_in_g = f"{peak / GRAVITY:.4g} g"
        message = f"the peak is {peak_in_g} read in {unit}: no ground motion is that strong"
        units = ", ".join(ACCELERATION_UNITS)
        hint = f"give the unit of the file: {units}; recorder counts need their scale, e.g. 6.34e-4 gal"
        raise text.refuse(message, hint, samples.line)
    return values
