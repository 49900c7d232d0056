"""From the laws of a scene's links to the tables of the kernels (`kernels.link_table`)."""

from __future__ import annotations

import functools

import numpy as np

from pounding_cli.kernels import link_table as t
from pounding_cli.kernels.layout import Links
from pounding_cli.laws.law import Branch, Guard, LinkLaw, Quantity
from pounding_cli.model.building import Building
from pounding_cli.model.links import Link

LANES = 8
FAR = 1e100
"""What stands for a gap without end [m]: kernels take differences of it, and inf - inf is none."""

_NONE = Branch("none", closed=False, acts=False)
"""What stands in the table for places without a link."""


def pack_links(buildings: tuple[Building, ...], given: tuple[Link, ...], floors: list[slice]) -> Links:
    """The links of a scene, floor j of building b in slot `floors[b].start + j - 1`. Links of one law between floors of
    the same masses share their rows."""
    padded = -(-len(given) // LANES) * LANES
    integers = np.zeros((4, padded), np.int64)
    left, right, first, last = integers
    offset = np.zeros(padded)
    begins: dict[tuple[LinkLaw, float, float], int] = {}
    branches, guards = [_branch_row(_NONE, 0)], [np.zeros(t.GUARD_ROW)]
    for e, link in enumerate(given):
        masses = buildings[link.left].mass[link.left_floor - 1], buildings[link.left + 1].mass[link.right_floor - 1]
        key = (link.law, float(masses[0]), float(masses[1]))
        own = _rows(*key)
        if key not in begins:
            begins[key] = len(branches)
            for row, ends in own:
                row = row.copy()
                row[[t.FIRST_GUARD, t.LAST_GUARD]] += len(guards)
                branches.append(row)
                for guard in ends:
                    guard = guard.copy()
                    guard[t.NEXT] += begins[key]
                    guards.append(guard)
        left[e] = floors[link.left].start + link.left_floor - 1
        right[e] = floors[link.left + 1].start + link.right_floor - 1
        first[e], last[e] = begins[key], begins[key] + len(own)
        offset[e] = min(link.law.offset, FAR)
    tables = np.concatenate(branches), np.concatenate(guards)
    return Links(len(given), padded, left, right, offset, first, last, *tables)


@functools.lru_cache(maxsize=1024)
def _rows(law: LinkLaw, left_mass: float, right_mass: float) -> tuple[tuple[np.ndarray, tuple[np.ndarray, ...]], ...]:
    """(row, rows of its guards) of every branch; branches and guards count from the law's first."""
    branches = law.branches(left_mass, right_mass)
    number = {branch.name: place for place, branch in enumerate(branches)}
    return tuple(
        (_branch_row(branch, len(branch.guards)), tuple(_guard_row(guard, number) for guard in branch.guards))
        for branch in branches
    )


def _branch_row(branch: Branch, guards: int) -> np.ndarray:
    low, high = branch.interval
    row = np.zeros(t.BRANCH_ROW)
    row[t.LINEAR], row[t.CUBIC], row[t.OFFSET] = branch.linear, branch.cubic, branch.offset
    row[t.DASHPOT], row[t.ROOT] = branch.dashpot, branch.root
    row[t.CLOSED], row[t.ACTS], row[t.CUTS] = branch.closed, branch.acts, branch.cut and branch.acts
    row[t.FROM], row[t.TO] = low, high
    row[t.LOW], row[t.HIGH] = (np.inf if branch.cut else low), high  # a force has to be looked at in any case
    row[t.LAST_GUARD] = guards
    return row


def _guard_row(guard: Guard, number: dict[str, int]) -> np.ndarray:
    row = np.zeros(t.GUARD_ROW)
    row[t.QUANTITY], row[t.AT], row[t.SIDE] = guard.quantity, guard.at, guard.side
    row[t.NEXT], row[t.IMPACT], row[t.ONCE] = number[guard.to], guard.impact, guard.once
    return row


def at_rest(links: Links) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Branch, what is known exactly, and the closing it then has [m], of every link before the motion."""
    known = np.zeros(links.size, np.int64)
    at = np.zeros(links.size)
    for e in range(links.number):
        for g in _guards(links, links.first[e]):
            if g[t.QUANTITY] == Quantity.CLOSING and g[t.AT] == -links.offset[e]:
                known[e], at[e] = t.CLOSING, g[t.AT]
    return links.first.copy(), known, at  # fault: branch-at-rest


def acting_at_rest(links: Links) -> np.ndarray:
    """1 for every link whose force acts before the motion, 0 otherwise."""
    return _branches(links)[links.first, t.ACTS].astype(np.int64)


def _branches(links: Links) -> np.ndarray:
    """The table of branches, a row each."""
    return links.branches.reshape(-1, t.BRANCH_ROW)


def _guards(links: Links, branch: int) -> np.ndarray:
    """The guards of a branch, a row each."""
    first, last = _branches(links)[branch, [t.FIRST_GUARD, t.LAST_GUARD]].astype(int)
    return links.guards.reshape(-1, t.GUARD_ROW)[first:last]


def stiffest(links: Links) -> tuple[np.ndarray, np.ndarray]:
    """(stiffness [N/m], dashpot [N s/m]) of every link where its law is stiffest, shape (number,)."""
    slope, dashpot = np.zeros((2, links.number))
    for e in range(links.number):
        rows = _branches(links)[links.first[e] : links.last[e]]
        high = np.where(np.isfinite(rows[:, t.TO]) & (rows[:, t.CUBIC] != 0), rows[:, t.TO], 0.0)
        slopes = rows[:, t.LINEAR] + 3 * rows[:, t.CUBIC] * high**2
        dashpots = rows[:, t.DASHPOT] + rows[:, t.ROOT] * np.sqrt(slopes)
        slope[e], dashpot[e] = slopes.max(), dashpots.max()
    return slope, dashpot


def force_over_time(links: Links, branch: np.ndarray, v: np.ndarray, rate: np.ndarray) -> np.ndarray:
    """Force of a link [N] at closings v [m] and rates [m/s], each time on the branch it is on then; shape (t,)."""
    row = _branches(links)[branch].T
    elastic = row[t.LINEAR] * v + row[t.OFFSET] + row[t.CUBIC] * v**3
    slope = np.maximum(row[t.LINEAR] + 3 * row[t.CUBIC] * v**2, 0.0)
    return row[t.ACTS] * (elastic + (row[t.DASHPOT] + row[t.ROOT] * np.sqrt(slope)) * rate)
