"""Blows of an oscillator on a rigid wall beside the closed form of their speed."""

from __future__ import annotations

from collections.abc import Iterator
from math import cos, pi, sin, sqrt
from pathlib import Path
from typing import Any

import matplotlib as mpl
import pandas as pd
import yaml
from comparison import Entry, Row, compare
from matplotlib.figure import Figure

from pounding_cli.report.style import RC


def find_rigid_speed(w: float, r: float, s: float, periods: int = 1) -> float:
    """Return the speed of the blow that comes once in some periods of x'' + x = cos(w t) with a rigid wall at s [-].

    Source: Shaw, S. W. & Holmes, P. J. (1983). A periodically forced piecewise linear oscillator. Journal of Sound and
    Vibration 90(1), 129-155.
    """
    lapse = 2 * pi * periods / w
    amplitude = 1 / (1 - w**2)
    loss = (1 - r) / w
    turn = (1 + r) * sin(lapse) / (1 - cos(lapse))
    root = sqrt(amplitude**2 * turn**2 - (s**2 - amplitude**2) * loss**2)
    return 2 * (root - turn * s) / (turn**2 + loss**2)


def find_speeds(solved: Any) -> pd.DataFrame:
    """Return the speeds of the blows over the stiffness of the contact, a column for every oscillator (w, r, s), as
    those of one of 1 s under 1 m/s2 [m/s]."""
    table = solved.table("link").rename(
        columns={"buildings.oscillator.period": "w", "impact.restitution": "r", "cases.wall.gap": "s"}
    )
    table["s"] = (table["s"] * 4 * pi**2 / table["w"] ** 2).round(6)
    table["stiffness"] = table["impact.stiffness"].str.split().str[0].astype(float)
    sums = table.set_index(["stiffness", "w", "r", "s", "records.duration"])[["impulse", "impacts"]]
    steady = sums.groupby(level=[0, 1, 2, 3]).last() - sums.groupby(level=[0, 1, 2, 3]).first()
    mass = find_mass(solved)
    impulse = steady["impulse"] / steady["impacts"]
    restitution = steady.index.get_level_values("r")
    w = steady.index.get_level_values("w")
    speeds = (impulse / mass / (1 + restitution) / w).rename("speed").reset_index()
    return speeds.pivot_table("speed", "stiffness", ["w", "r", "s"])


def find_mass(solved: Any) -> float:
    """Return the mass of the oscillator of a study [kg]."""
    text = yaml.safe_load(solved.study.read_text(encoding="utf-8"))["buildings"]["oscillator"]["mass"]
    return 1000 * float(text.removesuffix(" t"))


def extrapolate(speeds: pd.Series) -> float:
    """Return the limit of speeds whose error falls with the root of the stiffness, from the two largest."""
    (soft, low), (stiff, high) = speeds.sort_index().iloc[-2:].items()
    ratio = sqrt(stiff / soft)
    return float((ratio * high - low) / (ratio - 1))


OSCILLATORS = ((2.0, 0.5, 0.1), (2.0, 0.65, 0.1), (2.3, 0.5, 0.1), (1.7, 0.5, 0.3), (1.5, 0.5, 0.2), (1.2, 0.5, 1.0))
"""w [-], r [-] and s [-]."""


def compare_impact_oscillator(solved: Any) -> Iterator[Row]:
    """Yield the speed of the blows of every oscillator."""
    speeds = find_speeds(solved)
    for w, r, s in OSCILLATORS:
        exact = find_rigid_speed(w, r, s) / (2 * pi)
        column = speeds[w, r, s]
        errors = [f"{100 * (column[stiffness] / exact - 1):+.2f} %" for stiffness in (1e3, 1e5)]
        why = f"a contact 1e3 and 1e5 times as stiff as the oscillator is off by {errors[0]} and {errors[1]}"
        yield compare(f"speed of the blows, w = {w:g}, r = {r:g}, s = {s:g}", exact, extrapolate(column), ".5f", why)


def draw_convergence(solved: Any, path: Path) -> None:
    """Draw how the speeds of the blows converge to those of a rigid wall."""

    speeds = find_speeds(solved)
    with mpl.rc_context({**RC, "svg.hashsalt": path.stem}):
        figure = Figure(figsize=(6.4, 3.2), layout="constrained")
        ax = figure.subplots()
        for w, r, s in OSCILLATORS:
            exact = find_rigid_speed(w, r, s) / (2 * pi)
            errors = 100 * (speeds[w, r, s] / exact - 1).abs()
            ax.loglog(errors.index, errors, "o-", ms=3, label=f"w = {w:g}, r = {r:g}, s = {s:g}")
        ax.loglog([1e3, 1e6], [10, 10 / sqrt(1e3)], "k:", label="with the root of the stiffness")
        ax.set(xlabel="stiffness of the contact over that of the oscillator", ylabel="error of the speed [%]")
        ax.legend(fontsize="x-small", ncols=2)
        figure.savefig(path, format="svg", metadata={"Date": None})


ENTRY = Entry(compare_impact_oscillator, draw=draw_convergence)
