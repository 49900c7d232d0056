"""The tables of `pound fragility`: a curve for every limit, alone and with pounding, and what each motion said."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    pass

CURVES, MOTIONS = "fragility", "fragility_motions"
"""Names of the tables."""

_ALONE = {"mu": "mu0", "drift": "drift0", "acceleration": "acceleration0"}


class Sample(NamedTuple):
    """What one curve rests on.

    demand : over limit [-], NaN where the scene failed or was not asked for, shape (motions, levels)
    asked : which scenes were, same shape
    error : numerical error of the demand, relative [-], same shape; NaN where it was not estimated
    """

    demand: np.ndarray
    asked: np.ndarray
    error: np.ndarray

    @property
    def failed(self) -> int:
        """Scenes asked for that gave no demand."""
        return int((self.asked & np.isnan(self.demand)).sum())
