"""Files of hazard curves: how often a year an intensity is exceeded, as national services and OpenQuake publish it.

Read are a table of two columns (intensity, annual rate), and the one row of a site whose columns are intensities:
annual rates under headings that are numbers, or probabilities under `poe-0.1` with an `investigation_time` in the
comment above, as OpenQuake exports them, where the rate is -ln(1 - poe) / investigation time."""

from __future__ import annotations

import re
from itertools import zip_longest
from pathlib import Path

import numpy as np

from pounding_cli.errors import InputError, Problem
from pounding_cli.records.text import load_text, parse_number
from pounding_cli.records.units import find_acceleration_unit
from pounding_cli.units import find_unit_factor

_YEARS = re.compile(r"investigation_time\s*=\s*'?([\d.]+)")
_MEASURE = re.compile(r"imt\s*=\s*'?\"?(PGA|PGV|SA\([\d.]+\))")
_IN_BRACKETS = re.compile(r"[(\[]([^)\]]+)[)\]]")


def read_hazard(path: Path, unit: str | None, si: str) -> tuple[np.ndarray, np.ndarray, str]:
    """Intensities [SI], rising, the annual rates at which they are exceeded, falling, shape (n,), and the intensity
    measure that OpenQuake names in a comment, such as `SA(0.5)`; "" in other files.

    Parameters
    ----------
    unit : of the intensities; None: the file says it in its heading, and OpenQuake's accelerations are in g
    si : "m/s2" of accelerations, "m/s" of velocities, "" of a factor

    Raises
    ------
    InputError : no such file, not a hazard curve, several sites, no unit, rates that do not fall
    """
    text = load_text(path, "hazard curve")
    comment = " ".join(line for line in text.lines if line.startswith("#"))
    rows = {n: _cells(line) for n, line in enumerate(text.lines, 1) if line.strip() and not line.startswith("#")}
    if len(rows) < 2:
        raise text.refuse("this is not a hazard curve: it has no two rows", "give lines of intensity and annual rate")
    head, *others = rows.values()
    levels = [parse_number(cell.removeprefix("poe-")) for cell in head]
    if len([level for level in levels if level is not None]) > 2:
        if len(others) != 1:
            hint = "leave the row of your site, and the heading"
            raise text.refuse(f"the file has the curves of {len(others)} sites", hint, max(rows))
        values = zip_longest(levels, map(parse_number, others[0]))
        points = np.array([(level, value) for level, value in values if level is not None], float)
        years_match = _YEARS.search(comment)
        is_poe = any(cell.startswith("poe-") for cell in head)
        years = parse_number(years_match[1]) if years_match else None
        unit = unit or ("g" if si == "m/s2" and is_poe else None)
        if is_poe and not years:
            hint = "write `# investigation_time=50.0` above the heading"
            raise text.refuse("the probabilities are for an unknown number of years", hint, 1)
        if years:
            points[:, 1] = -np.log1p(-np.minimum(points[:, 1], 1 - 1e-16)) / years
    else:
        pairs = {n: [*map(parse_number, cells)] for n, cells in rows.items() if n > min(rows) or None not in levels}
        for n, pair in pairs.items():
            if len(pair) != 2 or None in pair:
                raise text.refuse(f"'{', '.join(rows[n])[:60]}' is no intensity and rate", "write e.g. 0.1, 0.005", n)
        points = np.array([*pairs.values()], float).reshape(-1, 2)
    unit_match = _IN_BRACKETS.search(" ".join(head))
    one = intensity_factor(unit or (unit_match[1] if unit_match else None), si, str(path))
    points = points[points[:, 1] != 0]  # a service writes 0 for what is too rare to say
    intensity, rate = points[np.argsort(points[:, 0])].T
    rises = (np.diff(intensity, prepend=0) > 0).all()
    falls = (np.diff(rate, append=0) < 0).all()
    if intensity.size < 2 or not (rises and falls):
        hint = "give at least two intensities above 0, each once, with rates that fall as they rise"
        raise text.refuse("this is not a hazard curve", hint)
    measure = _MEASURE.search(comment)
    return one * intensity, rate, measure[1] if measure else ""


def _cells(line: str) -> list[str]:
    return [each.strip().strip("\"'") for each in re.split(r"[,;\t]" if re.search(r"[,;\t]", line) else r"\s+", line)]


def intensity_factor(unit: str | None, si: str, shown: str) -> float:
    """One of the unit in SI."""
    if si == "":
        return 1.0
    try:
        one = None if unit is None else find_acceleration_unit(unit) if si == "m/s2" else find_unit_factor(unit, si)
    except ValueError:
        one = None
    if one is None:
        said = f"'{unit[:40]}' is no unit of this intensity" if unit else "the file does not say the unit of intensity"
        raise InputError(Problem(said, f"write `unit: {'g' if si == 'm/s2' else 'cm/s'}` beside it", shown))
    return one
