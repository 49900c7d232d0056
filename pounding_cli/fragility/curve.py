"""A fragility curve: the probability that a limit is passed, over an intensity, as a lognormal distribution."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from scipy.special import ndtr


class Outcome(StrEnum):
    """What came of a fit; only `FITTED` has a median and a spread."""

    FITTED = "fitted"
    NEVER = "never passed"
    ALWAYS = "always passed"
    SEPARATED = "no overlap"
    FLAT = "no trend"
    FEW = "too few"
    UNDECIDED = "undecided"

    @property
    def meaning(self) -> str:
        """The outcome in a sentence."""
        return _MEANINGS[self]


_MEANINGS = {
    Outcome.FITTED: "a median and a spread were found",
    Outcome.NEVER: "no motion passes the limit at any solved intensity: the median lies above them",
    Outcome.ALWAYS: "every motion passes the limit at every solved intensity: the median lies below them",
    Outcome.SEPARATED: "below one intensity all hold, above it all pass: the spread is too small to be seen",
    Outcome.FLAT: "the limit is not passed more often at higher intensities: no rising curve fits",
    Outcome.FEW: "too few motions or intensities to tell the median from the spread",
    Outcome.UNDECIDED: "in half of the motions or more a collapse ended the scenes before the limit was passed: "
    "there is no curve",
}


@dataclass(frozen=True)
class Curve:
    """A lognormal fragility curve, P(passed | x) = Phi(ln(x / median) / spread), or why there is none.

    outcome : outcome of the fit
    motions : motions it rests on
    median, spread : median [unit of the intensity] and logarithmic standard deviation [-]; None unless fitted
    between : the intensities that hold the median, (0, inf) where neither end is known; of a fit the median twice
    """

    outcome: Outcome
    motions: int
    median: float | None
    spread: float | None
    between: tuple[float, float]

    def probability(self, intensity: np.ndarray) -> np.ndarray:
        """The probability that the limit is passed [-], shape as `intensity`, all above 0.  Raises ValueError unless
        fitted."""
        if self.median is None or self.spread is None:
            raise ValueError(f"there is no curve: {self.outcome.meaning}")
        return ndtr(np.log(np.asarray(intensity, dtype=float) / self.median) / self.spread)
