"""The elements of a scene: everything that acts between its degrees of freedom, each with its terms.

An element acts on v, a sum of weight x displacement: a storey on its drift, a link on the closing of two floors, a base
on its sway or its rocking, the drag of mass-proportional damping on the motion of a floor against its base, P-Delta on
the difference of two floors' displacements, what rocking adds included: by that the columns lean. Its force goes back
through the same weights, so that it puts in or takes out the work of that force and no other."""

from __future__ import annotations

import functools

import numpy as np

from pounding_cli.kernels.layout import Elements
from pounding_cli.solve.arrays import Arrays
from pounding_cli.solve.places import Terms, listed


@functools.lru_cache(maxsize=8)
def elements_of(arrays: Arrays) -> Elements:
    """All elements, in the order of `layout.Elements`."""
    slots, springs, links = arrays.slots, arrays.springs, arrays.links
    size = slots.size
    at_point = dict(zip(arrays.points.slot.tolist(), listed(arrays.points), strict=False))
    terms = [_storey_terms(arrays, i, at_point) for i in range(size)] + listed(springs)
    leaning = np.flatnonzero(slots.geometric)
    terms += [[(i, 1.0), (i - 1, -1.0)] if slots.couple[i] else [(i, 1.0)] for i in leaning.tolist()]
    springs_end = len(terms)
    for left, right in zip(links.left[: links.number].tolist(), links.right[: links.number].tolist(), strict=True):
        terms.append(_resolved(left, 1.0, at_point) + _resolved(right, -1.0, at_point))
    moves = slots.mass > 0.0
    ends = np.array([_two(own) for own in terms])
    more = [term for own in terms for term in own[2:]]
    return Elements(
        number=len(terms),
        freedoms=size,
        springs=springs_end,
        one=ends[:, 0, 0].astype(np.int64),
        other=ends[:, 1, 0].astype(np.int64),
        weight_one=ends[:, 0, 1].copy(),
        weight_other=ends[:, 1, 1].copy(),
        more=int(len(more) > 0),
        first=np.concatenate(([0], np.cumsum([len(own[2:]) for own in terms]))).astype(np.int64),
        freedom=np.array([freedom for freedom, _ in more], np.int64),
        weight=np.array([weight for _, weight in more]),
        stiffness=np.concatenate((slots.stiffness, springs.stiffness[: springs.number], -slots.geometric[leaning])),
        dashpot=np.concatenate((slots.dashpot, springs.dashpot[: springs.number], np.zeros(leaning.size))),
        unknown=np.where(moves, np.cumsum(moves) - 1, -1),
        inverse_mass=slots.inverse_mass,
        drag=slots.alpha * slots.mass,
        loaded=slots.loaded,
        shears=arrays.points.shears,
    )


def _resolved(slot: int, weight: float, at_point: dict[int, Terms]) -> Terms:
    """`weight` times the motion of a slot, a point told by its terms."""
    return [(freedom, weight * part) for freedom, part in at_point.get(slot, [(slot, 1.0)])]


def _storey_terms(arrays: Arrays, i: int, at_point: dict[int, Terms]) -> Terms:
    """Of the spring below slot i."""
    if arrays.slots.mass[i] == 0.0:
        return []
    return [(i, 1.0)] + (_resolved(i - 1, -1.0, at_point) if arrays.slots.couple[i] else [])


def _two(terms: Terms) -> Terms:
    """The first two terms; where there is one, the other weighs nothing on the same freedom, so that what grows without
    bound there stays there."""
    one = terms[0] if terms else (0, 0.0)
    return [one, terms[1] if len(terms) > 1 else (one[0], 0.0)]


def term_matrix(elements: Elements) -> np.ndarray:
    """Rows that give what every element acts on from the displacements, shape (elements, freedoms)."""
    matrix = np.zeros((elements.number, elements.freedoms))
    each = np.arange(elements.number)
    for owner, freedom, weight in (
        (each, elements.one, elements.weight_one),
        (each, elements.other, elements.weight_other),
        (np.repeat(each, np.diff(elements.first)), elements.freedom, elements.weight),
    ):
        np.add.at(matrix, (owner, freedom), weight)
    return matrix
