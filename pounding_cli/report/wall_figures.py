"""Fig. 8: stress on the deformed mesh, histories, stress against distance, sweeps; fields as VTU."""

from __future__ import annotations

from itertools import product
from pathlib import Path

import h5py
import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from pounding_cli.report.connector_figures import point_label
from pounding_cli.report.style import caption, new_figure, save, styled
from pounding_cli.store.files import opened_kind
from pounding_cli.store.swept import axes_of, coordinate
from pounding_cli.store.wall_store import point_group

_COLORS = ("#000000", "#0072B2", "#AA2211", "#009E73", "#E69F00", "#7B3294", "#56B4E9", "#8C6D31")
_FIELDS_DRAWN = 8
_UNITS = {
    "length": "m",
    "thickness": "m",
    "averaging_length": "m",
    "storey_height": "m",
    "patch": "m",
    "size": "m",
    "height": "m",
    "width": "m",
    "depth": "m",
    "mass": "kg",
    "floor_mass": "kg",
    "speed": "m/s",
    "young": "N/m²",
    "density": "kg/m³",
    "end": "s",
    "step": "s",
}


def draw_wall(path: Path, folder: Path, formats: tuple[str, ...] = ("png", "svg"), vtu: bool = True) -> list[Path]:
    """Draw the results of `pound wall` and write its fields for ParaView; returns the files."""
    with opened_kind(path, "wall") as file:
        points = list(product(*(range(n) for n in file["peak_force"].shape)))
        figures = {f"{path.stem}-history": history_figure(file, points)}
        for point in points[:_FIELDS_DRAWN]:
            suffix = "-" + "-".join(map(str, point)) if point else ""
            figures[f"{path.stem}-stress{suffix}"] = stress_figure(file, point)
        for axis in range(len(axes_of(file, "peak_force"))):
            if file["peak_force"].shape[axis] > 1:
                name = axes_of(file, "peak_force")[axis]
                figures[f"{path.stem}-{name.replace('.', '-')}"] = sweep_figure(file, axis)
        if "mesh.size" in axes_of(file, "peak_force"):
            figures[f"{path.stem}-accuracy"] = accuracy_figure(file)
        written = save(figures, folder, formats)
        if vtu:
            written += [_write_vtu(file, point, folder / path.stem) for point in points[:_FIELDS_DRAWN]]
    return written


@styled
def history_figure(file: h5py.File, points: list[tuple[int, ...]]) -> Figure:
    """Contact force, speed of the striker, energies and averaged stress against distance."""
    axes = axes_of(file, "peak_force")
    figure = new_figure(9.2, 6.4)
    grid = figure.subplots(2, 2)
    drawn = points[: len(_COLORS)]
    for color, point in zip(_COLORS, drawn, strict=False):
        group = file[point_group(point)]
        ms = 1e3 * group["time"][:]
        label = point_label(file, axes, point) if axes else None
        grid[0, 0].plot(ms, group["force"][:] / 1e6, color=color, lw=1.4, label=label)
        grid[0, 1].plot(ms, group["velocity"][:], color=color, lw=1.4)
        away = group["cell_height"][:] - group.attrs["contact"].mean()
        grid[1, 1].plot(group["cell_stress"][:] / 1e6, away, color=color, lw=1.4)
    group = file[point_group(drawn[-1])]
    ms = 1e3 * group["time"][:]
    parts = [group[name][:] / 1e3 for name in ("striker_energy", "kinetic_energy", "strain_energy")]
    names = ("striker", "moving building", "strain")
    grid[1, 0].stackplot(ms, *parts, labels=names, colors=("0.35", "0.6", "0.85"))
    grid[0, 0].set(xlabel="time [ms]", ylabel="contact force [MN]", title="Contact force")
    grid[0, 1].set(xlabel="time [ms]", ylabel="velocity [m/s]", title="Striker")
    which = point_label(file, axes, drawn[-1]) if axes else "balance"
    grid[1, 0].set(xlabel="time [ms]", ylabel="energy [kJ]", title=f"Energy: {which}")
    side = file[point_group(drawn[0])].attrs["averaging_length"]
    label = f"largest stress, mean over {side:g} m [N/mm²]"
    grid[1, 1].set(xlabel=label, ylabel="distance up from the contact [m]", title="Stress at the struck face")
    grid[0, 1].axhline(0, color="0.35", lw=1)
    grid[1, 0].legend(loc="lower right", frameon=True)
    if axes:
        grid[0, 0].legend(fontsize=6.5)
    _title(figure, file)
    if len(points) > len(drawn):
        caption(figure, f"The first {len(drawn)} of {len(points)} points of the sweep.")
    return figure


@styled
def stress_figure(file: h5py.File, point: tuple[int, ...]) -> Figure:
    """Von Mises stress on the deformed mesh: at its peak, its envelope, and both around the contact."""
    group = file[point_group(point)]
    mesh = group["mesh"]
    points, quads, moved = mesh["points"][:], mesh["quads"][:], mesh["displacement"][:]
    largest = np.abs(moved).max()
    scale = 0.1 * group.attrs["length"] / largest if largest > 0 else 1.0
    shown = (points + scale * moved)[quads]
    contact = group.attrs["contact"].mean()
    figure = new_figure(8.4, 6.6)
    panels = figure.subplots(1, 3, width_ratios=(1, 1, 1.9))
    top = float(mesh["stress_envelope"][:].max()) / 1e6
    instant = f"{1e3 * group.attrs['time_of_peak']:.1f} ms"
    for ax, name, title in (
        (panels[0], "stress_peak", f"At {instant}"),
        (panels[1], "stress_envelope", "Largest over time"),
        (panels[2], "stress_peak", f"Around the contact, {instant}"),
    ):
        values = mesh[name][:] / 1e6
        thin = 0.15 if len(quads) < 5000 else 0.0
        patches = PolyCollection(shown, array=values, cmap="magma_r", edgecolors="0.4", linewidths=thin)
        patches.set_clim(0, top)
        ax.add_collection(patches)
        ax.set_aspect("equal")
        ax.grid(False)
        ax.set_title(title, loc="left")
        ax.set_xlabel("x [m]")
    for ax in panels[:2]:
        ax.set(xlim=(-0.4, group.attrs["length"] + 0.6), ylim=(-0.3, group.attrs["height"] + 0.5))
        for floor in group.attrs["floors"]:
            ax.plot([group.attrs["length"], group.attrs["length"] + 0.5], [floor, floor], color="0.5", lw=2)
    half = min(1.0, group.attrs["length"] / 2)
    low, high = contact - half, contact + half
    panels[2].set(xlim=(-0.2, 2 * half + 0.2), ylim=(low, high))
    panels[0].set_ylabel("height [m]")
    figure.colorbar(patches, ax=panels[2], label="von Mises stress [N/mm²]", shrink=0.6)
    _title(figure, file)
    axes = axes_of(file, "peak_force")
    label = (point_label(file, axes, point) + ". ") if axes else ""
    caption(figure, f"{label}Element means; displacements times {scale:.0f}. Grey stubs: beams.")
    return figure


@styled
def sweep_figure(file: h5py.File, axis: int) -> Figure:
    """Peak force, peak and averaged stress, and how far the stress reaches, against one swept axis."""
    axes = axes_of(file, "peak_force")
    name = axes[axis]
    values = coordinate(file, name)
    x = list(range(len(values))) if isinstance(values[0], str) else values
    unit = _UNITS.get(name.rsplit(".", 1)[-1])
    named = f"{name} [{unit}]" if unit and not isinstance(values[0], str) else name
    figure = new_figure(9.2, 6.2)
    panels = figure.subplots(2, 2)
    shape = file["peak_force"].shape
    others = list(product(*(range(n) if place != axis else (0,) for place, n in enumerate(shape))))
    for color, other in zip(_COLORS, others, strict=False):
        along = (*other[:axis], slice(None), *other[axis + 1 :])
        rest = tuple(n for place, n in enumerate(axes) if place != axis)
        at = tuple(n for place, n in enumerate(other) if place != axis)
        label = point_label(file, rest, at) if rest else None
        for ax, key, factor in (
            (panels[0, 0], "peak_force", 1e-6),
            (panels[0, 1], "averaged_stress", 1e-6),
            (panels[1, 0], "wall_stress", 1e-6),
            (panels[1, 1], "reach", 1.0),
        ):
            ax.plot(x, factor * file[key][along], color=color, marker="o", ms=4, lw=1.4, label=label)
    side = file[point_group(others[0])].attrs["averaging_length"]
    for ax, label in zip(
        panels.ravel(),
        (
            "peak force [MN]",
            f"stress, mean over {side:g} m [N/mm²]",
            "stress of an element [N/mm²]",
            "distance to half of it [m]",
        ),
        strict=True,
    ):
        ax.set(xlabel=named, ylabel=label)
        ax.set_ylim(bottom=0)
        if isinstance(values[0], str):
            ax.set_xticks(x, values)
        elif min(x) > 0 and max(x) / min(x) > 5:
            ax.set_xscale("log")
            ax.set_xticks(x, [f"{v:g}" for v in x], minor=False)
            ax.set_xticks([], minor=True)
    if len(axes) > 1:
        panels[0, 0].legend(fontsize=7)
    _title(figure, file)
    if len(others) > len(_COLORS):
        caption(figure, f"The first {len(_COLORS)} of {len(others)} curves.")
    return figure


@styled
def accuracy_figure(file: h5py.File) -> Figure:
    """Error of force and averaged stress against processor time, one line a mesh refined.

    Errors are relative to the point with the most freedoms among those that differ in mesh alone; that point
    itself is left out.
    """
    axes = axes_of(file, "peak_force")
    axis = axes.index("mesh.size")
    figure = new_figure(9.2, 3.6)
    panels = figure.subplots(1, 2)
    lines = list(product(*(range(n) for place, n in enumerate(file["peak_force"].shape) if place != axis)))
    rest = tuple(name for name in axes if name != "mesh.size")
    # Elements of either shape approach one limit; any other key changes what is computed.
    alike = [tuple(p for p, name in zip(line, rest, strict=True) if name != "mesh.element") for line in lines]
    for color, line, group in zip(_COLORS, lines, alike, strict=False):
        at = (*line[:axis], slice(None), *line[axis:])
        along = [
            (*other[:axis], slice(None), *other[axis:]) for other, g in zip(lines, alike, strict=True) if g == group
        ]
        finest = max(along, key=lambda where: file["freedoms"][where].max())
        best = int(np.argmax(file["freedoms"][finest]))
        for ax, key in zip(panels, ("peak_force", "averaged_stress"), strict=True):
            error = np.abs(file[key][at] / file[key][finest][best] - 1)
            seconds = file["seconds"][at]
            shown = error > 0
            label = point_label(file, rest, line) if rest else None
            ax.loglog(seconds[shown], error[shown], color=color, marker="o", ms=4, lw=1.4, label=label)
    for ax, label in zip(panels, ("error of peak force", "error of averaged stress"), strict=True):
        ax.set(xlabel="processor time [s]", ylabel=label)
    if rest:
        panels[0].legend(fontsize=7)
    _title(figure, file)
    caption(figure, "Relative to the finest mesh of the study with the same contact.")
    return figure


def _title(figure: Figure, file: h5py.File) -> None:
    figure.suptitle(str(file.attrs["title"]), x=0.015, ha="left", fontsize=11, fontweight="bold")


def _write_vtu(file: h5py.File, point: tuple[int, ...], folder: Path) -> Path:
    """The fields of one point for ParaView; lengths in m, stresses in N/m2."""
    import meshio

    mesh = file[point_group(point)]["mesh"]
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{point_group(point).split('/')[1]}.vtu"

    def in_space(array: np.ndarray) -> np.ndarray:
        return np.column_stack([array, np.zeros(len(array))])

    stresses = {name: [mesh[name][:]] for name in ("stress_peak", "stress_envelope")}
    meshio.Mesh(
        in_space(mesh["points"][:]),
        [("quad", mesh["quads"][:])],
        point_data={"displacement": in_space(mesh["displacement"][:])},
        cell_data=stresses,
    ).write(path)
    return path
