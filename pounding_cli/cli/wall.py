"""`pound wall`: the bumper wall of Fig. 8."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pounding_cli.cli.answering import answer_command, tell_points

if TYPE_CHECKING:
    from pounding_cli.batch import Outcome


@answer_command("wall")
def command(path: Path, outcome: Outcome) -> None:
    """Compute the impact of a floor on the bumper wall of a concrete building: force, separation, stresses.

    The command prints peak force and stresses, and writes FILE.h5. `pound report` draws the figures and writes the
    fields for ParaView.
    After Ctrl-C, a crash or a full disk, run the same command again to resume.

    \b
    Example:
      pound wall configs/fig8.yaml -o results/fig8.h5
      pound report results/fig8.h5
    """
    tell_points(path, outcome, _lines)


def _lines(point: dict[str, Any]) -> list[str]:
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
