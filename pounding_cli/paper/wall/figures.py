"""The figures of an impact on the bumper wall: stresses on the mesh, and histories."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

from pounding_cli.report.document import Picture
from pounding_cli.report.style import finish, new_figure, with_style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from pounding_cli.paper.points import SweepPoint

COLORS = ("#000000", "#0072B2", "#AA2211", "#009E73", "#E69F00", "#7B3294", "#56B4E9", "#8C6D31")
"""Of the histories of points; of as many they are drawn."""

WALL_ENERGIES = {"striker_energy": "striker", "kinetic_energy": "moving building", "strain_energy": "strain"}
"""Histories of energy from the bottom up, and what they are called."""

MAX_EDGED = 5000
"""Elements of a mesh whose edges are drawn."""

MAX_VECTORS = 400
"""Elements of a mesh that a vector file has one by one."""


def list_wall_figures(title: str, points: Sequence[SweepPoint]) -> list[Picture]:
    """Return the figures: the stresses at the last point, and the histories of the first ones."""
    stress = "Von Mises stress on the mesh"
    history = "Contact force, speed of the striker, energy, and stress at the struck face"
    return [
        Picture("stress", stress, stress, partial(draw_stress, title, points[-1]), has_scale=True),
        Picture("history", history, history, partial(draw_histories, title, points)),
    ]


@with_style
def draw_stress(title: str, point: SweepPoint) -> Figure:
    """Draw the von Mises stress on the mesh: its envelope, and at its peak around the contact."""
    from matplotlib.collections import PolyCollection

    length = point.study.wall.length
    outline = point.values("outline")
    figure = new_figure(7.4, 6.6)
    whole, near = figure.subplots(1, 2, width_ratios=(1, 1.9))
    headings = "Largest over time", f"Around the contact at {1e3 * point.numbers['time_of_peak']:.1f} ms"
    for ax, name, heading in zip((whole, near), ("stress_envelope", "stress_peak"), headings, strict=True):
        patches = PolyCollection(
            list(outline), array=point.values(name) / 1e6, cmap="magma_r", edgecolors="0.4",
            linewidths=0.15 if len(outline) < MAX_EDGED else 0.0, rasterized=len(outline) > MAX_VECTORS,
        )  # fmt: skip
        patches.set_clim(0, float(point.values("stress_envelope").max()) / 1e6)
        ax.add_collection(patches)
        ax.set(xlabel="x [m]", aspect="equal")
        ax.set_title(heading, loc="left")
        ax.grid(False)
    half = min(1.0, length / 2)
    contact = 0.5 * sum(point.study.patch)
    whole.set(xlim=(-0.4, length + 0.6), ylim=(-0.3, point.study.frame.height + 0.5), ylabel="height [m]")
    whole.hlines(point.study.frame.floors, length, length + 0.5, color="0.5", lw=2)
    near.set(xlim=(-0.2, 2 * half + 0.2), ylim=(contact - half, contact + half))
    figure.colorbar(patches, ax=near, label="von Mises stress [N/mm²]", shrink=0.6)
    where = f"{point.label}. " if point.label else ""
    finish(figure, title, f"{where}Element means. Grey stubs: beams.")
    return figure


@with_style
def draw_histories(title: str, points: Sequence[SweepPoint]) -> Figure:
    """Draw contact force and speed of the striker, energies of the last point drawn, and averaged stress over height.

    Of more points than there are colours the first ones are drawn.
    """
    drawn = points[: len(COLORS)]
    last = drawn[-1]
    figure = new_figure(9.2, 6.4)
    (force, speed), (energy, face) = figure.subplots(2, 2)
    for color, point in zip(COLORS, drawn, strict=False):
        milliseconds = 1e3 * point.values("time")
        force.plot(milliseconds, point.values("force") / 1e6, color=color, lw=1.4, label=point.label)
        speed.plot(milliseconds, point.values("velocity"), color=color, lw=1.4)
        distance = point.values("cell_height") - 0.5 * sum(point.study.patch)
        face.plot(point.values("cell_stress") / 1e6, distance, color=color)
    _stack_energies(energy, last)
    force.set(xlabel="time [ms]", ylabel="contact force [MN]", title="Contact force")
    speed.set(xlabel="time [ms]", ylabel="velocity [m/s]", title="Striker")
    face_label = f"largest stress, mean over {last.study.averaging_length:g} m [N/mm²]"
    face.set(xlabel=face_label, ylabel="distance up from the contact [m]", title="Stress at the struck face")
    speed.axhline(0, color="0.35", lw=1)
    if last.label:
        force.legend(fontsize=6.5)
    left_out = f"The first {len(drawn)} of {len(points)} points of the sweep." if len(points) > len(drawn) else ""
    finish(figure, title, left_out)
    return figure


def _stack_energies(ax: Axes, point: SweepPoint) -> None:
    """Draw the energies of a point upon each other over time."""
    parts = [point.values(name) / 1e3 for name in WALL_ENERGIES]
    labels = list(WALL_ENERGIES.values())
    ax.stackplot(1e3 * point.values("time"), *parts, labels=labels, colors=("0.35", "0.6", "0.85"))
    ax.set(xlabel="time [ms]", ylabel="energy [kJ]", title=f"Energy: {point.label or 'balance'}")
    ax.legend(loc="lower right", frameon=True)
