"""The rounds of `pound fragility`: from the responses so far to the scenes that are asked next."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, Protocol

import numpy as np

from pounding_cli.fragility.hunt import next_levels
from pounding_cli.model.placed import Placed
from pounding_cli.model.scene import Scene
from pounding_cli.study.limits import COLLAPSE, CONTACT, SHEAR_DEMAND, TAKES_NEIGHBOUR, Limit, Target
from pounding_cli.study.plan import LinkSeen, Plan

if TYPE_CHECKING:
    from pounding_cli.solve.response import Response

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
    linked : digests of the scenes, shape (points, cases, analyses, motions, levels)
    alone : digests of the baselines, shape (points, analyses, motions, levels, buildings)
    links : of every point and case, shape (points, cases)
    """

    order: np.ndarray
    intensity: np.ndarray
    points: list[tuple[int, ...]]
    linked: np.ndarray
    alone: np.ndarray
    links: np.ndarray

    @classmethod
    def of(cls, plan: Plan, axis: int | None) -> Layout:
        """The layout of a plan; `axis` : number of the axis of the intensity; None: there is one level."""
        values = [1.0] if axis is None else [float(value) for (value,) in plan.axes[axis].values]
        order = np.argsort(values)
        rows, buildings = len(plan.rows), len(plan.buildings)
        linked, alone, links = np.empty(rows, object), np.empty((rows, buildings), object), np.empty(rows, object)
        same: dict[str, str] = {}  # cases and points share buildings alone: each digest is held once
        for number, row in enumerate(plan.rows):
            linked[number], links[number] = row.scene, row.links
            alone[number] = [same.setdefault(digest, digest) for digest in row.baselines]
        swept = [len(each.values) for each in plan.axes]
        shape = (*swept, len(plan.cases), len(plan.analyses), len(plan.records))
        return cls(
            order,
            np.array(values)[order],
            list(np.ndindex(*(1 if number == axis else size for number, size in enumerate(swept)))),
            by_level(linked.reshape(shape), len(swept), axis, order),
            by_level(alone.reshape(*shape, buildings), len(swept), axis, order)[:, 0],
            by_level(links.reshape(shape), len(swept), axis, order)[:, :, 0, 0, 0],
        )


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


def demand_of_collapse(limit: Limit, own: bool | np.ndarray) -> np.ndarray:
    """Demand over limit of a scene that ended with a collapse: beyond any limit of a peak, in every building, since the
    row is lost. Whether gaps would have closed is unknown, and whether another building than its `own` would fall."""
    known = own if limit.quantity == COLLAPSE else limit.quantity != CONTACT
    return np.where(known, np.inf, np.nan)  # fault: demand-of-collapse


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

    building : place of the building that stands alone; -1 with pounding
    """

    scenes: tuple[str, ...]
    point: int
    case: int
    building: int
    targets: tuple[int, ...]


class Asked(Placed):
    """The scenes asked so far, of all that a plan could ask, and what their responses said.

    demands : by digest, demand over limit of every target, shape (targets,)
    going : series whose search goes on
    waiting : scenes whose responses have not been looked at, and the series each belongs to
    """

    def __init__(
        self,
        whole: Placed,
        layout: Layout,
        targets: tuple[Target, ...],
        demands: dict[str, np.ndarray],
        going: list[Series],
        waiting: dict[str, Series],
    ) -> None:
        self.whole, self.layout, self.targets = whole, layout, targets
        self.demands, self.going, self.waiting = demands, going, waiting

    @classmethod
    def first(cls, plan: Plan, layout: Layout, targets: tuple[Target, ...]) -> Asked:
        """The first round: the lowest level of every series."""
        going = list(_series(layout, targets))
        assert isinstance(plan.scenes, Placed)
        return cls(plan.scenes, layout, targets, {}, going, {each.scenes[0]: each for each in going})

    def place(self, digest: str) -> int:
        """Its place among all that could be asked."""
        if digest not in self:
            raise KeyError(digest)
        return self.whole.place(digest)

    def places(self, digests: Sequence[str]) -> list[int]:
        """Their places among all that could be asked."""
        is_asked = self.has(digests)
        if not is_asked.all():
            raise KeyError(digests[int(np.argmin(is_asked))])
        return self.whole.places(digests)

    def at(self, place: int) -> Scene:
        """The scene at a place."""
        return self.whole.at(place)

    def __contains__(self, digest: object) -> bool:
        return digest in self.demands or digest in self.waiting

    def __iter__(self) -> Iterator[str]:
        yield from self.demands
        yield from self.waiting

    def __len__(self) -> int:
        return len(self.demands) + len(self.waiting)


def refine_fragility(plan: Plan, responses: Responses) -> Plan | None:
    """The plan of the next round; None where every motion is bracketed, and where all was asked at once."""
    asked = plan.scenes
    if not isinstance(asked, Asked):
        return None
    demands = asked.demands | _demands(plan, asked, responses)
    fill = plan.study.model.fragility.fill  # type: ignore[attr-defined]  # a section that the registry adds
    going: list[Series] = []
    waiting: dict[str, Series] = {}
    for series in asked.going:
        told = {level: demands[digest] for level, digest in enumerate(series.scenes) if digest in demands}
        wanted: set[int] = set()
        for target in series.targets:
            seen = {level: float(each[target]) for level, each in told.items()}
            wanted |= next_levels(asked.layout.intensity, seen, fill)
        if wanted:
            going.append(series)
            waiting |= {series.scenes[level]: series for level in sorted(wanted)}
    if not waiting:
        return None
    return dataclasses.replace(plan, scenes=Asked(asked.whole, asked.layout, asked.targets, demands, going, waiting))


def _series(layout: Layout, targets: tuple[Target, ...]) -> Iterator[Series]:
    """Every motion with pounding, and every building alone once."""
    everything = tuple(range(len(targets)))
    points, cases, analyses, motions, _ = layout.linked.shape
    known: set[str] = set()
    for point in range(points):
        for case, analysis, motion in np.ndindex(cases, analyses, motions):
            yield Series(tuple(layout.linked[point, case, analysis, motion]), point, case, -1, everything)
        for building in range(layout.alone.shape[-1]):
            mine = tuple(
                number for number, target in enumerate(targets)
                if target.building == building and target.limit.quantity not in TAKES_NEIGHBOUR
            )  # fmt: skip
            for analysis, motion in np.ndindex(analyses, motions):
                scenes = tuple(layout.alone[point, analysis, motion, :, building])
                if mine and scenes[0] not in known:  # other cases and points may share it
                    known.add(scenes[0])
                    yield Series(scenes, point, 0, building, mine)


def _demands(plan: Plan, asked: Asked, responses: Responses) -> dict[str, np.ndarray]:
    """Demand over limit in every scene whose response was waited for."""
    # height [m] and yield shear [N] of the storeys, not the buildings: there may be many
    storeys: dict[tuple[int, int], tuple[np.ndarray, np.ndarray]] = {}
    found: dict[str, np.ndarray] = {}
    for digest, response in responses.read(asked.waiting):
        series = asked.waiting[digest]
        demand = np.full(len(asked.targets), np.nan)
        for number in series.targets if response.has_result else ():
            limit, building = asked.targets[number].limit, asked.targets[number].building
            place = building if series.building < 0 else 0
            if response.collapse_storey:  # fault: collapse-in-rounds
                demand[number] = demand_of_collapse(limit, response.collapse_building == place)
                continue
            if limit.quantity == COLLAPSE:
                demand[number] = 0.0
                continue
            if limit.quantity == CONTACT:
                links = asked.layout.links[series.point, series.case]
                mine = [place for place, link in enumerate(links) if link.left == building]
                gaps = np.array([links[place].gap for place in mine])
                demand[number] = over_gap(response.links.max_closing[mine], gaps)
                continue
            key = series.point, building
            if key not in storeys:
                own = plan.study.building(asked.layout.points[series.point], building)
                storeys[key] = own.height, own.yield_shear
            height, yield_shear = storeys[key]
            if limit.quantity == SHEAR_DEMAND:
                links = asked.layout.links[series.point, series.case]
                shear_demand = np.full(len(links), np.nan)
                shear_demand[response.columns.link] = response.columns.demand
                struck = struck_columns(asked.targets[number], links, yield_shear)
                demand[number] = over_demand(limit, shear_demand[struck])
                continue
            peaks = getattr(response.buildings[place], FIELDS[limit.quantity])
            demand[number] = over_limit(limit, peaks, height)
        found[digest] = demand
    return found
