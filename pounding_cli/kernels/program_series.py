"""The series of a program step: a step in which the force of some link is written as operations.

Such a force may have no Taylor series in time where contact begins and ends: v^(3/2) has none at v = 0. With q =
v^(1/b) of one link, and a step in s where
    dt = h q^(b-1) ds,
all is analytic again, for q' = h v' / b, t' = h q^(b-1), u' = h q^(b-1) w, w' = h q^(b-1) u'' (primes by s; v' and u''
in time, w the velocity). Contact begins as a regular start and ends at a simple root of q. The link nearest to v = 0
is taken; where none needs it, b = 1. Order k of the accelerations follows from order k of displacements and velocities
as in a plain step (`recurrence`); only the way to order k + 1 differs."""

from __future__ import annotations

from numba import njit

from pounding_cli.kernels import cells as c
from pounding_cli.kernels import law_table as t
from pounding_cli.kernels.cells import at, of_link
from pounding_cli.kernels.clock import GROUND, GROUND_SLOPE
from pounding_cli.kernels.layout import CALLED, PART
from pounding_cli.kernels.link_series import difference, link_forces_on
from pounding_cli.kernels.program import CLOSING, MEMORY, RATE, ROOT, carry_out, product_term
from pounding_cli.kernels.program_frame import (
    B_ROOT,
    CHOSEN,
    CLOSINGS,
    FLOWING,
    RATES,
    SCALE,
    SIZES,
    branch_of,
    flows,
    force_register,
    register,
    sides_of,
)
from pounding_cli.kernels.program_length import exceeds_allowed, judged_orders
from pounding_cli.kernels.program_storeys import end_series, expand_storeys, push_slots, some_flow
from pounding_cli.kernels.recurrence import LARGEST, no_orders
from pounding_cli.kernels.simd import (
    from_left,
    from_right,
    further,
    fused,
    greater,
    load,
    magnitude,
    no_inline,
    splat,
    store,
)
from pounding_cli.kernels.terms import hand_on, spring_forces

LEAST_ORDER = 10
"""No series is shorter: where contact begins, the first order of a force of v^n is n b, and those before say
nothing."""


@njit(**CALLED)
def on_program(run, inelastic):
    """Whether some link or storey of the island is on a branch that plain steps cannot follow."""
    no_inline()
    general = 0.0
    for e in range(run.link_start, run.link_stop):
        general = max(general, t.branch(run, branch_of(run, e), t.GENERAL))
    return general > 0.0 or (inelastic and some_flow(run) > 0)


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


@njit(**CALLED)
def _memory(run, p, e, k):
    """Order k, from 1, of the memory of link e: B times its rate, integrated by s."""
    no_inline()
    rate = register(p, e, int(t.branch(run, branch_of(run, e), t.FLOW)))
    register(p, e, MEMORY)[k] = product_term(p.B, rate, k - 1) * run.reciprocal[k]


@njit(**CALLED)
def _links(run, p, k):
    """Order k of every closed link's force; what acts goes into `link_forces` [N]."""
    no_inline()
    for n in range(1, p.closed[0] + 1):
        e = p.closed[n]
        if k > 0:
            closing, rate = register(p, e, CLOSING), register(p, e, RATE)
            sizes = further(p.sizes, SIZES * e)
            left, right = sides_of(run, e)
            one, other = p.U[k * run.padded + left], p.U[k * run.padded + right]
            closing[k] = difference(one, other, sizes[CLOSINGS])
            sizes[CLOSINGS] = max(sizes[CLOSINGS], abs(one), abs(other))
            one, other = run.W[k * run.padded + left], run.W[k * run.padded + right]
            rate[k] = difference(one, other, sizes[RATES])
            sizes[RATES] = max(sizes[RATES], abs(one), abs(other))
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
        total = load(slots, at(b, c.STENCIL_U)) * u - load(slots, at(b, c.LOADED)) * ground
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


@njit(**CALLED)
def expand(run, terms, p, tolerance, most, has_terms):
    """All series up to the order at which the last ones are below what may be left out, or up to `most`, forces and
    accelerations to the one before.

    Returns (order, whether that held, whether they are finite)."""
    no_inline()
    p.T[0] = 0.0
    total = 0.0
    small, k = no_orders()
    judged = judged_orders(p)
    while k < most and (small < judged or k < LEAST_ORDER):
        _time(p, k)
        _links(run, p, k)
        if p.numbers[FLOWING] > 0.0:
            expand_storeys(run, p, k)
        _accelerations(run, terms, p, k, has_terms)
        _integrate(run, p, k)
        total += p.T[k + 1]
        small = 0 if exceeds_allowed(run, p, k, tolerance, total) else small + 1
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
