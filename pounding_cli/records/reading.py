"""Read a motion file: an instrument's format strictly, any other as it is declared; show what was taken."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from pounding_cli.cells import CurableError, TextFile, load_text
from pounding_cli.errors import InputError, Issue
from pounding_cli.numbers import pluralize
from pounding_cli.records.checks import MAX_PEAK as MAX_PEAK  # others take it from here
from pounding_cli.records.checks import check_motion, check_samples
from pounding_cli.records.declaration import BASELINES, MEAN, SEPARATOR_NAMES, UNKNOWN_STEP, Declaration
from pounding_cli.records.formats import FORMATS, FORMATS_WITH_CHANNELS
from pounding_cli.records.instrument import InstrumentFile
from pounding_cli.records.motion import Motion
from pounding_cli.records.plain import read_plain
from pounding_cli.records.proposal import UNKNOWN_UNIT, propose
from pounding_cli.records.samples import Samples
from pounding_cli.records.units import ACCELERATION_UNITS, find_acceleration_unit, find_quantity
from pounding_cli.units import GRAVITY

PLAIN = "plain"
"""How a file that is of no instrument's format is called."""

MOTION_FORMATS = tuple(FORMATS)
"""The formats that say unit and time step themselves, as users name them."""

_ONLY_PLAIN = ("time", "column", "skip", "rows", "separator", "decimal", "thousands")
# Keys that say how the rows of a plain file are written.

QUOTED_LINES = 3
"""Lines that were not read of which the words are shown."""


@dataclass(frozen=True)
class Reading:
    """A motion and how it was read.

    motion : the motion
    format : one of `MOTION_FORMATS`, or PLAIN
    lines : what was taken: values, step, unit, peak and its time; then the lines that were not read
    doubts : warnings about it
    """

    motion: Motion
    format: str
    lines: tuple[str, ...]
    doubts: tuple[Issue, ...] = ()


def read_file(
    path: str | Path, declared: Declaration | None = None, *, name: str | None = None, source: str = "user"
) -> Reading:
    """Read a ground motion from a text file, and say what was taken.

    Parameters
    ----------
    path : the file
    declared : what is declared of it; a file that is of no instrument's format needs `unit`, and `time` or `dt`
    name : what to call the motion; the file's own `# name:` line or its stem unless given
    source : label of the motion

    Raises
    ------
    InputError : with file, line and column, for a file that is missing, empty or not text, a plain file of which
        nothing is declared (with the line to paste), a cell that is no number, a row of another width, uneven times, a
        header that disagrees, and samples that no ground motion has (`records.checks`)
    """
    declared = declared or Declaration()
    text = load_text(Path(path), "motion file")
    _check_declared(text, declared)
    file_format, samples = _read_samples(text, declared)
    declared = replace(declared, baseline=declared.baseline or samples.baseline or None)
    factor = find_acceleration_unit(samples.unit) or 0.0
    doubts = [*check_samples(text, samples, declared)]
    with np.errstate(over="ignore", invalid="ignore"):
        values = samples.values * factor
    mean = float(values.mean())
    if declared.baseline == MEAN and np.isfinite(mean):
        values = values - mean
    if not np.isfinite(values).all():
        raise text.refuse("the values are beyond all numbers", "check `unit:` and `column:`", samples.line)
    motion = Motion(name or samples.name or Path(path).stem, samples.dt, values, source)
    doubts += check_motion(text, motion, samples, declared)
    lines = _describe(text, file_format, samples, motion)
    if declared.baseline == MEAN:
        lines = (f"{lines[0]}; its mean of {mean:.4g} m/s2 is taken away", *lines[1:])
    return Reading(motion, file_format, lines, tuple(doubts))


def _check_declared(text: TextFile, declared: Declaration) -> None:
    """Refuse a declaration that is none: an unknown unit, separator, format or baseline, or signs that are one."""
    units = ", ".join(ACCELERATION_UNITS)
    if declared.unit is not None and find_acceleration_unit(declared.unit) is None:
        raise text.refuse(f"unknown unit '{declared.unit}' of acceleration", f"write one of {units}, or 0.01 g")
    if declared.separator is not None and declared.separator not in SEPARATOR_NAMES:
        hint = """write `","`, `";"`, `tab` or `blank`"""
        raise text.refuse(f"unknown separator '{declared.separator}'", hint)
    if declared.baseline not in (None, *BASELINES):
        raise text.refuse(f"unknown baseline '{declared.baseline}'", f"write {' or '.join(BASELINES)}")
    if declared.decimal not in (None, ".", ","):
        raise text.refuse(f"unknown decimal sign '{declared.decimal}'", """write "." or "," """.strip())
    if declared.thousands == (declared.decimal or "."):
        raise text.refuse(f"'{declared.thousands}' is declared for decimals and thousands", "give each its own sign")
    if declared.format not in (None, PLAIN, *FORMATS) and not declared.is_fortran():
        hint = f"write one of {', '.join(FORMATS)}, {PLAIN}, or the Fortran format of the rows, e.g. 8F9.6"
        raise text.refuse(f"unknown format '{declared.format}'", hint)
    for key in ("time", "column", "rows", "channel"):
        if (number := getattr(declared, key)) is not None and number < 1:
            raise text.refuse(f"{key} is {number}", "columns, rows and channels are counted from 1")
    if declared.skip is not None and declared.skip < 0:
        raise text.refuse(f"skip is {declared.skip}", "write the number of lines above the numbers")


def _read_samples(text: TextFile, declared: Declaration) -> tuple[str, Samples]:
    """Return the format of a file and its samples.

    Raises
    ------
    InputError : the file is not of the format given; a plain file of which nothing is declared
    """
    file = InstrumentFile(text, declared)
    for name, read in FORMATS.items():
        if declared.format not in (None, name):
            continue
        samples = read(file)
        if samples is not None:
            _check_instrument(text, name, declared)
            return name, _settle_unit(text, name, samples, declared)
    if declared.format in FORMATS:
        message = f"its first lines are not those of a file of format '{declared.format}'"
        raise text.refuse(message, "leave `format` out, and declare the columns of a plain file", 1)
    if declared.channel is not None:
        raise text.refuse("a plain file has no channels", "write `column:` in place of `channel:`", 1)
    if declared.time is not None and declared.dt is not None:
        raise text.refuse("both the column of times and the time step are declared", "leave `time` or `dt` out", 1)
    if declared.unit is None or (declared.time is None and declared.dt is None):
        raise _refuse_undeclared(text, declared)
    try:
        return PLAIN, read_plain(text, declared)
    except CurableError as refused:
        line = replace(declared, **refused.cure).write(str(text.path))
        problem = refused.issues[0]
        raise InputError(replace(problem, hint=f"{problem.hint}\n    {line}")) from None


def _check_instrument(text: TextFile, name: str, declared: Declaration) -> None:
    """Refuse keys that an instrument's format has no use for."""
    if declared.channel is not None and name not in FORMATS_WITH_CHANNELS:
        raise text.refuse(f"a file of format '{name}' has no channels to choose from", "leave `channel` out")
    odd = next((key for key in _ONLY_PLAIN if getattr(declared, key) is not None), None)
    if odd is not None:
        message = f"a file of format '{name}' says itself where its values stand"
        hint = f"leave `{odd}` out"
        if name in FORMATS_WITH_CHANNELS and odd == "column":
            hint += ", or write `channel:`"
        raise text.refuse(message, hint)


def _settle_unit(text: TextFile, name: str, samples: Samples, declared: Declaration) -> Samples:
    """Return the samples of an instrument's format with their unit.

    Raises
    ------
    InputError : the file states none, or counts, and none is declared; another one is declared
    """
    stated = find_acceleration_unit(samples.unit)
    line = samples.unit_line or samples.line
    if stated is None:
        if quantity := find_quantity(samples.unit):
            hint = "give the acceleration record (.AT2, .acc, HNx)"
            raise text.refuse(f"the file holds {quantity}, not acceleration", hint, line)
        if declared.unit is not None:
            return replace(samples, unit=declared.unit)
        message = f"the file's unit '{samples.unit}' is none of acceleration that is known"
        hint = f"write `unit:`, one of {', '.join(ACCELERATION_UNITS)}"
        if not samples.unit or samples.unit.lower().startswith("count"):
            message = (
                "the file holds recorder counts without their scale" if samples.unit else "the file states no unit"
            )
            hint = "download the processed record, or say what one count is, e.g. `unit: 6.34e-4 gal`"
        raise text.refuse(message, hint, line)
    given = find_acceleration_unit(declared.unit) if declared.unit is not None else None
    if given is not None and abs(given / stated - 1.0) > 1e-4:
        message = f"the unit is given as {declared.unit}, but the file, of format '{name}', says {samples.unit}"
        raise text.refuse(message, "leave the unit out, or correct the file's", line)
    return samples


def _refuse_undeclared(text: TextFile, declared: Declaration) -> InputError:
    """Return the refusal of a plain file of which unit or times are not declared, with the line to paste."""
    missing = [] if declared.unit else ["its unit"]
    if declared.time is None and declared.dt is None:
        missing.append("its times or time step")
    try:
        found = propose(text, declared)
    except InputError as refused:
        return refused
    line = found.declared.write(str(text.path))
    message = f"this file is of no instrument's format, and nothing says {' and '.join(missing)}"
    if found.fault:
        message += f"; {found.fault}"
    hints = ["write the line below"]
    if UNKNOWN_UNIT in (found.declared.unit or ""):
        hints.append(f"{UNKNOWN_UNIT} is its unit, e.g. g or cm/s2")
    elif declared.unit is None:
        hints.append(f"{found.declared.unit} stands {found.why}")
    if UNKNOWN_STEP in line:
        hints.append(f"{UNKNOWN_STEP} is its time step, e.g. 0.01 s")
    hints.append("`pound records import` shows its columns")
    return text.refuse(message, "; ".join(hints) + f"\n    {line}", 1)


def _describe(text: TextFile, file_format: str, samples: Samples, motion: Motion) -> tuple[str, ...]:
    """Return what was taken of a file, and the lines of it that were not read."""
    count = f"{samples.values.size:,} values".replace(",", " ") if samples.values.size > 9999 else ""
    count = count or pluralize(samples.values.size, "value")
    where = f"{samples.words}, " if samples.words else f"of format {file_format}, "
    encoding = f", a file in {text.encoding}" if text.encoding else ""
    place = samples.dt * int(np.abs(motion.acceleration).argmax())
    peak = f"peak {motion.pga:.4g} m/s2 = {motion.pga / GRAVITY:.4g} g at {place:g} s"
    every = f"every {samples.dt:g} s to {motion.duration:g} s"
    taken = f"{text.path.name}: {count} {where}{every}, {samples.unit}{encoding}; {peak}"
    notes = []
    if samples.unread:
        shown = ", ".join(f"'{line.words[:60]}'" for line in samples.unread[:QUOTED_LINES])
        more = " ..." if len(samples.unread) > QUOTED_LINES else ""
        notes.append(f"{pluralize(len(samples.unread), 'line')} not read: {shown}{more}")
    if samples.below:
        notes.append(f"{pluralize(samples.below, 'line')} below not read")
    return (taken, "; ".join(notes)) if notes else (taken,)
