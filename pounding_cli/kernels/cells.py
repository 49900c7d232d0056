"""The memory of a run: one record of doubles for every eight slots (or links), so that whatever a loop over them needs
stands at constant distances from one pointer.

A compiler keeps a dozen pointers in registers, not a hundred: with an array for every quantity, moving the pointers
cost more than the arithmetic. Field f of the eight slots from b on begins at `at(b, f)`; that of slot i alone is at
`of(i, f)`.

Fields are numbered by `np.arange`: what takes a plain int numba compiles once for each number."""

from __future__ import annotations

import numpy as np
from numba import njit, types

from pounding_cli.kernels.frame import DOUBLES, INTEGERS, Frame, filler, mover
from pounding_cli.kernels.law_table import NO_BRANCH
from pounding_cli.kernels.layout import CALLED, PART
from pounding_cli.kernels.simd import no_inline
from pounding_cli.kernels.storey_law import energy_held

# A slot: what it is, in the order of `layout.Slots`; its stencils (`recurrence`); its branch: stiffness and offset, the
# drifts between which it stays on it, 1 or -1 where it leaves it as the drift turns down or up, else 0, and the part of
# its shear that is lost, at zero drift and per drift; what a step leaves to the next: what its law remembers, its
# scale, peaks and energies so far, as in `layout.Peaks` and `ledger.Ledger`; what describes a step: values at its start
# (0) and end (1) and deviations from the chord between them (`summary`).
(
    COUPLE, COUPLE_RIGHT, STIFFNESS, DASHPOT, INVERSE_MASS, MASS, ALPHA, LOADED, STENCIL_U, STENCIL_U_BELOW,
    STENCIL_U_ABOVE, STENCIL_V, STENCIL_V_BELOW, STENCIL_V_ABOVE, OFFSET_ACCELERATION, TANGENT, OFFSET,
    DRIFT_LOW, DRIFT_HIGH, TURNS, LOST, LOST_SLOPE, STOREY_MEMORY, _, _, _, _, _, _, _, _, _, _, _, _, _, SCALE,
    PEAK_DRIFT, PEAK_SHEAR, PEAK_ACCELERATION, MAX_DISPLACEMENT, MIN_DISPLACEMENT, INPUT_ENERGY, DASHPOT_ENERGY,
    DRAG_ENERGY, HYSTERESIS_ENERGY, SPRING_FORCE,
    EVENT_ROOT, TERM_TOLERANCE, V1, DRIFT0, DRIFT1, DRIFT_RATE0, DRIFT_RATE1, TOTAL_ACCELERATION0, TOTAL_ACCELERATION1,
    V_CHORD_DEVIATION, DRIFT_CHORD_DEVIATION, DRIFT_RATE_CHORD_DEVIATION, TOTAL_ACCELERATION_CHORD_DEVIATION, GEOMETRIC,
) = np.arange(0, 8 * 61, 8)  # fmt: skip
_SLOT_FIELDS = 61  # an odd number of cache lines spreads them over the cache
SLOT_CHECKPOINT, SLOT_CHECKPOINT_END = STOREY_MEMORY, SPRING_FORCE
"""The fields of a checkpoint (`islands`), from the first to before the second; stencils follow from the branch."""

# A link: what its law leaves out of the closing; what a step leaves to the next: the law of its branch (`link_series`),
# the closing it is pinned at, what it remembers, events at this instant, peaks and work, for how long
# contact is undecided (`from_rest`); what describes a step: its start.
(
    LINK_OFFSET, LAW_LINEAR, LAW_CUBIC, LAW_OFFSET, LAW_DASHPOT, LAW_ROOT, ACTS, CLOSED, LOW, HIGH, PINNED_CLOSING,
    MEMORY, EVENTS_AT_INSTANT, PEAK_CLOSING, PEAK_FORCE, IMPULSE, CONTACT_TIME, WORK, UNDECIDED, CLOSING, LARGEST_TERM,
    DASHPOT_NOW, HALF_INVERSE_ROOT,
) = np.arange(0, 8 * 23, 8)  # fmt: skip
_LINK_FIELDS = 23  # an odd number again
LINK_CHECKPOINT, LINK_CHECKPOINT_END = LAW_LINEAR, CLOSING
"""Likewise."""

# A link in integers: its slots; what a step leaves to the next: branch, what the last event pinned, impacts.
LEFT_SLOT, RIGHT_SLOT, BRANCH, PINNED_AT_EVENT, IMPACTS = np.arange(0, 8 * 5, 8)
LINK_INTEGERS = 5  # integers a link
LINK_INTEGER_CHECKPOINT, LINK_INTEGER_CHECKPOINT_END = BRANCH, 8 * LINK_INTEGERS
"""Likewise."""

# The series of a link, by order: closing [m], its rate [m/s], force [N]; the infill's v^2 and sqrt(s_cur).
CLOSING_TERM, RATE_TERM, FORCE_TERM, SQUARE_TERM, ROOT_TERM = np.arange(0, 8 * 5, 8)
_TERM_FIELDS = 5

# A storey in integers, a row of all of them each: its branch; the guard that it stands at exactly and at rest, 0 for
# none; the guard it meets in this step; its events at this instant.
STOREY_BRANCH, STOREY_PINNED, STOREY_GUARD, STOREY_EVENTS = np.arange(4)
STOREY_INTEGERS = 4
STOREY_INTEGER_CHECKPOINT = STOREY_GUARD
"""The integers of a checkpoint are those before it."""

_POINTERS = {
    "W": DOUBLES, "ends": DOUBLES, "slots": DOUBLES, "storeys": INTEGERS, "links": DOUBLES, "link_integers": INTEGERS,
    "branches": DOUBLES, "guards": DOUBLES, "operations": DOUBLES, "left_links": INTEGERS, "right_links": INTEGERS,
    "link_forces": DOUBLES, "series": DOUBLES, "rule": DOUBLES, "reciprocal": DOUBLES, "clock": DOUBLES,
    "tally": INTEGERS, "scratch": DOUBLES,
}  # fmt: skip
_RANGES = ("slot_start", "slot_stop", "link_start", "link_stop")
_COUNTS = ("padded", "padded_links", "links_per_side")
RUN = Frame("run", dict.fromkeys(_RANGES + _COUNTS, types.int64) | _POINTERS, movable=_RANGES)
"""[slot_start, slot_stop), [link_start, link_stop) : places of the buildings that are solved now, and of the links
    between them (`set_range`)
padded, padded_links : numbers of places in all
links_per_side : see `layout.Row`
W : coefficients of velocity by order and place [m/s], after a row of displacements at the step's start [m]
ends : rows of displacements at the step's end, of their chord deviations (`summary`), of the largest and smallest
    displacements possible in this segment, and of the drifts of collapse (`collapse`) [m]
slots, links, link_integers, series : records as above
storeys : integers of storeys
branches, guards, operations : the tables of the laws (`law_table`)
left_links, right_links : of every place, the link on its left, which pushes it to the right, and the one on its right;
    a row for each of `links_per_side`. `padded_links` where there is none: there eight zeros stand behind the forces.
    Where `links_per_side` is 0, the first of eight links
link_forces : one order of the force of every link [N]
rule : points and weights of the ledger
reciprocal : reciprocal[k] = 1 / k
clock, tally : see `clock`
scratch : one polynomial
"""

run_frame = filler(RUN)
set_range = mover(RUN)


@njit(**PART)
def at(b, field):
    """Where a field of eight slots begins; b is a multiple of eight."""
    return b * _SLOT_FIELDS + field


@njit(**PART)
def of(i, field):
    """Where the field of one slot is."""
    return (i & -8) * _SLOT_FIELDS + field + (i & 7)


@njit(**PART)
def of_storey(run, i, field):
    """Where an integer of one storey is."""
    return field * run.padded + i


@njit(**PART)
def at_link(b, field):
    """Where a field of eight links begins."""
    return b * _LINK_FIELDS + field


@njit(**PART)
def of_link(e, field):
    """Where the field of one link is."""
    return (e & -8) * _LINK_FIELDS + field + (e & 7)


@njit(**PART)
def at_link_integer(b, field):
    """Where an integer of eight links begins."""
    return b * LINK_INTEGERS + field


@njit(**PART)
def of_link_integer(e, field):
    """Where the integer of one link is."""
    return (e & -8) * LINK_INTEGERS + field + (e & 7)


@njit(**PART)
def at_term(run, k, b, field):
    """Where order k of the series of eight links begins."""
    return (k * run.padded_links + b) * _TERM_FIELDS + field


@njit(**PART)
def of_term(run, k, e, field):
    """Where order k of the series of one link is."""
    return (k * run.padded_links + (e & -8)) * _TERM_FIELDS + field + (e & 7)


def record_sizes(padded: int, links: int, orders: int) -> tuple[int, int]:
    """Doubles and integers of the records of so many slots and links, padding included."""
    return _SLOT_FIELDS * padded + (
        _LINK_FIELDS + orders * _TERM_FIELDS
    ) * links, STOREY_INTEGERS * padded + LINK_INTEGERS * links


@njit(**PART)
def record_parts(padded, links, orders):
    """Doubles of the slots', the links' and the series' records."""
    return _SLOT_FIELDS * padded, _LINK_FIELDS * links, orders * _TERM_FIELDS * links


@njit(**CALLED)
def copy_memories(count, given, first, step, taken, start, stride):
    """Copy what the law of a storey remembers, `step` apart from `first` on, to `stride` apart from `start` on."""
    no_inline()
    for m in range(count):
        taken[start + m * stride] = given[first + m * step]


@njit(**CALLED)
def take_slots(run, row, slots, state, peaks, ledger):
    """Copy what is given by slot into the records; places without a slot stay zero."""
    no_inline()
    c = run.slots
    for slot in range(row.slots):
        i = row.slot_places[slot]
        c[of(i, COUPLE)] = slots.couple[slot]
        c[of(i, COUPLE_RIGHT)] = slots.couple_right[slot]
        c[of(i, STIFFNESS)] = slots.stiffness[slot]
        c[of(i, DASHPOT)] = slots.dashpot[slot]
        c[of(i, INVERSE_MASS)] = slots.inverse_mass[slot]
        c[of(i, MASS)] = slots.mass[slot]
        c[of(i, ALPHA)] = slots.alpha[slot]
        c[of(i, LOADED)] = slots.loaded[slot]
        c[of(i, GEOMETRIC)] = slots.geometric[slot]
        run.W[i - run.padded] = state.u[slot]
        run.W[i] = state.v[slot]
        copy_memories(slots.memories, state.storey_memory, slot, slots.size, c, of(i, STOREY_MEMORY), np.int64(8))
        run.storeys[of_storey(run, i, STOREY_BRANCH)] = state.storey_branch[slot]
        run.storeys[of_storey(run, i, STOREY_PINNED)] = state.pinned_storey[slot]
        c[of(i, SCALE)] = 0.0
        c[of(i, PEAK_DRIFT)] = peaks.drift[slot]
        c[of(i, PEAK_SHEAR)] = peaks.shear[slot]
        c[of(i, PEAK_ACCELERATION)] = peaks.acceleration[slot]
        c[of(i, MAX_DISPLACEMENT)] = peaks.displacement_max[slot]
        c[of(i, MIN_DISPLACEMENT)] = peaks.displacement_min[slot]
        c[of(i, INPUT_ENERGY)] = ledger.input[slot]
        c[of(i, DASHPOT_ENERGY)] = ledger.dashpots[slot]
        c[of(i, DRAG_ENERGY)] = ledger.drag[slot]
        c[of(i, HYSTERESIS_ENERGY)] = ledger.hysteresis[slot]


@njit(**CALLED)
def give_slots(run, row, slots, state, peaks, ledger):
    """Copy what has changed by slot back."""
    no_inline()
    c = run.slots
    for slot in range(row.slots):
        i = row.slot_places[slot]
        state.u[slot] = run.W[i - run.padded]
        state.v[slot] = run.W[i]
        copy_memories(slots.memories, c, of(i, STOREY_MEMORY), np.int64(8), state.storey_memory, slot, slots.size)
        state.storey_branch[slot] = run.storeys[of_storey(run, i, STOREY_BRANCH)]
        state.pinned_storey[slot] = run.storeys[of_storey(run, i, STOREY_PINNED)]
        peaks.drift[slot] = c[of(i, PEAK_DRIFT)]
        peaks.shear[slot] = c[of(i, PEAK_SHEAR)]
        peaks.acceleration[slot] = c[of(i, PEAK_ACCELERATION)]
        peaks.displacement_max[slot] = c[of(i, MAX_DISPLACEMENT)]
        peaks.displacement_min[slot] = c[of(i, MIN_DISPLACEMENT)]
        ledger.input[slot] = c[of(i, INPUT_ENERGY)]
        ledger.dashpots[slot] = c[of(i, DASHPOT_ENERGY)]
        ledger.drag[slot] = c[of(i, DRAG_ENERGY)]
        ledger.hysteresis[slot] = c[of(i, HYSTERESIS_ENERGY)]
        drift, b = c[of(i, DRIFT1)], run.storeys[of_storey(run, i, STOREY_BRANCH)]
        if b == NO_BRANCH:
            ledger.stored[slot] = 0.5 * c[of(i, STIFFNESS)] * drift * drift
        else:
            ledger.stored[slot] = energy_held(run, b, drift, c, slots.memories, of(i, STOREY_MEMORY), 8)


@njit(**PART)
def _pair_places(run, row):
    """Sides of the links where each eight of them join eight places to eight, in order."""
    for b in range(row.number - 1):
        for e in range(row.first_link[b], row.first_link[b + 1]):
            on = e - row.first_link[b]
            run.link_integers[of_link_integer(e, LEFT_SLOT)] = row.first_slot[b] + on
            run.link_integers[of_link_integer(e, RIGHT_SLOT)] = row.first_slot[b + 1] + on
            if (on & 7) == 0:
                run.right_links[row.first_slot[b] + on] = e
                run.left_links[row.first_slot[b + 1] + on] = e


@njit(**PART)
def _enter_link(run, table, i, e):
    """Enter link e in the first row in which slot i has none."""
    while table[i] != run.padded_links:
        i += run.padded
    table[i] = e


@njit(**CALLED)
def take_links(run, row, links, state, peaks, ledger):
    """Copy what is given by link into the records."""
    no_inline()
    c = run.links
    n = run.link_integers
    for e in range(run.padded_links):
        n[of_link_integer(e, BRANCH)] = NO_BRANCH
        c[of_link(e, PEAK_CLOSING)] = np.inf
    for i in range(max(run.links_per_side, 1) * run.padded):
        run.left_links[i] = run.padded_links
        run.right_links[i] = run.padded_links
    if run.links_per_side == 0:
        _pair_places(run, row)
    for link in range(row.links):
        e = row.link_places[link]
        c[of_link(e, LINK_OFFSET)] = links.offset[link]
        c[of_link(e, PINNED_CLOSING)] = state.pinned_closing[link]
        c[of_link(e, MEMORY)] = state.link_memory[link]
        c[of_link(e, EVENTS_AT_INSTANT)] = 0.0
        c[of_link(e, PEAK_CLOSING)] = peaks.closing[link]
        c[of_link(e, PEAK_FORCE)] = peaks.force[link]
        c[of_link(e, IMPULSE)] = peaks.impulse[link]
        c[of_link(e, CONTACT_TIME)] = peaks.contact_time[link]
        c[of_link(e, WORK)] = ledger.links[link]
        if run.links_per_side > 0:
            n[of_link_integer(e, LEFT_SLOT)] = row.slot_places[links.left[link]]
            n[of_link_integer(e, RIGHT_SLOT)] = row.slot_places[links.right[link]]
            _enter_link(run, run.left_links, n[of_link_integer(e, RIGHT_SLOT)], e)
            _enter_link(run, run.right_links, n[of_link_integer(e, LEFT_SLOT)], e)
        n[of_link_integer(e, BRANCH)] = state.link_branch[link]
        n[of_link_integer(e, PINNED_AT_EVENT)] = state.pinned_link[link]
        n[of_link_integer(e, IMPACTS)] = peaks.impacts[link]


@njit(**CALLED)
def give_links(run, row, state, peaks, ledger):
    """Copy what has changed by link back."""
    no_inline()
    c = run.links
    n = run.link_integers
    for link in range(row.links):
        e = row.link_places[link]
        peaks.closing[link] = c[of_link(e, PEAK_CLOSING)]
        peaks.force[link] = c[of_link(e, PEAK_FORCE)]
        peaks.impulse[link] = c[of_link(e, IMPULSE)]
        peaks.contact_time[link] = c[of_link(e, CONTACT_TIME)]
        ledger.links[link] = c[of_link(e, WORK)]
        state.link_branch[link] = n[of_link_integer(e, BRANCH)]
        state.pinned_link[link] = n[of_link_integer(e, PINNED_AT_EVENT)]
        state.pinned_closing[link] = c[of_link(e, PINNED_CLOSING)]
        state.link_memory[link] = c[of_link(e, MEMORY)]
        peaks.impacts[link] = n[of_link_integer(e, IMPACTS)]
