"""What a workflow says and draws: the head of its report, in place of the ratios to the building alone."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from pounding_cli.report.evidence import Evidence, Tables
from pounding_cli.workflows import WORKFLOWS

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from pounding_cli.report.web.story import Grid


@dataclass(frozen=True)
class Illustration:
    """A figure, its heading, and what it shows in words for readers who do not see it."""

    figure: Figure
    heading: str
    text: str


@dataclass(frozen=True)
class AnswerPage:
    """The answer of a workflow.

    heading : what was asked, as the title of its section
    lead : the answer in sentences
    figures : by file name, the one that answers at a glance first; none where none are wanted
    tables : caption and rows
    notes : what a reader should know of the numbers, one sentence each
    beside : (folder) -> files that it writes there for other programs
    """

    heading: str
    lead: Sequence[str]
    figures: Mapping[str, Illustration]
    tables: Sequence[tuple[str, Grid]]
    notes: Sequence[str] = ()
    beside: Callable[[Path], list[Path]] | None = None

    @property
    def words(self) -> dict[str, tuple[str, str]]:
        """Heading and text of every figure."""
        return {name: (each.heading, each.text) for name, each in self.figures.items()}


def answer_page(results: Tables, shown: Evidence, with_figures: bool = True) -> AnswerPage | None:
    """What the workflow of a results file says; None where it says nothing of its own.

    shown : the point of the sweep that figures and sentences are of
    """
    page = WORKFLOWS[results.workflow].part("page")
    return None if page is None else page(results, shown, with_figures)
