"""The layout that runs of the same buildings and links share: records at rest, and where everything stands in them."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from pounding_cli.laws import BEHAVIOURS
from pounding_cli.laws.joints import Maxwell
from pounding_cli.laws.law import Behaviour, LinkLaw
from pounding_cli.laws.slider import Slider
from pounding_cli.model.building import Building
from pounding_cli.model.effects import effects_of
from pounding_cli.model.links import LinkEnd
from pounding_cli.model.scene import Scene
from pounding_cli.solver.building_elements import BuildingElements, Fields, Weights, build_element
from pounding_cli.solver.records import COLUMN, DOF, ELEMENT, TERM

Terms = list[tuple[float, int]]
"""Weight and number of what each further term of elements and of shears refers to."""


class LinkTemplate(NamedTuple):
    """A link without the parameters of its law, which scenes of one layout need not share; fields as of `Link`.

    arms : of both ends from the centres of mass [m]
    """

    ends: tuple[LinkEnd, LinkEnd]
    columns: float
    cosine: float
    arms: tuple[float, float]
    law: type[LinkLaw]


class StruckColumns(NamedTuple):
    """Columns whose shear is asked for because a link ends on them.

    link : its number
    building, storey : of the columns, from 0 and from 1
    height : of its end in the storey [-]
    share : part of the storey that the columns have [-]
    cosine : part of the link's force that is level [-]
    on_left : whether they are those on the building's left
    """

    link: int
    building: int
    storey: int
    height: float
    share: float
    cosine: float
    on_left: bool

    def are_same_as(self, other: StruckColumns) -> bool:
        """Return whether another link ends on these columns too."""
        return (self.building, self.storey, self.on_left) == (other.building, other.storey, other.on_left)


@dataclass(frozen=True, eq=False)
class Layout:
    """The records at rest of buildings and links, and where each of them stands; without the parameters of links.

    dofs, elements, terms, columns : as of `records.Data`, of one scene
    masses : that the force of every link moves at its two ends [kg]
    cosines : of the angles of the links, shape (links,): a link deforms by the closing of its ends times it [-]
    floors : degrees of freedom of the floors of every building
    bases, feet : those of a base that sways, and that rocks; -1 where none does
    turns : degrees of freedom of the rotations of the floors of every building, none where they do not twist
    drags : dashpots to the ground of buildings on foundations; their elements stand behind those of the storeys
    lines : building, storey from 0 and number of every frame line; their elements stand behind these dashpots
    sums : buildings from 0 whose floors twist; their storey shears, sums over lines, stand behind those of `struck` in
        `columns`
    struck : columns that links end on; two shears each stand in `columns`, below and above that end
    has_smooth : whether a law has a force without a Taylor series
    """

    buildings: tuple[Building, ...]
    dofs: np.ndarray
    elements: np.ndarray
    terms: np.ndarray
    columns: np.ndarray
    masses: tuple[tuple[float, float], ...]
    cosines: np.ndarray
    floors: tuple[slice, ...]
    bases: tuple[int, ...]
    feet: tuple[int, ...]
    turns: tuple[slice, ...]
    drags: int
    lines: tuple[tuple[int, int, int], ...]
    sums: tuple[int, ...]
    struck: tuple[StruckColumns, ...]
    has_smooth: bool

    @property
    def number(self) -> int:
        """Number of the degrees of freedom."""
        return self.dofs.size

    @property
    def most_lines(self) -> int:
        """Most frame lines of a building; 0 where no floors twist."""
        return 1 + max((number for _, _, number in self.lines), default=-1)

    @property
    def of_lines(self) -> slice:
        """Slice of the elements of the frame lines."""
        first = self.number + self.drags
        return slice(first, first + len(self.lines))

    @property
    def of_links(self) -> slice:
        """Slice of the elements of the links."""
        return slice(self.of_lines.stop, self.elements.size)


def build_layout(scene: Scene) -> Layout:
    """Return the layout of the buildings and links of a scene."""
    effects = effects_of(scene)
    templates = []
    for link in scene.links:
        arms = (link.left_arm, link.right_arm)
        templates.append(LinkTemplate(link.ends, link.columns, link.cosine, arms, type(link.law)))
    return _build_layout(scene.buildings, tuple(templates), effects.yielding, effects.collapse)


@functools.lru_cache(maxsize=64)  # the same for every motion, gap and restitution
def _build_layout(
    buildings: tuple[Building, ...], templates: tuple[LinkTemplate, ...], yields: bool, collapses: bool
) -> Layout:
    """Return the layout of buildings and links, with yielding and collapse where they are simulated."""
    parts = list[BuildingElements]()
    first_dof = 0
    for building in buildings:
        parts.append(BuildingElements(building, first_dof, yields, collapses))
        first_dof += len(parts[-1].dofs)
    dofs = _fill_records(DOF, [dof for part in parts for dof in part.dofs])
    storeys = [storey for part in parts for storey in part.storeys]
    drags = [drag for part in parts for drag in part.drags]
    lines = [(line.element, line.weights) for part in parts for line in part.lines]
    ends = [_find_ends(parts, template) for template in templates]
    links = []
    for template, (left, right) in zip(templates, ends, strict=True):
        weights = left | {dof: -weight for dof, weight in right.items()}
        links.append((build_element(template.law.behaviour), weights))
    beside = [*drags, *lines, *links]
    elements = _fill_records(ELEMENT, [*storeys, *(element for element, _ in beside)])
    terms: Terms = []
    for place, element in enumerate(elements[: dofs.size]):
        _enter_storey(element, place, dofs[place], terms)
    for element, (_, weights) in zip(elements[dofs.size :], beside, strict=True):
        _enter_weights(element, weights, terms)
    struck = tuple(_find_columns(number, each) for number, each in enumerate(templates) if each.columns > 0.0)
    sums = tuple(number for number, building in enumerate(buildings) if building.plan is not None)
    first_line = dofs.size + len(drags)
    shears = _build_column_shears(struck, parts, first_line, terms)
    for number in sums:
        shears += _build_storey_shears(number, parts, first_line, terms)
    behaviours = [BEHAVIOURS[kind] for kind in elements["kind"].tolist()]
    _number_rows(elements, behaviours[: dofs.size])
    _number_states(elements, behaviours, first=2 * dofs.size)
    return Layout(
        buildings=buildings,
        dofs=dofs,
        elements=elements,
        terms=_build_terms(terms),
        columns=_fill_records(COLUMN, shears, 1),
        masses=tuple(_find_masses(left, right, dofs["inv_mass"]) for left, right in ends),
        cosines=np.array([template.cosine for template in templates]),
        floors=tuple(part.floors for part in parts),
        bases=tuple(part.base for part in parts),
        feet=tuple(part.foot for part in parts),
        turns=tuple(part.turns for part in parts),
        drags=len(drags),
        lines=tuple((number, line.storey, line.number) for number, part in enumerate(parts) for line in part.lines),
        sums=sums,
        struck=struck,
        has_smooth=any(each.force is not None for each in behaviours),
    )


def _fill_records(dtype: np.dtype, rows: Sequence[Mapping[str, Any]], least: int = 0) -> np.ndarray:
    """Return records with these fields, `least` at least; fields that are not given are zero."""
    records = np.zeros(max(len(rows), least), dtype)
    for record, row in zip(records, rows, strict=False):
        for name, value in row.items():
            record[name] = value
    return records


def _build_terms(terms: Terms) -> np.ndarray:
    """Return the records of terms, one at least."""
    table = np.zeros(max(len(terms), 1), TERM)
    table["weight"][: len(terms)] = [weight for weight, _ in terms]
    table["dof"][: len(terms)] = [number for _, number in terms]
    return table


def _find_ends(parts: Sequence[BuildingElements], template: LinkTemplate) -> tuple[Weights, Weights]:
    """Return the motion of the two ends of a link along it, as weights of the degrees of freedom."""
    left, right = (
        parts[number].find_end(floor, height, arm)
        for (number, floor, height), arm in zip(template.ends, template.arms, strict=True)
    )
    return _scale_weights(left, template.cosine), _scale_weights(right, template.cosine)


def _scale_weights(weights: Weights, factor: float) -> Weights:
    """Return weights times a factor."""
    return {dof: factor * weight for dof, weight in weights.items()}


def _find_masses(left: Weights, right: Weights, inv_mass: np.ndarray) -> tuple[float, float]:
    """Return the masses that a force on the ends of a link moves [kg]; see `_find_mass`."""
    return _find_mass(left, inv_mass), _find_mass(right, inv_mass)


def _find_mass(end: Weights, inv_mass: np.ndarray) -> float:
    """Return the mass that a force on an end moves [kg], inf where that does not move.

    inv_mass : of all degrees of freedom [1/kg]
    """
    flexibility = sum(weight * weight * float(inv_mass[dof]) for dof, weight in end.items())
    return 1.0 / flexibility if flexibility else math.inf


def _enter_storey(element: np.void, place: int, dof: np.void, terms: Terms) -> None:
    """Enter the two ends of a storey, and what a base that rocks adds to its drift.

    place : of the degree of freedom above the storey, and of its element
    """
    element["left"] = place
    element["right"] = max(place - 1, 0)
    element["hold"] = dof["below"]
    element["first"] = len(terms)
    if dof["lean"]:
        terms.append((dof["lean"], dof["foot"]))
    element["last"] = len(terms)


def _enter_weights(element: np.void, weights: Weights, terms: Terms) -> None:
    """Enter the degrees of freedom of an element: two plain ends, of weights 1 and -1, and all else as terms.

    Where one of the plain ends is missing all weights are terms.
    """
    left = next((dof for dof, weight in weights.items() if weight == 1.0), -1)
    right = next((dof for dof, weight in weights.items() if weight == -1.0), -1)
    has_ends = left >= 0 and right >= 0
    element["left"] = left if has_ends else 0
    element["right"] = right if has_ends else 0
    element["hold"] = 1.0
    element["first"] = len(terms)
    terms += [(weight, dof) for dof, weight in weights.items() if not has_ends or dof not in (left, right)]
    element["last"] = len(terms)


def _find_columns(number: int, template: LinkTemplate) -> StruckColumns:
    """Return the columns that a link ends on, of which one end stands between floors.

    number : of the link
    """
    left, right = template.ends
    on_left = left[2] == 1.0  # the link comes from the left, to the columns on the left of the right building
    building, storey, height = right if on_left else left
    return StruckColumns(number, building, storey, height, template.columns, template.cosine, on_left)


def _build_column_shears(
    struck: Sequence[StruckColumns], parts: Sequence[BuildingElements], first_line: int, terms: Terms
) -> list[Fields]:
    """Return the shears below and above the end of every link on columns, and add their terms.

    The columns have their share of the storey's shear, and of the level forces of all links on them the reaction of a
    clamped beam at that end; between two links, that of both sides.

    first_line : element of the first line of all buildings; the links stand behind the lines
    """
    shears = []
    first_link = first_line + sum(len(part.lines) for part in parts)
    for columns in struck:
        for is_above in (False, True):
            first = len(terms)
            for other in struck:
                if other.are_same_as(columns):
                    weight = _find_shear_weight(other, columns.height, is_above)
                    terms.append((weight, first_link + other.link))
            lines = _list_lines_of_storey(parts, columns.building, columns.storey - 1, first_line)
            terms += [(columns.share, line) for line in lines]
            storey = parts[columns.building].floors.start + columns.storey - 1
            shears.append({"share": columns.share, "storey": storey, "first": first, "last": len(terms)})
    return shears


def _find_shear_weight(columns: StruckColumns, height: float, is_above: bool) -> float:
    """Return the weight of the force of a link on columns in their shear just below or above a height in the storey."""
    to_above = columns.height * columns.height * (3.0 - 2.0 * columns.height)  # what the floor above takes
    acts_higher = columns.height > height if is_above else columns.height >= height
    weight = columns.cosine * (1.0 - to_above if acts_higher else -to_above)
    return weight if columns.on_left else -weight


def _build_storey_shears(number: int, parts: Sequence[BuildingElements], first_line: int, terms: Terms) -> list[Fields]:
    """Return the shears of the storeys of a building whose floors twist, from the ground up, and add their terms.

    They are the sums of the lines along the row. With them stand the places of the edges, whose drifts are looked at
    beside the shears.

    Parameters
    ----------
    number : of the building
    first_line : element of the first line of all buildings
    """
    part = parts[number]
    plan = part.building.plan
    assert plan is not None
    shears = []
    for storey in range(part.building.storeys):
        first = len(terms)
        terms += [(1.0, line) for line in _list_lines_of_storey(parts, number, storey, first_line)]
        shear = {"share": 1.0, "storey": part.floors.start + storey, "first": first, "last": len(terms)}
        shears.append(shear | {"is_sum": 1, "low": -plan.low, "high": -plan.high})
    return shears


def _list_lines_of_storey(parts: Sequence[BuildingElements], number: int, storey: int, first_line: int) -> list[int]:
    """Return the elements of the lines along the row of a storey of a building, none where floors do not twist.

    Parameters
    ----------
    number, storey : of the building and of its storey, from 0
    first_line : element of the first line of all buildings
    """
    first = first_line + sum(len(part.lines) for part in parts[:number])
    return [
        first + place
        for place, line in enumerate(parts[number].lines)
        if line.storey == storey and line.element["along"] > 0.0
    ]


def _number_rows(elements: np.ndarray, behaviours: Sequence[Behaviour]) -> None:
    """Enter where storeys whose force has a series of its own stand among the series, behind all other elements.

    behaviours : of the storeys
    """
    storeys = len(behaviours)
    has_series = np.flatnonzero([each.force is not None or each is Slider.behaviour for each in behaviours])
    elements["row"][has_series] = elements.size - storeys + np.arange(has_series.size)


def _number_states(elements: np.ndarray, behaviours: Sequence[Behaviour], first: int) -> None:
    """Enter where history variables that change between events stand among what DOP853 integrates.

    first : place of the first of them
    """
    is_changing = [each.history_rate is not None or each is Maxwell.behaviour for each in behaviours]
    places = np.flatnonzero(is_changing)
    elements["state"][places] = first + np.arange(places.size)


def build_term_matrix(layout: Layout) -> np.ndarray:
    """Return the rows that give the deformation of every element from the displacements.

    Returns
    -------
    shape (elements, degrees of freedom) [-], of terms of rocking and twist [m]
    """
    matrix = np.zeros((layout.elements.size, layout.number))
    for row, element in zip(matrix, layout.elements, strict=True):
        row[element["left"]] += 1.0
        row[element["right"]] -= element["hold"]
        for place in range(element["first"], element["last"]):
            row[layout.terms["dof"][place]] += layout.terms["weight"][place]
    return matrix
