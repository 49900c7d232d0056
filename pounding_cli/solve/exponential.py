"""Exact stepping of linear scenes by the matrix exponential, with peaks between samples to a stated accuracy.

Between two record samples the ground is a straight line, so z = (q, q', a_g, a_g') obeys z' = A z and z(t + dt) =
exp(A dt) z(t): no error but rounding. What is tracked (drifts, accelerations, displacements, link forces) is C z. It is
looked at on a grid of `parts` places a sample, all at once as one matrix product; wherever it comes near its largest
value, its power series C exp(A s) z is searched for the peak."""

from __future__ import annotations

import math
from collections import OrderedDict
from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm

from pounding_cli.kernels import layout
from pounding_cli.model.scene import Scene
from pounding_cli.solve.arrays import Arrays
from pounding_cli.solve.ground import segments
from pounding_cli.solve.linear import matrices, with_links
from pounding_cli.solve.method import Method, not_linear, real_slots

RADIANS = 1.0
"""Largest phase of the highest mode between two places of the grid [rad]."""


SERIAL_PRODUCT = 250_000
"""Multiplications in one matrix product: above 2^18 OpenBLAS wakes other threads, which costs more than such a run."""


@dataclass(frozen=True, eq=False)
class Propagator:
    """Exact motion of a linear scene over one record sample of length dt [s].

    unknowns : N, so that z has 2 N + 2 entries
    outer : exp(A dt) transposed, its columns for (q, q'), shape (2 N + 2, 2 N)
    places : exp(A s) at every place s of the grid within a sample, shape (parts, 2 N + 2, 2 N + 2)
    grid : what is tracked at every place from z at the sample's start, shape (2 N + 2, parts M)
    powers : C (A step)^j / j! with the grid's step, shape (M, orders, 2 N + 2)
    summing : integral of q over time from the change of (q, q') and the integral of a_g, shape (N, 2 N + 1)
    """

    unknowns: int
    outer: np.ndarray
    places: np.ndarray
    grid: np.ndarray
    powers: np.ndarray
    summing: np.ndarray


def propagator(arrays: Arrays, dt: float, orders: int) -> Propagator:
    """Build the propagator of a scene; A is scaled and squared by scipy's `expm` (Al-Mohy & Higham 2009)."""
    system = matrices(arrays)
    damping, stiffness = with_links(arrays, system)
    count = system.mass.size
    a = np.zeros((2 * count + 2, 2 * count + 2))
    a[:count, count : 2 * count] = np.eye(count)
    a[count : 2 * count, :count] = -stiffness / system.mass[:, None]
    a[count : 2 * count, count : 2 * count] = -damping / system.mass[:, None]
    a[count : 2 * count, -2] = -system.loaded / system.mass
    a[-2, -1] = 1.0

    n = real_slots(arrays)
    nothing = np.zeros((n, count))
    acceleration = a[count : count + n].copy()
    acceleration[:, -2] += 1.0  # total: the ground's is added
    slope = arrays.links.stiffness[: arrays.links.number, None]
    dashpot = arrays.links.dashpot[: arrays.links.number, None]
    moving = np.vstack((
        np.hstack((system.drift, nothing)),
        np.hstack((np.eye(n, count), nothing)),
        np.eye(arrays.feet.number, 2 * count, n),
        np.hstack((system.closing, 0 * system.closing)),
        np.hstack((slope * system.closing, dashpot * system.closing)),
    ))  # fmt: skip
    rows = np.vstack((np.hstack((moving, np.zeros((len(moving), 2)))), acceleration))

    fastest = float(np.abs(np.linalg.eigvals(a[: 2 * count, : 2 * count])).max())
    parts = max(1, math.ceil(fastest * dt / RADIANS))
    step = expm(a * (dt / parts))
    places = [np.eye(2 * count + 2)]
    for _ in range(parts - 1):
        places.append(places[-1] @ step)
    powers = [rows]
    for j in range(1, orders):
        powers.append(powers[-1] @ a * (dt / parts / j))
    # M dq' + C dq + K (integral of q) = -loaded (integral of a_g)
    balance = np.hstack((-damping, -np.diag(system.mass), -system.loaded[:, None]))
    rests = np.diag(stiffness) == 0  # a foundation that does not rock
    summing = np.linalg.solve(stiffness + np.diag(rests.astype(float)), balance)
    return Propagator(
        count,
        expm(a * dt)[: 2 * count].T.copy(),
        np.array(places),
        np.vstack([rows @ place for place in places]).T.copy(),
        np.array(powers).transpose(1, 0, 2).copy(),
        summing,
    )


def orders_for(accuracy: float) -> int:
    """Terms of the power series over RADIANS that leave less than `accuracy` / 10 [-]."""
    orders = 3
    while RADIANS**orders / math.factorial(orders) > 0.1 * accuracy and orders < 22:
        orders += 1
    return orders + 1


_propagators: OrderedDict[tuple, Propagator] = OrderedDict()
MOST_KEPT = 16
"""Propagators kept for the next motion of the same scene."""


def _kept(scene: Scene, arrays: Arrays, dt: float, orders: int) -> Propagator:
    key = (tuple(building.digest for building in scene.buildings), scene.links, dt, orders)
    if key not in _propagators:
        _propagators[key] = propagator(arrays, dt, orders)
    _propagators.move_to_end(key)
    while len(_propagators) > MOST_KEPT:
        _propagators.popitem(last=False)
    return _propagators[key]


def integrate(scene: Scene, arrays: Arrays, state, peaks, ledger, accuracy: float, bounds):
    """Run a linear scene; the state is exact, peaks between samples are found to `accuracy` [-]."""
    from pounding_cli.kernels import exponential as kernels

    march, refine = kernels.build()
    starts, slopes, dt = segments(scene)
    found = _kept(scene, arrays, dt, orders_for(accuracy))
    n, feet, links, count = real_slots(arrays), arrays.feet.number, arrays.links.number, found.unknowns
    z = np.zeros((starts.size + 1, 2 * count + 2))
    z[:-1, -2], z[:-1, -1] = starts, slopes
    z[-1, -2] = starts[-1] + slopes[-1] * dt
    z[0, : 2 * count] = np.concatenate((state.u[:n], state.phi, state.v[:n], state.phi_v))
    march(found.outer, z)

    tracked = found.powers.shape[0]
    values = np.empty((starts.size * len(found.places) + 1, tracked))
    by_sample = values[:-1].reshape(starts.size, -1)
    rows = max(1, SERIAL_PRODUCT // found.grid.size)
    for begin in range(0, starts.size, rows):
        piece = slice(begin, min(begin + rows, starts.size))
        np.matmul(z[piece], found.grid, out=by_sample[piece])
    values[-1] = found.powers[:, 0] @ z[-1]
    highest, lowest = refine(values, z, found.places, found.powers)

    largest = np.maximum(highest, -lowest)
    ends = np.cumsum([n, n, feet, links, links])
    peaks.drift[:n], _, peaks.rocking[:], _, peaks.force[:links], peaks.acceleration[:n] = np.split(largest, ends)
    peaks.shear[:n] = arrays.slots.stiffness[:n] * peaks.drift[:n]
    peaks.displacement_max[:n], peaks.displacement_min[:n] = highest[n : 2 * n], lowest[n : 2 * n]
    peaks.closing[:links] = highest[ends[2] : ends[3]]
    peaks.contact_time[:links] = starts.size * dt

    change = z[-1, : 2 * count] - z[0, : 2 * count]
    shaken = float(np.sum(starts + 0.5 * dt * slopes)) * dt
    travel = found.summing @ np.append(change, shaken)
    for e in range(links):
        left, right = arrays.links.left[e], arrays.links.right[e]
        elastic = arrays.links.stiffness[e] * (travel[left] - travel[right])
        peaks.impulse[e] = elastic + arrays.links.dashpot[e] * (change[left] - change[right])

    state.u[:n], state.phi[:], state.v[:n], state.phi_v[:] = np.split(z[-1, : 2 * count], [n, count, count + n])
    status = layout.DONE if np.isfinite(z[-1]).all() else layout.NOT_FINITE
    return status, starts.size, 0, 0, starts.size * dt


EXPONENTIAL = Method(
    "exponential",
    "exponential",
    0,
    "accuracy",
    "any time step; linear scenes only",
    "Al-Mohy, A. H. & Higham, N. J. (2009). A new scaling and squaring algorithm for the matrix exponential. SIAM J. "
    "Matrix Anal. Appl. 31(3).",
    integrate,
    refusal=not_linear,
)
