"""The largest values of a run, between the ends of steps too."""

from __future__ import annotations

import numpy as np
from numba import njit

from pounding_cli.solver.branches import TOUCH
from pounding_cli.solver.options import CALLED, INVERSE, PART
from pounding_cli.solver.polynomial import SLOPE, find_largest
from pounding_cli.solver.step_end import build_rate, integrate_rate


@njit(**PART)
def _can_turn(first, last, deviation):
    """Return whether a quantity may have its largest value inside the step.

    Its slope differs from the mean by four chord deviations at most.
    """
    return not abs(last - first) > 4.0 * deviation


@njit(**PART)
def _is_of_one_sign(first, last, deviation):
    """Return whether a rate keeps its sign in the step: then what it belongs to has no peak inside."""
    return first * last > 0.0 and min(abs(first), abs(last)) > deviation


@njit(**CALLED)
def raise_peaks(dofs, elements, terms, run, series, columns):
    """Raise every largest value that this step, up to s = run.end, exceeds.

    The walks stand here and not in functions of their own, with which a run takes a tenth longer.
    """
    for i in range(run.n):
        dof = dofs[i]
        if max(dof.u0, dof.u1) + dof.du > dof.u_max or min(dof.u0, dof.u1) - dof.du < dof.u_min:
            dof.u_max = max(dof.u_max, dof.u0, dof.u1)
            dof.u_min = min(dof.u_min, dof.u0, dof.u1)
            if not _is_of_one_sign(dof.w[0], dof.v1, dof.dv):
                if max(dof.u0, dof.u1) + dof.du > dof.u_max:
                    dof.u_max = _find_displacement(dof, run, 1.0, dof.u_max)
                if min(dof.u0, dof.u1) - dof.du < dof.u_min:
                    dof.u_min = -_find_displacement(dof, run, -1.0, -dof.u_min)
        if dof.felt == 0.0:
            continue
        largest = max(abs(dof.a0), abs(dof.a1))
        if largest + dof.da > dof.a_max:
            dof.a_max = max(dof.a_max, largest)
            if _can_turn(dof.a0, dof.a1, dof.da):
                _raise_acceleration(dof, run)
    for e in range(run.m):
        el = elements[e]
        is_storey = el.drifts != 0
        if _raise_to_ends(el, is_storey):
            build_rate(dofs, elements, terms, run, e)
            _raise_deformation(el, run, is_storey)
        if not is_storey and el.least > -TOUCH and el.v0 <= 0.0:  # how far floors in touch part, inside the step too
            build_rate(dofs, elements, terms, run, e)
            el.least = -find_largest(run, integrate_rate(run, -1.0, -el.v0), run.end, -el.least, is_storey)
        if el.acts and (el.smooth if is_storey else el.closed):
            _raise_force(el, run, series[el.row])
    for c in range(run.columns):
        column = columns[c]
        if elements[column.storey].twists:
            _raise_twisting(dofs, elements, terms, run, series, column)
        else:
            _raise_column_shear(dofs, elements, terms, run, series, column)


@njit(**CALLED)
def _raise_twisting(dofs, elements, terms, run, series, column):
    """Raise the largest |shear| of a storey whose floors twist, or of its struck columns, and its edge drifts."""
    el = elements[column.storey]
    mate = elements[el.mate]
    if column.is_sum and not run.smooth:
        one = el.k
        other = el.coupled_k
        constant = el.f0
        column.peak, rises = _raise_pair_to_ends(el, mate, one, other, constant, column.peak)
        if rises:
            column.peak = _find_pair_peak(dofs, elements, terms, run, el, one, other, constant, column.peak)
    else:
        _raise_storey_shear(dofs, elements, terms, run, series, column)
    if column.is_sum:
        low = column.low
        column.peak_low, rises = _raise_pair_to_ends(el, mate, 1.0, low, 0.0, column.peak_low)
        if rises:
            column.peak_low = _find_pair_peak(dofs, elements, terms, run, el, 1.0, low, 0.0, column.peak_low)
        high = column.high
        column.peak_high, rises = _raise_pair_to_ends(el, mate, 1.0, high, 0.0, column.peak_high)
        if rises:
            column.peak_high = _find_pair_peak(dofs, elements, terms, run, el, 1.0, high, 0.0, column.peak_high)


@njit(**PART)
def _raise_to_ends(el, is_storey):
    """Raise the largest values of an element to the ends of the step; return whether it may rise above them inside.

    They are |v| and |k v + f0| (without the dashpot) of a storey, and v of a link.
    """
    first, last = (abs(el.v0), abs(el.v1)) if is_storey else (el.v0, el.v1)
    rises = max(first, last) + el.dv > el.peak_v
    el.peak_v = max(el.peak_v, first, last)
    el.least = min(el.least, el.v1)
    if is_storey and el.yields and not el.smooth:
        first = abs(el.k * el.v0 + el.f0)
        last = abs(el.k * el.v1 + el.f0)
        rises = rises or max(first, last) + abs(el.k) * el.dv > el.peak_f
        el.peak_f = max(el.peak_f, first, last)
    return rises and not _is_of_one_sign(el.r0, el.r1, el.dr)


@njit(**CALLED)
def _raise_deformation(el, run, is_storey):
    """Raise the largest values of an element to those inside the step; its rate stands in run.p."""
    n = integrate_rate(run, 1.0, el.v0)
    el.peak_v = find_largest(run, n, run.end, el.peak_v, is_storey)
    if is_storey and el.yields and not el.smooth:
        for k in range(n + 1):
            run.p[k] *= el.k
        run.p[0] += el.f0
        el.peak_f = find_largest(run, n, run.end, el.peak_f, is_storey)


@njit(**CALLED)
def _find_displacement(dof, run, side, peak):
    """Return the larger of `peak` and the largest displacement inside the step, times `side`."""
    p = run.p
    absolute = run.h < 0.0
    p[0] = side * dof.u0
    for k in range(run.order + 1):
        p[k + 1] = side * dof.w[k] * run.h * INVERSE[k + 1]
    return find_largest(run, run.order + 1, run.end, peak, absolute)


@njit(**CALLED)
def _raise_acceleration(dof, run):
    """Raise the largest |total acceleration| of a degree of freedom to that inside the step."""
    p = run.p
    absolute = run.h > 0.0
    for k in range(run.order):
        p[k] = (k + 1) / run.h * dof.w[k + 1]
    p[0] += run.g0
    p[1] += run.g1
    dof.a_max = find_largest(run, run.order - 1, run.end, dof.a_max, absolute)


@njit(**CALLED)
def _raise_force(el, run, row):
    """Raise the largest |force| of an element that acts; add its impulse and its time."""
    first = row.f[0]
    deviation = 0.0
    last = 0.0
    impulse = 0.0
    for k in range(run.order - 1, -1, -1):
        f = row.f[k]
        last = last * run.end + f
        impulse = impulse * run.end + f * INVERSE[k + 1]
        deviation += k * (k - 1.0) * abs(f)
    el.f1 = last
    if el.relaxation > 0.0:
        el.h[0] = last
    el.impulse += impulse * run.h * run.end
    el.time += run.h * run.end
    deviation *= 0.125
    if max(abs(first), abs(last)) + deviation > el.peak_f:
        el.peak_f = max(el.peak_f, abs(first), abs(last))
        if _can_turn(first, last, deviation):
            p = run.p
            absolute = run.h > 0.0
            for k in range(run.order):
                p[k] = row.f[k]
            el.peak_f = find_largest(run, run.order - 1, run.end, el.peak_f, absolute)


@njit(**CALLED)
def _raise_column_shear(dofs, elements, terms, run, series, column):
    """Raise the largest |shear| in struck columns: their share of the storey's, and what blows add at that end."""
    el = elements[column.storey]
    p = run.p
    absolute = run.h > 0.0
    if el.smooth:
        row = series[el.row]
        n = run.order
        for k in range(n):
            p[k] = column.share * row.f[k]
    else:
        build_rate(dofs, elements, terms, run, np.int64(column.storey))
        n = integrate_rate(run, column.share * el.k, column.share * (el.k * el.v0 + el.f0)) + 1
    _add_forces(elements, terms, run, series, column)
    column.peak = find_largest(run, n - 1, run.end, column.peak, absolute)


@njit(**CALLED)
def _add_forces(elements, terms, run, series, column):
    """Add the forces of links, and of lines whose force is smooth, to the polynomial of a shear in run.p [N]."""
    for x in range(column.first, column.last):
        el = elements[terms[x].dof]
        if _has_own_force(el):
            row = series[el.row]
            for k in range(run.order):
                run.p[k] += terms[x].weight * row.f[k]


@njit(**PART)
def _has_own_force(el):
    """Return whether a link, or a line, adds a force of its own to a shear: straight lines are part of their storey."""
    return el.smooth if el.drifts else el.closed and el.acts


@njit(**PART)
def _raise_pair_to_ends(el, mate, one, other, constant, peak):
    """Return `peak` raised to the ends of the step, and whether what it is of may rise above it inside.

    It is of |one x drift + other x twist + constant| of a storey whose floors twist.
    """
    first = one * el.v0 + other * mate.v0 + constant
    last = one * el.v1 + other * mate.v1 + constant
    rises = max(abs(first), abs(last)) + abs(one) * el.dv + abs(other) * mate.dv > peak
    if rises:
        peak = max(peak, abs(first), abs(last))
        rate = one * el.r0 + other * mate.r0
        last_rate = one * el.r1 + other * mate.r1
        rises = not _is_of_one_sign(rate, last_rate, abs(one) * el.dr + abs(other) * mate.dr)
    return peak, rises


@njit(**CALLED)
def _build_pair(dofs, elements, terms, run, el, one, other, constant):
    """Put the coefficients of one x drift + other x twist + constant of a storey into run.p; return their degree."""
    p = run.p
    at = np.int64(SLOPE)
    start = one * el.v0 + other * elements[el.mate].v0 + constant
    build_rate(dofs, elements, terms, run, np.int64(elements[el.mate].mate))
    for k in range(run.order + 1):
        p[at + k] = one * p[k]
    build_rate(dofs, elements, terms, run, np.int64(el.mate))
    for k in range(run.order + 1):
        p[k] = p[at + k] + other * p[k]
    return integrate_rate(run, 1.0, start)


@njit(**CALLED)
def _find_pair_peak(dofs, elements, terms, run, el, one, other, constant, peak):
    """Return the larger of `peak` and the largest |one x drift + other x twist + constant| of a storey in the step."""
    absolute = run.h > 0.0
    n = _build_pair(dofs, elements, terms, run, el, one, other, constant)
    return find_largest(run, n, run.end, peak, absolute)


@njit(**CALLED)
def _raise_storey_shear(dofs, elements, terms, run, series, column):
    """Raise the largest |shear| of a storey whose floors twist, or of its struck columns.

    It is straight in drift and twist but for the forces of links and of lines whose force is smooth.
    """
    el = elements[column.storey]
    share = column.share
    absolute = run.h > 0.0
    n = _build_pair(dofs, elements, terms, run, el, share * el.k, share * el.coupled_k, share * el.f0)
    _add_forces(elements, terms, run, series, column)
    column.peak = find_largest(run, n, run.end, column.peak, absolute)
