"""The samples of a motion file, as one of its readers finds them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

MIN_TIME_STEP, MAX_TIME_STEP = 1e-6, 10.0
"""Time steps [s] outside are no ground motion's."""


class UnreadLine(NamedTuple):
    """A line of a file that was not read; number : from 1."""

    number: int
    words: str


@dataclass(frozen=True)
class Samples:
    """The samples of a file.

    dt : time step [s]
    values : in `unit`, shape (n,)
    unit : of acceleration, as declared or as the format states it
    unit_line : that states it, from 1; 0 for none
    line : where they begin, from 1
    words : which values they are: "of column 2", "row by row"
    unread : lines with words above, between and below the numbers
    heading : the cell above the column, "" for none
    lines : of every sample, from 1, shape (n,); None in an instrument's format
    below : number of lines below the numbers that are not read
    name, baseline : of the motion, as the file states them; "" for none
    """

    dt: float
    values: np.ndarray
    unit: str
    line: int
    words: str = ""
    unread: tuple[UnreadLine, ...] = ()
    heading: str = ""
    name: str = ""
    baseline: str = ""
    unit_line: int = 0
    lines: np.ndarray | None = None
    below: int = 0

    def find_line(self, place: int) -> int:
        """Return the line of a sample, from 1; that of the first one in an instrument's format."""
        return self.line if self.lines is None else int(self.lines[place])
