"""Steps by DOP853 (Hairer, Norsett & Wanner 1993, II.10), while a force acts that has no Taylor series.

The dense output gives displacements and velocities inside the step. The accelerations at eight Chebyshev points of it,
by the equations of motion, give a polynomial of the accelerations, and its integral the velocities: a step that events,
peaks and energies treat like one by series, of order 8.
"""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
from numba import njit

from pounding_cli.solver.dispatch import history_rate, smooth_force
from pounding_cli.solver.events import ends_of_elements
from pounding_cli.solver.options import CALLED, INVERSE, PART, bare
from pounding_cli.solver.records import NOT_FINITE, STEP_BOUND, Room
from pounding_cli.solver.series import line_force, push, push_by_storey

_TABLES = {
    name: np.array(values)
    for name, values in json.loads(Path(__file__).with_name("dop853.json").read_text(encoding="ascii")).items()
}
"""The coefficients as SciPy has them (tools/dop853.py)."""

STAGES, EXTRA = len(_TABLES["A"]), len(_TABLES["A_EXTRA"])
ALL = STAGES + 1 + EXTRA
"""Stages of a step, and with the derivative at its end and those of the dense output."""

A = np.zeros((ALL, ALL))
A[:STAGES, :STAGES], A[STAGES + 1 :, :] = _TABLES["A"], _TABLES["A_EXTRA"]
B, C = _TABLES["B"], np.concatenate((_TABLES["C"], [1.0], _TABLES["C_EXTRA"]))
E3, E5, D = _TABLES["E3"], _TABLES["E5"], _TABLES["D"]

ORDER = 8
PLACES = 0.5 - 0.5 * np.cos(np.pi * np.arange(ORDER) / (ORDER - 1))
FIT = np.ascontiguousarray(np.linalg.inv(np.vander(PLACES, increasing=True)))
"""Coefficients of a polynomial of degree 7 from its values at PLACES."""

STAGE, SPARE = np.int64(2), np.int64(ALL)
"""Places of a stage, and of derivatives that are looked at once (`records.STATE`). Numba compiles a call with a literal
number anew."""

SAFETY, LEAST, MOST = 0.9, 0.2, 6.0
"""Of the next step over this one: margin, least and most."""

SHORTEST = 1e-15
"""Part of a sample of the motion below which no step is tried."""


@njit(**PART)
def _set_state(dofs, elements, terms, r, states, at):
    """A state as displacements, velocities, deformations, rates and history variables of the records."""
    for i in range(r.n):
        dofs[i].u1, dofs[i].v1 = states[i].y[at], states[r.n + i].y[at]
    ends_of_elements(dofs, elements, terms, r)
    for e in range(r.m):
        el = elements[e]
        if el.state > 0:
            el.h[0] = states[el.state].y[at]


@njit(**PART)
def _element_force(el, formula):
    """Force of an element at its deformation and rate of now [N], kept in f1."""
    f = line_force(el, el.v1, el.r1)
    if el.smooth:
        f += smooth_force(el, el.v1, el.r1, formula)
    el.f1 = f
    return f


@njit(**CALLED)
def _derivative(dofs, elements, terms, r, series, room, at, s, to):
    """Derivatives of the states y[at], at the part s of the step, into k[to]."""
    states, formulas, n = room.states, room.formulas, r.n
    _set_state(dofs, elements, terms, r, states, at)
    ground = r.g0 + r.g1 * s
    for i in range(n):
        states[i].k[to] = dofs[i].v1
        dofs[i].push = dofs[i].mass * dofs[i].loaded * ground
    for a in range(r.active):
        el = elements[series[a].element]
        f = _element_force(el, formulas[el.formula])
        if el.state > 0:
            states[el.state].k[to] = el.k * el.r1 - el.relaxation * el.h[0]
        if el.acts:
            push(dofs, terms, el, f)
    for i in range(n):
        el = elements[i]
        f = _element_force(el, formulas[el.formula])
        if el.state > 0:
            states[el.state].k[to] = history_rate(el, el.r1, el.h[0])
        push_by_storey(dofs, el, i, f, r.has_lean)
    for i in range(n):
        d = dofs[i]
        states[n + i].k[to] = -d.inv_mass * d.push - d.drag * d.v1


@njit(**PART)
def _stage(states, h, weights, count, to):
    """y[to] = y[0] + h (weights k)."""
    for i in range(states.size):
        state = states[i]
        total = 0.0
        for j in range(count):
            total += weights[j] * state.k[j]
        state.y[to] = state.y[0] + h * total


@njit(**PART)
def _error(r, states, h):
    """Error of the step over what it may be [-], the largest of all states: in a long row a mean would hide it.

    Infinite where a state is not finite, which a comparison passes over."""
    worst5 = worst3 = total = 0.0
    for i in range(states.size):
        state = states[i]
        e5 = e3 = 0.0
        for j in range(STAGES):
            e5 += E5[j] * state.k[j]
            e3 += E3[j] * state.k[j]
        per = 1.0 / (r.smooth_tolerance * max(state.scale, abs(state.y[0]), abs(state.y[1])))
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
    room = Room(bare(room.states), bare(room.formulas))
    states, n = room.states, r.n
    for i in range(n):
        states[i].y[0], states[n + i].y[0] = dofs[i].u0, dofs[i].w[0]
    for e in range(r.m):
        if elements[e].state > 0:
            states[elements[e].state].y[0] = elements[e].h[0]
    if r.h > r.next > 0.0:
        part = 1.0 / math.ceil(r.h / r.next - 1e-9)
        r.h *= part
        r.g1 *= part
    first = 0
    while True:
        h = r.h
        for stage in range(first, STAGES):
            if stage > 0:
                _stage(states, h, A[stage], stage, 1)
            _derivative(dofs, elements, terms, r, series, room, min(stage, 1), C[stage], stage)
            if stage == 0:
                _at_place(dofs, elements, r, series, room, 0, 0)
        first = 1
        _stage(states, h, B, STAGES, 1)
        error = _error(r, states, h)
        factor = min(MOST, SAFETY * error ** (-0.125)) if error > 0.0 else MOST
        if error < 1.0:
            break
        factor = max(LEAST, factor) if error < 1e300 else LEAST
        r.h *= factor
        r.g1 *= factor
        r.trials += 1
        if r.h < SHORTEST * r.dt:
            r.status = STEP_BOUND if error < math.inf else NOT_FINITE
            return
    if r.onset < 0.0:  # the first step of a contact: where its force has no derivatives steps have to grow anew
        r.onset = h
    r.next = h * max(factor, LEAST)
    for stage in range(STAGES, ALL):
        if stage > STAGES:
            _stage(states, h, A[stage], stage, STAGE)
        _derivative(dofs, elements, terms, r, series, room, 1 if stage == STAGES else STAGE, C[stage], stage)
        if stage == STAGES:
            _at_place(dofs, elements, r, series, room, ORDER - 1, STAGES)
    _dense(r, states)
    for place in range(1, ORDER - 1):
        _dense_state(states, PLACES[place])
        _derivative(dofs, elements, terms, r, series, room, STAGE, PLACES[place], SPARE)
        _at_place(dofs, elements, r, series, room, place, SPARE)
    _fit(dofs, elements, r, series)


@njit(**PART)
def _dense(r, states):
    """Coefficients of the dense output, y[3] to y[9]."""
    h = r.h
    for i in range(states.size):
        y, k = states[i].y, states[i].k
        d = y[1] - y[0]
        y[3] = d
        y[4] = h * k[0] - d
        y[5] = 2.0 * d - h * (k[STAGES] + k[0])
        for q in range(4):
            total = 0.0
            for j in range(ALL):
                total += D[q, j] * k[j]
            y[6 + q] = h * total


@njit(**PART)
def _dense_state(states, s):
    """The states at the part s of the step, into those of a stage."""
    for i in range(states.size):
        y = states[i].y
        value = y[9]
        for q in range(5, -1, -1):
            value = value * (s if q % 2 else 1.0 - s) + y[3 + q]
        y[STAGE] = y[0] + s * value


@njit(**PART)
def _at_place(dofs, elements, r, series, room, place, at):
    """Keep accelerations, and rates and forces of links that act and of smooth storeys, at one of PLACES: those of the
    derivatives k[at], which were evaluated last."""
    for i in range(r.n):
        dofs[i].inside[place] = room.states[r.n + i].k[at]
        el = elements[i]
        if el.smooth:
            series[el.row].rate[place], series[el.row].f[place] = el.r1, el.f1 - el.c * el.r1
    for a in range(r.active):
        el = elements[series[a].element]
        if place == 0 and el.pinned:
            el.v1, el.r1 = el.v0, el.r0
            _element_force(el, room.formulas[el.formula])
        series[a].rate[place], series[a].f[place] = el.r1, el.f1


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
    states, n, whole = room.states, r.n, r.end == 1.0
    if not whole:
        _dense_state(states, r.end)
    at = 1 if whole else STAGE
    for e in range(r.m):
        el = elements[e]
        if el.state > 0:
            el.h[0] = states[el.state].y[at]
    if whole:
        for i in range(n):
            dofs[i].u1, dofs[i].v1 = states[i].y[1], states[n + i].y[1]
    for i in range(states.size):
        states[i].scale = max(states[i].scale, 0.01 * abs(states[i].y[1]))
