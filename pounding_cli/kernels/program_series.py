"""The series of a program step: a step in which the force of some link is written as operations.

Such a force may have no Taylor series in time where contact begins and ends: v^(3/2) has none at v = 0. With q =
v^(1/b) of one link, and a step in s where
    dt = h q^(b-1) ds,
all is analytic again, for q' = h v' / b, t' = h q^(b-1), u' = h q^(b-1) w, w' = h q^(b-1) u'' (primes by s; v' and u''
in time, w the velocity). Contact begins as a regular start and ends at a simple root of q. The link nearest to v = 0
is taken; where none needs it, b = 1. Order k of the accelerations follows from order k of displacements and velocities
as in a plain step (`recurrence`); only the way to order k + 1 differs."""

from __future__ import annotations

import math

from numba import njit, types

from pounding_cli.kernels import cells as c
from pounding_cli.kernels import law_table as t
from pounding_cli.kernels.cells import at, of, of_link, of_link_integer
from pounding_cli.kernels.clock import ELAPSED, GROUND, GROUND_SLOPE, LEAST_SCALE, SEGMENT_GROUND, SEGMENT_LENGTH
from pounding_cli.kernels.frame import DOUBLES, INTEGERS, Frame, filler
from pounding_cli.kernels.layout import CALLED, PART
from pounding_cli.kernels.link_series import difference, link_forces_on
from pounding_cli.kernels.polynomial import value
from pounding_cli.kernels.program import CLOSING, MEMORY, RATE, ROOT, carry_out, product_term
from pounding_cli.kernels.program_storeys import (
    end_series,
    expand_storeys,
    flows_on,
    largest_memory_term,
    part_followed,
    push_slots,
    some_flow,
    start_storeys,
)
from pounding_cli.kernels.recurrence import LARGEST, no_orders
from pounding_cli.kernels.simd import (
    from_left,
    from_right,
    further,
    fused,
    greater,
    load,
    magnitude,
    maximum,
    no_inline,
    splat,
    store,
)
from pounding_cli.kernels.terms import hand_on, spring_forces

JUDGED = 4
"""Orders at the end of a series by which it is judged. Two, as in a plain step, are too few beside a damper that
sticks: a slip that is an error of the series would stay."""

JUDGED_IN_ROOT = 6
"""The same of a step in q, or with storeys whose memory flows: some orders are empty then."""

LEAST_ORDER = 10
"""No series is shorter: where contact begins, the first order of a force of v^n is n b, and those before say
nothing."""

MARGIN = 0.9
"""Part of the longest step that the last orders allow which is taken [-]."""

ROUNDED = 1e-14
"""Part of a floor's displacement [-] below which a closing is rounding. Two links that close at one instant do not both
get a step in q of their own; the other is left without force up to there, or its series would allow no step."""

LARGEST_ROOT = 8
"""Largest b."""

_ROWS_OF = ("T", "B", "powers", "registers", "sizes", "U", "A", "storeys")
PROGRAMS = Frame(
    "programs",
    dict.fromkeys(("rows", "each"), types.int64)
    | {"resting": INTEGERS, "closed": INTEGERS, "numbers": DOUBLES}
    | dict.fromkeys(_ROWS_OF, DOUBLES),
)
"""rows: room for orders; each: doubles of the registers of one link, or of one storey. resting: whether a closed link
presses with less than is resolved (1 or 0). closed: how many links have a force to follow, then these. numbers: below.
By order: T time [s] and B what dt / ds is [s]; powers: of q, one after another. registers: series of each link
(`program`); storeys: likewise of each storey, where a memory flows. sizes: of each link the largest closing and rate so
far, what is rounding is judged by, and what may be left out of its force [N]. By order and place: U displacements [m],
A accelerations relative to the ground [m/s2]."""

fill_programs = filler(PROGRAMS)

SCALE, CHOSEN, B_ROOT, FLOWING = range(4)
"""Places in `numbers`: h; the link whose q the step is taken in, -1 for none; b; how many storeys have a memory that
flows."""

NUMBERS = 8

_CLOSINGS, _RATES, _ALLOWED = range(3)
"""Places in `sizes` of a link."""

_SIZES = 3


def room_for_programs(padded: int, linked: int, registers: int, rows: int, flowing: bool) -> tuple[int, int]:
    """Doubles and integers of scratch. `flowing`: whether storeys have a memory that flows."""
    by_order = 2 + LARGEST_ROOT + registers * (linked + (padded if flowing else 0)) + 2 * padded
    return NUMBERS + rows * by_order + _SIZES * linked, 2 * linked + 1


@njit(**PART)
def programs_frame(place, run, registers, rows, memory, integers):
    """The frame at `place`, its rows in `memory`."""
    time = further(memory, NUMBERS)
    powers = further(time, 2 * rows)
    written = further(powers, LARGEST_ROOT * rows)
    sizes = further(written, registers * run.padded_links * rows)
    displacements = further(sizes, _SIZES * run.padded_links)
    accelerations = further(displacements, rows * run.padded)
    return fill_programs(place, (
        rows, registers * rows, integers, further(integers, run.padded_links), memory, time, further(time, rows),
        powers, written, sizes, displacements, accelerations, further(accelerations, rows * run.padded),
    ))  # fmt: skip


@njit(**PART)
def branch_of(run, e):
    """The branch that link e is on."""
    return run.link_integers[of_link_integer(e, c.BRANCH)]


@njit(**PART)
def is_closed(run, e):
    """Whether link e has a force to follow."""
    return run.links[of_link(e, c.CLOSED)] != 0.0


@njit(**PART)
def register(p, e, which):
    """The series of a register of link e."""
    return further(p.registers, e * p.each + which * p.rows)


@njit(**PART)
def force_register(run, p, e):
    """The series of the force of link e [N]."""
    b = branch_of(run, e)
    regular = e == int(p.numbers[CHOSEN])
    first, last = (t.FIRST_REGULAR, t.LAST_REGULAR) if regular else (t.FIRST_STEP, t.LAST_STEP)
    return register(p, e, ROOT + int(t.branch(run, b, last) - t.branch(run, b, first)))


@njit(**CALLED)
def on_program(run, inelastic):
    """Whether some link or storey of the island is on a branch that plain steps cannot follow."""
    no_inline()
    general = 0.0
    for e in range(run.link_start, run.link_stop):
        general = max(general, t.branch(run, branch_of(run, e), t.GENERAL))
    return general > 0.0 or (inelastic and some_flow(run) > 0)


@njit(**PART)
def _sides(run, e):
    return run.link_integers[of_link_integer(e, c.LEFT_SLOT)], run.link_integers[of_link_integer(e, c.RIGHT_SLOT)]


@njit(**CALLED)
def _start_link(run, p, e):
    """Order 0 of closing, rate and memory of link e, what is known exactly put in."""
    no_inline()
    left, right = _sides(run, e)
    links = run.links
    one, other = run.W[left - run.padded], run.W[right - run.padded]
    v = difference(one - links[of_link(e, c.LINK_OFFSET)], other, 0.0)
    rate = difference(run.W[left], run.W[right], 0.0)
    pinned = run.link_integers[of_link_integer(e, c.PINNED_AT_EVENT)]
    if pinned == t.CLOSING:
        v = links[of_link(e, c.PINNED_CLOSING)]
    if pinned == t.RATE:
        rate = links[of_link(e, c.PINNED_CLOSING)]
    register(p, e, CLOSING)[0] = v
    register(p, e, RATE)[0] = rate
    links[of_link(e, c.CLOSING)] = v
    if is_closed(run, e):
        p.closed[0] += 1
        p.closed[p.closed[0]] = e
        memory = register(p, e, MEMORY)
        for k in range(0, p.rows, 8):
            store(memory, k, splat(0.0))
        memory[0] = links[of_link(e, c.MEMORY)]
        register(p, e, ROOT)[0] = 0.0
        sizes = further(p.sizes, _SIZES * e)
        sizes[_CLOSINGS] = max(abs(one), abs(other))
        sizes[_RATES] = max(abs(run.W[left]), abs(run.W[right]))
        sizes[_ALLOWED] = _allowed_force(run, e)


@njit(**PART)
def _allowed_force(run, e):
    """What may be left out of the force of link e [N]: what moves neither floor by more than is resolved."""
    left, right = _sides(run, e)
    slots = run.slots
    return min(
        slots[of(left, c.TERM_TOLERANCE)] * slots[of(left, c.MASS)],
        slots[of(right, c.TERM_TOLERANCE)] * slots[of(right, c.MASS)],
    )


@njit(**CALLED)
def least_closing(run, p, e):
    """A closing [m] below which the force of link e is not resolved, however it got there from where it is."""
    no_inline()
    v = 1e-3
    while v > 1e-60 and _is_resolved(run, p, e, v):
        v *= 0.125
    return max(v, _rounded(run, p, e))


@njit(**PART)
def _rounded(run, p, e):
    """A closing [m] of link e that is rounding of its floors' displacements."""
    left, right = _sides(run, e)
    return ROUNDED * max(abs(p.U[left]), abs(p.U[right]))


@njit(**CALLED)
def _is_resolved(run, p, e, v):
    """Whether the force of link e at a closing v [m] is more than may be left out, at its rate or, if that is more, the
    one that it has when it gets there from rest."""
    no_inline()
    b = branch_of(run, e)
    first, last = int(t.branch(run, b, t.FIRST_STEP)), int(t.branch(run, b, t.LAST_STEP))
    closing, rate = register(p, e, CLOSING), register(p, e, RATE)
    v0, r0 = closing[0], rate[0]
    closing[0], rate[0] = v, max(abs(r0), math.sqrt(2.0 * _largest_acceleration(run, e) * v))
    force = carry_out(run.operations, first, last, register(p, e, 0), p.rows, 0)
    closing[0], rate[0] = v0, r0
    return abs(force) > p.sizes[_SIZES * e + _ALLOWED]


@njit(**PART)
def _largest_acceleration(run, e):
    """Of the floors of link e of late [m/s2]."""
    left, right = _sides(run, e)
    return max(run.slots[of(left, c.SCALE)], run.slots[of(right, c.SCALE)], run.clock[LEAST_SCALE])


@njit(**CALLED)
def start(run, p):
    """Order 0 of the step: displacements, links, the link whose q it is taken in, and its length to begin with."""
    no_inline()
    clock = run.clock
    clock[GROUND] = clock[SEGMENT_GROUND] + clock[GROUND_SLOPE] * clock[ELAPSED]
    p.numbers[FLOWING] = some_flow(run)
    if p.numbers[FLOWING] > 0.0:
        start_storeys(run, p)
    for b in range(run.slot_start, run.slot_stop, 8):
        store(p.U, b, load(run.W, b - run.padded))
    nearest = math.inf
    p.numbers[CHOSEN], p.numbers[B_ROOT] = -1.0, 1.0
    p.closed[0] = 0
    for e in range(run.link_start, run.link_stop):
        run.link_forces[e] = 0.0
        p.resting[e] = 0
        if branch_of(run, e) != t.NO_BRANCH:
            _start_link(run, p, e)
    for n in range(1, p.closed[0] + 1):
        e = p.closed[n]
        if t.branch(run, branch_of(run, e), t.REGULAR) <= 1.0:
            continue
        v, rate = register(p, e, CLOSING)[0], register(p, e, RATE)[0]
        if not (v > _rounded(run, p, e) and _is_resolved(run, p, e, v)):
            least = least_closing(run, p, e)
            p.resting[e] = 1 if v < least else 0
            # from rest q would stand still
            if v < least and not rate > math.sqrt(2.0 * _largest_acceleration(run, e) * least):
                continue
        if max(v, 0.0) / max(abs(rate), 1e-300) < nearest:
            nearest = max(v, 0.0) / max(abs(rate), 1e-300)
            p.numbers[CHOSEN], p.numbers[B_ROOT] = e, t.branch(run, branch_of(run, e), t.REGULAR)
    left_over = clock[SEGMENT_LENGTH] - clock[ELAPSED]
    h = left_over
    if p.numbers[CHOSEN] >= 0.0:
        e, root = int(p.numbers[CHOSEN]), p.numbers[B_ROOT]
        p.resting[e] = 0
        q = max(register(p, e, CLOSING)[0], 0.0) ** (1.0 / root)
        register(p, e, ROOT)[0] = q
        speed = abs(register(p, e, RATE)[0]) / root
        by_place = left_over / q ** (root - 1.0) if q > 0.0 else math.inf
        by_speed = (left_over * root / speed ** (root - 1.0)) ** (1.0 / root) if speed > 0.0 else math.inf
        h = min(by_place, by_speed)
    p.numbers[SCALE] = h


@njit(**PART)
def _time(p, k):
    """Order k of B = h q^(b-1), and order k + 1 of the time."""
    root = int(p.numbers[B_ROOT])
    h = p.numbers[SCALE]
    if root == 1:
        p.B[k] = h if k == 0 else 0.0
    else:
        q = further(p.registers, int(p.numbers[CHOSEN]) * p.each + ROOT * p.rows)
        p.powers[k] = q[k]
        for n in range(1, root - 1):
            p.powers[n * p.rows + k] = product_term(further(p.powers, (n - 1) * p.rows), q, k)
        p.B[k] = h * p.powers[(root - 2) * p.rows + k]
    p.T[k + 1] = p.B[k] / (k + 1)


@njit(**PART)
def flows(run, e):
    """Whether the memory of link e changes with time while its branch holds."""
    return t.branch(run, branch_of(run, e), t.FLOW) != 0.0


@njit(**CALLED)
def _memory(run, p, e, k):
    """Order k, from 1, of the memory of link e: B times its rate, integrated by s."""
    no_inline()
    rate = register(p, e, int(t.branch(run, branch_of(run, e), t.FLOW)))
    register(p, e, MEMORY)[k] = product_term(p.B, rate, k - 1) * run.reciprocal[k]  # fault: memory-flows


@njit(**CALLED)
def _links(run, p, k):
    """Order k of every closed link's force; what acts goes into `link_forces` [N]."""
    no_inline()
    for n in range(1, p.closed[0] + 1):
        e = p.closed[n]
        if k > 0:
            closing, rate = register(p, e, CLOSING), register(p, e, RATE)
            sizes = further(p.sizes, _SIZES * e)
            left, right = _sides(run, e)
            one, other = p.U[k * run.padded + left], p.U[k * run.padded + right]
            closing[k] = difference(one, other, sizes[_CLOSINGS])
            sizes[_CLOSINGS] = max(sizes[_CLOSINGS], abs(one), abs(other))
            one, other = run.W[k * run.padded + left], run.W[k * run.padded + right]
            rate[k] = difference(one, other, sizes[_RATES])
            sizes[_RATES] = max(sizes[_RATES], abs(one), abs(other))
            if flows(run, e):
                _memory(run, p, e, k)
        if p.resting[e] != 0:
            force_register(run, p, e)[k] = 0.0
            continue
        b = branch_of(run, e)
        first, last = t.branch(run, b, t.FIRST_STEP), t.branch(run, b, t.LAST_STEP)
        if e == int(p.numbers[CHOSEN]):
            first, last = t.branch(run, b, t.FIRST_REGULAR), t.branch(run, b, t.LAST_REGULAR)
        force = carry_out(run.operations, int(first), int(last), register(p, e, 0), p.rows, k)
        run.link_forces[e] = force * run.links[of_link(e, c.ACTS)]


@njit(**CALLED)
def _accelerations(run, terms, p, k, has_terms):
    """Order k of the accelerations, from that of displacements, velocities, the ground and the links."""
    no_inline()
    if has_terms:
        spring_forces(run, terms, k, p.U, k * run.padded, 1.0)
    slots = run.slots
    row = k * run.padded
    zero = splat(0.0)
    ground = splat(run.clock[GROUND] if k == 0 else run.clock[GROUND_SLOPE] * p.T[k])
    u_left, w_left = zero, zero
    for b in range(run.slot_start, run.slot_stop, 8):
        more = b + 8 < run.slot_stop
        u, w = load(p.U, row + b), load(run.W, row + b)
        u_right = load(p.U, row + b + 8) if more else zero
        w_right = load(run.W, row + b + 8) if more else zero
        total = load(slots, at(b, c.STENCIL_U)) * u - load(slots, at(b, c.LOADED)) * ground  # fault: program-ground
        total = fused(load(slots, at(b, c.STENCIL_U_BELOW)), from_left(u_left, u), total)
        total = fused(load(slots, at(b, c.STENCIL_U_ABOVE)), from_right(u, u_right), total)
        total = fused(load(slots, at(b, c.STENCIL_V)), w, total)
        total = fused(load(slots, at(b, c.STENCIL_V_BELOW)), from_left(w_left, w), total)
        total = fused(load(slots, at(b, c.STENCIL_V_ABOVE)), from_right(w, w_right), total)
        total = total + load(slots, at(b, c.OFFSET_ACCELERATION)) if k == 0 else total
        if has_terms:
            total = fused(load(slots, at(b, c.INVERSE_MASS)), load(slots, at(b, c.SPRING_FORCE)), total)
        if run.link_stop > run.link_start:
            total = fused(load(slots, at(b, c.INVERSE_MASS)), link_forces_on(run, b), total)
        store(p.A, row + b, total)
        u_left, w_left = u, w
    if p.numbers[FLOWING] > 0.0 and k > 0:
        push_slots(run, p, k)
    if has_terms:
        hand_on(run, terms, p.A, row)


@njit(**CALLED)
def _integrate(run, p, k):
    """Order k + 1 of displacements and velocities: B times velocities and accelerations, integrated by s."""
    no_inline()
    padded = run.padded
    share = run.reciprocal[k + 1]
    last = k if p.numbers[B_ROOT] > 1.0 else 0
    for b in range(run.slot_start, run.slot_stop, 8):
        moved, gained = splat(0.0), splat(0.0)
        for i in range(last + 1):
            part = splat(p.B[i])
            moved = fused(part, load(run.W, (k - i) * padded + b), moved)
            gained = fused(part, load(p.A, (k - i) * padded + b), gained)
        store(p.U, (k + 1) * padded + b, moved * share)
        store(run.W, (k + 1) * padded + b, gained * share)
    chosen = int(p.numbers[CHOSEN])
    if chosen >= 0:
        speed = p.numbers[SCALE] / p.numbers[B_ROOT]
        register(p, chosen, ROOT)[k + 1] = speed * register(p, chosen, RATE)[k] * share


@njit(**PART)
def _exceeds(run, p, k, tolerance, total):
    """Whether order k of an acceleration or a force, or order k + 1 of the time, which is `total` by now [s], is more
    than may be left out."""
    exceeding = 0
    for b in range(run.slot_start, run.slot_stop, 8):
        exceeding |= greater(magnitude(load(p.A, k * run.padded + b)), load(run.slots, at(b, c.TERM_TOLERANCE)))
    # The terms of a memory that flows say nothing until `part_followed` has looked at them.
    exceeds = exceeding != 0 or p.numbers[FLOWING] > 0.0 or abs(p.T[k + 1]) > tolerance * abs(total)
    for n in range(1, p.closed[0] + 1):
        e = p.closed[n]
        exceeds = exceeds or abs(force_register(run, p, e)[k]) > p.sizes[_SIZES * e + _ALLOWED]
    return exceeds


@njit(**PART)
def _judged(p):
    """Orders at the end of a series by which it is judged."""
    return JUDGED_IN_ROOT if p.numbers[CHOSEN] >= 0.0 or p.numbers[FLOWING] > 0.0 else JUDGED


@njit(**CALLED)
def expand(run, terms, p, tolerance, most, has_terms):
    """All series up to the order at which the last ones are below what may be left out, or up to `most`, forces and
    accelerations to the one before.

    Returns (order, whether that held, whether they are finite)."""
    no_inline()
    p.T[0] = 0.0
    total = 0.0
    small, k = no_orders()
    judged = _judged(p)
    while k < most and (small < judged or k < LEAST_ORDER):
        _time(p, k)
        _links(run, p, k)
        if p.numbers[FLOWING] > 0.0:
            expand_storeys(run, p, k)
        _accelerations(run, terms, p, k, has_terms)
        _integrate(run, p, k)
        total += p.T[k + 1]
        small = 0 if _exceeds(run, p, k, tolerance, total) else small + 1
        k += 1
    for n in range(1, p.closed[0] + 1):
        if flows(run, p.closed[n]):
            _memory(run, p, p.closed[n], k)
    if p.numbers[FLOWING] > 0.0:
        end_series(run, p, k)
    last = splat(p.T[k])
    for b in range(run.slot_start, run.slot_stop, 8):
        last = last + magnitude(load(run.W, k * run.padded + b)) + magnitude(load(p.U, k * run.padded + b))
    return k, small >= judged, greater(splat(LARGEST), last) == 255


@njit(**PART)
def _term_over_allowed(run, p, k, tolerance):
    """The largest order k of an acceleration, a force or a memory over what may be left out of it [-]."""
    sizes = splat(0.0)
    for b in range(run.slot_start, run.slot_stop, 8):
        sizes = maximum(sizes, magnitude(load(p.A, k * run.padded + b)) / load(run.slots, at(b, c.TERM_TOLERANCE)))
    store(run.scratch, 0, sizes)
    largest = largest_memory_term(run, p, k) / tolerance if p.numbers[FLOWING] > 0.0 else 0.0
    for lane in range(8):
        largest = max(largest, run.scratch[lane])
    for n in range(1, p.closed[0] + 1):
        e = p.closed[n]
        largest = max(largest, abs(force_register(run, p, e)[k]) / p.sizes[_SIZES * e + _ALLOWED])
    return largest


@njit(**CALLED)
def part_allowed(run, p, order, tolerance):
    """The part of the step over which the last orders stay below what may be left out [-], at most 1."""
    no_inline()
    worst = 0.0
    judged = _judged(p)
    for k in range(order - judged, order):
        term = _term_over_allowed(run, p, k, tolerance)
        worst = max(worst, term ** (1.0 / k)) if term > 0.0 else worst
    ratio = MARGIN / worst if worst > MARGIN else 1.0
    for _ in range(3 if p.numbers[CHOSEN] >= 0.0 else 0):  # the time, whose error shifts all, by itself
        allowed = tolerance * abs(value(p.T, order, ratio))
        worst = 1.0
        for k in range(order - judged + 1, order + 1):
            term = abs(p.T[k]) * ratio**k
            worst = max(worst, (term / allowed) ** (1.0 / k)) if term > allowed > 0.0 else worst
        ratio /= worst
    return part_followed(run, p, tolerance, ratio) if p.numbers[FLOWING] > 0.0 else ratio


@njit(**PART)
def _rescale_series(run, series, order):
    """Orders of one series by the powers in `scratch`."""
    for k in range(0, order + 1, 8):
        store(series, k, load(series, k) * load(run.scratch, k))


@njit(**CALLED)
def rescale(run, p, order, ratio):
    """All series that are asked for afterwards for a step `ratio` times as long."""
    no_inline()
    p.numbers[SCALE] *= ratio
    power = 1.0
    for k in range(p.rows):
        run.scratch[k] = power
        power *= ratio
    for k in range(order + 1):
        power = run.scratch[k]
        p.B[k] *= ratio  # it is by s as well
        for i in range(k * run.padded + run.slot_start, k * run.padded + run.slot_stop, 8):
            store(run.W, i, load(run.W, i) * power)
            store(p.U, i, load(p.U, i) * power)
            store(p.A, i, load(p.A, i) * power)
    _rescale_series(run, p.T, order)
    _rescale_series(run, p.B, order)
    for n in range(1, p.closed[0] + 1):
        e = p.closed[n]
        for which in (CLOSING, RATE, MEMORY, ROOT):
            _rescale_series(run, register(p, e, which), order)
        _rescale_series(run, force_register(run, p, e), order)
    if p.numbers[FLOWING] > 0.0:
        for i in range(run.slot_start, run.slot_stop):
            if flows_on(run, i):
                for place in range(0, p.each, p.rows):
                    _rescale_series(run, further(p.storeys, i * p.each + place), order)
