"""What a stored solution depends on besides its scene: file format, solver, method and its setting."""

from __future__ import annotations

import hashlib
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pounding_cli.study import Plan

FORMAT = "pounding study results"
"""Root attribute `format` of every results file."""

FORMAT_VERSION = 3
"""Raised whenever a reader of the former version would misread the file."""

_SOLVER_PACKAGES = ("laws", "model", "solver")


@cache
def package_version() -> str:
    """Version of this package as installed."""
    return metadata.version("pounding-cli")


@cache
def solver_version() -> str:
    """Package version and a digest of the solver's own source.

    Between two releases the version stands still while the solver changes; results of the old one must not be
    taken for the new one's.
    """
    root = Path(__file__).parents[1]
    sha = hashlib.sha256()
    own = (path for package in _SOLVER_PACKAGES for path in sorted((root / package).glob("*.py")))
    for path in own:
        sha.update(path.name.encode() + b"\0" + path.read_bytes())
    return f"{package_version()}+{sha.hexdigest()[:12]}"


def key_of(plan: Plan) -> str:
    """The `solution_key` of the scenes of a plan."""
    return solution_key(plan.accuracy, plan.method, plan.estimate, plan.all_effects, plan.time_step)


def solution_key(
    accuracy: float, method: str, estimate: str = "none", all_effects: bool = False, time_step: float | None = None
) -> str:
    """The key two solutions of one scene share exactly when they are the same number for number."""
    solver = f"format {FORMAT_VERSION} | solver {solver_version()}"
    everything = " | all effects" if all_effects else ""
    asked = f"accuracy {accuracy!r}" if time_step is None else f"time step {time_step!r}"
    return f"{solver} | method {method} | {asked} | estimate {estimate}{everything}"
