"""Pictures of motions: one by itself, and the spectra of those of a study against their target."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullFormatter

from pounding_cli.errors import InputError, Problem
from pounding_cli.numbers import Unit
from pounding_cli.records.motion import GRAVITY, Motion, displacement, husid, significant_duration, spectrum, velocity
from pounding_cli.records.scaling import SpectrumMatch, TargetSpectrum
from pounding_cli.report.style import caption, entitle, is_for_paper, new_figure, styled

FORMATS = (".png", ".svg", ".pdf")
_TICKS = (0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 4.0)
_INK, _MARK = "#1a1a1a", "#b3261e"


def draw(motion: Motion, title: str, path: Path) -> None:
    """Draw `motion` into `path` (png, svg or pdf by its ending), whole or not at all.

    Raises `InputError` for another ending.
    """
    if path.suffix.lower() not in FORMATS:
        raise InputError(
            Problem(f"cannot draw a '{path.suffix}' file", f"end the name with {', '.join(FORMATS)}", str(path))
        )
    figure = Figure(figsize=(8.0, 9.0), layout="constrained")
    axes = figure.subplots(5, 1, gridspec_kw={"height_ratios": [1, 1, 1, 1, 1.6]})
    times = motion.dt * np.arange(motion.acceleration.size)
    for axis, values, name, unit in (
        (axes[0], motion.acceleration / GRAVITY, "acceleration", "g"),
        (axes[1], velocity(motion), "velocity", "m/s"),
        (axes[2], displacement(motion), "displacement", "m"),
    ):
        _series(axis, times, values, f"{name} [{unit}]")
        _mark_peak(axis, times, values, unit)
    _series(axes[3], times, husid(motion), "Husid [-]")
    _mark_duration(axes[3], motion)
    for axis in axes[:3]:
        axis.tick_params(labelbottom=False)
    axes[3].set_xlabel("time [s]")
    _spectrum(axes[4], motion)
    figure.align_ylabels(axes)
    figure.suptitle(f"{title} ({motion.source})", fontsize=11)
    path.parent.mkdir(parents=True, exist_ok=True)
    draft = path.with_name(f".{path.name}.{os.getpid()}{path.suffix}")
    try:
        figure.savefig(draft, dpi=150)
        os.replace(draft, path)
    finally:
        draft.unlink(missing_ok=True)


def _series(axis: Any, times: np.ndarray, values: np.ndarray, label: str) -> None:
    axis.plot(times, values, color=_INK, linewidth=0.8)
    axis.set_ylabel(label)
    axis.set_xlim(0.0, times[-1])
    axis.grid(alpha=0.3)


def _mark_peak(axis: Any, times: np.ndarray, values: np.ndarray, unit: str) -> None:
    """A dot at the largest sample, its value in the corner that the curve leaves free."""
    place = int(np.abs(values).argmax())
    axis.plot(times[place], values[place], "o", color=_MARK, markersize=3.5)
    text = f"{abs(values[place]):.3g} {unit} at {times[place]:.2f} s"
    axis.annotate(
        text, (0.99, 0.95), xycoords="axes fraction", ha="right", va="top", fontsize=8, color=_MARK,
        bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 1.0},
    )  # fmt: skip


def _mark_duration(axis: Any, motion: Motion) -> None:
    first, last = significant_duration(motion)
    axis.axvspan(first, last, color=_MARK, alpha=0.07, linewidth=0.0)
    for level, time in ((0.05, first), (0.95, last)):
        axis.axhline(level, color="grey", linewidth=0.6, linestyle="--")
        axis.plot(time, level, "o", color=_MARK, markersize=3.5)
    axis.annotate(
        f"D5-95 {last - first:.2f} s", (0.99, 0.12), xycoords="axes fraction", ha="right", fontsize=8, color=_MARK
    )


def _spectrum(axis: Any, motion: Motion) -> None:
    periods = np.geomspace(_TICKS[0], _TICKS[-1], 200)
    axis.semilogx(periods, spectrum(motion, periods) / GRAVITY, color=_INK, linewidth=1.0)
    axis.set_xlim(_TICKS[0], _TICKS[-1])
    axis.set_xticks(_TICKS, labels=[f"{period:g}" for period in _TICKS])
    axis.minorticks_off()
    axis.set_ylim(bottom=0.0)
    axis.set_xlabel("period [s]")
    axis.set_ylabel("Sa, 5 % damped [g]")
    axis.grid(alpha=0.3)


TICKS = (0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 1, 1.5, 2, 3, 5, 10)
"""Periods [s] written on the axis."""
NAMED = 8
"""Motions up to which each is named in the legend."""


@styled
def draw_spectra(match: SpectrumMatch, title: str, unit: Unit) -> Figure:
    """Pseudo-accelerations in `unit` over the periods, the range that was met shaded."""
    target: TargetSpectrum = match.target
    figure = new_figure(6.4, 4.3)
    entitle(figure, "Target spectrum", "bold")
    ax = figure.add_subplot()
    ax.axvspan(target.low, target.high, color="0.94", lw=0, zorder=0)
    styles = ("-", "--", ":", "-.")
    for number, (name, values) in enumerate(match.spectra.items()):
        few = len(match.spectra) <= NAMED
        style = styles[number % 4] if few else "-"
        shade = ("0.55", "0.7")[number // 4 % 2] if few else "0.75"
        label = name if few else "motions" if number == 0 else None
        ax.plot(match.periods, np.array(values) / unit.factor, style, color=shade, lw=1.0, label=label)
    ax.plot(match.periods, match.mean / unit.factor, color="#0072B2", lw=2.2, label=f"mean of {len(match.spectra)}")
    across = np.geomspace(target.periods[0], target.periods[-1], 200)
    wanted = np.exp(np.interp(np.log(across), np.log(target.periods), np.log(target.values)))
    ax.plot(across, wanted / unit.factor, color="black", lw=2.0, dashes=(5, 2), label="target")
    if match.at_least is not None:
        least = match.at_least * target.ordinates / unit.factor
        ax.plot(target.grid, least, color="black", lw=1.0, dashes=(1, 2), label=f"{match.at_least:g} of the target")
    ax.set_xscale("log")
    ax.set_xlim(match.periods[0], match.periods[-1])
    ax.set_ylim(bottom=0)
    ax.set_xticks([period for period in TICKS if match.periods[0] <= period <= match.periods[-1]])
    ax.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
    ax.xaxis.set_minor_formatter(NullFormatter())
    ax.set_xlabel("period [s]")
    ax.set_ylabel(f"pseudo-acceleration [{unit.name}], {100 * target.damping:g} % damping")
    ax.set_title("" if is_for_paper() else title, loc="left", fontsize=8.5, color="0.25")
    ax.legend(fontsize=8)
    caption(figure, f"{match.words} Shaded: that range.")
    return figure
