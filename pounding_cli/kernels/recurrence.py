"""The Taylor series of one step: every order from the one before by the equations of motion.

Time runs as s = (t - t0) / h from 0 to 1. Coefficient k of the displacement stands in row k of `U`, that of its rate
du/ds in row k of `W`; a row is one padded row of slots. Between two events every slot's acceleration is a fixed
combination of its own displacement and rate and of its two neighbours', so with those six *stencils* (times h^2 and h)
    h^2 u''_k = sum of stencil x (U_k, W_k) + links - h^2 a_g,k
    W_(k+1) = h^2 u''_k / (k + 1),    U_(k+1) = W_k / (k + 1)
Only W_(k+1) waits for W_k, through two shuffles and four multiply-adds: that chain is what an order costs.
"""

from __future__ import annotations

from collections import namedtuple

from numba import njit

from pounding_cli.kernels.layout import INLINE, LINKS_NONE
from pounding_cli.kernels.link_series import add_forces
from pounding_cli.kernels.simd import (
    from_left,
    from_right,
    greater,
    load,
    magnitude,
    maximum,
    splat,
    store,
)

LARGEST_ORDER = 34
"""Rows in the coefficient arrays."""

FORGET = 0.9
"""What is left of an acceleration as a scale after one step."""

Work = namedtuple(
    "Work",
    "U W D V rates F square root half sizes turns law phi_W phi_D tangent offset stencil scaled push force tilt "
    "roots scale reciprocal curve twist",
)
"""Scratch of a run. U, W, D: coefficients of displacement, rate and drift by order and slot. V, rates, F: closing,
its rate and force by order and link; square, root, half: the infill's v^2 and sqrt(s_cur) by order, and half its
inverse; sizes: the largest term so far of either floor; turns: events of a link since
time last went on; law: the link laws' coefficients (`link_series`). phi_W,
phi_D: rocking rate and angle by order. tangent [N/m] and offset [N] of each storey's branch. stencil: six rows of
acceleration per displacement (own, left, right) and per velocity (own, left, right); scaled: the same times h^2 and
h. push: acceleration of the offsets [m/s2]. force: one order's link and foundation forces; tilt: storey height times
rocking angle by order and slot. roots: where each storey leaves its branch; scale: acceleration that
an error is measured by [m/s2]. reciprocal[k] = 1/k; curve[k] = k (k -
1) / 8; twist[k] = k (k - 1) (k - 2) / 8."""


@njit(**INLINE)
def restencil(slots, work, i):
    """Renew what depends on the branch of slot i: its own stencils."""
    padded = slots.size
    below = work.tangent[i]
    above = 0.0
    above_dashpot = 0.0
    above_offset = 0.0
    if i + 1 < padded:
        above = slots.couple_right[i] * work.tangent[i + 1]
        above_dashpot = slots.couple_right[i] * slots.dashpot[i + 1]
        above_offset = slots.couple_right[i] * work.offset[i + 1]
    inverse = slots.inverse_mass[i]
    work.stencil[i] = -(below + above) * inverse
    work.stencil[padded + i] = slots.couple[i] * below * inverse
    work.stencil[2 * padded + i] = above * inverse
    work.stencil[3 * padded + i] = -(slots.dashpot[i] + above_dashpot) * inverse - slots.alpha[i]
    work.stencil[4 * padded + i] = slots.couple[i] * slots.dashpot[i] * inverse
    work.stencil[5 * padded + i] = above_dashpot * inverse
    work.push[i] = (above_offset - work.offset[i]) * inverse


@njit(**INLINE)
def _foundations(slots, feet, work, k, padded, h):
    """Order k of what foundations add: rocking's share of the storey shears, the mass-proportional damping of the
    structural motion (eq. 2), and order k + 1 of the rocking angle."""
    count = feet.number
    h2 = h * h
    row = k * padded
    for f in range(count):
        angle = work.phi_D[k * count + f]
        turning = work.phi_W[k * count + f]
        base = feet.base[f]
        sway = work.W[row + base] if base >= 0 else 0.0
        moment = -h2 * feet.stiffness[f] * angle - h * feet.dashpot[f] * turning
        for i in range(feet.first[f], feet.stop[f]):
            rise = slots.rise[i]
            turned = rise * (h2 * work.tangent[i] * angle + h * slots.dashpot[i] * turning)
            work.force[i] += turned
            drift = work.U[row + i]
            rate = work.W[row + i]
            if slots.couple[i] != 0.0:
                work.force[i - 1] -= turned
                drift -= work.U[row + i - 1]
                rate -= work.W[row + i - 1]
            shear = h2 * work.tangent[i] * drift + h * slots.dashpot[i] * rate - turned
            if k == 0:
                shear += h2 * work.offset[i]
            arm = slots.elevation[i]
            drag = h * feet.alpha[f] * slots.mass[i] * (work.W[row + i] - sway - arm * turning)
            work.force[i] -= drag
            if base >= 0:
                work.force[base] += drag
            moment += drag * arm + shear * rise
        angle = turning * work.reciprocal[k + 1]
        work.phi_D[(k + 1) * count + f] = angle
        for i in range(feet.first[f], feet.stop[f]):
            work.tilt[row + padded + i] = slots.rise[i] * angle
        work.phi_W[(k + 1) * count + f] = moment / feet.inertia[f] * work.reciprocal[k + 1]


@njit(**INLINE)
def expand(
    slots, feet, links, state, work, busy, padded, h, ground, ground_slope, tolerance, quiet,
    guess, most, founded, kinds,
):  # fmt: skip
    """Coefficients up to the order at which two acceleration terms in a row are below `tolerance` times the slot's
    acceleration of late (`renew_scale`; at least `quiet`), or up to `most`; returns (highest order, whether that
    held)."""
    h2 = h * h
    for b in range(0, 3 * padded, 8):
        store(work.scaled, b, load(work.stencil, b) * h2)
        store(work.scaled, 3 * padded + b, load(work.stencil, 3 * padded + b) * h)
    zero = splat(0.0)
    forced = founded or (kinds != LINKS_NONE and busy > 0)
    small_before = False
    k = 0
    while True:
        if forced:
            for b in range(0, padded, 8):
                store(work.force, b, zero)
            if kinds != LINKS_NONE and busy > 0:
                add_forces(links, state, work, k, padded, h, kinds)
            if founded:
                _foundations(slots, feet, work, k, padded, h)
        row = k * padded
        reciprocal = work.reciprocal[k + 1]
        pull = h2 * ground if k == 0 else h2 * h * ground_slope
        w_left = zero
        u_left = zero
        w = load(work.W, row)
        u = load(work.U, row)
        for b in range(0, padded, 8):
            more = b + 8 < padded
            w_right = load(work.W, row + b + 8) if more else zero
            u_right = load(work.U, row + b + 8) if more else zero
            total = load(work.scaled, b) * u
            total = total + load(work.scaled, padded + b) * from_left(u_left, u)
            total = total + load(work.scaled, 2 * padded + b) * from_right(u, u_right)
            if forced:
                total = total + load(slots.inverse_mass, b) * load(work.force, b)
            if k < 2:
                total = total - load(slots.real, b) * pull
                if k == 0:
                    total = total + load(work.push, b) * h2
            total = total + load(work.scaled, 3 * padded + b) * w
            total = total + load(work.scaled, 4 * padded + b) * from_left(w_left, w)
            total = total + load(work.scaled, 5 * padded + b) * from_right(w, w_right)
            store(work.W, row + padded + b, total * reciprocal)
            store(work.U, row + padded + b, w * reciprocal)
            w_left = w
            u_left = u
            w = w_right
            u = u_right
        if k >= guess - 1:
            large = False
            limit = tolerance * h2 * reciprocal
            for b in range(0, padded, 8):
                allowed = maximum(load(work.scale, b), splat(quiet)) * limit
                large = large or greater(magnitude(load(work.W, row + padded + b)), allowed) != 0
            if founded:
                for f in range(feet.number):  # a turning base, measured where it moves most: at the top floor
                    top = feet.stop[f] - 1
                    turning = abs(work.phi_W[(k + 1) * feet.number + f]) * slots.elevation[top]
                    large = large or turning > limit * max(work.scale[top], quiet)
            if not large and small_before:
                return k + 1, True
            small_before = not large
        k += 1
        if k == most:
            return k, False


@njit(**INLINE)
def renew_scale(work, ends, padded, h):
    """The largest acceleration of late: a blow is forgotten at a tenth a step, so that what follows it is not
    sloppy."""
    rate = 1.0 / (h * h)
    for b in range(0, padded, 8):
        now = maximum(magnitude(load(ends.acceleration0, b)), magnitude(load(ends.acceleration, b))) * rate
        store(work.scale, b, maximum(load(work.scale, b) * FORGET, now))


@njit(**INLINE)
def shrink(slots, feet, work, padded, h, tolerance, quiet, order):
    """The fraction of a step that meets the tolerance at its highest order; rescales nothing."""
    worst = 0.0
    for k in (order - 1, order):
        size = 0.0
        for i in range(padded):
            size = max(size, abs(work.W[k * padded + i]) / max(work.scale[i], quiet))
        for f in range(feet.number):
            top = feet.stop[f] - 1
            turning = abs(work.phi_W[k * feet.number + f]) * slots.elevation[top]
            size = max(size, turning / max(work.scale[top], quiet))
        size *= k / (h * h)
        if size > 0.0:
            worst = max(worst, (size / tolerance) ** (1.0 / (k - 1)))
    return 0.9 / worst if worst > 0.9 else 1.0


@njit(**INLINE)
def rescale(feet, links, work, busy, padded, order, ratio, founded, kinds):
    """Coefficients for a step `ratio` times as long: the motion is the same, only s is measured anew."""
    power = 1.0
    feet_count = feet.number
    count = links.size
    for k in range(order + 1):
        for b in range(k * padded, (k + 1) * padded, 8):
            store(work.U, b, load(work.U, b) * power)
            store(work.W, b, load(work.W, b) * (power * ratio))
        if founded:
            for i in range(k * padded, (k + 1) * padded):
                work.tilt[i] *= power
            for f in range(k * feet_count, (k + 1) * feet_count):
                work.phi_W[f] *= power * ratio
                work.phi_D[f] *= power
        if kinds != LINKS_NONE and busy > 0:
            for b in range(k * count, (k + 1) * count, 8):
                store(work.V, b, load(work.V, b) * power)
                store(work.F, b, load(work.F, b) * (power * ratio * ratio))
                store(work.rates, b, load(work.rates, b) * (power * ratio))
        power *= ratio
