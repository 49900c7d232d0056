"""The Taylor series of one step: every order from the one before by the equations of motion.

Time runs as s = (t - t0) / h from 0 to 1. Coefficient k of the displacement's rate du/ds stands in `W[k]`, that of the storey
drift in `D[k]`; each row of these is one padded row of slots. With Q = h^2 (k_t D + F0) + h c dD/ds the recurrence is
    h^2 u''_k = (couple_(i+1) Q_(i+1) - Q_i + links) / m - h alpha W_k - h^2 a_g,k,    W_(k+1) = h^2 u''_k / (k + 1).
"""

from __future__ import annotations

from collections import namedtuple

from numba import njit

from pounding_cli.kernels.layout import CUBIC, INLINE, LINKS_CUBIC, LINKS_NONE
from pounding_cli.kernels.simd import (
    any_greater,
    from_left,
    from_right,
    load,
    magnitude,
    maximum,
    splat,
    store,
)

LARGEST_ORDER = 34
"""Rows in the coefficient arrays."""

Work = namedtuple(
    "Work",
    "W D V F square slope root phi_W phi_D tangent offset kth dashh alphah force tilt shear reciprocal curve",
)
"""Scratch of a run. W, D: coefficients by order and slot. V, F: closing and force of each link by order; square, slope, root:
the infill's v^2, s_cur and its square root by order. phi_W, phi_D: rocking by order. tangent [N/m] and offset [N] of each
storey's branch; kth, dashh, alphah: tangent, dashpot and alpha times h^2, h, h; force, tilt, shear: one order's scratch;
reciprocal[k] = 1/k; curve[k] = k (k - 1) / 8."""


@njit(**INLINE)
def _infill_force(links, work, e, k, h):
    """Order k of the cubic law with its square-root dashpot (eq. 9), times h^2; v is known to order k + 1."""
    base = e * LARGEST_ORDER
    v, square, slope, root = work.V, work.square, work.slope, work.root
    cubic = links.cubic[e]
    total = 0.0
    for i in range(k + 1):
        total += v[base + i] * v[base + k - i]
    square[base + k] = total
    slope[base + k] = 3.0 * cubic * total + (links.stiffness[e] if k == 0 else 0.0)
    force = links.stiffness[e] * v[base + k]
    third = 0.0
    for i in range(k + 1):
        third += square[base + i] * v[base + k - i]
    force = h * h * (force + cubic * third)
    if links.root_dashpot[e] > 0.0:
        if k == 0:
            root[base] = slope[base] ** 0.5
        else:
            total = slope[base + k]
            for i in range(1, k):
                total -= root[base + i] * root[base + k - i]
            root[base + k] = 0.5 * total / root[base]
        total = 0.0
        for i in range(k + 1):
            total += root[base + i] * (k - i + 1) * v[base + k - i + 1]
        force += h * links.root_dashpot[e] * total
    return force


@njit(**INLINE)
def _link_forces(links, state, work, active, count, k, padded, h, kinds):
    """Order k of every active link's force, added to `work.force`."""
    row = k * padded
    for a in range(count):
        e = active[a]
        base = e * LARGEST_ORDER
        rate = work.W[row + links.left[e]] - work.W[row + links.right[e]]
        work.V[base + k + 1] = rate * work.reciprocal[k + 1]
        if kinds == LINKS_CUBIC and state.link_branch[e] == CUBIC:
            force = _infill_force(links, work, e, k, h)
        elif kinds == LINKS_CUBIC and links.kind[e] == 1:
            force = h * h * links.beyond[e] * work.V[base + k] + h * links.beyond_dashpot[e] * rate
            if k == 0:
                force += h * h * links.beyond_force[e]
        else:
            force = h * h * links.stiffness[e] * work.V[base + k] + h * links.dashpot[e] * rate
        work.F[base + k] = force
        if state.link_cut[e] == 0:
            work.force[links.left[e]] -= force
            work.force[links.right[e]] += force


@njit(**INLINE)
def _foundation_before(slots, feet, work, k, padded, h):
    """Rocking's share of the drift rates, and the mass-proportional damping of the structural motion (eq. 2)."""
    count = feet.first.size
    for f in range(count):
        turning = work.phi_W[k * count + f]
        base = feet.base[f]
        sway = work.W[k * padded + base] if base >= 0 else 0.0
        moment = 0.0
        for i in range(feet.first[f], feet.stop[f]):
            work.tilt[i] = slots.rise[i] * turning
            arm = slots.elevation[i]
            drag = h * feet.alpha[f] * slots.mass[i] * (work.W[k * padded + i] - sway - arm * turning)
            work.force[i] -= drag
            if base >= 0:
                work.force[base] += drag
            moment += drag * arm
        work.phi_D[(LARGEST_ORDER - 1) * count + f] = (
            moment  # kept for _foundation_after in a row no order reaches
        )


@njit(**INLINE)
def _foundation_after(slots, feet, work, k, h):
    """Order k + 1 of the rocking angle from the storey shears of order k."""
    count = feet.first.size
    for f in range(count):
        moment = work.phi_D[(LARGEST_ORDER - 1) * count + f]
        for i in range(feet.first[f], feet.stop[f]):
            moment += work.shear[i] * slots.rise[i]
        turning = work.phi_W[k * count + f]
        moment -= h * h * feet.stiffness[f] * work.phi_D[k * count + f] + h * feet.dashpot[f] * turning
        work.phi_D[(k + 1) * count + f] = turning * work.reciprocal[k + 1]
        work.phi_W[(k + 1) * count + f] = moment / feet.inertia[f] * work.reciprocal[k + 1]


@njit(**INLINE)
def expand(
    slots, feet, links, state, work, peaks, active, count, padded, h, ground, ground_slope, tolerance, quiet, guess, most, founded, kinds
):  # fmt: skip
    """Coefficients up to the order at which two acceleration terms in a row are below `tolerance` times the slot's
    largest acceleration so far (at least `quiet`), or up to `most`; returns (order of W and D, whether that held)."""
    h2 = h * h
    for b in range(0, padded, 8):
        store(work.kth, b, load(work.tangent, b) * h2)
        store(work.dashh, b, load(slots.dashpot, b) * h)
        store(work.alphah, b, load(slots.alpha, b) * h)
    zero = splat(0.0)
    small_before = False
    k = 0
    while True:
        if founded or (kinds != LINKS_NONE and count > 0):
            for b in range(0, padded, 8):
                store(work.force, b, zero)
            if kinds != LINKS_NONE:
                _link_forces(links, state, work, active, count, k, padded, h, kinds)
            if founded:
                _foundation_before(slots, feet, work, k, padded, h)
        row = k * padded
        reciprocal = work.reciprocal[k + 1]
        pull = h2 * ground if k == 0 else (h2 * h * ground_slope if k == 1 else 0.0)
        right = zero
        here = load(work.W, row + padded - 8)
        for b in range(padded - 8, -8, -8):
            left = load(work.W, row + b - 8) if b > 0 else zero
            rate = here - load(slots.couple, b) * from_left(left, here)
            if founded:
                rate = rate - load(work.tilt, b)
            shear = load(work.kth, b) * load(work.D, row + b) + load(work.dashh, b) * rate
            if k == 0:
                shear = shear + load(work.offset, b) * h2
            if founded:
                store(work.shear, b, shear)
            total = load(slots.couple_right, b) * from_right(shear, right) - shear
            if founded or (kinds != LINKS_NONE and count > 0):
                total = total + load(work.force, b)
            acceleration = load(slots.inverse_mass, b) * total - load(work.alphah, b) * here
            if k < 2:
                acceleration = acceleration - load(slots.real, b) * pull
            store(work.D, row + padded + b, rate * reciprocal)
            store(work.W, row + padded + b, acceleration * reciprocal)
            right = shear
            here = left
        if founded:
            _foundation_after(slots, feet, work, k, h)
        if k >= guess - 1:
            large = False
            limit = tolerance * h2 * reciprocal
            for b in range(0, padded, 8):
                allowed = maximum(load(peaks.acceleration, b), splat(quiet)) * limit
                large = large or any_greater(magnitude(load(work.W, row + padded + b)), allowed)
            if not large and small_before:
                return k + 1, True
            small_before = not large
        k += 1
        if k == most:
            return k, False


@njit(**INLINE)
def shrink(work, peaks, padded, h, tolerance, quiet, order):
    """The fraction of a step that meets the tolerance at its highest order; rescales nothing."""
    worst = 0.0
    for k in (order - 1, order):
        size = 0.0
        for i in range(padded):
            size = max(size, abs(work.W[k * padded + i]) / max(peaks.acceleration[i], quiet))
        size *= k / (h * h)
        if size > 0.0:
            worst = max(worst, (size / tolerance) ** (1.0 / (k - 1)))
    return 0.9 / worst if worst > 0.9 else 1.0


@njit(**INLINE)
def rescale(feet, work, active, count, padded, order, ratio, founded, kinds):
    """Coefficients for a step `ratio` times as long: the motion is the same, only s is measured anew."""
    power = 1.0
    feet_count = feet.first.size
    for k in range(order + 1):
        for i in range(padded):
            work.W[k * padded + i] *= power * ratio
            work.D[k * padded + i] *= power
        if founded:
            for f in range(feet_count):
                work.phi_W[k * feet_count + f] *= power * ratio
                work.phi_D[k * feet_count + f] *= power
        if kinds != LINKS_NONE:
            for a in range(count):
                work.V[active[a] * LARGEST_ORDER + k] *= power
                work.F[active[a] * LARGEST_ORDER + k] *= power * ratio * ratio
        power *= ratio
