"""From the laws of a scene's storeys and links to the tables of the kernels (`kernels.law_table`)."""

from __future__ import annotations

import functools
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, field

import numpy as np

from pounding_cli.kernels import law_table as t
from pounding_cli.kernels.layout import Links
from pounding_cli.laws.law import Branch, Guard, LinkLaw, Quantity
from pounding_cli.laws.program import GIVEN, carried_out, flowing, kept, operations, straight
from pounding_cli.laws.storey import StoreyBranch, StoreyLaw
from pounding_cli.model.links import Link
from pounding_cli.solve.blank import LANES

Rows = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Of branches, guards and operations."""

FAR = 1e100
"""What stands for a gap without end [m]: kernels take differences of it, and inf - inf is none."""


class Tables:
    """Tables as they grow: the rows of every law once, after a row of each that means nothing."""

    def __init__(self) -> None:
        self.branches, self.guards = [_NOTHING], [np.zeros((1, t.GUARD_ROW))]
        self.steps = [np.zeros((1, t.OPERATION_ROW))]
        self.begins, self.sizes = [(0, 0, 0)], (1, 1, 1)
        self.places: dict[Hashable, tuple[int, int]] = {}

    def add(self, law: Hashable, rows: Callable[[], Rows]) -> tuple[int, int]:
        """The first branch of a law and one more than the last; `rows` makes its rows if they are not there yet."""
        if law not in self.places:
            own, ends, steps = rows()
            self.branches.append(own)
            self.guards.append(ends)
            self.steps.append(steps)
            self.begins.append(self.sizes)
            first, asked, done = self.sizes
            self.sizes = first + len(own), asked + len(ends), done + len(steps)
            self.places[law] = first, self.sizes[0]
        return self.places[law]

    def rows(self) -> Rows:
        """Branches, guards and operations; those that rows name are counted from the first of all."""
        begins = np.array(self.begins, float)
        first, asked, done = np.repeat(begins, [len(own) for own in self.branches], axis=0).T[:, :, None]
        branches = np.concatenate(self.branches) + asked * _GUARD_PLACES + done * _STEP_PLACES
        first, asked, done = np.repeat(begins, [len(own) for own in self.guards], axis=0).T[:, :, None]
        guards = np.concatenate(self.guards) + first * _BRANCH_PLACE + done * _SET_PLACES
        return branches, guards, np.concatenate(self.steps)


def memories_of(laws: Sequence[StoreyLaw | None]) -> int:
    """How many memories these laws use."""
    return max((_memories_of(law) for law in {*laws} if law is not None), default=0)


@functools.lru_cache(maxsize=512)
def _memories_of(law: StoreyLaw) -> int:
    branches = _branches_of(law)
    kept_by = (number + 1 for branch in branches for guard in branch.guards for number, _ in guard.sets)
    return max(len(law.memories_at_rest), *(int(branch.flow is not None) for branch in branches), *kept_by)


@functools.lru_cache(maxsize=512)
def _branches_of(law: StoreyLaw) -> tuple[StoreyBranch, ...]:
    return law.branches()


def flow_of(laws: Sequence[StoreyLaw | None]) -> int:
    """The most registers that the rate of a memory takes, given ones included; 0 where none flows."""
    flows = {branch.flow for law in {*laws} if law is not None for branch in _branches_of(law)}
    return max((GIVEN + len(operations(flow)) for flow in flows if flow is not None), default=0)


def storeys_of(laws: Sequence[StoreyLaw | None]) -> Storeys:
    """The rows of these laws, by slot."""
    first = np.full(len(laws), -1)
    tables = Tables()
    for i, law in enumerate(laws):
        if law is not None:
            first[i] = tables.add(law, functools.partial(storey_rows, law))[0] - 1
    if not tables.places:
        return Storeys(None, first)
    branches, guards, steps = (rows[1:] for rows in tables.rows())
    return Storeys((branches - _GUARD_PLACES - _STEP_PLACES, guards - _BRANCH_PLACE - _SET_PLACES, steps), first)


@dataclass(eq=False)
class Storeys:
    """The rows of the laws of a scene's storeys, to stand behind those of its links.

    Parameters
    ----------
    rows : of the laws, each once, which count from the first; None where there are none
    first : by slot the first branch of its law among them, -1 for none
    """

    rows: Rows | None
    first: np.ndarray
    _behind: dict[tuple[int, int, int], tuple[tuple[np.ndarray, ...], np.ndarray]] = field(default_factory=dict)
    """By how many rows stand before them, which is the same for all gaps of a sweep."""

    def after(self, links: Links) -> tuple[tuple[np.ndarray, ...], np.ndarray]:
        """(the tables of the links with these rows behind them, flat; by slot the first branch of its law)."""
        tables = links.branches, links.guards, links.operations
        if self.rows is None:
            return tables, np.zeros(self.first.size, np.int64)
        before = tables[0].size // t.BRANCH_ROW, tables[1].size // t.GUARD_ROW, tables[2].size // t.OPERATION_ROW
        if before not in self._behind:
            self._behind[before] = self._moved(*before)
        rows, first = self._behind[before]
        return tuple([np.concatenate(two) for two in zip(tables, rows, strict=True)]), first

    def _moved(self, count: int, asked: int, done: int) -> tuple[tuple[np.ndarray, ...], np.ndarray]:
        """Behind so many branches, guards and operations."""
        assert self.rows is not None
        branches, guards, steps = self.rows
        branches = branches + asked * _GUARD_PLACES + done * _STEP_PLACES
        guards = guards + count * _BRANCH_PLACE + done * _SET_PLACES
        flat = branches.ravel(), guards.ravel(), steps.ravel()
        return flat, np.where(self.first >= 0, count + self.first, t.NO_BRANCH)


AtRest = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Branch, what is known exactly, and the closing it then has [m], of every link before the motion."""


@functools.lru_cache(maxsize=512)
def pack_links(
    given: tuple[Link, ...],
    slots: tuple[tuple[int, int], ...],
    masses: tuple[tuple[float, float], ...],
    flow: int = 0,
) -> tuple[Links, AtRest]:
    """The links of a scene, between which slots they stand and the masses there [kg], and their state before the
    motion. Links of one law between the same masses share their rows. `flow`: registers of the storeys (`flow_of`)."""
    laws = [(link.law, *between) for link, between in zip(given, masses, strict=True)]
    padded = -(-len(laws) // LANES) * LANES
    left, right, first, last = np.zeros((4, padded), np.int64)
    offset = np.zeros(padded)
    tables = Tables()
    written = flow > 0 or any(law.general for law, *_ in laws)
    for e, key in enumerate(laws):
        left[e], right[e] = slots[e]
        first[e], last[e] = tables.add(key, functools.partial(_link_rows, *key, written))
        offset[e] = min(key[0].offset, FAR)
    branches, guards, steps = tables.rows()
    registers = GIVEN + int(
        np.max(branches[:, [t.LAST_STEP, t.LAST_REGULAR]] - branches[:, [t.FIRST_STEP, t.FIRST_REGULAR]])
    )
    flat = branches.ravel(), guards.ravel(), steps.ravel()
    links = Links(len(laws), padded, max(registers, flow), left, right, offset, first, last, *flat)
    return links, _at_rest(links)


@functools.lru_cache(maxsize=512)
def storey_rows(law: StoreyLaw) -> Rows:
    """As `_link_rows`, of a storey; they count from the law's first."""
    branches = _branches_of(law)
    rows, guards, steps = _rows(branches, [_storey_row(branch, law.stiffness) for branch in branches])
    made = steps.tolist()
    for row, branch in zip(rows, branches, strict=True):
        row[t.FIRST_STORED] = len(made)
        made += operations(branch.stored) if branch.stored is not None else ()
        row[t.LAST_STORED] = len(made)
        if branch.flow is not None:
            flow = operations(branch.flow)
            row[t.FIRST_STEP], row[t.FLOW] = len(made), GIVEN + len(flow) - 1
            made += flow
            row[t.LAST_STEP] = len(made)
    return rows, guards, np.array(made, float).reshape(-1, t.OPERATION_ROW)


@functools.lru_cache(maxsize=512)
def _link_rows(law: LinkLaw, left_mass: float, right_mass: float, written: bool) -> Rows:
    """A row for every branch, for every guard and, where forces are `written` as operations, for each of these; all
    count from the law's first."""
    branches = law.branches(left_mass, right_mass)
    rows, guards, steps = _rows(branches, [_branch_row(branch) for branch in branches])
    if not written:
        return rows, guards, steps
    made = steps.tolist()
    for row, branch in zip(rows, branches, strict=True):
        if branch.closed:
            row[t.FIRST_STEP] = len(made)
            if branch.flow is None:
                made += operations(branch.expression)
            else:
                forces, row[t.FLOW] = flowing(branch.expression, branch.flow)
                made += forces
            row[t.LAST_STEP] = row[t.FIRST_REGULAR] = row[t.LAST_REGULAR] = len(made)
            if branch.regular > 1:
                made += operations(branch.expression, branch.regular)
                row[t.LAST_REGULAR] = len(made)
    return rows, guards, np.array(made, float).reshape(-1, t.OPERATION_ROW)


def _rows(branches: Sequence[Branch | StoreyBranch], rows: list[np.ndarray]) -> Rows:
    """The rows with their guards, and the operations that make what guards keep."""
    number = {branch.name: place for place, branch in enumerate(branches)}
    table = np.stack(rows)
    table[:, t.LAST_GUARD] = np.cumsum([len(branch.guards) for branch in branches])
    table[1:, t.FIRST_GUARD] = table[:-1, t.LAST_GUARD]
    guards: list[np.ndarray] = []
    steps: list[tuple[float, ...]] = []
    for branch in branches:
        for guard in branch.guards:
            row = _guard_row(guard, number)
            made, keeping = kept(guard.sets)
            row[t.FIRST_SET], row[t.FIRST_KEPT] = len(steps), len(steps) + len(made)
            steps += [*made, *keeping]
            row[t.LAST_SET] = len(steps)
            guards.append(row)
    as_rows = np.array(steps, float).reshape(-1, t.OPERATION_ROW)
    return table, np.array(guards).reshape(-1, t.GUARD_ROW), as_rows


def _storey_row(branch: StoreyBranch, stiffness: float) -> np.ndarray:
    row = np.zeros(t.BRANCH_ROW)
    row[t.LINEAR : t.LINEAR + 3] = straight(branch.stiffness)
    row[t.OFFSET : t.OFFSET + 3] = straight(branch.offset)
    row[t.CLOSED] = row[t.ACTS] = 1.0
    row[t.GENERAL] = branch.flow is not None
    row[t.LOW], row[t.HIGH] = -np.inf, np.inf
    unsettled = False  # whether guards have to be asked wherever the drift is
    for guard in branch.guards:
        bound = t.LOW if guard.side > 0 else t.HIGH
        if guard.quantity is Quantity.RATE:
            row[t.TURNS] = guard.side
        elif guard.quantity is Quantity.CLOSING and np.isinf(row[bound]):
            row[bound : bound + 3] = guard.at, guard.of_memory, guard.memory
        else:
            unsettled = True
    if unsettled:
        row[t.LOW : t.LOW + 3] = np.inf, 0.0, 0.0
    row[t.LOST] = 0.0 if branch.lost is None else branch.lost
    row[t.GIVES_BACK] = stiffness if branch.lost is None else 0.0
    return row


def _branch_row(branch: Branch) -> np.ndarray:
    low, high = branch.interval
    row = np.zeros(t.BRANCH_ROW)
    row[t.LINEAR], row[t.CUBIC], row[t.OFFSET] = branch.linear, branch.cubic, branch.offset
    row[t.DASHPOT], row[t.ROOT] = branch.dashpot, branch.root
    row[t.CLOSED], row[t.ACTS], row[t.CUTS] = branch.closed, branch.acts, branch.cut and branch.acts
    row[t.FROM], row[t.TO] = low, high
    row[t.STEEPEST], row[t.STEEPEST_DASHPOT] = branch.steepest
    row[t.GENERAL], row[t.WRITTEN], row[t.REGULAR] = branch.general, branch.force is not None, branch.regular
    row[t.LOW], row[t.HIGH] = (np.inf if branch.cut else low), high  # a force has to be looked at in any case
    return row


def _guard_row(guard: Guard, number: dict[str, int]) -> np.ndarray:
    row = np.zeros(t.GUARD_ROW)
    row[t.QUANTITY], row[t.AT], row[t.SIDE] = guard.quantity, guard.at, guard.side
    row[t.NEXT], row[t.IMPACT], row[t.ONCE] = number[guard.to], guard.impact, guard.once
    row[t.FACTOR], row[t.MEMORY] = guard.of_memory, guard.memory
    return row


_NOTHING = _branch_row(Branch("none", closed=False, acts=False))[None]
"""The row of `law_table.NO_BRANCH`."""

_GUARD_PLACES = np.zeros(t.BRANCH_ROW)
_GUARD_PLACES[[t.FIRST_GUARD, t.LAST_GUARD]] = 1.0
_STEP_PLACES = np.zeros(t.BRANCH_ROW)
_STEP_PLACES[[t.FIRST_STEP, t.LAST_STEP, t.FIRST_REGULAR, t.LAST_REGULAR, t.FIRST_STORED, t.LAST_STORED]] = 1.0
_BRANCH_PLACE = np.zeros(t.GUARD_ROW)
_BRANCH_PLACE[t.NEXT] = 1.0
_SET_PLACES = np.zeros(t.GUARD_ROW)
_SET_PLACES[[t.FIRST_SET, t.FIRST_KEPT, t.LAST_SET]] = 1.0


def _at_rest(links: Links) -> AtRest:
    """Floors that touch are exactly where their first branch ends."""
    begin = 0.0 - links.offset
    low, high = _branches(links)[links.first[:, None], [t.FROM, t.TO]].T
    known = np.where((high == begin) | (low == begin), t.CLOSING, t.NOTHING)
    return links.first, known, np.where(known == t.CLOSING, begin, 0.0)


def acting_at_rest(links: Links) -> np.ndarray:
    """1 for every link whose force acts before the motion, 0 otherwise."""
    return _branches(links)[links.first, t.ACTS].astype(np.int64)


def _branches(links: Links) -> np.ndarray:
    """The table of branches, a row each."""
    return links.branches.reshape(-1, t.BRANCH_ROW)


def stiffest(links: Links) -> tuple[np.ndarray, np.ndarray]:
    """(stiffness [N/m], dashpot [N s/m]) of every link where its law is stiffest, shape (number,)."""
    slope, dashpot = np.zeros((2, links.number))
    for e in range(links.number):
        rows = _branches(links)[links.first[e] : links.last[e]]
        slope[e], dashpot[e] = rows[:, t.STEEPEST].max(), rows[:, t.STEEPEST_DASHPOT].max()
    return slope, dashpot


def force_over_time(
    links: Links, branch: np.ndarray, v: np.ndarray, rate: np.ndarray, memory: np.ndarray
) -> np.ndarray:
    """Force of a link [N] at closings v [m], rates [m/s] and what it remembers, each time on the branch it is on then;
    shape (t,)."""
    row = _branches(links)[branch].T
    if np.any(row[t.WRITTEN]):
        steps = links.operations.reshape(-1, t.OPERATION_ROW)
        force = np.zeros(v.size)
        for b in np.unique(branch):
            here, own = branch == b, _branches(links)[b]
            written = steps[int(own[t.FIRST_STEP]) : int(own[t.LAST_STEP])]
            if own[t.ACTS] and len(written):
                force[here] = carried_out(written, v[here], rate[here], memory[here])
        return force
    elastic = row[t.LINEAR] * v + row[t.OFFSET] + row[t.CUBIC] * v**3
    slope = np.maximum(row[t.LINEAR] + 3 * row[t.CUBIC] * v**2, 0.0)
    return row[t.ACTS] * (elastic + (row[t.DASHPOT] + row[t.ROOT] * np.sqrt(slope)) * rate)
