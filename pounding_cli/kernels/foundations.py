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
from pounding_cli.kernels.simd import further, splat, stand_alone, store

_DOUBLES = (
    "inertia", "stiffness", "dashpot", "alpha", "phi", "phi_v", "rocking", "spent", "W", "D", "phi_end", "turn_end"
)  # fmt: skip
FEET = Frame("feet", dict.fromkeys(("first", "stop", "base"), INTEGERS) | dict.fromkeys(_DOUBLES, DOUBLES))
"""Per foundation: the fields of `layout.Feet`; its angle and rate in `layout.State`; the largest angle; energy lost
[J]; by order, coefficients of rate W [rad/s] and angle D [rad]; both at the step's end."""

_fill = filler(FEET)


@njit(**PART)
def footing_of(place, feet, state, peaks, ledger, number, rows, room):
    """A frame of feet at `place`, its series in `room`."""
    return _fill(place, (
        feet.first, feet.stop, feet.base, feet.inertia, feet.stiffness, feet.dashpot, feet.alpha, state.phi,
        state.phi_v, peaks.rocking, ledger.feet, room, further(room, rows * number), further(room, 2 * rows * number),
        further(room, (2 * rows + 1) * number),
    ))  # fmt: skip


@njit(**CALLED)
def start_feet(run, feet):
    """Order 0 of what foundations turn."""
    stand_alone()
    for f in range(run.feet):
        feet.D[f] = feet.phi[f]
        feet.W[f] = feet.phi_v[f]
        for i in range(feet.first[f], feet.stop[f]):
            run.tilt[i] = run.slots[of(i, c.RISE)] * feet.phi[f]
            run.tilt[run.padded + i] = run.slots[of(i, c.RISE)] * feet.phi_v[f]


@njit(**CALLED)
def expand_feet(run, feet, k):
    """Order k of what foundations add (`foundation_forces`), and order k + 1 of the rocking angle and its rate."""
    stand_alone()
    h = run.clock[H]
    after = h * run.reciprocal[k + 1]
    row = k * run.padded
    foundation_forces(run, feet, k, run.W, row - run.padded, h * run.reciprocal[k] if k > 0 else 1.0)
    for f in range(run.feet):
        feet.D[(k + 1) * run.feet + f] = feet.W[k * run.feet + f] * after
        turning_after = feet.W[(k + 1) * run.feet + f] * after
        feet.W[(k + 1) * run.feet + f] = turning_after
        for i in range(feet.first[f], feet.stop[f]):
            run.tilt[row + 2 * run.padded + i] = run.slots[of(i, c.RISE)] * turning_after


@njit(**CALLED)
def foundation_forces(run, feet, k, rows, above, before):
    """Order k of what foundations add, into FORCE: rocking's share of the storey shears, the mass-proportional damping
    of the structural motion; and of the angular acceleration, in the place of the next rate.

    Order k of the displacements is `before` times `rows`, from `above` on.
    """
    stand_alone()
    count = run.feet
    slots = run.slots
    row = k * run.padded
    for b in range(0, run.padded, 8):
        store(slots, at(b, c.FORCE), splat(0.0))
    for f in range(count):
        angle = feet.D[k * count + f]
        turning = feet.W[k * count + f]
        base = feet.base[f]
        sway = run.W[row + base] if base >= 0 else 0.0
        moment = -feet.stiffness[f] * angle - feet.dashpot[f] * turning
        for i in range(feet.first[f], feet.stop[f]):
            rise = slots[of(i, c.RISE)]
            tangent = slots[of(i, c.TANGENT)]
            dashpot = slots[of(i, c.DASHPOT)]
            turned = rise * (tangent * angle + dashpot * turning)
            slots[of(i, c.FORCE)] += turned
            drift = before * rows[above + i]
            rate = run.W[row + i]
            if slots[of(i, c.COUPLE)] != 0.0:
                slots[of(i - 1, c.FORCE)] -= turned
                drift -= before * rows[above + i - 1]
                rate -= run.W[row + i - 1]
            shear = tangent * drift + dashpot * rate - turned
            if k == 0:
                shear += slots[of(i, c.OFFSET)]
            arm = slots[of(i, c.ELEVATION)]
            drag = feet.alpha[f] * slots[of(i, c.MASS)] * (run.W[row + i] - sway - arm * turning)
            slots[of(i, c.FORCE)] -= drag
            if base >= 0:
                slots[of(base, c.FORCE)] += drag  # fault: base-drag
            moment += drag * arm + shear * rise  # fault: base-moment
        feet.W[(k + 1) * count + f] = moment / feet.inertia[f]


@njit(**PART)
def top_of(run, feet, k, f):
    """(top slot, coefficient k of its rate by rocking): a turning base is measured where it moves most."""
    top = feet.stop[f] - 1
    return top, abs(feet.W[k * run.feet + f]) * run.slots[of(top, c.ELEVATION)]


@njit(**CALLED)
def feet_exceed(run, feet, k):
    """Whether the last term of some rocking angle is more than may be left out."""
    stand_alone()
    for f in range(run.feet):
        top, turning = top_of(run, feet, k + 1, f)
        if turning > run.slots[of(top, c.ALLOWED)] * run.clock[H] * run.reciprocal[k + 1]:
            return True
    return False


@njit(**CALLED)
def rescale_feet(run, feet, order, ratio):
    """As `recurrence.rescale`."""
    stand_alone()
    power = 1.0
    for k in range(order + 1):
        for f in range(k * run.feet, (k + 1) * run.feet):
            feet.W[f] *= power
            feet.D[f] *= power
        for i in range((k + 1) * run.padded, (k + 2) * run.padded):
            run.tilt[i] *= power
        power *= ratio


@njit(**CALLED)
def end_feet(run, feet, s):
    """Angles and rates at s, and the drifts at both ends of the step without what they lend them."""
    stand_alone()
    slots = run.slots
    for f in range(run.feet):
        order = run.tally[ORDER]
        phi = 0.0
        turn = 0.0
        for k in range(order, -1, -1):
            phi = phi * s + feet.D[k * run.feet + f]
            turn = turn * s + feet.W[k * run.feet + f]
        feet.phi_end[f] = phi
        feet.turn_end[f] = turn
        for i in range(feet.first[f], feet.stop[f]):
            rise = slots[of(i, c.RISE)]
            slots[of(i, c.DRIFT0)] -= run.tilt[i]
            slots[of(i, c.RATE0)] -= run.tilt[run.padded + i]
            slots[of(i, c.DRIFT)] -= rise * phi
            slots[of(i, c.RATE)] -= rise * turn


@njit(**CALLED)
def charge_feet(run, feet, points, first_share):
    """Energy lost in the drag of founded buildings and in rocking dashpots."""
    stand_alone()
    padded = run.padded
    slots = run.slots
    order = run.tally[ORDER]
    for g in range(0, 8 * points, 8):
        s = run.rule[g]
        weight = run.rule[first_share + g]
        for f in range(run.feet):
            turning = 0.0
            sway = 0.0
            base = feet.base[f]
            for k in range(order, -1, -1):
                turning = turning * s + feet.W[k * run.feet + f]
                if base >= 0:
                    sway = sway * s + run.W[k * padded + base]
            power = feet.dashpot[f] * turning * turning
            for i in range(feet.first[f], feet.stop[f]):
                below = 0.0
                here = 0.0
                for k in range(order, -1, -1):
                    here = here * s + run.W[k * padded + i]
                    if slots[of(i, c.COUPLE)] != 0.0:
                        below = below * s + run.W[k * padded + i - 1]
                slip = here - sway - slots[of(i, c.ELEVATION)] * turning
                power += feet.alpha[f] * slots[of(i, c.MASS)] * slip * slip
                # The storey's dashpot was charged without rocking; put that right.
                lean = slots[of(i, c.RISE)] * turning
                bare = here - below
                power += slots[of(i, c.DASHPOT)] * ((bare - lean) * (bare - lean) - bare * bare)
            feet.spent[f] += power * weight


@njit(**CALLED)
def rocking_peaks(run, feet):
    """Largest rocking angles."""
    stand_alone()
    count = run.feet
    order = run.tally[ORDER]
    end = run.clock[END]
    for f in range(count):
        for k in range(order + 1):
            run.scratch[k] = feet.D[k * count + f]
        best = max(feet.rocking[f], abs(run.scratch[0]), abs(value(run.scratch, order, end)))
        feet.rocking[f] = highest(run.scratch, order, end, best, True)


@njit(**CALLED)
def move_feet(run, feet):
    """The state at the step's end."""
    stand_alone()
    for f in range(run.feet):
        feet.phi[f] = feet.phi_end[f]
        feet.phi_v[f] = feet.turn_end[f]
