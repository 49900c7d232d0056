"""The plans of the buildings of a group as pictures show them: outlines, frame lines, centres, and places of links."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli.numbers import format_range, join_limited
from pounding_cli.report.evidence import Evidence

if TYPE_CHECKING:
    import xarray as xr

USUAL_DEPTH = 0.7
"""Depth over the width of a plan of which nothing tells the depth [-]."""

WALL_DEPTH = 0.12
"""Depth of a wall over the mean depth of the buildings [-]."""


@dataclass(frozen=True)
class PlanLine:
    """A frame line of a plan.

    name : as tables number it
    place : of a line along the row its y along the street, of one across the row its x from the centre of mass [m]
    shares : least and most of its parts of the stiffness of all lines the same way, storey by storey [-]
    yield_drifts : of its storeys [m], inf where it cannot yield, shape (storeys,)
    """

    name: str
    place: float
    shares: tuple[float, float]
    yield_drifts: np.ndarray

    @property
    def share(self) -> float:
        """The mean part of the stiffness [-]."""
        return 0.5 * sum(self.shares)


@dataclass(frozen=True)
class PlanOutline:
    """A building from above; places are along the street [m].

    low, high : edges of the plan
    depth : along the row [m]
    centre : of mass; NaN of a building without a plan, whose floors do not twist
    stiffness_centres : of every storey; none without a plan
    depth_source : "" where the study has the depth, else where its guess comes from
    is_wall : True of a wall
    """

    name: str
    low: float
    high: float
    depth: float
    centre: float = math.nan
    stiffness_centres: tuple[float, ...] = ()
    lines: Sequence[PlanLine] = ()
    across: Sequence[PlanLine] = ()
    depth_source: str = ""
    is_wall: bool = False

    @property
    def has_plan(self) -> bool:
        """True where the study has a plan of it."""
        return not math.isnan(self.centre)

    @property
    def width(self) -> float:
        """Width along the street [m]."""
        return self.high - self.low

    @property
    def eccentricity(self) -> float:
        """Mean place of the centres of stiffness from the centre of mass [m]."""
        return float(np.mean(self.stiffness_centres)) - self.centre


@dataclass(frozen=True)
class LinkMark:
    """Links of one kind between two neighbours at one place along the street.

    left : number of the left neighbour
    left_place, right_place : where its ends stand along the street [m]
    floors : as texts, from the ground up
    gaps : of the cases that it stands for [m]
    is_whole : True where the floors do not twist, so that the links stand for the whole edge
    """

    left: int
    kind: str
    left_place: float
    right_place: float
    floors: tuple[str, ...]
    gaps: tuple[float, ...]
    is_whole: bool


def has_plans(evidence: Evidence) -> bool:
    """Return whether some building of the group has a plan."""
    return "plan_low" in evidence.results.arrays and bool(np.isfinite(evidence.values("plan_low")).any())


def read_outlines(evidence: Evidence) -> list[PlanOutline]:
    """Return the buildings of a group from above, left to right; some of them must have a plan."""
    known = {
        name: _read_outline(evidence, number, name)
        for number, name in enumerate(evidence.group)
        if np.isfinite(evidence.values("plan_low")[number])
    }
    depth = float(np.mean([outline.depth for outline in known.values()]))
    outlines = []
    for number, name in enumerate(evidence.group):
        if name in known:
            outlines.append(known[name])
            continue
        nearest = _find_nearest(evidence.group, number, known)
        low = min(known[other].low for other in nearest)
        high = max(known[other].high for other in nearest)
        is_wall = name in evidence.results.walls
        its_depth = WALL_DEPTH * depth if is_wall else depth
        source = "" if is_wall else "as deep as the others, on the mean"
        outlines.append(PlanOutline(name, low, high, its_depth, depth_source=source, is_wall=is_wall))
    return outlines


def _find_nearest(group: Sequence[str], number: int, known: Mapping[str, PlanOutline]) -> list[str]:
    """Return the names with a known plan that stand nearest to a place of the group, one or both sides of it."""
    distances = {name: abs(place - number) for place, name in enumerate(group) if name in known}
    return [name for name, distance in distances.items() if distance == min(distances.values())]


def _read_outline(evidence: Evidence, number: int, name: str) -> PlanOutline:
    """Return a building with a plan from above.

    number : of the building in the group
    """
    low, high, centre = (float(evidence.values(key)[number]) for key in ("plan_low", "plan_high", "plan_centre"))
    centres = evidence.values("stiffness_centre")[number]
    depth, source = _find_depth(evidence, number, high - low)
    y = evidence.values("line_street")[number]
    x = evidence.values("line_x")[number]
    return PlanOutline(
        name, low, high, depth, centre, tuple(centres[np.isfinite(centres)].tolist()), _read_lines(evidence, number, y),
        _read_lines(evidence, number, x), source,
    )  # fmt: skip


def _find_depth(evidence: Evidence, number: int, width: float) -> tuple[float, str]:
    """Return the depth of a plan [m], and where its guess comes from; "" where the study has it."""
    building = evidence.results.study_data["group"][number]
    plan = evidence.building_of_study(evidence.group[number]).get("plan") or {}
    written = evidence.point.get(f"buildings.{building}.plan.depth", plan.get("depth"))
    if written is not None:
        return float(written), ""
    rows = evidence.buildings[evidence.buildings["building"] == evidence.group[number]]
    square = 12.0 * float(evidence.values("inertia")[number][0] / rows["mass"].iloc[0]) - width**2
    if 0.2 * width < math.sqrt(max(square, 0.0)) < 5.0 * width:
        return math.sqrt(square), "that of a rectangle of this width with its rotary inertia"
    return USUAL_DEPTH * width, f"{100 * USUAL_DEPTH:g} % of its width"


def _read_lines(evidence: Evidence, number: int, places: np.ndarray) -> list[PlanLine]:
    """Return the frame lines of a building that have a place; their shares add up to 1.

    places : of all of its lines, NaN of those the other way, shape (lines,)
    """
    stiffness = evidence.values("line_stiffness")[number]  # storeys, lines
    stiffness = stiffness[np.isfinite(stiffness).any(axis=1)]
    shear = evidence.values("line_yield_shear")[number][: len(stiffness)]
    chosen = np.flatnonzero(np.isfinite(places))
    if not chosen.size:
        return []
    shares = stiffness / stiffness[:, chosen].sum(axis=1, keepdims=True)
    lines = []
    for column in chosen:
        least, most = float(shares[:, column].min()), float(shares[:, column].max())
        drifts = shear[:, column] / stiffness[:, column]
        lines.append(PlanLine(str(column + 1), float(places[column]), (least, most), drifts))
    return lines


def read_marks(evidence: Evidence, case: str, outlines: Sequence[PlanOutline]) -> list[LinkMark]:
    """Return where the links of a case stand, those of several floors at one place together."""
    data = evidence.data.sel(case=case)
    is_still = _find_still(data, len(outlines))
    floors: dict[tuple[Any, ...], list[str]] = {}
    for number in np.flatnonzero(data["kind"].values != ""):
        link = data.isel(link=number)
        left = evidence.group.index(str(link["link_left"].item()))
        is_whole = bool(np.isnan(link["street"].item())) or (is_still[left] and is_still[left + 1])
        ends = find_link_ends(link, outlines[left], outlines[left + 1])
        if is_whole:
            ends = (_find_middle(outlines[left], outlines[left + 1]),) * 2
        place = (left, str(link["kind"].item()), *ends, (float(link["gap"].item()),), is_whole)
        floors.setdefault(place, []).append(_name_floors(link))
    return [
        LinkMark(left, kind, first, second, tuple(dict.fromkeys(names)), gaps, is_whole)
        for (left, kind, first, second, gaps, is_whole), names in floors.items()
    ]


def find_link_ends(link: xr.Dataset, left: PlanOutline, right: PlanOutline) -> tuple[float, float]:
    """Return the places of both ends of a link along the street [m], rounded to a micrometre.

    Where floors do not twist it is drawn in the middle of the edge that they share.
    """
    y = float(link["street"].item())
    if math.isnan(y):
        middle = _find_middle(left, right)
        return middle, middle
    ends = []
    for side, outline in (("left_arm", left), ("right_arm", right)):
        ends.append(outline.centre + float(link[side].item()) if outline.has_plan else math.nan)
    first, second = (y if math.isnan(end) else end for end in ends)
    if math.isnan(ends[1]):
        second = first
    if math.isnan(ends[0]):
        first = second
    return round(first, 6), round(second, 6)


def _find_middle(left: PlanOutline, right: PlanOutline) -> float:
    """Return the middle of the edge that two neighbours share, along the street [m]."""
    return 0.5 * sum(find_facing_edge(left, right))


def _find_still(data: xr.Dataset, buildings: int) -> list[bool]:
    """Return of every building whether its floors do not twist in a case, though other numbers are there."""
    if "twist" not in data or not np.isfinite(data["twist"].values).any():
        return [False] * buildings
    twist = np.abs(np.nan_to_num(data["twist"].transpose("building", ...).values))
    return [not each.any() for each in twist]


def _name_floors(link: xr.Dataset) -> str:
    """Return the floors of a link as a text."""
    left = int(link["link_floor"].item())
    right = int(link["link_right_floor"].item())
    return str(left or "base") if left == right else f"{left} | {right}"


def find_facing_edge(left: PlanOutline, right: PlanOutline) -> tuple[float, float]:
    """Return both ends of the edge that two neighbours share, along the street [m].

    The first is above the second where they share none.
    """
    return max(left.low, right.low), min(left.high, right.high)


def join_floors(floors: Sequence[str]) -> str:
    """Return floors in words: "floor 3", "floors 1 to 3", "base and floors 1, 3"."""
    if floors[0] == "base":
        return f"base and {join_floors(floors[1:])}" if floors[1:] else "base"
    if len(floors) == 1:
        return f"floor {floors[0]}"
    numbers = [int(floor) for floor in floors if floor.isdecimal()]
    is_row = len(numbers) == len(floors) and np.all(np.diff(numbers) == 1)
    if is_row and len(floors) > 2:
        return f"floors {floors[0]} to {floors[-1]}"
    return f"floors {', '.join(floors)}"


def group_cases(evidence: Evidence, outlines: Sequence[PlanOutline]) -> list[tuple[list[str], list[LinkMark]]]:
    """Return the cases whose links stand alike, but for their gaps, together with the places of their links."""
    groups: dict[tuple[LinkMark, ...], list[str]] = {}
    gaps: dict[tuple[LinkMark, ...], list[tuple[float, ...]]] = {}
    for case in evidence.plotted_cases:
        marks = read_marks(evidence, case, outlines)
        alike = tuple(replace(mark, gaps=()) for mark in marks)
        groups.setdefault(alike, []).append(case)
        known = gaps.setdefault(alike, [()] * len(marks))
        gaps[alike] = [(*before, *mark.gaps) for before, mark in zip(known, marks, strict=True)]
    return [
        (cases, [replace(mark, gaps=tuple(dict.fromkeys(each))) for mark, each in zip(alike, gaps[alike], strict=True)])
        for alike, cases in groups.items()
    ]


def describe_outlines(outlines: Iterable[PlanOutline]) -> str:
    """Return the plans in words, for readers who do not see them."""
    return " ".join(_describe_outline(outline) for outline in outlines)


def _describe_outline(outline: PlanOutline) -> str:
    if outline.is_wall:
        return f"{outline.name}: a wall."
    if not outline.has_plan:
        return f"{outline.name}: no plan."
    lines = [f"line {line.name} at {line.place:.3g} m with {format_shares(line)}" for line in outline.lines]
    lines += [f"line {line.name} across the row" for line in outline.across]
    return (
        f"{outline.name}: from {outline.low:.4g} to {outline.high:.4g} m along the street, {outline.depth:.3g} m deep; "
        f"centre of mass at {outline.centre:.3g} m, of stiffness at {outline.centre + outline.eccentricity:.3g} m; "
        f"{join_limited(lines, 400)}."
    )


def describe_marks(outlines: Sequence[PlanOutline], marks: Iterable[LinkMark]) -> str:
    """Return places of links in words, for readers who do not see them."""
    sentences = []
    for mark in marks:
        pair = f"{outlines[mark.left].name} | {outlines[mark.left + 1].name}"
        place = "along the shared edge" if mark.is_whole else f"at {mark.left_place:.3g} m"
        sentences.append(f"{pair}, {join_floors(mark.floors)}: {mark.kind} {place}.")
    return " ".join(sentences) or "No links."


def format_shares(line: PlanLine) -> str:
    """Return the part of the stiffness that a line has: "63 %", "60 to 63 %" where storeys differ."""
    least, most = line.shares
    return f"{format_range(100 * least, 100 * most, '.0f')} %"
