"""Fig. 5 in the paper's form: both ratios against Omega / omega10; the claims of Figs 4 and 5."""

from __future__ import annotations

from itertools import product
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from matplotlib.figure import Figure

from pounding_cli.report.style import caption, new_figure, save, styled
from pounding_cli.store.files import opened_kind
from pounding_cli.store.swept import axes_of, coordinate, written

_COLORS = ("#000000", "#0072B2")


def draw_connector(path: Path, folder: Path, formats: tuple[str, ...] = ("png", "svg", "pdf")) -> list[Path]:
    """Draw the results of `pound connector`; returns the files."""
    with opened_kind(path, "connector") as file:
        return save({path.stem: connector_figure(file)}, folder, formats)


@styled
def connector_figure(file: h5py.File) -> Figure:
    """One panel a point of the sweep (at most twelve), |R1| solid and |R2| dashed."""
    axes = axes_of(file, "peak1")
    points = list(product(*(range(n) for n in file["peak1"].shape)))
    drawn = points[:12]
    columns = min(len(drawn), 3)
    rows = -(-len(drawn) // columns)
    figure = new_figure(3.6 * columns + 0.6, 3.0 * rows + 0.9)
    panels = figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True).ravel()
    x = file["frequency"][:]
    for ax, point in zip(panels, drawn, strict=False):
        for which, dash in ((1, "-"), (2, (0, (5, 2)))):
            y = file[f"R{which}"][point]
            ax.plot(x, y, color=_COLORS[which - 1], linestyle=dash, lw=1.6, label=f"system {which}")
        for low, high in file["both_above"][point]:
            if np.isfinite(low):
                ax.axvspan(low, high, color="0.88", zorder=0)
        for name in ("frequency_low", "frequency_high"):
            if x[0] < file[name][point] < x[-1]:
                ax.axvline(file[name][point], color="#AA2211", lw=0.9, linestyle=(0, (1, 1.5)))
        ax.axhline(1, color="0.35", lw=1.0, zorder=1)
        ax.set_title(point_label(file, axes, point), loc="left")
        ax.set(
            xlabel="Ω / ω₁₀",
            ylabel="largest displacement over that alone",
            xlim=(x[0], x[-1]),
            ylim=(0, None),
        )
    for ax in panels[len(drawn) :]:
        ax.axis("off")
    panels[0].legend(loc="upper right")
    figure.suptitle(str(file.attrs["title"]), x=0.015, ha="left", fontsize=11, fontweight="bold")
    note = "Grey: both ratios exceed one. Dotted: frequencies of the connected pair."
    if len(points) > len(drawn):
        note += f" The first {len(drawn)} of {len(points)} points of the sweep."
    caption(figure, note)
    return figure


def point_label(file: h5py.File, axes: tuple[str, ...], point: tuple[int, ...]) -> str:
    """A point of the sweep in words and the units of the study."""
    parts = []
    for name, place in zip(axes, point, strict=True):
        parts.append(f"{name} = {written(file[name]).text(coordinate(file, name)[place])}")
    return ", ".join(parts) or "response ratios"


def connector_claims(path: Path) -> list[dict[str, Any]]:
    """What the paper says of Figs 4 and 5 beside what was found, one entry a claim and point.

    Each entry has `paper` (the sentence), `found` (words with numbers), `holds` (bool) and `point`.
    """
    entries = []
    with opened_kind(path, "connector") as file:
        axes = axes_of(file, "peak1")
        for point in product(*(range(n) for n in file["peak1"].shape)):
            label = point_label(file, axes, point)
            low, high = float(file["frequency_low"][point]), float(file["frequency_high"][point])
            p = float(file["p"][point])
            entries.append(
                {
                    "point": label,
                    "paper": "The lowest frequency lies between the uncoupled ones, the other above both.",
                    "found": f"{low:.4f} and {high:.4f}, uncoupled 1 and {p:.4f} (over omega10)",
                    "holds": bool(min(1, p) <= low <= max(1, p) <= high),
                }
            )
            bands = [(a, b) for a, b in file["both_above"][point] if np.isfinite(a)]
            where = ", ".join(f"{a:.3f}-{b:.3f}" for a, b in bands) or "nowhere"
            peaks = (
                f"|R1| peaks at {file['peak1'][point]:.2f} (Omega/omega10 = {file['at1'][point]:.2f}), "
                f"|R2| at {file['peak2'][point]:.2f} ({file['at2'][point]:.2f})"
            )
            entries.append(
                {
                    "point": label,
                    "paper": "Whenever the response of one system increases, that of the other decreases.",
                    "found": f"both largest displacements grow in: {where}; {peaks}. It holds for the "
                    "signed real ratios of undamped systems: m1 R1 + m2 R2 = m1 + m2.",
                    "holds": not bands,
                }
            )
    return entries
