"""Two towers on a shaking table beside two statements on such towers."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pandas as pd
from comparison import Entry, Row
from matplotlib.figure import Figure

from pounding_cli.report.style import RC

EFFECTIVE_MASS = 1e5
"""Of two towers of 200 t [kg]."""

RESTITUTION = 0.5
"""Of the study [-]."""


def read_frequency(record: str) -> float:
    """Return the frequency of a sinusoidal motion, of its name "sine 1.25 Hz" [Hz]."""
    return float(record.split()[1])


def find_steady_speeds(solved: Any) -> pd.Series:
    """Return the mean speed of the blows of the steady motion [m/s], over period of the stiff tower and frequency."""
    links = solved.table("link")
    links["frequency"] = links["record"].map(read_frequency)
    sums = links.groupby(["buildings.stiff.period", "frequency", "records.duration"])[["impulse", "impacts"]].sum()
    steady = sums.groupby(level=[0, 1]).last() - sums.groupby(level=[0, 1]).first()
    steady = steady[steady["impacts"] > 0]
    return steady["impulse"] / steady["impacts"] / (EFFECTIVE_MASS * (1 + RESTITUTION))


def find_ratios(solved: Any) -> pd.DataFrame:
    """Return V/V0 of both towers [-], over period of the stiff tower and frequency."""
    storeys = solved.table("storey")
    storeys["frequency"] = storeys["record"].map(read_frequency)
    whole = storeys[storeys["records.duration"] == storeys["records.duration"].max()]
    return whole.pivot_table("V_ratio", ["buildings.stiff.period", "frequency"], "building")


def compare_two_towers(solved: Any) -> Iterator[Row]:
    """Yield both statements for every pair of towers."""
    speeds = find_steady_speeds(solved)
    ratios = find_ratios(solved).reindex(speeds.index)
    for period in sorted(set(speeds.index.get_level_values(0)), reverse=True):
        pair = ratios.loc[period]
        fastest = float(speeds[period].idxmax())
        stiff = 1 / period
        name = f"1 and {stiff:.2f} Hz"
        yield Row(
            f"frequency of the fastest blows, towers of {name}",
            f"between 1 and {stiff:.2f} Hz",
            f"{fastest:.2f} Hz",
            "none" if 1 < fastest < stiff else f"{fastest - stiff:+.2f} Hz",
            f"the blows have {speeds[period].max():.2f} m/s in the mean; frequencies are 0.05 Hz apart",
        )
        both = (pair["stiff"] > 1) & (pair["soft"] < 1)
        turned = pair.index[(pair["stiff"] < 1)]
        yield Row(
            f"stiff amplified and soft suppressed, towers of {name}",
            "of all frequencies",
            f"of {both.sum()} of {len(pair)} frequencies with blows",
            f"{len(pair) - both.sum()} frequencies",
            f"they are those up to {both[both].index.max():.2f} Hz; at {turned.min():.2f} to {turned.max():.2f} Hz, "
            "by its own resonance, the stiff one is suppressed and the soft one amplified",
        )


def draw_response(solved: Any, path: Path) -> None:
    """Draw V/V0 of both towers, and the speed of their blows, over the frequency of the motion."""
    speeds = find_steady_speeds(solved)
    ratios = find_ratios(solved).reindex(speeds.index)
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


ENTRY = Entry(compare_two_towers, draw=draw_response)
