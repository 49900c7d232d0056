"""From the laws of a scene's links to the tables of the kernels (`kernels.link_table`)."""

from __future__ import annotations

import functools
from collections.abc import Sequence

import numpy as np

from pounding_cli.kernels import link_table as t
from pounding_cli.kernels.layout import Links
from pounding_cli.laws.law import Branch, Guard, LinkLaw
from pounding_cli.laws.program import GIVEN, carried_out, operations
from pounding_cli.model.building import Building
from pounding_cli.model.links import Link

LANES = 8
FAR = 1e100
"""What stands for a gap without end [m]: kernels take differences of it, and inf - inf is none."""


def pack_links(buildings: tuple[Building, ...], given: tuple[Link, ...], floors: Sequence[slice]) -> Links:
    """The links of a scene, floor j of building b in slot `floors[b].start + j - 1`. Links of one law between floors of
    the same masses share their rows."""
    masses = [building.mass.tolist() for building in buildings]
    laws, ends = [], []
    for link in given:
        one, other = link.left_floor - 1, link.right_floor - 1
        laws.append((link.law, masses[link.left][one], masses[link.left + 1][other]))
        ends.append((floors[link.left].start + one, floors[link.left + 1].start + other))
    return _packed(tuple(laws), tuple(ends))


Between = tuple[LinkLaw, float, float]
"""A law and the masses of the floors that it stands between [kg]."""


@functools.lru_cache(maxsize=4096)
def _packed(laws: tuple[Between, ...], ends: tuple[tuple[int, int], ...]) -> Links:
    """Links of these laws between these slots."""
    padded = -(-len(laws) // LANES) * LANES
    left, right, first, last = np.zeros((4, padded), np.int64)
    offset = np.zeros(padded)
    begins: dict[Between, tuple[int, int]] = {}
    branches, guards, steps = [_NOWHERE], [np.zeros((1, t.GUARD_ROW))], [np.zeros((1, t.OPERATION_ROW))]
    count, asked, done = 1, 1, 1
    written = any(law.general for law, *_ in laws)
    for e, key in enumerate(laws):
        if key not in begins:
            own, ends_of_branches, forces = _rows(*key, written)
            begins[key] = count, count + len(own)
            branches.append(own + asked * _GUARD_PLACES + done * _STEP_PLACES)
            guards.append(ends_of_branches + count * _BRANCH_PLACE)
            steps.append(forces)
            count, asked, done = count + len(own), asked + len(ends_of_branches), done + len(forces)
        left[e], right[e] = ends[e]
        first[e], last[e] = begins[key]
        offset[e] = min(key[0].offset, FAR)
    table = np.concatenate(branches)
    registers = GIVEN + int(np.max(table[:, [t.LAST_STEP, t.LAST_REGULAR]] - table[:, [t.FIRST_STEP, t.FIRST_REGULAR]]))
    tables = table.ravel(), np.concatenate(guards).ravel(), np.concatenate(steps).ravel()
    return Links(len(laws), padded, registers, left, right, offset, first, last, *tables)


@functools.lru_cache(maxsize=4096)
def _rows(
    law: LinkLaw, left_mass: float, right_mass: float, written: bool
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A row for every branch, for every guard and, where forces are `written` as operations, for each of these; all
    count from the law's first."""
    branches = law.branches(left_mass, right_mass)
    number = {branch.name: place for place, branch in enumerate(branches)}
    rows = np.stack([_branch_row(branch) for branch in branches])
    rows[:, t.LAST_GUARD] = np.cumsum([len(branch.guards) for branch in branches])
    rows[1:, t.FIRST_GUARD] = rows[:-1, t.LAST_GUARD]
    guards = [_guard_row(guard, number) for branch in branches for guard in branch.guards]
    steps: list[tuple[float, ...]] = []
    for row, branch in zip(rows, branches, strict=True):
        if written and branch.closed:
            row[t.FIRST_STEP] = len(steps)
            steps += operations(branch.expression)
            row[t.LAST_STEP] = row[t.FIRST_REGULAR] = row[t.LAST_REGULAR] = len(steps)
            if branch.regular > 1:
                steps += operations(branch.expression, branch.regular)
                row[t.LAST_REGULAR] = len(steps)
    return rows, np.array(guards).reshape(-1, t.GUARD_ROW), np.array(steps, float).reshape(-1, t.OPERATION_ROW)


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
    row[t.OF_MEMORY], row[t.REMEMBERS] = guard.of_memory, guard.remembers
    return row


_NOWHERE = _branch_row(Branch("none", closed=False, acts=False))[None]
"""The row of places without a link (`link_table.NO_LINK`)."""

_GUARD_PLACES = np.zeros(t.BRANCH_ROW)
_GUARD_PLACES[[t.FIRST_GUARD, t.LAST_GUARD]] = 1.0
_STEP_PLACES = np.zeros(t.BRANCH_ROW)
_STEP_PLACES[[t.FIRST_STEP, t.LAST_STEP, t.FIRST_REGULAR, t.LAST_REGULAR]] = 1.0
_BRANCH_PLACE = np.zeros(t.GUARD_ROW)
_BRANCH_PLACE[t.NEXT] = 1.0


def at_rest(links: Links) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Branch, what is known exactly, and the closing it then has [m], of every link before the motion: floors
    that touch are exactly where their first branch ends."""
    begin = 0.0 - links.offset
    low, high = _branches(links)[links.first[:, None], [t.FROM, t.TO]].T
    known = np.where((high == begin) | (low == begin), t.CLOSING, t.NOTHING)
    return links.first.copy(), known, np.where(known == t.CLOSING, begin, 0.0)  # fault: branch-at-rest


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
