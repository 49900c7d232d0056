"""Where the blows of an oscillator on a rigid wall begin to alternate, beside the closed form of the place."""

from __future__ import annotations

from collections.abc import Iterator
from math import cos, pi, sin, sqrt
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pandas as pd
from comparison import Entry, Row, compare
from impact_oscillator import extrapolate, find_mass, find_rigid_speed
from matplotlib.figure import Figure
from scipy.optimize import brentq

from pounding_cli.report.style import RC

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


def find_last_blows(solved: Any) -> pd.DataFrame:
    """Return the speeds of the last two blows, by stiffness of the contact, w, r and place s of the wall [-]."""
    table = solved.table("link").rename(columns={"buildings.oscillator.period": "w", "impact.restitution": "r"})
    table["s"] = (table["cases.wall.gap"] * 4 * pi**2 / table["w"] ** 2).round(6)
    table["stiffness"] = table["impact.stiffness"].str.split().str[0].astype(float)
    table["speed"] = table["impulse"] * 2 * pi / (find_mass(solved) * (1 + table["r"]) * table["w"])
    sums = table.pivot_table("speed", ["stiffness", "w", "r", "s"], "records.duration")
    return sums.diff(axis=1).iloc[:, -2:]


def find_walls(blows: pd.DataFrame) -> pd.DataFrame:
    """Return the places of the wall at which the blows begin to alternate over the stiffness of the contact, a column
    for every oscillator (w, r) [-].

    The square of the difference of two blows grows from zero there; its second power makes the fit exact to 0.1 %.
    """
    squares = blows.diff(axis=1).iloc[:, -1] ** 2
    rows = []
    for (stiffness, w, r), walls in squares.groupby(level=["stiffness", "w", "r"]):
        beyond = walls.sort_index().tail(3)
        powers = np.vander(beyond / beyond.max(), 3, increasing=True)
        wall = np.linalg.solve(powers, beyond.index.get_level_values("s"))[0]
        rows.append({"stiffness": stiffness, "w": w, "r": r, "wall": wall})
    return pd.DataFrame(rows).pivot_table("wall", "stiffness", ["w", "r"])


def draw_alternation(solved: Any, path: Path) -> None:
    """Draw the speeds of the last two blows over the place of the wall beside the closed form of one blow a period."""
    blows = find_last_blows(solved).xs(1e6, level="stiffness")
    with mpl.rc_context({**RC, "svg.hashsalt": path.stem}):
        figure = Figure(figsize=(6.4, 3.2), layout="constrained")
        ax = figure.subplots()
        for number, (w, r) in enumerate(OSCILLATORS):
            start = find_doubling_wall(w, r)
            own = blows.loc[w, r]
            ax.plot(own.index - start, own, "o", ms=3, color=f"C{number}", label=[f"w = {w:g}, r = {r:g}", None])
            places = np.linspace(start - 0.025, start + 0.02, 50)
            speeds = [find_rigid_speed(w, r, s) for s in places]
            ax.plot(places - start, speeds, "-", color=f"C{number}", lw=0.8)
        ax.axvline(0, color="k", ls=":", lw=0.8)
        ax.set(xlabel="place of the wall, less the one where the blows begin to alternate", ylabel="speed of the blows")
        ax.legend(fontsize="x-small")
        figure.savefig(path, format="svg", metadata={"Date": None})


def compare_impact_doubling(solved: Any) -> Iterator[Row]:
    """Yield the place of the wall of every oscillator."""
    walls = find_walls(find_last_blows(solved))
    for w, r in OSCILLATORS:
        exact = find_doubling_wall(w, r)
        column = walls[w, r]
        errors = [f"{100 * (column[stiffness] / exact - 1):+.2f} %" for stiffness in (1e5, 1e6)]
        why = f"a contact 1e5 and 1e6 times as stiff as the oscillator is off by {errors[0]} and {errors[1]}"
        quantity = f"place s of the wall where the blows begin to alternate, w = {w:g}, r = {r:g}"
        yield compare(quantity, exact, extrapolate(column), ".5f", why)


ENTRY = Entry(compare_impact_doubling, draw=draw_alternation)
