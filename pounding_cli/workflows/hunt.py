"""Incremental dynamic analysis that looks for the intensity at which one motion first passes a limit.

Hunt and fill (Vamvatsikos, D. and Cornell, C. A. (2004). Applied incremental dynamic analysis. Earthquake Spectra
20(2), 523-553): step up until the limit is passed, close the bracket, then look again below it, for demand need not
grow with intensity. The intensities are levels given beforehand, so that what is found is what all levels would have
told, but for a pass between two levels below that were looked at.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

UNDECIDED = float("-inf")
"""Demand over limit of a scene that a collapse ended before the limit was passed: the whole motion might have passed
it or not."""

_OVERSHOOT = 1.1
"""By how much the first step beyond a capacity aims too high: a bracket from above is worth more than another below."""

_LONGEST_STEP = 4.0
"""The intensity grows at most by this factor from one level to the next while none has passed."""


def next_levels(intensity: np.ndarray, seen: Mapping[int, float], fill: int) -> set[int]:
    """The levels of one motion to look at next; none when its bracket is closed and filled below.

    Parameters
    ----------
    intensity : of the levels, rising, shape (levels,)
    seen : number of a level -> demand over limit there; above 1 where the limit is passed, UNDECIDED where a collapse
        left that open, NaN where the scene failed
    fill : levels below the bracket that are looked at, evenly
    """
    if not seen:
        return {0}
    levels = len(intensity)
    # a collapse closes the bracket too: above it scenes tell nothing of other limits
    ended = min((level for level, demand in seen.items() if demand > 1 or demand == UNDECIDED), default=levels)
    held = max((level for level, demand in seen.items() if demand <= 1 and level < ended), default=-1)
    if ended == levels:  # a level above all at which the motion holds, where demand in proportion would pass the limit
        above = _unseen(seen, held, levels)
        if held < 0:
            return set(above[:1])  # all that was looked at failed
        factor = _LONGEST_STEP if seen[held] * _LONGEST_STEP < _OVERSHOOT else _OVERSHOOT / seen[held]
        wanted = int(np.searchsorted(intensity, factor * intensity[max(seen)]))
        return {min(above, key=lambda level: (abs(level - wanted), level))} if above else set()
    if between := _unseen(seen, held, ended):
        return {between[len(between) // 2]}
    return set(np.linspace(0, max(held, 0), fill + 2)[1:-1].round().astype(int).tolist()) - seen.keys()


def _unseen(seen: Collection[int], low: int, high: int) -> list[int]:
    """The levels between two that were not looked at."""
    return [level for level in range(low + 1, high) if level not in seen]
