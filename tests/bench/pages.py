"""Blocks of pages that `make bench` writes: where they stand, and the words for numbers and the machine in them."""

from __future__ import annotations

import datetime
import os
import platform
import subprocess
import sys
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path

ROOT = Path(__file__).parents[2]
FIGURES = ROOT / "docs" / "figures"
POUND = [sys.executable, "-c", "from pounding_cli.cli.main import main; main()"]
"""The command, by the Python that runs this."""

BEGIN = "<!-- begin (make bench) -->"
END = "<!-- end -->"


def write_block(page: Path, text: str, begin: str = BEGIN, end: str = END) -> None:
    """Replace what stands between the marks of a page.  Raises `ValueError` for a page without them."""
    before, first, rest = page.read_text(encoding="utf-8").partition(begin)
    _, last, after = rest.partition(end)
    if not first or not last:
        raise ValueError(f"{page} lacks the marks {begin} and {end}")
    page.write_text(f"{before}{begin}\n{text}\n{end}{after}", encoding="utf-8")


def format_machine(load: float) -> str:
    """Return day, commit, processor, load before the measurement and versions as the end of a sentence."""
    commit = subprocess.run(
        ["git", "-C", str(ROOT), "rev-parse", "--short", "HEAD"], capture_output=True, text=True
    ).stdout.strip()
    day = datetime.datetime.now(datetime.UTC).strftime("%Y-%m-%d")
    packages = ", ".join(f"{name} {version(name)}" for name in ("numpy", "numba"))
    return (
        f"on {day}, commit {commit or 'unknown'}, {find_processor()}, {os.cpu_count()} cores, load before {load:.1f}, "
        f"Python {platform.python_version()}, {packages}"
    )


def find_processor() -> str:
    """Return the processor's name, or its architecture where the system does not tell."""
    info = Path("/proc/cpuinfo")
    lines = info.read_text().splitlines() if info.exists() else []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()


def format_time(seconds: float) -> str:
    """Return a time [s] with three digits and a fitting unit."""
    for unit, size in (("s", 1.0), ("ms", 1e-3)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds * 1e6:.3g} µs"


def format_error(error: float) -> str:
    """Return a relative error [-] with two digits: "9.3e-4"."""
    mantissa, exponent = f"{error:.1e}".split("e")
    return f"{mantissa}e{int(exponent)}"


def table(head: str, rows: Sequence[Sequence[str]]) -> str:
    """Return a Markdown table; `head` has its columns between `|`."""
    lines = [f"| {head} |", "|" + "---|" * (head.count("|") + 1)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])
