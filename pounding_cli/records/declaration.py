"""What is declared of a motion file: its unit, its times or time step, its column, and how its cells are written."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, fields

from pounding_cli.cells import BLANKS, SEPARATORS

SEPARATOR_NAMES = {"tab": "\t", "blank": BLANKS, **{sign: sign for sign in SEPARATORS}}
"""How separators are declared."""

UNKNOWN_STEP = "STEP"
"""Stands in a proposal where nothing shows the time step."""

MEAN, KEPT = "mean", "kept"
BASELINES = (MEAN, KEPT)
"""`mean`: the mean of the samples is taken away; `kept`: the ground is meant to drift, or to be pushed one way."""


@dataclass(frozen=True)
class Declaration:
    """What is declared of a motion file.  A plain file needs `unit`, and `time` or `dt`; an instrument's format says
    all this itself, and what is declared beside it must agree.

    unit : of the acceleration (`units.find_acceleration_unit`)
    time : column of the times, in seconds, from 1
    dt : time step [s] of a file without times
    column : column of the acceleration, from 1; None: the next after the times, or every value, row by row
    skip : lines above the first row of numbers; None: lines that hold words
    rows : rows of numbers that are read; None: all
    separator : what parts cells, one of `SEPARATOR_NAMES`; None: as the first row of numbers shows
    decimal : "." or ","
    thousands : sign between thousands; None: none
    format : of an instrument, or the Fortran format of the rows such as 8F9.6
    channel : of an instrument's file with several, from 1
    baseline : one of `BASELINES`; None: samples stay as they are, and the ground must not drift away
    """

    unit: str | None = None
    time: int | None = None
    dt: float | None = None
    column: int | None = None
    skip: int | None = None
    rows: int | None = None
    separator: str | None = None
    decimal: str | None = None
    thousands: str | None = None
    format: str | None = None
    channel: int | None = None
    baseline: str | None = None

    def list_given(self) -> dict[str, object]:
        """Return what is declared, by its key."""
        given = {field.name: getattr(self, field.name) for field in fields(self)}
        return {key: value for key, value in given.items() if value is not None}

    def write(self, file: str) -> str:
        """Return the entry of a study that declares so; UNKNOWN_STEP stands for a `dt` that is not a number."""
        items = []
        for key, value in self.list_given().items():
            if isinstance(value, float):
                items.append(f"{key}: {UNKNOWN_STEP if math.isnan(value) else f'{value:.10g} s'}")
            else:
                items.append(f"{key}: {_write_value(value)}")
        return f"{', '.join([write_file(file), *items])}}}"


def write_file(file: str) -> str:
    """Return how the entry of a file in a study begins."""
    return f"{{file: {_write_value(file)}"


def _write_value(value: object) -> str:
    """Return a value as YAML writes it in braces."""
    text = str(value)
    is_plain = re.fullmatch(r"\w[\w ./*?-]*", text) is not None
    return text if is_plain else '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'
