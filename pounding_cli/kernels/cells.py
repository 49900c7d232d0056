"""Where a run keeps what it knows: one record of doubles for every eight slots (or links), so that whatever a loop
over them needs stands at constant distances from one pointer.

A compiler keeps a dozen pointers in registers, not a hundred: with an array for every quantity, moving the pointers
cost more than the arithmetic. Field f of the eight slots from b on begins at `at(b, f)`; that of slot i alone is at
`of(i, f)`."""

from __future__ import annotations

from collections import namedtuple

from numba import njit

from pounding_cli.kernels.layout import CALLED, PART
from pounding_cli.kernels.simd import stand_alone

# A slot: what it is, in the order of `layout.Slots`; its state and branch; stencils (`recurrence`); the step's ends
# (`summary`); peaks and energies so far, as in `layout.Peaks` and `ledger.Ledger`.
(
    COUPLE, COUPLE_RIGHT, STIFFNESS, DASHPOT, INVERSE_MASS, MASS, ALPHA, REAL, YIELD_DRIFT, HARDENING, PLATEAU, RISE,
    ELEVATION, LINE, PLASTIC, TANGENT, OFFSET, OWN, LEFT, RIGHT, OWN_RATE, LEFT_RATE, RIGHT_RATE, PUSH, FORCE, ROOT,
    SCALE, ALLOWED, V_END, DRIFT0, DRIFT, RATE0, RATE, PULL0, PULL, V_STRAY, DRIFT_STRAY, RATE_STRAY, PULL_STRAY,
    MOST_DRIFT, MOST_SHEAR, MOST_PULL, TOP, BOTTOM, INPUT, DASHED, DRAGGED, HYSTERESIS,
) = range(0, 8 * 48, 8)  # fmt: skip
_SLOT = 49  # one more than there are: an odd number of cache lines spreads them over the cache

# A link: its parameters, as in `layout.Links`; the law of its branch (`link_series`); the step's start; peaks and work.
(
    GAP, SPRING, DAMPER, BEYOND, BEYOND_FORCE, BEYOND_DAMPER, CUBE, ROOT_DAMPER, LINEAR_LAW, CUBIC_LAW, OFFSET_LAW,
    RATE_LAW, ROOT_LAW, APPLIED, CLOSED, LOW, HIGH, THICKNESS, CLOSING, SIZE, DAMPING, HALF, TURNS, MOST_CLOSING,
    MOST_FORCE, IMPULSE, CONTACT, WORK_DONE,
) = range(0, 8 * 28, 8)  # fmt: skip
_LINK = 29  # an odd number again

# A link in integers: its slots, kind, whether tension is cut off; branch, cut and what is exactly zero; impacts.
LEFT_SLOT, RIGHT_SLOT, KIND, CUTS, BRANCH, CUT, SNAPPED, IMPACTS = range(0, 8 * 8, 8)
_TIE = 8

# The series of a link, by order: closing [m], its rate [m/s], force [N]; the infill's v^2 and sqrt(s_cur).
V_TERM, RATE_TERM, F_TERM, SQUARE_TERM, ROOT_TERM = range(0, 8 * 5, 8)
_TERM = 5

Run = namedtuple(
    "Run",
    "padded number linked rounds feet W ends slots snapped links ties gains losses pushed series rule reciprocal clock "
    "tally scratch tilt",
)
"""padded: slots with padding; number, linked: links, without and with padding; rounds: see `layout.Links`; feet:
number of foundations. W: coefficients of velocity by order and slot [m/s], after a row of displacements at the step's
start [m]. ends: a row of displacements at the step's end and one of their strays (`summary`) [m]. slots, links, ties,
series: records as above; snapped: of storeys, as in `layout.State`; gains, losses: as in `layout.Links`; pushed: one
order's link forces [N] and eight zeros. rule: the ledger's points and weights. reciprocal[k] = 1 / k. clock, tally:
see `clock`. scratch: one polynomial. tilt: storey height times rocking rate by order and slot, after a row of the
same of the angle."""


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
    return b * _TIE + field


@njit(**PART)
def of_tie(e, field):
    """Where the integer of one link is."""
    return (e & -8) * _TIE + field + (e & 7)


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
    return _SLOT * padded + (_LINK + orders * _TERM) * links, padded + _TIE * links


@njit(**PART)
def parts_of(padded, links, orders):
    """Doubles of the slots', the links' and the series' records."""
    return _SLOT * padded, _LINK * links, orders * _TERM * links


@njit(**CALLED)
def take_slots(run, slots, state, peaks, ledger):
    """Copy what is given by slot into the records."""
    stand_alone()
    c = run.slots
    for i in range(run.padded):
        c[of(i, COUPLE)] = slots.couple[i]
        c[of(i, COUPLE_RIGHT)] = slots.couple_right[i]
        c[of(i, STIFFNESS)] = slots.stiffness[i]
        c[of(i, DASHPOT)] = slots.dashpot[i]
        c[of(i, INVERSE_MASS)] = slots.inverse_mass[i]
        c[of(i, MASS)] = slots.mass[i]
        c[of(i, ALPHA)] = slots.alpha[i]
        c[of(i, REAL)] = slots.real[i]
        c[of(i, YIELD_DRIFT)] = slots.yield_drift[i]
        c[of(i, HARDENING)] = slots.hardening[i]
        c[of(i, PLATEAU)] = slots.plateau[i]
        c[of(i, RISE)] = slots.rise[i]
        c[of(i, ELEVATION)] = slots.elevation[i]
        run.W[i - run.padded] = state.u[i]
        run.W[i] = state.v[i]
        c[of(i, LINE)] = state.line[i]
        c[of(i, PLASTIC)] = state.plastic[i]
        run.snapped[i] = state.snapped_storey[i]
        c[of(i, SCALE)] = 0.0
        c[of(i, MOST_DRIFT)] = peaks.drift[i]
        c[of(i, MOST_SHEAR)] = peaks.shear[i]
        c[of(i, MOST_PULL)] = peaks.acceleration[i]
        c[of(i, TOP)] = peaks.displacement_max[i]
        c[of(i, BOTTOM)] = peaks.displacement_min[i]
        c[of(i, INPUT)] = ledger.input[i]
        c[of(i, DASHED)] = ledger.dashpots[i]
        c[of(i, DRAGGED)] = ledger.drag[i]
        c[of(i, HYSTERESIS)] = ledger.hysteresis[i]


@njit(**CALLED)
def give_slots(run, state, peaks, ledger):
    """Copy what has changed by slot back."""
    stand_alone()
    c = run.slots
    for i in range(run.padded):
        state.u[i] = run.W[i - run.padded]
        state.v[i] = run.W[i]
        state.line[i] = c[of(i, LINE)]
        state.plastic[i] = c[of(i, PLASTIC)]
        state.snapped_storey[i] = run.snapped[i]
        peaks.drift[i] = c[of(i, MOST_DRIFT)]
        peaks.shear[i] = c[of(i, MOST_SHEAR)]
        peaks.acceleration[i] = c[of(i, MOST_PULL)]
        peaks.displacement_max[i] = c[of(i, TOP)]
        peaks.displacement_min[i] = c[of(i, BOTTOM)]
        ledger.input[i] = c[of(i, INPUT)]
        ledger.dashpots[i] = c[of(i, DASHED)]
        ledger.drag[i] = c[of(i, DRAGGED)]
        ledger.hysteresis[i] = c[of(i, HYSTERESIS)]


@njit(**CALLED)
def take_links(run, links, state, peaks, ledger):
    """Copy what is given by link into the records."""
    stand_alone()
    c = run.links
    n = run.ties
    for e in range(run.linked):
        c[of_link(e, GAP)] = links.gap[e]
        c[of_link(e, SPRING)] = links.stiffness[e]
        c[of_link(e, DAMPER)] = links.dashpot[e]
        c[of_link(e, BEYOND)] = links.beyond[e]
        c[of_link(e, BEYOND_FORCE)] = links.beyond_force[e]
        c[of_link(e, BEYOND_DAMPER)] = links.beyond_dashpot[e]
        c[of_link(e, CUBE)] = links.cubic[e]
        c[of_link(e, ROOT_DAMPER)] = links.root_dashpot[e]
        c[of_link(e, TURNS)] = 0.0
        c[of_link(e, MOST_CLOSING)] = peaks.closing[e]
        c[of_link(e, MOST_FORCE)] = peaks.force[e]
        c[of_link(e, IMPULSE)] = peaks.impulse[e]
        c[of_link(e, CONTACT)] = peaks.contact_time[e]
        c[of_link(e, WORK_DONE)] = ledger.links[e]
        n[of_tie(e, LEFT_SLOT)] = links.left[e]
        n[of_tie(e, RIGHT_SLOT)] = links.right[e]
        n[of_tie(e, KIND)] = links.kind[e]
        n[of_tie(e, CUTS)] = links.tension_cut[e]
        n[of_tie(e, BRANCH)] = state.link_branch[e]
        n[of_tie(e, CUT)] = state.link_cut[e]
        n[of_tie(e, SNAPPED)] = state.snapped_link[e]
        n[of_tie(e, IMPACTS)] = peaks.impacts[e]


@njit(**CALLED)
def give_links(run, state, peaks, ledger):
    """Copy what has changed by link back."""
    stand_alone()
    c = run.links
    n = run.ties
    for e in range(run.linked):
        peaks.closing[e] = c[of_link(e, MOST_CLOSING)]
        peaks.force[e] = c[of_link(e, MOST_FORCE)]
        peaks.impulse[e] = c[of_link(e, IMPULSE)]
        peaks.contact_time[e] = c[of_link(e, CONTACT)]
        ledger.links[e] = c[of_link(e, WORK_DONE)]
        state.link_branch[e] = n[of_tie(e, BRANCH)]
        state.link_cut[e] = n[of_tie(e, CUT)]
        state.snapped_link[e] = n[of_tie(e, SNAPPED)]
        peaks.impacts[e] = n[of_tie(e, IMPACTS)]
