"""What Fig. 5 shows: both ratios over frequency; found to rounding, their peaks and where both exceed one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from pounding_cli.connector.oscillators import Oscillators, coupled_frequencies, response_ratios
from pounding_cli.variables import Variable

FINEST = 4001
"""Grid on which peaks are searched at least."""


@dataclass(frozen=True)
class Question:
    """Two oscillators and where their ratios are asked for: `points` of Omega / omega10 from `low` to `high` [-]."""

    pair: Oscillators
    low: float
    high: float
    points: int


@dataclass(frozen=True)
class Findings:
    """Peaks and both-above-one bands over a range of frequency ratios.

    peak1, peak2 : largest |R1| and |R2| [-]; at1, at2 : Omega / omega10 where they stand [-]
    both_above : bands of Omega / omega10 in which |R1| > 1 and |R2| > 1, shape (n, 2)
    frequency_low, frequency_high : coupled frequencies over omega10 [-]
    """

    peak1: float
    at1: float
    peak2: float
    at2: float
    both_above: np.ndarray
    frequency_low: float
    frequency_high: float


@dataclass(frozen=True, eq=False)
class Answer:
    """Both ratios over frequency, and what they show.

    frequency : Omega / omega10 [-], shape (n,)
    R1, R2 : displacement connected over alone [-], shape (n,): sizes, real and imaginary parts
    """

    frequency: np.ndarray
    R1: np.ndarray
    R1_real: np.ndarray
    R1_imag: np.ndarray
    R2: np.ndarray
    R2_real: np.ndarray
    R2_imag: np.ndarray
    found: Findings


_OVER = ("frequency",)

VARIABLES = (
    Variable("peak1", (), "1", "largest ratio of system 1", of="found.peak1", label="largest |R1|"),
    Variable("at1", (), "1", "Omega / omega10 at the peak of system 1", of="found.at1", label="at Ω/ω10"),
    Variable("peak2", (), "1", "largest ratio of system 2", of="found.peak2", label="largest |R2|"),
    Variable("at2", (), "1", "Omega / omega10 at the peak of system 2", of="found.at2", label="at Ω/ω10"),
    Variable("frequency_low", (), "1", "lower coupled frequency over omega10", of="found.frequency_low",
        label="lower coupled frequency/ω10"),
    Variable("frequency_high", (), "1", "higher coupled frequency over omega10", of="found.frequency_high",
        label="higher coupled frequency/ω10"),
    Variable("p", (), "1", "omega20 / omega10", of="model.pair.p", label="p = ω20/ω10"),
    Variable("frequency", _OVER, "1", "Omega / omega10"),
    Variable("R1", _OVER, "1", "displacement of system 1, connected over alone"),
    Variable("R1_real", _OVER, "1", "displacement of system 1, connected over alone, real part"),
    Variable("R1_imag", _OVER, "1", "displacement of system 1, connected over alone, imaginary part"),
    Variable("R2", _OVER, "1", "displacement of system 2, connected over alone"),
    Variable("R2_real", _OVER, "1", "displacement of system 2, connected over alone, real part"),
    Variable("R2_imag", _OVER, "1", "displacement of system 2, connected over alone, imaginary part"),
    Variable(
        "both_above", ("band", "edge"), "1", "bands of Omega / omega10 in which both ratios exceed one",
        of="found.both_above",
    ),
)  # fmt: skip
"""Those without dimensions are numbers of the table `connector`."""


def answer(question: Question) -> Answer:
    """The ratios asked for, and what they show."""
    pair, low, high = question.pair, question.low, question.high
    ratio = np.linspace(low, high, question.points)
    found = find(pair, low, high, max(question.points, FINEST))
    r1, r2 = response_ratios(pair, ratio * pair.omega10)
    return Answer(ratio, np.abs(r1), r1.real, r1.imag, np.abs(r2), r2.real, r2.imag, found)


def find(pair: Oscillators, low: float = 0.05, high: float = 2.0, points: int = FINEST) -> Findings:
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
    return Findings(*first, *second, np.array(crossings).reshape(-1, 2), lower / pair.omega10, upper / pair.omega10)
