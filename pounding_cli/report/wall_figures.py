"""Fig. 8: stress on the deformed mesh, histories, stress against distance, and numbers over the sweep."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
import pandas as pd
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from pounding_cli.report.style import caption, entitle, new_figure, styled
from pounding_cli.store import Results
from pounding_cli.store.points import Point

_COLORS = ("#000000", "#0072B2", "#AA2211", "#009E73", "#E69F00", "#7B3294", "#56B4E9", "#8C6D31")
_MANY = 400
"""Elements from which a mesh is an image within a figure of lines and letters."""


def along(results: Results, frame: pd.DataFrame, *keys: str) -> Iterator[tuple[str, pd.DataFrame]]:
    """The rows of a sweep that differ in some swept keys alone, and what they have in common in words."""
    rest = [names[0] for names in results.swept if names[0] not in keys]
    for values, part in frame.groupby(rest, sort=False) if rest else [((), frame)]:
        yield ", ".join(f"{k} = {results.value_label(k, v)}" for k, v in zip(rest, values, strict=True)), part


@styled
def draw_histories(results: Results, points: Sequence[Point]) -> Figure:
    """Contact force, speed of the striker, energies and averaged stress against distance."""
    figure = new_figure(9.2, 6.4)
    grid = figure.subplots(2, 2)
    drawn = points[: len(_COLORS)]
    for color, (_, label, point) in zip(_COLORS, drawn, strict=False):
        ms = 1e3 * point["time"]
        grid[0, 0].plot(ms, point["force"] / 1e6, color=color, lw=1.4, label=label)
        grid[0, 1].plot(ms, point["velocity"], color=color, lw=1.4)
        away = point["cell_height"] - point["contact"].mean()
        grid[1, 1].plot(point["cell_stress"] / 1e6, away, color=color, lw=1.4)
    _, label, point = drawn[-1]
    parts = [point[name] / 1e3 for name in ("striker_energy", "kinetic_energy", "strain_energy")]
    names = ("striker", "moving building", "strain")
    grid[1, 0].stackplot(1e3 * point["time"], *parts, labels=names, colors=("0.35", "0.6", "0.85"))
    grid[0, 0].set(xlabel="time [ms]", ylabel="contact force [MN]", title="Contact force")
    grid[0, 1].set(xlabel="time [ms]", ylabel="velocity [m/s]", title="Striker")
    grid[1, 0].set(xlabel="time [ms]", ylabel="energy [kJ]", title=f"Energy: {label or 'balance'}")
    of_face = f"largest stress, mean over {point['averaged_over']:g} m [N/mm²]"
    grid[1, 1].set(xlabel=of_face, ylabel="distance up from the contact [m]", title="Stress at the struck face")
    grid[0, 1].axhline(0, color="0.35", lw=1)
    grid[1, 0].legend(loc="lower right", frameon=True)
    if label:
        grid[0, 0].legend(fontsize=6.5)
    _title(figure, results)
    if (count := math.prod(len(results.axes[names[0]]) for names in results.swept)) > len(drawn):
        caption(figure, f"{len(drawn)} of {count} points of the sweep.")
    return figure


@styled
def draw_stress(results: Results, point: Point) -> Figure:
    """Von Mises stress on the deformed mesh: at its peak, its envelope, and both around the contact."""
    _, label, values = point
    length = values["wall_length"]
    points, quads, moved = values["points"], values["quads"].astype(int), values["displacement"]
    largest = np.abs(moved).max()
    scale = 0.1 * length / largest if largest > 0 else 1.0
    shown = (points + scale * moved)[quads]
    contact = values["contact"].mean()
    figure = new_figure(8.4, 6.6)
    panels = figure.subplots(1, 3, width_ratios=(1, 1, 1.9))
    top = float(values["stress_envelope"].max()) / 1e6
    instant = f"{1e3 * values['time_of_peak']:.1f} ms"
    for ax, name, title in (
        (panels[0], "stress_peak", f"At {instant}"),
        (panels[1], "stress_envelope", "Largest over time"),
        (panels[2], "stress_peak", f"Around the contact, {instant}"),
    ):
        thin = 0.15 if len(quads) < 5000 else 0.0
        patches = PolyCollection(
            shown, array=values[name] / 1e6, cmap="magma_r", edgecolors="0.4", linewidths=thin,
            rasterized=len(quads) > _MANY,
        )  # fmt: skip
        patches.set_clim(0, top)
        ax.add_collection(patches)
        ax.set_aspect("equal")
        ax.grid(False)
        ax.set_title(title, loc="left")
        ax.set_xlabel("x [m]")
    for ax in panels[:2]:
        ax.set(xlim=(-0.4, length + 0.6), ylim=(-0.3, values["floors"][-1] + 0.5))
        for floor in values["floors"]:
            ax.plot([length, length + 0.5], [floor, floor], color="0.5", lw=2)
    half = min(1.0, length / 2)
    panels[2].set(xlim=(-0.2, 2 * half + 0.2), ylim=(contact - half, contact + half))
    panels[0].set_ylabel("height [m]")
    figure.colorbar(patches, ax=panels[2], label="von Mises stress [N/mm²]", shrink=0.6)
    _title(figure, results)
    where = f"{label}. " if label else ""
    caption(figure, f"{where}Element means; displacements times {scale:.0f}. Grey stubs: beams.")
    return figure


@styled
def draw_sweep(results: Results, frame: pd.DataFrame, key: str) -> Figure:
    """Peak force, peak and averaged stress, and how far the stress reaches, against one swept key."""
    figure = new_figure(9.2, 6.2)
    panels = figure.subplots(2, 2)
    values = results.axes[key]
    is_text = isinstance(values[0], str)
    x = list(range(len(values))) if is_text else [results.units[key].number(value) for value in values]
    lines = list(along(results, frame, key))
    quantities = {
        "peak_force": (1e-6, "peak force [MN]"),
        "averaged_stress": (1e-6, f"stress, mean over {frame['averaged_over'].iloc[0]:g} m [N/mm²]"),
        "wall_stress": (1e-6, "stress of an element [N/mm²]"),
        "reach": (1.0, "distance to half of it [m]"),
    }
    for ax, (name, (factor, heading)) in zip(panels.ravel(), quantities.items(), strict=True):
        for color, (label, part) in zip(_COLORS, lines, strict=False):
            ax.plot(x, factor * part[name], color=color, marker="o", ms=4, lw=1.4, label=label)
        ax.set(xlabel=results.axis_label(key), ylabel=heading)
        ax.set_ylim(bottom=0)
        if is_text:
            ax.set_xticks(x, values)
        elif min(x) > 0 and max(x) / min(x) > 5:
            ax.set_xscale("log")
            ax.set_xticks(x, [f"{v:g}" for v in x], minor=False)
            ax.set_xticks([], minor=True)
    if len(lines) > 1:
        panels[0, 0].legend(fontsize=7)
    _title(figure, results)
    if len(lines) > len(_COLORS):
        caption(figure, f"The first {len(_COLORS)} of {len(lines)} curves.")
    return figure


@styled
def draw_accuracy(results: Results, frame: pd.DataFrame) -> Figure:
    """Error of force and averaged stress against processor time, one line a mesh refined.

    Errors are relative to the point with the most freedoms among those that differ in mesh alone; that point
    itself is left out.
    """
    figure = new_figure(9.2, 3.6)
    panels = figure.subplots(1, 2)
    # Elements of either shape approach one limit; any other key changes what is computed.
    finest = {
        number: part.iloc[int(part["freedoms"].argmax())]
        for _, part in along(results, frame, "mesh.size", "mesh.element")
        for number in part.index
    }
    labels = False
    for color, (label, part) in zip(_COLORS, along(results, frame, "mesh.size"), strict=False):
        labels = labels or bool(label)
        for ax, name in zip(panels, ("peak_force", "averaged_stress"), strict=True):
            error = np.abs(part[name] / finest[part.index[0]][name] - 1)
            kept = error > 0
            ax.loglog(part["seconds"][kept], error[kept], color=color, marker="o", ms=4, lw=1.4, label=label)
    for ax, what in zip(panels, ("error of peak force", "error of averaged stress"), strict=True):
        ax.set(xlabel="processor time [s]", ylabel=what)
    if labels:
        panels[0].legend(fontsize=7)
    _title(figure, results)
    caption(figure, "Relative to the finest mesh of the study with the same contact.")
    return figure


def _title(figure: Figure, results: Results) -> None:
    entitle(figure, results.title, "bold")
