"""Where a run keeps what it knows: one record of doubles for every eight slots (or links), so that whatever a loop
over them needs stands at constant distances from one pointer.

A compiler keeps a dozen pointers in registers, not a hundred: with an array for every quantity, moving the pointers
cost more than the arithmetic. Field f of the eight slots from b on begins at `at(b, f)`; that of slot i alone is at
`of(i, f)`."""

from __future__ import annotations

import numpy as np
from numba import njit, types

from pounding_cli.kernels.frame import DOUBLES, INTEGERS, Frame, filler, mover
from pounding_cli.kernels.layout import CALLED, PART
from pounding_cli.kernels.link_table import NO_LINK
from pounding_cli.kernels.simd import stand_alone

# A slot: what it is, in the order of `layout.Slots`; its stencils (`recurrence`); what a step leaves to the next: its
# branch and scale, peaks and energies so far, as in `layout.Peaks` and `ledger.Ledger`; what a step is told by: its
# ends and strays (`summary`).
(
    COUPLE, COUPLE_RIGHT, STIFFNESS, DASHPOT, INVERSE_MASS, MASS, ALPHA, REAL, YIELD_DRIFT, HARDENING, PLATEAU, RISE,
    ELEVATION, OWN, LEFT, RIGHT, OWN_RATE, LEFT_RATE, RIGHT_RATE, PUSH, LINE, PLASTIC, TANGENT, OFFSET, SCALE,
    MOST_DRIFT, MOST_SHEAR, MOST_PULL, TOP, BOTTOM, INPUT, DASHED, DRAGGED, HYSTERESIS, FORCE, ROOT, ALLOWED, V_END,
    DRIFT0, DRIFT, RATE0, RATE, PULL0, PULL, V_STRAY, DRIFT_STRAY, RATE_STRAY, PULL_STRAY,
) = range(0, 8 * 48, 8)  # fmt: skip
_SLOT = 49  # one more than there are: an odd number of cache lines spreads them over the cache
SLOT_LEFT, SLOT_LEFT_END = LINE, FORCE  # fault: island-slots-put-back
"""The fields that a step leaves to the next, from the first to before the second; stencils follow from the branch."""

# A link: what its closing leaves out; what a step leaves to the next: the law of its branch (`link_series`), the
# closing known exactly, events at this instant, peaks and work; what a step is told by: its start.
(
    LEAVES_OUT, LINEAR_LAW, CUBIC_LAW, OFFSET_LAW, RATE_LAW, ROOT_LAW, APPLIED, CLOSED, LOW, HIGH, EXACTLY, MEMORY,
    TURNS, MOST_CLOSING, MOST_FORCE, IMPULSE, CONTACT, WORK_DONE, CLOSING, SIZE, DAMPING, HALF,
) = range(0, 8 * 22, 8)  # fmt: skip
_LINK = 23  # one more than there are, an odd number again
LINK_LEFT, LINK_LEFT_END = LINEAR_LAW, CLOSING
"""Likewise."""

# A link in integers: its slots; what a step leaves: branch, what is known exactly, impacts.
LEFT_SLOT, RIGHT_SLOT, BRANCH, SNAPPED, IMPACTS = range(0, 8 * 5, 8)
TIE = 5  # integers a link
TIE_LEFT, TIE_LEFT_END = BRANCH, 8 * TIE  # fault: island-links-put-back
"""Likewise."""

# The series of a link, by order: closing [m], its rate [m/s], force [N]; the infill's v^2 and sqrt(s_cur).
V_TERM, RATE_TERM, F_TERM, SQUARE_TERM, ROOT_TERM = range(0, 8 * 5, 8)
_TERM = 5

_POINTERS = {
    "W": DOUBLES, "ends": DOUBLES, "slots": DOUBLES, "snapped": INTEGERS, "links": DOUBLES, "ties": INTEGERS,
    "branches": DOUBLES, "guards": DOUBLES, "operations": DOUBLES, "gains": INTEGERS, "losses": INTEGERS, "pushed": DOUBLES,
    "series": DOUBLES, "rule": DOUBLES,
    "reciprocal": DOUBLES, "clock": DOUBLES, "tally": INTEGERS, "scratch": DOUBLES, "tilt": DOUBLES,
}  # fmt: skip
RUN = Frame(
    "run",
    dict.fromkeys(("low", "high", "first", "last", "padded", "linked", "rounds", "feet"), types.int64) | _POINTERS,
    movable=("low", "high", "first", "last"),
)
"""[low, high) and [first, last): places of the buildings that are run now, and of the links between them (`focus`);
padded, linked: places in all; rounds: see `layout.Row`; feet: number of foundations. W: coefficients of velocity by
order and place [m/s], after a row of displacements at the step's start [m]. ends: rows of displacements at the step's
end, of their strays (`summary`), and of what they stay below and above in this segment [m]. slots, links, ties, series:
records as above; snapped: of storeys, as in `layout.State`; branches, guards: the tables of the links' laws
(`link_table`); gains, losses: by round and place, the link that pushes the
slot to the right and to the left, or `linked`, the first of eight zeros behind one order's link forces, `pushed` [N];
where rounds is 0, the first of eight links. rule: the ledger's points and weights. reciprocal[k] = 1 / k. clock, tally:
see `clock`. scratch: one polynomial. tilt: storey height times rocking rate by order and place, after a row of the same
of the angle."""

run_frame = filler(RUN)
focus = mover(RUN)


@njit(**PART)
def at(b, field):
    """Where a field of eight slots begins; b is a multiple of eight."""
    return b * _SLOT + field


@njit(**PART)
def of(i, field):
    """Where the field of one slot is."""
    return (i & -8) * _SLOT + field + (i & 7)


@njit(**PART)
def at_link(b, field):
    """Where a field of eight links begins."""
    return b * _LINK + field


@njit(**PART)
def of_link(e, field):
    """Where the field of one link is."""
    return (e & -8) * _LINK + field + (e & 7)


@njit(**PART)
def at_tie(b, field):
    """Where an integer of eight links begins."""
    return b * TIE + field


@njit(**PART)
def of_tie(e, field):
    """Where the integer of one link is."""
    return (e & -8) * TIE + field + (e & 7)


@njit(**PART)
def at_term(run, k, b, field):
    """Where order k of the series of eight links begins."""
    return (k * run.linked + b) * _TERM + field


@njit(**PART)
def of_term(run, k, e, field):
    """Where order k of the series of one link is."""
    return (k * run.linked + (e & -8)) * _TERM + field + (e & 7)


def room_for(padded: int, links: int, orders: int) -> tuple[int, int]:
    """Doubles and integers of the records of so many slots and links, padding included."""
    return _SLOT * padded + (_LINK + orders * _TERM) * links, padded + TIE * links


@njit(**PART)
def parts_of(padded, links, orders):
    """Doubles of the slots', the links' and the series' records."""
    return _SLOT * padded, _LINK * links, orders * _TERM * links


@njit(**CALLED)
def take_slots(run, row, slots, state, peaks, ledger):
    """Copy what is given by slot into the records; places without a slot stay zero."""
    stand_alone()
    c = run.slots
    for i in range(run.padded):
        c[of(i, YIELD_DRIFT)] = np.inf
    for slot in range(row.slots):
        i = row.spots[slot]
        c[of(i, COUPLE)] = slots.couple[slot]
        c[of(i, COUPLE_RIGHT)] = slots.couple_right[slot]
        c[of(i, STIFFNESS)] = slots.stiffness[slot]
        c[of(i, DASHPOT)] = slots.dashpot[slot]
        c[of(i, INVERSE_MASS)] = slots.inverse_mass[slot]
        c[of(i, MASS)] = slots.mass[slot]
        c[of(i, ALPHA)] = slots.alpha[slot]
        c[of(i, REAL)] = slots.real[slot]
        c[of(i, YIELD_DRIFT)] = slots.yield_drift[slot]
        c[of(i, HARDENING)] = slots.hardening[slot]
        c[of(i, PLATEAU)] = slots.plateau[slot]
        c[of(i, RISE)] = slots.rise[slot]
        c[of(i, ELEVATION)] = slots.elevation[slot]
        run.W[i - run.padded] = state.u[slot]
        run.W[i] = state.v[slot]
        c[of(i, LINE)] = state.line[slot]
        c[of(i, PLASTIC)] = state.plastic[slot]
        run.snapped[i] = state.snapped_storey[slot]
        c[of(i, SCALE)] = 0.0
        c[of(i, MOST_DRIFT)] = peaks.drift[slot]
        c[of(i, MOST_SHEAR)] = peaks.shear[slot]
        c[of(i, MOST_PULL)] = peaks.acceleration[slot]
        c[of(i, TOP)] = peaks.displacement_max[slot]
        c[of(i, BOTTOM)] = peaks.displacement_min[slot]
        c[of(i, INPUT)] = ledger.input[slot]
        c[of(i, DASHED)] = ledger.dashpots[slot]
        c[of(i, DRAGGED)] = ledger.drag[slot]
        c[of(i, HYSTERESIS)] = ledger.hysteresis[slot]


@njit(**CALLED)
def give_slots(run, row, state, peaks, ledger):
    """Copy what has changed by slot back."""
    stand_alone()
    c = run.slots
    for slot in range(row.slots):
        i = row.spots[slot]
        state.u[slot] = run.W[i - run.padded]
        state.v[slot] = run.W[i]
        state.line[slot] = c[of(i, LINE)]
        state.plastic[slot] = c[of(i, PLASTIC)]
        state.snapped_storey[slot] = run.snapped[i]
        peaks.drift[slot] = c[of(i, MOST_DRIFT)]
        peaks.shear[slot] = c[of(i, MOST_SHEAR)]
        peaks.acceleration[slot] = c[of(i, MOST_PULL)]
        peaks.displacement_max[slot] = c[of(i, TOP)]
        peaks.displacement_min[slot] = c[of(i, BOTTOM)]
        ledger.input[slot] = c[of(i, INPUT)]
        ledger.dashpots[slot] = c[of(i, DASHED)]
        ledger.drag[slot] = c[of(i, DRAGGED)]
        ledger.hysteresis[slot] = c[of(i, HYSTERESIS)]


@njit(**PART)
def _pair_up(run, row):
    """Sides of the links where each eight of them join eight places to eight, in order."""
    for b in range(row.number - 1):
        for e in range(row.joints[b], row.joints[b + 1]):
            on = e - row.joints[b]
            run.ties[of_tie(e, LEFT_SLOT)] = row.first[b] + on
            run.ties[of_tie(e, RIGHT_SLOT)] = row.first[b + 1] + on
            if (on & 7) == 0:
                run.losses[row.first[b] + on] = e
                run.gains[row.first[b + 1] + on] = e


@njit(**PART)
def _list(run, table, i, e):
    """Enter link e in the first round in which slot i has none."""
    while table[i] != run.linked:
        i += run.padded
    table[i] = e


@njit(**CALLED)
def take_links(run, row, links, state, peaks, ledger):
    """Copy what is given by link into the records."""
    stand_alone()
    c = run.links
    n = run.ties
    for e in range(run.linked):
        n[of_tie(e, BRANCH)] = NO_LINK
        c[of_link(e, MOST_CLOSING)] = np.inf
    for i in range(max(run.rounds, 1) * run.padded):
        run.gains[i] = run.linked
        run.losses[i] = run.linked
    if run.rounds == 0:
        _pair_up(run, row)
    for link in range(row.links):
        e = row.seats[link]
        c[of_link(e, LEAVES_OUT)] = links.offset[link]
        c[of_link(e, EXACTLY)] = state.link_at[link]
        c[of_link(e, MEMORY)] = state.link_memory[link]
        c[of_link(e, TURNS)] = 0.0
        c[of_link(e, MOST_CLOSING)] = peaks.closing[link]
        c[of_link(e, MOST_FORCE)] = peaks.force[link]
        c[of_link(e, IMPULSE)] = peaks.impulse[link]
        c[of_link(e, CONTACT)] = peaks.contact_time[link]
        c[of_link(e, WORK_DONE)] = ledger.links[link]
        if run.rounds > 0:
            n[of_tie(e, LEFT_SLOT)] = row.spots[links.left[link]]
            n[of_tie(e, RIGHT_SLOT)] = row.spots[links.right[link]]
            _list(run, run.gains, n[of_tie(e, RIGHT_SLOT)], e)
            _list(run, run.losses, n[of_tie(e, LEFT_SLOT)], e)
        n[of_tie(e, BRANCH)] = state.link_branch[link]
        n[of_tie(e, SNAPPED)] = state.snapped_link[link]
        n[of_tie(e, IMPACTS)] = peaks.impacts[link]


@njit(**CALLED)
def give_links(run, row, state, peaks, ledger):
    """Copy what has changed by link back."""
    stand_alone()
    c = run.links
    n = run.ties
    for link in range(row.links):
        e = row.seats[link]
        peaks.closing[link] = c[of_link(e, MOST_CLOSING)]
        peaks.force[link] = c[of_link(e, MOST_FORCE)]
        peaks.impulse[link] = c[of_link(e, IMPULSE)]
        peaks.contact_time[link] = c[of_link(e, CONTACT)]
        ledger.links[link] = c[of_link(e, WORK_DONE)]
        state.link_branch[link] = n[of_tie(e, BRANCH)]
        state.snapped_link[link] = n[of_tie(e, SNAPPED)]
        state.link_at[link] = c[of_link(e, EXACTLY)]
        state.link_memory[link] = c[of_link(e, MEMORY)]
        peaks.impacts[link] = n[of_tie(e, IMPACTS)]
