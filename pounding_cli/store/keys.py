"""What a stored solution depends on besides its scene: file format, solver, method and accuracy."""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path

import pounding_cli

FORMAT = "pounding study results"
"""Root attribute `format` of every results file."""

FORMAT_VERSION = 1
"""Raised whenever a reader of the former version would misread the file."""

_SOLVER_ROOMS = ("kernels", "model", "solve")


@cache
def solver_version() -> str:
    """Package version and a digest of the solver's own source.

    Between two releases the version stands still while the solver changes; results of the old one must not be
    taken for the new one's.
    """
    root = Path(pounding_cli.__file__).parent
    sha = hashlib.sha256()
    for room in _SOLVER_ROOMS:
        for path in sorted((root / room).glob("*.py")):
            sha.update(path.name.encode() + b"\0" + path.read_bytes())
    return f"{pounding_cli.__version__}+{sha.hexdigest()[:12]}"


def solution_key(accuracy: float, method: str) -> str:
    """The key two solutions of one scene share exactly when they are the same number for number."""
    return f"format {FORMAT_VERSION} | solver {solver_version()} | method {method} | accuracy {accuracy!r}"
