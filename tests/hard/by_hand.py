"""Hard scenes written by hand for the integrator of `tests/reference/`: masses, springs, dashpots and gaps from the
numbers of their YAML files by formulas of this module.

Nothing here is read or assembled by the package: `SCENES` are what `integrate` takes in the place of a built scene.
Numbers are those of the file of the same name and of the defaults that docs/study-file.md states, in SI.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace

import numpy as np

from tests.reference.assembly import Coordinates

G = 9.80665
RECORDS = Path(__file__).parents[2] / "records"
MOTIONS = Path(__file__).parent / "motions"

MASS, HEIGHT, DAMPING, HARDENING, RESTITUTION = 200e3, 3.0, 0.05, 0.05, 0.5
"""What a study means that does not say otherwise: floors [kg], storeys [m], damping in two modes, hardening, e [-]."""


@dataclass(frozen=True)
class Contact:
    """A Kelvin-Voigt contact: gap [m], spring [N/m], damping ratio [-]."""

    gap: float
    stiffness: float
    damping_ratio: float
    name: str = "pounding"
    kind: str = "pounding"
    tension_cut: bool = False
    columns: float | None = None

    @property
    def law(self) -> Contact:
        return self


@dataclass(frozen=True)
class Written:
    """A scene written by hand, with what the integrator asks of one."""

    coordinates: Coordinates
    links: tuple[Contact, ...]
    motion: SimpleNamespace
    analysis: str
    tail: float = 0.0


@dataclass
class Draft:
    """A scene that is being written: `total` coordinates.

    mass, loaded : of every coordinate, and what the ground pulls of it
    resisting : row, stiffness [N/m], yield drift [m], hardening and storey of all that resists
    """

    total: int
    mass: np.ndarray = field(init=False)
    loaded: np.ndarray = field(init=False)
    damping: np.ndarray = field(init=False)
    springs: np.ndarray = field(init=False)
    floors: list[np.ndarray] = field(default_factory=list)
    turns: list[np.ndarray] = field(default_factory=list)
    resisting: list[tuple[np.ndarray, float, float, float, int | None]] = field(default_factory=list)
    travel: list[np.ndarray] = field(default_factory=list)
    low: list[np.ndarray] = field(default_factory=list)
    high: list[np.ndarray] = field(default_factory=list)
    closing: list[np.ndarray] = field(default_factory=list)
    links: list[Contact] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.mass, self.loaded = np.zeros(self.total), np.zeros(self.total)
        self.damping, self.springs = np.zeros((self.total, self.total)), np.zeros((self.total, self.total))

    def row(self, *terms: tuple[int | None, float]) -> np.ndarray:
        """Return a combination of coordinates; None is the ground."""
        row = np.zeros(self.total)
        for place, factor in terms:
            if place is not None:
                row[place] += factor
        return row

    def strike(self, closing: np.ndarray, gap: float, stiffness: float, restitution: float) -> None:
        """Add a contact that presses by `closing`."""
        xi = -math.log(restitution) / math.sqrt(math.pi**2 + math.log(restitution) ** 2)
        self.closing.append(closing)
        self.links.append(Contact(gap, stiffness, xi))

    def finish(self, motion: SimpleNamespace, analysis: str) -> Written:
        rows, stiffness, reach, hardening, storeys = zip(*self.resisting, strict=True)
        sums = np.zeros((len(self.travel), len(rows)))
        for column, storey in enumerate(storeys):
            if storey is not None:
                sums[storey, column] = 1.0
        edges = np.array([*self.low, *self.high]).reshape(-1, self.total)
        coordinates = Coordinates(
            self.floors, self.turns, np.array(rows), sums, np.array(self.travel), edges,
            [SimpleNamespace(name="bilinear")] * len(rows), np.array(self.closing), np.ones(len(self.links)), self.mass,
            self.damping, self.springs, self.loaded, np.array(stiffness), np.array(reach), np.array(hardening),
        )  # fmt: skip
        return Written(coordinates, tuple(self.links), motion, analysis)


def chain(stiffness: Sequence[float]) -> np.ndarray:
    """Return the stiffness matrix of a shear building on the ground."""
    k = [*stiffness, 0.0]
    matrix = np.diag([one + two for one, two in pairwise(k)])
    for j, between in enumerate(k[1:-1]):
        matrix[j, j + 1] = matrix[j + 1, j] = -between
    return matrix


def frequencies(mass: Sequence[float], stiffness: Sequence[float]) -> np.ndarray:
    """Return the circular frequencies of a shear building, the lowest first [rad/s]."""
    root = np.sqrt(np.outer(mass, mass))
    return np.sqrt(np.linalg.eigvalsh(chain(stiffness) / root))


def tapered(period: float, mass: Sequence[float]) -> list[float]:
    """Return stiffnesses that fall on a line to a third at the top and give a period [s]."""
    shares = [1 - 2 / 3 * j / max(len(mass) - 1, 1) for j in range(len(mass))]
    return [share * (2 * math.pi / period / frequencies(mass, shares)[0]) ** 2 for share in shares]


def rayleigh(mass: Sequence[float], stiffness: Sequence[float], ratio: float) -> tuple[float, float]:
    """Return alpha [1/s] and beta [s] of a damping ratio in the first two modes."""
    one, two = frequencies(mass, stiffness)[:2]
    beta = 2 * ratio / (one + two)
    return beta * one * two, beta


def code_shears(period: float, mass: Sequence[float], height: float = HEIGHT) -> list[float]:
    """Return the storey shears of UBC 1991 for Z 0.4, S 1.2, Rw 12 and a period of at most 0.7 s."""
    assert period <= 0.7
    base = 0.4 * min(1.25 * 1.2 / period ** (2 / 3), 2.75) / 12 * G * sum(mass)
    moments = [m * height * (j + 1) for j, m in enumerate(mass)]
    return [base * sum(moments[j:]) / sum(moments) for j in range(len(mass))]


def add_building(
    draft: Draft,
    at: Sequence[int],
    mass: Sequence[float],
    stiffness: Sequence[float],
    factors: tuple[float, float],
    yields: Sequence[float] | None = None,
    base: int | None = None,
    foot: int | None = None,
) -> None:
    """Add a shear building whose floors move relative to the ground; base : its sway, foot : its rocking.

    Its damping, alpha and beta, acts on the floors as they move relative to base and foot: alpha m on that motion of a
    floor, beta k on that of a storey.
    """
    alpha, beta = factors
    for j, (place, m, k) in enumerate(zip(at, mass, stiffness, strict=True)):
        draft.mass[place] = draft.loaded[place] = m
        storey = draft.row((place, 1.0), (at[j - 1] if j else base, -1.0), (foot, -HEIGHT))
        relative = draft.row((place, 1.0), (base, -1.0), (foot, -HEIGHT * (j + 1)))
        draft.damping += alpha * m * np.outer(relative, relative) + beta * k * np.outer(storey, storey)
        reach = np.inf if yields is None else yields[j] / k
        draft.resisting.append((storey, k, reach, HARDENING, len(draft.travel)))
        draft.travel.append(storey)
    draft.floors.append(np.array(at))
    draft.turns.append(np.zeros(0, int))


def add_plan(
    draft: Draft,
    at: Sequence[int],
    turn: Sequence[int],
    mass: Sequence[float],
    size: tuple[float, float],
    torsional: Sequence[float],
    lines: Sequence[tuple[float, Sequence[float], Sequence[float]]],
    hardening: float,
) -> None:
    """Add a building whose floors, even rectangles of a width and a depth, twist.

    lines : place from the centre of mass [m], stiffnesses [N/m] and yield shears [N]
    """
    storeys = len(mass)
    whole = [sum(stiffness[j] for _, stiffness, _ in lines) for j in range(storeys)]
    alpha, beta = rayleigh(mass, whole, DAMPING)
    first = len(draft.travel)
    twists = [draft.row((turn[j], 1.0), (turn[j - 1] if j else None, -1.0)) for j in range(storeys)]
    for j in range(storeys):
        inertia = mass[j] * (size[0] ** 2 + size[1] ** 2) / 12
        draft.mass[at[j]] = draft.loaded[at[j]] = mass[j]
        draft.mass[turn[j]] = inertia
        draft.damping[at[j], at[j]] += alpha * mass[j]
        draft.damping[turn[j], turn[j]] += alpha * inertia
        pair = np.outer(twists[j], twists[j])
        draft.springs += torsional[j] * pair
        draft.damping += beta * torsional[j] * pair
        draft.travel.append(draft.row((at[j], 1.0), (at[j - 1] if j else None, -1.0)))
    for y, stiffness, yields in lines:
        for j in range(storeys):
            line = draft.travel[first + j] - y * twists[j]
            draft.damping += beta * stiffness[j] * np.outer(line, line)
            draft.resisting.append((line, stiffness[j], yields[j] / stiffness[j], hardening, first + j))
    draft.low += [draft.travel[first + j] + size[0] / 2 * twists[j] for j in range(storeys)]
    draft.high += [draft.travel[first + j] - size[0] / 2 * twists[j] for j in range(storeys)]
    draft.floors.append(np.array(at))
    draft.turns.append(np.array(turn))


def elcentro(duration: float, peak: float | None = None) -> SimpleNamespace:
    """Return the beginning of the stand-in for El Centro; peak : what it is scaled to [g]."""
    samples = np.loadtxt(RECORDS / "elcentro.txt")[: round(duration / 0.01) + 1]
    return SimpleNamespace(acceleration=samples * G * (peak / np.abs(samples).max() if peak else 1.0), dt=0.01)


def shake(peak: float | None = None) -> SimpleNamespace:
    """Return the motion of most hard scenes; peak : what it is scaled to [g]."""
    samples = np.loadtxt(MOTIONS / "shake.txt")
    return SimpleNamespace(acceleration=samples * G * (peak / np.abs(samples).max() if peak else 1.0), dt=0.01)


def heavy_light_row() -> Written:
    """Five undamped buildings of three storeys, floors of 20,000 t and of 5 t in turn."""
    draft = Draft(15)
    springs = []
    for place in range(5):
        mass = [(20e6, 5e3)[place % 2]] * 3
        springs.append(tapered((0.36, 0.60)[place % 2], mass))
        add_building(draft, range(3 * place, 3 * place + 3), mass, springs[-1], (0.0, 0.0))
    stiffest = max(k for each in springs for k in each)
    for place in range(4):
        for j in range(3):
            closing = draft.row((3 * place + j, 1.0), (3 * place + 3 + j, -1.0))
            draft.strike(closing, 0.01, 1000 * stiffest, RESTITUTION)
    return draft.finish(elcentro(8.0), "elastic")


def record_strong() -> Written:
    """Two buildings of three storeys that yield by the code, 5 mm apart, under 5 g."""
    draft = Draft(6)
    mass = [MASS] * 3
    springs = [tapered(period, mass) for period in (0.36, 0.60)]
    for place, (period, k) in enumerate(zip((0.36, 0.60), springs, strict=True)):
        factors = rayleigh(mass, k, DAMPING)
        add_building(draft, range(3 * place, 3 * place + 3), mass, k, factors, code_shears(period, mass))
    for j in range(3):
        draft.strike(draft.row((j, 1.0), (3 + j, -1.0)), 0.005, 20 * max(max(springs)), RESTITUTION)
    return draft.finish(shake(5.0), "inelastic")


def foundation_light() -> Written:
    """Two buildings of two storeys in touch, on bases of 2 t and 20 t m2 that sway and rock."""
    draft = Draft(8)
    mass = [MASS] * 2
    springs = [200e6, 150e6], [80e6, 60e6]
    for place, k in enumerate(springs):
        first = 4 * place
        base, foot = first + 2, first + 3
        period = 2 * math.pi / frequencies(mass, k)[0]
        factors = rayleigh(mass, k, DAMPING)
        add_building(draft, (first, first + 1), mass, k, factors, code_shears(period, mass), base, foot)
        draft.mass[base] = draft.loaded[base] = 2e3
        draft.mass[foot] = 20e3
        draft.springs[base, base], draft.springs[foot, foot] = 200e6, 1e10
    for j in range(2):
        draft.strike(draft.row((j, 1.0), (4 + j, -1.0)), 0.0, 20 * 200e6, RESTITUTION)
    return draft.finish(shake(), "inelastic")


def twisting() -> Written:
    """Two buildings of two storeys whose floors twist; they share the edge from -3 m to 10 m along the street."""
    draft = Draft(8)
    mass = [240e3, 200e3], [160e3, 120e3]
    add_plan(
        draft, (0, 1), (2, 3), mass[0], (20.0, 14.0), (9e9, 7e9),
        [(-7.5, (90e6, 70e6), (1.2e6, 0.8e6)), (8.0, (160e6, 110e6), (1.9e6, 1.25e6))], 0.02,
    )  # fmt: skip
    add_plan(
        draft, (4, 5), (6, 7), mass[1], (16.0, 12.0), (1.6e9, 1.2e9),
        [(-7.0, (26e6, 20e6), (6e5, 4e5)), (-1.0, (15e6, 12e6), (3.8e5, 2.5e5)), (7.0, (19e6, 14e6), (4.2e5, 2.8e5))],
        0.05,
    )  # fmt: skip
    for j in (0, 1):
        for street in (-3.0, 10.0):
            closing = draft.row((j, 1.0), (2 + j, -street), (4 + j, -1.0), (6 + j, street - 5.0))
            draft.strike(closing, 0.002, 1e9, RESTITUTION)
    return draft.finish(elcentro(4.0, 0.7), "inelastic")


def isolated() -> Written:
    """A building on lead-rubber bearings between two of 0.36 s."""
    draft = Draft(10)
    plain, mass, k = [MASS] * 3, [200e3, 200e3, 150e3], [400e6, 350e6, 250e6]
    outer = tapered(0.36, plain)
    add_building(draft, (0, 1, 2), plain, outer, rayleigh(plain, outer, DAMPING))
    add_building(draft, (3, 4, 5), mass, k, rayleigh(mass, k, 0.02), base=6)
    add_building(draft, (7, 8, 9), plain, outer, rayleigh(plain, outer, DAMPING))
    draft.mass[6] = draft.loaded[6] = 300e3
    strength, second, reach = 400e3, 4e6, 0.01
    first = second + strength / reach
    draft.resisting.append((draft.row((6, 1.0)), first, reach, second / first, None))
    for left, right in ((0, 3), (3, 7)):
        for j in range(3):
            draft.strike(draft.row((left + j, 1.0), (right + j, -1.0)), 0.01, 1e10, 0.4)
    return draft.finish(elcentro(4.0, 0.7), "inelastic")


def unaligned() -> Written:
    """Three storeys of 3 m beside two of 4.4 m and 4.6 m: three slabs strike columns, the roofs each other."""
    draft = Draft(5)
    mass, k = ([220e3, 220e3, 180e3], [180e3, 160e3]), ([400e6, 340e6, 240e6], [90e6, 70e6])
    strength = [6e6, 5e6, 3.3e6], [2.4e6, 1.6e6]
    add_building(draft, (0, 1, 2), mass[0], k[0], rayleigh(mass[0], k[0], DAMPING), strength[0])
    add_building(draft, (3, 4), mass[1], k[1], rayleigh(mass[1], k[1], DAMPING), strength[1])

    def bend(at: float, share: float, stiffness: float) -> float:
        """Spring of a contact of 8e9 N/m in series with columns that it strikes at a part of their height [N/m]."""
        return 1 / (1 / 8e9 + 4 * (at * (1 - at)) ** 3 / (share * stiffness))

    def between(below: int | None, above: int, at: float) -> list[tuple[int | None, float]]:
        """Displacement of columns clamped in two floors at a part of their height."""
        upper = 3 * at**2 - 2 * at**3
        return [(below, 1 - upper), (above, upper)]

    def closing(left: list[tuple[int | None, float]], right: list[tuple[int | None, float]]) -> np.ndarray:
        return draft.row(*left, *((place, -factor) for place, factor in right))

    draft.strike(closing([(2, 1.0)], [(4, 1.0)]), 0.002, 8e9, RESTITUTION)
    one, two, three = 3.0 / 4.4, (4.4 - 3.0) / 3.0, (6.0 - 4.4) / 4.6
    draft.strike(closing([(0, 1.0)], between(None, 3, one)), 0.002, bend(one, 0.3, 90e6), RESTITUTION)
    draft.strike(closing(between(0, 1, two), [(3, 1.0)]), 0.002, bend(two, 0.2, 340e6), RESTITUTION)
    draft.strike(closing([(1, 1.0)], between(3, 4, three)), 0.002, bend(three, 0.3, 70e6), RESTITUTION)
    return draft.finish(elcentro(4.0, 0.7), "inelastic")


SCENES: dict[str, Callable[[], Written]] = {
    "heavy-light-row; gap, elastic": heavy_light_row,
    "record-strong; gap, inelastic": record_strong,
    "foundation-light; touching, inelastic": foundation_light,
    "twisting; gap, inelastic": twisting,
    "isolated; gap, inelastic": isolated,
    "unaligned; gap, inelastic": unaligned,
}
"""Scenes by the study and where in it they stand: case, analysis."""
