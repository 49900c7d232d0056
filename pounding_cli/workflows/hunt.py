"""Incremental dynamic analysis that looks for the intensity at which one motion first passes a limit.

Hunt and fill (Vamvatsikos, D. and Cornell, C. A. (2004). Applied incremental dynamic analysis. Earthquake Spectra
20(2), 523-553): step up until the limit is passed, close the bracket, then look again below it, for demand need not
grow with intensity. The intensities are levels given beforehand, so that what is found is what all levels would have
told, but for a pass between two levels below that were looked at.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
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


def next_levels(intensity: np.ndarray, seen: Mapping[int, float], fill: int) -> set[int]:
    """The levels of one motion to look at next; none when its bracket is closed and filled below.

    Parameters
    ----------
    intensity : of the levels, rising, shape (levels,)
    seen : number of a level -> demand over limit there; above 1 where the limit is passed, UNDECIDED where a collapse
        left that open, NaN where the scene failed
    fill : of the levels below the bracket, and of those between the lowest and the highest undecided one, no more than
        1 / (fill + 1) follow each other without being looked at
    """
    if not seen:
        return {0}
    levels = len(intensity)
    passed = min((level for level, demand in seen.items() if demand > 1), default=levels)
    held = max((level for level, demand in seen.items() if UNDECIDED < demand <= 1 and level < passed), default=-1)
    undecided = [level for level, demand in seen.items() if demand == UNDECIDED and held < level < passed]
    below = _fill(seen, -1, held, fill) if held >= 1 else set()
    if undecided:
        # around them: between the highest at which the motion holds and the lowest undecided one, and between the
        # highest undecided one and the lowest that passes, or up to the top; then among them
        lowest, highest = min(undecided), max(undecided)
        around = _middle(seen, held, lowest)
        if passed == levels:
            step = int(np.searchsorted(intensity, _STEP_UNDECIDED * intensity[highest]))
            around |= _nearest(_unseen(seen, highest, passed), step)
        else:
            around |= _middle(seen, highest, passed)
        return below | (around or _fill(seen, lowest, highest, fill))
    if passed == levels:  # a level above all at which the motion holds, where demand in proportion would pass the limit
        above = _unseen(seen, held, levels)
        if held < 0:
            return set(above[:1])  # all that was looked at failed
        factor = _LONGEST_STEP if seen[held] * _LONGEST_STEP < _OVERSHOOT else _OVERSHOOT / seen[held]
        return _nearest(above, int(np.searchsorted(intensity, factor * intensity[max(seen)])))
    return below | _middle(seen, held, passed)


def _unseen(seen: Collection[int], low: int, high: int) -> list[int]:
    """The levels between two that were not looked at."""
    return [level for level in range(low + 1, high) if level not in seen]


def _middle(seen: Collection[int], low: int, high: int) -> set[int]:
    levels = _unseen(seen, low, high)
    return {levels[len(levels) // 2]} if levels else set()


def _nearest(levels: list[int], wanted: int) -> set[int]:
    return {min(levels, key=lambda level: (abs(level - wanted), level))} if levels else set()


def _fill(seen: Collection[int], low: int, high: int, fill: int) -> set[int]:
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
