"""What the paper says of Fig. 8 beside what was found."""

from __future__ import annotations

from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from pounding_cli.report.connector_figures import point_label
from pounding_cli.store.files import opened_kind
from pounding_cli.store.swept import axes_of, coordinate

LOW = 0.5
"""A stress is called low, or lower, below this share of the wall's averaged peak."""


def wall_claims(path: Path) -> list[dict[str, Any]]:
    """The paper's sentences on Fig. 8, judged at every point of the sweep.

    Each entry has `point`, `paper` (the sentence), `found` (words with numbers) and `holds` (bool).
    Stresses in N/mm2; the averaged stress is the one that settles as the mesh is refined.
    """
    entries = []
    with opened_kind(path, "wall") as file:
        axes = axes_of(file, "peak_force")
        for point in product(*(range(n) for n in file["peak_force"].shape)):
            label = point_label(file, axes, point) if axes else ""

            def number(name: str, point: tuple[int, ...] = point) -> float:
                return float(file[name][point])

            element, averaged = number("wall_stress") / 1e6, number("averaged_stress") / 1e6
            entries.append(
                {
                    "point": label,
                    "paper": "Maximum stresses are about 33 N/mm2, of the order of the compressive strength.",
                    "found": f"{averaged:.1f} N/mm2 averaged, {element:.1f} N/mm2 in the worst element",
                    "holds": 0.8 * 33 <= averaged <= 1.2 * 33,
                }
            )
            beam, column = number("beam_stress") / 1e6, number("column_stress") / 1e6
            then = number("beam_stress_then") / 1e6, number("column_stress_then") / 1e6
            entries.append(
                {
                    "point": label,
                    "paper": "The stresses in the beams and columns are quite low.",
                    "found": f"at the instant of the wall's peak {then[0]:.1f} and {then[1]:.1f} N/mm2, "
                    f"later up to {beam:.1f} and {column:.1f} N/mm2",
                    "holds": max(beam, column) < LOW * averaged,
                }
            )
            entries.append(
                {
                    "point": label,
                    "paper": "The phenomenon is a rather local one.",
                    "found": f"{number('reach'):.2f} m from the contact half of the averaged stress is left",
                    "holds": number("reach") < 1.0,
                }
            )
    return entries


SETTLED = 0.1
"""A number settles where the last refinement of the mesh changes it by less than this share."""
_REFINED = {
    "peak_force": ("the contact force", 1e-6, "MN"),
    "averaged_stress": ("the stress averaged over a length of the wall", 1e-6, "N/mm2"),
    "wall_stress": ("the stress of the worst element", 1e-6, "N/mm2"),
}


def mesh_convergence(path: Path) -> list[str]:
    """What settles as the mesh is refined, in sentences; none where the sweep has no meshes."""
    with opened_kind(path, "wall") as file:
        axes = axes_of(file, "peak_force")
        if "mesh.size" not in axes or file["peak_force"].shape[axes.index("mesh.size")] < 2:
            return []
        place = axes.index("mesh.size")
        order = np.argsort(-np.asarray(coordinate(file, "mesh.size"), float))  # coarse to fine
        sentences = {True: [], False: []}  # type: dict[bool, list[str]]
        others = [axis for axis in axes if axis != "mesh.size"]
        for name, (words, factor, unit) in _REFINED.items():
            values = np.moveaxis(file[name][:], place, -1)[..., order] * factor
            for point in product(*(range(n) for n in values.shape[:-1])):
                run = values[point]
                change = run[-1] / run[-2] - 1
                where = f" ({point_label(file, tuple(others), point)})" if others else ""
                numbers = ", ".join(f"{value:.3g}" for value in run)
                settles = abs(change) < SETTLED
                verb = "settles" if settles else "does not settle"
                sentences[settles].append(
                    f"{words.capitalize()} {verb}{where}: {numbers} {unit} from the coarsest to the finest mesh, "
                    f"{100 * change:+.0f} % at the last refinement."
                )
        return sentences[True] + sentences[False]
