"""Steps by DOP853 (Hairer, Norsett & Wanner 1993, II.10), while a force acts that has no Taylor series.

Its dense output is a polynomial of degree 7 of every velocity, whose integral is the displacement: a step that events,
peaks and energies treat like one by series. The forces of links and of smooth storeys are polynomials through their
values at eight Chebyshev points of it.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from pounding_cli.solver.dispatch import compute_force, history_rate
from pounding_cli.solver.dop853 import ALL, DENSE, E3, E5, ORDER, STAGES, A, C
from pounding_cli.solver.options import CALLED, PART, borrow_records
from pounding_cli.solver.polynomial import evaluate
from pounding_cli.solver.records import NOT_FINITE, STEP_BOUND, Room
from pounding_cli.solver.series import push, push_by_storey, zero_if_rounding
from pounding_cli.solver.step_end import build_rate, deform_elements, integrate_rate

POINTS = 8
"""Points of a step at which a force is looked at."""

PLACES = 0.5 - 0.5 * np.cos(np.pi * np.arange(POINTS) / (POINTS - 1))
"""Their places in the step, from 0 to 1 (Chebyshev)."""

FIT = np.ascontiguousarray(np.linalg.inv(np.vander(PLACES, increasing=True)))
"""Coefficients of a polynomial of degree 7 from its values at PLACES."""

LAST_OF_SUM = 2e-15
"""Part of its terms [-] below which such a coefficient is rounding, of eight terms and the values themselves: what is
more is part of the force, which the energies miss."""

FIT_SIZE = np.abs(FIT).sum(axis=1)
"""Largest size of the terms of each coefficient, over the largest value."""

MARGIN = 0.9
"""Length of the next step over that which the error of this one allows [-]."""

MIN_GROWTH = 0.2
"""Least length of the next step over that of this one [-]."""

MAX_GROWTH = 6.0
"""Largest length of the next step over that of this one [-]."""

PART_TO_PARTING = 0.75
"""Length of a step towards the end of a contact, over the time to there as the floors part now [-]: its force has no
derivatives there."""

GROWTH_ACROSS = 1.1
"""Length of a step across the end of a contact over that of the step that last led across one [-]."""

MIN_STEP = 1e-15
"""Part of a sample of the motion below which no step is tried."""


@njit(**PART)
def _set_stage(dofs, elements, terms, run, states, stage):
    """Put the states of a stage, y0 + h (A k), into the records: motion, deformations, rates, history variables."""
    for i in range(states.size):
        state = states[i]
        total = 0.0
        for j in range(stage):
            total += A[stage, j] * state.k[j]
        state.y = state.y0 + run.h * total
    for i in range(run.n):
        dofs[i].u1 = states[i].y
        dofs[i].v1 = states[run.n + i].y
    deform_elements(dofs, elements, terms, run)
    for e in range(run.m):
        el = elements[e]
        if el.state > 0:
            el.h[0] = states[el.state].y


@njit(**PART)
def _take_derivatives(dofs, elements, terms, run, series, room, stage):
    """Find the derivatives of the states at a stage."""
    states = room.states
    formulas = room.formulas
    n = run.n
    ground = run.g0 + run.g1 * C[stage]
    for i in range(n):
        states[i].k[stage] = dofs[i].v1
        dofs[i].push = dofs[i].mass * dofs[i].loaded * ground
    for a in range(run.active):
        el = elements[series[a].element]
        if el.state > 0 and not el.drifts:
            states[el.state].k[stage] = el.k * el.r1 - el.relaxation * el.h[0]
        if el.acts:
            push(dofs, terms, el, compute_force(el, el.v1, el.r1, formulas[el.formula]))
    for e in range(n + run.drags, n + run.drags + run.lines):
        el = elements[e]
        if el.state > 0:
            states[el.state].k[stage] = history_rate(el, el.r1, el.h[0])
    for i in range(n):
        el = elements[i]
        if el.state > 0:
            states[el.state].k[stage] = history_rate(el, el.r1, el.h[0])
        f = compute_force(el, el.v1, el.r1, formulas[el.formula])
        if run.lines > 0 and el.twists:
            mate = elements[el.mate]
            f += el.coupled_k * mate.v1 + el.coupled_c * mate.r1
        push_by_storey(dofs, el, i, f, run.has_lean)
    for i in range(n):
        dof = dofs[i]
        states[n + i].k[stage] = -dof.inv_mass * dof.push - dof.drag * dof.v1


@njit(**PART)
def _estimate_error(run, states):
    """Return the error of the step over what it may be [-], the largest of all states: a mean would hide it in a row.

    It is infinite where a state is not finite, which a comparison passes over.
    """
    worst5 = worst3 = total = 0.0
    for i in range(states.size):
        state = states[i]
        e5 = e3 = 0.0
        for j in range(STAGES):
            e5 += E5[j] * state.k[j]
            e3 += E3[j] * state.k[j]
        per = 1.0 / (run.smooth_tolerance * max(state.scale, abs(state.y0), abs(state.y)))
        worst5 = max(worst5, abs(e5 * per))
        worst3 = max(worst3, abs(e3 * per))
        total += abs(e5 * per)
    if not total < math.inf:
        return math.inf
    if worst5 == 0.0 and worst3 == 0.0:
        return 0.0
    return run.h * worst5 * worst5 / math.hypot(worst5, 0.1 * worst3)


@njit(**PART)
def _find_longest_step(elements, run, series):
    """Return the longest step worth trying [s]: up to near where a contact parts, or across it."""
    longest = math.inf
    for a in range(run.active):
        el = elements[series[a].element]
        if el.smooth and el.low == 0.0 and el.r0 < 0.0:
            longest = min(longest, max(-PART_TO_PARTING * el.v0 / el.r0, GROWTH_ACROSS * run.across))
    return longest


@njit(**CALLED)
def take_smooth_step(dofs, elements, terms, run, series, room):
    """Take a step that DOP853 accepts: the velocities' polynomials go to `dofs`, the forces' to `series`."""
    room = Room(borrow_records(room.states), borrow_records(room.formulas))
    states = room.states
    n = run.n
    for i in range(n):
        states[i].y0 = dofs[i].u0
        states[n + i].y0 = dofs[i].w[0]
    for e in range(run.m):
        if elements[e].state > 0:
            states[elements[e].state].y0 = elements[e].h[0]
    run.next = min(run.next, _find_longest_step(elements, run, series))
    if run.h > run.next > 0.0:
        part = 1.0 / math.ceil(run.h / run.next - 1e-9)
        run.h *= part
        run.g1 *= part
    stage = 0
    if run.follows:  # the derivatives at the end of the last step are those at the start of this one
        stage = 1
        for i in range(states.size):
            states[i].k[0] = states[i].k[STAGES]
    while stage < ALL:
        _set_stage(dofs, elements, terms, run, states, stage)
        if stage == STAGES:
            error = _estimate_error(run, states)
            factor = max(MIN_GROWTH, min(MAX_GROWTH, MARGIN * run.smaller * max(error, 1e-300) ** (-0.125)))
            if not error < 1.0:
                run.h *= factor
                run.g1 *= factor
                run.trials += 1
                if run.h < MIN_STEP * run.dt:
                    run.status = STEP_BOUND if error < math.inf else NOT_FINITE
                    return
                stage = 1
                continue
            if run.onset < 0.0:  # in the first step of a contact: steps grow anew where its force has no derivatives
                run.onset = run.h
                run.across = max(run.across, run.h)
            run.next = run.h * factor
            for i in range(states.size):
                states[i].scale = max(states[i].scale, 0.01 * abs(states[i].y))
        _take_derivatives(dofs, elements, terms, run, series, room, stage)
        stage += 1
    _build_polynomials(dofs, elements, terms, run, series, room)


@njit(**PART)
def _build_polynomials(dofs, elements, terms, run, series, room):
    """Build the polynomials of velocities, history variables and forces."""
    states = room.states
    n = run.n
    run.order = ORDER + 1
    for i in range(n, states.size):
        state = states[i]
        state.c[0] = state.y0
        for k in range(ORDER):
            total = 0.0
            for j in range(ALL):
                total += DENSE[k, j] * state.k[j]
            state.c[k + 1] = run.h * total
    for i in range(n):
        dof = dofs[i]
        state = states[n + i]
        dof.a0 = state.k[0] + dof.felt * run.g0
        for k in range(1, ORDER + 1):
            dof.w[k] = state.c[k]
        dof.w[ORDER + 1] = 0.0
    for e in range(run.m):
        el = elements[e]
        if el.smooth if e < n or el.drifts else el.closed:
            build_rate(dofs, elements, terms, run, e)
            _fit_force(el, run, series[el.row], states[el.state], room.formulas[el.formula], el.drifts)


@njit(**CALLED)
def _fit_force(el, run, row, state, formula, storey):
    """Build the polynomials of the rate of an element, which stands in run.p, and of its force.

    That of a storey or a frame line is without its dashpot.

    state : of its history variable, if it has one
    """
    for k in range(POINTS):
        row.rate[k] = run.p[k]
    integrate_rate(run, 1.0, el.v0)
    for place in range(POINTS):
        at = PLACES[place]
        v = run.p[POINTS]
        rate = 0.0
        h = 0.0
        for k in range(POINTS - 1, -1, -1):
            v = v * at + run.p[k]
            rate = rate * at + row.rate[k]
            h = h * at + state.c[k]
        if el.state > 0:
            el.h[0] = h
        run.values[place] = compute_force(el, v, rate, formula)
        if storey:
            run.values[place] -= el.c * rate
    largest = 0.0
    for place in range(POINTS):
        largest = max(largest, abs(run.values[place]))
    for k in range(POINTS):
        f = 0.0
        for place in range(POINTS):
            f += FIT[k, place] * run.values[place]
        if abs(f) <= LAST_OF_SUM * FIT_SIZE[k] * largest:  # else it is no rounding
            size = 0.0
            for place in range(POINTS):
                size += abs(FIT[k, place] * run.values[place])
            f = zero_if_rounding(f, size, LAST_OF_SUM)  # events ask for the first coefficient that is not zero
        row.f[k] = f


@njit(**PART)
def end_smooth_step(elements, run, room):
    """Set the history variables at the end of the step."""
    for e in range(run.m):
        el = elements[e]
        if el.state > 0:
            el.h[0] = evaluate(room.states[el.state].c, ORDER, run.end)
