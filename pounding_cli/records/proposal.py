"""Propose what may be declared of a plain file: its columns numbered, their peaks in every usual unit, a line to paste.

A proposal may guess, since a person confirms it; a reader may not.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from pounding_cli.cells import CurableError, TextFile, load_text
from pounding_cli.errors import InputError
from pounding_cli.records.checks import MAX_PEAK
from pounding_cli.records.declaration import Declaration
from pounding_cli.records.number_rows import NumberRows, read_number_rows
from pounding_cli.records.plain import read_plain
from pounding_cli.records.samples import Samples
from pounding_cli.records.units import ACCELERATION_UNITS, USUAL_UNITS, find_stated_units
from pounding_cli.units import GRAVITY

UNKNOWN_UNIT = "UNIT"
"""Stands in a proposal where nothing shows the unit."""

ANY_STEP = 0.010101
"""Time step with which a file is tried whose step is not known: no file states it [s]."""

MAX_COLUMNS = 40
"""Columns of which a proposal shows the peak."""

MAX_CURES = 6
"""Keys that are found one after the other."""


@dataclass(frozen=True)
class ColumnPeak:
    """What a column of a file may be.

    name : number of the column, from 1; "all" of values row by row
    first : its first cells as written
    step : by which it rises evenly, as times do; None where it does not
    peak : largest absolute value, as written
    """

    name: str
    first: tuple[str, ...]
    step: float | None
    peak: float

    def list_peaks(self) -> tuple[str, ...]:
        """Return the peak [g] read in each of the usual units, "impossible" above 5 g."""
        peaks = (self.peak * ACCELERATION_UNITS[unit] for unit in USUAL_UNITS)
        return tuple("impossible" if peak > MAX_PEAK else f"{peak / GRAVITY:.3g} g" for peak in peaks)


@dataclass(frozen=True)
class Proposal:
    """What may be declared of a file.

    declared : with what its numbers show; `unit` is UNKNOWN_UNIT, and `dt` is not a number, where nothing shows it
    columns : of its rows of numbers
    why : where the unit is from, in words
    fault : what is wrong with the file without the other keys, with its line; "" for nothing
    """

    declared: Declaration
    columns: tuple[ColumnPeak, ...]
    why: str
    fault: str


def propose_file(path: Path, declared: Declaration) -> Proposal:
    """Return what may be declared of a file, beside what is.  Raises InputError: it has no rows of numbers."""
    return propose(load_text(path, "motion file"), declared)


def propose(text: TextFile, declared: Declaration) -> Proposal:
    """Return what may be declared of a file, beside what is: what cures each refusal in turn.

    Raises
    ------
    InputError : it has no rows of numbers
    """
    found, samples, fault = _find_declaration(text, declared)
    rows = read_number_rows(text, found)
    if found.time is not None and found.column is None:
        found = replace(found, column=1 if found.time == 2 else 2)
    if found.time is None and found.column is None:
        columns: tuple[ColumnPeak, ...] = (_measure_column("all", rows.numbers, rows, 1),)
    else:
        numbers = range(1, min(rows.width, MAX_COLUMNS) + 1)
        columns = tuple(_measure_column(str(number), rows.take_column(number), rows, number) for number in numbers)
    unit, why = (declared.unit, "as declared") if declared.unit else _find_unit(samples)
    unit = (found.unit or UNKNOWN_UNIT).replace(UNKNOWN_UNIT, unit)  # a factor of the file stands before it
    return Proposal(replace(found, unit=unit), columns, why, fault)


def _find_declaration(text: TextFile, declared: Declaration) -> tuple[Declaration, Samples, str]:
    """Return a declaration with which a file is read, its samples, and what was wrong without the last keys, "" for
    nothing.

    Raises
    ------
    InputError : there is none
    """
    if declared.time is not None or declared.dt is not None:
        return _follow_cures(text, declared)
    try:
        return _follow_cures(text, replace(declared, time=1))
    except InputError:  # column 1 holds no times
        return _follow_cures(text, replace(declared, dt=math.nan))


def _follow_cures(text: TextFile, declared: Declaration) -> tuple[Declaration, Samples, str]:
    """Return what `_find_declaration` does, of what cures each refusal in turn."""
    found = replace(declared, unit=declared.unit or UNKNOWN_UNIT)
    fault = ""
    for _ in range(MAX_CURES):
        try:
            return found, _read_with_any_step(text, found), fault
        except CurableError as refused:
            fault = fault or _write_fault(refused)
            found = replace(found, **refused.cure)
    return found, _read_with_any_step(text, found), fault


def _read_with_any_step(text: TextFile, declared: Declaration) -> Samples:
    """Return the samples of a file, with some step where it is not known."""
    is_unknown = declared.dt is not None and math.isnan(declared.dt)
    return read_plain(text, replace(declared, dt=ANY_STEP) if is_unknown else declared)


def _write_fault(refused: InputError) -> str:
    """Return a refusal with its line, in words."""
    problem = refused.issues[0]
    return f"line {problem.line}: {problem.message}"


def _measure_column(name: str, numbers: np.ndarray, rows: NumberRows, column: int) -> ColumnPeak:
    """Return what a column may be, from its numbers and its first cells as written."""
    steps = np.diff(numbers)
    median = float(np.median(steps)) if steps.size else 0.0
    rises = steps.size > 1 and steps.min() > 0 and steps.max() <= 3 * median
    first = tuple(row.cells[column - 1] for row in rows.rows[:3])
    return ColumnPeak(name, first, float(f"{median:.6g}") if rises else None, float(np.abs(numbers).max()))


def _find_unit(samples: Samples) -> tuple[str, str]:
    """Return the unit that a file plainly states, and where; UNKNOWN_UNIT where it does not."""
    heading = find_stated_units(samples.heading)
    if heading:
        return _write_unit(heading[0]), f"in the heading '{samples.heading[:60]}'"
    for line in samples.unread:
        for unit in find_stated_units(line.words):
            return _write_unit(unit), f"on line {line.number}, '{line.words[:60]}'"
    return UNKNOWN_UNIT, f"which nothing shows; one of {', '.join(ACCELERATION_UNITS)}, or a multiple"


def _write_unit(stated: str) -> str:
    """Return a unit as a study writes it."""
    return stated.lower().replace("^", "")
