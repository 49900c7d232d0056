"""Files of hazard curves: how often a year an intensity is exceeded, as national services and OpenQuake publish it.

Read are a table of two columns (intensity, annual rate), and the one row of a site whose columns are intensities:
annual rates under headings that are numbers, or probabilities under `poe-0.1` with an `investigation_time` in the
comment above, as OpenQuake exports them, where the rate is -ln(1 - poe) / investigation time."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np

from pounding_cli.errors import InputError, Problem
from pounding_cli.reading import read_bytes, shortened
from pounding_cli.records.units import acceleration_unit
from pounding_cli.units import factor

LARGEST = 1_000_000
"""Bytes of a file."""

_YEARS = re.compile(r"investigation_time\s*=\s*'?([\d.]+)")
_MEASURE = re.compile(r"imt\s*=\s*'?\"?(PGA|PGV|SA\([\d.]+\))")
_IN_BRACKETS = re.compile(r"[(\[]([^)\]]+)[)\]]")


def read_hazard(path: Path, unit: str | None, si: str) -> tuple[np.ndarray, np.ndarray]:
    """Intensities [SI], rising, and the annual rates at which they are exceeded, falling, shape (n,).

    Parameters
    ----------
    unit : of the intensities; None: the file says it in its heading, and OpenQuake's accelerations are in g
    si : "m/s2" of accelerations, "m/s" of velocities, "" of a factor

    Raises
    ------
    InputError : no such file, not a hazard curve, several sites, no unit, rates that do not fall
    """
    shown = shortened(path)
    try:
        text = read_bytes(path, LARGEST, "hazard curve").decode("utf-8-sig", errors="replace")
    except (OSError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        hint = "paths are relative to the study file"
        raise InputError(Problem(f"the hazard curve cannot be read: {error}", hint, shown)) from error
    lines = [(n, line.strip()) for n, line in enumerate(text.splitlines(), 1) if line.strip()]
    comment = " ".join(line for _, line in lines if line.startswith("#"))
    rows = [(n, _cells(line)) for n, line in lines if not line.startswith("#")]
    if len(rows) < 2:
        hint = "give lines of intensity and annual rate: 0.1, 0.005"
        raise InputError(Problem("this is not a hazard curve: it has no two rows", hint, shown))
    (_, head), *others = rows
    levels = [(place, level) for place, cell in enumerate(head) if (level := _level(cell)) is not None]
    if len(levels) > 2:
        is_poe = any(cell.startswith("poe-") for cell in head)
        points = _of_site(levels, others, is_poe, comment, shown)
        unit = unit or ("g" if si == "m/s2" and is_poe else None)
    else:
        points = [_pair(n, cells, shown) for n, cells in (rows if levels else others)]
    found = _IN_BRACKETS.search(" ".join(head))
    one = intensity_factor(unit or (found[1] if found else None), si, shown)
    intensity, rate = np.array(sorted(points)).T
    keep = rate > 0  # a service writes 0 for what is too rare to say
    intensity, rate = one * intensity[keep], rate[keep]
    if intensity.size < 2 or intensity[0] <= 0 or (np.diff(intensity) <= 0).any() or (np.diff(rate) >= 0).any():
        hint = "give at least two intensities above 0, each once, with rates that fall as they rise"
        raise InputError(Problem("this is not a hazard curve", hint, shown))
    return intensity, rate


def measure_of(path: Path) -> str:
    """The intensity measure that OpenQuake names in a comment, such as `SA(0.5)`; "" in other files."""
    found = _MEASURE.search(path.read_text(encoding="utf-8", errors="replace")[:2000])
    return found[1] if found else ""


def _cells(line: str) -> list[str]:
    return [each.strip().strip("\"'") for each in re.split(r"[,;\t]" if re.search(r"[,;\t]", line) else r"\s+", line)]


def _number(cell: str) -> float | None:
    try:
        return float(cell)
    except ValueError:
        return None


def _level(cell: str) -> float | None:
    """The intensity that the heading of a column is, `0.1` or `poe-0.1`."""
    return _number(cell.removeprefix("poe-"))


def _pair(n: int, cells: list[str], shown: str) -> tuple[float, float]:
    numbers = [_number(cell) for cell in cells]
    if (
        len(numbers) != 2
        or numbers[0] is None
        or numbers[1] is None
        or not all(map(math.isfinite, (numbers[0], numbers[1])))
    ):
        raise InputError(
            Problem(f"'{', '.join(cells)[:60]}' is no intensity and rate", "write e.g. 0.1, 0.005", shown, n, 1)
        )
    return numbers[0], numbers[1]


def _of_site(
    levels: list[tuple[int, float]], rows: list[tuple[int, list[str]]], is_poe: bool, comment: str, shown: str
) -> list[tuple[float, float]]:
    """The points of the one site of a file whose columns are intensities."""
    if len(rows) != 1:
        hint = "leave the row of your site, and the heading"
        raise InputError(Problem(f"the file has the curves of {len(rows)} sites", hint, shown, rows[1][0], 1))
    n, cells = rows[0]
    values = [_number(cells[place]) if place < len(cells) else None for place, _ in levels]
    numbers = [value for value in values if value is not None and math.isfinite(value)]
    if len(numbers) != len(levels):
        raise InputError(Problem("a value of the curve is no number", "give one for every heading", shown, n, 1))
    years = _YEARS.search(comment)
    if years:
        numbers = [-math.log1p(-min(poe, 1 - 1e-16)) / float(years[1]) for poe in numbers]
    elif is_poe:
        hint = "write `# investigation_time=50.0` above the heading"
        raise InputError(Problem("the probabilities are for an unknown number of years", hint, shown, 1, 1))
    return [(level, number) for (_, level), number in zip(levels, numbers, strict=True)]


def intensity_factor(unit: str | None, si: str, shown: str) -> float:
    """One of the unit in SI."""
    if si == "":
        return 1.0
    if unit is None:
        raise InputError(
            Problem("the file does not say the unit of its intensities", "write `unit: g` beside it", shown)
        )
    one = acceleration_unit(unit) if si == "m/s2" else factor(unit, si)
    if one is None:
        raise InputError(
            Problem(
                f"'{unit[:40]}' is no unit of this intensity",
                f"write e.g. `unit: {'g' if si == 'm/s2' else 'cm/s'}`",
                shown,
            )
        )
    return one
