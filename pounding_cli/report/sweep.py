"""A quantity over the sweep: its mean over the motions with the spread, as curves over one swept axis or maps over two.

`over_sweep` computes what figures and the page's explorer draw."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, Literal

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PatchCollection
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from pounding_cli.errors import InputError, Problem
from pounding_cli.numbers import Unit, counted
from pounding_cli.report.document import Picture
from pounding_cli.report.evidence import Evidence, motion_sentence, names
from pounding_cli.report.figures import RESPONSES as PANELS
from pounding_cli.report.figures import framed, plain_log, plotted_cases
from pounding_cli.report.style import caption, key_words, looks, name_axis, span, styled
from pounding_cli.report.table import column_of, digits
from pounding_cli.results.flags import flagged_scenes
from pounding_cli.variables import OF_COLUMNS, RESPONSES, VARIABLES

if TYPE_CHECKING:
    from pounding_cli.results.results import Results

LEVELS = {
    "storey": ("case", "analysis", "building", "storey"),
    "floor": ("case", "analysis", "building", "floor"),
    "link": ("case", "analysis", "link", "floor"),
    "scene": ("case", "analysis"),
}
"""Tables that hold quantities, and the columns that, beside point and motion, say where a value stands."""

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


@dataclass(frozen=True)
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
    resolved: Mapping[str, Any] = field(default_factory=dict, repr=False, compare=False)

    def __len__(self) -> int:
        return len(self.points)

    @property
    def numeric(self) -> bool:
        """Whether the points stand on a scale: the first key's values are numbers."""
        return not any(isinstance(point[0], str) for point in self.points)

    @property
    def label(self) -> str:
        """The keys with their units: "cases.gap.gap [cm]"."""
        return ", ".join(unit.label(key) for key, unit in zip(self.keys, self.units, strict=True))

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
    frame = results.scene()
    return tuple(
        SweptAxis(
            tuple(keys),
            tuple(frame[list(keys)].drop_duplicates().itertuples(index=False, name=None)),
            tuple(results.units.get(key, Unit()) for key in keys),
            results.resolved,
        )
        for keys in results.swept
    )


# numbers over the sweep


@dataclass(frozen=True)
class Choice:
    """Which values of a quantity are looked at; None takes the worst of all there are.

    quantity : a column of the tables storey, floor, link or scene
    record : one motion; None takes the mean over all of them
    """

    quantity: str
    case: str | None = None
    analysis: str | None = None
    building: str | None = None
    storey: int | None = None
    floor: int | None = None
    link: str | None = None
    record: str | None = None

    @property
    def table(self) -> str:
        """The table that holds the quantity."""
        return table_of(self.quantity)


@dataclass(frozen=True, eq=False)
class OverSweep:
    """A quantity at every point of a sweep; arrays have one dimension an axis.

    title : the quantity with its unit
    mean, std : over the motions, at the place whose mean is largest at that point; NaN where nothing is
    place : that place in words ("stiff, storey 5"); "" where nothing is
    meaningless : number of motions whose scene carries a flag that takes the meaning from its numbers
    reasons : those flags
    """

    choice: Choice
    axes: tuple[SweptAxis, ...]
    title: str
    mean: np.ndarray
    std: np.ndarray
    place: np.ndarray
    meaningless: np.ndarray
    reasons: tuple[str, ...]

    @property
    def is_ratio(self) -> bool:
        """Whether 1 stands for the building alone."""
        return self.choice.quantity.endswith("_ratio")


def table_of(quantity: str) -> str:
    """The table that holds a quantity.

    Raises
    ------
    InputError : there is no such quantity
    """
    known = (*(variable.name for variable in RESPONSES if variable.dims[-1] in LEVELS), *OF_SCENES)
    if quantity not in known:
        raise InputError(Problem(f"there is no quantity {quantity!r}", f"write one of: {', '.join(known)}"))
    return "scene" if quantity in OF_SCENES else VARIABLES[quantity].dims[-1]


def over_sweep(
    results: Results, choice: Choice, axes: Sequence[SweptAxis] | None = None, at: Mapping[str, Any] | None = None
) -> OverSweep:
    """A quantity over the sweep: per place the mean over the motions, at every point the place where it is largest.

    axes : in the order wanted, all axes of the sweep unless given
    at : value (SI, as in the tables) of every key of the axes left out

    Raises
    ------
    InputError : a quantity, case, analysis, building, storey, floor, link or motion that is not there
    """
    axes = tuple(axes) if axes is not None else swept_axes(results)
    frame = getattr(results, choice.table)()
    if choice.quantity not in frame.columns and choice.quantity in OF_COLUMNS:
        hint = "choose another quantity, or write `columns:` in the buildings whose columns are struck"
        raise InputError(Problem(f"no {choice.quantity} in these results: no slab strikes columns", hint))
    rows = _chosen(_cut(frame, at or {}), choice)
    scenes, level = ["point", "case", "analysis", "record"], list(LEVELS[choice.table])
    numbers = rows[[*level, "record"]].assign(
        value=rows[choice.quantity].to_numpy(float), point=point_numbers(rows, axes)
    )
    voids = void_scenes(_cut(results.scene(), at or {}), axes)
    numbers["void"] = pd.MultiIndex.from_frame(numbers[scenes]).isin(pd.MultiIndex.from_frame(voids[scenes]))
    found = over_motions(numbers, "value", level)
    void_of = numbers.groupby(["point", *level], sort=False)["void"].sum()
    found["void"] = void_of.reindex(pd.MultiIndex.from_frame(found[["point", *level]])).to_numpy()
    worst = largest(found, ["point"])
    shape = tuple(len(axis) for axis in axes)

    def spread(values: Any, empty: object, kind: Any = float) -> np.ndarray:
        whole = np.full(int(np.prod(shape)), empty, dtype=kind)
        whole[worst["point"].to_numpy(int)] = values
        return whole.reshape(shape)

    look = column_of(choice.quantity, results.units)
    mean, std = (spread(worst[name].to_numpy(float) / look.unit.factor, np.nan) for name in ("mean", "std"))
    drawn = pd.MultiIndex.from_frame(numbers.loc[numbers["void"], scenes])
    reasons = names(voids.loc[pd.MultiIndex.from_frame(voids[scenes]).isin(drawn), "flag"])
    return OverSweep(
        choice, axes, look.head, mean, std, spread(_places(worst, choice), "", object),
        spread(worst["void"].to_numpy(int), 0, int), tuple(reasons),
    )  # fmt: skip


def over_motions(frame: pd.DataFrame, quantity: str, place: Sequence[str]) -> pd.DataFrame:
    """Mean, std, min, max and count of a quantity over the motions, by `point` and place; no row where nothing is."""
    found = frame.groupby(["point", *place], sort=False)[quantity].agg(["mean", "std", "min", "max", "count"])
    return found[found["count"] > 0].reset_index()


def largest(found: pd.DataFrame, by: Sequence[str]) -> pd.DataFrame:
    """Of what `over_motions` found the row with the largest mean, positive or negative, in every group."""
    if found.empty:
        return found
    return found.loc[found["mean"].abs().groupby([found[name] for name in by], sort=False).idxmax()]


def void_scenes(scene: pd.DataFrame, axes: Sequence[SweptAxis]) -> pd.DataFrame:
    """Flags that take the meaning from a scene's numbers, with its point's number, case, analysis and record."""
    flagged = flagged_scenes(scene[scene["flags"].astype(bool)])
    flagged = flagged[flagged["meaningless"]]
    return flagged.assign(point=point_numbers(flagged, axes))


def point_numbers(rows: pd.DataFrame, axes: Sequence[SweptAxis]) -> np.ndarray:
    """The number of every row's point, the last axis fastest; -1 where the axes do not have it."""
    number = np.zeros(len(rows), int)
    for axis in axes:
        places = pd.MultiIndex.from_tuples(axis.points)
        place = places.get_indexer(pd.MultiIndex.from_frame(rows[list(axis.keys)]))
        number = np.where((number < 0) | (place < 0), -1, number * len(axis) + place)
    return number


def _cut(frame: pd.DataFrame, at: Mapping[str, Any]) -> pd.DataFrame:
    """The rows at some values of swept keys."""
    for key, value in at.items():
        frame = frame[frame[key] == value]
    return frame


def _chosen(frame: pd.DataFrame, choice: Choice) -> pd.DataFrame:
    """The rows of the choice; a name that is not there is refused with those that are."""
    problems = []
    for name in ("case", "analysis", "building", "storey", "floor", "link", "record"):
        value = getattr(choice, name)
        if value is None:
            continue
        if name not in frame.columns:
            problems.append(Problem(f"{choice.quantity} has no {name}", "leave it out, or choose another quantity"))
        elif (rows := frame[frame[name] == value]).empty:
            there = ", ".join(names(frame[name].sort_values() if name in ("storey", "floor") else frame[name]))
            hint = f"write one of: {there}" if there else f"there is no {name} in this file"
            problems.append(Problem(f"there is no {name} {value!r} for {choice.quantity}", hint))
        else:
            frame = rows
    if problems:
        raise InputError(problems)
    return frame


def _places(worst: pd.DataFrame, choice: Choice) -> np.ndarray:
    """Where the numbers stand in words, without what was chosen."""
    words = []
    for name in LEVELS[choice.table]:
        if getattr(choice, name) is None and not (choice.table == "link" and name == "floor"):
            prefix = f"{name} " if name in ("storey", "floor") else ""
            words.append([f"{prefix}{value}" for value in worst[name]])
    return np.array([", ".join(parts) for parts in zip(*words, strict=True)] if words else [""] * len(worst), object)


# figures


@dataclass(frozen=True)
class Asked:
    """What is drawn over a sweep; what is not said is drawn for all there are.

    quantities : names of the tables' columns; V/V0 elastic and mu/mu0 inelastic unless given
    choice : the places that are fixed; its case and building may be WORST
    at : swept key -> value (SI, as in the tables) at which an axis is cut
    """

    quantities: tuple[str, ...] = ()
    choice: Choice = field(default_factory=lambda: Choice(""))
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
    asked = asked or Asked()
    axes = swept_axes(results)
    free = [axis for axis in axes if len(axis) > 1 and asked.at.keys().isdisjoint(axis.keys)]
    drawn = tuple(sorted(sorted(free, key=len, reverse=True)[:2], key=len))
    cut = {key: shown.point[key] for axis in axes if axis not in drawn for key in axis.keys} | dict(asked.at)
    if not drawn:
        if asked.quantities:
            what = "all swept keys are fixed" if asked.at else "nothing is swept"
            raise InputError(Problem(f"{what}, so there is nothing to draw {asked.quantities[0]} over", "see `sweep:`"))
        return []
    kind, draw = ("map", draw_maps) if len(drawn) == 2 else ("sweep", draw_curves)
    said = "as maps over two swept keys, one per case" if kind == "map" else "one line per case"
    group, found = _without_swept_periods(results, shown), []
    for name, choices in _choices(shown, asked):
        every = [_panels(results, shown, choice, drawn, cut) for choice in choices]
        every = [(heading, by_case) for heading, by_case in every if by_case]
        if every:
            building = str(choices[0].building)
            black = [building] if building in shown.group else []
            title = f"{building} over the sweep" if black else "Over the sweep"
            drawing = partial(draw, group, black, title, every, _said(shown, every, cut))
            text = f"Means over the motions at their largest place, {said}."
            heading = f"{name.replace('-', ', ')}: over the sweep"
            found.append(Picture(f"{name}-{kind}", heading, text, drawing, has_scale=kind == "map"))
    return found


def _without_swept_periods(results: Results, shown: Evidence) -> Evidence:
    """The same without the periods that change over the sweep, for the drawing of the group."""
    changing = results.buildings.groupby("building")["period"].transform("nunique") > 1
    swept = set(results.buildings.loc[changing, "building"])
    periods = shown.buildings["period"].mask(shown.buildings["building"].isin(swept))
    return replace(shown, buildings=shown.buildings.assign(period=periods))


def _choices(shown: Evidence, asked: Asked) -> Iterator[tuple[str, list[Choice]]]:
    """Name and quantities of every figure."""
    fixed = asked.choice
    buildings: list[str] = [fixed.building] if fixed.building else list(shown.group)[:MOST_BUILDINGS]
    analyses = [fixed.analysis] if fixed.analysis else shown.analyses
    if not asked.quantities:
        for building in buildings:
            pairs = [(quantity, analysis) for analysis, quantity, _ in PANELS if analysis in analyses]
            yield building, [replace(fixed, quantity=q, analysis=a, building=building) for q, a in pairs]
    for quantity in asked.quantities:
        of_buildings = table_of(quantity) in ("storey", "floor") or fixed.building is not None
        places: list[str | None] = [*buildings] if of_buildings else [None]
        for place in places:
            name = f"{place}-{quantity}" if place else quantity
            yield name, [replace(fixed, quantity=quantity, analysis=a, building=place) for a in analyses]


def _panels(
    results: Results, shown: Evidence, choice: Choice, drawn: Sequence[SweptAxis], cut: Mapping[str, Any]
) -> Panels:
    """A quantity by case; cases that have none of it are left out, unless they were asked for."""
    cases: list[str] = [choice.case] if choice.case else plotted_cases(shown)[:MOST_CASES]
    building = None if choice.building == WORST and WORST not in shown.group else choice.building
    by_case, refused = {}, None
    for case in cases:
        named = None if case == WORST and WORST not in shown.cases else case
        try:
            over = over_sweep(results, replace(choice, case=named, building=building), drawn, cut)
        except InputError as error:
            refused = error
            continue
        if np.isfinite(over.mean).any():
            by_case[case if named else "worst of all cases"] = over
    if not by_case and refused:
        raise refused
    return str(choice.analysis).capitalize(), by_case


def _said(shown: Evidence, panels: Sequence[Panels], cut: Mapping[str, Any]) -> str:
    """What is drawn, in a sentence without its full stop."""
    choice = next(iter(panels[0][1].values())).choice
    motions = shown.records["record"].nunique()
    what = f"Mean over the {counted(motions, 'motion')}" if choice.record is None else f"Under {choice.record}"
    chosen = [f"{name} {getattr(choice, name)}" for name in ("storey", "floor", "link") if getattr(choice, name)]
    free = [name for name in LEVELS[choice.table] if getattr(choice, name) is None and name != "analysis"]
    if choice.table == "link":
        free = [] if chosen else [name for name in free if name != "floor"]
    worst = f"at the {' and '.join(free)} where it is largest" if free else ""
    where = " ".join((*(f"at {place}" for place in chosen), worst)).strip()
    others = ", ".join(f"{key} = {shown.units.get(key, Unit()).text(value)}" for key, value in cut.items())
    said = f"{what}, {where}".rstrip(", ") + (f"; {others}" if others else "")
    return f"{motion_sentence(shown.records)} {said}"


@dataclass(frozen=True)
class Placed:
    """Where the points of an axis stand in a figure.

    order : numbers of the points, as they stand from the left (or upwards)
    positions : where they stand, in that order
    ticks : their names, in that order; None where the axis is a scale with ticks of its own
    log : whether that scale is logarithmic
    key : what numbered ticks stand for, as a sentence; "" where the ticks are names
    """

    axis: SweptAxis
    order: np.ndarray
    positions: np.ndarray
    ticks: tuple[str, ...] | None
    log: bool
    key: str

    def apply(self, ax: Axes, side: Literal["x", "y"], named: bool = True, room: int = 0) -> None:
        """Set scale, ticks and, where wanted, the title of one side of a panel; a side without a title has no names.

        room : characters in a line of the title, 0: any number
        """
        if self.log:
            ax.set(**{f"{side}scale": "log"})
        if self.ticks is not None:
            step = -(-len(self.ticks) // MOST_TICKS)
            ax.set(**{f"{side}ticks": self.positions[::step], f"{side}ticklabels": self.ticks[::step]})
        if named:
            name_axis(ax, side, self.axis.keys, self.axis.units, self.axis.resolved, room=room)
        else:
            ax.tick_params(axis=side, labelleft=False, labelbottom=False)


def placed(axis: SweptAxis, characters: int, *, cells: bool = False) -> Placed:
    """Places and ticks of an axis.

    characters : that fit beside each other along the axis
    cells : few points stand as cells of one size, whatever their distances
    """
    order = np.argsort(axis.coordinates, kind="stable")
    coordinates = axis.coordinates[order]
    if axis.numeric and not (cells and len(axis) <= MOST_TICKS):
        wide = coordinates[0] > 0 and coordinates[-1] > LARGE_RANGE * coordinates[0]
        return Placed(axis, order, coordinates, None, bool(wide), "")
    ticks, key = short_names([axis.names[place] for place in order], characters)
    positions = np.arange(1.0, len(axis) + 1)
    return Placed(axis, order, positions, tuple(ticks), False, f" {axis.label}: {key}." if key else "")


def short_names(names: Sequence[str], characters: int) -> tuple[list[str], str]:
    """Ticks that fit beside each other in so many characters: names in lines, else numbers with a key."""
    width = max(characters // len(names), 1)
    wrapped = [textwrap.fill(name, width, break_long_words=False) for name in names]
    longest = max(len(line) for name in wrapped for line in name.split("\n"))
    if longest <= width and len("".join(names)) < 3 * characters:
        return wrapped, ""
    numbers = [str(number) for number in range(1, len(names) + 1)]
    return numbers, "; ".join(f"({n}) {name}" for n, name in zip(numbers, names, strict=True))


@styled
def draw_curves(
    evidence: Evidence, black: Sequence[str], headline: str, panels: Sequence[Panels], words: str
) -> Figure:
    """One panel for each of `panels`, the swept axis across: the mean over the motions with its spread, a line a case.

    black : buildings filled in the drawing of the group
    words : what is drawn, for the caption
    """
    cases = list(dict.fromkeys(case for _, by_case in panels for case in by_case))
    columns = min(len(panels), 2)
    figure, axes = framed(
        evidence, black, -(-len(panels) // columns), columns, headline, cases=cases, width=4.0, height=3.2
    )
    every = [over for _, by_case in panels for over in by_case.values()]
    places, look = placed(every[0].axes[0], 34), looks(cases)
    flat = [ax for line in axes for ax in line]
    for ax, (heading, by_case) in zip(flat, panels, strict=False):
        for case, over in by_case.items():
            _curve(ax, over, places, look[case])
        first = next(iter(by_case.values()))
        ax.set_title(heading, loc="left")
        ax.set_ylabel(first.title)
        if first.is_ratio:
            ax.axhline(1, color="0.35", lw=1.0, zorder=1)
        places.apply(ax, "x")
        if places.ticks is not None:
            ax.set_xlim(0.6, len(places.positions) + 0.4)
    for ax in flat[len(panels) :]:
        ax.axis("off")
    spread = "; bands: one standard deviation either way" if any(np.isfinite(over.std).any() for over in every) else ""
    caption(figure, f"{words}{spread}.{_marks(every, 'Open grey markers')}{places.key}")
    return figure


def _curve(ax: Axes, over: OverSweep, places: Placed, look: Any) -> None:
    x, joined = places.positions, places.ticks is None
    mean, std, void = (values[places.order] for values in (over.mean, over.std, over.meaningless > 0))
    if joined:
        ax.fill_between(x, mean - std, mean + std, color=look.color, alpha=0.13, lw=0, zorder=1.5)
    elif np.isfinite(std).any():
        ax.errorbar(x, mean, yerr=std, fmt="none", ecolor=look.color, elinewidth=0.8, capsize=2)
    ax.plot(x, mean, color=look.color, ls=look.line if joined else "none", lw=1.6, zorder=2.5)
    size = 5 if len(x) <= 25 else 2.5
    ax.plot(x[~void], mean[~void], look.marker, color=look.color, ms=size, zorder=3)
    ax.plot(x[void], mean[void], look.marker, mfc="white", mec="0.45", ms=size + 1, zorder=3)


@styled
def draw_maps(evidence: Evidence, black: Sequence[str], headline: str, panels: Sequence[Panels], words: str) -> Figure:
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
    figure, axes = framed(
        evidence, black, len(blocks), columns, headline, cases=(), width=width + 0.3, height=height + 0.5
    )
    x, y = placed(across, int(11 * width), cells=True), placed(along, 12 * len(along), cells=True)
    for line, (heading, by_case, cases) in zip(axes, blocks, strict=True):
        norm = _norm(np.concatenate([over.mean.ravel() for over in by_case.values()]))
        for ax, case in zip(line, cases, strict=False):
            _map(ax, by_case[case], x, y, norm, first=ax is line[0])
            ax.set_title(f"{case}, {heading.lower()}", loc="left")
        for ax in line[len(cases) :]:
            ax.axis("off")
        bar = figure.colorbar(ScalarMappable(norm, COLOURS), ax=line[: len(cases)], pad=0.02, aspect=18)
        bar.set_label(next(iter(by_case.values())).title)
        if isinstance(norm, LogNorm):
            plain_log(bar.ax.yaxis)
    line_at_1 = any(over.is_ratio and max(over.mean.shape) > MOST_TICKS for over in every)
    grey = " Grey: no number." if any(np.isnan(over.mean).any() for over in every) else ""
    white = " White line: ratio 1." if line_at_1 else ""
    caption(figure, f"{words}.{_marks(every, 'Hatched')}{grey}{white}{x.key}{y.key}")
    return figure


def _norm(values: np.ndarray) -> Normalize:
    """The colour scale of all panels of a quantity."""
    low, high = span(values) if np.isfinite(values).any() else (0.0, 1.0)
    if low > 0 and high > LARGE_RANGE * low:
        return LogNorm(low, high)
    return Normalize(low, high if high > low else low + 1e-3 * max(abs(low), 1.0))


def _map(ax: Axes, over: OverSweep, x: Placed, y: Placed, norm: Normalize, *, first: bool) -> None:
    order = np.ix_(y.order, x.order)
    values, void = np.ma.masked_invalid(over.mean[order]), over.meaningless[order] > 0
    ax.grid(False)
    ax.set_facecolor("0.87")
    x.apply(ax, "x")
    y.apply(ax, "y", named=first, room=24)
    ax.pcolormesh(x.positions, y.positions, values, norm=norm, cmap=COLOURS, shading="nearest", rasterized=True)
    right, up = _edges(x.positions), _edges(y.positions)
    crossed = [Rectangle((right[j], up[i]), right[j + 1] - right[j], up[i + 1] - up[i]) for i, j in np.argwhere(void)]
    ax.add_collection(PatchCollection(crossed, facecolor="none", edgecolor="white", hatch="//", linewidth=0))
    if x.ticks is not None and y.ticks is not None:
        _print(ax, values, void, x, y, norm)
    elif over.is_ratio and min(values.shape) > 2 and values.count() and values.min() < 1 < values.max():
        ax.contour(x.positions, y.positions, values, levels=[1.0], colors="white", linewidths=1.2)
    ax.tick_params(length=3)


def _edges(places: np.ndarray) -> np.ndarray:
    """Where cells around places begin and end: half way to their neighbours."""
    half = np.diff(places) / 2
    return np.concatenate(([places[0] - half[0]], places[:-1] + half, [places[-1] + half[-1]]))


def _print(ax: Axes, values: np.ma.MaskedArray, void: np.ndarray, x: Placed, y: Placed, norm: Normalize) -> None:
    """The numbers in the cells, dark on light and light on dark; hatching ends before them."""
    for i, j in np.argwhere(~np.ma.getmaskarray(values)):
        colour = mpl.colormaps[COLOURS](norm(values[i, j]))
        dark = float(np.dot(colour[:3], (0.299, 0.587, 0.114))) < 0.5
        box = {"facecolor": colour, "edgecolor": "none", "pad": 0.8} if void[i, j] else None
        text, ink = digits(float(values[i, j]), 3), "white" if dark else "black"
        ax.text(x.positions[j], y.positions[i], text, ha="center", va="center", fontsize=7, color=ink, bbox=box)


def _marks(every: Sequence[OverSweep], mark: str) -> str:
    """What a mark of numbers without meaning says, in a sentence; "" where there are none."""
    reasons = "; ".join(dict.fromkeys(reason for over in every for reason in over.reasons))
    void = any(over.meaningless.any() for over in every)
    return f" {mark}: the numbers of some motions have no meaning, {reasons}." if void else ""
