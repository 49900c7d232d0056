"""The two models of the paper that are not those of a study: the oscillators of Figs 4 and 5 and the wall of Fig. 8.

Nothing of the rest of the program needs this package, except the commands and `api/`.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pounding_cli.paper.points import PointCommand

TITLES = {
    "connector": "Solve two connected oscillators in closed form (Figs 4 and 5).",
    "wall": "Solve an impact on a bumper wall (Fig. 8).",
}
"""Every command that solves points by a model of its own: the name of its module here, its line in `pound --help`."""


def load_point_command(name: str) -> PointCommand:
    """Return a command of `TITLES`; its module is imported then."""
    command: PointCommand = importlib.import_module(f"pounding_cli.paper.{name}").COMMAND
    return command
