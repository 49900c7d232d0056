"""What foundations add to a step: rocking angles, and the drag of the structural motion (eq. 2) relative to them.

Scenes with foundations run alone. Foundations are few, so all is done one by one."""

from __future__ import annotations

from numba import njit

from pounding_cli.kernels import cells as c
from pounding_cli.kernels.cells import at, of
from pounding_cli.kernels.clock import END, ORDER, H
from pounding_cli.kernels.frame import DOUBLES, INTEGERS, Frame, filler
from pounding_cli.kernels.layout import CALLED, PART
from pounding_cli.kernels.polynomial import highest, value
from pounding_cli.kernels.simd import further, no_inline, splat, store

_DOUBLES = (
    "inertia", "stiffness", "dashpot", "alpha", "phi", "phi_v", "rocking", "energy_lost", "W", "D", "phi_end",
    "phi_v_end",
)  # fmt: skip
FOUNDATIONS = Frame(
    "foundations", dict.fromkeys(("first", "stop", "base"), INTEGERS) | dict.fromkeys(_DOUBLES, DOUBLES)
)
"""Per foundation: the fields of `layout.Foundations`; its angle and rate in `layout.State`; the largest angle; energy
lost [J]; by order, coefficients of rate W [rad/s] and angle D [rad]; both at the step's end."""

_fill = filler(FOUNDATIONS)


@njit(**PART)
def foundations_frame(place, foundations, state, peaks, ledger, number, rows, memory):
    """The frame of the foundations at `place`, their series in `memory`."""
    return _fill(place, (
        foundations.first, foundations.stop, foundations.base, foundations.inertia, foundations.stiffness,
        foundations.dashpot, foundations.alpha, state.phi, state.phi_v, peaks.rocking, ledger.foundations, memory,
        further(memory, rows * number), further(memory, 2 * rows * number),
        further(memory, (2 * rows + 1) * number),
    ))  # fmt: skip


@njit(**CALLED)
def start_foundations(run, foundations):
    """Order 0 of the rocking angles and of the drifts they cause."""
    no_inline()
    for f in range(run.foundations):
        foundations.D[f] = foundations.phi[f]
        foundations.W[f] = foundations.phi_v[f]
        for i in range(foundations.first[f], foundations.stop[f]):
            run.rocking_drift[i] = run.slots[of(i, c.RISE)] * foundations.phi[f]
            run.rocking_drift[run.padded + i] = run.slots[of(i, c.RISE)] * foundations.phi_v[f]


@njit(**CALLED)
def expand_foundations(run, foundations, k):
    """Order k of what foundations add (`foundation_forces`), and order k + 1 of the rocking angle and its rate."""
    no_inline()
    h = run.clock[H]
    after = h * run.reciprocal[k + 1]
    row = k * run.padded
    foundation_forces(run, foundations, k, run.W, row - run.padded, h * run.reciprocal[k] if k > 0 else 1.0)
    for f in range(run.foundations):
        foundations.D[(k + 1) * run.foundations + f] = foundations.W[k * run.foundations + f] * after
        turning_after = foundations.W[(k + 1) * run.foundations + f] * after
        foundations.W[(k + 1) * run.foundations + f] = turning_after
        for i in range(foundations.first[f], foundations.stop[f]):
            run.rocking_drift[row + 2 * run.padded + i] = run.slots[of(i, c.RISE)] * turning_after


@njit(**CALLED)
def foundation_forces(run, foundations, k, rows, above, before):
    """Order k of what foundations add, into FORCE: rocking's share of the storey shears, the mass-proportional damping
    of the structural motion; and of the angular acceleration, in the place of the next rate.

    Order k of the displacements is `before` times `rows`, from `above` on.
    """
    no_inline()
    count = run.foundations
    slots = run.slots
    row = k * run.padded
    for b in range(0, run.padded, 8):
        store(slots, at(b, c.FOUNDATION_FORCE), splat(0.0))
    for f in range(count):
        angle = foundations.D[k * count + f]
        turning = foundations.W[k * count + f]
        base = foundations.base[f]
        sway = run.W[row + base] if base >= 0 else 0.0
        moment = -foundations.stiffness[f] * angle - foundations.dashpot[f] * turning
        for i in range(foundations.first[f], foundations.stop[f]):
            rise = slots[of(i, c.RISE)]
            tangent = slots[of(i, c.TANGENT)]
            dashpot = slots[of(i, c.DASHPOT)]
            turned = rise * (tangent * angle + dashpot * turning)
            slots[of(i, c.FOUNDATION_FORCE)] += turned
            drift = before * rows[above + i]
            rate = run.W[row + i]
            if slots[of(i, c.COUPLE)] != 0.0:
                slots[of(i - 1, c.FOUNDATION_FORCE)] -= turned
                drift -= before * rows[above + i - 1]
                rate -= run.W[row + i - 1]
            shear = tangent * drift + dashpot * rate - turned
            if k == 0:
                shear += slots[of(i, c.OFFSET)]
            arm = slots[of(i, c.ELEVATION)]
            drag = foundations.alpha[f] * slots[of(i, c.MASS)] * (run.W[row + i] - sway - arm * turning)
            slots[of(i, c.FOUNDATION_FORCE)] -= drag
            if base >= 0:
                slots[of(base, c.FOUNDATION_FORCE)] += drag  # fault: base-drag
            moment += drag * arm + shear * rise  # fault: base-moment
        foundations.W[(k + 1) * count + f] = moment / foundations.inertia[f]


@njit(**PART)
def top_of(run, foundations, k, f):
    """(top slot, coefficient k of its rate by rocking): a turning base is measured where it moves most."""
    top = foundations.stop[f] - 1
    return top, abs(foundations.W[k * run.foundations + f]) * run.slots[of(top, c.ELEVATION)]


@njit(**CALLED)
def foundations_exceed(run, foundations, k):
    """Whether the last term of some rocking angle is more than may be left out."""
    no_inline()
    for f in range(run.foundations):
        top, turning = top_of(run, foundations, k + 1, f)
        if turning > run.slots[of(top, c.TERM_TOLERANCE)] * run.clock[H] * run.reciprocal[k + 1]:
            return True
    return False


@njit(**CALLED)
def rescale_foundations(run, foundations, order, ratio):
    """As `recurrence.rescale`."""
    no_inline()
    power = 1.0
    for k in range(order + 1):
        for f in range(k * run.foundations, (k + 1) * run.foundations):
            foundations.W[f] *= power
            foundations.D[f] *= power
        for i in range((k + 1) * run.padded, (k + 2) * run.padded):
            run.rocking_drift[i] *= power
        power *= ratio


@njit(**CALLED)
def end_foundations(run, foundations, s):
    """Angles and rates at s; the drifts at both ends of the step without the part that rocking causes."""
    no_inline()
    slots = run.slots
    for f in range(run.foundations):
        order = run.tally[ORDER]
        phi = 0.0
        phi_a = 0.0
        for k in range(order, -1, -1):
            phi = phi * s + foundations.D[k * run.foundations + f]
            phi_a = phi_a * s + foundations.W[k * run.foundations + f]
        foundations.phi_end[f] = phi
        foundations.phi_v_end[f] = phi_a
        for i in range(foundations.first[f], foundations.stop[f]):
            rise = slots[of(i, c.RISE)]
            slots[of(i, c.DRIFT0)] -= run.rocking_drift[i]
            slots[of(i, c.DRIFT_RATE0)] -= run.rocking_drift[run.padded + i]
            slots[of(i, c.DRIFT1)] -= rise * phi
            slots[of(i, c.DRIFT_RATE1)] -= rise * phi_a


@njit(**CALLED)
def account_foundations(run, foundations, points, first_share):
    """Energy lost in the drag of founded buildings and in rocking dashpots."""
    no_inline()
    padded = run.padded
    slots = run.slots
    order = run.tally[ORDER]
    for g in range(0, 8 * points, 8):
        s = run.rule[g]
        weight = run.rule[first_share + g]
        for f in range(run.foundations):
            turning = 0.0
            sway = 0.0
            base = foundations.base[f]
            for k in range(order, -1, -1):
                turning = turning * s + foundations.W[k * run.foundations + f]
                if base >= 0:
                    sway = sway * s + run.W[k * padded + base]
            power = foundations.dashpot[f] * turning * turning
            for i in range(foundations.first[f], foundations.stop[f]):
                below = 0.0
                here = 0.0
                for k in range(order, -1, -1):
                    here = here * s + run.W[k * padded + i]
                    if slots[of(i, c.COUPLE)] != 0.0:
                        below = below * s + run.W[k * padded + i - 1]
                slip = here - sway - slots[of(i, c.ELEVATION)] * turning
                power += foundations.alpha[f] * slots[of(i, c.MASS)] * slip * slip
                # The storey's dashpot was charged without rocking; put that right.
                lean = slots[of(i, c.RISE)] * turning
                bare = here - below
                power += slots[of(i, c.DASHPOT)] * ((bare - lean) * (bare - lean) - bare * bare)
            foundations.energy_lost[f] += power * weight


@njit(**CALLED)
def rocking_peaks(run, foundations):
    """Largest rocking angles."""
    no_inline()
    count = run.foundations
    order = run.tally[ORDER]
    end = run.clock[END]
    for f in range(count):
        for k in range(order + 1):
            run.scratch[k] = foundations.D[k * count + f]
        best = max(foundations.rocking[f], abs(run.scratch[0]), abs(value(run.scratch, order, end)))
        foundations.rocking[f] = highest(run.scratch, order, end, best, True)


@njit(**CALLED)
def advance_foundations(run, foundations):
    """The state at the step's end."""
    no_inline()
    for f in range(run.foundations):
        foundations.phi[f] = foundations.phi_end[f]
        foundations.phi_v[f] = foundations.phi_v_end[f]
