"""The look of every figure: one colour, line and marker a case, legible in grey; and the saving of figures."""

from __future__ import annotations

import base64
import io
import textwrap
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any, ParamSpec

from pounding_cli.study.display import key_words
from pounding_cli.texts import to_file_name, write_markdown

if TYPE_CHECKING:  # matplotlib is loaded when something is drawn
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FIGURE_FORMATS = ("png", "svg", "pdf")
"""Formats of figures."""
USUAL = ("png", "svg")
"""Formats in which a report saves its figures."""
OF_PAPERS = ("svg", "pdf")
"""Formats in which figures for a paper are saved."""

RC: Any = {
    "font.size": 9,
    "axes.facecolor": "none",  # pages show figures without the white behind them
    "axes.titlesize": 9.5,
    "axes.labelsize": 9.5,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "0.9",
    "grid.linewidth": 0.6,
    "legend.facecolor": "white",
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


_DASHED = (0, (5, 2))
_DASH_DOT = (0, (5, 1.5, 1, 1.5))
_DOTTED = (0, (1, 1.2))
_NAMED = {
    "touching": Look("#000000", "-", "o"),
    "gap": Look("#0072B2", _DASHED, "s"),
    "infill": Look("#E69F00", "-", "^"),
    "connected": Look("#AA2211", _DASH_DOT, "D"),
}
_REST = (
    Look("#009E73", _DOTTED, "v"),
    Look("#56B4E9", "-", "P"),
    Look("#7B3294", _DASHED, "X"),
    Look("#8C6D31", _DASH_DOT, "<"),
    Look("#666666", (0, (3, 1)), ">"),
    Look("#CC79A7", "-", "*"),
)


def looks(cases: Sequence[str]) -> dict[str, Look]:
    """Return a look for every case: the paper's four keep theirs, others take the rest in turn."""
    others = [case for case in cases if case not in _NAMED]
    given = {case: _REST[number % len(_REST)] for number, case in enumerate(others)}
    return {case: _NAMED.get(case) or given[case] for case in cases}


def to_page_look(look: Look) -> dict[str, str]:
    """Return a look as the script of a page draws it.

    A colour of the style sheet, dashes, and the marker one unit wide as a path of SVG, upwards.
    """
    from matplotlib.markers import MarkerStyle

    letters = {1: "M", 2: "L", 3: "Q", 4: "C", 79: "Z"}  # of the codes of a path
    number = [*_NAMED.values(), *_REST].index(look)
    dash = "" if look.line == "-" else " ".join(f"{1.6 * length:g}" for length in look.line[1])
    marker = MarkerStyle(look.marker)
    outline = marker.get_path().transformed(marker.get_transform()).iter_segments()
    parts = (letters[int(code)] + " ".join(f"{each:.3g}" for each in ends if code != 79) for ends, code in outline)
    return {"color": f"var(--case-{number})", "dash": dash, "marker": "".join(parts)}


_SETTINGS = RC | {"text.parse_math": False}  # a text of a study is no formula
_Drawing = ParamSpec("_Drawing")


def with_style(draw: Callable[_Drawing, Figure]) -> Callable[_Drawing, Figure]:
    """Decorate a function that draws: the settings hold while it draws and nowhere else.

    Logarithmic axes get plain numbers at 1, 2 and 5, those of many decades at 1, those of less than one in even steps.
    """

    @wraps(draw)
    def draw_with_style(*args: _Drawing.args, **named: _Drawing.kwargs) -> Figure:
        from matplotlib import rc_context
        from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter

        with rc_context(_SETTINGS):
            figure = draw(*args, **named)
            every_axis = [axis for ax in figure.axes for axis in (ax.xaxis, ax.yaxis)]
            for axis in every_axis:
                if axis.get_scale() != "log":
                    continue
                low, high = axis.get_view_interval()
                decades = LogLocator(subs=(1, 2, 5) if high < 300 * low else (1,))
                axis.set_major_locator(MaxNLocator(6) if high < 5 * low else decades)
                axis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
                axis.set_minor_formatter(NullFormatter())
        return figure

    return draw_with_style


def new_figure(width: float, height: float) -> Figure:
    """Return an empty figure [in] that lays itself out; it needs no window system."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def panels(rows: int, columns: int, width: float = 3.9, height: float = 3.2, **shared: Any) -> tuple[Figure, Any]:
    """Return a figure of rows x columns panels of so many inches, with room for a legend, and its axes."""
    figure = new_figure(width * columns + 1.7, height * rows + 0.8)
    return figure, figure.subplots(rows, columns, squeeze=False, **shared)


def grid(
    count: int, width: float = 3.9, height: float = 3.2, ylabel: str = "", **shared: Any
) -> tuple[Figure, list[Axes]]:
    """Return a figure of `count` panels, two or three in a line, the first of which has the label, and its axes."""
    columns = min(count, 2 if count in (2, 4) else 3)
    figure, axes = panels(-(-count // columns), columns, width, height, **shared)
    for ax in axes.flat[count:]:
        ax.remove()
    for ax in axes.flat[count - columns : count]:  # those with no panel beneath
        ax.tick_params(labelbottom=True)
    for ax in axes[:, 0]:
        ax.set_ylabel(ylabel)
    return figure, list(axes.flat[:count])


def case_handles(cases: Mapping[str, str]) -> list[Any]:
    """Return line and marker of every case for a legend.

    cases : the label of each
    """
    from matplotlib.lines import Line2D

    return [
        Line2D([], [], color=look.color, linestyle=look.line, marker=look.marker, ms=5, lw=1.6, label=cases[case])
        for case, look in looks(list(cases)).items()
    ]


def shared_legend(figure: Figure, axes: Iterable[Axes], where: Any = "outside right center", columns: int = 1) -> None:
    """Add one legend of all panels, each label once."""
    handles = {}
    for ax in axes:
        for handle, label in zip(*ax.get_legend_handles_labels(), strict=True):
            handles[label] = handle
    figure.legend(handles.values(), handles.keys(), loc=where, fontsize=8, ncols=columns)


IN_FILES = "file"
PAPER = "paper"
PAGE = "page"
"""Where a figure is drawn for: a file of its own, a paper, whose text has title and caption, or a page, which has them
too and draws the group once."""

_medium = ContextVar("medium", default=IN_FILES)


@contextmanager
def drawing_for(medium: str) -> Iterator[None]:
    """Draw the figures within for IN_FILES, PAPER or PAGE."""
    token = _medium.set(medium)
    try:
        yield
    finally:
        _medium.reset(token)


def is_for_paper() -> bool:
    """Return whether figures are drawn for a paper: `save` writes their captions beside them."""
    return _medium.get() == PAPER


def is_for_page() -> bool:
    """Return whether figures are drawn for a page, which has titles, captions and the group around them."""
    return _medium.get() == PAGE


def finish(figure: Figure, title: str, text: str = "") -> None:
    """Put the title above a figure and the caption below, wrapped to its width; only files of their own have them."""
    figure.set_label(text)
    if _medium.get() != IN_FILES:
        return
    wrapped_title = textwrap.fill(title, int(10 * figure.get_figwidth()))
    figure.suptitle(wrapped_title, x=0.015, ha="left", fontsize=11, fontweight="bold")
    lines = textwrap.wrap(text, int(17 * figure.get_figwidth()), break_on_hyphens=False)
    figure.supxlabel("\n".join(lines), x=0.015, ha="left", fontsize=7.5, color="0.25")


def save_figures(figures: Mapping[str, Figure], folder: Path, formats: Sequence[str]) -> list[Path]:
    """Write every figure in every format; return the files.

    Formats in which the folder has a figure already are written too, so that no file is of other results. Figures for a
    paper get their captions beside them.
    """
    files = []
    for name, figure in figures.items():
        for suffix in FIGURE_FORMATS:
            path = folder / f"{to_file_name(name)}.{suffix}"
            if suffix in formats or path.exists():
                files.append(path)
                path.write_bytes(drawn_as(figure, suffix))
    if figures and is_for_paper():
        captions = [f"**{name}**: {figure.get_label()}\n" for name, figure in figures.items()]
        files.append(write_markdown(folder / "captions.md", captions))
    return files


def data_address(figure: Figure, **named: Any) -> str:
    """Return a figure as SVG in a `data:` address, for a page.

    named : parameters of `savefig`
    """
    svg = drawn_as(figure, "svg", **named)
    return f"data:image/svg+xml;base64,{base64.b64encode(svg).decode('ascii')}"


def drawn_as(figure: Figure, suffix: str, **named: Any) -> bytes:
    """Return a figure in a format, laid out once; it has no date, so that one that did not change is the same file."""
    from matplotlib import rc_context
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    buffer = io.BytesIO()
    with rc_context(_SETTINGS):
        if isinstance(figure.get_layout_engine(), ConstrainedLayoutEngine):
            figure.draw_without_rendering()
            figure.set_layout_engine("none")
        dated = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}.get(suffix)
        figure.savefig(buffer, format=suffix, metadata=dated, **named)
    return buffer.getvalue()


def name_axis(
    ax: Axes, which: str, keys: Sequence[str], units: Sequence[Any], size: float = 9.5, room: int = 80
) -> None:
    """Write the meaning of keys along an axis ("x" or "y"), and the keys below; figures for a paper leave these out.

    size : of the words [pt]; room : characters in a line
    """
    lines = [", ".join(unit.label(key_words(key)) for key, unit in zip(keys, units, strict=True))]
    if not is_for_paper() and any(key_words(key) != key for key in keys):
        lines.append(", ".join(keys))
    label = "\n".join(textwrap.fill(line, room, break_long_words=False) for line in lines)
    ax.set(**{f"{which}label": label})
    getattr(ax, f"{which}axis").label.set_size(size)
