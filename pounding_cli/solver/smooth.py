"""Steps by DOP853 (Hairer, Norsett & Wanner 1993, II.10), while a force acts that has no Taylor series.

Its dense output is a polynomial of degree 7 of every velocity, whose integral is the displacement: a step that events,
peaks and energies treat like one by series. The forces of links and of smooth storeys are polynomials through their
values at eight Chebyshev points of it.
"""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
from numba import njit

from pounding_cli.solver.dispatch import force, history_rate
from pounding_cli.solver.events import ends_of_elements, integral, rate_series
from pounding_cli.solver.options import CALLED, PART, bare
from pounding_cli.solver.polynomial import value
from pounding_cli.solver.records import NOT_FINITE, STEP_BOUND, Room
from pounding_cli.solver.series import push, push_by_storey, zero_if_rounding

_TABLES = {
    name: np.array(values)
    for name, values in json.loads(Path(__file__).with_name("dop853.json").read_text(encoding="ascii")).items()
}
"""The coefficients as SciPy has them (tools/dop853.py)."""

STAGES = len(_TABLES["A"])
EXTRA = len(_TABLES["A_EXTRA"])
ALL = STAGES + 1 + EXTRA
"""Stages of a step, and with the derivative at its end and those of the dense output."""

A = np.zeros((ALL, ALL))
A[:STAGES, :STAGES] = _TABLES["A"]
A[STAGES, :STAGES] = _TABLES["B"]
A[STAGES + 1 :, :] = _TABLES["A_EXTRA"]
C = np.concatenate((_TABLES["C"], [1.0], _TABLES["C_EXTRA"]))
E3 = _TABLES["E3"]
E5 = _TABLES["E5"]

ORDER = 7
"""Of the polynomials of velocities."""


def _dense_output() -> np.ndarray:
    """Coefficients 1 to 7 of the polynomials of the states, over the step's length, from the derivatives at all stages:
    a sum of s, s (1 - s), s^2 (1 - s) and so on."""
    step = A[STAGES]
    first = np.eye(ALL)[0]
    last = np.eye(ALL)[STAGES]
    parts = [step, first - step, 2.0 * step - first - last, *_TABLES["D"]]
    made = np.zeros((ORDER, ALL))
    base = np.polynomial.Polynomial([0.0, 1.0])
    for number, part in enumerate(parts):
        made[: base.degree()] += np.outer(base.coef[1:], part)
        base = base * np.polynomial.Polynomial([0.0, 1.0] if number % 2 else [1.0, -1.0])
    return made


DENSE = _dense_output()

POINTS = 8
PLACES = 0.5 - 0.5 * np.cos(np.pi * np.arange(POINTS) / (POINTS - 1))
FIT = np.ascontiguousarray(np.linalg.inv(np.vander(PLACES, increasing=True)))
"""Coefficients of a polynomial of degree 7 from its values at PLACES."""

LAST_OF_SUM = 2e-15
"""Part of its terms [-] below which such a coefficient is rounding, of eight terms and the values themselves: what is
more is part of the force, which the energies miss."""

FIT_SIZE = np.abs(FIT).sum(axis=1)
"""Largest size of the terms of each coefficient, over the largest value."""

SAFETY = 0.9
LEAST = 0.2
MOST = 6.0
"""Of the next step over this one: margin, least and most."""

NEARER = 0.75
LONGER = 1.1
"""Of a step towards the end of a contact, where its force has no derivatives: its part of the time to there, as the
floors part now; where it leads across, its length over that of the step that last did."""

SHORTEST = 1e-15
"""Part of a sample of the motion below which no step is tried."""


@njit(**PART)
def _state_at(dofs, elements, terms, r, states, stage):
    """The states y of a stage, y0 + h (A k), as displacements, velocities, deformations, rates and history variables
    of the records."""
    for i in range(states.size):
        state = states[i]
        total = 0.0
        for j in range(stage):
            total += A[stage, j] * state.k[j]
        state.y = state.y0 + r.h * total
    for i in range(r.n):
        dofs[i].u1 = states[i].y
        dofs[i].v1 = states[r.n + i].y
    ends_of_elements(dofs, elements, terms, r)
    for e in range(r.m):
        el = elements[e]
        if el.state > 0:
            el.h[0] = states[el.state].y


@njit(**PART)
def _derivative(dofs, elements, terms, r, series, room, stage):
    """Derivatives of the states at a stage."""
    states = room.states
    formulas = room.formulas
    n = r.n
    ground = r.g0 + r.g1 * C[stage]
    for i in range(n):
        states[i].k[stage] = dofs[i].v1
        dofs[i].push = dofs[i].mass * dofs[i].loaded * ground
    for a in range(r.active):
        el = elements[series[a].element]
        if el.state > 0 and not el.drifts:
            states[el.state].k[stage] = el.k * el.r1 - el.relaxation * el.h[0]
        if el.acts:
            push(dofs, terms, el, force(el, el.v1, el.r1, formulas[el.formula]))
    for e in range(n + r.drags, n + r.drags + r.lines):
        el = elements[e]
        if el.state > 0:
            states[el.state].k[stage] = history_rate(el, el.r1, el.h[0])
    for i in range(n):
        el = elements[i]
        if el.state > 0:
            states[el.state].k[stage] = history_rate(el, el.r1, el.h[0])
        f = force(el, el.v1, el.r1, formulas[el.formula])
        if r.lines > 0 and el.twists:
            mate = elements[el.mate]
            f += el.coupled_k * mate.v1 + el.coupled_c * mate.r1
        push_by_storey(dofs, el, i, f, r.has_lean)
    for i in range(n):
        d = dofs[i]
        states[n + i].k[stage] = -d.inv_mass * d.push - d.drag * d.v1


@njit(**PART)
def _error(r, states):
    """Error of the step over what it may be [-], the largest of all states: in a long row a mean would hide it.

    Infinite where a state is not finite, which a comparison passes over."""
    worst5 = worst3 = total = 0.0
    for i in range(states.size):
        state = states[i]
        e5 = e3 = 0.0
        for j in range(STAGES):
            e5 += E5[j] * state.k[j]
            e3 += E3[j] * state.k[j]
        per = 1.0 / (r.smooth_tolerance * max(state.scale, abs(state.y0), abs(state.y)))
        worst5 = max(worst5, abs(e5 * per))
        worst3 = max(worst3, abs(e3 * per))
        total += abs(e5 * per)
    if not total < math.inf:
        return math.inf
    if worst5 == 0.0 and worst3 == 0.0:
        return 0.0
    return r.h * worst5 * worst5 / math.hypot(worst5, 0.1 * worst3)


@njit(**PART)
def _longest(elements, r, series):
    """The longest step worth trying [s]: up to near where a contact parts, or across it."""
    longest = math.inf
    for a in range(r.active):
        el = elements[series[a].element]
        if el.smooth and el.low == 0.0 and el.r0 < 0.0:
            longest = min(longest, max(-NEARER * el.v0 / el.r0, LONGER * r.across))
    return longest


@njit(**CALLED)
def take_smooth(dofs, elements, terms, r, series, room):
    """A step that DOP853 accepts: the velocities' polynomials in `dofs`, the forces' in `series`."""
    room = Room(bare(room.states), bare(room.formulas))
    states = room.states
    n = r.n
    for i in range(n):
        states[i].y0 = dofs[i].u0
        states[n + i].y0 = dofs[i].w[0]
    for e in range(r.m):
        if elements[e].state > 0:
            states[elements[e].state].y0 = elements[e].h[0]
    r.next = min(r.next, _longest(elements, r, series))
    if r.h > r.next > 0.0:
        part = 1.0 / math.ceil(r.h / r.next - 1e-9)
        r.h *= part
        r.g1 *= part
    stage = 0
    if r.follows:  # the derivatives at the end of the last step are those at the start of this one
        stage = 1
        for i in range(states.size):
            states[i].k[0] = states[i].k[STAGES]
    while stage < ALL:
        _state_at(dofs, elements, terms, r, states, stage)
        if stage == STAGES:
            error = _error(r, states)
            factor = max(LEAST, min(MOST, SAFETY * r.smaller * max(error, 1e-300) ** (-0.125)))
            if not error < 1.0:
                r.h *= factor
                r.g1 *= factor
                r.trials += 1
                if r.h < SHORTEST * r.dt:
                    r.status = STEP_BOUND if error < math.inf else NOT_FINITE
                    return
                stage = 1
                continue
            if r.onset < 0.0:  # the first step of a contact: where its force has no derivatives steps have to grow anew
                r.onset = r.h
                r.across = max(r.across, r.h)
            r.next = r.h * factor
            for i in range(states.size):
                states[i].scale = max(states[i].scale, 0.01 * abs(states[i].y))
        _derivative(dofs, elements, terms, r, series, room, stage)
        stage += 1
    _take_polynomials(dofs, elements, terms, r, series, room)


@njit(**PART)
def _take_polynomials(dofs, elements, terms, r, series, room):
    """Polynomials of velocities, history variables and forces."""
    states = room.states
    n = r.n
    r.order = ORDER + 1
    for i in range(n, states.size):
        state = states[i]
        state.c[0] = state.y0
        for k in range(ORDER):
            total = 0.0
            for j in range(ALL):
                total += DENSE[k, j] * state.k[j]
            state.c[k + 1] = r.h * total
    for i in range(n):
        d = dofs[i]
        state = states[n + i]
        d.a0 = state.k[0] + d.felt * r.g0
        for k in range(1, ORDER + 1):
            d.w[k] = state.c[k]
        d.w[ORDER + 1] = 0.0
    for e in range(r.m):
        el = elements[e]
        if el.smooth if e < n or el.drifts else el.closed:
            rate_series(dofs, elements, terms, r, e)
            _fit_force(el, r, series[el.row], states[el.state], room.formulas[el.formula], el.drifts)


@njit(**CALLED)
def _fit_force(el, r, s, state, formula, storey):
    """Polynomials of the rate of an element, which stands in r.p, and of its force: of a storey or a frame line without
    its dashpot."""
    for k in range(POINTS):
        s.rate[k] = r.p[k]
    integral(r, 1.0, el.v0)
    for place in range(POINTS):
        at = PLACES[place]
        v = r.p[POINTS]
        rate = 0.0
        h = 0.0
        for k in range(POINTS - 1, -1, -1):
            v = v * at + r.p[k]
            rate = rate * at + s.rate[k]
            h = h * at + state.c[k]
        if el.state > 0:
            el.h[0] = h
        r.values[place] = force(el, v, rate, formula)
        if storey:
            r.values[place] -= el.c * rate
    largest = 0.0
    for place in range(POINTS):
        largest = max(largest, abs(r.values[place]))
    for k in range(POINTS):
        f = 0.0
        for place in range(POINTS):
            f += FIT[k, place] * r.values[place]
        if abs(f) <= LAST_OF_SUM * FIT_SIZE[k] * largest:  # else it is no rounding
            size = 0.0
            for place in range(POINTS):
                size += abs(FIT[k, place] * r.values[place])
            f = zero_if_rounding(f, size, LAST_OF_SUM)  # events ask for the first coefficient that is not zero
        s.f[k] = f


@njit(**PART)
def end_of_smooth(elements, r, room):
    """History variables at the end of the step."""
    for e in range(r.m):
        el = elements[e]
        if el.state > 0:
            el.h[0] = value(room.states[el.state].c, ORDER, r.end)
