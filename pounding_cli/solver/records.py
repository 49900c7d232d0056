"""The records that a run works on: one per degree of freedom, one per element, and one for the run.

An element is one-dimensional: it deforms by v = sum of weight x u over its degrees of freedom, less an offset (the gap
of a contact), and its force acts back on the same degrees of freedom by the same weights. Element i < n is the *storey*
below degree of freedom i (or the spring under a foundation), v = u_i - below u_(i-1) + lean u_foot, whose forces a walk
up the storeys adds; the others are dashpots to the ground, frame lines of floors that twist, and links, in this order.
All have two ends and any number of further terms. A frame line counts as a storey: its drift is looked at both ways.
Where floors twist, the drift of a line is that of its storey plus `lever` times the twist of its storey, so that
straight lines need no series of their own: their stiffnesses and dashpots add up in these two storeys
(`branches.gather_lines`).

In the functions that are compiled `dof` and `el` are records of these, `row` is one of SERIES, and `run` that of RUN.
They stand at the places i, e and a; x counts terms, k orders of a series, and g places of a quadrature. Displacement,
velocity and acceleration are u, v and a; of an element v is the deformation, `rate` or r its rate, and f its force.
A field ends in 0 at the start of a step and in 1 at its end; d stands before a chord deviation (`step_end`).

SI units: m, m/s, N, kg, s, J; for a rocking base rad, N m, kg m2.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pounding_cli.laws.formula import MAX_OPERATIONS
from pounding_cli.laws.law import HISTORY, PARAMETERS

ORDERS = 32
"""Room for the orders of a series: none has more than 31 terms."""

MIN_STATE = 1e-6
"""Size of a displacement [m], velocity [m/s] or history variable below which DOP853 resolves nothing: its tolerance is
relative to that at least."""

PLACES_INSIDE = 8
"""Places inside a step where velocities and forces are looked at for its energies."""


def _build_dtype(fields: str) -> np.dtype:
    """Return the type of a record from lines of a kind, a name and a meaning.

    The kind is f8 (a number), i8 (a count, or 0 and 1) or u8 (a place among other records); `w:32` is a row of 32.
    Lines that begin with # are headings.
    """
    columns: list[tuple[str, str, tuple[int, ...]]] = []
    for line in fields.strip().splitlines():
        if not line.lstrip().startswith("#"):
            kind, field = line.split()[:2]
            name, _, shape = field.partition(":")
            columns.append((name, kind, tuple(map(int, shape.split("x"))) if shape else ()))
    return np.dtype(columns, align=True)


DOF = _build_dtype(f"""
    # for the walk up the storeys
    f8 inv_mass  1 / mass; 0 of what does not move or is held
    f8 drag      mass-proportional damping [1/s]
    f8 below     1 where the storey stands on the degree of freedom before it
    f8 push      sum of the forces of elements, order by order
    f8 allowed   1 / what a term of the series may leave out of the acceleration
    f8 lean      what a unit of `foot` adds to the drift of the storey
    f8 u0        displacement
    f8 a0        total acceleration
    f8 w:{ORDERS}      coefficients of the velocity in the step
    f8 inside:{PLACES_INSIDE}  velocity at the places of the quadrature
    # for the end of the step, its events and its peaks
    f8 u1
    f8 v1
    f8 a1
    f8 du
    f8 dv
    f8 da
    f8 mass
    f8 loaded    part of the mass that the ground accelerates [-]
    f8 scale     recent acceleration
    f8 u_max     largest displacement so far
    f8 u_min     smallest displacement so far
    f8 a_max     largest total acceleration so far
    f8 fastest   largest speed so far
    f8 felt      1 where the acceleration of the ground belongs to the total one; 0 of a floor that twists
    f8 unit      what counts as 1 m/s2: 1, or 1 / radius of gyration of a floor that twists [rad/m]
    f8 apart:8   empty, for nine lines of the cache a record: eight (512 bytes) lie in the same places of it
    u8 foot      the rocking of its base
""")

ELEMENT = _build_dtype(f"""
    # present branch, see laws.law.Behaviour
    f8 k
    f8 c
    f8 stiffness   k, less `load`
    f8 previous    rate, of the order before
    f8 f0
    f8 low
    f8 high
    f8 slow
    f8 fast
    f8 cubic
    f8 relaxation
    # motion in the step
    f8 v0
    f8 v1
    f8 r0
    f8 r1
    f8 dv
    f8 dr
    f8 offset      part of the sum of the terms that the deformation leaves out
    f8 hold        weight of the right end, 0 where that is the ground
    f8 root
    f8 exact       deformation at the guard just met
    f8 load        P / h of P-Delta [N/m]
    f8 collapse    drift at which the storey counts as collapsed
    # largest values and sums so far
    f8 peak_v      largest |v| of a storey, v of a link
    f8 peak_f      largest |f|
    f8 impulse     of a link
    f8 time        of a link with a force
    f8 work        done on it
    f8 f1          force at the step's end, of one that is smooth
    f8 least       smallest v
    f8 at          where in the step the branch ends
    # where floors twist
    f8 along       of a line, what a unit of the drift of its storey adds to its drift
    f8 lever       of a line, what a unit of the twist of its storey adds to its drift
    f8 coupled_k   of a storey, what its lines add to its force by the deformation of its `mate`
    f8 coupled_c   of a storey, what its lines add to its force by the rate of its `mate`
    f8 size_v      of a storey, sum of the sizes of the terms of its deformation
    f8 size_r      of a storey, sum of the sizes of the terms of its rate
    # the law, see laws.law.Behaviour
    f8 p:{PARAMETERS}        parameters
    f8 h:{HISTORY}        history variables
    i8 kind        place of the law in laws.BEHAVIOURS
    i8 branch
    i8 levels
    i8 cuts
    i8 crosses
    i8 smooth
    i8 closed
    i8 acts
    i8 guard       met at the step's end
    i8 pinned      what is exactly known after it (`VALUE`...), 0 nothing
    i8 stuck       events at one instant
    i8 hits        times that a link closed
    i8 row         place among the series
    i8 state       place of h[0] among what DOP853 integrates, or 0
    i8 yields      1 for a storey whose work is kept
    i8 holds       1 for a slider that sticks
    i8 slides      1 for a slider
    i8 drifts      1 for what counts as a storey
    i8 twists      1 for a storey whose floors twist, of their drift and of their twist; 2 for the highest of a building
    u8 left        degree of freedom of the left end
    u8 right       degree of freedom of the right end
    u8 first       of its further terms
    u8 last        behind its further terms
    u8 formula     place of its formula among those of the scene
    u8 storey      of a line, the storey whose drift is its own
    u8 mate        of a line, the storey whose twist is its own; of these two storeys, the other one
""")

TERM = _build_dtype("""
    f8 weight
    u8 dof     degree of freedom, of a further term of an element; of a shear, the link or line whose force is a term
""")

COLUMN = _build_dtype("""
    f8 share      part of the storey's shear
    f8 peak       largest |shear| so far
    f8 low        what a unit of the twist adds to the drift of the edge where y is least
    f8 high       what a unit of the twist adds to the drift of the edge where y is largest
    f8 peak_low   largest |drift| of that edge so far
    f8 peak_high  largest |drift| of that edge so far
    i8 is_sum     1 for a storey that is a sum over lines, 0 for struck columns
    u8 storey     its element
    u8 first      term: forces of links and of lines
    u8 last       behind its terms
""")
"""A shear that is looked at beside the elements: in struck columns, or of a storey that is a sum over lines."""

SERIES = _build_dtype(f"""
    f8 v:{ORDERS}           deformation
    f8 rate:{ORDERS}
    f8 f:{ORDERS}           force
    f8 square:{ORDERS}      v^2, of a cubic force
    f8 cubic_root:{ORDERS}  sqrt(k + 3 cubic v^2), of a cubic force
    u8 element
""")
"""Coefficients in the step of an element whose force is not zero."""

RUN = _build_dtype(f"""
    # the step
    f8 h           length
    f8 end         where it ends, from 0 to 1
    f8 g0          acceleration of the ground at its start
    f8 g1          change of that acceleration over its length
    # accuracy
    f8 tolerance         what a series may leave out of an acceleration [-]
    f8 smooth_tolerance  error that a step by DOP853 may have [-]
    f8 least             acceleration below which nothing is resolved
    # lengths of steps
    f8 dt          time step of the motion
    f8 longest     until the next event
    f8 next        that DOP853 tries next
    f8 onset       of the first step of a contact by DOP853; -1 before it
    f8 across      of the longest step that led across the end of a contact
    # energies so far
    f8 input       work of the ground
    f8 drag        taken by mass-proportional damping
    f8 dashpots    taken by dashpots of storeys
    # time
    f8 time
    f8 begun       when the motion began
    f8 most_h      longest step of the run
    f8 rest        length of the last segment, where a tail ends between samples
    f8 smaller     part of the step that the tolerance of DOP853 allows, where finer is asked than it can be [-]
    # numbers of records
    i8 n           degrees of freedom
    i8 m           elements
    i8 drags       dashpots to the ground
    i8 lines       frame lines
    i8 columns     shears beside the elements
    i8 trials      steps that were tried again
    i8 active      elements beside the storeys whose force is not zero
    i8 max_order
    i8 order       of the present series
    # counts so far
    i8 steps
    i8 events
    i8 orders
    i8 instant     events at one instant
    i8 hasty       events in a row, each in the first hundredth of its step (`run.HASTE`)
    # state
    i8 status      how the run ends (`DONE`...)
    i8 smooth      1 while DOP853 takes the steps
    i8 always_smooth  1 where it takes all of them
    i8 follows     1 for a step by DOP853 behind another, in one segment of the motion and without an event between them
    i8 has_lean    1 where a base rocks
    i8 most_steps
    i8 most_events
    i8 output      place of the next output time
    i8 still       1 before the motion begins
    i8 resumes     1 for a run that goes on from records that an earlier one has left
    i8 has_sliders  1 where bases stand on sliders
    # room
    f8 p:{2 * (ORDERS + 8)}        a polynomial and its derivative
    f8 values:8    of a polynomial at the places that it is fitted to
""")

DERIVATIVES = 16
"""Of what DOP853 integrates: at its twelve stages, at the step's end, and three more for the dense output."""

STATE = _build_dtype(f"""
    f8 y0      at the step's start
    f8 y       at a stage
    f8 k:{DERIVATIVES}    derivatives
    f8 c:8     coefficients in the step
    f8 scale   by which errors are measured
""")
"""Of a displacement, velocity or history variable that DOP853 integrates."""

FORMULA = _build_dtype(f"""
    f8 operations:{MAX_OPERATIONS}x4
    f8 registers:{MAX_OPERATIONS + 2}  that the operations fill
    i8 count           of the operations
    i8 result          register of the force
""")
"""Operations of a formula of the study (`laws.formula`)."""

VALUE = 1
"""Of `pinned`, which tells what is exactly known of an element after an event: its deformation is that of the guard."""

ITS_FORCE = 2
"""Of `pinned`: the force is zero."""

RATE = 3
"""Of `pinned`: the rate is that of the guard."""

RATE_AND_SLOPE = 4
"""Of `pinned`: the rate neither grows nor falls besides."""

DONE, COLLAPSED, STEP_BOUND, EVENT_BOUND, STALLED, NOT_FINITE, NO_ROOT, UNSTABLE = range(8)
"""How a run ends: run.status."""


class Room(NamedTuple):
    """Room for steps by DOP853: displacements, then velocities, then history variables; and the formulas of the scene,
    one at least."""

    states: np.ndarray
    formulas: np.ndarray


class Watch(NamedTuple):
    """Room for what a history needs over time.

    times : from 0, shape (t,) [s]
    dofs : displacement [m], velocity [m/s] and total acceleration [m/s2], shape (t, n, 3)
    elements : deformation [m] and force without dashpots of storeys [N], shape (t, m, 2)
    energy : work of the ground, what damping took, work done on links [J], shape (t, 3)
    storeys : work done on storeys that yield [J], shape (t, n)
    """

    times: np.ndarray
    dofs: np.ndarray
    elements: np.ndarray
    energy: np.ndarray
    storeys: np.ndarray


class Data(NamedTuple):
    """The arrays of a run; all functions take them in this order.

    dofs, elements, terms : records of DOF, ELEMENT and TERM; `terms` are those of elements, and then of `columns`
    run : one record a scene
    series : of elements beside the storeys, as many as have a force that is not zero; those of storeys stand behind
    columns : one at least
    room : None where all laws have Taylor series
    watch : room for a history, of no times where none is asked for
    """

    dofs: np.ndarray
    elements: np.ndarray
    terms: np.ndarray
    run: np.ndarray
    series: np.ndarray
    columns: np.ndarray
    room: Room | None
    watch: Watch
