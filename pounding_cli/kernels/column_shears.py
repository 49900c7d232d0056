"""Shears in columns that slabs strike: their share of the storey's, and what blows add below and above themselves.

Each is followed as the shear of a slot of its own, which has no mass and does not move."""

from __future__ import annotations

from numba import njit

from pounding_cli.kernels import cells as c
from pounding_cli.kernels.cells import of, of_link, of_term
from pounding_cli.kernels.clock import ORDER, H
from pounding_cli.kernels.layout import CALLED, INLINE, PART
from pounding_cli.kernels.peaks import largest
from pounding_cli.kernels.polynomial import ABSOLUTE
from pounding_cli.kernels.program_frame import force_register
from pounding_cli.kernels.program_storeys import shear_terms
from pounding_cli.kernels.simd import no_inline
from pounding_cli.kernels.summary import drift_series


@njit(**PART)
def _pushes(run, e):
    """Whether link e is solved now and acts."""
    here = run.link_start <= e < run.link_stop
    return here and run.links[of_link(e, c.CLOSED)] != 0.0 and run.links[of_link(e, c.ACTS)] != 0.0


@njit(**PART)
def _raise(run, terms, n, order):
    """The peak of shear n by the polynomial in `scratch`."""
    peak = of(terms.shear_slot[n], c.PEAK_SHEAR)
    run.slots[peak] = largest(run, order, run.slots[peak], ABSOLUTE)


@njit(**PART)
def no_shears(run, terms):
    """Nothing to track: the kernel of scenes without struck columns holds no code of it."""


@njit(**CALLED)
def track(run, terms):
    """Raise the peaks of a step by time series, up to s = END."""
    no_inline()
    order = run.tally[ORDER]
    for n in range(terms.shears):
        i = terms.shear_storey[n]
        if not run.slot_start <= i < run.slot_stop:
            continue
        share = terms.shear_share[n]
        drift_series(run, run.clock[H], i, order, share * run.slots[of(i, c.TANGENT)])
        run.scratch[0] += share * run.slots[of(i, c.OFFSET)]
        for j in range(terms.shear_first[n], terms.shear_first[n + 1]):
            e = terms.shear_link[j]
            if _pushes(run, e):
                for k in range(order):
                    run.scratch[k] += terms.shear_weight[j] * run.series[of_term(run, k, e, c.FORCE_TERM)]
        _raise(run, terms, n, order)


@njit(**CALLED)
def track_program(run, terms, p):
    """Likewise of a program step."""
    no_inline()
    order = run.tally[ORDER]
    for n in range(terms.shears):
        i = terms.shear_storey[n]
        if not run.slot_start <= i < run.slot_stop:
            continue
        share = terms.shear_share[n]
        shear_terms(run, p, i, share)
        for j in range(terms.shear_first[n], terms.shear_first[n + 1]):
            e = terms.shear_link[j]
            if _pushes(run, e):
                force = force_register(run, p, e)
                for k in range(order):
                    run.scratch[k] += terms.shear_weight[j] * force[k]
        _raise(run, terms, n, order)


@njit(**INLINE)
def raise_at(peaks, elements, shear, force):
    """Raise the peaks by shears of storeys, by slot, and forces of elements at one instant: of fixed-step methods."""
    table = elements.shears
    for n in range(table.number):
        found = table.share[n] * shear[table.storey[n]]
        for j in range(table.first[n], table.first[n + 1]):
            found += table.weight[j] * force[elements.springs + table.link[j]]
        peaks.shear[table.slot[n]] = max(peaks.shear[table.slot[n]], abs(found))
