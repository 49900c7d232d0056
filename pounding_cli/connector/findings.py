"""What Fig. 5 shows, found to rounding: peaks of both ratios, frequencies where both exceed one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from pounding_cli.connector.oscillators import Oscillators, coupled_frequencies, response_ratios


@dataclass(frozen=True)
class Findings:
    """Peaks and both-above-one bands over a range of frequency ratios.

    peak1, peak2 : largest |R1| and |R2| [-]; at1, at2 : Omega / omega10 where they stand [-]
    both_above : bands of Omega / omega10 in which |R1| > 1 and |R2| > 1, shape (n, 2)
    frequencies : coupled frequencies over omega10 [-], lower first
    """

    peak1: float
    at1: float
    peak2: float
    at2: float
    both_above: np.ndarray
    frequencies: tuple[float, float]


def find(pair: Oscillators, low: float = 0.05, high: float = 2.0, points: int = 4001) -> Findings:
    """Search Omega / omega10 between `low` and `high` [-]: a grid of `points`, then refined.

    Two features closer together than one grid interval are seen as one.
    """
    grid = np.linspace(low, high, points)

    def sizes(x: np.ndarray | float) -> tuple[np.ndarray, np.ndarray]:
        r1, r2 = response_ratios(pair, np.asarray(x) * pair.omega10)
        return np.abs(r1), np.abs(r2)

    def peak(which: int) -> tuple[float, float]:
        best = int(np.argmax(sizes(grid)[which]))
        left, right = grid[max(best - 1, 0)], grid[min(best + 1, points - 1)]
        top = minimize_scalar(lambda x: -float(sizes(x)[which]), bounds=(left, right), options={"xatol": 1e-10})
        candidates = [(float(sizes(x)[which]), float(x)) for x in (top.x, grid[best])]
        return max(candidates)

    def both(x: float) -> float:
        return float(min(*sizes(x))) - 1.0

    smaller = np.minimum(*sizes(grid)) - 1.0
    # A ratio that is one throughout (no connector, equal systems) is not above one: rounding is left out.
    above = smaller > 1e-12
    edges = np.flatnonzero(above[1:] != above[:-1])
    crossings = [
        brentq(both, grid[i], grid[i + 1], xtol=1e-14) if smaller[i] * smaller[i + 1] < 0 else float(grid[i])
        for i in edges
    ]
    if above[0]:
        crossings.insert(0, low)
    if above[-1]:
        crossings.append(high)
    first, second = peak(0), peak(1)
    lower, upper = coupled_frequencies(pair)
    return Findings(*first, *second, np.array(crossings).reshape(-1, 2), (lower / pair.omega10, upper / pair.omega10))
