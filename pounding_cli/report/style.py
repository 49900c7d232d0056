"""How every figure looks: one colour, line and marker a case, legible in grey, and how figures are saved."""

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

FORMATS, USUAL, OF_PAPERS = ("png", "svg", "pdf"), ("png", "svg"), ("svg", "pdf")
"""What a figure can be saved as; as what reports save it; as what figures for a paper are saved."""

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


_DASHED, _DASH_DOT, _DOTTED = (0, (5, 2)), (0, (5, 1.5, 1, 1.5)), (0, (1, 1.2))
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
    """A look for every case: the paper's four keep theirs, others take the rest in turn."""
    others = [case for case in cases if case not in _NAMED]
    given = {case: _REST[number % len(_REST)] for number, case in enumerate(others)}
    return {case: _NAMED.get(case) or given[case] for case in cases}


def for_page(look: Look) -> dict[str, str]:
    """A look as the script of a page draws it: a colour of the style sheet, dashes, and the marker one unit
    wide as a path of SVG, upwards."""
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


def styled(draw: Callable[_Drawing, Figure]) -> Callable[_Drawing, Figure]:
    """Decorator of every function that draws: the settings hold while it draws and nowhere else; logarithmic axes get
    plain numbers at 1, 2 and 5, those of many decades at 1, those of less than one in even steps."""

    @wraps(draw)
    def drawn(*args: _Drawing.args, **named: _Drawing.kwargs) -> Figure:
        from matplotlib import rc_context
        from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter

        with rc_context(_SETTINGS):
            figure = draw(*args, **named)
            for axis in (axis for ax in figure.axes for axis in (ax.xaxis, ax.yaxis) if axis.get_scale() == "log"):
                low, high = axis.get_view_interval()
                decades = LogLocator(subs=(1, 2, 5) if high < 300 * low else (1,))
                axis.set_major_locator(MaxNLocator(6) if high < 5 * low else decades)
                axis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
                axis.set_minor_formatter(NullFormatter())
        return figure

    return drawn


def new_figure(width: float, height: float) -> Figure:
    """An empty figure [in] that lays itself out; drawn without any window system."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def panels(rows: int, columns: int, width: float = 3.9, height: float = 3.2, **shared: Any) -> tuple[Figure, Any]:
    """A figure of rows x columns panels of so many inches, with room for a legend, and its axes."""
    figure = new_figure(width * columns + 1.7, height * rows + 0.8)
    return figure, figure.subplots(rows, columns, squeeze=False, **shared)


def grid(
    count: int, width: float = 3.9, height: float = 3.2, ylabel: str = "", **shared: Any
) -> tuple[Figure, list[Axes]]:
    """The same of `count` panels one after the other, two or three in a line, the first of which has the label."""
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
    """Line and marker of every case for a legend; `cases`: what each is called."""
    from matplotlib.lines import Line2D

    return [
        Line2D([], [], color=look.color, linestyle=look.line, marker=look.marker, ms=5, lw=1.6, label=cases[case])
        for case, look in looks(list(cases)).items()
    ]


def shared_legend(figure: Figure, axes: Iterable[Axes], where: Any = "outside right center", columns: int = 1) -> None:
    """One legend of all panels, each label once."""
    handles = {label: h for ax in axes for h, label in zip(*ax.get_legend_handles_labels(), strict=True)}
    figure.legend(handles.values(), handles.keys(), loc=where, fontsize=8, ncols=columns)


_paper = ContextVar("paper", default=False)


@contextmanager
def for_paper() -> Iterator[None]:
    """Figures drawn within have no title and no caption; `save` writes the captions beside them."""
    token = _paper.set(True)
    try:
        yield
    finally:
        _paper.reset(token)


def is_for_paper() -> bool:
    """Whether figures are drawn without titles."""
    return _paper.get()


def finish(figure: Figure, title: str, text: str = "") -> None:
    """Title above a figure and caption below, wrapped to its width; for a paper `save` writes captions."""
    figure.set_label(text)
    if not is_for_paper():
        figure.suptitle(
            textwrap.fill(title, int(10 * figure.get_figwidth())), x=0.015, ha="left", fontsize=11, fontweight="bold"
        )
        lines = textwrap.wrap(text, int(17 * figure.get_figwidth()), break_on_hyphens=False)
        figure.supxlabel("\n".join(lines), x=0.015, ha="left", fontsize=7.5, color="0.25")


def save(figures: Mapping[str, Figure], folder: Path, formats: Sequence[str]) -> list[Path]:
    """Write every figure in every format, and in those in which the folder has it already, so that none is of other
    results; of figures for a paper their captions too; returns the files."""
    files = []
    for name, figure in figures.items():
        there = {suffix: folder / f"{to_file_name(name)}.{suffix}" for suffix in FORMATS}
        for suffix, path in there.items():
            if suffix in formats or path.exists():
                files.append(path)
                path.write_bytes(drawn_as(figure, suffix))
    if figures and is_for_paper():
        said = [f"**{name}**: {figure.get_label()}\n" for name, figure in figures.items()]
        files.append(write_markdown(folder / "captions.md", said))
    return files


def data_address(figure: Figure, **named: Any) -> str:
    """A figure as SVG in a `data:` address, for a page; `named` : as `savefig` takes them."""
    drawn = base64.b64encode(drawn_as(figure, "svg", **named)).decode("ascii")
    return f"data:image/svg+xml;base64,{drawn}"


def drawn_as(figure: Figure, suffix: str, **named: Any) -> bytes:
    """A figure in a format: without a date in it, so that one that did not change is the same file; laid out once."""
    from matplotlib import rc_context
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    held = io.BytesIO()
    with rc_context(_SETTINGS):
        if isinstance(figure.get_layout_engine(), ConstrainedLayoutEngine):
            figure.draw_without_rendering()
            figure.set_layout_engine("none")
        dated = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}.get(suffix)
        figure.savefig(held, format=suffix, metadata=dated, **named)
    return held.getvalue()


def name_axis(
    ax: Axes, which: str, keys: Sequence[str], units: Sequence[Any], size: float = 9.5, room: int = 80
) -> None:
    """Entitle an axis ("x" or "y") with what keys are, and below with the keys; figures for a paper leave these out.

    size : of the words [pt]; room : characters in a line
    """
    lines = [", ".join(unit.label(key_words(key)) for key, unit in zip(keys, units, strict=True))]
    if not is_for_paper() and any(key_words(key) != key for key in keys):
        lines.append(", ".join(keys))
    label = "\n".join(textwrap.fill(line, room, break_long_words=False) for line in lines)
    ax.set(**{f"{which}label": label})
    getattr(ax, f"{which}axis").label.set_size(size)
