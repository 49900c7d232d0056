"""What a results file is, and what a stored solution depends on besides its scene: solver, method and its setting."""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from pounding_cli import __version__

if TYPE_CHECKING:
    from pounding_cli.study.plan import Plan

FORMAT = "pounding study results"
"""Attribute `format` of every results file."""

FORMAT_VERSION = 5
"""Raised whenever a reader of the former version would misread the file."""

_SOLVER_PACKAGES = ("laws", "model", "solver")


@cache
def solver_version() -> str:
    """Package version and a digest of the solver's own source.

    Between two releases the version stands still while the solver changes; results of the old one must not be
    taken for the new one's.
    """
    root = Path(__file__).parents[1]
    sha = hashlib.sha256()
    own = [path for package in _SOLVER_PACKAGES for path in sorted((root / package).glob("*.*"))]
    own.append(root / "results" / "solved.py")  # how responses are kept
    for path in own:
        sha.update(path.name.encode() + b"\0" + path.read_bytes())
    return f"{__version__}+{sha.hexdigest()[:12]}"


def solution_key(plan: Plan) -> str:
    """What two solutions of one scene share exactly when they are the same number for number."""
    asked = f"accuracy {plan.accuracy!r}" if plan.time_step is None else f"time step {plan.time_step!r}"
    return f"solver {solver_version()} | method {plan.method} | {asked} | estimate {plan.estimate}"
