"""A report: sections of sentences, tables and figures; the terminal, the page and a notebook show the same one."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pounding_cli.errors import InputError, Issue
from pounding_cli.outputs import check_folder
from pounding_cli.report.summary import Summary
from pounding_cli.tables import Table

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Picture:
    """A figure that is drawn when it is needed.

    name : of its files
    heading : above it on the page
    text : description for readers who do not see it
    draw : () -> the figure
    has_scale : True if its colours stand for numbers, so that a dark page leaves them as they are
    """

    name: str
    heading: str
    text: str
    draw: Callable[[], Figure]
    has_scale: bool = False


@dataclass(frozen=True)
class Section:
    """One part of a report.

    title : its heading; "" of the first, which answers the question
    sentences : one paragraph each
    notes : remarks on the numbers
    folded : True if its tables are closed on the page until they are opened
    widget : a further part of the page: "explorer", "player", "study", or "" for nothing
    data : numbers and names for the script of that widget
    """

    title: str
    sentences: Sequence[str] = ()
    tables: Sequence[Table] = ()
    pictures: Sequence[Picture] = ()
    notes: Sequence[str] = ()
    folded: bool = False
    widget: str = ""
    data: Mapping[str, Any] | None = None

    @property
    def key(self) -> str:
        """The address of the section on the page."""
        return "-".join(self.title.lower().replace("’", "").split()) or "answer"


@dataclass(frozen=True)
class Report:
    """The report of a results file.

    title : of the study
    answer : the first section, which is all that a terminal prints; its figures are `figures`
    figures : () -> the figures of the answer, the most important first
    more : () -> the other sections
    lead : the scope of the computation, in one line
    sketch : () -> the drawing of the group
    study : text of the study file
    """

    title: str
    answer: Section
    figures: Callable[[], Sequence[Picture]] = list
    more: Callable[[], Sequence[Section]] = list
    lead: str = ""
    sketch: Callable[[], Figure] | None = None
    study: str = ""

    @cached_property
    def sections(self) -> list[Section]:
        """All sections, the answer with its figures first."""
        return [replace(self.answer, pictures=self.figures()), *self.more()]

    @property
    def summary(self) -> Summary:
        """Title and answer, as a terminal prints them; nothing is drawn for it."""
        tables = tuple(table.to_text_table() for table in self.answer.tables)
        return Summary(self.title, tuple(self.answer.sentences), tables, tuple(self.answer.notes))

    def print(self) -> None:
        """Print title and answer."""
        self.summary.print()

    def save(self, folder: Path, formats: Sequence[str] | None = None, page: bool = True) -> list[Path]:
        """Write figures, tables as CSV and the page into a folder; return the files, the page last.

        Parameters
        ----------
        formats : of the figures, PNG and SVG unless given; an empty one leaves them out
        page : False leaves the page out

        Raises
        ------
        InputError : the folder cannot be written to
        """
        from pounding_cli.report.page import write_page
        from pounding_cli.report.style import USUAL, save_figures

        formats = USUAL if formats is None else formats
        tables = [table for section in self.sections for table in section.tables if table.name]
        pictures = [picture for section in self.sections for picture in section.pictures]
        check_folder(folder)  # a folder that cannot be written to is refused before anything is drawn
        figures = {picture.name: picture.draw() for picture in pictures} if formats else {}
        try:
            (folder / "tables").mkdir(parents=True, exist_ok=True)
            files = save_figures(figures, folder, formats)
            files += [table.to_csv(folder / "tables") for table in tables]
            if page:
                files.append(write_page(self, folder / "report.html", has_figures=bool(formats)))
            return files
        except OSError as error:
            hint = "name a folder you may write to: pound report FILE.h5 -o FOLDER"
            problem = Issue((), f"cannot write the report to {folder}: {error.strerror or error}", hint)
            raise InputError(problem) from error

    def _repr_html_(self) -> str:
        """Return the report as a notebook shows it."""
        from pounding_cli.report.page import to_notebook_html

        return to_notebook_html(self)
