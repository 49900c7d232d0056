"""The records that a run works on: one per degree of freedom, one per element, and one for the run.

An element is one-dimensional: it deforms by v = sum of weight x u over its degrees of freedom, less an offset (the gap
of a contact), and its force acts back on the same degrees of freedom by the same weights. Element i < n is the *storey*
below degree of freedom i (or the spring under a foundation), v = u_i - below u_(i-1) + lean u_foot, whose forces a walk
up the storeys adds; the others are dashpots to the ground, frame lines of floors that twist, and links, in this order.
All have two ends and any number of further terms. A frame line counts as a storey: its drift is looked at both ways.
Where floors twist, the drift of a line is that of its storey plus `lever` times the twist of its storey, so that
straight lines need no series of their own: their stiffnesses and dashpots add up in these two storeys
(`events.gather_lines`).

SI units: m, m/s, N, kg, s, J; for a rocking base rad, N m, kg m2.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from pounding_cli.laws.formula import MAX_OPERATIONS
from pounding_cli.laws.law import HISTORY, PARAMETERS

ORDERS = 32
"""Room for the orders of a series: none has more than 31 terms."""

PLACES_INSIDE = 8
"""Places inside a step where velocities and forces are looked at for its energies."""


def _build_dtype(**fields: str) -> np.dtype:
    """Return the type of a record from the names of its fields by kind.

    `f8="a b w:32"` are two numbers and a row of 32; whatever follows the two letters of a kind tells lists of one kind
    apart.
    """
    made: list[Any] = []
    for kind, names in fields.items():
        for each in names.split():
            name, _, shape = each.partition(":")
            made.append((name, kind[:2], tuple(map(int, shape.split("x")))) if shape else (name, kind[:2]))
    return np.dtype(made, align=True)


DOF = _build_dtype(
    # w: coefficients of the velocity in the step [m/s]
    # inside: the velocity at the places of the quadrature
    # drag: mass-proportional damping [1/s]
    # below: 1 where the storey stands on the degree of freedom before it; lean: what a unit of `foot` (rocking) adds to
    # its drift; loaded: part of the mass that the ground accelerates
    # u0 at the step's start; u1, v1, a1 at its end; a0 and a1 are total accelerations; du, dv, da chord deviations
    # push: sum of forces of links, order by order
    # allowed: 1 / what a term of the series may leave out; scale: recent acceleration
    # fastest: largest speed so far [m/s]
    # felt: 1 where the acceleration of the ground belongs to the total one, 0 of a floor that twists
    # unit: what counts as an acceleration of 1 m/s2: 1, or 1 / radius of gyration of a floor that twists [rad/m]
    # apart: nine lines of the cache a record: eight (512 bytes) lie in the same places of it and slow the walks
    f8=f"inv_mass drag below push allowed lean u0 a0 w:{ORDERS} inside:{PLACES_INSIDE} u1 v1 a1 du dv da mass loaded"
    " scale u_max u_min a_max fastest felt unit apart:8",
    u8="foot",
)
ELEMENT = _build_dtype(
    # present branch, see laws.law.Behaviour; stiffness: k, less the load over the height of P-Delta
    # previous: rate of the order before
    # v0, r0 deformation and rate at the step's start, v1, r1 at its end, dv, dr chord deviations
    # exact: deformation at the guard just met; at: where in the step the branch ends
    # load: P / h of P-Delta [N/m]; collapse: drift at which the storey counts as collapsed [m]
    # peak_v: largest |v| of a storey, v of a link; peak_f likewise
    # impulse, time: of a link's force; work: done on it; f1: a smooth force at the step's end
    # least: smallest v so far
    # along, lever: of a line, what a unit of the drift and of the twist of its storey add to its drift
    # coupled_k, coupled_c: of a storey whose floors twist, what its lines add to its force by the deformation and rate
    # of its `mate`; size_v, size_r: sizes of the terms of its deformation and rate
    f8="k c stiffness previous f0 low high slow fast cubic relaxation v0 v1 r0 r1 dv dr offset hold root exact"
    " load collapse peak_v peak_f impulse time work f1 least at along lever coupled_k coupled_c size_v size_r",
    f8_history=f"p:{PARAMETERS} h:{HISTORY}",
    # kind of law (laws.BEHAVIOURS); guard met; pinned: what is exactly known after it (`VALUE`...);
    # stuck: events at one instant; row: place among the series; state: place of h[0] among what DOP853 integrates, or 0
    # yields: 1 for a storey whose work is kept; eased: 1 for a contact that DOP853 steps (`events.FROM_REST`)
    # holds: 1 for a slider that sticks; slides: 1 for a slider; drifts: 1 for what counts as a storey
    # twists: 1 for a storey whose floors twist, of their drift and of their twist; 2 for the highest of a building
    i8="kind branch levels cuts crosses smooth closed acts guard pinned stuck hits row state yields eased holds slides"
    " drifts twists",
    # v = u_left - hold u_right - offset + further terms, first to last; hold: 0 where the right end is the ground
    # formula: place of its formula among those of the scene
    # storey, mate: of a line, the storeys whose drift and twist are its own; of these, mate is the other one
    u8="left right first last formula storey mate",
)
TERM = _build_dtype(f8="weight", u8="dof")
"""Further term of an element; of a struck column the weight of a link's force in its shear."""

COLUMN = _build_dtype(f8="share peak low high peak_low peak_high", i8="is_sum", u8="storey first last")
"""What is looked at beside the elements: the shear in struck columns, and of whole storeys that are sums over lines
(is_sum): a share of the storey's shear, and terms of the forces of links and of lines. Of these storeys the drifts of
both edges too, those of the storey plus `low` and `high` times its twist."""

SERIES = _build_dtype(
    # of a link that acts: deformation, rate, force, and two that a cubic force needs
    f8=" ".join(f"{name}:{ORDERS}" for name in ("v", "rate", "f", "square", "cubic_root")),
    u8="element",
)
RUN = _build_dtype(
    # begun: when the motion began [s]; still: 1 before
    # most_h: longest step of the run [s]; rest: length of the last segment, where a tail ends between samples [s]
    # smaller: part of the step that the tolerance of DOP853 allows, where finer is asked than it can be [-]
    # has_sliders: 1 where bases stand on sliders
    # resumes: 1 for a run that goes on from its records, which an earlier one has left
    # follows: a step by DOP853 follows another, in one segment of the motion and without an event between them
    # drags, lines: numbers of the dashpots to the ground and of the frame lines
    f8="h end g0 g1 tolerance smooth_tolerance least dt longest next onset across input drag dashpots time begun"
    " most_h rest smaller",
    i8="n m drags lines columns trials active max_order order steps events orders instant status smooth always_smooth"
    " follows has_lean most_steps most_events output still resumes has_sliders",
    # p: room for one polynomial and its derivative
    # values: of a polynomial at the places that it is fitted to
    f8_=f"p:{2 * (ORDERS + 8)} values:8",
)

DERIVATIVES = 16
"""Of what DOP853 integrates: at its twelve stages, at the step's end, and three more for the dense output."""

STATE = _build_dtype(
    # y0 at the step's start, y at a stage; k: the derivatives; c: coefficients in the step; scale: what errors are
    # measured by
    f8=f"y0 y k:{DERIVATIVES} c:8 scale"
)

FORMULA = _build_dtype(f8=f"operations:{MAX_OPERATIONS}x4 registers:{MAX_OPERATIONS + 2}", i8="count result")
"""Operations of a formula of the study (`laws.formula`), the registers they fill, and which of them is the force."""

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
    """The arrays of a run; all functions take them in this order, with the one record of `run` as r.

    dofs, elements, terms : records; `terms` are those of links and of struck columns
    run : one record
    series : of the links whose force is not zero; those of smooth storeys stand behind them
    columns : of struck columns, one at least
    room : None where all laws have Taylor series
    watch : what is kept over time, of no times where nothing is
    """

    dofs: np.ndarray
    elements: np.ndarray
    terms: np.ndarray
    run: np.ndarray
    series: np.ndarray
    columns: np.ndarray
    room: Room | None
    watch: Watch
