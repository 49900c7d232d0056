"""Where the blows of an oscillator on a rigid wall begin to alternate, beside the closed form of the place."""

from __future__ import annotations

from collections.abc import Iterator
from math import cos, pi, sin, sqrt
from typing import Any

import numpy as np
import pandas as pd
from comparison import Entry, Row, compare
from impact_oscillator import extrapolate, find_rigid_speed
from scipy.optimize import brentq

OSCILLATORS = ((2.5, 0.5), (2.6, 0.5), (2.6, 0.6))
"""w [-] and r [-]."""


def find_doubling_speed(w: float, r: float) -> float:
    """Return the speed at which the motion of x'' + x = cos(w t) with one blow in a period doubles its period [-].

    Source: Budd, C. & Dux, F. (1994). Chattering and related behaviour in impact oscillators. Philosophical
    Transactions of the Royal Society of London A 347, 365-389; as F. Dux's program impact-oscillator has it.
    """
    period = 2 * pi / w
    amplitude = 1 / (1 - w**2)
    loss = (1 - r) / w
    sine, cosine = sin(period), cos(period)
    turn = (1 + r) * sine / (1 - cosine)
    trace = 4 * r * cosine - 2 * (1 + r**2) + (w**2 - 1) * turn**2 * (1 - cosine)
    swing = (1 + r) * w * sine
    square = trace**2 + swing**2 * (w**2 * (turn**2 + loss**2) - 2 * trace / (1 - cosine))
    return abs(2 * swing * w * amplitude) / sqrt(square)


def find_doubling_wall(w: float, r: float) -> float:
    """Return the place of the wall, s, at which the blows begin to alternate [-]."""
    speed = find_doubling_speed(w, r)
    return float(brentq(lambda s: find_rigid_speed(w, r, s) - speed, 0.0, 0.15))


def find_walls(solved: Any) -> pd.DataFrame:
    """Return the places of the wall at which the blows begin to alternate over the stiffness of the contact, a column
    for every oscillator (w, r) [-].

    The square of the difference of two blows grows from zero there; its second power makes the fit exact to 0.1 %.
    """
    table = solved.table("link").rename(columns={"buildings.oscillator.period": "w", "impact.restitution": "r"})
    table["s"] = table["cases.wall.gap"] * 4 * pi**2 / table["w"] ** 2
    table["stiffness"] = table["impact.stiffness"].str.split().str[0].astype(float)
    sums = table.pivot_table("impulse", ["stiffness", "w", "r", "s"], "records.duration")
    squares = sums.diff(axis=1).diff(axis=1).iloc[:, -1] ** 2
    rows = []
    for (stiffness, w, r), three in squares.groupby(level=["stiffness", "w", "r"]):
        powers = np.vander(three / three.max(), 3, increasing=True)
        wall = np.linalg.solve(powers, three.index.get_level_values("s"))[0]
        rows.append({"stiffness": stiffness, "w": w, "r": r, "wall": wall})
    return pd.DataFrame(rows).pivot_table("wall", "stiffness", ["w", "r"])


def compare_impact_doubling(solved: Any) -> Iterator[Row]:
    """Yield the place of the wall of every oscillator."""
    walls = find_walls(solved)
    for w, r in OSCILLATORS:
        exact = find_doubling_wall(w, r)
        column = walls[w, r]
        errors = [f"{100 * (column[stiffness] / exact - 1):+.2f} %" for stiffness in (1e5, 1e6)]
        why = f"a contact 1e5 and 1e6 times as stiff as the oscillator is off by {errors[0]} and {errors[1]}"
        quantity = f"place s of the wall where the blows begin to alternate, w = {w:g}, r = {r:g}"
        yield compare(quantity, exact, extrapolate(column), ".5f", why)


ENTRY = Entry(compare_impact_doubling)
