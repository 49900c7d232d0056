"""Figures of motions: one by itself, and the spectra of those of a study against their target."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from pounding_cli.errors import InputError, Issue
from pounding_cli.numbers import Unit
from pounding_cli.records.motion import Motion, displacement, husid, significant_duration, spectrum, velocity
from pounding_cli.records.scaling import SpectrumMatch, TargetSpectrum
from pounding_cli.report.style import FIGURE_FORMATS, drawn_as, finish, new_figure, with_style
from pounding_cli.units import GRAVITY

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PERIODS = np.geomspace(0.05, 4.0, 200)
"""Periods of the spectrum of one motion [s]."""


def save_motion_figure(motion: Motion, title: str, path: Path) -> None:
    """Draw a motion into a file, PNG, SVG or PDF by its ending.

    Raises InputError: another ending.
    """
    suffix = path.suffix.lower().lstrip(".")
    if suffix not in FIGURE_FORMATS:
        hint = f"end the name with one of .{', .'.join(FIGURE_FORMATS)}"
        raise InputError(Issue((), f"cannot draw a '{path.suffix}' file", hint, file=str(path)))
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(drawn_as(draw_motion(motion, title), suffix))


@with_style
def draw_motion(motion: Motion, title: str) -> Figure:
    """Draw acceleration, velocity, displacement and Husid curve over time, and the spectrum."""
    figure = new_figure(8.0, 9.0)
    *over_time, last = figure.subplots(5, 1, gridspec_kw={"height_ratios": [1, 1, 1, 1, 1.6]})
    times = motion.dt * np.arange(motion.acceleration.size)
    series = {
        "acceleration [g]": motion.acceleration / GRAVITY, "velocity [m/s]": velocity(motion),
        "displacement [m]": displacement(motion), "Husid [-]": husid(motion),
    }  # fmt: skip
    for ax, (label, values) in zip(over_time, series.items(), strict=True):
        ax.plot(times, values, color="#1a1a1a", lw=0.8)
        ax.set(ylabel=label, xlim=(0.0, times[-1]))
    first, end = significant_duration(motion)
    over_time[-1].axvspan(first, end, color="#b3261e", alpha=0.07, lw=0)
    over_time[-1].set_xlabel(f"time [s]; shaded: D5-95, {end - first:.2f} s")
    last.plot(PERIODS, spectrum(motion, PERIODS) / GRAVITY, color="#1a1a1a", lw=1.0)
    last.set(xscale="log", xlim=(PERIODS[0], PERIODS[-1]), xlabel="period [s]")
    last.set_ylim(bottom=0.0)
    last.set_ylabel("pseudo-acceleration [g], 5 %")
    figure.align_ylabels([*over_time, last])
    finish(figure, f"{title} ({motion.source})")
    return figure


@with_style
def draw_spectra(match: SpectrumMatch, title: str, unit: Unit) -> Figure:
    """Draw the pseudo-accelerations over the periods, with the range that was met shaded.

    unit : of the accelerations
    """
    target: TargetSpectrum = match.target
    figure = new_figure(6.4, 4.3)
    ax = figure.add_subplot()
    ax.axvspan(target.low, target.high, color="0.94", lw=0, zorder=0)
    for values in match.spectra.values():
        (line,) = ax.plot(match.periods, np.array(values) / unit.factor, color="0.7", lw=1.0)
    line.set_label("motions")
    mean = np.mean(list(match.spectra.values()), axis=0)
    ax.plot(match.periods, mean / unit.factor, color="#0072B2", lw=2.2, label=f"mean of {len(match.spectra)}")
    across = _list_drawn_periods(target, match.periods[0], match.periods[-1])
    label = target.name or "target"
    ax.plot(across, target.interpolate(across) / unit.factor, color="black", lw=2.0, dashes=(5, 2), label=label)
    if match.at_least is not None:
        within = _with_corners(target.grid, target)
        limit = match.at_least * target.interpolate(within) / unit.factor
        ax.plot(within, limit, color="black", lw=1.0, dashes=(1, 2), label=f"{match.at_least:g} of the target")
    ax.set(xscale="log", xlim=(match.periods[0], match.periods[-1]), xlabel="period [s]")
    ax.set_ylim(bottom=0)
    ax.set_ylabel(f"pseudo-acceleration [{unit.name}], {100 * target.damping:g} % damping")
    ax.legend(fontsize=8)
    finish(figure, f"Target spectrum: {title}", f"{match.words} Shaded: that range.")
    return figure


def _list_drawn_periods(target: TargetSpectrum, first: float, last: float) -> np.ndarray:
    """Return the periods at which a target is drawn [s], its corners among them.

    first, last : ends of the axis [s]: the spectrum of a code is not drawn beyond them
    """
    ends = target.periods[0], target.periods[-1]
    if target.name:
        ends = max(first, ends[0]), min(last, ends[1])
    return _with_corners(np.geomspace(*ends, 200), target)


def _with_corners(periods: np.ndarray, target: TargetSpectrum) -> np.ndarray:
    """Return rising periods, and the corners of a target between them [s]."""
    corners = [corner for corner in target.periods if periods[0] < corner < periods[-1]]
    return np.union1d(periods, corners)
