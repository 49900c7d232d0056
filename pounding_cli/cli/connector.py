"""`pound connector`: Figs 4 and 5 in closed form."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from pounding_cli.cli.answering import answer_command, tell_points

if TYPE_CHECKING:
    from pounding_cli.batch import Outcome


@answer_command("connector")
def command(path: Path, outcome: Outcome) -> None:
    """Compute how a spring (and dashpot) between two oscillators changes their largest displacements.

    The command prints the peak ratios with their frequencies, and writes FILE.h5. `pound report` draws the figure.

    \b
    Example:
      pound connector configs/fig5.yaml -o results/fig5.h5
      pound report results/fig5.h5
    """
    tell_points(path, outcome, _lines)


def _lines(point: dict[str, Any]) -> list[str]:
    bands = ", ".join(f"{low:.3f}-{high:.3f}" for low, high in point["both_above"])
    return [
        f"|R1| at most {point['peak1']:.3f} at Omega/omega10 = {point['at1']:.3f}",
        f"|R2| at most {point['peak2']:.3f} at Omega/omega10 = {point['at2']:.3f}",
        f"coupled frequencies over omega10: {point['frequency_low']:.4f}, {point['frequency_high']:.4f} "
        f"(alone: 1, {point['p']:.4f})",
        f"both ratios exceed 1 in: {bands or 'nowhere'}",
    ]
