"""The small drawing of the group at the head of a figure, to the form of the paper's Figs 6 and 7."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import accumulate, pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle

from pounding_cli.report.evidence import Evidence

WIDTH, SPACE, STOREY = 1.0, 0.35, 0.42
"""Width of a building, space between two of them and height of a storey, in units of the drawing."""
STRUCK = "#c8102e"
"""Colour of the points where slabs strike columns."""
MANY = 7
"""From this many buildings on, the periods are written upright and without their symbol."""


def draw_group(ax: Axes, evidence: Evidence, black: Sequence[str]) -> None:
    """Buildings left to right as blocks of storeys with their periods; those plotted are black. Storeys of several
    heights are drawn to one scale, slabs as thick as they are, and a point marks every place where a slab strikes
    columns.

    A period that is NaN is not written.
    """
    storeys = evidence.storey.dropna(subset=["V"]).groupby("building")["storey"].max()
    pitch = WIDTH + SPACE
    group = evidence.group
    levels = _levels(evidence, {name: int(storeys.get(name, 1)) for name in group})
    tallest = max(own[-1] for own in levels.values())
    many = len(group) >= MANY
    for place, name in enumerate(group):
        filled = name in black
        for below, above in pairwise(levels[name]):
            block = Rectangle(
                (place * pitch, below),
                WIDTH,
                above - below,
                facecolor="black" if filled else "white",
                edgecolor="0.75" if filled else "black",
                linewidth=0.8,
            )
            ax.add_patch(block)
        thick = _slab(evidence, name) * levels[name][-1] / (sum(_heights(evidence, name)) or 1.0)
        for above in levels[name][1:] if thick > 0 else ():
            shade = "0.75" if filled else "0.4"
            ax.add_patch(Rectangle((place * pitch, above - thick / 2), WIDTH, thick, color=shade, linewidth=0))
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
    struck = np.array(_struck(evidence, levels)).reshape(-1, 2)
    ax.plot(struck[:, 0], struck[:, 1], "o", color=STRUCK, ms=2.5, zorder=3)
    right = len(group) * pitch - SPACE
    ax.plot([-0.3, right + 0.3], [0, 0], color="black", lw=1.2, clip_on=False)
    ax.set(xlim=(-0.4, right + 0.4), ylim=(-0.75, tallest + 0.1))
    ax.axis("off")


def _heights(evidence: Evidence, name: str) -> list[float]:
    """Storey heights of a building from the ground up [m]; none where the results do not tell them."""
    buildings = evidence.buildings
    if "height" not in buildings:
        return []
    return [float(height) for height in buildings[buildings["building"] == name].sort_values("storey")["height"]]


def _slab(evidence: Evidence, name: str) -> float:
    """Thickness of its slabs [m]."""
    buildings = evidence.buildings
    return float(buildings[buildings["building"] == name]["slab"].iloc[0]) if "slab" in buildings else 0.0


def _levels(evidence: Evidence, storeys: Mapping[str, int]) -> dict[str, list[float]]:
    """Heights of the ground and the floors of every building in the drawing: each storey alike, or to one scale where
    storeys have several heights."""
    heights = {name: _heights(evidence, name) for name in storeys}
    known = [height for own in heights.values() for height in own]
    if len(set(known)) < 2 or any(len(heights[name]) != count for name, count in storeys.items()):
        return {name: [STOREY * level for level in range(count + 1)] for name, count in storeys.items()}
    scale = STOREY * len(known) / sum(known)
    return {name: [0.0, *(scale * level for level in accumulate(own))] for name, own in heights.items()}


def _struck(evidence: Evidence, levels: Mapping[str, Sequence[float]]) -> list[tuple[float, float]]:
    """Where slabs strike columns in the drawing."""
    link, pitch = evidence.link, WIDTH + SPACE
    if "left_at" not in link:
        return []
    found = []
    for row in link[(link["left_at"] < 1) | (link["right_at"] < 1)].drop_duplicates("link").to_dict("records"):
        side = "left" if row["left_at"] < 1 else "right"
        floor = int(row["floor" if side == "left" else "right_floor"])
        below, above = levels[row[side]][floor - 1 : floor + 1]
        face = evidence.group.index(row[side]) * pitch + (WIDTH if side == "left" else 0.0)
        found.append((face, below + row[f"{side}_at"] * (above - below)))
    return found
