"""The report of `pound optimise`: the optimum, the number sought along every key, its map over the two that matter."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.tri import Triangulation

from pounding_cli.numbers import Unit, counted
from pounding_cli.report.background import background, frame_of
from pounding_cli.report.document import Picture, Report, Section
from pounding_cli.report.evidence import Evidence, axis_keys, motion_sentence, nominal
from pounding_cli.report.references import Use
from pounding_cli.report.style import caption, entitle, name_axis, new_figure, styled
from pounding_cli.report.sweep import COLOURS
from pounding_cli.report.table import NOTHING, from_rows
from pounding_cli.results.tables import Table
from pounding_cli.workflows.optimise import DESIGN, OPTIMUM, POINTS, UNSETTLED
from pounding_cli.workflows.optimise import NOTHING as NO_OPTIMUM

if TYPE_CHECKING:
    from pounding_cli.results.results import Results

MOST_KEYS = 8
"""Keys that are drawn."""
_AT_END = 1e-6
"""Of a range: nearer to its end than that, the optimum lies at it [-]."""

_LINE, _BEST, _WRITTEN, _FLAT = "#0072B2", "#AA2211", "#E69F00", "0.9"


def optimise_report(results: Results) -> Report:
    """What the search for an optimum says."""
    whole, results = results, results.first_sample()
    found, shown = optimum_of(results), nominal(results)
    said, tables, pictures = sentences(found), list[Table](), list[Picture]()
    if found.is_found:
        tables = [_optimum(found), _design(found)]
        text = f"{said[0]} Along each key through the optimum, and every point that was tried."
        draw = partial(draw_optimum, found, shown)
        pictures = [Picture("optimise", "The optimum and its surroundings", text, draw, has_scale=True)]
    scene = whole.scene()
    return Report(
        **frame_of(results, shown, scene, len(scene[axis_keys(scene)].drop_duplicates())),
        answer=Section("", said, tables, pictures, notes(found)),
        more=lambda: background(whole, shown, scene, ("records",)),
    )


@styled
def draw_optimum(found: Optimum, shown: Evidence) -> Figure:
    """A panel for each key, and the map."""
    keys = found.keys[:MOST_KEYS]
    mapped = [key for key in found.keys if key["mapped"]]
    panels = len(keys) + (1 if mapped else 0)
    columns = 2 if panels == 4 else min(panels, 3)
    lines = -(-panels // columns)
    figure = new_figure(3.3 * columns + 0.6, 2.7 * lines + 0.9)
    axes = figure.subplots(lines, columns, squeeze=False).ravel()
    window = _window(found)
    for ax, key in zip(axes, keys, strict=False):
        _along(ax, found, key, window)
    for number, ax in enumerate(axes[: len(keys)]):
        if number % columns == 0:
            ax.set_ylabel(found.label_of_value, fontsize=7.5)
    if mapped:
        _map(figure, axes[len(keys)], found, mapped)
    for ax in axes[panels:]:
        ax.axis("off")
    handles = {h.get_label(): h for ax in axes[:panels] for h in ax.get_legend_handles_labels()[0]}
    below_title = (0.005, 1.0 - 0.27 / figure.get_figheight())
    figure.legend(handles.values(), handles.keys(), loc="upper left", bbox_to_anchor=below_title, ncols=5, fontsize=8)
    entitle(figure, f"{shown.title}\n")  # the second line is the legend's
    caption(figure, f"{' '.join(sentences(found))} {motion_sentence(shown.records)}")
    return figure


def _window(found: Optimum) -> tuple[float, float]:
    """The values that are drawn: those of the slices and the map, and of the file as written."""
    frame = found.tried.frame
    here = frame.loc[frame["stage"].isin(["slices", "map", "as written"]), "value"].to_numpy(float)
    here = here if np.isfinite(here).any() else frame["value"].to_numpy(float)
    here = np.append(here[np.isfinite(here)], found.first["optimum"])
    low, high = float(here.min()), float(here.max())
    room = 0.05 * (high - low) or 0.01 * abs(high) or 1.0
    return low - room, high + room


def _slice(found: Optimum, key: dict[Any, Any]) -> pd.DataFrame:
    """The points that differ from the optimum in one key alone."""
    frame = found.tried.frame
    here = np.ones(len(frame), bool)
    for other in found.keys:
        if other["key"] != key["key"]:
            column = frame[other["key"]]
            here &= (column == (other["option"] or other["value"])).to_numpy()
    return frame[here & frame["value"].notna().to_numpy()].sort_values(key["key"])


def _shown(found: Optimum, name: str, values: Any) -> np.ndarray:
    """Values of a key in the unit of the study."""
    return np.asarray(values, float) / found.tried.columns[name].unit.factor


def _name(ax: Axes, which: str, found: Optimum, key: dict[Any, Any]) -> None:
    unit = found.tried.columns[key["key"]].unit
    name_axis(ax, which, [key["key"]], [unit], found.resolved, 7.5, 32)


def _along(ax: Axes, found: Optimum, key: dict[Any, Any], window: tuple[float, float]) -> None:
    """The number sought along one key through the optimum, every point behind it."""
    name, frame, line = key["key"], found.tried.frame, _slice(found, key)
    ax.set_ylim(window)
    _name(ax, "x", found, key)
    ax.tick_params(labelsize=7.5)
    first = found.first
    if key["option"]:
        options = list(dict.fromkeys(frame[name]))
        number = {option: place for place, option in enumerate(options)}
        x = frame[name].map(number).to_numpy(float)
        shift = np.random.default_rng(1).uniform(-0.25, 0.25, x.size)
        ax.plot(x + shift, frame["value"], ls="", marker=".", ms=2.5, color="0.65", label="point tried")
        best = line.groupby(name)["value"].agg("min" if found.direction == "least" else "max")
        ax.plot(
            [number[option] for option in best.index], best, ls="", marker="_", ms=16, mew=2, color=_LINE,
            label="through the optimum",
        )  # fmt: skip
        ax.set_xticks(range(len(options)), options)
        at, written = float(number[key["option"]]), float(number.get(key["written_option"], np.nan))
    else:
        if key["flat_from"] == key["flat_from"]:
            ax.axvspan(
                *_shown(found, name, [key["flat_from"], key["flat_to"]]), color=_FLAT, lw=0, label="as good by itself"
            )
        ax.plot(
            _shown(found, name, frame[name]), frame["value"], ls="", marker=".", ms=2.5, color="0.65",
            label="point tried",
        )  # fmt: skip
        ax.plot(_shown(found, name, line[name]), line["value"], color=_LINE, lw=1.6, label="through the optimum")
        if key["spacing"] == "log":
            ax.set_xscale("log")
        at, written = (float(_shown(found, name, key[which])) for which in ("value", "written"))
    if first["as_written"] == first["as_written"]:
        ax.plot([written], [first["as_written"]], ls="", marker="D", ms=6, color=_WRITTEN, mec="k", label="as written")
    ax.plot([at], [first["optimum"]], ls="", marker="*", ms=11, color=_BEST, mec="k", mew=0.6, label="optimum")


def _map(figure: Figure, ax: Axes, found: Optimum, mapped: list[dict[Any, Any]]) -> None:
    """Contours of the number over two keys, the others at the optimum; every point that lies there."""
    x_key, y_key = mapped
    frame = found.tried.frame
    here = np.array(frame["stage"].isin(["map", "slices"]) & frame["value"].notna())
    for other in found.keys:
        if other["key"] not in (x_key["key"], y_key["key"]):
            here &= (frame[other["key"]] == (other["option"] or other["value"])).to_numpy()
    frame = frame[here]
    x, y = (_shown(found, key["key"], frame[key["key"]]) for key in mapped)
    for key, apply in ((x_key, ax.set_xscale), (y_key, ax.set_yscale)):
        apply(key["spacing"])
    on_paper = [np.log(v) if key["spacing"] == "log" else v for v, key in zip((x, y), mapped, strict=True)]
    flat = [(v - v.min()) / np.ptp(v) for v in on_paper]
    corners = Triangulation(x, y, Triangulation(*flat).triangles)
    drawn = ax.tricontourf(corners, frame["value"].to_numpy(float), levels=14, cmap=COLOURS)
    bar = figure.colorbar(drawn, ax=ax, pad=0.02, aspect=22)
    bar.ax.tick_params(labelsize=7.5)
    bar.set_label(found.label_of_value, fontsize=7.5)
    ax.plot(x, y, ls="", marker=".", ms=1.5, color="0.85")
    ax.plot(
        *(_shown(found, key["key"], [key["value"]]) for key in mapped), ls="", marker="*", ms=11, color=_BEST, mec="k",
        mew=0.6,
    )  # fmt: skip
    ax.grid(False)
    ax.tick_params(labelsize=7.5)
    _name(ax, "x", found, x_key)
    _name(ax, "y", found, y_key)


def cite_optimise(resolved: Mapping[str, Any], used: Use) -> None:
    """The references of a search."""
    used("storn1997", "differential evolution, as in SciPy")
    used("nelder1965", "the simplex method, as in SciPy")


@dataclass(frozen=True)
class Optimum:
    """The answer as it was read back.

    keys : a row of the table for each
    tried : every point
    design : what the buildings do at the optimum and with the study as written, a row of the table for each quantity
    generations : of the search, at most
    over_motions : what is taken of the values over the motions
    resolved : the study with every default filled in
    """

    keys: list[dict[Any, Any]]
    tried: Table
    generations: int
    design: list[dict[Any, Any]]
    over_motions: str
    resolved: Mapping[str, Any]

    @property
    def is_found(self) -> bool:
        return self.first["outcome"] != NO_OPTIMUM

    @property
    def first(self) -> dict[Any, Any]:
        """What is the same for all keys."""
        return self.keys[0]

    @property
    def points(self) -> int:
        return int(self.first["points"])

    @property
    def unit(self) -> str:
        """SI unit of the number sought; "" of a pure number."""
        return self.tried.columns["value"].unit.name

    @property
    def sought(self) -> str:
        """What is sought least or most."""
        return str(self.first["sought"]).partition(" ")[2]

    @property
    def direction(self) -> str:
        """least or most."""
        return str(self.first["sought"]).partition(" ")[0]

    def number(self, value: float) -> str:
        """A value of the number sought."""
        return f"{value:.5g}{f' {self.unit}' if self.unit else ''}"

    @property
    def label_of_value(self) -> str:
        """The number sought with its unit."""
        return f"{self.sought} [{self.unit}]" if self.unit else self.sought

    def label(self, key: dict[Any, Any]) -> str:
        """A key with its unit."""
        return self._unit(key).label(str(key["key"]))

    def text(self, key: dict[Any, Any], name: str, with_unit: bool = True) -> str:
        """A value of a key in the unit of the study; NOTHING where there is none."""
        option = {"value": "option", "written": "written_option"}.get(name)
        if option and key[option]:
            return str(key[option])
        if key[name] != key[name]:
            return NOTHING
        unit = self._unit(key)
        return (unit if with_unit else Unit("", unit.factor)).text(float(key[name]), digits=4)

    def span(self, key: dict[Any, Any], name: str) -> str:
        """A range of a key, without its unit."""
        ends = [self.text(key, f"{name}_{end}", with_unit=False) for end in ("from", "to")]
        return NOTHING if "-" in ends else " to ".join(ends)

    def _unit(self, key: dict[Any, Any]) -> Unit:
        return self.tried.columns[key["key"]].unit


def optimum_of(results: Results) -> Optimum:
    """The answer of a results file."""
    keys = results.answer(OPTIMUM).frame.to_dict("records")
    asked = results.resolved.get("optimise") or {}
    design = results.answer(DESIGN).frame.to_dict("records")
    generations, over_motions = int(asked.get("generations", 0)), str(asked.get("over_motions", "mean"))
    return Optimum(keys, results.answer(POINTS), generations, design, over_motions, results.resolved)


def sentences(found: Optimum) -> list[str]:
    """The answer."""
    first = found.first
    what = f"{found.direction.capitalize()} of {found.sought}"
    if not found.is_found:
        return [f"{what}: no point gave a number that means something, so there is no answer."]
    error = first["error"]
    worth = f" ± {error:.1g}" if error == error and error > 0 else ""
    said = f"{what}: {first['optimum']:.5g}{worth}{f' {found.unit}' if found.unit else ''}"
    if first["as_written"] == first["as_written"]:
        said += f"; with the study as written: {found.number(first['as_written'])}"
    return [f"{said}.", design_note(found)]


def _optimum(found: Optimum) -> Table:
    """A row for each key."""
    is_written = any(found.text(key, "written") != NOTHING for key in found.keys)
    heads = ["key", "best", *["as written"] * is_written, "as good by itself", "as good with others", "searched"]
    rows = []
    for key in found.keys:
        spans = [found.span(key, name) for name in ("flat", "together", "range")]
        if key["option"]:
            spans[-1] = ", ".join(dict.fromkeys(map(str, found.tried.frame[key["key"]])))
        values = [found.text(key, name, with_unit=False) for name in ("value", "written")[: 1 + is_written]]
        rows.append([found.label(key), *values, *spans])
    return from_rows("The optimum", heads, rows)


def _design(found: Optimum) -> Table:
    """What the buildings do at the optimum, and beside it with the study as written."""

    def text(row: dict[Any, Any], value: float) -> str:
        if value != value:
            return NOTHING
        if row["of"]:
            return f"{value:.0f} of {row['of']}"
        return f"{value:.5g} {row['unit'] if row['unit'] != '1' else ''}".rstrip()

    told = [row for row in found.design
            if row["quantity"] != "scenes that failed" or row["optimum"] or row["as_written"]]  # fmt: skip
    rows = [[str(row["quantity"]), *(text(row, row[name]) for name in ("optimum", "as_written"))] for row in told]
    return from_rows("What the buildings do", ("quantity", "at the optimum", "as written"), rows)


def design_note(found: Optimum) -> str:
    """What is left of contacts and flags at the optimum."""
    left = {row["quantity"]: row["optimum"] for row in found.design}
    flags = [name.partition(": ")[2] for name, count in left.items() if name.startswith("scenes flagged: ") and count]
    count, of = (
        left["scenes with contact"],
        next(r["of"] for r in found.design if r["quantity"] == "scenes with contact"),
    )
    contact = "no contact is left" if count == 0 else f"contact is left in {count:.0f} of {counted(of, 'scene')}"
    if count != count:
        contact = "contacts are not known, since a scene failed"
    return f"At the optimum {contact}; {'flagged: ' + ', '.join(flags) if flags else 'nothing is flagged'}."


def notes(found: Optimum) -> list[str]:
    """What a reader should know of the numbers."""
    first, said = found.first, []
    if found.is_found:
        said.append(
            f"As good: the number stays within {first['tolerance']:.2g}{f' {found.unit}' if found.unit else ''} of the "
            "optimum (1 % of it, or its error); by itself: of the other keys at their best; with others: among all "
            "points that were tried."
        )
        if first["error"] != first["error"]:
            said.append("The numerical error is not known: no scene near the optimum was assessed (`estimate:`).")
    for key in found.keys if found.is_found else ():
        ends = np.array([key["range_from"], key["range_to"]], float)
        near = np.abs(ends - key["value"]) <= _AT_END * abs(ends[1] - ends[0])
        if near.any():
            end = "range_from" if near[0] else "range_to"
            said.append(
                f"{key['key']} is best at the end of its range, {found.text(key, end)}: a better value may lie beyond."
            )
    if found.is_found:
        said.append(
            f"What the buildings do: of every storey, floor or link the {found.over_motions} over the motions, and of "
            "these the largest."
        )
    if first["outcome"] == UNSETTLED:
        said.append(
            f"The search ended after {counted(found.generations, 'generation')}, before the points of one were nearly "
            "as good: write more `generations:`."
        )
    if first["failed"]:
        said.append(
            f"{counted(int(first['failed']), 'point')} of {found.points} gave no number: a scene failed, "
            "also in a second solution with a hundred times finer accuracy, or has no such number."
        )
    if first["meaningless"]:
        said.append(
            f"{counted(int(first['meaningless']), 'point')} of {found.points} were excluded: a link left the range "
            "in which its law has a meaning (floors that would have struck, an infill beyond its thickness): "
            "`pound show FILE.h5 flagged`."
        )
    return said
