"""The buildings of a study in their places, and where neighbours meet."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

from pounding_cli.errors import InputError, Issue
from pounding_cli.model.building import Building
from pounding_cli.model.links import BASE
from pounding_cli.model.meetings import find_meetings
from pounding_cli.model.wall import MIN_HEIGHT, Wall
from pounding_cli.numbers import join_limited, pluralize
from pounding_cli.study.construct.link_places import Meeting
from pounding_cli.study.schema.quantity import StoreyMultiple
from pounding_cli.study.text.file import nearest

MAX_IN_GROUP = 20

COLUMNS_HINT = (
    "or write `columns:`, what part of a storey's stiffness and yield shear the columns have that the other's slab "
    "strikes, e.g. `columns: 20 %`"
)
"""What to write where slabs strike columns."""


@dataclass(frozen=True, eq=False)
class Group:
    """The buildings in their places.

    buildings : left to right, by the names of their places
    types : building types by name
    """

    buildings: tuple[Building, ...]
    types: Mapping[str, Building]

    @cached_property
    def meetings(self) -> tuple[Meeting, ...]:
        """The meeting of every two neighbours, left to right."""
        return tuple(Meeting.of(*pair) for pair in pairwise(self.buildings))

    def stiffness(self, given: float | StoreyMultiple) -> float:
        """Return a stiffness, or a multiple of that of a storey, in N/m.  Raises KeyError: no such building."""
        if not isinstance(given, StoreyMultiple):
            return given
        named = self.buildings if given.building is None else (self.types[given.building],)
        frames = [building for building in named if not isinstance(building, Wall)] or named
        storeys = [building.stiffness.tolist() for building in frames]
        if given.which == "stiffest":
            return given.factor * max(map(max, storeys))
        return given.factor * max(sum(stiffness) / len(stiffness) for stiffness in storeys)


def build_group(names: Sequence[str], types: Mapping[str, Building]) -> Group:
    """Return the buildings in their places; a wall without a height of its own is as high as its neighbours.

    names : of the types, left to right
    """
    placed = [
        types[name] if types[name].name == label else replace(types[name], name=label)
        for name, label in zip(names, unique_names(names), strict=True)
    ]
    return Group(tuple(_raise_walls(placed)), types)


def _raise_walls(row: Sequence[Building]) -> Iterator[Building]:
    """Yield the buildings of a row; a wall without a height of its own is as high as the higher of its neighbours."""
    for place, building in enumerate(row):
        if isinstance(building, Wall):
            beside = row[max(place - 1, 0) : place + 2]
            roofs = (float(each.elevation[-1]) for each in beside if not isinstance(each, Wall))
            yield building.raise_to(max(roofs, default=MIN_HEIGHT))
        else:
            yield building


def unique_names(names: Sequence[str]) -> tuple[str, ...]:
    """Return names by place: a type that stands more than once is told apart by a number (soft-1, soft-2)."""
    return tuple(
        f"{name}-{list(names[: place + 1]).count(name)}" if list(names).count(name) > 1 else name
        for place, name in enumerate(names)
    )


def check_group_names(names: Sequence[str], defined: Sequence[str]) -> Sequence[str]:
    """Return the names of a group.  Raises InputError: too few or many, or one that is not defined."""
    labels = unique_names(names)
    if not 2 <= len(names) <= MAX_IN_GROUP:
        example = ", ".join((*defined, *defined)[:2])
        hint = f"name 2 to {MAX_IN_GROUP}, e.g. `group: [{example}]`; each alone is computed anyway"
        message = f"the group has {pluralize(len(names), 'building')}: pounding takes two"
        raise InputError([Issue(("group",), message, hint)])
    issues = []
    for place, (name, label) in enumerate(zip(names, labels, strict=True)):
        if name not in defined:
            issues.append(Issue(("group", place), f"no building '{name}' is defined", nearest(name, defined)))
        if labels.index(label) != place:
            message = f"two places of the group are called '{label}'"
            issues.append(Issue(("group", place), message, "give the building another name"))
    if issues:
        raise InputError(issues)
    return names


def check_meetings(group: Group, linked_pairs: Collection[int] = ()) -> Group:
    """Return the group unchanged.

    A wall may stand beside a building that does not reach it, if it meets its other neighbour.

    linked_pairs : pairs from 0 whose floors a link of a case names, wherever they are

    Raises
    ------
    InputError : two neighbours cannot strike each other, and no link joins them, or two walls stand side by side
    """
    issues = []
    for place, meeting in enumerate(group.meetings):
        pair = group.buildings[place : place + 2]
        names = f"{meeting.left.name} and {meeting.right.name}"
        walls = [building for building in pair if isinstance(building, Wall)]
        if len(walls) == 2:
            message = f"{names} are two walls side by side: no building stands between them"
            hint = "leave one out: a wall can be struck from both sides"
            issues.append(Issue(("group", place + 1), message, hint))
        elif not (walls or meeting.floors or meeting.strikes or place in linked_pairs):
            levels = (join_limited((f"{elevation:g}" for elevation in each.elevation), 60) for each in pair)
            message = f"{names} have no floor at one elevation: {' against '.join(levels)} m"
            hint = f"let the storey heights agree somewhere; {COLUMNS_HINT}; "
            hint += "or name both ends of links, `floors: [[2, 3]]`"
            issues.append(Issue(("group", place + 1), message, hint))
    for place, building in enumerate(group.buildings):
        if isinstance(building, Wall) and not any(
            each.floors for each in group.meetings[max(place - 1, 0) : place + 1]
        ):
            issues += _find_wall_issues(group, place, building)
    if issues:
        raise InputError(issues)
    return group


def _find_wall_issues(group: Group, place: int, wall: Wall) -> list[Issue]:
    """Return the issue of a wall that no floor meets; none where another wall stands beside it."""
    beside = [*group.buildings[max(place - 1, 0) : place], *group.buildings[place + 1 : place + 2]]
    if any(isinstance(building, Wall) for building in beside):
        return []
    height = float(wall.height[0])
    reach = f"reaches {height:g} m above the ground" if height > MIN_HEIGHT else "ends at the ground"
    lowest = " and ".join(f"the lowest floor of {each.name} is at {each.elevation[0]:g} m" for each in beside)
    message = f"no floor meets the wall {wall.name}, which {reach}: {lowest}"
    hint = "write a higher wall, or one without `height:`; a base that moves meets every wall"
    return [Issue(("group", place), message, hint)]


def find_ignored_blows(group: Group) -> Iterator[Issue]:
    """Yield every pair of neighbours whose slabs strike columns of which nothing is known."""
    for place, pair in enumerate(pairwise(group.buildings)):
        floors, strikes = find_meetings(*pair)
        unknown = [strike for strike in strikes if pair[strike.side].columns is None]
        if unknown:
            slabs = join_limited(f"floor {strike.slab} of {pair[1 - strike.side].name}" for strike in unknown)
            struck = " and ".join(sorted({pair[strike.side].name for strike in unknown}))
            where = f"meet at {pluralize(len(floors), 'floor')} only" if floors else "meet at no floor"
            message = f"{pair[0].name} and {pair[1].name} {where}: blows on columns are left out of {slabs}"
            hint = f"give both the same `height:`, a `slab:` thick enough to meet, {COLUMNS_HINT} in {struck}"
            hint += "; `columns: none` where walls stand there"
            yield Issue(("group", place + 1), message, hint, code="blows")


def format_meetings(group: Sequence[Building]) -> list[str]:
    """Return every meeting of neighbours, a line each from the ground up.

    These are slabs that meet, slabs that strike columns, and blows that are left out. Floors that all meet those of
    their number share a line.
    """
    lines = []
    for left, right in pairwise(group):
        pair = f"{left.name}|{right.name}  "
        floors, strikes = find_meetings(left, right)
        if isinstance(left, Wall) or isinstance(right, Wall):
            named = ", ".join(f"floor {floor}" if floor else BASE for floor, _ in floors) or "no floor"
            lines.append(f"{pair}the wall meets {named}")
            continue
        if not strikes and len(floors) > 1 and all(i == j for i, j in floors):
            first = floors[0][0]
            last = floors[-1][0]
            heights = f"{left.level(first):g} to {left.level(last):g} m"
            lines.append(f"{pair}{heights}: floors {first} to {last} meet those of the same number")
            continue
        found = [(left.level(i), f"floor {i} meets floor {j}") for i, j in floors]
        for strike in strikes:
            columns = (left, right)[strike.side]
            slab = (right, left)[strike.side]
            sentence = f"floor {strike.slab} of {slab.name} strikes columns of {columns.name} in storey {strike.storey}"
            sentence += f", at {100 * strike.height:.3g} % of its height"
            if columns.columns is None:
                sentence = f"left out: {sentence}; write `columns:` in {columns.name}"
            elif columns.columns == 0.0:
                sentence = f"floor {strike.slab} of {slab.name} meets storey {strike.storey} of {columns.name}, "
                sentence += "which has no columns to strike"
            else:
                sentence += f", {100 * columns.columns:.3g} % of the storey"
            found.append((slab.level(strike.slab), sentence))
        lines += [f"{pair}{height:g} m: {sentence}" for height, sentence in sorted(found)]
    return lines
