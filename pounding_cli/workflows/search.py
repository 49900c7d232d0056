"""The least of a function over the unit cube.

Differential evolution (Storn, R. and Price, K. (1997). Differential evolution. Journal of Global Optimization 11,
341-359) finds the valley, the simplex method (Nelder, J. A. and Mead, R. (1965). A simplex method for function
minimization. The Computer Journal 7(4), 308-313) its bottom, both by SciPy. Then the surroundings are looked at: along
every coordinate, where the function leaves the bottom, and over the two coordinates that matter most. Where that finds
a lower point, the search goes on from there.

The points follow from the seed and the values alone. A search that is begun again looks at the same points.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy.optimize import differential_evolution, minimize
from scipy.stats import qmc

from pounding_cli.errors import InputError

Point = tuple[float, ...]
"""Coordinates between 0 and 1."""

Function = Callable[[list[Point], bool], tuple[np.ndarray, np.ndarray]]
"""function(points, rough) -> values, NaN where there is none, and their errors, NaN where not known; shape (points,).
`rough`: these points only lead to the valley, whose bottom later ones look at."""

WRITTEN, SEARCH, POLISH, SLICES, MAP = "as written", "search", "polish", "slices", "map"
"""The stages."""

FLAT = 0.01
"""The bottom is where the function is within this share of its least value [-]."""

_DIGITS = 9
"""Of a coordinate: points closer than that are one."""

_FEW_COMBINATIONS = 200
"""So many combinations of choices are all looked at."""

_SPREAD = 1e-3
"""Values of a population, relative: below, it has found its valley [-]."""

_SIMPLEX = (0.05, 0.02, 0.01)
"""Edges of the simplex, one polish after the other: where the function has a kink, the first may get stuck."""

_GAIN = 1e-5
"""A polish that gains less is the last [-]."""

_SAME = 1e-6
"""A point that is lower by less is no better than the best one [-]."""

_NARROW = 1e-3
"""Width of the interval in which the function leaves the bottom."""

_RETURNS = 3
"""Times that the search goes on from a lower point that its surroundings hold."""


@dataclass(frozen=True)
class Settings:
    """How a search goes.

    population : points of a generation; by the number of coordinates unless given
    generations : at most
    slice_points : along every coordinate
    map_points : along each of the two coordinates of the map
    """

    seed: int = 1
    population: int | None = None
    generations: int = 100
    slice_points: int = 21
    map_points: int = 15


class Search:
    """A search, and what it found.

    Parameters
    ----------
    function : what is minimised
    options : of every coordinate how many values it chooses from; 0 where it is continuous
    written : the point from which the user comes; None for none

    Attributes
    ----------
    values, errors, stages : of every point that was looked at, in that order
    flat : of continuous coordinates, between which ends the function stays on its bottom, the others at the best point
    mapped : the two coordinates of the map; None where there is none
    is_settled : whether the population came together before its generations were spent
    """

    def __init__(
        self, function: Function, options: Sequence[int], settings: Settings | None = None, written: Point | None = None
    ) -> None:
        self.function, self.options, self.settings = function, tuple(options), settings or Settings()
        self.written = None if written is None else self.key(written)
        self.values: dict[Point, float] = {}
        self.errors: dict[Point, float] = {}
        self.stages: dict[Point, str] = {}
        self.flat: dict[int, tuple[float, float]] = {}
        self.mapped: tuple[int, int] | None = None
        self.is_settled = True
        self._centre: Point | None = None

    @property
    def best(self) -> Point | None:
        """The point of the least value, the first of several; None where no point has a value.

        The one that was polished stays it until a lower one is found.
        """
        found = min(self.values, key=self._ranked, default=None)
        if found is None or np.isnan(self.values[found]):
            return None
        centre = self._centre
        if centre is not None and self.values[centre] - self.values[found] <= _SAME * abs(self.values[centre]):
            return centre
        return found

    @property
    def error(self) -> float:
        """The error of the least value; where it is not known, the largest known on the bottom; NaN: there is none."""
        assert self.best is not None
        own, least = self.errors[self.best], self.values[self.best]
        if not np.isnan(own):
            return own
        near = [self.errors[point] for point, value in self.values.items() if value <= least + FLAT * abs(least)]
        return max((error for error in near if not np.isnan(error)), default=np.nan)

    @property
    def tolerance(self) -> float:
        """By how much the function may lie above its least value on the bottom: its error, or a share of it."""
        assert self.best is not None
        error = self.error
        return max(0.0 if np.isnan(error) else error, FLAT * abs(self.values[self.best]))

    @property
    def continuous(self) -> list[int]:
        """The coordinates that are."""
        return [number for number, options in enumerate(self.options) if not options]

    def key(self, point: Sequence[float]) -> Point:
        """The point as it is known: choices in the middle of their share."""
        return tuple(
            (min(int(u * options), options - 1) + 0.5) / options if options else round(float(u), _DIGITS)
            for u, options in zip(np.clip(point, 0.0, 1.0).tolist(), self.options, strict=True)
        )

    def moved(self, point: Point, moves: dict[int, float]) -> Point:
        """A point with other values of some coordinates."""
        return self.key([moves.get(number, u) for number, u in enumerate(point)])

    def _along(self, number: int, best: Point) -> tuple[np.ndarray, np.ndarray]:
        """What is known along a coordinate through a point: coordinate, rising, and value."""
        line = sorted(
            (point[number], value) for point, value in self.values.items()
            if all(u == v for place, (u, v) in enumerate(zip(point, best, strict=True)) if place != number)
        )  # fmt: skip
        return np.array([u for u, _ in line]), np.array([value for _, value in line])

    def _ranked(self, point: Point) -> float:
        value = self.values[point]
        return np.inf if np.isnan(value) else value

    # The stages

    def run(self) -> None:
        """Search."""
        if self.written is not None:
            self._look([self.written], WRITTEN)
        combinations = [[(place + 0.5) / options for place in range(options)] for options in self.options]
        if not self.continuous and np.prod(self.options) <= _FEW_COMBINATIONS:
            self._look(list(product(*combinations)), SEARCH)
            return
        self._evolve()
        for _ in range(_RETURNS):
            self._centre = None
            if self.best is None:
                return
            if self.continuous:
                self._polish()
            self._centre = self.best
            self._surroundings()
            if self.best == self._centre:
                return

    def _look(self, points: Sequence[Sequence[float]], stage: str) -> np.ndarray:
        """The values at points, worked out where they are not known; infinite where there is none."""
        keys = [self.key(point) for point in points]
        if new := [key for key in dict.fromkeys(keys) if key not in self.values]:
            values, errors = self.function(new, stage == SEARCH and bool(self.continuous))
            self.values |= zip(new, values.tolist(), strict=True)
            self.errors |= zip(new, errors.tolist(), strict=True)
            self.stages |= dict.fromkeys(new, stage)
        return np.array([self._ranked(key) for key in keys])

    def _evolve(self) -> None:
        """Differential evolution, a generation at a time, until all points of one are nearly as good."""
        size, seed = len(self.options), self.settings.seed
        number = self.settings.population or max(20, 12 * size)
        population = qmc.LatinHypercube(size, rng=np.random.default_rng(seed)).random(number)
        values = self._look(population, SEARCH)
        for generation in range(self.settings.generations):
            if not np.isfinite(values).any() or _is_close(values):
                return
            with _refusals():
                found = differential_evolution(
                    lambda x: self._look(x.T, SEARCH), [(0.0, 1.0)] * size, init=population, maxiter=1, polish=False,
                    tol=0.0, atol=0.0, updating="deferred", vectorized=True,
                    rng=np.random.default_rng([seed, generation]),
                )  # fmt: skip
            population, values = found.population, found.population_energies
        self.is_settled = _is_close(values)

    def _polish(self) -> None:
        """The simplex method from the best point, choices kept."""
        for edge in _SIMPLEX:
            best = self.best
            assert best is not None
            before, places = self.values[best], self.continuous
            begin = np.array([best[place] for place in places])
            corners = begin + np.vstack([np.zeros(begin.size), edge * np.diag(np.where(begin + edge > 1, -1.0, 1.0))])

            options = {
                "initial_simplex": corners, "xatol": 1e-4, "fatol": max(1e-7 * abs(before), 1e-300),
                "maxfev": 60 * len(corners), "adaptive": len(corners) > 4,
            }  # fmt: skip

            def of(x: np.ndarray, best: Point = best, places: list[int] = places) -> float:
                return float(self._look([self.moved(best, dict(zip(places, x.tolist(), strict=True)))], POLISH)[0])

            minimize(of, corners[0], method="Nelder-Mead", bounds=[(0.0, 1.0)] * begin.size, options=options)
            assert self.best is not None
            if before - self.values[self.best] <= _GAIN * abs(before):
                return

    def _surroundings(self) -> None:
        """Slices through the best point, the ends of its flat bottom, and a map over two coordinates."""
        best = self.best
        assert best is not None
        line = np.linspace(0.0, 1.0, self.settings.slice_points).tolist()
        points = []
        for number, options in enumerate(self.options):
            across = [(place + 0.5) / options for place in range(options)] if options else line
            points += [self.moved(best, {number: u}) for u in across]
        self._look(points, SLICES)
        if self.best != best:
            return
        self._ends(best)
        if self.best != best or len(self.continuous) < 2:
            return
        one, other = sorted(sorted(self.continuous, key=lambda number: self.flat[number][1] - self.flat[number][0])[:2])
        self.mapped = one, other
        line = np.linspace(0.0, 1.0, self.settings.map_points).tolist()
        self._look([self.moved(best, {one: u, other: v}) for u in line for v in line], MAP)

    def _ends(self, best: Point) -> None:
        """Halve the intervals in which the function leaves the bottom, on both sides of every coordinate at once."""
        while True:
            middles = [
                self.moved(best, {number: (inside + outside) / 2})
                for number in self.continuous for inside, outside in self._leaving(number, best)
                if outside is not None and abs(outside - inside) > _NARROW
            ]  # fmt: skip
            if not middles:
                break
            self._look(middles, SLICES)
            if self.best != best:  # the search goes on from there
                return
        for number in self.continuous:
            (low, _), (high, _) = self._leaving(number, best)
            self.flat[number] = low, high

    def _leaving(self, number: int, best: Point) -> list[tuple[float, float | None]]:
        """Below and above the best point: the last coordinate on the bottom and the first beyond it, None for none."""
        u, values = self._along(number, best)
        is_in = values <= self.values[best] + self.tolerance
        here, found = int(np.flatnonzero(u == best[number])[0]), []
        for step, end in ((-1, -1), (1, u.size)):
            place = here
            while place + step != end and is_in[place + step]:
                place += step
            found.append((float(u[place]), None if place + step == end else float(u[place + step])))
        return found


def _is_close(values: np.ndarray) -> bool:
    """Whether a population has found its valley."""
    return bool(np.isfinite(values).all() and values.std() <= _SPREAD * abs(values.mean()))


@contextlib.contextmanager
def _refusals() -> Iterator[None]:
    """An `InputError` of the function comes through: SciPy takes every ValueError for a fault of its own caller's."""
    try:
        yield
    except RuntimeError as error:
        if isinstance(error.__cause__, InputError):
            raise error.__cause__ from None
        raise
