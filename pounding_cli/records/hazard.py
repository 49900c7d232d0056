"""Read files of hazard curves: annual rates at which intensities are exceeded, of national services and OpenQuake.

They hold a table of two columns (intensity, annual rate), and the one row of a site whose columns are intensities:
annual rates under headings that are numbers, or probabilities under `poe-0.1` with an `investigation_time` in the
comment above, as OpenQuake exports them, where the rate is -ln(1 - poe) / investigation time."""

from __future__ import annotations

import re
from collections.abc import Mapping
from itertools import zip_longest
from pathlib import Path

import numpy as np

from pounding_cli.cells import TextFile, load_text
from pounding_cli.errors import InputError, Problem
from pounding_cli.records.instrument import parse_number
from pounding_cli.records.units import find_acceleration_unit
from pounding_cli.units import find_unit_factor

_YEARS = re.compile(r"investigation_time\s*=\s*'?([\d.]+)")
_MEASURE = re.compile(r"imt\s*=\s*'?\"?(PGA|PGV|SA\([\d.]+\))")
_IN_BRACKETS = re.compile(r"[(\[]([^)\]]+)[)\]]")


def read_hazard(path: Path, unit: str | None, si: str) -> tuple[np.ndarray, np.ndarray, str]:
    """Return the intensities, their annual rates and the intensity measure of a hazard curve.

    Intensities rise [SI], the rates at which they are exceeded fall [1/year], shape (n,). The measure is the one that
    OpenQuake names in a comment, such as `SA(0.5)`; "" in other files.

    Parameters
    ----------
    path : the file
    unit : of the intensities; None: the file says it in its heading, and OpenQuake's accelerations are in g
    si : "m/s2" of accelerations, "m/s" of velocities, "" of a factor

    Raises
    ------
    InputError : no such file, not a hazard curve, several sites, no unit, rates that do not fall
    """
    text = load_text(path, "hazard curve")
    comment = " ".join(line for line in text.lines if line.startswith("#"))
    rows = {
        number: _split_cells(line)
        for number, line in enumerate(text.lines, 1)
        if line.strip() and not line.startswith("#")
    }
    if len(rows) < 2:
        message = "this is not a hazard curve: it has no two rows"
        raise text.refuse(message, "give lines of intensity and annual rate")
    head = next(iter(rows.values()))
    levels = [parse_number(cell.removeprefix("poe-")) for cell in head]
    if sum(level is not None for level in levels) > 2:
        points = _read_site(text, rows, levels, comment)
        is_from_openquake = any(cell.startswith("poe-") for cell in head)
        if is_from_openquake and si == "m/s2":
            unit = unit or "g"
    else:
        points = _read_pairs(text, rows, has_head=None in levels)
    bracket = _IN_BRACKETS.search(" ".join(head))
    unit_in_head = bracket[1] if bracket else None
    factor = intensity_factor(unit or unit_in_head, si, str(path))
    points = points[points[:, 1] != 0]  # a service writes 0 for what is too rare to say
    intensity, rate = points[np.argsort(points[:, 0])].T
    rises = (np.diff(intensity, prepend=0) > 0).all()
    falls = (np.diff(rate, append=0) < 0).all()
    if intensity.size < 2 or not (rises and falls):
        hint = "give at least two intensities above 0, each once, with rates that fall as they rise"
        raise text.refuse("this is not a hazard curve", hint)
    measure = _MEASURE.search(comment)
    return factor * intensity, rate, measure[1] if measure else ""


def _read_site(
    text: TextFile,
    rows: Mapping[int, list[str]],
    levels: list[float | None],
    comment: str,
) -> np.ndarray:
    """Return intensities [unit of the file] and annual rates of the one row of a site, shape (n, 2).

    Parameters
    ----------
    rows : the cells of every line by its number (from 1), the heading first
    levels : intensities of the columns; None of a column that has none
    comment : the lines that begin with #

    Raises
    ------
    InputError : several sites, or probabilities for an unknown number of years
    """
    head, *sites = rows.values()
    if len(sites) != 1:
        hint = "leave the row of your site, and the heading"
        raise text.refuse(f"the file has the curves of {len(sites)} sites", hint, max(rows))
    columns = zip_longest(levels, map(parse_number, sites[0]))
    points = np.array([(level, value) for level, value in columns if level is not None], float)
    years_match = _YEARS.search(comment)
    years = parse_number(years_match[1]) if years_match else None
    if not years and any(cell.startswith("poe-") for cell in head):
        hint = "write `# investigation_time=50.0` above the heading"
        raise text.refuse("the probabilities are for an unknown number of years", hint, 1)
    if years:
        points[:, 1] = -np.log1p(-np.minimum(points[:, 1], 1 - 1e-16)) / years
    return points


def _read_pairs(text: TextFile, rows: Mapping[int, list[str]], has_head: bool) -> np.ndarray:
    """Return intensities [unit of the file] and annual rates of a table of two columns, shape (n, 2).

    Raises
    ------
    InputError : a row is not an intensity and a rate
    """
    head_line = min(rows) if has_head else 0
    points = []
    for line, cells in rows.items():
        if line == head_line:
            continue
        pair = [parse_number(cell) for cell in cells]
        if len(pair) != 2 or None in pair:
            message = f"'{', '.join(cells)[:60]}' is no intensity and rate"
            raise text.refuse(message, "write e.g. 0.1, 0.005", line)
        points.append(pair)
    return np.array(points, float).reshape(-1, 2)


def _split_cells(line: str) -> list[str]:
    """Return the cells of a line, without quotes."""
    separator = r"[,;\t]" if re.search(r"[,;\t]", line) else r"\s+"
    return [cell.strip().strip("\"'") for cell in re.split(separator, line)]


def intensity_factor(unit: str | None, si: str, file: str) -> float:
    """Return one of a unit of intensity in SI.

    Parameters
    ----------
    unit : as written; None where nothing says it
    si : as in `read_hazard`
    file : where it is written, for the message

    Raises
    ------
    InputError : no unit, or one of another quantity
    """
    if si == "":
        return 1.0
    factor = None
    if unit is not None:
        try:
            factor = find_acceleration_unit(unit) if si == "m/s2" else find_unit_factor(unit, si)
        except ValueError:
            factor = None
    if factor is None:
        message = "the file does not say the unit of intensity"
        if unit:
            message = f"'{unit[:40]}' is no unit of this intensity"
        example = "g" if si == "m/s2" else "cm/s"
        raise InputError(Problem(message, f"write `unit: {example}` beside it", file))
    return factor
