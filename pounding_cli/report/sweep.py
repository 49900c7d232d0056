"""A quantity over the sweep: its mean over the motions with the spread, as curves over one swept key or as maps."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import xarray as xr

from pounding_cli.errors import InputError, Problem
from pounding_cli.numbers import Unit, format_number, pluralize
from pounding_cli.report.document import Picture
from pounding_cli.report.evidence import RESPONSES as PANELS
from pounding_cli.report.evidence import Evidence, describe_motions, list_points
from pounding_cli.report.figures import framed
from pounding_cli.report.style import finish, looks, name_axis, styled
from pounding_cli.results.columns import column_of
from pounding_cli.solver.outcome import is_meaningless
from pounding_cli.variables import RESPONSE_VARIABLES, VARIABLES

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from pounding_cli.results.results import ResultTables

OF_SCENES = ("error_estimate", "sensitivity", "energy_residual", "steps", "events", "seconds")
WORST = "worst"
"""What is said in place of a case or building for the largest over all of them."""
MOST_CASES, MOST_BUILDINGS = 6, 6
"""Cases of one figure, and buildings that get one of their own; further ones are drawn when asked for."""
LARGE_RANGE = 20.0
"""Largest over smallest value above which an axis, or the colours of a map, are logarithmic."""
MOST_TICKS = 12
"""Points of an axis up to which each has its own tick, and its own cell of a map."""
COLOURS = "viridis_r"  # darker is larger; equal steps of a number are equal steps to the eye, also in grey
RATIO_COLOURS = "RdBu_r"
"""Of ratios to the building alone: white at 1, red above it, blue below it, as far on either side."""

CELL = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5)])
"""Corners of a cell of a map around its middle."""


class SweptAxis(NamedTuple):
    """One axis of a sweep.

    keys : the swept keys; more than one where they move together
    points : one tuple a point, as long as `keys`: SI numbers or texts, as in the tables
    units : per key the unit the study wrote it in
    coordinates : where the points stand: the first key's numbers in its unit; 1, 2, ... for texts
    names : the points as ticks, without units: "5"; of keys that move together all values
    """

    keys: tuple[str, ...]
    points: list[tuple[Any, ...]]
    units: list[Unit]
    coordinates: np.ndarray
    names: list[str]

    @property
    def numeric(self) -> bool:
        """Whether the points stand on a scale: the first key's values are numbers."""
        return not any(isinstance(point[0], str) for point in self.points)

    def take(self, numbers: Sequence[int]) -> SweptAxis:
        """Some of its points, in this order."""
        points, names = [self.points[n] for n in numbers], [self.names[n] for n in numbers]
        return SweptAxis(self.keys, points, self.units, self.coordinates[list(numbers)], names)


def swept_axes(results: ResultTables) -> list[SweptAxis]:
    """The axes of a results file in the order of the study; none where nothing is swept."""
    found = []
    for keys in results.swept:
        points, units = list_points(results, keys), [results.units[key] for key in keys]
        bare = [Unit("", unit.factor) for unit in units]
        names = [", ".join(unit.text(v) for unit, v in zip(bare, point, strict=True)) for point in points]
        is_text = any(isinstance(point[0], str) for point in points)
        numbers = [n + 1.0 if is_text else units[0].number(float(point[0])) for n, point in enumerate(points)]
        found.append(SweptAxis(tuple(keys), points, units, np.array(numbers), names))
    return found


# numbers over the sweep


def over_sweep(
    results: ResultTables,
    quantity: str,
    places: Mapping[str, Any] | None = None,
    index: Mapping[str, Any] | None = None,
) -> xr.Dataset:
    """A quantity over the sweep: per place the mean over the motions, at every point the place where it is largest.

    places : which case, analysis, building, storey, floor, link or record is looked at; all there are of the others
    index : by the first key of an axis the number of the point at which it is cut, or the numbers of some; all of the
        others, in their order

    Returns `mean` and `std` over the motions in the unit that figures show, NaN where nothing is, and `void`: whether
    the scene of a motion carries a flag that takes the meaning from these numbers.

    Raises
    ------
    InputError : a quantity, case, analysis, building, storey, floor, link or motion that is not there
    """
    index = index or {}
    values = _values(results, quantity, places or {}).isel(index, drop=True)
    values = values / column_of(quantity, results.units).unit.factor
    flags = results.data["flags"].sel({name: values[name] for name in ("case", "analysis", "record")})
    mean, void = values.mean("record"), meaningless(flags.isel(index, drop=True)).any("record")
    found = xr.Dataset({"mean": mean, "std": values.std("record", ddof=1), "void": void & np.isfinite(mean)})
    every = [keys[0] for keys in results.swept if keys[0] in mean.dims]
    dims = [*(dim for dim in index if dim in every), *(dim for dim in every if dim not in index)]
    found = found.reset_coords(drop=True)
    found = found.stack(place=[dim for dim in mean.dims if dim not in dims], create_index=False)
    return found.isel(place=abs(found["mean"]).fillna(-1.0).argmax("place")).transpose(*dims)


def _values(results: ResultTables, quantity: str, places: Mapping[str, Any]) -> xr.DataArray:
    """A quantity over swept axes, case, analysis, record and place, at some places; what is not there is refused with
    what is."""
    known = (*(v.name for v in RESPONSE_VARIABLES if v.dims[-1] in ("storey", "floor", "link")), *OF_SCENES)
    if quantity not in known:
        raise InputError(Problem(f"there is no quantity {quantity!r}", f"write one of: {', '.join(known)}"))
    if quantity not in results.data:
        raise InputError(Problem(f"no case has a link with {quantity}", "choose another quantity"))
    values = results.data[quantity].astype(float)
    for name, wanted in places.items():
        dim = "link" if name == "floor" and "link" in values.dims else name
        if dim not in values.dims:
            raise InputError(Problem(f"{quantity} has no {name}", "leave it out, or choose another quantity"))
        there = values[name if dim == name else "link_floor"].values.astype(str)
        if str(wanted) not in there:
            hint = f"write one of: {', '.join(dict.fromkeys(there))}"
            raise InputError(Problem(f"there is no {name} {str(wanted)!r} for {quantity}", hint))
        values = values.isel({dim: there == str(wanted)})
    return values


def meaningless(flags: xr.DataArray) -> xr.DataArray:
    """Whether the numbers of every scene mean nothing."""
    void = [any(map(is_meaningless, cell.splitlines())) for cell in flags.values.flat]
    return flags.copy(data=np.array(void, bool).reshape(flags.shape))


# figures


@dataclass(frozen=True)
class SweepChoice:
    """What is drawn over a sweep; what is not said is drawn for all there are.

    quantities : names of the tables' columns; V/V0 elastic and mu/mu0 inelastic unless given
    places : those that are fixed, as of `over_sweep`; case and building may be WORST
    at : swept key -> value (SI, as in the tables) at which an axis is cut
    """

    quantities: tuple[str, ...] = ()
    places: Mapping[str, Any] = field(default_factory=dict)
    at: Mapping[str, Any] = field(default_factory=dict)


Panels = list[tuple[str, str, dict[str, xr.Dataset]]]
"""What stands in a figure: a quantity, its analysis, and its numbers by case."""


def sweep_pictures(results: ResultTables, shown: Evidence, asked: SweepChoice | None = None) -> list[Picture]:
    """The figures over the sweep: maps over its two longest axes, or curves where it has one; none where it has none.

    shown : the point at which axes that are neither drawn nor cut by `asked.at` are taken

    Raises
    ------
    InputError : something asked for is not there
    """
    asked, every = asked or SweepChoice(), swept_axes(results)
    free = [axis for axis in every if len(axis.points) > 1 and asked.at.keys().isdisjoint(axis.keys)]
    free = sorted(sorted(free, key=lambda axis: -len(axis.points))[:2], key=lambda axis: len(axis.points))
    _check_places(asked, shown)
    if asked != SweepChoice() and not free:
        message = "no swept key with two values is left to draw figures over"
        raise InputError(Problem(message, "leave one of the swept keys out of --where, or all options of the figures"))
    index: dict[str, Any] = {axis.keys[0]: np.argsort(axis.coordinates, kind="stable").tolist() for axis in free}
    axes, cut, found = [axis.take(index[axis.keys[0]]) for axis in free], dict[str, Any](), list[Picture]()
    for axis in (axis for axis in every if axis.keys[0] not in index):
        given = {key: asked.at[key] for key in axis.keys if key in asked.at} or {k: shown.point[k] for k in axis.keys}
        points = [dict(zip(axis.keys, point, strict=True)) for point in axis.points]
        meant = [number for number, point in enumerate(points) if given.items() <= point.items()]
        if not meant:
            raise InputError(Problem(f"{', '.join(given)} do not have these values together", "give one of them"))
        index[axis.keys[0]] = meant[0]
        cut |= points[meant[0]]
    drawn = set[str]()
    kind, draw = ("map", draw_maps) if len(axes) == 2 else ("sweep", draw_curves)
    for name, building, wanted in _figures(shown, asked) if axes else ():
        places, panels = dict(asked.places) | ({"building": building} if building else {}), Panels()
        for analysis, quantity in wanted:
            if by_case := _by_case(results, shown, quantity, {**places, "analysis": analysis}, index):
                panels.append((quantity, analysis, by_case))
        if panels:
            drawing = partial(draw, shown, building, axes, panels, _said(shown, places, cut))
            text, heading = "Means over the motions at their largest place, case by case.", name.replace("-", ", ")
            found.append(Picture(f"{name}-{kind}", f"{heading}: over the sweep", text, drawing, kind == "map"))
            drawn.update(quantity for quantity, *_ in panels)
    missing = [name for name in asked.quantities if name not in drawn] or ["V_ratio or mu_ratio"] * (not drawn)
    if missing and asked != SweepChoice():
        where = ", ".join(f"{name} {place}" for name, place in asked.places.items()) or "any case"
        raise InputError(Problem(f"there is no number of {missing[0]} in {where}", "choose another place or quantity"))
    return found


def _check_places(asked: SweepChoice, shown: Evidence) -> None:
    """Raise `InputError` for a place that no figure can have, whatever its quantity."""
    for name, place in asked.places.items():
        if place == WORST and name not in ("case", "building"):
            hint = f"write one {name}; `{WORST}` stands for a case or a building"
            raise InputError(Problem(f"there is no worst {name}", hint))
    analysis = asked.places.get("analysis", shown.analyses[0])
    if analysis not in shown.analyses:
        raise InputError(Problem(f"there is no analysis {analysis!r}", f"write one of: {', '.join(shown.analyses)}"))


def _figures(shown: Evidence, asked: SweepChoice) -> Iterator[tuple[str, str, list[tuple[str, str]]]]:
    """Name and building of every figure, and analysis and quantity of its panels."""
    fixed = asked.places
    analyses = [fixed["analysis"]] if "analysis" in fixed else shown.analyses
    buildings = [fixed["building"]] if "building" in fixed else shown.group[:MOST_BUILDINGS]
    on_links = {v.name for v in RESPONSE_VARIABLES if v.dims[-1] == "link"} | set(OF_SCENES)
    for building in buildings if not asked.quantities else ():
        yield building, building, [(how, quantity) for how, quantity in PANELS if how in analyses]
    for quantity in asked.quantities:
        for building in [""] if quantity in on_links and "building" not in fixed else buildings:
            yield f"{building}-{quantity}".lstrip("-"), building, [(how, quantity) for how in analyses]


def _by_case(
    results: ResultTables, shown: Evidence, quantity: str, places: Mapping[str, Any], index: Mapping[str, Any]
) -> dict[str, xr.Dataset]:
    """A quantity by case; cases that have none of it are left out."""
    found = {}
    for case in [places["case"]] if "case" in places else shown.plotted_cases[:MOST_CASES]:
        named = {name: place for name, place in {**places, "case": case}.items() if place != WORST}
        over = over_sweep(results, quantity, named, index)
        if np.isfinite(over["mean"]).any():
            found[named.get("case", "worst of all cases")] = over
    return found


def _said(shown: Evidence, places: Mapping[str, Any], cut: Mapping[str, Any]) -> str:
    """What is drawn, in a sentence without its full stop."""
    where = [f"{name} {place}" for name, place in places.items() if name in ("record", "storey", "floor", "link")]
    where += [f"{key} = {shown.results.value_label(key, value)}" for key, value in cut.items()]
    what = f"Mean over the {pluralize(len(shown.records), 'motion')}, at the place where it is largest"
    return "; ".join([f"{describe_motions(shown.records)} {what}", *where])


def _finish(figure: Figure, shown: Evidence, building: str, panels: Panels, words: str, mark: str) -> Figure:
    """Title and caption; `mark` : of numbers without meaning, where there are some."""
    if any(over["void"].any() for *_, by_case in panels for over in by_case.values()):
        words += f" {mark}: not meaningful for some motions."
    finish(figure, ": ".join(filter(None, ("Over the sweep", building, shown.title))), words)
    return figure


def _set_axis(ax: Axes, side: str, axis: SweptAxis, width: int, room: int = 80) -> None:
    """Title of one side of a panel, and its ticks at 1, 2, ..., every so many where there are too many.

    width, room : characters in a line of a tick, and of the title
    """
    step = -(-len(axis.names) // MOST_TICKS)
    names = [textwrap.fill(name, width) for name in axis.names[::step]] if width else []
    if names:
        ax.set(**{f"{side}ticks": range(1, len(axis.names) + 1, step), f"{side}ticklabels": names})
    name_axis(ax, side, axis.keys, axis.units, room=room)


@styled
def draw_curves(shown: Evidence, building: str, axes: Sequence[SweptAxis], panels: Panels, words: str) -> Figure:
    """The swept axis across: the mean over the motions with its spread, a line a case.

    building : filled in the drawing of the group; words : what is drawn, for the caption
    """
    cases = list(dict.fromkeys(case for *_, by_case in panels for case in by_case))
    (axis,), look, columns = axes, looks(cases), min(len(panels), 2)
    x, is_scale = axis.coordinates, axis.numeric
    figure, lines = framed(shown, building, -(-len(panels) // columns), columns, (4.0, 3.2), cases)
    flat = [ax for line in lines for ax in line]
    for ax, (quantity, analysis, by_case) in zip(flat, panels, strict=False):
        for case, over in by_case.items():
            (mean, std, void), how = (over[name].values for name in ("mean", "std", "void")), look[case]
            if is_scale:
                ax.fill_between(x, mean - std, mean + std, color=how.color, alpha=0.13, lw=0, zorder=1.5)
            else:
                ax.errorbar(x, mean, yerr=std, fmt="none", ecolor=how.color, elinewidth=0.8, capsize=2)
            line, size = how.line if is_scale else "none", 5 if len(x) <= 25 else 2.5
            ax.plot(x, mean, color=how.color, ls=line, marker=how.marker, ms=size, lw=1.6, zorder=2.5)
            ax.plot(x[void], mean[void], how.marker, mfc="white", mec="0.45", ms=size + 1, zorder=3)
        ax.set_title(analysis.capitalize(), loc="left")
        ax.set_ylabel(column_of(quantity, shown.results.units).head)
        if is_ratio(quantity):  # 1 stands for the building alone
            ax.axhline(1, color="0.35", lw=1.0, zorder=1)
        _set_axis(ax, "x", axis, 0 if is_scale else max(34 // len(x), 9))
        if is_scale and 0 < LARGE_RANGE * x[0] < x[-1]:
            ax.set_xscale("log")
    for ax in flat[len(panels) :]:
        ax.axis("off")
    words = f"{words}; bands: one standard deviation either way."
    return _finish(figure, shown, building, panels, words, "Open grey markers")


@styled
def draw_maps(shown: Evidence, building: str, axes: Sequence[SweptAxis], panels: Panels, words: str) -> Figure:
    """A line of panels for each quantity, a panel for each case; the second axis is across. Points are cells of one
    size, with their numbers where all have room; hatched where they mean nothing. All panels have one scale of colours.

    building : filled in the drawing of the group; words : what is drawn, for the caption
    """
    columns, sizes = max(len(by_case) for *_, by_case in panels), [len(axis.points) for axis in axes]
    few = max(sizes) <= MOST_TICKS
    along, across = (1.4 + 0.34 * max(size, 3) if few else 3.7 for size in sizes)
    figure, lines = framed(shown, building, len(panels), columns, (across, along))
    values = np.concatenate([over["mean"].values.ravel() for *_, by_case in panels for over in by_case.values()])
    labels = list(dict.fromkeys(column_of(quantity, shown.results.units).head for quantity, *_ in panels))
    are_ratios = all(is_ratio(quantity) for quantity, *_ in panels)
    colours = _ratio_colours(values) if are_ratios else _colours(values)
    for line, (_, analysis, by_case) in zip(lines, panels, strict=True):
        for ax, (case, over) in zip(line, by_case.items(), strict=False):
            _map(ax, over, colours, few)
            _set_axis(ax, "x", axes[1], 9)
            _set_axis(ax, "y", axes[0], 12, room=24)
            ax.set_title(f"{case}, {analysis}", loc="left")
            ax.label_outer()
        for ax in line[len(by_case) :]:
            ax.axis("off")
    bar = figure.colorbar(colours, ax=[ax for line in lines for ax in line], pad=0.02, aspect=18 * len(panels))
    bar.set_label(", ".join(labels))
    if are_ratios:
        bar.ax.set_ylim(min(np.nanmin(values), 1 / LEAST_SPREAD), max(np.nanmax(values), LEAST_SPREAD))
        bar.ax.axhline(1, color="black", lw=1.6)
        words += ". White, and the line across the scale: as the building alone"
    return _finish(figure, shown, building, panels, f"{words}. Grey: no number.", "Hatched")


def is_ratio(quantity: str) -> bool:
    """Whether a quantity is a ratio to the building alone, whose 1 is marked."""
    return bool(VARIABLES[quantity].ratio)


LEAST_SPREAD = 1.1
"""Ratio that the colours of a map of ratios reach at least, so that rounding about 1 stays white [-]."""


def _ratio_colours(values: np.ndarray) -> Any:
    """Return the colours of ratios: 1 in the middle, twice as far from it as half."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import LogNorm

    positive = values[np.isfinite(values) & (values > 0)]
    furthest = max(LEAST_SPREAD, float(np.exp(np.abs(np.log(positive)).max(initial=0.0))))
    return ScalarMappable(LogNorm(1 / furthest, furthest), RATIO_COLOURS)


def _colours(values: np.ndarray) -> Any:
    """Return the colours of numbers, logarithmic over a large range."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import LogNorm, Normalize

    low = np.nanmin(values)
    high = np.nanmax(values)
    scale: Any = LogNorm if 0 < LARGE_RANGE * low < high else Normalize
    return ScalarMappable(scale(low, high if high > low else low + 1e-3 * max(abs(low), 1.0)), COLOURS)


def _map(ax: Axes, over: xr.Dataset, colours: Any, few: bool) -> None:
    """The map of one case; `few` : whether its cells have room for their numbers."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    mean, void = over["mean"].values, over["void"].values
    y, x = (np.arange(1, size + 1) for size in mean.shape)
    ax.grid(False)
    ax.set_facecolor("0.87")
    drawn = np.ma.masked_invalid(np.maximum(mean, colours.norm.vmin))  # a logarithmic scale has no zero
    ax.pcolormesh(x, y, drawn, norm=colours.norm, cmap=colours.cmap, shading="nearest", rasterized=True)
    lightness = colours.to_rgba(drawn)[..., :3] @ (0.299, 0.587, 0.114)
    is_dark = np.isfinite(mean) & (lightness < 0.5)  # cells without a number show the light grey of the panel
    for ink, here in (("white", is_dark), ("black", ~is_dark)):
        cells = [Path(CELL + at, closed=True) for at in 1 + np.argwhere(void & here)[:, ::-1]]
        if cells:  # one outline of all, since every hatch takes time
            outline = Path.make_compound_path(*cells)
            ax.add_patch(PathPatch(outline, fill=False, hatch="//", edgecolor=ink, linewidth=0))
        for row, column in np.argwhere(np.isfinite(mean) & here) if few else ():
            colour = colours.to_rgba(drawn[row, column])
            box = {"facecolor": colour, "edgecolor": "none", "pad": 0.8} if void[row, column] else None
            text = format_number(float(mean[row, column]), 3)
            ax.text(x[column], y[row], text, ha="center", va="center", fontsize=7, color=ink, bbox=box)
