"""Exact stepping of linear scenes (no link that may close but connectors, nothing yields) by the matrix exponential.

Between two record samples the ground is a straight line, so z = (q, q', a_g, a_g') obeys z' = A z and z(t + h) =
exp(A h) z(t): no error but rounding. What is tracked (drifts, displacements, accelerations, link forces) is C z. Every
sample is cut into parts over which no mode turns by more than 1.5 radians: there exp(A h) is its power series, peaks
are found from C exp(A s) z, and energies are quadratic forms of z."""

from __future__ import annotations

import math
import threading
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from pounding_cli.kernels import layout
from pounding_cli.model.scene import Scene
from pounding_cli.solve.arrays import LANES, Arrays, aligned
from pounding_cli.solve.ground import segments
from pounding_cli.solve.law_tables import acting_at_rest, stiffest
from pounding_cli.solve.linear import matrices, with_links
from pounding_cli.solve.method import Integrator, not_linear

RADIANS = 1.5
"""Largest phase of the highest mode over one part of a sample [rad]."""

TERMS = 24
"""Terms of the power series of exp(A h): the next is below 1.5^24 / 24! = 3e-20 of the first."""


@dataclass(frozen=True, eq=False)
class Propagator:
    """Exact motion of a linear scene over one part of a record sample.

    unknowns : N, so that z has 2 N + 2 entries
    parts, length : equal parts of a sample, and how long each is [s]
    step, rows, bends, powers : as `kernels.exponential.build` takes them
    forms : symmetric W, so that z' W z at a sample's start is an energy over the sample [J]: the ground's input, what
        structure and foundations dissipate, and, where there are links, the work done on them; padded
    impulses : integrals over a sample of the link forces from z at its start, shape (links, 2 N + 2)
    """

    unknowns: int
    parts: int
    length: float
    step: np.ndarray
    rows: np.ndarray
    bends: np.ndarray
    powers: np.ndarray
    forms: np.ndarray
    impulses: np.ndarray


def generator(arrays: Arrays) -> np.ndarray:
    """A, shape (2 N + 2, 2 N + 2), with every link closed."""
    system = matrices(arrays)
    damping, stiffness = with_links(arrays, system)
    count = system.mass.size
    a = np.zeros((2 * count + 2, 2 * count + 2))
    a[:count, count : 2 * count] = np.eye(count)
    a[count : 2 * count, :count] = -stiffness / system.mass[:, None]
    a[count : 2 * count, count : 2 * count] = -damping / system.mass[:, None]
    a[count : 2 * count, -2] = -system.loaded / system.mass
    a[-2, -1] = 1.0
    return a


def propagator(arrays: Arrays, dt: float, orders: int) -> Propagator:
    """Build the propagator of a scene for samples of `dt` [s] and peaks from series of so many `orders`."""
    system = matrices(arrays)
    count, total = system.mass.size, 2 * system.mass.size + 2
    a = generator(arrays)
    parts = parts_of(a, dt)
    length = dt / parts

    nothing = np.zeros((count, count))
    acceleration = a[count : 2 * count].copy()
    acceleration[:, -2] += arrays.slots.loaded[system.slots]  # total: the ground's is added
    slope, dashpot = (values[:, None] for values in stiffest(arrays.links))
    moving = np.vstack((
        np.hstack((system.drift, nothing)),
        np.hstack((np.eye(count), nothing)),
        np.hstack((system.closing, 0 * system.closing)),
        np.hstack((slope * system.closing, dashpot * system.closing)),
    ))  # fmt: skip
    forces = np.hstack((slope * system.closing, dashpot * system.closing, np.zeros((len(slope), 2))))
    rows = np.vstack((np.hstack((moving, np.zeros((len(moving), 2)))), acceleration))
    bends = rows @ a @ a * (length**2 / 8)
    powers = [rows]
    for j in range(1, orders):
        powers.append(powers[-1] @ a * (length / j))

    step = series(a * length)
    powers_at = np.zeros((2 + (arrays.links.number > 0), total, total))
    powers_at[0, count:-2, -2] = -system.loaded
    powers_at[1, count:-2, count:-2] = system.damping
    if arrays.links.number:
        powers_at[2, :count, count:-2] = system.closing.T @ (slope * system.closing)
        powers_at[2, count:-2, count:-2] = system.closing.T @ (dashpot * system.closing)
    forms = [over_sample(0.5 * (form + form.T), a * length, step, parts) * length for form in powers_at]
    return Propagator(
        count,
        parts,
        length,
        _padded(step[: 2 * count].T),
        _padded(rows.T),
        _padded(bends.T),
        np.array(powers).transpose(1, 0, 2).copy(),
        _padded(np.vstack(forms)).reshape(len(forms), total, -1),
        forces @ mean_over_sample(a * length, step, parts) * length,
    )


def parts_of(a: np.ndarray, dt: float) -> int:
    """Parts of a sample, a power of two, so that the norm of A over one of them is at most RADIANS.

    Velocities are measured over a frequency that balances both halves of A.
    """
    count = len(a) // 2 - 1
    stiff = np.abs(a[count : 2 * count, :count]).sum(axis=1).max()
    damped = np.abs(a[count : 2 * count, count : 2 * count]).sum(axis=1).max()
    fastest = 0.5 * damped + math.sqrt(0.25 * damped**2 + stiff)  # omega = stiff / omega + damped
    return 1 << max(0, math.ceil(math.log2(max(fastest * dt / RADIANS, 1e-9))))


def series(a: np.ndarray) -> np.ndarray:
    """exp(a) by its power series, for an a whose balanced norm is at most RADIANS."""
    total, term = np.eye(len(a)), np.eye(len(a))
    for j in range(1, TERMS):
        term = term @ a / j
        total += term
    return total


def over_sample(form: np.ndarray, a: np.ndarray, step: np.ndarray, parts: int) -> np.ndarray:
    """W with z' W z the mean over one part of z(s)' form z(s), summed over all `parts`, where z(s) = exp(a s) z.

    dW/ds = a' W + W a gives the series over one part; parts are doubled, with exp(a) = step.
    """
    total, term = form.copy(), form
    for j in range(1, TERMS + 4):
        product = term @ a
        term = (product + product.T) / (j + 1)
        total += term
    while parts > 1:
        total = total + step.T @ total @ step
        step = step @ step
        parts //= 2
    return total


def mean_over_sample(a: np.ndarray, step: np.ndarray, parts: int) -> np.ndarray:
    """The matrix that takes z to the mean of exp(a s) z over one part, summed over all `parts`."""
    total, term = np.eye(len(a)), np.eye(len(a))
    for j in range(1, TERMS):
        term = term @ a / (j + 1)
        total = total + term
    while parts > 1:
        total = total + total @ step
        step = step @ step
        parts //= 2
    return total


def _padded(matrix: np.ndarray) -> np.ndarray:
    """The matrix with zero columns up to a multiple of LANES, from a cache line on."""
    height, width = matrix.shape
    wide = -(-width // LANES) * LANES
    memory = aligned(height * wide).reshape(height, wide)
    memory[:, :width] = matrix
    return memory


def orders_for(accuracy: float) -> int:
    """Terms of the power series over RADIANS that leave less than `accuracy` / 10 [-]."""
    orders = 3
    while RADIANS**orders / math.factorial(orders) > 0.1 * accuracy and orders < 22:
        orders += 1
    return orders + 1


MAX_UNKNOWNS, MAX_PARTS = 5, 8
"""Up to here a propagator, whose cost grows with the square of the unknowns, beats the series (measured:
docs/accuracy.md)."""


def pays(scene: Scene, arrays: Arrays) -> bool:
    """Whether exact steps are cheaper than series for this linear scene."""
    if np.count_nonzero(arrays.slots.mass) > MAX_UNKNOWNS:
        return False
    key = "parts", _key(scene)
    return _remembered(key, lambda: parts_of(generator(arrays), scene.motion.dt)) <= MAX_PARTS


MAX_KEPT = 128
"""Propagators kept for the next motion of the same scene."""

_memory: OrderedDict[tuple, Any] = OrderedDict()
_lock = threading.Lock()


def _key(scene: Scene) -> tuple:
    return tuple(building.digest for building in scene.buildings), scene.links, scene.motion.dt


def _remembered(key: tuple, make: Callable[[], Any]) -> Any:
    """What was made for this key before, or made now."""
    with _lock:
        if key in _memory:
            _memory.move_to_end(key)
            return _memory[key]
    made = make()
    with _lock:
        _memory[key] = made
        while len(_memory) > MAX_KEPT:
            _memory.popitem(last=False)
    return made


def integrate(scene: Scene, arrays: Arrays, state, peaks, ledger, accuracy: float, bounds):
    """Run a linear scene; the state is exact, peaks between samples are found to `accuracy` [-]."""
    from pounding_cli.kernels import exponential as kernels

    starts, slopes, dt = segments(scene)
    orders = orders_for(accuracy)
    found = _remembered((orders, _key(scene)), lambda: propagator(arrays, dt, orders))
    links, count = arrays.links.number, found.unknowns
    here = np.flatnonzero(arrays.slots.mass)
    wide = found.rows.shape[1]
    extremes, sums = aligned(2 * wide).reshape(2, wide), np.zeros((len(found.forms), LANES))
    ends, visited = np.zeros((2, 2 * count)), np.zeros(2 * count + 2)
    ends[0] = np.concatenate((state.u[here], state.v[here]))
    samples = np.empty((len(peaks.samples), count * peaks.watched))
    kernels.build()(
        found.step, found.rows, found.bends, found.powers, found.forms, starts, slopes, found.length,
        found.parts, ends,
        aligned(kernels.memory_needed(found.step.shape[1], wide)), extremes, sums, visited, count, samples,
    )  # fmt: skip

    if peaks.watched:
        peaks.samples[:, here] = samples
    tracked = len(found.powers)
    highest, lowest = extremes[0, :tracked], extremes[1, :tracked]
    largest = np.maximum(highest, -lowest)
    cuts = np.cumsum([count, count, links, links])
    peaks.drift[here], _, _, peaks.force[:links], peaks.acceleration[here] = np.split(largest, cuts)
    peaks.shear[here] = arrays.slots.stiffness[here] * peaks.drift[here]
    peaks.displacement_max[here], peaks.displacement_min[here] = highest[count : cuts[1]], lowest[count : cuts[1]]
    peaks.closing[:links] = highest[cuts[1] : cuts[2]]
    peaks.contact_time[:links] = starts.size * dt * acting_at_rest(arrays.links)[:links]

    peaks.impulse[:links] = found.impulses @ visited
    ledger.input[0], ledger.dashpots[0], *on_links = sums.sum(axis=1)
    ledger.links[:links] = np.divide(on_links, links) if links else 0.0

    state.u[here], state.v[here] = np.split(ends[1], 2)
    status = layout.DONE if np.isfinite(ends[1]).all() else layout.NOT_FINITE
    return status, starts.size * found.parts, 0, 0, starts.size * dt


EXPONENTIAL = Integrator(integrate, refusal=not_linear)
