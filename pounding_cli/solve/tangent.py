"""What the tangent of a run tells: of which scenes it is known, and how far a change of the motion moves their
numbers."""

from __future__ import annotations

import functools
from typing import NamedTuple

import numpy as np

from pounding_cli.kernels import law_table as t
from pounding_cli.kernels.layout import Peaks
from pounding_cli.laws.storey import StoreyLaw
from pounding_cli.solve.arrays import Arrays
from pounding_cli.solve.law_tables import storey_rows

CUT = 0.3
"""What the terms that series leave out come to at most, over the accuracy asked, where nothing hands them on."""

OF_FLOORS, OF_ALL = 0.05, 5e-4
"""What the largest relative changes of floors, and of any number, over that of the motion add to that
(docs/accuracy.md)."""

HARMLESS = 0.1
"""Part of the accuracy asked, and of the sensitivity that is flagged, up to which one run is enough (`assess`)."""

ILL_CONDITIONED = 100.0
"""Sensitivity above which a scene is flagged: six digits of the record then give four of the response."""

MOST_SENSITIVE = HARMLESS * ILL_CONDITIONED
"""Sensitivity above which it is measured."""

FINEST_BOUNDED = 1e-7
"""Accuracy asked below which errors are measured: where floors begin to press from rest, some do not fall with it."""


class Moved(NamedTuple):
    """Largest relative change of a run's numbers over that of its motion, which grows from nothing at its start [-],
    shape (runs,) each.

    storeys : of the largest drift, and so of the shear, of any storey
    floors : of any drift or displacement at any time, over its largest value
    all : of any number: accelerations, displacements, and of links closings, forces, impulses and contact times, each
        relative to what `assess.difference` has it relative to
    """

    storeys: np.ndarray
    floors: np.ndarray
    all: np.ndarray


@functools.lru_cache(maxsize=64)  # the same for every motion
def is_known(arrays: Arrays) -> bool:
    """Whether the tangent follows all that may happen: no force is written as operations, links end at floors and
    remember nothing, and what a storey remembers is told by the drift at which it turned back."""
    if arrays.written or arrays.flows or arrays.columns:
        return False
    joined = {*arrays.links.left[: arrays.links.number].tolist(), *arrays.links.right[: arrays.links.number].tolist()}
    if joined & {*arrays.points.slot[: arrays.points.number].tolist()}:
        return False
    if not all([_is_known_of(law) for law in arrays.laws if law is not None]):
        return False
    storeys = min([b for b in arrays.slots.branch.tolist() if b != t.NO_BRANCH], default=None)
    table = arrays.slots.branches.reshape(-1, t.BRANCH_ROW)[:storeys]
    guards = arrays.slots.guards.reshape(-1, t.GUARD_ROW)[: int(table[-1, t.LAST_GUARD])]
    return not table[:, [t.GENERAL, t.LINEAR_FACTOR]].any() and all(
        [guard[t.QUANTITY] in (t.CLOSING, t.FORCE) and not guard[t.FACTOR] and guard[t.FIRST_SET] == guard[t.LAST_SET]
         for guard in guards[1:].tolist()]
    )  # fmt: skip


@functools.lru_cache(maxsize=512)
def _is_known_of(law: StoreyLaw) -> bool:
    """Whether what storeys of a law remember is told by the drift at which they turned back."""
    branches, guards, _ = storey_rows(law)
    return not branches[:, [t.GENERAL, t.LINEAR_FACTOR]].any() and all(
        [asked == t.RATE or (asked == t.CLOSING and not branches[int(following), t.OFFSET_FACTOR])
         for asked, following in guards[:, [t.QUANTITY, t.NEXT]].tolist()]
    )  # fmt: skip


def moved(arrays: Arrays, peaks: Peaks) -> Moved:
    """From the peaks of runs that carried a tangent, a row each."""
    runs, slots, links = len(peaks.tangent), arrays.padded, arrays.links.size
    drift, most, displacement, acceleration = peaks.tangent[:, : 4 * slots].reshape(runs, 4, slots).swapaxes(0, 1)
    closing, force, shift, impulse = peaks.tangent[:, 4 * slots :].reshape(runs, 4, links).swapaxes(0, 1)
    reach = np.maximum(peaks.displacement_max, -peaks.displacement_min)
    floors = np.maximum(_over(most, peaks.drift), _over(displacement, reach))
    every = [floors, _over(acceleration, peaks.acceleration)]
    number = arrays.links.number
    if number:
        kinds = (closing, peaks.closing), (force, peaks.force), (shift, peaks.contact_time), (impulse, peaks.impulse)
        for each, size in kinds:
            largest = np.abs(size[:, :number]).max(axis=1, keepdims=True)
            every.append(_over(each[:, :number], largest))
    return Moved(_over(drift, peaks.drift), floors, np.max(every, axis=0))


def bounds(found: Moved, accuracy: np.ndarray) -> np.ndarray:
    """Bounds of the errors of runs by what was `found` of them [-], nan where that is not enough: where the bound is
    above the accuracy asked, the sensitivity is to be measured, or rounding is near; shape (runs,)."""
    bound = (CUT + OF_FLOORS * found.floors + OF_ALL * found.all) * accuracy
    enough = (bound <= accuracy) & (found.storeys <= MOST_SENSITIVE) & (accuracy >= FINEST_BOUNDED)
    return np.where(enough, bound, np.nan)


def _over(change: np.ndarray, size: np.ndarray) -> np.ndarray:
    """Largest change over a size, 0 where there is no size, shape (runs,)."""
    size = np.where(size > 0.0, size, np.inf)
    return np.max(change / size, axis=1, initial=0.0)
