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

UNDECIDED = float("-inf")
"""Demand over limit of a scene that a collapse ended before the limit was passed: the whole motion might have passed
it or not."""

_OVERSHOOT = 1.1
"""By how much the first step beyond a capacity aims too high: a bracket from above is worth more than another below."""

_LONGEST_STEP = 4.0
"""The intensity grows at most by this factor from one level to the next while none has passed."""

_STEP_UNDECIDED = 2.0
"""The intensity grows by this factor from one level to the next while a collapse leaves all undecided."""

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

    seen : number of a level -> demand over limit there; above 1 where the limit is passed, UNDECIDED where a collapse
        left that open, NaN where the scene failed
    levels : how many there are
    """
    passed = min((level for level, demand in seen.items() if demand > 1), default=levels)
    holds = [level for level, demand in seen.items() if demand <= 1 and demand != UNDECIDED]
    held = max((level for level in holds if level < passed), default=-1)
    return Found(held, passed, any(level > passed for level in holds))


def next_levels(intensity: np.ndarray, seen: Mapping[int, float], fill: int) -> set[int]:
    """The levels of one motion to look at next; none when its bracket is closed and filled below.

    Parameters
    ----------
    intensity : of the levels, rising, shape (levels,)
    seen : as in `found`
    fill : of the levels below the bracket, and of those between the lowest and the highest undecided one, no more than
        1 / (fill + 1) follow each other without being looked at
    """
    top = len(intensity) - 1
    if not seen:
        return {0}
    known = found(seen, top + 1)
    undecided = [level for level, demand in seen.items() if demand == UNDECIDED and known.held < level < known.passed]
    below = _fill(seen, -1, known.held, fill) if known.held >= 1 else set()
    if undecided:
        return below | _around(intensity, seen, known, undecided, fill)
    if known.passed > top:
        step = _step_up(intensity, seen, known.held)
        return {step} if step is not None else set()
    return below | _close(intensity, seen, known)


def _around(
    intensity: np.ndarray, seen: Mapping[int, float], known: Found, undecided: list[int], fill: int
) -> set[int]:
    """Levels around those that a collapse leaves undecided, then among them.

    Around: between the highest at which the motion holds and the lowest undecided one, and between the highest
    undecided one and the lowest that passes, or up to the top.
    """
    lowest, highest = min(undecided), max(undecided)
    below = [level for level in range(known.held + 1, lowest) if level not in seen]
    above = [level for level in range(highest + 1, known.passed) if level not in seen]
    wanted = {below[len(below) // 2]} if below else set()
    if above and known.passed == len(intensity):
        step = int(np.searchsorted(intensity, _STEP_UNDECIDED * intensity[highest]))
        wanted.add(_nearest(above, step))
    elif above:
        wanted.add(above[len(above) // 2])
    return wanted or _fill(seen, lowest, highest, fill)


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


def _fill(seen: Mapping[int, float], low: int, high: int, fill: int) -> set[int]:
    """Levels between two, so that none of the stretches between those looked at is too long."""
    if fill < 1 or high <= low:
        return set()
    longest = max(1, -(-(high - max(low, 0)) // (fill + 1)))
    stops = sorted({low, *(level for level in seen if low <= level <= high)})
    wanted: set[int] = set()
    for one, other in pairwise(stops):
        pieces = -(-(other - one) // longest)
        wanted |= {one + round(piece * (other - one) / pieces) for piece in range(1, pieces)}
    return wanted - set(seen)
