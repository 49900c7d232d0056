"""The plan of a building whose floors twist: rotary inertias, frame lines along the row, and lines across it.

Places across the row are told in three ways, all in metres and the same way for all buildings: `y` as studies write it,
from the middle of a plan; `street`, along the street that the row faces, from one origin for the whole row; `arm`, from
the centre of mass of a floor. So street = shift + y = (street of the centre of mass) + arm.

A floor that moves along the row by u and turns by theta, positive from the row to the street, moves by u - arm theta at
an arm, and by x theta across the row at x along the row from its centre of mass."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pounding_cli.model.stiffness import frequencies

SAME = 1e-12
"""Relative difference of two numbers [-] that count as equal, since both were computed."""


def find_square_radii(inertia: np.ndarray, mass: np.ndarray) -> np.ndarray:
    """Return the squares of the radii of gyration of what stands above every storey [m2], shape (n,).

    inertia, mass : of the floors [kg m2], [kg], shape (n,)
    """
    return np.asarray(np.cumsum(inertia[::-1])[::-1] / np.cumsum(mass[::-1])[::-1])


def _as_storeys(values: np.ndarray, storeys: int, name: str) -> np.ndarray:
    """Return numbers of every storey as an array that nobody changes.  Raises ValueError: there are not so many."""
    array = np.array(values, dtype=float)
    array.setflags(write=False)
    if array.shape != (storeys,):
        raise ValueError(f"plan: {name} has shape {array.shape}, expected ({storeys},)")
    return array


@dataclass(frozen=True, eq=False)
class FrameLine:
    """Frames or walls of one line, which resist its floors; arrays run from the ground up, shape (n,).

    Parameters
    ----------
    name : what tables call it
    arm : from the centres of mass [m]; of a line across the row along the row
    stiffness : initial stiffness of every storey [N/m], > 0
    yield_shear : of every storey [N], > 0; inf where it cannot yield
    """

    name: str
    arm: float
    stiffness: np.ndarray
    yield_shear: np.ndarray

    def __post_init__(self) -> None:
        storeys = np.size(self.stiffness)
        for name in ("stiffness", "yield_shear"):
            array = _as_storeys(getattr(self, name), storeys, f"{name} of line {self.name}")
            object.__setattr__(self, name, array)
            if not (array > 0).all():
                raise ValueError(f"plan: {name} of line {self.name} must be above zero")
        if not np.isfinite(self.stiffness).all():
            raise ValueError(f"plan: stiffness of line {self.name} must be finite")


@dataclass(frozen=True, eq=False)
class FloorPlan:
    """Rotary inertias, frame lines and edges of a building whose floors twist.

    Parameters
    ----------
    inertia : rotary inertias of the floors about the vertical axes through their centres of mass [kg m2], > 0,
        shape (n,)
    lines : along the row
    torsional_stiffness : of elastic lines across the row [N m], >= 0, shape (n,)
    lines_across : further lines across the row, which may yield
    low, high : arms of the edges of the floors [m]
    street : place of the centres of mass along the street [m]
    twists_always : whether the floors may turn although nothing is eccentric

    Raises
    ------
    ValueError : an array has another shape, or a value is outside its range
    """

    inertia: np.ndarray
    lines: tuple[FrameLine, ...]
    torsional_stiffness: np.ndarray
    lines_across: tuple[FrameLine, ...] = ()
    low: float = 0.0
    high: float = 0.0
    street: float = 0.0
    twists_always: bool = False

    def __post_init__(self) -> None:
        storeys = np.size(self.inertia)
        for name in ("inertia", "torsional_stiffness"):
            object.__setattr__(self, name, _as_storeys(getattr(self, name), storeys, name))
        if not (np.isfinite(self.inertia).all() and (self.inertia > 0).all()):
            raise ValueError("plan: inertia must be finite and above zero")
        if not (np.isfinite(self.torsional_stiffness).all() and (self.torsional_stiffness >= 0).all()):
            raise ValueError("plan: torsional_stiffness must be finite and not negative")
        if not self.lines:
            raise ValueError("plan: no lines along the row; give at least one")
        for line in (*self.lines, *self.lines_across):
            if line.stiffness.shape != (storeys,):
                raise ValueError(f"plan: line {line.name} has {line.stiffness.size} storeys, not {storeys}")
        if not self.low <= self.high:
            raise ValueError("plan: low must not be above high")

    @property
    def storeys(self) -> int:
        """Number of storeys n."""
        return self.inertia.size

    @cached_property
    def all_lines(self) -> tuple[FrameLine, ...]:
        """Its lines along the row, and behind them those across it."""
        return (*self.lines, *self.lines_across)

    @cached_property
    def stiffness(self) -> np.ndarray:
        """Storey stiffnesses along the row, the sums of their lines [N/m], shape (n,)."""
        return np.sum([line.stiffness for line in self.lines], axis=0)

    @cached_property
    def yield_shear(self) -> np.ndarray:
        """Storey yield shears along the row, the sums of their lines [N], shape (n,)."""
        return np.sum([line.yield_shear for line in self.lines], axis=0)

    @cached_property
    def eccentricity(self) -> np.ndarray:
        """Arms of the centres of stiffness [m], shape (n,)."""
        return np.sum([line.arm * line.stiffness for line in self.lines], axis=0) / self.stiffness

    def storey_matrices(self, share: np.ndarray | float = 1.0) -> np.ndarray:
        """Return the stiffnesses of every storey in drift and twist of the centres of mass, shape (n, 2, 2).

        Parameters
        ----------
        share : part of their initial stiffness that lines have where they can yield [-], a number or shape (n,)
        """
        matrices = np.zeros((self.storeys, 2, 2))
        for number, line in enumerate(self.all_lines):
            stiffness = np.where(np.isfinite(line.yield_shear), share, 1.0) * line.stiffness
            weights = np.array([1.0, -line.arm] if number < len(self.lines) else [0.0, line.arm])
            matrices += stiffness[:, None, None] * np.outer(weights, weights)
        matrices[:, 1, 1] += self.torsional_stiffness
        return matrices

    def load_matrices(self, mass: np.ndarray, load_over_height: np.ndarray) -> np.ndarray:
        """Return what P-Delta takes away from `storey_matrices`, shape (n, 2, 2).

        Parameters
        ----------
        mass : of the floors [kg], shape (n,)
        load_over_height : P / h of every storey [N/m], shape (n,)
        """
        square_radius = find_square_radii(self.inertia, mass)
        matrices = np.zeros((self.storeys, 2, 2))
        matrices[:, 0, 0] = load_over_height
        matrices[:, 1, 1] = load_over_height * square_radius
        return matrices

    def frequency_ratio(self, mass: np.ndarray) -> float:
        """Return the first frequency of the twist about the centres of mass over that along the row, each without the
        other [-].

        mass : of the floors [kg], shape (n,)
        """
        matrices = self.storey_matrices()
        along = frequencies(mass, matrices[:, 0, 0])[0]
        return float(frequencies(self.inertia, matrices[:, 1, 1])[0] / along)

    def periods(self, mass: np.ndarray) -> np.ndarray:
        """Return the natural periods of the fixed-base building whose floors move and turn [s], longest first,
        shape (2 n,).

        mass : of the floors [kg], shape (n,)
        """
        n = self.storeys
        stiffness = np.zeros((n, 2, n, 2))
        for j, storey in enumerate(self.storey_matrices()):
            stiffness[j, :, j, :] += storey
            if j > 0:
                stiffness[j - 1, :, j - 1, :] += storey
                stiffness[j, :, j - 1, :] -= storey
                stiffness[j - 1, :, j, :] -= storey
        root = np.sqrt(np.column_stack((mass, self.inertia)).ravel())
        squares = np.linalg.eigvalsh(stiffness.reshape(2 * n, 2 * n) / np.outer(root, root))
        with np.errstate(divide="ignore"):  # what is as good as free has no period
            return np.asarray(2 * np.pi / np.sqrt(np.maximum(squares, 0.0)))

    @cached_property
    def identity(self) -> str:
        """All that makes the floors twist, and the edges whose drifts are looked at, in a line."""
        lines = [(line.arm, line.stiffness.tolist(), line.yield_shear.tolist()) for line in self.all_lines]
        edges = (self.low, self.high)
        return repr((self.inertia.tolist(), len(self.lines), lines, self.torsional_stiffness.tolist(), edges))

    @property
    def is_eccentric(self) -> bool:
        """True where the floors twist by themselves, without eccentric links: some line along the row has not its like
        on the other side."""
        unmatched = list(self.lines)
        while unmatched:
            line = unmatched[0]
            mirrored = [number for number, other in enumerate(unmatched) if self._are_mirrored(line, other)]
            if not mirrored:
                return True
            del unmatched[mirrored[0]]
            if mirrored[0] > 0:  # else it stands at the centres of mass
                del unmatched[0]
        return False

    def _are_mirrored(self, line: FrameLine, other: FrameLine) -> bool:
        """Return whether two lines along the row stand on both sides of the centres of mass and are alike."""
        distance = abs(line.arm + other.arm)
        return (
            distance <= SAME * max(self.high - self.low, abs(line.arm))
            and np.allclose(line.stiffness, other.stiffness, rtol=SAME, atol=0.0)
            and np.allclose(line.yield_shear, other.yield_shear, rtol=SAME, atol=0.0)
        )

    @property
    def yields_as_one(self) -> bool:
        """True where all lines of a storey yield at one drift, so that without a twist their sum is one storey."""
        drifts = [line.yield_shear / line.stiffness for line in self.lines]
        return all(np.allclose(each, drifts[0], rtol=SAME, atol=0.0) for each in drifts)
