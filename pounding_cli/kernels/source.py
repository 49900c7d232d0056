"""A digest of the kernels' own source: numba's disk cache watches one file a kernel, and ours are made of several."""

from __future__ import annotations

import functools
import hashlib
from pathlib import Path

from pounding_cli.kernels.pipelines import QUICK


@functools.cache
def source_digest() -> str:
    """SHA-256 over every file of this room, and over the name of the pipeline, so that each has kernels of its own."""
    sha = hashlib.sha256(b"quick" if QUICK else b"plain")
    kernels = Path(__file__).parent
    for path in sorted(kernels.glob("*.py")):
        sha.update(path.read_bytes())
    return sha.hexdigest()
