"""The small drawing of the group at the head of a figure, to the form of the paper's Figs 6 and 7."""

from __future__ import annotations

import math
from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.patches import Rectangle

from pounding_cli.report.evidence import Evidence

WIDTH, SPACE, STOREY = 1.0, 0.35, 0.42
"""Width of a building, space between two of them and height of a storey, in units of the drawing."""
MANY = 7
"""From this many buildings on, the periods are written upright and without their symbol."""


def draw_group(ax: Axes, evidence: Evidence, black: Sequence[str]) -> None:
    """Buildings left to right as blocks of storeys with their periods; those plotted are black.

    A period that is NaN is not written.
    """
    storeys = evidence.storey.dropna(subset=["V"]).groupby("building")["storey"].max()
    pitch = WIDTH + SPACE
    group = evidence.group
    tallest = max(int(storeys.get(name, 1)) for name in group)
    many = len(group) >= MANY
    for place, name in enumerate(group):
        filled = name in black
        for storey in range(int(storeys.get(name, 1))):
            block = Rectangle(
                (place * pitch, storey * STOREY),
                WIDTH,
                STOREY,
                facecolor="black" if filled else "white",
                edgecolor="0.75" if filled else "black",
                linewidth=0.8,
            )
            ax.add_patch(block)
        if math.isnan(evidence.periods[name]):
            continue
        ax.annotate(
            f"{evidence.periods[name]:.2f}" if many else f"T = {evidence.periods[name]:.2f} s",
            (place * pitch + WIDTH / 2, 0),
            xytext=(0, -4),
            textcoords="offset points",
            ha="center",
            va="top",
            fontsize=6 if many else 7,
            rotation=90 if many else 0,
            annotation_clip=False,
        )
    right = len(group) * pitch - SPACE
    ax.plot([-0.3, right + 0.3], [0, 0], color="black", lw=1.2, clip_on=False)
    ax.set(xlim=(-0.4, right + 0.4), ylim=(-0.75, tallest * STOREY + 0.1))
    ax.axis("off")
