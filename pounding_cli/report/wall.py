"""The report of `pound wall`: figures, the statements on Fig. 8, what settles with the mesh, fields, references."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from pounding_cli.report.answer_page import AnswerPage, Illustration
from pounding_cli.report.citations import Use
from pounding_cli.report.evidence import Evidence
from pounding_cli.report.statements import CAPTION, Statement, judged
from pounding_cli.report.wall_figures import along, draw_accuracy, draw_histories, draw_stress, draw_sweep
from pounding_cli.store import Results
from pounding_cli.store.points import Point, read_points

LOW = 0.5
"""A stress is called low, or lower, below this share of the wall's averaged peak."""

SETTLED = 0.1
"""A number settles where the last refinement of the mesh changes it by less than this share."""

_FIELDS_DRAWN = 8


def wall_page(results: Results, shown: Evidence | None, with_figures: bool = True) -> AnswerPage:
    """What the report of an impact on the bumper wall says; its fields are written for ParaView beside it."""
    table = (CAPTION, judged(results, STATEMENTS))
    if not with_figures:
        return AnswerPage("Against the paper", [], {}, [table], mesh_convergence(results))
    points = [point for point in read_points(results, _FIELDS_DRAWN) if point.values["status"] == "done"]
    figures = _figures(results, points) if points else {}
    fields = partial(write_fields, points)
    return AnswerPage("Against the paper", [], figures, [table], mesh_convergence(results), fields)


def _figures(results: Results, points: Sequence[Point]) -> dict[str, Illustration]:
    """The stresses at the last point first, those of the other points last."""
    figures = _stress(results, points[-1])
    heading = "Contact force, speed of the striker, energy, and stress at the struck face"
    figures["history"] = Illustration(draw_histories(results, points), heading, "Over time, one line a point.")
    frame = results.answer("wall").frame
    for key in (names[0] for names in results.swept if len(results.axes[names[0]]) > 1):
        heading = f"Peaks against {key}"
        figures[key.replace(".", "-")] = Illustration(draw_sweep(results, frame, key), heading, heading)
    if "mesh.size" in results.axes:
        heading = "Error of the peaks against processor time"
        figures["accuracy"] = Illustration(draw_accuracy(results, frame), heading, "One line a mesh that is refined.")
    for point in points[:-1]:
        figures |= _stress(results, point)
    return figures


def _stress(results: Results, point: Point) -> dict[str, Illustration]:
    heading = f"Stress in the wall, {point.label}" if point.label else "Stress in the wall"
    text = f"Von Mises stress on the deformed mesh, at most {point.values['wall_stress'] / 1e6:.1f} N/mm²."
    return {_name("stress", point): Illustration(draw_stress(results, point), heading, text)}


def _name(what: str, point: Point) -> str:
    return "-".join([what, *map(str, point.place)])


def _strength(point: Mapping[str, Any]) -> tuple[bool, str]:
    averaged = point["averaged_stress"] / 1e6
    words = f"{averaged:.1f} N/mm2 averaged, {point['wall_stress'] / 1e6:.1f} N/mm2 in the worst element"
    return 0.8 * 33 <= averaged <= 1.2 * 33, words


def _frame(point: Mapping[str, Any]) -> tuple[bool, str]:
    beam, column, beam_then, column_then = (
        point[name] / 1e6 for name in ("beam_stress", "column_stress", "beam_stress_then", "column_stress_then")
    )
    words = f"at the instant of the wall's peak {beam_then:.1f} and {column_then:.1f} N/mm2, "
    words += f"later up to {beam:.1f} and {column:.1f} N/mm2"
    return max(beam, column) < LOW * point["averaged_stress"] / 1e6, words


def _local(point: Mapping[str, Any]) -> tuple[bool, str]:
    return point["reach"] < 1.0, f"{point['reach']:.2f} m from the contact half of the averaged stress is left"


STATEMENTS: Sequence[Statement] = (
    ("Maximum stresses are about 33 N/mm2, of the order of the compressive strength.", _strength),
    ("The stresses in the beams and columns are quite low.", _frame),
    ("The phenomenon is a rather local one.", _local),
)

_REFINED = {
    "peak_force": ("the contact force", 1e-6, "MN"),
    "averaged_stress": ("the stress averaged over a length of the wall", 1e-6, "N/mm2"),
    "wall_stress": ("the stress of the worst element", 1e-6, "N/mm2"),
}


def mesh_convergence(results: Results) -> list[str]:
    """What settles as the mesh is refined, in sentences; none where the sweep has no meshes."""
    if len(results.axes.get("mesh.size", ())) < 2:
        return []
    sentences: dict[bool, list[str]] = {True: [], False: []}
    for name, (words, factor, unit) in _REFINED.items():
        for label, part in along(results, results.answer("wall").frame, "mesh.size"):
            run = part.sort_values("mesh.size", ascending=False)[name].to_numpy() * factor
            change = run[-1] / run[-2] - 1
            settles = abs(change) < SETTLED
            verb = "settles" if settles else "does not settle"
            sentences[settles].append(
                f"{words.capitalize()} {verb}{f' ({label})' if label else ''}: {', '.join(f'{v:.3g}' for v in run)} "
                f"{unit} from the coarsest to the finest mesh, {100 * change:+.0f} % at the last refinement."
            )
    return sentences[True] + sentences[False]


def write_fields(points: Sequence[Point], folder: Path) -> list[Path]:
    """Write the fields of points for ParaView, lengths in m, stresses in N/m2; returns the files."""
    import meshio

    def in_space(array: np.ndarray) -> np.ndarray:
        return np.column_stack([array, np.zeros(len(array))])

    files = []
    for point in points:
        values = point.values
        files.append(folder / "fields" / f"{_name('point', point)}.vtu")
        files[-1].parent.mkdir(parents=True, exist_ok=True)
        meshio.Mesh(
            in_space(values["points"]),
            [("quad", values["quads"].astype(int))],
            point_data={"displacement": in_space(values["displacement"])},
            cell_data={name: [values[name]] for name in ("stress_peak", "stress_envelope")},
        ).write(files[-1])
    return files


def cite_wall(resolved: Mapping[str, Any], used: Use) -> None:
    """The references of `pound wall`."""
    used("spiliopoulos1996", "the bumper wall, Fig. 8")
    used("anagnostopoulos1992", "bumper walls")
    used("gustafsson2020", "the plane-stress elements of the wall")
    used("wood1980", "the time integration")
