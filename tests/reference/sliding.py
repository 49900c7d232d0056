"""A building on a slider that sticks, beside an oscillator that may strike its base, by an integrator of its own.

Between two changes - the slider sticks or slides, the floors touch or part, a sample of the ground motion - the motion
is linear, and is followed exactly by the exponential of its matrix; changes are bracketed on a fine grid and then
bisected. It shares no code with the package."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.linalg import expm

FINE = 32
"""Parts of a sample of the motion at whose ends changes are looked for."""


@dataclass
class Sliding:
    """Base and floors in a row, on a slider.

    masses, springs : of base and floors [kg]; of the storeys [N/m]
    surface, friction : W / R [N/m], mu W [N]
    beta : dashpots of the storeys over their springs [s]
    neighbour : mass [kg] and spring [N/m] of an oscillator at the left of the base, or None
    gap, contact, dashpot : of the contact between the two [m], [N/m], [N s/m]
    """

    masses: list[float]
    springs: list[float]
    surface: float
    friction: float
    beta: float = 0.0
    neighbour: tuple[float, float] | None = None
    gap: float = np.inf
    contact: float = 0.0
    dashpot: float = 0.0

    def __post_init__(self) -> None:
        masses = list(self.masses) + ([self.neighbour[0]] if self.neighbour else [])
        self.n = len(masses)
        self.mass = np.array(masses)
        self.k, self.c = np.zeros((self.n, self.n)), np.zeros((self.n, self.n))
        for storey, spring in enumerate(self.springs):
            pair = np.zeros(self.n)
            pair[storey], pair[storey + 1] = -1.0, 1.0
            self.k += spring * np.outer(pair, pair)
            self.c += self.beta * spring * np.outer(pair, pair)
        self.k[0, 0] += self.surface
        self.closing = np.zeros(self.n)
        if self.neighbour:
            self.k[-1, -1] += self.neighbour[1]
            self.closing[-1], self.closing[0] = 1.0, -1.0

    def matrix(self, sign: int, touches: bool) -> np.ndarray:
        """The rates of (u, u', ground acceleration, its slope, 1) in one mode; sign 0: the base is held."""
        k, c, constant = self.k.copy(), self.c.copy(), np.zeros(self.n)
        constant[0] -= sign * self.friction
        if touches:
            k += self.contact * np.outer(self.closing, self.closing)
            c += self.dashpot * np.outer(self.closing, self.closing)
            constant += self.contact * self.gap * self.closing
        n, inverse = self.n, 1 / self.mass
        a = np.zeros((2 * n + 3, 2 * n + 3))
        a[:n, n : 2 * n] = np.eye(n)
        a[n : 2 * n, :n], a[n : 2 * n, n : 2 * n] = -inverse[:, None] * k, -inverse[:, None] * c
        a[n : 2 * n, 2 * n], a[n : 2 * n, -1] = -1.0, inverse * constant
        a[2 * n, 2 * n + 1] = 1.0
        self.pull = self.mass[0] * a[n].copy()  # force on the base, friction included
        if sign == 0:
            a[n], a[0] = 0.0, 0.0
        return a

    def run(self, ground: np.ndarray, dt: float) -> dict[str, float | np.ndarray]:
        """Largest displacement of the base and drifts of the storeys [m], and impacts of the neighbour."""
        n, sign, touches = self.n, 0, False
        y = np.zeros(2 * n + 3)
        y[-1] = 1.0
        floors = len(self.masses)
        largest, impacts = np.zeros(floors), 0
        before: list[np.ndarray] = []
        known: dict[tuple[int, bool], tuple[np.ndarray, np.ndarray, np.ndarray]] = {}

        def mode() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
            if (sign, touches) not in known:
                a = self.matrix(sign, touches)
                known[sign, touches] = a, expm(a * dt / FINE), self.pull.copy()
            return known[sign, touches]

        def room(state: np.ndarray) -> list[float]:
            """What stays positive in this mode."""
            _, _, pull = mode()
            closing = float(self.closing @ state[:n]) - self.gap if self.neighbour else -1.0
            found = [closing if touches else -closing]
            if sign:
                found.append(sign * state[n])
            else:
                found += [self.friction - pull @ state, self.friction + pull @ state]
            return found

        for left, right in pairwise(ground):
            y[2 * n], y[2 * n + 1] = left, (right - left) / dt
            for _ in range(FINE):
                rest = dt / FINE
                for _ in range(100):
                    a, step, _ = mode()
                    after = (step if rest == dt / FINE else expm(a * rest)) @ y
                    ends = room(after)
                    if min(ends) >= 0.0:
                        y = after
                        break
                    low, high = 0.0, rest
                    for _ in range(60):
                        middle = 0.5 * (low + high)
                        low, high = (middle, high) if min(room(expm(a * middle) @ y)) >= 0.0 else (low, middle)
                    y = expm(a * high) @ y
                    rest -= high
                    which = int(np.argmin(room(y)))
                    if which == 0:
                        touches = not touches
                        impacts += touches
                    elif sign:
                        y[n], sign = 0.0, 0
                    else:
                        sign = 1 if which == 1 else -1
                    before.clear()
                    if not sign:  # a jump of the forces may leave less friction than it takes to stick
                        needed = float(mode()[2] @ y)
                        sign = 0 if abs(needed) < self.friction else int(np.sign(needed))
                before.append(np.diff(y[:floors], prepend=0.0))
                largest = np.maximum(largest, _peaks(before[-3:]))
        return {"base": float(largest[0]), "drift": largest[1:], "impacts": impacts}


def _peaks(values: list[np.ndarray]) -> np.ndarray:
    """The largest sizes of parabolas through three values a step apart, or the last sizes."""
    last = np.abs(values[-1])
    if len(values) < 3:
        return last
    left, middle, right = values
    bend = left - 2 * middle + right
    with np.errstate(all="ignore"):
        at = 0.5 * (left - right) / bend
        top = middle - 0.125 * (left - right) ** 2 / bend
    return np.where(np.abs(at) <= 1.0, np.maximum(last, np.abs(top)), last)
