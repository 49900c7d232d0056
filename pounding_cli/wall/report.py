"""Fig. 8: the numbers of an impact, what the paper says of them, stress on the deformed mesh, histories, sweeps."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from pounding_cli.points import Point
from pounding_cli.report.style import caption, entitle, new_figure, styled
from pounding_cli.study.axes import SweepAxis
from pounding_cli.variables import Variable
from pounding_cli.wall.study import WallStudy

_HISTORY, _CELL, _ROW = ("instant",), ("cell",), ("row",)
VARIABLES = (
    Variable("peak_force", (), "N", "largest contact force"),
    Variable("peak_time", (), "s", "time of the largest contact force"),
    Variable("separation", (), "s", "first time the striker leaves the wall"),
    Variable("last_contact", (), "s", "last time the striker pushes"),
    Variable("impulse", (), "N s", "impulse of the contact force"),
    Variable("momentum_residual", (), "1", "impulse less the striker's change of momentum, over its first momentum"),
    Variable("energy_residual", (), "1", "largest open part of the energy balance, over the first energy"),
    Variable("wall_stress", (), "N/m2", "largest von Mises stress of an element"),
    Variable("averaged_stress", (), "N/m2", "largest von Mises stress averaged over the stated length"),
    Variable("beam_stress", (), "N/m2", "largest edge stress of the beams"),
    Variable("column_stress", (), "N/m2", "largest edge stress of the columns"),
    Variable("beam_stress_then", (), "N/m2", "largest edge stress of the beams at the instant of the wall's peak"),
    Variable("column_stress_then", (), "N/m2", "largest edge stress of the columns at the instant of the wall's peak"),
    Variable("wall_shear", (), "N", "largest shear force in a cross-section of the wall"),
    Variable("wall_moment", (), "N m", "largest bending moment in a cross-section of the wall"),
    Variable("reach", (), "m", "farthest from the contact that the averaged stress exceeds half its largest"),
    Variable("stressed_share", (), "1", "share of the wall's area stressed above a tenth of the averaged stress"),
    Variable("step", (), "s", "time step"),
    Variable("freedoms", (), "1", "degrees of freedom"),
    Variable("averaged_over", (), "m", "length over which stress is averaged"),
    Variable("wall_length", (), "m", "length of the wall"),
    Variable("time_of_peak", (), "s", "instant of the largest stress of an element"),
    Variable("time", _HISTORY, "s", "time"),
    Variable("force", _HISTORY, "N", "contact force"),
    Variable("velocity", _HISTORY, "m/s", "velocity of the striker"),
    Variable("position", _HISTORY, "m", "displacement of the striker"),
    Variable("indentation", _HISTORY, "m", "displacement of the wall under the striker"),
    Variable("striker_energy", _HISTORY, "J", "kinetic energy of the striker"),
    Variable("kinetic_energy", _HISTORY, "J", "kinetic energy of wall and frame"),
    Variable("strain_energy", _HISTORY, "J", "strain energy of wall and frame"),
    Variable("cell_height", _CELL, "m", "height of a cell over which stress is averaged, at the struck face"),
    Variable("cell_stress", _CELL, "N/m2", "largest von Mises stress of the mean stress in a cell"),
    Variable("row_height", _ROW, "m", "height of a cross-section of the wall"),
    Variable("normal", _ROW, "N", "largest normal force in a cross-section"),
    Variable("shear", _ROW, "N", "largest shear force in a cross-section"),
    Variable("moment", _ROW, "N m", "largest bending moment in a cross-section"),
)
"""What the results file holds; those without dimensions are numbers of the table."""

_COLORS = ("#000000", "#0072B2", "#AA2211", "#009E73", "#E69F00", "#7B3294", "#56B4E9", "#8C6D31")
_FIELDS_DRAWN = 8
"""Points whose stresses are drawn and written for ParaView."""


def lines(point: Mapping[str, Any]) -> list[str]:
    """What is printed of a point."""
    mega = {name: value / 1e6 for name, value in point.items() if isinstance(value, float)}
    left = f"{1e3 * point['separation']:.1f} ms" if math.isfinite(point["separation"]) else "not reached"
    return [
        f"peak force {mega['peak_force']:.2f} MN at {1e3 * point['peak_time']:.1f} ms, separation {left}, "
        f"impulse {point['impulse'] / 1e3:.1f} kN s",
        f"peak stress {mega['wall_stress']:.1f} N/mm2 in an element, {mega['averaged_stress']:.1f} N/mm2 over "
        f"{point['averaged_over']:g} m; beams {mega['beam_stress']:.1f}, columns {mega['column_stress']:.1f} N/mm2",
        f"in the wall's cross-sections: shear up to {mega['wall_shear']:.2f} MN, "
        f"moment up to {mega['wall_moment']:.2f} MN m",
        f"energy balance open by {point['energy_residual']:.1e}; {point['freedoms']:.0f} freedoms, "
        f"step {1e3 * point['step']:.3g} ms, {point['seconds']:.2f} s",
    ]


def _strength(point: Mapping[str, Any]) -> tuple[bool, str]:
    averaged = point["averaged_stress"] / 1e6
    words = f"{averaged:.1f} N/mm2 averaged, {point['wall_stress'] / 1e6:.1f} N/mm2 in the worst element"
    return 0.8 * 33 <= averaged <= 1.2 * 33, words


def _frame(point: Mapping[str, Any]) -> tuple[bool, str]:
    names = "beam_stress", "column_stress", "beam_stress_then", "column_stress_then"
    beam, column, beam_then, column_then = (point[name] / 1e6 for name in names)
    words = f"at the instant of the wall's peak {beam_then:.1f} and {column_then:.1f} N/mm2, "
    words += f"later up to {beam:.1f} and {column:.1f} N/mm2"
    return max(beam, column) < 0.5 * point["averaged_stress"] / 1e6, words


def _local(point: Mapping[str, Any]) -> tuple[bool, str]:
    return point["reach"] < 1.0, f"{point['reach']:.2f} m from the contact half of the averaged stress is left"


STATEMENTS = (
    ("Maximum stresses are about 33 N/mm2, of the order of the compressive strength.", _strength),
    ("The stresses in the beams and columns are quite low.", _frame),
    ("The phenomenon is a rather local one.", _local),
)
"""What the paper says of Fig. 8."""


def cites(study: WallStudy) -> dict[str, str]:
    """The references of a study."""
    return {
        "spiliopoulos1996": "the bumper wall, Fig. 8",
        "anagnostopoulos1992": "bumper walls",
        "gustafsson2020": "the plane-stress elements of the wall",
        "wood1980": "the time integration",
    }


def figures(title: str, points: Sequence[Point], axes: Sequence[SweepAxis]) -> dict[str, tuple[str, Figure]]:
    """The stresses at the last point first, then histories, the peaks against every swept key, the other points."""
    drawn = list(points[:_FIELDS_DRAWN])
    found = {_name(drawn[-1]): (_heading(drawn[-1]), draw_stress(title, drawn[-1]))}
    heading = "Contact force, speed of the striker, energy, and stress at the struck face"
    found["history"] = (heading, draw_histories(title, drawn))
    for axis in (axis for axis in axes if len(axis) > 1):
        found[axis.names[0].replace(".", "-")] = (f"Peaks against {axis.names[0]}", draw_sweep(title, points, axis))
    return found | {_name(point): (_heading(point), draw_stress(title, point)) for point in drawn[:-1]}


def _name(point: Point) -> str:
    return "-".join(["stress", *map(str, point.place)])


def _heading(point: Point) -> str:
    return f"Von Mises stress on the deformed mesh{f', {point.label}' if point.label else ''}"


@styled
def draw_stress(title: str, point: Point) -> Figure:
    """Von Mises stress on the deformed mesh: at its peak, its envelope, and both around the contact."""
    fields, study, length = point.found["fields"], point.study, point.study.wall.length
    scale = 0.1 * length / (np.abs(fields["displacement"]).max() or 1.0)
    shown = (fields["points"] + scale * fields["displacement"])[fields["quads"]]
    figure = new_figure(8.4, 6.6)
    panels = figure.subplots(1, 3, width_ratios=(1, 1, 1.9))
    instant = f"{1e3 * point.found['time_of_peak']:.1f} ms"
    for ax, name, heading in (
        (panels[0], "stress_peak", f"At {instant}"),
        (panels[1], "stress_envelope", "Largest over time"),
        (panels[2], "stress_peak", f"Around the contact, {instant}"),
    ):
        patches = PolyCollection(
            shown, array=fields[name] / 1e6, cmap="magma_r", edgecolors="0.4",
            linewidths=0.15 if len(shown) < 5000 else 0.0, rasterized=len(shown) > 400,
        )  # fmt: skip
        patches.set_clim(0, float(fields["stress_envelope"].max()) / 1e6)
        ax.add_collection(patches)
        ax.set_aspect("equal")
        ax.grid(False)
        ax.set_title(heading, loc="left")
        ax.set_xlabel("x [m]")
    for ax in panels[:2]:
        ax.set(xlim=(-0.4, length + 0.6), ylim=(-0.3, study.frame.height + 0.5))
        ax.hlines(study.frame.floors, length, length + 0.5, color="0.5", lw=2)
    half, contact = min(1.0, length / 2), 0.5 * sum(study.patch)
    panels[2].set(xlim=(-0.2, 2 * half + 0.2), ylim=(contact - half, contact + half))
    panels[0].set_ylabel("height [m]")
    figure.colorbar(patches, ax=panels[2], label="von Mises stress [N/mm²]", shrink=0.6)
    entitle(figure, title, "bold")
    where = f"{point.label}. " if point.label else ""
    caption(figure, f"{where}Element means; displacements times {scale:.0f}. Grey stubs: beams.")
    return figure


@styled
def draw_histories(title: str, points: Sequence[Point]) -> Figure:
    """Contact force, speed of the striker, energies and averaged stress against distance."""
    figure = new_figure(9.2, 6.4)
    grid = figure.subplots(2, 2)
    for color, point in zip(_COLORS, points, strict=False):
        values, ms = point.found, 1e3 * point.found["time"]
        grid[0, 0].plot(ms, values["force"] / 1e6, color=color, lw=1.4, label=point.label)
        grid[0, 1].plot(ms, values["velocity"], color=color, lw=1.4)
        away = values["cell_height"] - 0.5 * sum(point.study.patch)
        grid[1, 1].plot(values["cell_stress"] / 1e6, away, color=color, lw=1.4)
    parts = [values[name] / 1e3 for name in ("striker_energy", "kinetic_energy", "strain_energy")]
    grid[1, 0].stackplot(ms, *parts, labels=("striker", "moving building", "strain"), colors=("0.35", "0.6", "0.85"))
    grid[0, 0].set(xlabel="time [ms]", ylabel="contact force [MN]", title="Contact force")
    grid[0, 1].set(xlabel="time [ms]", ylabel="velocity [m/s]", title="Striker")
    grid[1, 0].set(xlabel="time [ms]", ylabel="energy [kJ]", title=f"Energy: {point.label or 'balance'}")
    of_face = f"largest stress, mean over {values['averaged_over']:g} m [N/mm²]"
    grid[1, 1].set(xlabel=of_face, ylabel="distance up from the contact [m]", title="Stress at the struck face")
    grid[0, 1].axhline(0, color="0.35", lw=1)
    grid[1, 0].legend(loc="lower right", frameon=True)
    if point.label:
        grid[0, 0].legend(fontsize=6.5)
    entitle(figure, title, "bold")
    return figure


@styled
def draw_sweep(title: str, points: Sequence[Point], axis: SweepAxis) -> Figure:
    """Peak force, peak and averaged stress, and how far the stress reaches, against one swept key."""
    key, unit = axis.names[0], axis.units[0]
    figure = new_figure(9.2, 6.2)
    panels = figure.subplots(2, 2)
    curves: dict[str, list[Point]] = {}
    for point in points:  # a curve joins points that differ in this key alone
        others = [part for part in point.label.split(", ") if not part.startswith(f"{key} =")]
        curves.setdefault(", ".join(others), []).append(point)
    quantities = {
        "peak_force": (1e6, "peak force [MN]"),
        "averaged_stress": (1e6, "averaged stress [N/mm²]"),
        "wall_stress": (1e6, "stress of an element [N/mm²]"),
        "reach": (1.0, "distance to half of the averaged stress [m]"),
    }
    for ax, (name, (size, label)) in zip(panels.ravel(), quantities.items(), strict=True):
        for color, (alike, part) in zip(_COLORS, curves.items(), strict=False):
            x = [v if isinstance(v := point.swept[key], str) else unit.number(v) for point in part]
            ax.plot(x, [point.found[name] / size for point in part], color=color, marker="o", ms=4, label=alike)
        ax.set(xlabel=unit.label(key), ylabel=label, ylim=(0, None))
    if len(curves) > 1:
        panels[0, 0].legend(fontsize=7)
    entitle(figure, title, "bold")
    return figure


def write_fields(points: Sequence[Point], folder: Path) -> None:
    """Write the fields of points for ParaView, lengths in m, stresses in N/m2."""
    import meshio

    def in_space(array: np.ndarray) -> np.ndarray:
        return np.column_stack([array, np.zeros(len(array))])

    (folder / "fields").mkdir(exist_ok=True)
    for point in points[:_FIELDS_DRAWN]:
        fields = point.found["fields"]
        meshio.Mesh(
            in_space(fields["points"]),
            [("quad", fields["quads"])],
            point_data={"displacement": in_space(fields["displacement"])},
            cell_data={name: [fields[name]] for name in ("stress_peak", "stress_envelope")},
        ).write(folder / "fields" / f"{_name(point)}.vtu")
