"""Search for the least value of a function over the unit cube.

Differential evolution (Storn, R. and Price, K. (1997). Differential evolution. Journal of Global Optimization 11,
341-359) finds the valley, the simplex method (Nelder, J. A. and Mead, R. (1965). A simplex method for function
minimization. The Computer Journal 7(4), 308-313) its bottom, both by SciPy. Then the function is looked at along every
coordinate; where that finds a lower point, the search goes on from there.

The points follow from the seed and the values alone. A search that is begun again looks at the same points.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import product
from typing import Any

import numpy as np
from scipy.optimize import differential_evolution, minimize
from scipy.stats import qmc

from pounding_cli.errors import InputError
from pounding_cli.questions.optimise.spec import OptimiseSpec

SearchPoint = tuple[float, ...]
"""Coordinates between 0 and 1."""

Function = Callable[[list[SearchPoint], bool], np.ndarray]
"""function(points, rough) -> values, NaN where there is none, shape (points,). `rough`: these points only lead to the
valley, whose bottom later ones look at."""

UNMET = 1e30
"""The value of a point that does not meet what is required, times one and more: by how much it misses it."""

WRITTEN, SEARCH, POLISH, SLICES = "as written", "search", "polish", "slices"
"""The stages."""

_DIGITS = 9
"""Of a coordinate: points closer than that are one."""

_MAX_COMBINATIONS = 200
"""Combinations of choices that are all evaluated."""

_SPREAD = 1e-3
"""Standard deviation of the values of a population over their mean [-]: below, it has found its valley."""

_SIMPLEX = (0.05, 0.02, 0.01)
"""Edges of the simplex, one polish after the other: where the function has a kink, the first may get stuck."""

_GAIN = 1e-5
"""A polish that gains less is the last [-]."""

_SAME = 1e-6
"""A point along a coordinate that is lower by less is no better than the best one [-]."""

_RETURNS = 3
"""Times that the search goes on from a lower point along a coordinate."""


def evaluate_kink(points: list[SearchPoint], rough: bool) -> np.ndarray:
    """Return a function with one kink, as the largest of several responses has; a search for its lowest point looks at
    about as many points as one for theirs."""
    x = np.array(points)
    lowest = np.modf(0.618 * np.arange(1, x.shape[1] + 1))[0]
    return 1.0 + np.abs(x - lowest).sum(axis=1)


class Search:
    """A search for the point of the least value.

    Parameters
    ----------
    function : the function that is minimised
    options : of every coordinate how many values it chooses from; 0 where it is continuous
    spec : settings of the search
    written_point : the point that the study stands for as written; None for none

    Attributes
    ----------
    values : the value of every point that was evaluated, in that order; infinite where it has none
    stages : the stage for which each was evaluated
    best_point : the point of the least value, the first of several; None where no point has a value
    is_converged : whether the population came together before its generations were spent
    """

    def __init__(
        self,
        function: Function,
        options: Sequence[int],
        spec: OptimiseSpec | None = None,
        written_point: SearchPoint | None = None,
    ) -> None:
        self.function = function
        self.options = tuple(options)
        self.spec = spec or OptimiseSpec()
        self.written_point = None if written_point is None else self.snap(written_point)
        self.continuous = [place for place, count in enumerate(options) if not count]
        self.values: dict[SearchPoint, float] = {}
        self.stages: list[str] = []
        self.best_point: SearchPoint | None = None
        self.is_converged = True

    def snap(self, point: Sequence[float]) -> SearchPoint:
        """Return the point under which a point is known: rounded, choices in the middle of their share."""
        return tuple(
            (min(int(u * options), options - 1) + 0.5) / options if options else round(float(u), _DIGITS)
            for u, options in zip(np.clip(point, 0.0, 1.0).tolist(), self.options, strict=True)
        )

    def run(self) -> None:
        """Search for the best point."""
        if self.written_point is not None:
            self._evaluate([self.written_point], WRITTEN)
        slices = [  # values of the coordinates: every choice, or points from end to end
            [(each + 0.5) / options for each in range(options)] or np.linspace(0, 1, self.spec.slice_points).tolist()
            for options in self.options
        ]
        if not self.continuous and np.prod(self.options) <= _MAX_COMBINATIONS:
            self._evaluate(list(product(*slices)), SEARCH)
            self._take_lowest()
            return
        self._evolve()
        self._take_lowest()
        for _ in range(_RETURNS):
            if self.best_point is None:
                return
            if self.continuous:
                self._polish(self.best_point)
                self._take_lowest()
            best = self.best_point
            along = [self._with_coordinates(best, {place: u}) for place, line in enumerate(slices) for u in line]
            self._evaluate(along, SLICES)
            if not self._take_lowest(_SAME):
                return

    def _take_lowest(self, min_gain: float = 0.0) -> bool:
        """Make the lowest point the best one where it is lower than that; return whether it is.

        min_gain : share of the value by which it must be lower [-]
        """
        lowest = min(self.values, key=self.values.__getitem__)
        best = self.best_point
        is_lower = best is None or self.values[best] - self.values[lowest] > min_gain * abs(self.values[best])
        if is_lower and np.isfinite(self.values[lowest]):
            self.best_point = lowest
        return is_lower

    def _evaluate(self, points: Sequence[Sequence[float]], stage: str) -> np.ndarray:
        """Return the values at points, computed where they are not known; infinite where there is none."""
        keys = [self.snap(point) for point in points]
        new = [key for key in dict.fromkeys(keys) if key not in self.values]
        if new:
            values = self.function(new, stage == SEARCH and bool(self.continuous))
            self.values |= zip(new, np.where(np.isnan(values), np.inf, values).tolist(), strict=True)
            self.stages += [stage] * len(new)
        return np.array([self.values[key] for key in keys])

    def _with_coordinates(self, point: SearchPoint, moves: dict[int, float]) -> SearchPoint:
        """Return a point with other values of some coordinates."""
        return self.snap([moves.get(place, u) for place, u in enumerate(point)])

    def _evolve(self) -> None:
        """Run differential evolution until all points of a generation are nearly as good."""
        size = len(self.options)
        population = qmc.LatinHypercube(size, rng=self.spec.seed).random(self.spec.population or max(20, 12 * size))

        def callback(intermediate_result: Any) -> None:
            if not np.isfinite(intermediate_result.population_energies).any():
                raise StopIteration  # no point has a value

        try:
            evolution = differential_evolution(
                lambda x: self._evaluate(x.T, SEARCH), [(0.0, 1.0)] * size, init=population,
                maxiter=self.spec.generations, tol=_SPREAD, polish=False, updating="deferred", vectorized=True,
                callback=callback, rng=self.spec.seed,
            )  # fmt: skip
        except RuntimeError as error:  # SciPy takes every ValueError for a fault of its own caller's
            raise error.__cause__ if isinstance(error.__cause__, InputError) else error from None
        self.is_converged = bool(evolution.success)

    def _polish(self, best: SearchPoint) -> None:
        """Run the simplex method from the best point, choices kept."""
        for edge in _SIMPLEX:
            before = self.values[best]
            begin = np.array([best[place] for place in self.continuous])
            corners = begin + np.vstack([np.zeros(begin.size), edge * np.diag(np.where(begin + edge > 1, -1.0, 1.0))])
            options = {
                "initial_simplex": corners, "xatol": 1e-4, "fatol": max(1e-7 * abs(before), 1e-300),
                "maxfev": 60 * len(corners), "adaptive": len(corners) > 4,
            }  # fmt: skip

            def evaluate_corner(x: np.ndarray, best: SearchPoint = best) -> float:
                moves = dict(zip(self.continuous, x.tolist(), strict=True))
                return float(self._evaluate([self._with_coordinates(best, moves)], POLISH)[0])

            minimize(evaluate_corner, begin, method="Nelder-Mead", bounds=[(0.0, 1.0)] * begin.size, options=options)
            best = min(self.values, key=self.values.__getitem__)
            if before - self.values[best] <= _GAIN * abs(before):
                return
