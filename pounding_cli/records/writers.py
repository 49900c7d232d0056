"""The catalogue's own motion file: header lines `# key: value`, then one acceleration a line."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Mapping
from pathlib import Path

from pounding_cli.records.motion import GRAVITY, Motion


def motion_text(motion: Motion, about: Mapping[str, str], digits: int | None = None) -> str:
    """The file's text: `about` first, then name, unit, dt, samples and the values in g.

    With `digits` None the values are in m/s2 and in full, so that reading the file gives the very motion
    back, digest and all; otherwise they are in g with that many decimals.
    """
    lines = [f"# {key}: {value}" for key, value in about.items()]
    lines += [
        f"# name: {motion.name}",
        f"# unit: {'m/s2' if digits is None else 'g'}",
        f"# dt: {motion.dt!r} s",
        f"# samples: {motion.acceleration.size}",
    ]
    if digits is None:
        lines += [repr(float(value)) for value in motion.acceleration]
    else:
        lines += [f"{value:.{digits}f}" for value in motion.acceleration / GRAVITY]
    return "\n".join(lines) + "\n"


def write_text(path: Path, text: str) -> None:
    """Write atomically: the file appears whole or not at all.  Makes missing folders."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, draft = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
    try:
        with os.fdopen(handle, "w", encoding="utf-8") as stream:
            stream.write(text)
        mode = 0o666 & ~_umask()
        os.chmod(draft, mode)
        os.replace(draft, path)
    except BaseException:
        Path(draft).unlink(missing_ok=True)
        raise


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
