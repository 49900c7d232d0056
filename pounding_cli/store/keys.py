"""What a stored solution depends on besides its scene: file format, solver, method and its setting."""

from __future__ import annotations

import hashlib
from functools import cache
from importlib import metadata
from pathlib import Path

from pounding_cli.laws import sources_elsewhere

FORMAT = "pounding study results"
"""Root attribute `format` of every results file."""

FORMAT_VERSION = 3
"""Raised whenever a reader of the former version would misread the file."""

_SOLVER_PACKAGES = ("kernels", "laws", "model", "solve")


@cache
def package_version() -> str:
    """Version of this package as installed."""
    return metadata.version("pounding-cli")


@cache
def solver_version(packages: tuple[str, ...] = _SOLVER_PACKAGES) -> str:
    """Package version and a digest of the solver's own source, laws of other packages included.

    Between two releases the version stands still while the solver changes; results of the old one must not be
    taken for the new one's.
    """
    root = Path(__file__).parents[1]
    sha = hashlib.sha256()
    own = (path for package in packages for path in sorted((root / package).glob("*.py")))
    for path in (*own, *sources_elsewhere()):
        sha.update(path.name.encode() + b"\0" + path.read_bytes())
    return f"{package_version()}+{sha.hexdigest()[:12]}"


def solution_key(
    accuracy: float, method: str, estimate: str = "none", all_effects: bool = False, time_step: float | None = None
) -> str:
    """The key two solutions of one scene share exactly when they are the same number for number."""
    solver = f"format {FORMAT_VERSION} | solver {solver_version()}"
    everything = " | all effects" if all_effects else ""
    asked = f"accuracy {accuracy!r}" if time_step is None else f"time step {time_step!r}"
    return f"{solver} | method {method} | {asked} | estimate {estimate}{everything}"
