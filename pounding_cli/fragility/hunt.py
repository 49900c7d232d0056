"""Incremental dynamic analysis that looks for the intensity at which one motion first passes a limit.

Hunt and fill (Vamvatsikos, D. and Cornell, C. A. (2004). Applied incremental dynamic analysis. Earthquake Spectra
20(2), 523-553): step up until the limit is passed, close the bracket, then look again below it, for demand need not
grow with intensity. The intensities are levels given beforehand, so that what is found is what all levels would have
told, but for a pass between two levels below that were looked at.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

_OVERSHOOT = 1.1
"""By how much the first step beyond a capacity aims too high: a bracket from above is worth more than another below."""

_LONGEST_STEP = 4.0
"""The intensity grows at most by this factor from one level to the next while none has passed."""

_NARROW = 8
"""A bracket of more levels is halved too, for the case that the demand misleads."""


@dataclass(frozen=True)
class Found:
    """What is known of one motion.

    held : number of the highest level below `passed` at which it holds, -1 where there is none
    passed : number of the lowest level at which it passes the limit; the number of levels where there is none
    returns : whether it holds at a level above `passed`
    """

    held: int
    passed: int
    returns: bool


def found(seen: Mapping[int, float], levels: int) -> Found:
    """What is known from some levels.

    seen : number of a level -> demand over limit there; above 1 where the limit is passed, NaN where the scene failed
    levels : how many there are
    """
    passed = min((level for level, demand in seen.items() if demand > 1), default=levels)
    holds = [level for level, demand in seen.items() if demand <= 1]  # fault: failed-scene-of-ida
    held = max((level for level in holds if level < passed), default=-1)
    return Found(held, passed, any(level > passed for level in holds))


def next_levels(intensity: np.ndarray, seen: Mapping[int, float], fill: int) -> set[int]:
    """The levels of one motion to look at next; none when its bracket is closed and filled below.

    Parameters
    ----------
    intensity : of the levels, rising, shape (levels,)
    seen : as in `found`
    fill : below the bracket no more than 1 / (fill + 1) of its levels follow each other without being looked at
    """
    top = len(intensity) - 1
    if not seen:
        return {0}
    known = found(seen, top + 1)
    if known.passed > top:
        step = _step_up(intensity, seen, known.held)
        return {step} if step is not None else set()
    return _close(intensity, seen, known) | _fill(seen, known, fill)


def _step_up(intensity: np.ndarray, seen: Mapping[int, float], held: int) -> int | None:
    """A level above all at which the motion holds, where demand in proportion would pass the limit."""
    last = max(seen)
    above = [level for level in range(held + 1, len(intensity)) if level not in seen]
    if not above:
        return None
    if held < 0:
        return above[0]  # all that was looked at failed
    demand = seen[held]
    factor = _LONGEST_STEP if demand * _LONGEST_STEP < _OVERSHOOT else _OVERSHOOT / demand
    wanted = int(np.searchsorted(intensity, factor * intensity[max(held, last)]))
    return _nearest(above, wanted)


def _nearest(levels: list[int], wanted: int) -> int:
    return min(levels, key=lambda level: (abs(level - wanted), level))


def _close(intensity: np.ndarray, seen: Mapping[int, float], known: Found) -> set[int]:
    """Levels inside the bracket: beside where a straight line through both ends meets the limit."""
    low, high = known.held, known.passed
    inside = [level for level in range(low + 1, high) if level not in seen]
    if not inside:
        return set()
    wanted = {inside[len(inside) // 2]} if len(inside) > _NARROW or low < 0 else set()
    if low >= 0:
        below, above = seen[low], seen[high]
        share = (1.0 - below) / (above - below)
        meets = intensity[low] + share * (intensity[high] - intensity[low])
        right = int(np.searchsorted(intensity, meets))
        for level in (right - 1, right):
            wanted.add(_nearest(inside, level))
    return wanted


def _fill(seen: Mapping[int, float], known: Found, fill: int) -> set[int]:
    """Levels below the bracket, so that none of the stretches between those looked at is too long."""
    if known.held < 1 or fill < 1:
        return set()
    longest = max(1, -(-known.held // (fill + 1)))
    stops = sorted({-1, *(level for level in seen if level <= known.held)})
    wanted: set[int] = set()
    for low, high in pairwise(stops):
        pieces = -(-(high - low) // longest)
        wanted |= {low + round(piece * (high - low) / pieces) for piece in range(1, pieces)}
    return wanted - set(seen)
