"""The largest values of a run, between the ends of steps too."""

from __future__ import annotations

import numpy as np
from numba import njit

from pounding_cli.solver.events import TOUCH, integral, rate_series
from pounding_cli.solver.options import CALLED, INVERSE, PART
from pounding_cli.solver.polynomial import SLOPE, highest


@njit(**PART)
def _may_turn(first, last, deviation):
    """Whether a quantity may have its largest value inside the step: its slope differs from the mean by four chord
    deviations at most."""
    return not abs(last - first) > 4.0 * deviation


@njit(**PART)
def _keeps_sign(first, last, deviation):
    """Whether a rate keeps its sign in the step: then what it belongs to has no peak inside."""
    return first * last > 0.0 and min(abs(first), abs(last)) > deviation


@njit(**CALLED)
def raise_peaks(dofs, elements, terms, r, series, columns):
    """Raise every largest value that this step, up to s = run.end, exceeds."""
    for i in range(r.n):
        d = dofs[i]
        if max(d.u0, d.u1) + d.du > d.u_max or min(d.u0, d.u1) - d.du < d.u_min:
            d.u_max = max(d.u_max, d.u0, d.u1)
            d.u_min = min(d.u_min, d.u0, d.u1)
            if not _keeps_sign(d.w[0], d.v1, d.dv):
                if max(d.u0, d.u1) + d.du > d.u_max:
                    d.u_max = _displacement_peak(d, r, 1.0, d.u_max)
                if min(d.u0, d.u1) - d.du < d.u_min:
                    d.u_min = -_displacement_peak(d, r, -1.0, -d.u_min)
        if d.felt == 0.0:
            continue
        largest = max(abs(d.a0), abs(d.a1))
        if largest + d.da > d.a_max:
            d.a_max = max(d.a_max, largest)
            if _may_turn(d.a0, d.a1, d.da):
                _acceleration_peak(d, r)
    for e in range(r.m):
        el = elements[e]
        storey = el.drifts != 0
        if _ends_rise(el, storey):
            rate_series(dofs, elements, terms, r, e)
            _deformation_peaks(el, r, storey)
        if not storey and el.least > -TOUCH and el.v0 <= 0.0:  # how far floors in touch part, inside the step too
            rate_series(dofs, elements, terms, r, e)
            el.least = -highest(r, integral(r, -1.0, -el.v0), r.end, -el.least, storey)
        if el.acts and (el.smooth if storey else el.closed):
            _force_peak(el, r, series[el.row])
    for c in range(r.columns):
        column = columns[c]
        el = elements[column.storey]
        if not el.twists:
            _column_peak(dofs, elements, terms, r, series, column)
            continue
        mate = elements[el.mate]
        if column.is_sum and not r.smooth:
            one = el.k
            other = el.coupled_k
            constant = el.f0
            column.peak, rises = _ends_of_pair(el, mate, one, other, constant, column.peak)
            if rises:
                column.peak = _peak_of_pair(dofs, elements, terms, r, el, one, other, constant, column.peak)
        else:
            _shear_peak(dofs, elements, terms, r, series, column)
        if column.is_sum:
            column.peak_low, rises = _ends_of_pair(el, mate, 1.0, column.low, 0.0, column.peak_low)
            if rises:
                column.peak_low = _peak_of_pair(dofs, elements, terms, r, el, 1.0, column.low, 0.0, column.peak_low)
            column.peak_high, rises = _ends_of_pair(el, mate, 1.0, column.high, 0.0, column.peak_high)
            if rises:
                column.peak_high = _peak_of_pair(dofs, elements, terms, r, el, 1.0, column.high, 0.0, column.peak_high)


@njit(**PART)
def _ends_rise(el, storey):
    """Raise the largest |v| and |k v + f0| (without the dashpot) of a storey, or the largest v of a link, to the ends
    of the step; whether it may rise above them inside."""
    first, last = (abs(el.v0), abs(el.v1)) if storey else (el.v0, el.v1)
    rises = max(first, last) + el.dv > el.peak_v
    el.peak_v = max(el.peak_v, first, last)
    el.least = min(el.least, el.v1)
    if storey and el.yields and not el.smooth:
        first = abs(el.k * el.v0 + el.f0)
        last = abs(el.k * el.v1 + el.f0)
        rises = rises or max(first, last) + abs(el.k) * el.dv > el.peak_f
        el.peak_f = max(el.peak_f, first, last)
    return rises and not _keeps_sign(el.r0, el.r1, el.dr)


@njit(**CALLED)
def _deformation_peaks(el, r, storey):
    """The same inside the step, for an element whose rate stands in r.p."""
    n = integral(r, 1.0, el.v0)
    el.peak_v = highest(r, n, r.end, el.peak_v, storey)
    if storey and el.yields and not el.smooth:
        for k in range(n + 1):
            r.p[k] *= el.k
        r.p[0] += el.f0
        el.peak_f = highest(r, n, r.end, el.peak_f, storey)


@njit(**CALLED)
def _displacement_peak(d, r, side, peak):
    """Largest displacement inside the step, times `side`."""
    p = r.p
    absolute = r.h < 0.0
    p[0] = side * d.u0
    for k in range(r.order + 1):
        p[k + 1] = side * d.w[k] * r.h * INVERSE[k + 1]
    return highest(r, r.order + 1, r.end, peak, absolute)


@njit(**CALLED)
def _acceleration_peak(d, r):
    """Largest |total acceleration| inside the step."""
    p = r.p
    absolute = r.h > 0.0
    for k in range(r.order):
        p[k] = (k + 1) / r.h * d.w[k + 1]
    p[0] += r.g0
    p[1] += r.g1
    d.a_max = highest(r, r.order - 1, r.end, d.a_max, absolute)


@njit(**CALLED)
def _force_peak(el, r, s):
    """Largest |force|, impulse and time of an element that acts."""
    first = s.f[0]
    deviation = 0.0
    last = 0.0
    impulse = 0.0
    for k in range(r.order - 1, -1, -1):
        f = s.f[k]
        last = last * r.end + f
        impulse = impulse * r.end + f * INVERSE[k + 1]
        deviation += k * (k - 1.0) * abs(f)
    el.f1 = last
    if el.relaxation > 0.0:
        el.h[0] = last
    el.impulse += impulse * r.h * r.end
    el.time += r.h * r.end
    deviation *= 0.125
    if max(abs(first), abs(last)) + deviation > el.peak_f:
        el.peak_f = max(el.peak_f, abs(first), abs(last))
        if _may_turn(first, last, deviation):
            p = r.p
            absolute = r.h > 0.0
            for k in range(r.order):
                p[k] = s.f[k]
            el.peak_f = highest(r, r.order - 1, r.end, el.peak_f, absolute)


@njit(**CALLED)
def _column_peak(dofs, elements, terms, r, series, column):
    """Largest |shear| in struck columns: their share of the storey's, and what blows on them add at that end."""
    el = elements[column.storey]
    p = r.p
    absolute = r.h > 0.0
    if el.smooth:
        s = series[el.row]
        n = r.order
        for k in range(n):
            p[k] = column.share * s.f[k]
    else:
        rate_series(dofs, elements, terms, r, np.int64(column.storey))
        n = integral(r, column.share * el.k, column.share * (el.k * el.v0 + el.f0)) + 1
    _add_forces(elements, terms, r, series, column)
    column.peak = highest(r, n - 1, r.end, column.peak, absolute)


@njit(**CALLED)
def _add_forces(elements, terms, r, series, column):
    """Add the forces of links, and of lines whose force is smooth, to the polynomial of a shear in r.p [N]."""
    for x in range(column.first, column.last):
        el = elements[terms[x].dof]
        if _adds_force(el):
            s = series[el.row]
            for k in range(r.order):
                r.p[k] += terms[x].weight * s.f[k]


@njit(**PART)
def _adds_force(el):
    """Return whether a link, or a line, adds a force of its own to a shear: straight lines are part of their storey."""
    return el.smooth if el.drifts else el.closed and el.acts


@njit(**PART)
def _ends_of_pair(el, mate, one, other, constant, peak):
    """Raise the largest |one x drift + other x twist + constant| of a storey whose floors twist to the step's ends;
    return it, and whether it may rise above them inside."""
    first = one * el.v0 + other * mate.v0 + constant
    last = one * el.v1 + other * mate.v1 + constant
    rises = max(abs(first), abs(last)) + abs(one) * el.dv + abs(other) * mate.dv > peak
    if rises:
        peak = max(peak, abs(first), abs(last))
        rate = one * el.r0 + other * mate.r0
        last_rate = one * el.r1 + other * mate.r1
        rises = not _keeps_sign(rate, last_rate, abs(one) * el.dr + abs(other) * mate.dr)
    return peak, rises


@njit(**CALLED)
def _pair_series(dofs, elements, terms, r, el, one, other, constant):
    """Coefficients of one x drift + other x twist + constant of a storey, into r.p; returns their degree."""
    p = r.p
    at = np.int64(SLOPE)
    start = one * el.v0 + other * elements[el.mate].v0 + constant
    rate_series(dofs, elements, terms, r, np.int64(elements[el.mate].mate))
    for k in range(r.order + 1):
        p[at + k] = one * p[k]
    rate_series(dofs, elements, terms, r, np.int64(el.mate))
    for k in range(r.order + 1):
        p[k] = p[at + k] + other * p[k]
    return integral(r, 1.0, start)


@njit(**CALLED)
def _peak_of_pair(dofs, elements, terms, r, el, one, other, constant, peak):
    """The same inside the step."""
    absolute = r.h > 0.0
    n = _pair_series(dofs, elements, terms, r, el, one, other, constant)
    return highest(r, n, r.end, peak, absolute)


@njit(**CALLED)
def _shear_peak(dofs, elements, terms, r, series, column):
    """Largest |shear| of a storey whose floors twist, or of its struck columns: straight in drift and twist but for
    forces of links and of lines whose force is smooth."""
    el = elements[column.storey]
    share = column.share
    absolute = r.h > 0.0
    n = _pair_series(dofs, elements, terms, r, el, share * el.k, share * el.coupled_k, share * el.f0)
    _add_forces(elements, terms, r, series, column)
    column.peak = highest(r, n, r.end, column.peak, absolute)
