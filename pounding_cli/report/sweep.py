"""A quantity over the sweep: its mean over the motions with the spread, as curves over one swept key or as maps."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import xarray as xr

from pounding_cli.errors import InputError
from pounding_cli.numbers import Unit, format_number, pluralize
from pounding_cli.report.document import Picture
from pounding_cli.report.evidence import RESPONSES as PANELS
from pounding_cli.report.evidence import Evidence, describe_motions, list_points
from pounding_cli.report.figures import CONTACT_SENTENCE, has_contacts, new_framed_panels
from pounding_cli.report.style import finish, looks, name_axis, with_style
from pounding_cli.results.columns import column_of
from pounding_cli.results.flags import is_void
from pounding_cli.study.expressions.expression import CONTACT_QUANTITIES
from pounding_cli.variables import RESPONSE_VARIABLES, VARIABLES

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from pounding_cli.results.results import ResultTables

OF_SCENES = ("error_estimate", "sensitivity", "energy_residual", "steps", "events", "seconds")
"""Quantities of whole runs."""
PLACE_DIMS = ("storey", "floor", "line", "link")
"""Last dimensions of the quantities that can be drawn."""
WORST = "worst"
"""Stands for a case or building: the largest value over all of them."""
MAX_FIGURE_CASES = 6
"""Cases of one figure; further ones are drawn when they are chosen."""
MOST_BUILDINGS = 6
"""Buildings that get a figure of their own; further ones do when they are chosen."""
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

    keys : swept keys; more than one where they move together
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
        """True if the points stand on a scale: the first key's values are numbers."""
        return not any(isinstance(point[0], str) for point in self.points)

    def take(self, numbers: Sequence[int]) -> SweptAxis:
        """Return the axis with some of its points, in this order."""
        points = [self.points[number] for number in numbers]
        names = [self.names[number] for number in numbers]
        return SweptAxis(self.keys, points, self.units, self.coordinates[list(numbers)], names)


def list_swept_axes(results: ResultTables) -> list[SweptAxis]:
    """Return the axes of a results file in the order of the study; none where nothing is swept."""
    axes = []
    for keys in results.swept:
        points = list_points(results, keys)
        units = []
        for number, key in enumerate(keys):
            is_text = any(isinstance(point[number], str) for point in points)
            units.append(Unit() if is_text else results.units[key])
        names = [_name_point(point, units) for point in points]
        if any(isinstance(point[0], str) for point in points):
            coordinates = np.arange(1.0, len(points) + 1.0)
        else:
            coordinates = np.array([units[0].number(float(point[0])) for point in points])
        axes.append(SweptAxis(tuple(keys), points, units, coordinates, names))
    return axes


def _name_point(point: Sequence[Any], units: Sequence[Unit]) -> str:
    """Return the values of a point in the units of the study, without the names of the units."""
    return ", ".join(Unit("", unit.factor).text(value) for unit, value in zip(units, point, strict=True))


# numbers over the sweep


def over_sweep(
    results: ResultTables,
    quantity: str,
    places: Mapping[str, Any] | None = None,
    index: Mapping[str, Any] | None = None,
) -> xr.Dataset:
    """Return a quantity over the sweep: the mean over the motions, at every point of the place where it is largest.

    The dataset has `mean` and `std` over the motions in the unit of figures, NaN where there is none, and `void`: True
    where the run of a motion carries a flag that takes the meaning from these numbers.

    Parameters
    ----------
    places : case, analysis, building, storey, floor, line, link or record; all of those that are not given
    index : by the first key of an axis the number of the point at which it is cut, or the numbers of some; all of the
        others, in their order

    Raises
    ------
    InputError : a quantity, case, analysis, building, storey, floor, line, link or motion that is not there
    """
    index = index or {}
    values = _select_values(results, quantity, places or {}).isel(index, drop=True)
    values = values / column_of(quantity, results.units).unit.factor
    flags = results.data["flags"].sel({name: values[name] for name in ("case", "analysis", "record")})
    mean = values.mean("record")
    void = find_meaningless(flags.isel(index, drop=True)).any("record")
    statistics = xr.Dataset({"mean": mean, "std": values.std("record", ddof=1), "void": void & np.isfinite(mean)})
    swept = [keys[0] for keys in results.swept if keys[0] in mean.dims]
    dims = [*(dim for dim in index if dim in swept), *(dim for dim in swept if dim not in index)]
    statistics = statistics.reset_coords(drop=True)
    statistics = statistics.stack(place=[dim for dim in mean.dims if dim not in dims], create_index=False)
    largest = abs(statistics["mean"]).fillna(-1.0).argmax("place")
    return statistics.isel(place=largest).transpose(*dims)


def _select_values(results: ResultTables, quantity: str, places: Mapping[str, Any]) -> xr.DataArray:
    """Return a quantity over swept axes, case, analysis, record and place, at some places.

    Raises InputError: a quantity or a place that is not there, with those that are.
    """
    known = (*(v.name for v in RESPONSE_VARIABLES if v.dims[-1] in PLACE_DIMS), *OF_SCENES)
    if quantity not in known:
        raise InputError(f"there is no quantity {quantity!r}", f"write one of: {', '.join(known)}")
    if quantity not in results.data:
        raise InputError(f"no case has a link with {quantity}", "choose another quantity")
    values = results.data[quantity].astype(float)
    for name, wanted in places.items():
        dim = "link" if name == "floor" and "link" in values.dims else name
        if dim not in values.dims:
            raise InputError(f"{quantity} has no {name}", "leave it out, or choose another quantity")
        there = values[name if dim == name else "link_floor"].values.astype(str)
        if str(wanted) not in there:
            hint = f"write one of: {', '.join(dict.fromkeys(there))}"
            raise InputError(f"there is no {name} {str(wanted)!r} for {quantity}", hint)
        values = values.isel({dim: there == str(wanted)})
    return values


def find_meaningless(flags: xr.DataArray) -> xr.DataArray:
    """Return of every run whether its flags take the meaning from its numbers."""
    void = [is_void(cell) for cell in flags.values.flat]
    return flags.copy(data=np.array(void, bool).reshape(flags.shape))


# figures


@dataclass(frozen=True)
class SweepChoice:
    """The figures over a sweep that are drawn; of everything that is not chosen, all are.

    quantities : columns of the tables; V/V0 elastic and mu/mu0 inelastic unless given
    places : those that are fixed, as of `over_sweep`; case and building may be WORST
    at : swept key -> value (SI, as in the tables) at which an axis is cut
    """

    quantities: tuple[str, ...] = ()
    places: Mapping[str, Any] = field(default_factory=dict)
    at: Mapping[str, Any] = field(default_factory=dict)


Panels = list[tuple[str, str, dict[str, xr.Dataset]]]
"""The panels of a figure: a quantity, its analysis, and its numbers by case."""


def list_sweep_pictures(results: ResultTables, evidence: Evidence, choice: SweepChoice | None = None) -> list[Picture]:
    """Return the figures over the sweep: maps over its two longest axes, or curves over one; none without a sweep.

    evidence : the point at which axes are cut that are neither drawn nor in `choice.at`

    Raises
    ------
    InputError : something chosen is not there
    """
    is_chosen = choice is not None and choice != SweepChoice()
    choice = choice or SweepChoice()
    _check_places(choice, evidence)
    axes, index, cut = _cut_axes(results, evidence, choice)
    if is_chosen and not axes:
        message = "no swept key with two values is left to draw figures over"
        raise InputError(message, "leave one of the swept keys out of --where, or all options of the figures")
    kind, draw = ("map", draw_maps) if len(axes) == 2 else ("sweep", draw_sweep_curves)
    pictures: list[Picture] = []
    drawn: set[str] = set()
    for name, building, wanted in _iter_figures(evidence, choice) if axes else ():
        places = dict(choice.places) | ({"building": building} if building else {})
        panels = Panels()
        for analysis, quantity in wanted:
            if by_case := _select_by_case(results, evidence, quantity, {**places, "analysis": analysis}, index):
                panels.append((quantity, analysis, by_case))
        if not panels:
            continue
        drawing = partial(draw, evidence, building, axes, panels, _build_caption(evidence, places, cut, panels))
        text = "Means over the motions at their largest place, case by case."
        heading = f"{name.replace('-', ', ')} over the sweep"
        pictures.append(Picture(f"{name}-{kind}", heading, text, drawing, kind == "map"))
        drawn.update(quantity for quantity, *_ in panels)
    missing = [name for name in choice.quantities if name not in drawn] or ["V_ratio or mu_ratio"] * (not drawn)
    if missing and is_chosen:
        where = ", ".join(f"{name} {place}" for name, place in choice.places.items()) or "any case"
        raise InputError(f"there is no number of {missing[0]} in {where}", "choose another place or quantity")
    return pictures


def _cut_axes(
    results: ResultTables, evidence: Evidence, choice: SweepChoice
) -> tuple[list[SweptAxis], dict[str, Any], dict[str, Any]]:
    """Return the axes that are drawn, the index of every axis, and the values at which the others are cut.

    Raises InputError: values that do not occur together.
    """
    every_axis = list_swept_axes(results)
    free = [axis for axis in every_axis if len(axis.points) > 1 and choice.at.keys().isdisjoint(axis.keys)]
    longest = sorted(free, key=lambda axis: -len(axis.points))[:2]
    longest.sort(key=lambda axis: len(axis.points))
    index: dict[str, Any] = {}
    axes = []
    for axis in longest:
        order = np.argsort(axis.coordinates, kind="stable").tolist()
        index[axis.keys[0]] = order
        axes.append(axis.take(order))
    cut: dict[str, Any] = {}
    for axis in every_axis:
        if axis.keys[0] in index:
            continue
        chosen = {key: choice.at[key] for key in axis.keys if key in choice.at}
        given = chosen or {key: evidence.point[key] for key in axis.keys}
        points = [dict(zip(axis.keys, point, strict=True)) for point in axis.points]
        numbers = [number for number, point in enumerate(points) if given.items() <= point.items()]
        if not numbers:
            raise InputError(f"{', '.join(given)} do not have these values together", "give one of them")
        index[axis.keys[0]] = numbers[0]
        cut |= points[numbers[0]]
    return axes, index, cut


def _check_places(choice: SweepChoice, evidence: Evidence) -> None:
    """Raise `InputError` for a place that no figure can have, for any quantity."""
    for name, place in choice.places.items():
        if place == WORST and name not in ("case", "building"):
            hint = f"write one {name}; `{WORST}` stands for a case or a building"
            raise InputError(f"there is no worst {name}", hint)
    analysis = choice.places.get("analysis", evidence.analyses[0])
    if analysis not in evidence.analyses:
        raise InputError(f"there is no analysis {analysis!r}", f"write one of: {', '.join(evidence.analyses)}")


def _iter_figures(evidence: Evidence, choice: SweepChoice) -> Iterator[tuple[str, str, list[tuple[str, str]]]]:
    """Yield name and building of every figure, and analysis and quantity of its panels."""
    fixed = choice.places
    analyses = [fixed["analysis"]] if "analysis" in fixed else evidence.analyses
    buildings = [fixed["building"]] if "building" in fixed else evidence.group[:MOST_BUILDINGS]
    on_links = {variable.name for variable in RESPONSE_VARIABLES if variable.dims[-1] == "link"} | set(OF_SCENES)
    for building in buildings if not choice.quantities else ():
        yield building, building, [(analysis, quantity) for analysis, quantity in PANELS if analysis in analyses]
    for quantity in choice.quantities:
        for building in [""] if quantity in on_links and "building" not in fixed else buildings:
            name = f"{building}-{quantity}".lstrip("-")
            yield name, building, [(analysis, quantity) for analysis in analyses]


def _select_by_case(
    results: ResultTables, evidence: Evidence, quantity: str, places: Mapping[str, Any], index: Mapping[str, Any]
) -> dict[str, xr.Dataset]:
    """Return a quantity by case; cases that have none of it are left out."""
    by_case = {}
    for case in [places["case"]] if "case" in places else evidence.plotted_cases[:MAX_FIGURE_CASES]:
        named = {name: place for name, place in {**places, "case": case}.items() if place != WORST}
        over = over_sweep(results, quantity, named, index)
        if np.isfinite(over["mean"]).any():
            by_case[named.get("case", "worst of all cases")] = over
    return by_case


def _build_caption(evidence: Evidence, places: Mapping[str, Any], cut: Mapping[str, Any], panels: Panels) -> str:
    """Return the caption of a figure, without its last full stop."""
    where = [f"{name} {place}" for name, place in places.items() if name in ("record", *PLACE_DIMS)]
    where += [f"{key} = {evidence.results.value_label(key, value)}" for key, value in cut.items()]
    mean = f"Mean over the {pluralize(len(evidence.records), 'motion')}, at the place where it is largest"
    sentences = [describe_motions(evidence.records)]
    depends = any(quantity in CONTACT_QUANTITIES for quantity, *_ in panels)
    if depends and has_contacts(evidence.results.link("kind", "impacts")):
        sentences.append(CONTACT_SENTENCE)
    return "; ".join([" ".join([*sentences, mean]), *where])


def _finish(figure: Figure, evidence: Evidence, building: str, panels: Panels, words: str, mark: str) -> Figure:
    """Add title and caption.

    mark : of numbers without meaning, which the caption explains where there are some
    """
    if any(over["void"].any() for *_, by_case in panels for over in by_case.values()):
        words += f" {mark}: not meaningful for some motions."
    finish(figure, ": ".join(filter(None, ("Over the sweep", building, evidence.title))), words)
    return figure


def _set_axis(ax: Axes, side: str, axis: SweptAxis, width: int, room: int = 80) -> None:
    """Set the title of one side of a panel, and its ticks at 1, 2, ..., every so many where there are too many.

    width : characters in a line of a tick
    room : characters in a line of the title
    """
    step = -(-len(axis.names) // MOST_TICKS)
    names = [textwrap.fill(name, width) for name in axis.names[::step]] if width else []
    if names:
        ax.set(**{f"{side}ticks": range(1, len(axis.names) + 1, step), f"{side}ticklabels": names})
    name_axis(ax, side, axis.keys, axis.units, room=room)


@with_style
def draw_sweep_curves(
    evidence: Evidence, building: str, axes: Sequence[SweptAxis], panels: Panels, words: str
) -> Figure:  # fmt: skip
    """Draw the mean over the motions with its spread over a swept axis, a line a case.

    building : filled in the drawing of the group
    words : caption
    """
    cases = list(dict.fromkeys(case for *_, by_case in panels for case in by_case))
    (axis,) = axes
    look = looks(cases)
    columns = min(len(panels), 2)
    x = axis.coordinates
    is_scale = axis.numeric
    figure, lines = new_framed_panels(evidence, building, -(-len(panels) // columns), columns, (4.0, 3.2), cases)
    flat = [ax for line in lines for ax in line]
    for ax, (quantity, analysis, by_case) in zip(flat, panels, strict=False):
        for case, over in by_case.items():
            mean = over["mean"].values
            std = over["std"].values
            void = over["void"].values
            color = look[case].color
            marker = look[case].marker
            if is_scale:
                ax.fill_between(x, mean - std, mean + std, color=color, alpha=0.13, lw=0, zorder=1.5)
            else:
                ax.errorbar(x, mean, yerr=std, fmt="none", ecolor=color, elinewidth=0.8, capsize=2)
            line = look[case].line if is_scale else "none"
            size = 5 if len(x) <= 25 else 2.5
            ax.plot(x, mean, color=color, ls=line, marker=marker, ms=size, lw=1.6, zorder=2.5)
            ax.plot(x[void], mean[void], marker, mfc="white", mec="0.45", ms=size + 1, zorder=3)
        ax.set_title(analysis.capitalize(), loc="left")
        ax.set_ylabel(column_of(quantity, evidence.results.units).head)
        if is_ratio(quantity):  # 1 stands for the building alone
            ax.axhline(1, color="0.35", lw=1.0, zorder=1)
        _set_axis(ax, "x", axis, 0 if is_scale else max(34 // len(x), 9))
        if is_scale and 0 < LARGE_RANGE * x[0] < x[-1]:
            ax.set_xscale("log")
    for ax in flat[len(panels) :]:
        ax.axis("off")
    words = f"{words}; bands: one standard deviation either way."
    return _finish(figure, evidence, building, panels, words, "Open grey markers")


@with_style
def draw_maps(evidence: Evidence, building: str, axes: Sequence[SweptAxis], panels: Panels, words: str) -> Figure:
    """Draw a line of panels for each quantity, a panel for each case; the second axis is across.

    Points are cells of one size, with their numbers where all have room; hatched where they mean nothing. All panels
    have one scale of colours.

    building : filled in the drawing of the group
    words : caption
    """
    columns = max(len(by_case) for *_, by_case in panels)
    sizes = [len(axis.points) for axis in axes]
    few = max(sizes) <= MOST_TICKS
    along, across = (1.4 + 0.34 * max(size, 3) if few else 3.7 for size in sizes)
    figure, lines = new_framed_panels(evidence, building, len(panels), columns, (across, along))
    values = np.concatenate([over["mean"].values.ravel() for *_, by_case in panels for over in by_case.values()])
    labels = list(dict.fromkeys(column_of(quantity, evidence.results.units).head for quantity, *_ in panels))
    are_ratios = all(is_ratio(quantity) for quantity, *_ in panels)
    colours = _ratio_colours(values) if are_ratios else _colours(values)
    for line, (_, analysis, by_case) in zip(lines, panels, strict=True):
        for ax, (case, over) in zip(line, by_case.items(), strict=False):
            _draw_map(ax, over, colours, few)
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
    return _finish(figure, evidence, building, panels, f"{words}. Grey: no number.", "Hatched")


def is_ratio(quantity: str) -> bool:
    """Return whether a quantity is a ratio to the building alone, whose 1 is marked."""
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


def _draw_map(ax: Axes, over: xr.Dataset, colours: Any, few: bool) -> None:
    """Draw the map of one case.

    few : True if its cells have room for their numbers
    """
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    mean = over["mean"].values
    void = over["void"].values
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
