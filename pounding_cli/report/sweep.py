"""A quantity over the sweep: its mean over the motions with the spread, as curves over one swept axis or as maps."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PatchCollection
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from pounding_cli.errors import InputError, Problem
from pounding_cli.numbers import Unit, counted
from pounding_cli.report.document import Picture
from pounding_cli.report.evidence import Evidence, motion_sentence
from pounding_cli.report.figures import RESPONSES as PANELS
from pounding_cli.report.figures import framed, plain_log
from pounding_cli.report.style import Look, caption, key_words, looks, name_axis, styled
from pounding_cli.report.table import column_of, digits
from pounding_cli.results.flags import parted
from pounding_cli.solver.outcome import is_meaningless
from pounding_cli.variables import OF_COLUMNS, RESPONSES

if TYPE_CHECKING:
    from pounding_cli.results.results import Results

OF_SCENES = ("error_estimate", "sensitivity", "energy_residual", "steps", "events", "seconds")
WORST = "worst"
"""What is said in place of a case or building for the largest over all of them."""
MOST_CASES, MOST_BUILDINGS = 12, 6
"""Cases of one figure, and buildings that get one of their own; further ones are drawn when asked for."""
LARGE_RANGE = 20.0
"""Largest over smallest value above which an axis, or the colours of a map, are logarithmic."""
MOST_TICKS = 12
"""Points of an axis up to which each has its own tick."""
COLOURS = "viridis"  # equal steps of a number are equal steps to the eye, also printed in grey


@dataclass(frozen=True, eq=False)
class SweptAxis:
    """One axis of a sweep.

    keys : the swept keys; more than one where they move together
    points : one tuple a point, as long as `keys`: SI numbers or texts, as in the tables
    units : per key the unit the study wrote it in
    resolved : the study with every default filled in, which says what the keys are
    """

    keys: tuple[str, ...]
    points: tuple[tuple[Any, ...], ...]
    units: tuple[Unit, ...]
    resolved: Mapping[str, Any] = field(repr=False)

    def __len__(self) -> int:
        return len(self.points)

    @property
    def dim(self) -> str:
        """Its dimension in the Dataset."""
        return self.keys[0]

    @property
    def numeric(self) -> bool:
        """Whether the points stand on a scale: the first key's values are numbers."""
        return not any(isinstance(point[0], str) for point in self.points)

    @property
    def words(self) -> str:
        """What the keys are, with their units, and the keys in brackets."""
        named = zip(self.keys, self.units, strict=True)
        return ", ".join(f"{unit.label(key_words(key, self.resolved))} ({key})" for key, unit in named)

    @cached_property
    def coordinates(self) -> np.ndarray:
        """Where the points stand: the first key's numbers in its unit; 1, 2, ... for texts."""
        if not self.numeric:
            return np.arange(1.0, len(self) + 1)
        return np.array([self.units[0].number(float(point[0])) for point in self.points])

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The points as ticks, without units: "5"; of keys that move together all values."""
        bare = [Unit("", unit.factor) for unit in self.units]
        return tuple(", ".join(unit.text(v) for unit, v in zip(bare, point, strict=True)) for point in self.points)


def swept_axes(results: Results) -> tuple[SweptAxis, ...]:
    """The axes of a results file in the order of the study; none where nothing is swept."""
    found = []
    for keys in results.swept:
        points, units = zip(*(results.axes[key] for key in keys), strict=True), [results.units[key] for key in keys]
        found.append(SweptAxis(tuple(keys), tuple(points), tuple(units), results.resolved))
    return tuple(found)


# numbers over the sweep


@dataclass(frozen=True, eq=False)
class OverSweep:
    """A quantity at every point of a sweep; arrays have one dimension an axis.

    title : the quantity with its unit
    mean, std : over the motions, at the place whose mean is largest at that point; NaN where nothing is
    void : whether the scene of a motion carries a flag that takes the meaning from these numbers
    """

    axes: tuple[SweptAxis, ...]
    title: str
    mean: np.ndarray
    std: np.ndarray
    void: np.ndarray

    @property
    def is_ratio(self) -> bool:
        """Whether 1 stands for the building alone."""
        return "₀" in self.title


Places = Mapping[str, Any]
"""Which case, analysis, building, storey, floor, link or record is looked at; of the others the worst of all there are,
and the mean over all motions."""


def over_sweep(
    results: Results, quantity: str, places: Places | None = None, axes: Sequence[SweptAxis] | None = None,
    at: Mapping[str, Any] | None = None,
) -> OverSweep:  # fmt: skip
    """A quantity over the sweep: per place the mean over the motions, at every point the place where it is largest.

    axes : in the order wanted, all axes of the sweep unless given
    at : value (SI, as in the tables) of every key of the axes left out

    Raises
    ------
    InputError : a quantity, case, analysis, building, storey, floor, link or motion that is not there
    """
    axes, at = swept_axes(results) if axes is None else tuple(axes), at or {}
    dims = [axis.dim for axis in axes]
    cut = {keys[0]: results.axes[key].index(at[key]) for keys in results.swept for key in keys if key in at}
    values = _chosen(_variable(results, quantity), quantity, places or {}).isel(cut, missing_dims="ignore", drop=True)
    mean, std = values.mean("record"), values.std("record", ddof=1)
    flags = meaningless(results.data["flags"]).isel(cut, missing_dims="ignore", drop=True)
    void = flags.sel({name: values[name] for name in ("case", "analysis", "record")}).any("record")
    of_places = [of.broadcast_like(mean).transpose(*dims, ...).values for of in (mean, std, void)]
    flat = [of.reshape(*(len(axis) for axis in axes), -1) for of in of_places]
    worst = np.where(np.isfinite(flat[0]), np.abs(flat[0]), -1.0).argmax(-1)[..., None]
    means, stds, voids = (np.take_along_axis(of, worst, -1)[..., 0] for of in flat)
    look = column_of(quantity, results.units)
    return OverSweep(axes, look.head, means / look.unit.factor, stds / look.unit.factor, voids & np.isfinite(means))


def _variable(results: Results, quantity: str) -> xr.DataArray:
    """A quantity over swept axes, case, analysis, record and place; refused where there is none of that name."""
    known = (*(v.name for v in RESPONSES if v.dims[-1] in ("storey", "floor", "link")), *OF_SCENES)
    if quantity not in known:
        raise InputError(Problem(f"there is no quantity {quantity!r}", f"write one of: {', '.join(known)}"))
    if quantity not in results.data:
        what = "no slab strikes columns" if quantity in OF_COLUMNS else "no case has a link"
        hint = "choose another quantity" + (", or write `columns:` in the buildings" if quantity in OF_COLUMNS else "")
        raise InputError(Problem(f"no {quantity} in these results: {what}", hint))
    return results.data[quantity].astype(float)


def _chosen(values: xr.DataArray, quantity: str, places: Places) -> xr.DataArray:
    """The values at some places; a name that is not there is refused with those that are."""
    problems = []
    for name, wanted in places.items():
        on_links = name == "floor" and values.dims[-1] == "link"
        if name not in values.dims and not on_links:
            problems.append(Problem(f"{quantity} has no {name}", "leave it out, or choose another quantity"))
            continue
        there = values["link_floor" if on_links else name].values
        if wanted not in there:
            hint = f"write one of: {', '.join(map(str, dict.fromkeys(there)))}"
            problems.append(Problem(f"there is no {name} {wanted!r} for {quantity}", hint))
        values = values.isel({"link" if on_links else name: there == wanted})
    if problems:
        raise InputError(problems)
    return values


def meaningless(flags: xr.DataArray) -> xr.DataArray:
    """Whether the numbers of every scene mean nothing."""
    void = [any(is_meaningless(flag) for flag, _ in parted(cell)) for cell in flags.values.flat]
    return flags.copy(data=np.array(void, bool).reshape(flags.shape))


# figures


@dataclass(frozen=True)
class Asked:
    """What is drawn over a sweep; what is not said is drawn for all there are.

    quantities : names of the tables' columns; V/V0 elastic and mu/mu0 inelastic unless given
    places : those that are fixed; case and building may be WORST
    at : swept key -> value (SI, as in the tables) at which an axis is cut
    """

    quantities: tuple[str, ...] = ()
    places: Places = field(default_factory=dict)
    at: Mapping[str, Any] = field(default_factory=dict)


Panels = tuple[str, dict[str, OverSweep]]
"""What stands side by side in a figure: a heading, and one quantity by case."""


def sweep_pictures(results: Results, shown: Evidence, asked: Asked | None = None) -> list[Picture]:
    """The figures over the sweep: maps over its two longest axes, or curves where it has one; none where it has none.

    shown : the point at which axes that are neither drawn nor cut by `asked.at` are taken

    Raises
    ------
    InputError : something asked for is not there
    """
    asked, axes = asked or Asked(), swept_axes(results)
    free = [axis for axis in axes if len(axis) > 1 and asked.at.keys().isdisjoint(axis.keys)]
    drawn = tuple(sorted(sorted(free, key=len, reverse=True)[:2], key=len))
    cut = {key: shown.point[key] for axis in axes if axis not in drawn for key in axis.keys} | dict(asked.at)
    if not drawn:
        if asked.quantities:
            what = "all swept keys are fixed" if asked.at else "nothing is swept"
            raise InputError(Problem(f"{what}, so there is nothing to draw {asked.quantities[0]} over", "see `sweep:`"))
        return []
    kind, draw, found = ("map", draw_maps, []) if len(drawn) == 2 else ("sweep", draw_curves, list[Picture]())
    for name, wanted in _figures(shown, asked):
        panels = [_panels(results, shown, quantity, places, drawn, cut) for quantity, places in wanted]
        if panels := [panel for panel in panels if panel[1]]:
            words, building = _said(shown, wanted[0][1], cut), wanted[0][1].get("building")
            text = f"Means over the motions at their largest place, one {'map' if kind == 'map' else 'line'} per case."
            drawing = partial(draw, results, shown, [building] if building in shown.group else [], panels, words)
            heading = f"{name.replace('-', ', ')}: over the sweep"
            found.append(Picture(f"{name}-{kind}", heading, text, drawing, has_scale=kind == "map"))
    return found


def _figures(shown: Evidence, asked: Asked) -> Iterator[tuple[str, list[tuple[str, Places]]]]:
    """Name of every figure, quantity and places of its panels."""
    fixed = dict(asked.places)
    analyses = [fixed["analysis"]] if "analysis" in fixed else shown.analyses
    buildings = [fixed["building"]] if "building" in fixed else shown.group[:MOST_BUILDINGS]
    on_buildings = {v.name for v in RESPONSES if v.dims[-1] in ("storey", "floor")}
    for building in buildings if not asked.quantities else ():
        pairs = [(quantity, analysis) for analysis, quantity, _ in PANELS if analysis in analyses]
        yield building, [(quantity, fixed | {"analysis": how, "building": building}) for quantity, how in pairs]
    for quantity in asked.quantities:
        if quantity not in on_buildings and "building" not in fixed:
            yield quantity, [(quantity, fixed | {"analysis": how}) for how in analyses]
            continue
        for building in buildings:
            places = fixed | {"building": building}
            yield f"{building}-{quantity}", [(quantity, places | {"analysis": how}) for how in analyses]


def _panels(
    results: Results, shown: Evidence, quantity: str, places: Places, drawn: Sequence[SweptAxis], cut: Mapping[str, Any]
) -> Panels:
    """A quantity by case; cases that have none of it are left out."""
    by_case = {}
    for case in [places["case"]] if "case" in places else shown.plotted[:MOST_CASES]:
        named = dict(places) | {"case": case}
        for name, known in (("case", shown.cases), ("building", shown.group)):
            if named.get(name) == WORST and WORST not in known:
                del named[name]
        over = over_sweep(results, quantity, named, drawn, cut)
        if np.isfinite(over.mean).any():
            by_case[case if "case" in named else "worst of all cases"] = over
    return str(places["analysis"]).capitalize(), by_case


def _said(shown: Evidence, places: Places, cut: Mapping[str, Any]) -> str:
    """What is drawn, in a sentence without its full stop."""
    what = f"Mean over the {counted(len(shown.records['record'].unique()), 'motion')}"
    if "record" in places:
        what = f"Under {places['record']}"
    where = [f"{name} {places[name]}" for name in ("storey", "floor", "link") if name in places]
    at = f" at {', '.join(where)}" if where else ", at the place where it is largest"
    others = "".join(f"; {key} = {shown.results.value_label(key, value)}" for key, value in cut.items())
    return f"{motion_sentence(shown.records)} {what}{at}{others}"


class Placed(NamedTuple):
    """Where the points of an axis stand in a figure.

    order : numbers of the points, as they stand from the left (or upwards)
    positions : where they stand, in that order
    ticks : their names, in that order; None where the axis is a scale with ticks of its own
    """

    axis: SweptAxis
    order: np.ndarray
    positions: np.ndarray
    ticks: list[str] | None

    def apply(self, ax: Axes, side: Literal["x", "y"], named: bool = True, room: int = 0) -> None:
        """Set scale, ticks and, where wanted, the title of one side of a panel; a side without a title has no names.

        room : characters in a line of the title, 0: any number
        """
        if self.ticks is not None:
            step = -(-len(self.ticks) // MOST_TICKS)
            ax.set(**{f"{side}ticks": self.positions[::step], f"{side}ticklabels": self.ticks[::step]})
        elif 0 < LARGE_RANGE * self.positions[0] < self.positions[-1]:
            ax.set(**{f"{side}scale": "log"})
        if named:
            name_axis(ax, side, self.axis.keys, self.axis.units, self.axis.resolved, room=room)
        else:
            ax.tick_params(axis=side, labelleft=False, labelbottom=False)


def placed(axis: SweptAxis, characters: int, *, cells: bool = False) -> Placed:
    """Places and ticks of an axis; of texts their names in lines.

    characters : that fit beside each other along the axis
    cells : few points stand as cells of one size, whatever their distances
    """
    order = np.argsort(axis.coordinates, kind="stable")
    if axis.numeric and not (cells and len(axis) <= MOST_TICKS):
        return Placed(axis, order, axis.coordinates[order], None)
    width = max(characters // len(axis), 9)
    return Placed(axis, order, np.arange(1.0, len(axis) + 1), [textwrap.fill(axis.names[n], width) for n in order])


def _framed(
    results: Results, shown: Evidence, black: Sequence[str], rows: int, columns: int, size: tuple[float, float],
    cases: Sequence[str],
) -> tuple[Figure, list[list[Axes]]]:  # fmt: skip
    """The frame of a figure over the sweep; periods that change over it are not written."""
    periods = results.buildings.groupby("building")["period"].nunique()
    title = f"{black[0]} over the sweep" if black else "Over the sweep"
    changing = set(periods[periods > 1].index)
    return framed(shown, black, rows, columns, title, size=size, cases=cases, unwritten=changing)


@styled
def draw_curves(
    results: Results, shown: Evidence, black: Sequence[str], panels: Sequence[Panels], words: str
) -> Figure:
    """One panel for each of `panels`, the swept axis across: the mean over the motions with its spread, a line a case.

    black : buildings filled in the drawing of the group
    words : what is drawn, for the caption
    """
    cases = list(dict.fromkeys(case for _, by_case in panels for case in by_case))
    columns = min(len(panels), 2)
    figure, axes = _framed(results, shown, black, -(-len(panels) // columns), columns, (4.0, 3.2), cases)
    every = [over for _, by_case in panels for over in by_case.values()]
    places, look = placed(every[0].axes[0], 34), looks(cases)
    flat = [ax for line in axes for ax in line]
    for ax, (heading, by_case) in zip(flat, panels, strict=False):
        for case, over in by_case.items():
            _curve(ax, over, places, look[case])
        ax.set_title(heading, loc="left")
        ax.set_ylabel(over.title)
        if over.is_ratio:
            ax.axhline(1, color="0.35", lw=1.0, zorder=1)
        places.apply(ax, "x")
        if places.ticks is not None:
            ax.set_xlim(0.6, len(places.positions) + 0.4)
    for ax in flat[len(panels) :]:
        ax.axis("off")
    spread = "; bands: one standard deviation either way" if any(np.isfinite(over.std).any() for over in every) else ""
    caption(figure, f"{words}{spread}.{_marks(every, 'Open grey markers')}")
    return figure


def _curve(ax: Axes, over: OverSweep, places: Placed, look: Look) -> None:
    x, joined = places.positions, places.ticks is None
    mean, std, void = (values[places.order] for values in (over.mean, over.std, over.void))
    if joined:
        ax.fill_between(x, mean - std, mean + std, color=look.color, alpha=0.13, lw=0, zorder=1.5)
    elif np.isfinite(std).any():
        ax.errorbar(x, mean, yerr=std, fmt="none", ecolor=look.color, elinewidth=0.8, capsize=2)
    ax.plot(x, mean, color=look.color, ls=look.line if joined else "none", lw=1.6, zorder=2.5)
    size = 5 if len(x) <= 25 else 2.5
    ax.plot(x[~void], mean[~void], look.marker, color=look.color, ms=size, zorder=3)
    ax.plot(x[void], mean[void], look.marker, mfc="white", mec="0.45", ms=size + 1, zorder=3)


@styled
def draw_maps(results: Results, shown: Evidence, black: Sequence[str], panels: Sequence[Panels], words: str) -> Figure:
    """One panel for every case of each of `panels`; the second axis of the quantities is across.

    black : buildings filled in the drawing of the group
    words : what is drawn, for the caption
    """
    columns = min(max(len(by_case) for _, by_case in panels), 4)
    blocks = [
        (heading, by_case, list(by_case)[start : start + columns])
        for heading, by_case in panels
        for start in range(0, len(by_case), columns)
    ]
    every = [over for _, by_case in panels for over in by_case.values()]
    along, across = every[0].axes
    width, height = (
        1.0 + 0.34 * max(len(axis), 3) if len(axis) <= MOST_TICKS else (4.5 if columns == 1 else 3.2)
        for axis in (across, along)
    )  # room for a number in every cell, or for the picture of many
    figure, axes = _framed(results, shown, black, len(blocks), columns, (width + 0.3, height + 0.5), ())
    x, y = placed(across, int(11 * width), cells=True), placed(along, 12 * len(along), cells=True)
    for line, (heading, by_case, cases) in zip(axes, blocks, strict=True):
        norm = _norm(np.concatenate([over.mean.ravel() for over in by_case.values()]))
        for ax, case in zip(line, cases, strict=False):
            _map(ax, by_case[case], x, y, norm, first=ax is line[0])
            ax.set_title(f"{case}, {heading.lower()}", loc="left")
        for ax in line[len(cases) :]:
            ax.axis("off")
        bar = figure.colorbar(ScalarMappable(norm, COLOURS), ax=line[: len(cases)], pad=0.02, aspect=18)
        bar.set_label(by_case[cases[0]].title)
        if isinstance(norm, LogNorm):
            plain_log(bar.ax.yaxis)
    grey = " Grey: no number." if any(np.isnan(over.mean).any() for over in every) else ""
    caption(figure, f"{words}.{_marks(every, 'Hatched')}{grey}")
    return figure


def _norm(values: np.ndarray) -> Normalize:
    """The colour scale of all panels of a quantity."""
    low, high = np.nanmin(values), np.nanmax(values)
    if low > 0 and high > LARGE_RANGE * low:
        return LogNorm(low, high)
    return Normalize(low, high if high > low else low + 1e-3 * max(abs(low), 1.0))


def _map(ax: Axes, over: OverSweep, x: Placed, y: Placed, norm: Normalize, *, first: bool) -> None:
    order = np.ix_(y.order, x.order)
    values, void = over.mean[order], over.void[order]
    ax.grid(False)
    ax.set_facecolor("0.87")
    x.apply(ax, "x")
    y.apply(ax, "y", named=first, room=24)
    ax.pcolormesh(
        x.positions, y.positions, np.ma.masked_invalid(values), norm=norm, cmap=COLOURS, shading="nearest",
        rasterized=True,
    )  # fmt: skip
    right, up = _edges(x.positions), _edges(y.positions)
    crossed = [Rectangle((right[j], up[i]), right[j + 1] - right[j], up[i + 1] - up[i]) for i, j in np.argwhere(void)]
    ax.add_collection(PatchCollection(crossed, facecolor="none", edgecolor="white", hatch="//", linewidth=0))
    if x.ticks is not None and y.ticks is not None:
        for i, j in np.argwhere(
            np.isfinite(values)
        ):  # dark on light and light on dark; hatching ends before the number
            colour = mpl.colormaps[COLOURS](norm(values[i, j]))
            ink = "white" if float(np.dot(colour[:3], (0.299, 0.587, 0.114))) < 0.5 else "black"
            box = {"facecolor": colour, "edgecolor": "none", "pad": 0.8} if void[i, j] else None
            place, text = (x.positions[j], y.positions[i]), digits(float(values[i, j]), 3)
            ax.text(*place, text, ha="center", va="center", fontsize=7, color=ink, bbox=box)
    ax.tick_params(length=3)


def _edges(places: np.ndarray) -> np.ndarray:
    """Where cells around places begin and end: half way to their neighbours."""
    half = np.diff(places) / 2
    return np.concatenate(([places[0] - half[0]], places[:-1] + half, [places[-1] + half[-1]]))


def _marks(every: Sequence[OverSweep], mark: str) -> str:
    """What a mark of numbers without meaning says, in a sentence; "" where there are none."""
    return f" {mark}: not meaningful for some motions." if any(over.void.any() for over in every) else ""
