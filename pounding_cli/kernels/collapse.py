"""Where a storey has drifted so far that its building counts as collapsed: the run ends there, within a step."""

from __future__ import annotations

from numba import njit

from pounding_cli.kernels import cells as c
from pounding_cli.kernels.cells import at
from pounding_cli.kernels.clock import COLLAPSED, END, ORDER, H
from pounding_cli.kernels.layout import CALLED
from pounding_cli.kernels.polynomial import first_crossing
from pounding_cli.kernels.program_storeys import drift_terms
from pounding_cli.kernels.simd import greater, load, lowest, magnitude, maximum, no_inline
from pounding_cli.kernels.summary import drift_series

_LIMITS = 4
"""The row of `Run.ends` that holds the drifts of collapse."""


@njit(**CALLED)
def take_limits(run, row, collapse):
    """Enter the drift at which every storey counts as collapsed [m]; places without a slot keep zero, and no drift."""
    no_inline()
    for slot in range(row.slots):
        run.ends[_LIMITS * run.padded + row.slot_places[slot]] = collapse[slot]


@njit(**CALLED)
def _passes(run, i, limit):
    """Whether what `scratch` holds, a drift, passes +limit or -limit before the step ends; its place goes to END."""
    no_inline()
    order = run.tally[ORDER]
    found = False
    first = run.scratch[0]
    for side in (-1.0, 1.0):
        for k in range(order + 1):
            run.scratch[k] *= -1.0
        run.scratch[0] = limit + side * first
        s = first_crossing(run.scratch, order, min(1.0, run.clock[END]))
        if s < run.clock[END] and s <= 1.0:
            run.clock[END] = s
            found = True
    return found


@njit(**CALLED)
def first_collapse(run):
    """Whether a storey collapses before what stands in END: its place goes there."""
    no_inline()
    found = False
    slots = run.slots
    for b in range(run.slot_start, run.slot_stop, 8):
        reach = maximum(magnitude(load(slots, at(b, c.DRIFT0))), magnitude(load(slots, at(b, c.DRIFT1))))
        reach = reach + load(slots, at(b, c.DRIFT_CHORD_DEVIATION))
        suspects = greater(reach, load(run.ends, _LIMITS * run.padded + b))
        while suspects != 0:
            i = b + lowest(suspects)
            suspects &= suspects - 1
            drift_series(run, run.clock[H], i, run.tally[ORDER], 1.0)
            found = _passes(run, i, run.ends[_LIMITS * run.padded + i]) or found
    run.tally[COLLAPSED] = 1 if found else 0
    return found


@njit(**CALLED)
def first_collapse_on_program(run, p):
    """The same in a program step, whose drifts have series of their own."""
    no_inline()
    found = False
    for i in range(run.slot_start, run.slot_stop):
        limit = run.ends[_LIMITS * run.padded + i]
        if limit > 0.0 and limit < 1e300:
            drift_terms(run, p, i, run.tally[ORDER], 1.0)
            found = _passes(run, i, limit) or found
    run.tally[COLLAPSED] = 1 if found else 0
    return found
