"""Readers of ground-motion text files: PEER AT2, two columns (t, a), one column with a time step.

A one-column file may carry its time step, unit and name in header lines such as `# dt: 0.01 s`; that is also
the format the catalogue's own files are written in (`pounding_cli.records.writers`).
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from pounding_cli.errors import InputError, Problem
from pounding_cli.records.motion import GRAVITY, Motion

UNITS: dict[str, float] = {
    "g": GRAVITY,
    "m/s2": 1.0,
    "cm/s2": 0.01,
    "gal": 0.01,
    "mm/s2": 0.001,
    "ft/s2": 0.3048,
    "in/s2": 0.0254,
}
"""Units an acceleration file may be in, and one of each in m/s2."""

FORMATS = ("at2", "two-column", "column")

_LARGEST = 5.0 * GRAVITY
# The strongest ground accelerations ever recorded lie between 3 and 5 g; above that the unit is wrong.
_UNEVEN = 0.02
# Times are often printed with few digits; a sample may stand off its even place by this part of a step.
_AT2_SIZE = re.compile(r"NPTS\s*=?\s*(\d+)\s*,?\s*DT\s*=?\s*([-+.\dEe]+)", re.IGNORECASE)
_AT2_SIZE_OLD = re.compile(r"^\s*(\d+)\s+([-+.\dEe]+)\s+NPTS", re.IGNORECASE)
_TOUCHING = re.compile(r"(?<=[\d.])(?=[-+])")
_HEADER = re.compile(r"^\s*[#%!]\s*([A-Za-z0-9 ]+?)\s*[:=]\s*(.*?)\s*$")


@dataclass
class _Text:
    """The file as lines, its `# key: value` header, and where the numbers start."""

    path: Path
    lines: list[str]
    header: dict[str, str] = field(default_factory=dict)

    def refuse(self, message: str, hint: str, line: int = 0, column: int = 1) -> InputError:
        return InputError(Problem(message, hint, str(self.path), line, column if line else 0))


def read_motion(
    path: str | Path,
    *,
    name: str | None = None,
    unit: str | None = None,
    dt: float | None = None,
    format: str | None = None,
    source: str = "user",
) -> Motion:
    """Read a ground motion from a text file.

    Parameters
    ----------
    path : the file
    name : what to call the motion; the file's own `# name:` line or its stem unless given
    unit : unit of the acceleration, one of `UNITS`; g unless given or the header says otherwise
    dt : time step [s]; needed for one column without a `# dt:` line, otherwise checked against the file's own
    format : "at2", "two-column" (t [s], a) or "column" (values row by row); found from the file unless given
    source : label of the motion

    Raises `InputError`, with file and line, for a file that is missing, empty or not text, a value that is no
    number, uneven or falling times, a count or digest other than the header's, a missing or
    contradicting time step, an unknown unit or format, and a peak above 5 g (a wrong unit).
    """
    text = _load(Path(path))
    kind = _format(text, format)
    factor = _unit_factor(text, unit)
    if kind == "at2":
        step, values, first_line = _at2(text, dt)
    elif kind == "two-column":
        step, values, first_line = _two_columns(text, dt)
    else:
        step, values, first_line = _column(text, dt)
    acceleration = np.array(values) * factor
    if acceleration.size < 2:
        raise text.refuse("only one sample found", "a motion needs at least two samples", first_line)
    peak = float(np.abs(acceleration).max())
    if peak == 0.0:
        raise text.refuse("every sample is zero", "give a file that holds a ground motion", first_line)
    if peak > _LARGEST:
        used = unit or text.header.get("unit", "g")
        raise text.refuse(
            f"the peak is {peak / GRAVITY:.4g} g read in {used}: no ground motion is that strong",
            f"say which unit the file is in: {', '.join(UNITS)}",
            first_line,
        )
    motion = Motion(name or text.header.get("name") or Path(path).stem, step, acceleration, source)
    written = text.header.get("digest")
    if kind == "column" and written is not None and written != motion.digest:
        raise text.refuse(
            "the samples are not those the file was written with: their digest differs",
            "import the motion again, or take the '# digest:' line out if the change was meant",
            first_line,
        )
    return motion


def read_header(path: str | Path) -> dict[str, str]:
    """The `# key: value` lines at the top of a motion file, keys in lower case.

    Raises `InputError` for a file that is missing, empty or not text.
    """
    return dict(_load(Path(path)).header)


def _load(path: Path) -> _Text:
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except FileNotFoundError:
        raise InputError(Problem("no such file", "give the path of a motion", str(path))) from None
    except UnicodeDecodeError:
        raise InputError(
            Problem("not a text file", "give PEER AT2, two columns t a, or one column", str(path))
        ) from None
    except OSError as error:
        raise InputError(
            Problem(f"cannot be read: {error.strerror}", "give a file that can be read", str(path))
        ) from None
    text = _Text(path, lines)
    if not any(line.strip() for line in lines):
        raise text.refuse("the file is empty", "give a file that holds a ground motion")
    for line in lines:
        found = _HEADER.match(line)
        if found:
            text.header[found[1].strip().lower()] = found[2]
        elif line.strip() and line.lstrip()[0] not in "#%!":
            break
    return text


def _unit_factor(text: _Text, unit: str | None) -> float:
    name = (unit or text.header.get("unit") or "g").strip().lower()
    name = {"m/s^2": "m/s2", "m/s/s": "m/s2", "cm/s^2": "cm/s2", "cm/s/s": "cm/s2"}.get(name, name)
    if name not in UNITS:
        raise text.refuse(f"unknown unit '{unit or name}' of acceleration", f"write one of {', '.join(UNITS)}")
    return UNITS[name]


def _format(text: _Text, wanted: str | None) -> str:
    if wanted is not None:
        if wanted not in FORMATS:
            raise text.refuse(f"unknown format '{wanted}'", f"write one of {', '.join(FORMATS)}")
        return wanted
    if any(_at2_size(line) for line in text.lines[:8]):
        return "at2"
    start = _first_row(text)
    width = len(_tokens(text.lines[start]))
    if width == 1:
        return "column"
    if width == 2:
        return "two-column"
    raise text.refuse(
        f"{width} values on a line, and no header says what they are",
        "give two columns (t in s, a); for values printed row by row say format 'column' and dt",
        start + 1,
    )


def _tokens(line: str) -> list[str]:
    return line.replace(",", " ").replace(";", " ").split()


def _is_number(token: str) -> bool:
    try:
        float(token.replace("D", "E").replace("d", "e"))
    except ValueError:
        return False
    return True


def _first_row(text: _Text) -> int:
    """Index of the first line that opens with a number; words and comments before are the header."""
    for index, line in enumerate(text.lines):
        tokens = _tokens(line)
        if tokens and _is_number(tokens[0]):
            return index
    raise text.refuse("no line of numbers found", "give PEER AT2, two columns t a, or one column with dt", 1)


def _row(text: _Text, index: int) -> list[float]:
    """The numbers on one line; every other character, and nan or inf, is refused with its line and column."""
    line = text.lines[index]
    values = []
    for token in _tokens(line):
        try:
            found = [float(token)]
        except ValueError:
            # Fortran writes 1.0D-03, and fixed-width columns may touch: -.12E-01-.34E-01.
            parts = _TOUCHING.split(token.upper().replace("D", "E"))
            if not all(map(_is_number, parts)):
                raise text.refuse(
                    f"'{token}' is not a number", "write plain numbers only", index + 1, line.find(token) + 1
                ) from None
            found = [float(part) for part in parts]
        if not all(map(math.isfinite, found)):
            raise text.refuse(
                f"'{token}' is not a finite number",
                "fill or cut the gap in the record before reading it",
                index + 1,
                line.find(token) + 1,
            )
        values += found
    return values


def _rows(text: _Text, start: int) -> list[tuple[int, list[float]]]:
    rows = []
    for index in range(start, len(text.lines)):
        line = text.lines[index].strip()
        if line and line[0] not in "#%!":
            rows.append((index, _row(text, index)))
    if not rows:
        raise text.refuse("no numbers after the header", "give a file that holds a ground motion", start)
    return rows


def _at2_size(line: str) -> re.Match[str] | None:
    return _AT2_SIZE.search(line) or _AT2_SIZE_OLD.search(line)


def _at2(text: _Text, dt: float | None) -> tuple[float, list[float], int]:
    sizes = ((index, _at2_size(line)) for index, line in enumerate(text.lines[:8]))
    index, size = next(((index, size) for index, size in sizes if size), (0, None))
    if size is None:
        raise text.refuse(
            "no header line with NPTS and DT",
            "a PEER AT2 file has 'NPTS= 5437, DT= .0100 SEC' on its fourth line; or say another format",
            1,
        )
    count = int(size[1])
    step = _same_step(text, dt, _step(text, size[2], index + 1), index + 1)
    values = [value for _, row in _rows(text, index + 1) for value in row]
    if len(values) != count:
        raise text.refuse(
            f"the header says NPTS= {count}, but {len(values)} values follow",
            "the file is cut short or damaged: fetch it again, or correct NPTS",
            index + 1,
        )
    return step, values, index + 2


def _two_columns(text: _Text, dt: float | None) -> tuple[float, list[float], int]:
    start = _first_row(text)
    rows = _rows(text, start)
    for index, row in rows:
        if len(row) != 2:
            raise text.refuse(
                f"{len(row)} values on this line, where every other has two",
                "write the time in s and the acceleration on every line",
                index + 1,
            )
    if len(rows) < 2:
        raise text.refuse("only one sample found", "a motion needs at least two samples", start + 1)
    times = np.array([row[0] for _, row in rows])
    step = float(f"{(times[-1] - times[0]) / (times.size - 1):.9g}")
    falling = np.flatnonzero(np.diff(times) <= 0)
    if falling.size:
        line = rows[falling[0] + 1][0] + 1
        raise text.refuse(
            f"the time {times[falling[0] + 1]:g} s does not come after {times[falling[0]]:g} s",
            "write the times in rising order; for values printed row by row say format 'column' and dt",
            line,
        )
    step = _same_step(text, dt, step, start + 1)
    off = np.abs(times - times[0] - step * np.arange(times.size))
    if off.max() > _UNEVEN * step:
        gaps = np.diff(times)
        usual = float(np.median(gaps))
        worst = int(np.argmax(np.abs(gaps - usual)))
        raise text.refuse(
            f"uneven time steps: {gaps[worst]:.6g} s here, {usual:.6g} s elsewhere",
            "resample the record to even steps, or restore the missing samples",
            rows[worst + 1][0] + 1,
        )
    return step, [row[1] for _, row in rows], start + 1


def _column(text: _Text, dt: float | None) -> tuple[float, list[float], int]:
    written = text.header.get("dt")
    if written is None and dt is None:
        raise text.refuse(
            "one column of values, and no time step",
            "give dt (--dt 0.01, or dt: 0.01 s beside the file in a study), or put '# dt: 0.01 s' on top",
            1,
        )
    if written is None:
        step = _step(text, str(dt), 0)
    else:
        step = _same_step(text, dt, _step(text, written.removesuffix("s").strip(), 1), 1)
    start = _first_row(text)
    values = [value for _, row in _rows(text, start) for value in row]
    said = text.header.get("samples")
    if said is not None and said != str(len(values)):
        raise text.refuse(
            f"the header says {said} samples, but {len(values)} values follow",
            "fetch or import the file again",
            1,
        )
    return step, values, start + 1


def _step(text: _Text, written: str, line: int) -> float:
    try:
        step = float(written)
    except ValueError:
        step = math.nan
    if not (math.isfinite(step) and step > 0):
        raise text.refuse(f"the time step is {written}", "give a time step above 0 s, e.g. 0.01", line)
    return step


def _same_step(text: _Text, given: float | None, found: float, line: int) -> float:
    if given is not None and abs(given - found) > 1e-3 * found:
        raise text.refuse(
            f"dt is given as {given:g} s, but the file says {found:g} s", "leave dt out, or correct it", line
        )
    return found
