"""The figures of docs/published.md, from the tables of results."""

from __future__ import annotations

import sys
from collections.abc import Callable
from math import pi, sqrt
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from pounding_cli.report.style import RC

sys.path.append(str(Path(__file__).parents[2]))  # the closed forms stand with the tests

from tests.reference.published import find_doubling_wall, find_rigid_speed

OSCILLATOR_MASS = 2e5
"""Of the studies of impact oscillators [kg]."""

TOWER_MASS, TOWER_RESTITUTION = 1e5, 0.5
"""Effective mass of two towers of 200 t [kg], and restitution of their study [-]."""


def _list_oscillators(table: pd.DataFrame) -> pd.DataFrame:
    """Return a table of links with w, r, s and the contact's stiffness over that of the oscillator [-]."""
    table = table.rename(columns={"buildings.oscillator.period": "w", "impact.restitution": "r"})
    table["s"] = (table["cases.wall.gap"] * 4 * pi**2 / table["w"] ** 2).round(6)
    table["stiffness"] = table["impact.stiffness"].str.split().str[0].astype(float)
    return table


def draw_convergence(results: Any, path: Path) -> None:
    """Draw how the speeds of the blows converge to those of a rigid wall as the contact stiffens."""
    table = _list_oscillators(results.link())
    sums = table.set_index(["w", "r", "s", "stiffness", "records.duration"])[["impulse", "impacts"]].sort_index()
    by_contact = sums.groupby(level=[0, 1, 2, 3])
    steady = by_contact.last() - by_contact.first()
    with mpl.rc_context({**RC, "svg.hashsalt": path.stem}):
        figure = Figure(figsize=(6.4, 3.2), layout="constrained")
        ax = figure.subplots()
        for (w, r, s), rows in steady.groupby(level=[0, 1, 2]):
            speeds = rows["impulse"] / rows["impacts"] / (OSCILLATOR_MASS * (1 + r) * w)
            exact = find_rigid_speed(w, r, s) / (2 * pi)
            errors = 100 * (speeds / exact - 1).abs()
            label = f"w = {w:g}, r = {r:g}, s = {s:g}"
            ax.loglog(errors.index.get_level_values("stiffness"), errors, "o-", ms=3, label=label)
        ax.loglog([1e3, 1e6], [10, 10 / sqrt(1e3)], "k:", label="with the root of the stiffness")
        ax.set(xlabel="stiffness of the contact over that of the oscillator", ylabel="error of the speed [%]")
        ax.legend(fontsize="x-small", ncols=2)
        figure.savefig(path, format="svg", metadata={"Date": None})


def draw_alternation(results: Any, path: Path) -> None:
    """Draw the speeds of the last two blows over the place of the wall beside the closed form of one blow a period."""
    table = _list_oscillators(results.link())
    table = table[table["stiffness"] == table["stiffness"].max()]
    table["speed"] = table["impulse"] * 2 * pi / (OSCILLATOR_MASS * (1 + table["r"]) * table["w"])
    blows = table.pivot_table("speed", ["w", "r", "s"], "records.duration").diff(axis=1).iloc[:, -2:]
    with mpl.rc_context({**RC, "svg.hashsalt": path.stem}):
        figure = Figure(figsize=(6.4, 3.2), layout="constrained")
        ax = figure.subplots()
        for number, ((w, r), own) in enumerate(blows.groupby(level=[0, 1])):
            start = find_doubling_wall(w, r)
            at = own.index.get_level_values("s") - start
            ax.plot(at, own, "o", ms=3, color=f"C{number}", label=[f"w = {w:g}, r = {r:g}", None])
            places = np.linspace(start - 0.025, start + 0.02, 50)
            speeds = [find_rigid_speed(w, r, s) for s in places]
            ax.plot(places - start, speeds, "-", color=f"C{number}", lw=0.8)
        ax.axvline(0, color="k", ls=":", lw=0.8)
        ax.set(xlabel="place of the wall, less the one where the blows begin to alternate", ylabel="speed of the blows")
        ax.legend(fontsize="x-small")
        figure.savefig(path, format="svg", metadata={"Date": None})


def draw_towers(results: Any, path: Path) -> None:
    """Draw V/V0 of both towers, and the mean speed of their steady blows, over the frequency of the motion."""
    links, storeys = results.link(), results.storey()
    for table in (links, storeys):
        table["frequency"] = table["record"].astype(str).str.split().str[1].astype(float)  # of "sine 1.25 Hz"
    keys = ["buildings.stiff.period", "frequency"]
    sums = links.groupby([*keys, "records.duration"], observed=True)[["impulse", "impacts"]].sum()
    by_tower = sums.groupby(level=[0, 1])
    steady = by_tower.last() - by_tower.first()
    steady = steady[steady["impacts"] > 0]
    speeds = steady["impulse"] / steady["impacts"] / (TOWER_MASS * (1 + TOWER_RESTITUTION))
    whole = storeys[storeys["records.duration"] == storeys["records.duration"].max()]
    ratios = whole.pivot_table("V_ratio", keys, "building", observed=True).reindex(speeds.index)
    periods = sorted(set(speeds.index.get_level_values(0)), reverse=True)
    with mpl.rc_context({**RC, "svg.hashsalt": path.stem}):
        figure = Figure(figsize=(7.2, 4.2), layout="constrained")
        grid = figure.subplots(2, len(periods), sharex=True, sharey="row")
        for (above, below), period in zip(grid.T, periods, strict=True):
            pair = ratios.loc[period]
            every = pd.Index(np.round(np.arange(pair.index.min(), pair.index.max() + 0.01, 0.05), 2), name="frequency")
            pair = pair.reindex(every)  # leaves out the frequencies without a blow
            for tower, color in (("stiff", "#D55E00"), ("soft", "#0072B2")):
                above.semilogy(pair.index, pair[tower], "o-", ms=3, color=color, label=tower)
            above.axhline(1.0, color="0.6", lw=0.8)
            above.set(title=f"1 and {1 / period:.2f} Hz")
            below.plot(every, speeds[period].reindex(every), "o-", ms=3, color="0.2")
            below.set(xlabel="frequency of the motion [Hz]")
            for ax in (above, below):
                for frequency in (1.0, 1 / period):
                    ax.axvline(frequency, color="0.6", lw=0.8, ls=":")
        grid[0, 0].set(ylabel="V/V0")
        grid[1, 0].set(ylabel="speed of blows [m/s]", ylim=(0, None))
        grid[0, 0].legend(fontsize="x-small")
        figure.savefig(path, format="svg", metadata={"Date": None})


DRAWN: dict[str, Callable[[Any, Path], None]] = {
    "impact-oscillator": draw_convergence,
    "impact-doubling": draw_alternation,
    "two-towers": draw_towers,
}
"""Study -> what draws its figure into a file."""
