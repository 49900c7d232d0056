"""The rounds of `pound fragility`: from the responses so far to the scenes that are asked next."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, Protocol

import numpy as np

from pounding_cli.digests import DigestList
from pounding_cli.fragility.hunt import UNDECIDED, next_levels
from pounding_cli.model.placed import Placed
from pounding_cli.model.scene import Scene
from pounding_cli.study.expression import COLLAPSE, CONTACT, SHEAR_DEMAND, TAKES_NEIGHBOUR, Limit, Target
from pounding_cli.study.plan import LinkSeen, Plan
from pounding_cli.study.scenes import LinkSets, Scenes

if TYPE_CHECKING:
    from pounding_cli.solver.response import Response

FIELDS = {"mu": "ductility", "drift": "drift", "acceleration": "acceleration"}
"""What a limit looks at, as responses call it."""


class Responses(Protocol):
    """What was solved, by digest."""

    def read(self, digests: Iterable[str]) -> Iterator[tuple[str, Response]]: ...


@dataclass(frozen=True, eq=False)
class Layout:
    """Where the scenes of a plan stand, the intensity apart from the other swept axes.

    order : places of the levels on their axis, intensities rising, shape (levels,)
    intensity : of the levels as the study says it, rising, shape (levels,)
    points : of the other axes, an index on every axis, 0 on that of the intensity
    linked : numbers of the scenes in the table of the plan's rows, shape (points, cases, analyses, motions, levels)
    alone : numbers of the baselines there, shape (points, analyses, motions, levels, buildings)
    """

    order: np.ndarray
    intensity: np.ndarray
    points: list[tuple[int, ...]]
    linked: np.ndarray
    alone: np.ndarray
    _sets: LinkSets
    _links: np.ndarray

    @classmethod
    def of(cls, plan: Plan, axis: int | None) -> Layout:
        """The layout of a plan; `axis` : number of the axis of the intensity; None: there is one level."""
        values = [1.0] if axis is None else [float(value) for (value,) in plan.axes[axis].values]
        order, rows = np.argsort(values), plan.rows
        swept = [len(each.values) for each in plan.axes]
        shape = (*swept, len(plan.cases), len(plan.analyses), len(plan.records))
        return cls(
            order,
            np.array(values)[order],
            list(np.ndindex(*(1 if number == axis else size for number, size in enumerate(swept)))),
            by_level(rows.scenes[:, 0].reshape(shape), len(swept), axis, order),
            by_level(rows.scenes[:, 1:].reshape(*shape, len(plan.buildings)), len(swept), axis, order)[:, 0],
            rows.sets,
            by_level(rows.links.reshape(*shape[:-2], 1, 1), len(swept), axis, order)[:, :, 0, 0, 0],
        )

    def links(self, point: int, case: int) -> tuple[LinkSeen, ...]:
        """The links of a point and case."""
        return self._sets[int(self._links[point, case])]


def by_level(values: np.ndarray, swept: int, axis: int | None, order: np.ndarray) -> np.ndarray:
    """Values with the levels behind the motions, shape (points, cases, analyses, motions, levels, what follows).

    values : shape (swept axes, cases, analyses, motions, what follows); swept : how many axes
    """
    place = swept + 3
    if axis is None:
        whole = np.expand_dims(values, place)
    else:
        whole = np.moveaxis(np.take(values, order, axis), axis, place - 1)
        swept -= 1
    return whole.reshape(-1, *whole.shape[swept:])


def over_limit(limit: Limit, peaks: np.ndarray, height: np.ndarray) -> np.ndarray:
    """Demand over limit [-], above 1 where the limit is passed; NaN where there is no peak.

    peaks : of a storey or floor, NaN above the highest, shape (..., storeys); height : of the storeys [m], (storeys,)
    """
    parts = peaks / (limit.value * height if limit.of_height else limit.value)
    return parts[..., limit.level - 1] if limit.level else np.fmax.reduce(parts, axis=-1)


def demand_of_collapse(limit: Limit, reached: float, storey: int) -> float:
    """Demand over limit of a scene that a collapse ended [-]: inf where the limit was passed, else UNDECIDED.

    Passed are limits that were passed before the scene ended, the collapse itself, and limits on the drift or the
    ductility of the storey that collapsed: its drift has no bound.

    reached : demand over limit until the scene ended [-]; storey : of the limit's building that collapsed, from 1; 0
        where another building did
    """
    of_drift = limit.quantity in ("mu", "drift") and limit.level in (0, storey)
    passed = reached > 1 or (storey > 0 and (of_drift or limit.quantity == COLLAPSE))
    return np.inf if passed else UNDECIDED


def over_gap(closing: np.ndarray, gap: np.ndarray) -> np.ndarray:
    """Largest closing over gap [-], above 1 where a gap closes; 0 without links, NaN where no closing is known.

    closing, gap : of every link, shape (..., links) [m]
    """
    if not closing.shape[-1]:
        return np.zeros(closing.shape[:-1])
    at_once = np.where(closing > 0, np.inf, np.where(np.isnan(closing), np.nan, 0.0))  # floors in touch
    parts = np.divide(closing, gap, out=at_once, where=np.broadcast_to(gap > 0, closing.shape))
    return np.fmax.reduce(parts, axis=-1)


def struck_columns(target: Target, links: Sequence[LinkSeen], yield_shear: np.ndarray) -> list[int]:
    """Numbers of the links that strike columns of the target's building, of its only storey if the limit names one;
    those of storeys that cannot yield are left out: nothing says what they can carry.

    yield_shear : of the building's storeys [N], shape (storeys,)
    """
    return [
        number
        for number, link in enumerate(links)
        if link.columns is not None
        and link.columns[0] == target.building
        and target.limit.level in (0, link.columns[1])
        and yield_shear[link.columns[1] - 1] < np.inf
    ]


def over_demand(limit: Limit, demand: np.ndarray) -> np.ndarray:
    """Shear demand over limit [-], above 1 where the limit is passed; 0 without struck columns, NaN where unknown.

    demand : of every link that strikes the columns, shape (..., links)
    """
    return np.fmax.reduce(demand, axis=-1) / limit.value if demand.shape[-1] else np.zeros(demand.shape[:-1])


class Series(NamedTuple):
    """The scenes of one motion over the levels, and the targets that they tell of.

    scenes : numbers in the table of the plan's rows, shape (levels,)
    building : place of the building that stands alone; -1 with pounding
    """

    scenes: np.ndarray
    point: int
    case: int
    building: int
    targets: tuple[int, ...]


class Asked(Placed):
    """The scenes asked so far, of all that a plan could ask, and what their responses said; all by their numbers in the
    table of the plan's rows.

    known : scenes whose responses were looked at, in the order in which they were asked
    demands : of every scene, asked or not, demand over limit of every target as `Demands` has it, shape
        (scenes, targets)
    going : series whose search goes on
    waiting : scenes whose responses have not been looked at, and the series each belongs to
    """

    def __init__(
        self,
        whole: Scenes,
        layout: Layout,
        targets: tuple[Target, ...],
        known: np.ndarray,
        demands: np.ndarray,
        going: list[Series],
        waiting: dict[int, Series],
    ) -> None:
        self.whole, self.layout, self.targets = whole, layout, targets
        self.known, self.demands, self.going, self.waiting = known, demands, going, waiting
        self._numbers = np.concatenate([known, np.array(list(waiting), np.int32)])
        self._is_asked = np.zeros(len(whole) + 1, bool)  # the last for what is none of them
        self._is_asked[self._numbers] = True

    @classmethod
    def first(cls, plan: Plan, layout: Layout, targets: tuple[Target, ...]) -> Asked:
        """The first round: the lowest level of every series."""
        going, whole = list(_series(layout, targets)), plan.scenes
        assert isinstance(whole, Scenes)
        demands = np.full((len(whole), len(targets)), np.nan)
        waiting = {int(each.scenes[0]): each for each in going}
        return cls(whole, layout, targets, np.zeros(0, np.int32), demands, going, waiting)

    def digests(self, numbers: Sequence[int] | np.ndarray) -> DigestList:
        """Digests by number."""
        return DigestList(self.whole.table.digests, np.asarray(numbers, np.int64))

    def place(self, digest: str) -> int:
        """Its place among all that could be asked."""
        return self.places([digest])[0]

    def places(self, digests: Sequence[str]) -> list[int]:
        """Their places among all that could be asked."""
        is_asked = self.has(digests)
        if not is_asked.all():
            raise KeyError(digests[int(np.argmin(is_asked))])
        return self.whole.places(digests)

    def at(self, place: int) -> Scene:
        """The scene at a place."""
        return self.whole.at(place)

    def has(self, digests: Sequence[str]) -> np.ndarray:
        """Whether each scene is asked, shape (digests,)."""
        return self._is_asked[self.whole.table.numbers(digests)]

    def __contains__(self, digest: object) -> bool:
        return isinstance(digest, str) and bool(self.has([digest])[0])

    def __iter__(self) -> Iterator[str]:
        return iter(self.digests(self._numbers))

    def __len__(self) -> int:
        return len(self._numbers)


def refine_fragility(plan: Plan, responses: Responses) -> Plan | None:
    """The plan of the next round; None where every motion is bracketed, and where all was asked at once."""
    asked = plan.scenes
    if not isinstance(asked, Asked):
        return None
    known = np.concatenate([asked.known, np.array(list(asked.waiting), np.int32)])
    demands, is_known = asked.demands.copy(), np.zeros(len(asked.whole), bool)
    demands[known[len(asked.known) :]] = _demands(plan, asked, responses)
    is_known[known] = True
    fill = plan.study.model.fragility.fill
    going: list[Series] = []
    waiting: dict[int, Series] = {}
    for series in asked.going:
        levels = np.flatnonzero(is_known[series.scenes])
        told = demands[series.scenes[levels]].T
        wanted: set[int] = set()
        for target in series.targets:
            seen = dict(zip(levels.tolist(), told[target].tolist(), strict=True))
            wanted |= next_levels(asked.layout.intensity, seen, fill)
        if wanted:
            going.append(series)
            waiting |= {int(series.scenes[level]): series for level in sorted(wanted)}
    if not waiting:
        return None
    scenes = Asked(asked.whole, asked.layout, asked.targets, known, demands, going, waiting)
    return dataclasses.replace(plan, scenes=scenes)


def _series(layout: Layout, targets: tuple[Target, ...]) -> Iterator[Series]:
    """Every motion with pounding, and every building alone once."""
    everything = tuple(range(len(targets)))
    points, cases, analyses, motions, _ = layout.linked.shape
    known: set[int] = set()
    for point in range(points):
        for case, analysis, motion in np.ndindex(cases, analyses, motions):
            yield Series(layout.linked[point, case, analysis, motion], point, case, -1, everything)
        for building in range(layout.alone.shape[-1]):
            mine = tuple(
                number for number, target in enumerate(targets)
                if target.building == building and target.limit.quantity not in TAKES_NEIGHBOUR
            )  # fmt: skip
            for analysis, motion in np.ndindex(analyses, motions):
                scenes = layout.alone[point, analysis, motion, :, building]
                if mine and int(scenes[0]) not in known:  # other cases and points may share it
                    known.add(int(scenes[0]))
                    yield Series(scenes, point, 0, building, mine)


class Demands:
    """Demand over limit of the scenes of a plan, from their responses."""

    def __init__(self, plan: Plan, layout: Layout) -> None:
        self._plan, self._layout = plan, layout
        self._storeys: dict[tuple[int, int], tuple[np.ndarray, np.ndarray]] = {}  # of a building there may be many

    def of(self, response: Response, target: Target, point: int, case: int, place: int) -> float:
        """Demand over limit [-], above 1 where the limit is passed; inf where a collapse ended the scene after that,
        UNDECIDED where it did before; NaN where the scene failed.

        point, case : of the layout; place : of the target's building in the scene, from 0
        """
        if not response.has_result:
            return float("nan")
        reached = self._reached(response, target, point, case, place)
        if not response.collapse_storey:
            return reached
        fell = response.collapse_building == place
        return demand_of_collapse(target.limit, reached, response.collapse_storey if fell else 0)

    def _reached(self, response: Response, target: Target, point: int, case: int, place: int) -> float:
        """Demand over limit by the largest values of a response, whatever ended it; 0 of collapse."""
        limit = target.limit
        if limit.quantity == COLLAPSE:
            return 0.0
        links = self._layout.links(point, case)
        if limit.quantity == CONTACT:
            mine = [number for number, link in enumerate(links) if link.left == target.building]
            gaps = np.array([links[number].gap for number in mine])
            return float(over_gap(response.links.max_closing[mine], gaps))
        height, yield_shear = self._of_storeys(point, target.building)
        if limit.quantity == SHEAR_DEMAND:
            demand = np.full(len(links), np.nan)
            demand[response.columns.link] = response.columns.demand
            return float(over_demand(limit, demand[struck_columns(target, links, yield_shear)]))
        return float(over_limit(limit, getattr(response.buildings[place], FIELDS[limit.quantity]), height))

    def _of_storeys(self, point: int, building: int) -> tuple[np.ndarray, np.ndarray]:
        """Height [m] and yield shear [N] of the storeys of a building."""
        key = point, building
        if key not in self._storeys:
            own = self._plan.study.building(self._layout.points[point], building)
            self._storeys[key] = own.height, own.yield_shear
        return self._storeys[key]


def _demands(plan: Plan, asked: Asked, responses: Responses) -> np.ndarray:
    """Demand over limit of every target in the scenes whose responses were waited for, shape (scenes, targets)."""
    demands = Demands(plan, asked.layout)
    found = np.full((len(asked.waiting), len(asked.targets)), np.nan)
    read = responses.read(asked.digests(list(asked.waiting)))
    for demand, series, (_, response) in zip(found, asked.waiting.values(), read, strict=True):
        for number in series.targets:
            target = asked.targets[number]
            place = target.building if series.building < 0 else 0
            demand[number] = demands.of(response, target, series.point, series.case, place)
    return found
