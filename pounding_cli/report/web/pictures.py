"""Figures inside the page: as data addresses, each with a text that says what it shows."""

from __future__ import annotations

import base64
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import matplotlib as mpl
from matplotlib.figure import Figure

from pounding_cli.report.claims import RESPONSES
from pounding_cli.report.columns import shown
from pounding_cli.report.evidence import Evidence
from pounding_cli.report.style import RC, literal

MOST_FIGURES = 60
"""Figures the page carries; those of further buildings stand beside it."""


SPECTRUM = "target-spectrum"
"""The figure that stands with the motions."""


@dataclass(frozen=True)
class Picture:
    """A figure: its name, a heading, the image as a data address, its text, its size in CSS pixels."""

    name: str
    heading: str
    source: str
    text: str
    width: int
    height: int


def pictures(
    figures: Mapping[str, Figure], evidence: Evidence | None, words: Mapping[str, tuple[str, str]]
) -> list[Picture]:
    """The drawn figures as SVG; at most MOST_FIGURES. `words` : heading and text of those that have their own, all of
    them without `evidence`."""
    found = []
    for name, figure in list(figures.items())[:MOST_FIGURES]:
        held = io.BytesIO()
        literal(figure)
        with mpl.rc_context(RC):
            figure.savefig(held, format="svg", metadata={"Date": None})
        width, height = (round(96 * inches) for inches in figure.get_size_inches())
        heading, text = words[name] if evidence is None or name in words else _words(name, evidence)
        found.append(Picture(name, heading, address("svg+xml", held.getvalue()), text, width, height))
    return found


def from_files(files: Sequence[Path], words: Mapping[str, tuple[str, str]], title: str) -> list[Picture]:
    """PNG figures that were written to files; `words`: heading and text by stem, else both are `title`."""
    found = []
    for file in files:
        data = file.read_bytes()
        width, height = (int.from_bytes(data[start : start + 4], "big") for start in (16, 20))  # the PNG header
        heading, text = words.get(file.stem, (title, title))
        found.append(Picture(file.stem, heading, address("png", data), text, width // 2, height // 2))
    return found


def address(kind: str, data: bytes) -> str:
    """A `data:` address of an image."""
    return f"data:image/{kind};base64,{base64.b64encode(data).decode('ascii')}"


def _words(name: str, evidence: Evidence) -> tuple[str, str]:
    """Heading and text of a figure by its file name."""
    building, _, what = name.rpartition("-")
    if name == SPECTRUM:
        return "Target spectrum", "The target, the mean of the spectra of the motions as used, and each of them."
    if name == "link-forces":
        return "Forces between neighbours", f"Largest force in every link, floor by floor. {_forces(evidence)}"
    if what == "accelerations":
        said = "Largest floor accelerations over those of the building alone, and over touching, floor by floor"
        return f"{building}: floor accelerations", f"{said}. {_largest(evidence, building, accelerations=True)}"
    if what == "cases":
        said = "One panel per case with every motion and their mean, storey by storey"
        return f"{building}: every case and motion", f"{said}. {_largest(evidence, building)}"
    if what in ("sweep", "map"):
        of = building.replace("-", ", ")
        said = "one line per case" if what == "sweep" else "as maps over two swept keys, one per case"
        return f"{of}: over the sweep", f"Means over the motions at their largest place, {said}."
    said = "Ratios to the building alone, storey by storey, one line per case"
    return f"{building}: storey shears and ductilities", f"{said}. {_largest(evidence, building)}"


def _largest(evidence: Evidence, building: str, accelerations: bool = False) -> str:
    """The largest means of a building in words, analysis by analysis."""
    panels = (
        [("acceleration_ratio", analysis) for analysis in evidence.analyses]
        if accelerations
        else [(ratio, analysis) for ratio, analysis, _ in RESPONSES if analysis in evidence.analyses]
    )
    level = "floor" if accelerations else "storey"
    said = []
    for ratio, analysis in panels:
        parts = []
        for case in evidence.cases:
            means = evidence.means(case, analysis, building, ratio)
            if len(means):
                parts.append(f"{case} {means.max():.2f} ({level} {means.idxmax()})")
        if parts:
            said.append(f"Largest mean {shown(ratio).label}, {analysis}: {', '.join(parts)}.")
    return " ".join(said)


def _forces(evidence: Evidence) -> str:
    forces = evidence.link.groupby("case", sort=False)["peak_force"].max().dropna() / 1e6
    return "Largest: " + ", ".join(f"{case} {force:.2f} MN" for case, force in forces.items()) + "."
