"""Compiled kernels as they are known without numba: where they are kept, which one a scene needs, how fast they are."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import sys
from collections.abc import Mapping
from importlib.util import find_spec
from pathlib import Path

SERIES_KERNEL = "the solver"
SMOOTH_KERNEL = "the solver for smooth laws"
FIXED_STEP_KERNEL = "the methods of fixed time steps"

COMPILE_TIME = {SERIES_KERNEL: 20.0, SMOOTH_KERNEL: 30.0, FIXED_STEP_KERNEL: 15.0}
"""Time in which a kernel is compiled, about [s]."""


IS_INTERPRETED = os.environ.get("NUMBA_DISABLE_JIT", "").strip() not in ("", "0")
"""Python runs the kernels itself, some thousand times as slowly: a debugger can stop in them."""


def _compute_digest() -> str:
    """Return the SHA-256 of the sources of solver and laws, and of the versions that compile them.

    Numba does not see that a function that a kernel calls changed.
    """
    package = Path(__file__).parent.parent
    sha = hashlib.sha256(f"python {sys.version_info[:2]}{' alone' * IS_INTERPRETED}".encode())
    numba = find_spec("numba")  # found, not imported
    if numba is not None and numba.origin is not None:
        for source in sorted(Path(numba.origin).parent.glob("_version.*")):
            sha.update(source.name.encode() + source.read_bytes())
    for folder in ("laws", "solver"):
        for source in sorted((package / folder).glob("*.*")):
            sha.update(source.name.encode() + source.read_bytes())
    return sha.hexdigest()[:16]


FOLDER = Path(os.environ.get("NUMBA_CACHE_DIR") or Path.home() / ".cache") / "pounding_cli" / _compute_digest()
"""Folder of the compiled kernels and of their rates."""


def find_kernel(takes_step: bool, has_smooth: bool) -> str:
    """Return the kernel that runs a scene.

    Parameters
    ----------
    takes_step : the method takes a time step
    has_smooth : a law of the scene, or the method, has no Taylor series
    """
    if takes_step:
        return FIXED_STEP_KERNEL
    return SMOOTH_KERNEL if has_smooth else SERIES_KERNEL


def is_compiled(kernel: str) -> bool:
    """Return whether a kernel is compiled and kept on this computer, or needs no compiling."""
    return IS_INTERPRETED or (_locate_mark(kernel).exists() and any(FOLDER.rglob("*.nbc")))


def mark_compiled(kernel: str) -> None:
    """Note that a kernel is compiled and kept."""
    with contextlib.suppress(OSError):
        FOLDER.mkdir(parents=True, exist_ok=True)
        _locate_mark(kernel).touch()


def _locate_mark(kernel: str) -> Path:
    """Return the file that says that a kernel is compiled."""
    return FOLDER / f"{kernel}.compiled"


def read_rates() -> dict[str, float]:
    """Return the time of a kernel for a unit of work, by kind of time history; empty before the first run."""
    try:
        rates = json.loads((FOLDER / "rates.json").read_text(encoding="utf-8"))
        return {str(kind): float(rate) for kind, rate in rates.items()}
    except (OSError, ValueError, TypeError, AttributeError):
        return {}


def store_rates(rates: Mapping[str, float]) -> None:
    """Keep rates for later runs; those of other kinds stay as they are."""
    with contextlib.suppress(OSError):
        FOLDER.mkdir(parents=True, exist_ok=True)
        hidden = FOLDER / f"rates.{os.getpid()}.part"
        hidden.write_text(json.dumps({**read_rates(), **rates}), encoding="utf-8")
        hidden.replace(FOLDER / "rates.json")
