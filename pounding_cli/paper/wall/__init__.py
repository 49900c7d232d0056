"""The bumper wall of Fig. 8: plane stress and frame elements, struck by a floor.

`study` has its keys, `impact` solves it, here are numbers, references and figures of the report.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

from pounding_cli.paper.points import PointCommand, SweepPoint
from pounding_cli.paper.wall.study import WallStudySpec
from pounding_cli.report.style import finish, new_figure, styled

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from pounding_cli.report.document import Picture

WALL_NUMBERS = ("peak_force", "separation", "wall_stress", "averaged_stress")
"""The numbers of a table that fits a terminal; the page and the CSV table have all."""

_COLORS = ("#000000", "#0072B2", "#AA2211", "#009E73", "#E69F00", "#7B3294", "#56B4E9", "#8C6D31")
"""Of the histories of points; of as many they are drawn."""


def solve_wall(study: WallStudySpec) -> xr.Dataset:
    """Solve one impact, as `impact.solve_impact`."""
    from pounding_cli.paper.wall import impact  # here: `pound check` needs the study alone

    return impact.solve_impact(study)


def cite_wall(study: WallStudySpec) -> dict[str, str]:
    """The references of a study."""
    return {
        "spiliopoulos1996": "the bumper wall, Fig. 8",
        "anagnostopoulos1992": "bumper walls",
        "gustafsson2020": "the plane-stress elements of the wall",
        "wood1980": "the time integration",
    }


def build_wall_pictures(title: str, points: Sequence[SweepPoint]) -> list[Picture]:
    """The stresses at the last point, and histories."""
    from pounding_cli.report.document import Picture

    stress = "Von Mises stress on the mesh"
    history = "Contact force, speed of the striker, energy, and stress at the struck face"
    return [
        Picture("stress", stress, stress, partial(draw_stress, title, points[-1]), has_scale=True),
        Picture("history", history, history, partial(draw_histories, title, points[: len(_COLORS)])),
    ]


@styled
def draw_stress(title: str, point: SweepPoint) -> Figure:
    """Von Mises stress on the mesh: its envelope, and at its peak around the contact."""
    from matplotlib.collections import PolyCollection

    data = point.data
    study = point.study
    length = point.study.wall.length
    shown = data["outline"].to_numpy()
    figure = new_figure(7.4, 6.6)
    whole, near = figure.subplots(1, 2, width_ratios=(1, 1.9))
    headings = "Largest over time", f"Around the contact at {1e3 * float(data['time_of_peak']):.1f} ms"
    for ax, name, heading in zip((whole, near), ("stress_envelope", "stress_peak"), headings, strict=True):
        patches = PolyCollection(
            shown, array=data[name].to_numpy() / 1e6, cmap="magma_r", edgecolors="0.4",
            linewidths=0.15 if len(shown) < 5000 else 0.0, rasterized=len(shown) > 400,
        )  # fmt: skip
        patches.set_clim(0, float(data["stress_envelope"].max()) / 1e6)
        ax.add_collection(patches)
        ax.set(xlabel="x [m]", aspect="equal")
        ax.set_title(heading, loc="left")
        ax.grid(False)
    half = min(1.0, length / 2)
    contact = 0.5 * sum(study.patch)
    whole.set(xlim=(-0.4, length + 0.6), ylim=(-0.3, study.frame.height + 0.5), ylabel="height [m]")
    whole.hlines(study.frame.floors, length, length + 0.5, color="0.5", lw=2)
    near.set(xlim=(-0.2, 2 * half + 0.2), ylim=(contact - half, contact + half))
    figure.colorbar(patches, ax=near, label="von Mises stress [N/mm²]", shrink=0.6)
    where = f"{point.label}. " if point.label else ""
    finish(figure, title, f"{where}Element means. Grey stubs: beams.")
    return figure


@styled
def draw_histories(title: str, points: Sequence[SweepPoint]) -> Figure:
    """Contact force, speed of the striker, energies of the last point, and averaged stress against distance."""
    figure = new_figure(9.2, 6.4)
    (force, speed), (energy, face) = figure.subplots(2, 2)
    for color, point in zip(_COLORS, points, strict=False):
        data = point.data
        ms = 1e3 * point.data["time"]
        force.plot(ms, data["force"] / 1e6, color=color, lw=1.4, label=point.label)
        speed.plot(ms, data["velocity"], color=color, lw=1.4)
        face.plot(data["cell_stress"] / 1e6, data["cell_height"] - 0.5 * sum(point.study.patch), color=color)
    parts = [data[name] / 1e3 for name in ("striker_energy", "kinetic_energy", "strain_energy")]
    energy.stackplot(ms, *parts, labels=("striker", "moving building", "strain"), colors=("0.35", "0.6", "0.85"))
    force.set(xlabel="time [ms]", ylabel="contact force [MN]", title="Contact force")
    speed.set(xlabel="time [ms]", ylabel="velocity [m/s]", title="Striker")
    energy.set(xlabel="time [ms]", ylabel="energy [kJ]", title=f"Energy: {point.label or 'balance'}")
    of_face = f"largest stress, mean over {point.study.averaging_length:g} m [N/mm²]"
    face.set(xlabel=of_face, ylabel="distance up from the contact [m]", title="Stress at the struck face")
    speed.axhline(0, color="0.35", lw=1)
    energy.legend(loc="lower right", frameon=True)
    if point.label:
        force.legend(fontsize=6.5)
    finish(figure, title)
    return figure


WALL_COMMAND = PointCommand(
    name="wall",
    spec=WallStudySpec,
    solve=solve_wall,
    terminal_numbers=WALL_NUMBERS,
    cite_references=cite_wall,
    build_pictures=build_wall_pictures,
)
"""`pound wall`."""
