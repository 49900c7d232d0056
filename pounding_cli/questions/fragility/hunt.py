"""The hunt for the intensity at which a motion first passes a limit.

Hunt and fill (Vamvatsikos, D. and Cornell, C. A. (2004). Applied incremental dynamic analysis. Earthquake Spectra
20(2), 523-553): step up until the limit is passed, close the bracket, then look again below it, for demand need not
grow with intensity.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from pounding_cli.questions.fragility.demands import UNDECIDED

_OVERSHOOT = 1.1
"""Factor by which the first step beyond a capacity aims too high: a bracket from above is worth more than another
below."""

_MAX_STEP = 4.0
"""Largest factor by which the intensity grows from one level to the next while none has passed."""

_UNDECIDED_STEP = 2.0
"""Factor by which the intensity grows from one level to the next while a collapse leaves all undecided."""


def next_levels(intensity: np.ndarray, demands: Mapping[int, float], fill: int) -> set[int]:
    """Return the levels of one motion to solve next; none when its bracket is closed and filled below.

    Parameters
    ----------
    intensity : of the levels, rising, shape (levels,)
    demands : number of a solved level -> demand over limit there; above 1 where the limit is passed, UNDECIDED where a
        collapse left that open, NaN where the time history failed
    fill : levels below the bracket that are solved, evenly
    """
    levels = len(intensity)
    passed = min((level for level, demand in demands.items() if demand > 1), default=levels)
    ended = min((level for level, demand in demands.items() if demand > 1 or demand == UNDECIDED), default=levels)
    held = max((level for level, demand in demands.items() if demand <= 1 and level < ended), default=-1)
    between = [level for level in range(held + 1, ended) if level not in demands]
    if ended < levels and not between:
        last = max((level for level in demands if level < passed), default=-1)
        if ended < passed and passed - last > 1:  # a collapse came first: a stronger motion may pass before it
            return {_step_beyond_collapse(intensity, last, passed)}
        below = np.linspace(0, max(held, 0), fill + 2)[1:-1].round().astype(int)
        return set(below.tolist()) - demands.keys()
    if ended < levels:
        return {between[len(between) // 2]}
    if held < 0:
        return set(between[:1])  # all that was solved failed
    if not between:
        return set()
    factor = _OVERSHOOT / demands[held] if demands[held] * _MAX_STEP >= _OVERSHOOT else _MAX_STEP
    wanted = int(np.searchsorted(intensity, factor * intensity[max(demands)]))
    return {min(between, key=lambda level: (abs(level - wanted), level))}


def _step_beyond_collapse(intensity: np.ndarray, last: int, passed: int) -> int:
    """Return a level above the highest that a collapse left undecided.

    last : highest solved level below the first pass
    passed : level of the first pass; the number of levels where there is none
    """
    if passed < len(intensity):
        return (last + passed) // 2
    stronger = int(np.searchsorted(intensity, _UNDECIDED_STEP * intensity[last]))
    return min(max(stronger, last + 1), len(intensity) - 1)


def expected_levels(intensity: np.ndarray, capacity: float, fill: int) -> list[int]:
    """Return the levels that `next_levels` solves where the demand is in proportion to the intensity.

    Parameters
    ----------
    intensity : of the levels, rising, shape (levels,)
    capacity : intensity at which the limit is passed
    fill : as of `next_levels`
    """
    demands: dict[int, float] = {}
    wanted = {0}
    while wanted:
        demands |= {level: float(intensity[level]) / capacity for level in wanted}
        wanted = next_levels(intensity, demands, fill)
    return sorted(demands)
