"""What `pound accuracy` left beside a results file: its answer in words and its diagrams."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from pounding_cli.report.web.pictures import Picture, from_files


@dataclass(frozen=True)
class Accuracy:
    """The answer of `pound accuracy`; empty where it was not asked, `command`: how to ask."""

    words: tuple[str, ...]
    pictures: tuple[Picture, ...]
    command: str


def accuracy_beside(path: Path | None, title: str, study: str = "") -> Accuracy:
    """Look for `<results>-accuracy/accuracy.md` beside a results file; an answer to another study does not count.

    study : the name of the study's file; that of the results file with another suffix unless given
    """
    stem = path.stem if path is not None else "STUDY"
    folder = path.parent / f"{stem}-accuracy" if path is not None else Path()
    command = (
        f"pound accuracy {study or f'{stem}.yaml'} -o {folder}" if path is not None else "pound accuracy STUDY.yaml"
    )
    answer = folder / "accuracy.md"
    if path is None or not answer.is_file():
        return Accuracy((), (), command)
    lines = answer.read_text(encoding="utf-8").splitlines()
    if not lines or lines[0] != f"# What accuracy costs: {title}":
        return Accuracy((), (), command)
    head = lines[1 : next((n for n, line in enumerate(lines) if line.startswith("![")), len(lines))]
    words = tuple(line.removeprefix("- ") for line in head if line.strip())
    files = sorted(folder.glob("accuracy-*.png"))
    said = {}
    for file in files:
        analysis = file.stem.removeprefix("accuracy-")
        text = f"Error against time of every method, {analysis} analyses: rows are quantities, columns cases. "
        said[file.stem] = (f"Error against time, {analysis}", text + "The sentences above name the cheapest method.")
    return Accuracy(words, tuple(from_files(files, said, "Error against time")), command)
