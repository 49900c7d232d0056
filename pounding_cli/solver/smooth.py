"""Steps by DOP853 (Hairer, Norsett & Wanner 1993, II.10), while a force acts that has no Taylor series.

The dense output gives displacements and velocities inside the step. The accelerations at eight Chebyshev points of it,
by the equations of motion, give a polynomial of the accelerations, and its integral the velocities: a step that events,
peaks and energies treat like one by series, of order 8.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from scipy.integrate import DOP853

from pounding_cli.solver.dispatch import history_rate, smooth_force
from pounding_cli.solver.options import CALLED, INVERSE, PART
from pounding_cli.solver.records import NOT_FINITE
from pounding_cli.solver.series import line_force, push

STAGES = DOP853.n_stages
EXTRA = DOP853.A_EXTRA.shape[0]
ALL = STAGES + 1 + EXTRA
"""Stages of a step, and with the derivative at its end and those of the dense output."""

A = np.zeros((ALL, ALL))
A[:STAGES, :STAGES], A[STAGES + 1 :, :] = DOP853.A, DOP853.A_EXTRA
B, C = DOP853.B, np.concatenate((DOP853.C, [1.0], DOP853.C_EXTRA))
E3, E5, D = DOP853.E3, DOP853.E5, DOP853.D

ORDER = 8
PLACES = 0.5 - 0.5 * np.cos(np.pi * np.arange(ORDER) / (ORDER - 1))
FIT = np.ascontiguousarray(np.linalg.inv(np.vander(PLACES, increasing=True)))
"""Coefficients of a polynomial of degree 7 from its values at PLACES."""

ROWS = 10
"""Rows of states: the step's start, its end, a stage, seven coefficients of the dense output."""

STAGE, SPARE = np.int64(2), np.int64(ALL)
"""Row of a stage, and of derivatives that are looked at once. Numba compiles a call with a literal number anew."""

SAFETY, LEAST, MOST = 0.9, 0.2, 6.0
"""Of the next step over this one: margin, least and most."""

SHORTEST = 1e-15
"""Part of a sample of the motion below which no step is tried."""


@njit(**PART)
def _element_force(el, v, rate, Y, row, room):
    """Force of an element whose history variable, if it changes all the time, stands in Y [N]."""
    held = el.h[0]
    if el.state > 0:
        el.h[0] = Y[row, el.state]
    f = line_force(el, v, rate)
    if el.smooth:
        f += smooth_force(el, v, rate, room)
    el.h[0] = held
    return f


@njit(**PART)
def _link_at(terms, el, Y, row, n):
    """Deformation and rate of a link in a state."""
    v, rate = Y[row, el.left] - Y[row, el.right] - el.offset, Y[row, n + el.left] - Y[row, n + el.right]
    for x in range(el.first, el.last):
        v += terms[x].weight * Y[row, terms[x].dof]
        rate += terms[x].weight * Y[row, n + terms[x].dof]
    return v, rate


@njit(**PART)
def _storey_at(d, i, Y, row, n, has_lean):
    """Drift and its rate of storey i in a state."""
    v, rate = Y[row, i], Y[row, n + i]
    if d.below != 0.0:
        v, rate = v - Y[row, i - 1], rate - Y[row, n + i - 1]
    if has_lean:
        v, rate = v + d.lean * Y[row, d.foot], rate + d.lean * Y[row, n + d.foot]
    return v, rate


@njit(**CALLED)
def _derivative(dofs, elements, terms, r, series, room, row, s, to):
    """Rates of displacements, velocities and history variables Y[row] at the part s of the step, into K[to]."""
    Y, K, n = room.Y, room.K, r.n
    ground = r.g0 + r.g1 * s
    for i in range(n):
        K[to, i] = Y[row, n + i]
        dofs[i].push = dofs[i].mass * dofs[i].loaded * ground
    for a in range(r.active):
        el = elements[series[a].element]
        v, rate = _link_at(terms, el, Y, row, n)
        f = _element_force(el, v, rate, Y, row, room)
        if el.state > 0:
            K[to, el.state] = el.k * rate - el.relaxation * Y[row, el.state]
        if el.acts:
            push(dofs, terms, el, f)
    for i in range(n):
        el, d = elements[i], dofs[i]
        v, rate = _storey_at(d, i, Y, row, n, r.has_lean)
        f = _element_force(el, v, rate, Y, row, room)
        if el.state > 0:
            K[to, el.state] = history_rate(el, rate, Y[row, el.state])
        if r.has_lean:
            dofs[d.foot].push += d.lean * f
        if el.load != 0.0:
            f -= el.load * (Y[row, i] - (Y[row, i - 1] if d.below != 0.0 else 0.0))
        d.push += f
        if d.below != 0.0:
            dofs[i - 1].push -= f
    for i in range(n):
        d = dofs[i]
        K[to, n + i] = -d.inv_mass * d.push - d.drag * Y[row, n + i]


@njit(**PART)
def _stage(Y, K, h, weights, count, size, to):
    """Y[to] = Y[0] + h (weights K)."""
    for i in range(size):
        Y[to, i] = 0.0
    for j in range(count):
        w = weights[j] * h
        if w != 0.0:
            for i in range(size):
                Y[to, i] += w * K[j, i]
    for i in range(size):
        Y[to, i] += Y[0, i]


@njit(**PART)
def _error(r, Y, K, scale, size, h):
    """Error of the step over what it may be [-], the largest of all states: in a long row a mean would hide it.

    Infinite where a state is not finite, which a comparison passes over."""
    worst5 = worst3 = total = 0.0
    for i in range(size):
        e5 = e3 = 0.0
        for j in range(STAGES):
            e5 += E5[j] * K[j, i]
            e3 += E3[j] * K[j, i]
        per = 1.0 / (r.smooth_tolerance * max(scale[i], abs(Y[0, i]), abs(Y[1, i])))
        worst5, worst3 = max(worst5, abs(e5 * per)), max(worst3, abs(e3 * per))
        total += abs(e5 * per)
    if not total < math.inf:
        return math.inf
    if worst5 == 0.0 and worst3 == 0.0:
        return 0.0
    return h * worst5 * worst5 / math.hypot(worst5, 0.1 * worst3)


@njit(**CALLED)
def take_smooth(dofs, elements, terms, r, series, room):
    """A step that DOP853 accepts: the velocities' polynomials in `dofs`, the forces' in `series`."""
    Y, K = room.Y, room.K
    n, size = r.n, r.size
    for i in range(n):
        Y[0, i], Y[0, n + i] = dofs[i].u0, dofs[i].w[0]
    for e in range(r.m):
        if elements[e].state > 0:
            Y[0, elements[e].state] = elements[e].h[0]
    if r.h > r.next > 0.0:
        part = 1.0 / math.ceil(r.h / r.next - 1e-9)
        r.h *= part
        r.g1 *= part
    first = 0
    while True:
        h = r.h
        for stage in range(first, STAGES):
            if stage > 0:
                _stage(Y, K, h, A[stage], stage, size, 1)
            _derivative(dofs, elements, terms, r, series, room, min(stage, 1), C[stage], stage)
        first = 1
        _stage(Y, K, h, B, STAGES, size, 1)
        error = _error(r, Y, K, room.scale, size, h)
        factor = min(MOST, SAFETY * error ** (-0.125)) if error > 0.0 else MOST
        if error < 1.0:
            break
        factor = max(LEAST, factor) if error < 1e300 else LEAST
        r.h *= factor
        r.g1 *= factor
        r.trials += 1
        if r.h < SHORTEST * r.dt:
            r.status = NOT_FINITE
            return
    if r.onset < 0.0:  # the first step of a contact: where its force has no derivatives steps have to grow anew
        r.onset = h
    r.next = h * max(factor, LEAST)
    for stage in range(STAGES, ALL):
        if stage > STAGES:
            _stage(Y, K, h, A[stage], stage, size, STAGE)
        _derivative(dofs, elements, terms, r, series, room, 1 if stage == STAGES else STAGE, C[stage], stage)
    _dense(r, Y, K)
    _at_places(dofs, elements, terms, r, series, room)
    _fit(dofs, elements, r, series)


@njit(**PART)
def _dense(r, Y, K):
    """Coefficients of the dense output, rows 3 to 9 of the states."""
    h = r.h
    for i in range(r.size):
        d = Y[1, i] - Y[0, i]
        Y[3, i] = d
        Y[4, i] = h * K[0, i] - d
        Y[5, i] = 2.0 * d - h * (K[STAGES, i] + K[0, i])
        for q in range(4):
            total = 0.0
            for j in range(ALL):
                total += D[q, j] * K[j, i]
            Y[6 + q, i] = h * total


@njit(**PART)
def _dense_value(Y, i, s):
    """State i at the part s of the step."""
    y = Y[9, i]
    for q in range(5, -1, -1):
        y = y * (s if q % 2 else 1.0 - s) + Y[3 + q, i]
    return Y[0, i] + s * y


@njit(**PART)
def _at_places(dofs, elements, terms, r, series, room):
    """Accelerations, and rates and forces of links that act and of smooth storeys, at PLACES."""
    Y, K, n = room.Y, room.K, r.n
    for place in range(ORDER):
        s = PLACES[place]
        for i in range(r.size):
            Y[STAGE, i] = _dense_value(Y, i, s) if place < ORDER - 1 else Y[1, i]
        _derivative(dofs, elements, terms, r, series, room, STAGE, s, SPARE)
        for i in range(n):
            dofs[i].inside[place] = K[SPARE, n + i]
        for a in range(r.active):
            el = elements[series[a].element]
            v, rate = _link_at(terms, el, Y, STAGE, n)
            if place == 0 and el.pinned:
                v, rate = el.v0, el.r0
            series[a].rate[place], series[a].f[place] = rate, _element_force(el, v, rate, Y, STAGE, room)
        for i in range(n):
            el = elements[i]
            if el.smooth:
                v, rate = _storey_at(dofs[i], i, Y, STAGE, n, r.has_lean)
                f = _element_force(el, v, rate, Y, STAGE, room) - el.c * rate
                series[el.row].rate[place], series[el.row].f[place] = rate, f


@njit(**CALLED)
def _to_powers(values):
    """Coefficients from the values at PLACES that begin a row, in their place."""
    c0 = c1 = c2 = c3 = c4 = c5 = c6 = c7 = 0.0
    for j in range(ORDER):
        x = values[j]
        c0, c1, c2, c3 = c0 + FIT[0, j] * x, c1 + FIT[1, j] * x, c2 + FIT[2, j] * x, c3 + FIT[3, j] * x
        c4, c5, c6, c7 = c4 + FIT[4, j] * x, c5 + FIT[5, j] * x, c6 + FIT[6, j] * x, c7 + FIT[7, j] * x
    values[0], values[1], values[2], values[3] = c0, c1, c2, c3
    values[4], values[5], values[6], values[7] = c4, c5, c6, c7


@njit(**PART)
def _fit(dofs, elements, r, series):
    """Polynomials of velocities and forces."""
    r.order = ORDER
    for i in range(r.n):
        d = dofs[i]
        _to_powers(d.inside)
        d.a0 = d.inside[0] + r.g0
        for k in range(ORDER):
            d.w[k + 1] = d.inside[k] * r.h * INVERSE[k + 1]
    for a in range(r.active):
        _to_powers(series[a].rate)
        _to_powers(series[a].f)
    for i in range(r.n):
        if elements[i].smooth:
            _to_powers(series[elements[i].row].rate)
            _to_powers(series[elements[i].row].f)


@njit(**PART)
def end_of_smooth(dofs, elements, r, room):
    """History variables at the end of the step, and what errors are measured by."""
    Y, scale = room.Y, room.scale
    n, s, whole = r.n, r.end, r.end == 1.0
    for e in range(r.m):
        el = elements[e]
        if el.state > 0:
            el.h[0] = Y[1, el.state] if whole else _dense_value(Y, el.state, s)
    if whole:
        for i in range(n):
            dofs[i].u1, dofs[i].v1 = Y[1, i], Y[1, n + i]
    for i in range(r.size):
        scale[i] = max(scale[i], 0.01 * abs(Y[1, i]))
