"""Plan a study: the different scenes of its sweep, the rows of the tables that point at them, those kept over time."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from typing import Any, NamedTuple

import numpy as np

from pounding_cli.model.building import Building
from pounding_cli.model.links import Link, LinkPlace, link_places
from pounding_cli.model.parts import is_divided
from pounding_cli.model.scene import Analysis, Digests, Scene
from pounding_cli.model.twist import drop_plans
from pounding_cli.study.construct import keep
from pounding_cli.study.construct.group import Group, unique_names
from pounding_cli.study.construct.link_places import Meeting
from pounding_cli.study.construct.motions import Suite
from pounding_cli.study.construct.resolve import StudyParts
from pounding_cli.study.construct.swept import Point, Swept, sweep_map
from pounding_cli.study.study import Study
from pounding_cli.study.text.file import Problems
from pounding_cli.study.vary.axes import Axis

DIGEST_SIZE = 32
"""Bytes of a SHA-256 digest."""

PlanFilter = Callable[[Point, str, Analysis, str], bool]
"""row_filter(point, case, analysis, record) -> whether the scenes of a row are wanted."""


@dataclass(frozen=True, eq=False)
class Links:
    """The links of every point and case in the columns of the tables; arrays have the shape (points of every axis...,
    cases, columns).

    places : of every column left building from 0, floors from 1, name among links of the same floors
    order : number of the link in its scene; -1 where the case has none here
    kind : law; "" where there is none
    gap : [m]; NaN where there is none
    left_at, right_at : heights of its ends in the storeys below its floors [-], 1 at a floor
    inclination : angle between the link and the horizontal [rad]; NaN where there is none
    street : place of its left end along the street, of its right end beside a left building without a plan [m]; NaN
        where neither has one
    left_arm, right_arm : places of its ends from the centres of mass [m]
    facing : 1 where its ends are as high as each other, within the slabs, else 0; NaN where there is none
    """

    places: tuple[LinkPlace, ...]
    order: np.ndarray
    kind: np.ndarray
    gap: np.ndarray
    left_at: np.ndarray
    right_at: np.ndarray
    inclination: np.ndarray
    facing: np.ndarray
    street: np.ndarray
    left_arm: np.ndarray
    right_arm: np.ndarray


class PlanRow(NamedTuple):
    """A row of the tables: its index on every axis, its names, the number of its scene."""

    point: tuple[int, ...]
    case: str
    analysis: str
    record: str
    scene: int


@dataclass(frozen=True, eq=False)
class Plan:
    """Everything to run.

    digests : SHA-256 of every different scene, in the order of the rows that need them first, shape (scenes, 32)
    numbers : number of the scene of a row, then of every building alone, -1 for one that nobody asks for, shape
        (points of every axis..., cases, analyses, records, 1 + buildings)
    divided : which scenes have parts that nothing links, shape (scenes,)
    links : what the tables say of links
    build : scene of a row by its flat number among all rows
    buildings : names by place, left to right (soft-1, soft-2 where a type occurs twice)
    accuracy : relative error wanted [-]
    time_step : of a method that takes one [s]
    estimate : which scenes are assessed, for error and sensitivity: none, sample or all
    harder : whether a scene that fails is solved once more, more finely
    kept : rows whose scenes are kept over time, every `every` seconds
    """

    study: Study
    axes: tuple[Axis, ...]
    cases: tuple[str, ...]
    analyses: tuple[str, ...]
    records: tuple[str, ...]
    buildings: tuple[str, ...]
    digests: np.ndarray
    numbers: np.ndarray
    divided: np.ndarray
    links: Links
    build: Callable[[int], Scene]
    accuracy: float
    method: str
    time_step: float | None = None
    estimate: str = "none"
    harder: bool = False
    kept: tuple[PlanRow, ...] = ()
    every: float = 0.002

    def __len__(self) -> int:
        """Return the number of different scenes."""
        return len(self.digests)

    @property
    def shape(self) -> tuple[int, ...]:
        """Sizes of the rows: points of every axis, cases, analyses, records."""
        return self.numbers.shape[:-1]

    @cached_property
    def first(self) -> tuple[np.ndarray, np.ndarray]:
        """The place where every scene stands first: flat number of the row, and the column in it; shapes (scenes,).

        The column is 0 for the group, and 1 + the number of a building that stands alone.
        """
        flat = self.numbers.ravel()
        _, at = np.unique(flat[flat >= 0], return_index=True)
        return np.divmod(np.flatnonzero(flat >= 0)[at], self.numbers.shape[-1])

    def scenes(self, numbers: np.ndarray) -> Iterator[Scene]:
        """Some scenes by number, built one by one."""
        rows, columns = self.first
        for row, column in zip(rows[numbers].tolist(), columns[numbers].tolist(), strict=True):
            scene = self.build(row)
            yield scene.alone(column - 1) if column else scene

    def scene(self, number: int) -> Scene:
        """A scene by number."""
        return next(self.scenes(np.array([number])))

    def row(self, number: int) -> PlanRow:
        """A row by its flat number."""
        *point, case, analysis, record = map(int, np.unravel_index(number, self.shape))
        scene = int(self.numbers[(*point, case, analysis, record, 0)])
        return PlanRow(tuple(point), self.cases[case], self.analyses[analysis], self.records[record], scene)

    def display_values(self, point: tuple[int, ...]) -> dict[str, str]:
        """Return the swept values at a point, by key, in the units of the study."""
        return {
            name: text
            for axis, place in zip(self.axes, point, strict=True)
            for name, text in zip(axis.names, axis.display_values(place), strict=True)
        }


def make_plan(study: Study, parts: StudyParts | None = None, row_filter: PlanFilter | None = None) -> Plan:
    """Return the plan of a study.

    Parameters
    ----------
    parts : in place of the parts of the study, such as other links
    row_filter : which rows have scenes; all unless given

    Raises
    ------
    InputError : the histories that are kept would take too much memory
    """
    planner = _Planner(study, study.parts if parts is None else parts)
    return planner.build_plan(row_filter)


class _Planner:
    """One study being planned; it stays with the plan, to build scenes when they are asked for."""

    def __init__(self, study: Study, parts: StudyParts) -> None:
        self.study = study
        self.parts = parts
        self.cases = tuple(study.spec.cases)
        self.records = tuple(study.motion_uses(study.first_point))
        self.analyses = tuple(map(Analysis, study.spec.analyses))
        self.sizes = tuple(len(axis) for axis in study.axes)
        self.wants_residual_drift = study.wants_residual_drift
        self.suffixes = sweep_map(self.list_suffixes, parts.suite, parts.tail)
        self.content = bytearray()  # digests of scenes as they are found, one behind the other

    def build_plan(self, row_filter: PlanFilter | None) -> Plan:
        """Return the plan."""
        study = self.study
        spec = study.spec
        rows = (*self.sizes, len(self.cases), len(self.analyses), len(self.records))
        numbers = np.empty((*rows, 1 + len(spec.group)), np.int32)
        divided_rows = np.zeros(rows, bool)
        for place, case in enumerate(self.cases):
            row = self.parts.group, self.parts.links[case]
            numbers[..., place, :, :, 0] = self.number_scenes(sweep_map(_begin_digests, *row))
            is_of_parts = sweep_map(lambda group, links: is_divided(group.buildings, links), *row)
            divided_rows[..., place, :, :] = is_of_parts.spread(range(len(self.sizes)))[..., None, None]
        for place, name in enumerate(spec.group):
            alone = self.number_scenes(sweep_map(_begin_digests_alone, self.parts.types[name]))
            numbers[..., 1 + place] = alone[..., None, :, :]
        if row_filter is not None:
            points = product(*map(range, self.sizes))
            wanted = (row_filter(*row) for row in product(points, self.cases, self.analyses, self.records))
            numbers[~np.fromiter(wanted, bool, int(np.prod(rows))).reshape(rows)] = -1
        digests = np.frombuffer(self.content, np.uint8).reshape(-1, DIGEST_SIZE)
        digests, numbers = _drop_equal(digests, numbers)
        self.content = bytearray()
        divided = np.zeros(len(digests) + 1, bool)  # the last one stands for -1
        divided[numbers[..., 0][divided_rows]] = True
        plan = Plan(
            study=study,
            axes=study.axes,
            cases=self.cases,
            analyses=tuple(map(str, self.analyses)),
            records=self.records,
            buildings=unique_names(spec.group),
            digests=digests,
            numbers=numbers,
            links=_build_table(self.parts.group, [self.parts.links[case] for case in self.cases], self.sizes),
            divided=divided[:-1],
            build=self.build_scene,
            accuracy=spec.accuracy,
            method=spec.method,
            time_step=spec.time_step,
            estimate=spec.estimate,
        )
        return keep_rows(plan) if spec.keep is not None else plan

    def list_suffixes(self, suite: Suite, tail: float) -> list[bytes]:
        """Return how the digests of all analyses and motions end."""
        pairs = product(self.analyses, suite.uses.values())
        return [Digests.suffix(use.digest, analysis, tail, self.wants_residual_drift) for analysis, use in pairs]

    def number_scenes(self, begun: Swept[Digests]) -> np.ndarray:
        """Return the numbers in `content` of scenes on every motion, in every analysis.

        Shape: points of every axis (1 where the scenes do not depend on it), analyses, motions.

        begun : digests of their buildings and links
        """
        first = len(self.content) // DIGEST_SIZE
        finished = sweep_map(lambda digests, suffixes: b"".join(map(digests.finish, suffixes)), begun, self.suffixes)
        for digests in finished.values.flat:
            self.content += digests
        numbers = np.arange(first, len(self.content) // DIGEST_SIZE, dtype=np.int32)
        points = finished.spread(range(len(self.sizes))).shape
        return numbers.reshape(*points, len(self.analyses), len(self.records))

    def build_scene(self, row: int) -> Scene:
        """Return the scene of a row by its flat number; scenes of one point and case share buildings and links."""
        shape = (*self.sizes, len(self.cases), len(self.analyses), len(self.records))
        *point, case, analysis, record = map(int, np.unravel_index(row, shape))
        at = tuple(point)
        links = self.parts.links[self.cases[case]].value_at(at)
        return Scene(
            drop_plans(self.parts.group.value_at(at).buildings, links),
            links,
            self.study.motion(at, self.records[record]),
            self.analyses[analysis],
            self.parts.tail.value_at(at),
            self.wants_residual_drift,
        )


def _begin_digests(group: Group, links: tuple[Link, ...]) -> Digests:
    """Return the digests of the scenes of buildings and links."""
    return Digests(drop_plans(group.buildings, links), links)


def _begin_digests_alone(building: Building) -> Digests:
    """Return the digests of the scenes of a building that stands alone."""
    return Digests(drop_plans((building,), ()), ())


ABSENT_LINK: dict[str, Any] = {
    "order": np.int16(-1), "kind": np.array("", object), "gap": np.nan, "left_at": np.nan, "right_at": np.nan,
    "inclination": np.nan, "facing": np.nan, "street": np.nan, "left_arm": np.nan, "right_arm": np.nan,
}  # fmt: skip
"""What the tables say of a link where a case has none, by the fields of `Links`."""


def _build_table(group: Swept[Group], cases: list[Swept[tuple[Link, ...]]], sizes: tuple[int, ...]) -> Links:
    """Return what the tables say of the links of all cases.

    sizes : lengths of all axes
    """
    meetings = sweep_map(lambda group: group.meetings, group).merge_equal()
    rows_by_case = [sweep_map(_list_rows, links, meetings) for links in cases]
    different = [rows for by_case in rows_by_case for _, rows in by_case.iter_values()]
    columns = tuple(sorted({place for rows in different for place, _ in rows}))
    number = {place: column for column, place in enumerate(columns)}
    table = {name: np.full((*sizes, len(cases), len(columns)), value) for name, value in ABSENT_LINK.items()}
    for case, swept in enumerate(rows_by_case):
        flat = list(swept.values.flat)
        points = [point for point, rows in enumerate(flat) for _ in rows]
        where = points, [number[place] for rows in flat for place, _ in rows]
        shape = swept.spread(range(len(sizes))).shape
        for name, array in table.items():
            values = np.full((len(flat), len(columns)), ABSENT_LINK[name])
            values[where] = [facts[name] for rows in flat for _, facts in rows]
            array[..., case, :] = values.reshape(*shape, -1)
    return Links(columns, **table)


def _list_rows(links: tuple[Link, ...], meetings: Sequence[Meeting]) -> list[tuple[LinkPlace, dict[str, Any]]]:
    """Return the place of every link of a scene, with what the tables say of it by the fields of `Links`."""
    rows = []
    for order, (place, link) in enumerate(zip(link_places(links), links, strict=True)):
        names = ("kind", "gap", "left_at", "right_at", "inclination", "left_arm", "right_arm")
        facts = {name: getattr(link, name) for name in names}
        meeting = meetings[link.left]
        facts |= {"order": order, "facing": float(meeting.has_facing_ends(link))}
        facts["street"] = meeting.find_street_place(link)
        rows.append((place, facts))
    return rows


def _drop_equal(digests: np.ndarray, numbers: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the different digests, in the order in which `numbers` has them first, and `numbers` among these."""
    _, first, same = np.unique(digests.view("V32").ravel(), return_index=True, return_inverse=True)
    numbers = np.where(numbers < 0, -1, same[numbers])
    used, begins = np.unique(numbers, return_index=True)
    is_scene = used >= 0
    used = used[is_scene]
    used = used[np.argsort(begins[is_scene])]
    place = np.full(len(first) + 1, -1, np.int32)  # the last one stands for -1
    place[used] = np.arange(len(used))
    return digests[first[used]], place[numbers]


def keep_rows(plan: Plan) -> Plan:
    """Return the plan with the rows whose scenes are kept over time, and their output step [s].

    Raises
    ------
    InputError : they would take more than MAX_BYTES_OF_HISTORIES, if all of a motion are as large as its first
    """
    study = plan.study
    histories = keep.requested_histories(study.spec.keep)
    if histories is None:
        return plan
    names = {"cases": plan.cases, "analyses": plan.analyses, "records": plan.records}
    chosen, _ = keep.choose_rows(histories, names, study.tree, study.axes)
    mask = np.zeros(plan.shape, bool)
    mask[np.ix_(*chosen)] = True
    rows = np.flatnonzero(mask).tolist()
    firsts = {row % len(plan.records): row for row in reversed(rows)}  # the motion runs fastest
    of_firsts = sum(keep.count_bytes(plan.build(row), histories.every) for row in firsts.values())
    size = of_firsts * len(rows) / max(len(firsts), 1)
    if size > keep.MAX_BYTES_OF_HISTORIES:
        taken = f"about {size / 1e9:.3g} GB; the most is {keep.MAX_BYTES_OF_HISTORIES / 1e9:g} GB"
        message = f"histories of {len(rows)} rows every {1000 * histories.every:g} ms take {taken}"
        hint = "keep fewer, `keep: {histories: {cases: [..], records: [..], where: {..}}}`, or write a longer `every:`"
        problems = Problems(study.file)
        problems.add_at(study.tree, ("keep",), message, hint, key=True)
        problems.check()
    return replace(plan, kept=tuple(map(plan.row, rows)), every=histories.every)
