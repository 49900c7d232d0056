"""The target spectrum of a study against the mean and each of the motions as used."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullFormatter

from pounding_cli.numbers import Unit
from pounding_cli.records.scaling import SpectrumMatch, TargetSpectrum
from pounding_cli.report.style import caption, entitle, is_for_paper, new_figure, styled

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
