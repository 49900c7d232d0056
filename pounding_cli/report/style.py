"""How every figure looks: one colour, line and marker a case, legible in grey, and how figures are saved."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.lines import Line2D
from matplotlib.mathtext import MathTextParser
from matplotlib.text import Text
from matplotlib.textpath import text_to_path

from pounding_cli.errors import InputError, Problem
from pounding_cli.texts import file_name, write_markdown

FORMATS = ("png", "svg", "pdf")
"""What a figure can be saved as."""

RC: Any = {
    "font.size": 9,
    "axes.titlesize": 9.5,
    "axes.labelsize": 9.5,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "0.9",
    "grid.linewidth": 0.6,
    "legend.frameon": False,
    "hatch.linewidth": 0.6,
    "savefig.dpi": 180,
    "svg.fonttype": "none",
    "pdf.fonttype": 42,  # TrueType, which journals ask for
    "svg.hashsalt": "pound",  # the same figure gives the same file
}


@dataclass(frozen=True)
class Look:
    """Colour (Okabe and Ito's set, apart in grey too), line and marker of one case."""

    color: str
    line: Any
    marker: str


_NAMED = {
    "touching": Look("#000000", "-", "o"),
    "gap": Look("#0072B2", (0, (5, 2)), "s"),
    "infill": Look("#E69F00", "-", "^"),
    "connected": Look("#AA2211", (0, (5, 1.5, 1, 1.5)), "D"),
}
_REST = (
    Look("#009E73", (0, (1, 1.2)), "v"),
    Look("#56B4E9", "-", "P"),
    Look("#7B3294", (0, (5, 2)), "X"),
    Look("#8C6D31", (0, (5, 1.5, 1, 1.5)), "<"),
    Look("#666666", (0, (3, 1)), ">"),
    Look("#CC79A7", "-", "*"),
)


VOID = "0.6"
"""Grey of what is drawn though it means nothing."""


def looks(cases: Sequence[str]) -> dict[str, Look]:
    """A look for every case: the paper's four keep theirs, others take the rest in turn."""
    others = [case for case in cases if case not in _NAMED]
    given = {case: _REST[number % len(_REST)] for number, case in enumerate(others)}
    return {case: _NAMED.get(case) or given[case] for case in cases}


styled = mpl.rc_context(RC)
"""Decorator of every function that draws: the settings hold while it draws and nowhere else."""


_given: ContextVar[Figure | None] = ContextVar("given", default=None)


def new_figure(width: float, height: float) -> Figure:
    """An empty figure [in] that lays itself out; drawn without any window system unless within `drawn_on`."""
    given = _given.get()
    if given is None:
        return Figure(figsize=(width, height), layout="constrained")
    given.set_size_inches(width, height)
    given.set_layout_engine("constrained")
    return given


@contextmanager
def drawn_on(figure: Figure) -> Iterator[None]:
    """The next figure is drawn on this one: one of pyplot, which a notebook or a window shows.

    It is made before the settings of `styled` hold: pyplot starts its backend with the first figure, and what that sets
    would be undone with them.
    """
    token = _given.set(figure)
    try:
        yield
    finally:
        _given.reset(token)


def legend(ax: Axes, cases: Mapping[str, str], **keywords: Any) -> None:
    """A legend of cases alone, with their line and marker; `cases`: what each is called."""
    chosen = list(cases)
    handles = [
        Line2D([], [], color=look.color, linestyle=look.line, marker=look.marker, ms=5, lw=1.6, label=cases[case])
        for case, look in looks(chosen).items()
    ]
    ax.legend(handles=handles, handlelength=3.2, **keywords)


_captions: ContextVar[dict[Figure, str] | None] = ContextVar("captions", default=None)


@contextmanager
def for_paper() -> Iterator[dict[Figure, str]]:
    """Figures drawn within have no title and no caption; gives the captions, by figure."""
    captions: dict[Figure, str] = {}
    token = _captions.set(captions)
    try:
        yield captions
    finally:
        _captions.reset(token)


def is_for_paper() -> bool:
    """Whether figures are drawn without titles."""
    return _captions.get() is not None


def entitle(figure: Figure, title: str, weight: str = "normal") -> None:
    """The study's title at the head of a figure."""
    if not is_for_paper():
        figure.suptitle(title, x=0.015, ha="left", fontsize=11, fontweight=weight)


def shared_legend(figure: Figure, axes: Iterable[Axes], where: Any = "outside right upper", columns: int = 1) -> None:
    """One legend of all panels, each label once."""
    handles = {label: h for ax in axes for h, label in zip(*ax.get_legend_handles_labels(), strict=True)}
    figure.legend(handles.values(), handles.keys(), loc=where, fontsize=8, ncols=columns)


def caption(figure: Figure, text: str) -> None:
    """A caption under the figure, wrapped to its width."""
    if (captions := _captions.get()) is not None:
        captions[figure] = text
        return
    left, font = 0.015, FontProperties(size=7.5)
    room, characters = (1 - 2 * left) * 72 * figure.get_figwidth(), int(figure.get_figwidth() * 18.5)
    while True:
        lines = textwrap.wrap(text, characters, break_on_hyphens=False)
        widths = [text_to_path.get_text_width_height_descent(line, font, ismath=False)[0] for line in lines]
        if max(widths, default=0.0) <= room or characters < 20:
            break
        characters -= 1
    figure.supxlabel("\n".join(lines), x=left, ha="left", fontsize=7.5, color="0.25")


_FORMULAS = MathTextParser("path")


def literal(figure: Figure) -> None:
    """Show a text as it is where its dollar signs enclose what is not a formula."""
    for text in figure.findobj(Text):
        if isinstance(text, Text) and "$" in text.get_text() and text.get_parse_math():
            try:
                _FORMULAS.parse(text.get_text())
            except ValueError:
                text.set_parse_math(False)


def save(figures: Mapping[str, Figure], folder: Path, formats: Sequence[str] = FORMATS) -> list[Path]:
    """Write every figure in every format, of figures for a paper their captions too; returns the files. Raises
    InputError where the folder refuses."""
    files = []
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, figure in figures.items():
            literal(figure)
            with mpl.rc_context(RC):
                figure.draw_without_rendering()
            figure.set_layout_engine("none")  # laid out once, not once a format
            for suffix in formats:
                path = folder / f"{file_name(name)}.{suffix}"
                # Without a date in it, a figure that did not change is the same file.
                dated = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}.get(suffix)
                with mpl.rc_context(RC):
                    figure.savefig(path, metadata=dated)
                files.append(path)
        if figures and (captions := _captions.get()) is not None:
            said = {name: captions[figure] for name, figure in figures.items() if figure in captions}
            files.append(
                write_markdown(folder / "captions.md", [f"**{name}**: {text}\n" for name, text in said.items()])
            )
    except OSError as error:
        raise unwritable(folder, error) from error
    return files


def unwritable(folder: Path, error: OSError) -> InputError:
    """The refusal of a folder that cannot be written to."""
    hint = "name a folder you may write to: pound report FILE.h5 -o FOLDER"
    return InputError(Problem(f"cannot write the report to {folder}: {error.strerror or error}", hint))
