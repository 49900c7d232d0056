"""Results files changed by someone who knows how they are written, for tests of what lies behind the checksums."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import h5py

from pounding_cli.store.seal import Sealed, seal


@contextmanager
def edited(path: Path) -> Iterator[h5py.File]:
    """A results file open for changes, and sealed again."""
    with Sealed(path) as sealed:
        size = sealed.size
    os.truncate(path, size)
    try:
        with h5py.File(path, "r+", libver=("v110", "latest")) as file:
            yield file
    finally:
        handle = os.open(path, os.O_RDWR)
        seal(handle)
        os.close(handle)
