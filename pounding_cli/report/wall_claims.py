"""What the paper says of Fig. 8 beside what was found."""

from __future__ import annotations

from itertools import product
from pathlib import Path
from typing import Any

from pounding_cli.report.connector_figures import point_label
from pounding_cli.store.files import opened_kind
from pounding_cli.store.swept import axes_of

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
