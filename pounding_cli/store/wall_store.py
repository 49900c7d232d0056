"""The results file of `pound wall`: numbers over the sweep, histories and fields of every point."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path

import h5py
import numpy as np

from pounding_cli.store.swept import create, write_array, write_axes, write_head, write_scale
from pounding_cli.study.system_study import Point, SystemStudy
from pounding_cli.wall.analysis import WallResponse, strike
from pounding_cli.wall.model import WallModel

NUMBERS = {
    "peak_force": ("N", "largest contact force"),
    "peak_time": ("s", "time of the largest contact force"),
    "separation": ("s", "first time the striker leaves the wall"),
    "last_contact": ("s", "last time the striker pushes"),
    "impulse": ("N s", "impulse of the contact force"),
    "momentum_residual": ("1", "impulse less the striker's change of momentum, over its first momentum"),
    "energy_residual": ("1", "largest open part of the energy balance, over the first energy"),
    "wall_stress": ("N/m2", "largest von Mises stress of an element"),
    "averaged_stress": ("N/m2", "largest von Mises stress averaged over the stated length"),
    "beam_stress": ("N/m2", "largest edge stress of the beams"),
    "column_stress": ("N/m2", "largest edge stress of the columns"),
    "beam_stress_then": ("N/m2", "largest edge stress of the beams at the instant of the wall's peak"),
    "column_stress_then": ("N/m2", "largest edge stress of the columns at the instant of the wall's peak"),
    "wall_shear": ("N", "largest shear force in a cross-section of the wall"),
    "wall_moment": ("N m", "largest bending moment in a cross-section of the wall"),
    "reach": ("m", "farthest from the contact that the averaged stress exceeds half its largest"),
    "stressed_share": ("1", "share of the wall's area stressed above a tenth of the averaged stress"),
    "step": ("s", "time step"),
    "freedoms": ("1", "degrees of freedom"),
    "seconds": ("s", "processor time"),
}
"""Variables over the swept dimensions: unit and meaning."""

_HISTORIES = {
    "force": ("N", "contact force"),
    "velocity": ("m/s", "velocity of the striker"),
    "position": ("m", "displacement of the striker"),
    "indentation": ("m", "displacement of the wall under the striker"),
    "striker_energy": ("J", "kinetic energy of the striker"),
    "kinetic_energy": ("J", "kinetic energy of wall and frame"),
    "strain_energy": ("J", "strain energy of wall and frame"),
}


def point_group(index: tuple[int, ...]) -> str:
    """Where a point's histories and fields lie in the file."""
    return "points/" + ("-".join(str(i) for i in index) or "0")


def write_wall(
    study: SystemStudy[WallModel],
    path: Path,
    progress: Callable[[Point[WallModel], WallResponse], None] | None = None,
    solve: Callable[..., Iterable[WallResponse]] = map,
) -> list[WallResponse]:
    """Solve every point of a study and write it; returns the responses in the points' order.

    solve : what takes `strike` and the models to their responses (`batch.points.kept_points`)
    """
    shape = tuple(len(axis.nodes) for axis in study.axes)
    responses = []
    with create(path) as file:
        write_head(file, "wall", study, path)
        dims = write_axes(file, study.axes, [(p.index, p.values) for p in study.points])
        solved = solve(strike, [point.model for point in study.points])
        for point, response in zip(study.points, solved, strict=True):
            responses.append(response)
            _write_point(file.create_group(point_group(point.index)), point, response)
            if progress is not None:
                progress(point, response)
        for name, (units, text) in NUMBERS.items():
            values = np.array([getattr(r, name) for r in responses], dtype=float).reshape(shape)
            write_array(file, name, values, dims, units, text)
    return responses


def _write_point(group: h5py.Group, point: Point[WallModel], response: WallResponse) -> None:
    run, fields, model = response.transient, response.fields, point.model
    group.attrs["flags"] = list(response.flags) or ""
    group.attrs["contact"] = model.patch
    for name, value in (
        ("length", model.length),
        ("height", model.frame.height),
        ("averaging_length", model.averaging_length),
        ("time_of_peak", fields.time_of_peak),
    ):
        group.attrs[name] = value
    group.attrs["floors"] = model.frame.floors
    group.attrs["columns"] = model.length + model.frame.columns
    write_scale(group, "time", run.time, "s")
    for name, (units, text) in _HISTORIES.items():
        write_array(group, name, getattr(run, name), ("time",), units, text)
    write_scale(group, "cell_height", response.cell_height, "m")
    text = "largest von Mises stress of the mean stress in a cell at the struck face"
    write_array(group, "cell_stress", response.cell_stress, ("cell_height",), "N/m2", text)
    write_scale(group, "row_height", response.row_height, "m")
    for name, units in (("normal", "N"), ("shear", "N"), ("moment", "N m")):
        text = f"largest {name} of the wall's cross-section over time"
        write_array(group, name, getattr(response, name), ("row_height",), units, text)
    mesh = group.create_group("mesh")
    mesh.attrs["description"] = "corner points [m], quadrilaterals (point numbers), values of points and elements"
    for name in ("points", "quads", "displacement", "stress_peak", "stress_envelope"):
        mesh.create_dataset(name, data=getattr(fields, name), compression="gzip", shuffle=True)
