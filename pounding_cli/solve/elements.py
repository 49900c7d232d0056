"""The elements of a scene: everything that acts between its degrees of freedom, each with its terms.

An element acts on v, a sum of weight x displacement: a storey on its drift, a link on the closing of two floors, a base
on its sway or its angle, the drag of mass-proportional damping on the motion of a floor against its base, P-Delta on
the difference of two floors' displacements, what rocking adds included: by that the columns lean. Its force
goes back through the same weights, so that it puts in or takes out the work of that force and no other."""

from __future__ import annotations

import functools

import numpy as np

from pounding_cli.kernels.layout import Elements
from pounding_cli.solve.arrays import Arrays

Terms = list[tuple[int, float]]
"""(degree of freedom, weight), ..."""


@functools.lru_cache(maxsize=8)
def elements_of(arrays: Arrays) -> Elements:
    """All elements, in the order of `layout.Elements`."""
    slots, foundations, links = arrays.slots, arrays.foundations, arrays.links
    size, count = slots.size, foundations.number
    rocks = np.isfinite(foundations.inertia)
    on = {i: f for f in range(count) for i in range(foundations.first[f], foundations.stop[f])}
    terms = [_storey_terms(arrays, i, on) for i in range(size)]
    stiffness, dashpot = slots.stiffness.tolist(), slots.dashpot.tolist()
    for f in np.flatnonzero(rocks):
        terms.append([(size + int(f), 1.0)])
        stiffness.append(foundations.stiffness[f])
        dashpot.append(foundations.dashpot[f])
    for i in range(size):
        if i in on and foundations.alpha[on[i]] > 0.0:
            terms.append(_drag_terms(arrays, i, on[i]))
            stiffness.append(0.0)
            dashpot.append(foundations.alpha[on[i]] * slots.mass[i])
    for i in np.flatnonzero(slots.geometric).tolist():
        terms.append([(i, 1.0), (i - 1, -1.0)] if slots.couple[i] else [(i, 1.0)])
        stiffness.append(-float(slots.geometric[i]))
        dashpot.append(0.0)
    springs = len(terms)
    terms += [[(int(links.left[e]), 1.0), (int(links.right[e]), -1.0)] for e in range(links.number)]
    mass = np.concatenate((slots.mass, np.where(rocks, foundations.inertia, 1.0)))
    inverse = np.concatenate((slots.inverse_mass, np.where(rocks, 1.0 / foundations.inertia, 0.0)))
    ends = np.array([_two(own) for own in terms])
    each = [term for own in terms for term in own[2:]]
    return Elements(
        number=len(terms),
        freedoms=size + count,
        springs=springs,
        one=ends[:, 0, 0].astype(np.int64),
        other=ends[:, 1, 0].astype(np.int64),
        weight_one=ends[:, 0, 1].copy(),
        weight_other=ends[:, 1, 1].copy(),
        more=int(len(each) > 0),
        first=np.concatenate(([0], np.cumsum([len(own[2:]) for own in terms]))).astype(np.int64),
        freedom=np.array([freedom for freedom, _ in each], np.int64),
        weight=np.array([weight for _, weight in each]),
        stiffness=np.array(stiffness),
        dashpot=np.array(dashpot),
        mass=mass,
        inverse_mass=inverse,
        drag=np.concatenate((slots.alpha * slots.mass, np.zeros(count))),
        loaded=np.concatenate((slots.real, np.zeros(count))),
    )


def _storey_terms(arrays: Arrays, i: int, on: dict[int, int]) -> Terms:
    """Of the spring below slot i: its drift, without what the rocking of its base adds."""
    slots = arrays.slots
    if not slots.real[i]:
        return []
    terms = [(i, 1.0)]
    if slots.couple[i]:
        terms.append((i - 1, -1.0))
    if slots.rise[i]:
        terms.append((slots.size + on[i], -float(slots.rise[i])))
    return terms


def _drag_terms(arrays: Arrays, i: int, f: int) -> Terms:
    """Of the drag on slot i: its motion against foundation f, which sways or rocks."""
    terms, foundations = [(i, 1.0)], arrays.foundations
    if foundations.base[f] >= 0:
        terms.append((int(foundations.base[f]), -1.0))
    if np.isfinite(foundations.inertia[f]):
        terms.append((arrays.slots.size + f, -float(arrays.slots.elevation[i])))
    return terms


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
