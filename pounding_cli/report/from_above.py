"""The picture of a group from above: plans at their places along the street, frame lines, centres, links."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any

from pounding_cli.laws import is_damper, link_symbol
from pounding_cli.numbers import join_limited
from pounding_cli.report.document import Picture, Section
from pounding_cli.report.evidence import Evidence
from pounding_cli.report.plans import (
    LinkMark,
    PlanOutline,
    describe_marks,
    describe_outlines,
    find_facing_edge,
    format_shares,
    group_cases,
    has_plans,
    join_floors,
    read_outlines,
)
from pounding_cli.report.style import finish, is_for_page, new_figure, with_style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MOST_PANELS = 4
"""Groups of cases that are drawn, each with its own places of links; the others are named."""

MOST_PLANS = 6
"""Plans that stand side by side; a longer row goes on below, from the plan that ends it on."""

LEAST_GAP = 0.14
"""Least width at which a gap is drawn, over the mean width of the plans [-]: its links have room there."""

PANEL = (8.4, 3.6)
"""Largest width and height of the plans in a panel [in]."""

TEXT_WIDTH = 0.9
"""Room to the right of its marks that the text of an eccentricity takes [in]."""

LABEL_HEIGHT = 0.15
"""Height of the label of a frame line [in]: where two would cover each other, one is left out."""

SMALL_ECCENTRICITY = 0.004
"""Eccentricity over the width of a plan up to which its centres are drawn as one [-]."""

CaseGroup = tuple[list[str], list[LinkMark]]
"""Cases whose links stand alike, and the places of their links."""

_FLOOR = "0.96"
_LINE = "#0072B2"
_ACROSS = "#7A7A7A"
_SHARED = "#E69F00"
_STRIKE = "#C0392B"
_JOIN = "#7B3294"
_MASS = "black"
_STIFFNESS = "#009E73"


@dataclass(frozen=True)
class PlacedPlan:
    """A plan at its place in the picture.

    left, right : where its edges stand along the row [m]; gaps are drawn wider than they are
    """

    outline: PlanOutline
    left: float
    right: float

    @property
    def middle(self) -> float:
        """The middle along the row [m], where its centres are drawn."""
        return 0.5 * (self.left + self.right)


@dataclass(frozen=True)
class Panel:
    """Plans that stand side by side in the picture, with the links of some cases between them.

    cases : whose links stand alike
    marks : their links; neighbours are counted within the panel
    """

    cases: list[str]
    marks: list[LinkMark]
    plans: list[PlacedPlan]

    @property
    def width(self) -> float:
        """How far it reaches along the row [m]."""
        return self.plans[-1].right - self.plans[0].left


def list_plan_sections(evidence: Evidence) -> list[Section]:
    """Return the section of a page with the group from above; none where no building has a plan."""
    if not has_plans(evidence):
        return []
    outlines = read_outlines(evidence)
    groups = group_cases(evidence, outlines)
    text = f"The group from above. {describe_outlines(outlines)} "
    for cases, marks in _choose_groups(groups, len(outlines)):
        text += f"{', '.join(cases)}: {describe_marks(outlines, marks)} "
    picture = Picture("from-above", "The group from above, to scale", text.strip(), partial(draw_from_above, evidence))
    return [Section("From above", pictures=[picture])]


def _choose_groups(groups: Sequence[CaseGroup], buildings: int) -> list[CaseGroup]:
    """Return the groups of cases that are drawn: those with links, where there are some; fewer of a long row."""
    linked = [(cases, marks) for cases, marks in groups if marks]
    return (linked or list(groups))[: max(1, MOST_PANELS // len(_split_row(buildings)))]


def _split_row(buildings: int) -> list[slice]:
    """Return the buildings that stand side by side: all, or parts of a long row of which two share their end."""
    parts = max(1, math.ceil((buildings - 1) / (MOST_PLANS - 1)))
    step = max(1, math.ceil((buildings - 1) / parts))
    return [slice(first, first + step + 1) for first in range(0, max(1, buildings - 1), step)]


def _list_panels(outlines: Sequence[PlanOutline], groups: Sequence[CaseGroup]) -> list[Panel]:
    """Return the panels of some groups of cases, those of a long row in parts."""
    panels = []
    for cases, marks in groups:
        for part in _split_row(len(outlines)):
            inside = range(part.start, min(part.stop, len(outlines)) - 1)
            own = [replace(mark, left=mark.left - part.start) for mark in marks if mark.left in inside]
            panels.append(Panel(cases, own, _place_plans(outlines[part], own)))
    return panels


@with_style
def draw_from_above(evidence: Evidence) -> Figure:
    """Return the plans of a group from above, a panel for all cases whose links stand alike."""
    outlines = read_outlines(evidence)
    groups = group_cases(evidence, outlines)
    panels = _list_panels(outlines, _choose_groups(groups, len(outlines)))
    across = max(panel.width for panel in panels)
    low = min(outline.low for outline in outlines)
    high = max(outline.high for outline in outlines)
    inches = min(PANEL[0] / across, PANEL[1] / (high - low))  # a metre
    width = max(inches * across + 1.0, 6.6)  # the legend has room
    handles, labels = zip(*_list_handles(outlines, [mark for panel in panels for mark in panel.marks]), strict=True)
    columns = 2 if width < 8.0 else 3
    legend = 0.2 * -(-len(handles) // columns) + 0.1
    height = inches * (high - low) + 1.45
    figure = new_figure(width, len(panels) * height + legend + (0.2 if is_for_page() else 1.0))
    *axes, below = figure.subplots(len(panels) + 1, 1, height_ratios=[*[height] * len(panels), legend])
    for ax, panel in zip(axes, panels, strict=True):
        _draw_panel(ax, panel, evidence, 1.0 / inches)
        ax.set(xlim=(-0.06 / inches, across + 0.06 / inches), ylim=(low - 0.06 / inches, high + 0.06 / inches))
        for plan in panel.plans:
            _name_plan(ax, plan, low, evidence)
        title = join_limited(panel.cases, int(11 * width)) if len(evidence.cases) > 1 else " "
        heads = [_head_lines(_marks_between(panel.marks, left), evidence) for left in range(len(panel.plans))]
        ax.set_title(title, loc="left", pad=5 + 9.5 * max(map(len, heads)))
    axes[-1].set_xlabel("along the row, the way of the ground motion  →", labelpad=30)
    below.axis("off")
    below.legend(
        handles, labels, loc="center left", ncols=columns, fontsize=8, handlelength=2.2, columnspacing=1.4,
        borderaxespad=0,
    )  # fmt: skip
    finish(figure, f"From above: {evidence.title}", _build_caption(evidence, outlines, groups))
    return figure


def _place_plans(outlines: Sequence[PlanOutline], marks: Sequence[LinkMark]) -> list[PlacedPlan]:
    """Return the plans side by side along the row, with room for the links between them."""
    room = LEAST_GAP * sum(outline.width for outline in outlines) / len(outlines)
    placed: list[PlacedPlan] = []
    for number, outline in enumerate(outlines):
        gaps = [gap for mark in marks if mark.left == number - 1 for gap in mark.gaps]
        left = placed[-1].right + max(room, *gaps) if placed and gaps else placed[-1].right + room if placed else 0.0
        placed.append(PlacedPlan(outline, left, left + outline.depth))
    return placed


def _draw_panel(ax: Axes, panel: Panel, evidence: Evidence, inch: float) -> None:
    """Draw the plans with the links of some cases.

    inch : metres that an inch on paper stands for
    """
    from matplotlib.ticker import MaxNLocator

    placed = panel.plans
    for each in placed:
        _draw_plan(ax, each, inch)
    for left in range(len(placed) - 1):
        _draw_links(ax, placed[left], placed[left + 1], _marks_between(panel.marks, left), evidence)
    ax.set_aspect("equal")
    ax.grid(False)
    ax.spines["bottom"].set_visible(False)
    ax.set_xticks([])
    ax.yaxis.set_major_locator(MaxNLocator(6, steps=(1, 2, 5, 10)))
    ax.set_ylabel("along the street [m]  →")


def _draw_plan(ax: Axes, placed: PlacedPlan, inch: float) -> None:
    """Draw one plan with its frame lines and centres."""
    from matplotlib.patches import Rectangle

    outline = placed.outline
    is_guess = bool(outline.depth_source) or not (outline.has_plan or outline.is_wall)
    ax.add_patch(
        Rectangle(
            (placed.left, outline.low), outline.depth, outline.width, facecolor="0.85" if outline.is_wall else _FLOOR,
            edgecolor="0.25", lw=1.0, ls=(0, (5, 3)) if is_guess else "-", hatch="////" if outline.is_wall else None,
            label=outline.name,
        )
    )  # fmt: skip
    for line in outline.across:
        x = placed.middle + line.place
        ax.plot(
            [x, x],
            [outline.low, outline.high],
            color=_ACROSS,
            lw=_thickness(line.share),
            solid_capstyle="butt",
            zorder=2,
        )
    labelled = -math.inf
    for line in sorted(outline.lines, key=lambda line: line.place):
        ends = [placed.left, placed.right]
        ax.plot(ends, [line.place] * 2, color=_LINE, lw=_thickness(line.share), solid_capstyle="butt", zorder=2.2)
        is_above = line.place + 0.2 * inch <= outline.high
        away = 2.5 + 0.5 * _thickness(line.share)
        label = line.place + (away / 72 if is_above else -away / 72 - LABEL_HEIGHT) * inch
        if label < labelled + LABEL_HEIGHT * inch:
            continue  # the labels of lines so close would cover each other
        labelled = label
        ax.annotate(
            f"{line.name}: {format_shares(line)}", (placed.left, line.place), xytext=(4, away if is_above else -away),
            textcoords="offset points", va="bottom" if is_above else "top", fontsize=7.5, color=_LINE, zorder=5,
            bbox={"facecolor": _FLOOR, "edgecolor": "none", "pad": 0.6},
        )  # fmt: skip
    if outline.has_plan:
        _draw_centres(ax, placed, inch)


def _thickness(share: float) -> float:
    """Return the thickness of a frame line in a picture [pt], which grows with its share of the stiffness."""
    return 0.8 + 6.0 * share


def _draw_centres(ax: Axes, placed: PlacedPlan, inch: float) -> None:
    """Draw the centre of mass, those of stiffness, and the distance between them."""
    outline = placed.outline
    x = placed.middle
    centres = outline.stiffness_centres
    if max(centres) - min(centres) > SMALL_ECCENTRICITY * outline.width:  # storeys differ
        ax.plot([x, x], [min(centres), max(centres)], color=_STIFFNESS, lw=1.2, zorder=3)
    mean = outline.centre + outline.eccentricity
    ax.plot([x], [mean], "s", ms=7, mfc="white", mec=_STIFFNESS, mew=1.8, zorder=3.2)
    ax.plot([x], [outline.centre], "o", ms=8, mfc="none", mec=_MASS, mew=1.3, zorder=3.4)
    ax.plot([x], [outline.centre], "+", ms=8, color=_MASS, mew=1.1, zorder=3.4)
    distance = abs(outline.eccentricity)
    if distance <= SMALL_ECCENTRICITY * outline.width:
        return
    text = f"{distance:.2g} m, {100 * distance / outline.width:.2g} %"
    words: dict[str, Any] = {"textcoords": "offset points", "fontsize": 7.5, "zorder": 6}
    if placed.right - x < TEXT_WIDTH * inch:  # beside the marks it would reach beyond the plan
        spot = (placed.right, max(mean, outline.centre))
        words |= {"xytext": (-4, 6), "ha": "right", "va": "bottom"}
        words["bbox"] = {"facecolor": _FLOOR, "edgecolor": "none", "pad": 0.6}
    else:
        spot = (x, 0.5 * (mean + outline.centre))
        words |= {"xytext": (9, 0), "va": "center"}
    ax.annotate(text, spot, **words)
    if distance > 0.2 * inch:  # the arrow shows between the marks
        arrow = {"arrowstyle": "<->", "lw": 0.8, "shrinkA": 5, "shrinkB": 5}
        ax.annotate("", (x, mean), xytext=(x, outline.centre), arrowprops=arrow)


def _name_plan(ax: Axes, placed: PlacedPlan, low: float, evidence: Evidence) -> None:
    """Write name and size of a building below the plans.

    low : lowest edge of all plans along the street [m]
    """
    outline = placed.outline
    if outline.is_wall:
        size = "wall"
    elif not outline.has_plan:
        size = "no plan"
    else:
        depth = f"≈ {outline.depth:.2g}" if outline.depth_source else f"{outline.depth:.3g}"
        size = f"{outline.width:.3g} m × {depth} m"
    ax.annotate(
        f"{outline.name}\n{size}", (placed.middle, low), xytext=(0, -8), textcoords="offset points", ha="center",
        va="top", fontsize=8, annotation_clip=False,
    )  # fmt: skip


def _draw_links(
    ax: Axes, left: PlacedPlan, right: PlacedPlan, marks: Sequence[LinkMark], evidence: Evidence
) -> None:  # fmt: skip
    """Draw the links between two neighbours, and the edge that they share."""
    if not marks:
        return
    low, high = find_facing_edge(left.outline, right.outline)
    middle = 0.5 * (left.right + right.left)
    if low < high:
        for x in (left.right, right.left):
            ax.plot([x, x], [low, high], color=_SHARED, lw=3.0, solid_capstyle="butt", zorder=2.6)
    for mark in marks:
        alike = [other for other in marks if _stand_together(mark, other)]
        part = (alike.index(mark) + 1) / (len(alike) + 1)  # of the gap: kinds at one place stand side by side
        _draw_mark(ax, mark, (left.right, right.left), part)
    top = max(left.outline.high, right.outline.high)
    ax.annotate(
        "\n".join(_head_lines(marks, evidence)), (middle, top), xytext=(0, 7), textcoords="offset points", ha="center",
        va="bottom", fontsize=7.5, annotation_clip=False,
    )  # fmt: skip


def _marks_between(marks: Sequence[LinkMark], left: int) -> list[LinkMark]:
    """Return the links between a building and its neighbour to the right.

    left : number of the building
    """
    return [mark for mark in marks if mark.left == left]


def _stand_together(one: LinkMark, other: LinkMark) -> bool:
    """Return whether links between the same neighbours stand at one place."""
    return (one.left_place, one.right_place) == (other.left_place, other.right_place)


def _head_lines(marks: Sequence[LinkMark], evidence: Evidence) -> list[str]:
    """Return what stands above a gap: its width, and the floors that are linked, kind by kind where these differ."""
    if not marks:
        return []
    unit = evidence.unit("gap")
    gaps = dict.fromkeys(unit.text(gap, 3) for mark in marks for gap in mark.gaps)
    lines = [f"gap {join_limited(gaps, 20)}"]
    places: dict[tuple[str, tuple[str, ...]], list[float]] = {}
    for mark in marks:
        places.setdefault((mark.kind, mark.floors), []).append(mark.left_place)
    kinds = [kind for kind, _ in places]
    for (kind, floors), own in places.items():
        line = join_floors(floors)
        if len(set(kinds)) > 1:
            line = f"{kind}: {line}"
        if kinds.count(kind) > 1:
            line += f" at {', '.join(f'{place:.3g}' for place in own)} m"
        lines.append(line)
    return lines


def _draw_mark(ax: Axes, mark: LinkMark, faces: tuple[float, float], part: float) -> None:
    """Draw the links at one place: a star where floors strike, a bar where they are joined, a block that fills a gap.

    faces : where both floors end along the row [m]
    part : of the way from the left face to the right one, at which its mark is drawn [-]
    """
    symbol = link_symbol(mark.kind)
    places = [mark.left_place, mark.right_place]
    color = _STRIKE if symbol == "gap" else _JOIN
    x = (1.0 - part) * faces[0] + part * faces[1]
    y = (1.0 - part) * places[0] + part * places[1]
    fill = "white" if mark.is_whole else color
    if symbol == "gap":
        if places[0] != places[1]:
            ax.plot(faces, places, color=color, lw=1.0, ls=":", zorder=3)
        ax.plot([x], [y], "*", ms=11, mfc=fill, mec=color, mew=1.0, zorder=4)
        return
    ax.plot(faces, places, color=color, lw=2.2 if symbol == "bar" else 6.0, solid_capstyle="butt", zorder=3.6)
    marker = "s" if is_damper(mark.kind) else "o"
    if symbol == "bar":
        ax.plot([x], [y], marker, ms=5, mfc=fill, mec=color, zorder=4)


def _list_handles(outlines: Sequence[PlanOutline], marks: Sequence[LinkMark]) -> list[tuple[Any, str]]:
    """Return the entries of the legend, of what is drawn and nothing else, and their texts."""
    from matplotlib.lines import Line2D

    ring = Line2D([], [], ls="none", marker="o", ms=8, mfc="none", mec=_MASS, mew=1.3)
    cross = Line2D([], [], ls="none", marker="+", ms=8, color=_MASS, mew=1.1)
    square = Line2D([], [], ls="none", marker="s", ms=7, mfc="white", mec=_STIFFNESS, mew=1.8)
    handles: list[tuple[Any, str]] = [
        (Line2D([], [], color=_LINE, lw=4), "frame line, its number: share of the stiffness"),
        ((ring, cross), "centre of mass"),
        (square, "centre of stiffness"),
    ]
    if any(outline.across for outline in outlines):
        handles.insert(1, (Line2D([], [], color=_ACROSS, lw=3), "line across the row"))
    if marks:
        handles.append((Line2D([], [], color=_SHARED, lw=3), "edge shared with the neighbour"))
    for kind in dict.fromkeys(mark.kind for mark in marks):
        symbol = link_symbol(kind)
        if symbol == "gap":
            look: dict[str, Any] = {"ls": "none", "marker": "*", "ms": 11, "color": _STRIKE}
        else:
            look = {"lw": 2.2 if symbol == "bar" else 6, "color": _JOIN}
            if symbol == "bar":
                look |= {"marker": "s" if is_damper(kind) else "o", "ms": 5}
        handles.append((Line2D([], [], **look), kind))
    return handles


def _build_caption(evidence: Evidence, outlines: Sequence[PlanOutline], groups: Sequence[CaseGroup]) -> str:
    """Return what a reader must know of the picture."""
    sentences = ["To scale, except gaps, which are drawn wider so that their links can be seen."]
    for outline in outlines:
        if outline.depth_source and outline.has_plan:
            sentences.append(f"The study has no depth of {outline.name}: drawn dashed, {outline.depth_source}.")
    plain = [outline.name for outline in outlines if not outline.has_plan and not outline.is_wall]
    if plain:
        names = ", ".join(plain)
        sentences.append(f"No plan of {names}: drawn dashed, as wide as its neighbour and as deep as the others.")
    shown = _choose_groups(groups, len(outlines))
    if any(mark.is_whole for _, marks in shown for mark in marks):
        sentences.append("Open marks: these floors do not twist, so their links stand for the whole edge.")
    for cases, marks in groups:
        if (cases, marks) not in shown:
            has_links = "further places of links, not drawn" if marks else "no links"
            sentences.append(f"{join_limited(cases, 200)}: {has_links}.")
    if len(_split_row(len(outlines))) > 1:
        sentences.append("The row goes on below, from the plan that ends it on.")
    if evidence.label:
        sentences.append(f"Point of the sweep: {evidence.label}.")
    return " ".join(sentences)
