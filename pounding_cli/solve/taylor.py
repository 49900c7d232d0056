"""The default method: the event-located Taylor integrator of `kernels.taylor`."""

from __future__ import annotations

import functools
import math
import threading
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from pounding_cli.kernels.history import History
from pounding_cli.kernels.layout import Points, Row, Springs
from pounding_cli.kernels.ledger import MAX_POINTS
from pounding_cli.model.scene import Scene
from pounding_cli.solve.arrays import LANES, Arrays, aligned, drift_of
from pounding_cli.solve.ground import segments
from pounding_cli.solve.method import Integrator
from pounding_cli.solve.tangent import is_known

SAFETY = 0.5
"""Local tolerance (relative, of acceleration) over the accuracy asked. Ordinary scenes come out hundreds of times
better than asked; this is for the hard ones, where thousands of contacts hand errors on (tests/hard)."""


LEAST_SCALE = 1e-3
"""Part of the ground's peak below which accelerations are not resolved: isolated floors may feel as little."""


COARSEST_TOLERANCE = 1e-4
"""No series is cut shorter than this, whatever is asked: events would be found where there are none, to save little."""


_NUMBERS, _PLACES = np.zeros((1, 1)), np.zeros((1, 1), np.int64)
NO_HISTORY = History(
    segments=0, lengths=_NUMBERS[0], outputs=_PLACES[0], u=_NUMBERS, v=_NUMBERS, storey_branch=_PLACES,
    storey_memory=_NUMBERS, link_branch=_PLACES, link_memory=_NUMBERS, work=_NUMBERS,
)  # fmt: skip
"""Of a run that keeps none."""


@functools.cache
def gauss_rules(most: int) -> tuple[np.ndarray, np.ndarray]:
    """Gauss-Legendre nodes and weights on [0, 1] of all rules up to `most` points: rule n in row n, zeros beyond it."""
    nodes, weights = np.zeros((most + 1, most)), np.zeros((most + 1, most))
    for n in range(1, most + 1):
        x, w = np.polynomial.legendre.leggauss(n)
        nodes[n, :n], weights[n, :n] = (x + 1) / 2, w / 2
    return nodes, weights


def local_tolerance(accuracy: float) -> float:
    """What a series may leave out, relative to the acceleration [-]."""
    return min(max(accuracy * SAFETY, 1e-16), COARSEST_TOLERANCE)


def max_order(tolerance: float) -> int:
    """Highest order worth computing before the step is cut: near the optimum of Jorba & Zou, -ln(tol) / 2 + 1, and
    above it, because most steps end at a record sample."""
    return min(30, max(10, math.ceil(-0.75 * math.log(tolerance)) + 4))


def least_acceleration_scale(scene: Scene, arrays: Arrays, state) -> float:
    """Acceleration [m/s2] below which nothing is resolved: a part of the ground's peak, or on still ground that of
    the start.

    The start's is the largest spring force per mass, or what would turn its largest velocity within a second.
    """
    if scene.motion.pga > 0:
        return LEAST_SCALE * scene.motion.pga
    pulls = arrays.slots.stiffness * np.abs(drift_of(arrays, state.u)) * arrays.slots.inverse_mass
    return max(float(pulls.max()), float(np.abs(state.v).max()))


def max_events_at_instant(slots: int, links: int) -> int:
    """Events in a row without time going on that are too many."""
    return 20 + 4 * (slots + links)


ALWAYS_ONE_ISLAND = 3
"""Buildings that are always solved as one island: to solve fewer at a time saves less than steps of their own cost."""

MOST_PADDING = 2
"""Places that buildings may take to stand alone, over those that they take one behind the other [-]: where buildings of
one or two storeys would leave most of every eight places empty, the row stays one island."""


def places_of(arrays: Arrays) -> tuple[Row, Points, Springs]:
    """The buildings by place (`layout.Row`), and points and springs likewise."""
    count = arrays.links.number
    left, right = arrays.links.left[:count].tolist(), arrays.links.right[:count].tolist()
    row = _row(arrays.begins, arrays.left_of_links, tuple(left), tuple(right))
    points, springs = arrays.points, arrays.springs
    if points.number:
        table = points.shears
        shears = table._replace(
            slot=row.slot_places[table.slot], storey=row.slot_places[table.storey], link=row.link_places[table.link]
        )
        points = points._replace(
            slot=row.slot_places[points.slot], freedom=row.slot_places[points.freedom], shears=shears
        )
    if springs.number:
        springs = springs._replace(freedom=row.slot_places[springs.freedom])
    return row, points, springs


def solved_in_islands(arrays: Arrays) -> bool:
    """Whether buildings that do not touch take steps of their own."""
    several = len(arrays.floors) > ALWAYS_ONE_ISLAND and not arrays.collapses
    return several and _allows_islands(places_of(arrays)[0])


def _allows_islands(row: Row) -> bool:
    """Whether every building begins at a multiple of eight places."""
    return row.number > ALWAYS_ONE_ISLAND and bool(np.all(row.first_slot % LANES == 0))


@functools.lru_cache(maxsize=256)
def _row(begins: tuple[int, ...], at: tuple[int, ...], left: tuple[int, ...], right: tuple[int, ...]) -> Row:
    """Buildings that begin at the slots `begins` (and where the last ends), links between neighbours from the building
    `at` to the next, from slot `left` to slot `right`."""
    start, where = np.array(begins), np.array(at, np.int64)
    storeys = np.diff(start)
    closely = -(-start[-1] // LANES) * LANES
    first = np.concatenate(([0], np.cumsum(_padded(storeys))))
    alone = first[-1] <= MOST_PADDING * closely if storeys.size > ALWAYS_ONE_ISLAND else first[-1] == closely
    if not alone:  # no building is run by itself: as few places as can be
        first = np.append(start[:-1], closely)
    slot_places = np.concatenate([first[b] + np.arange(n) for b, n in enumerate(storeys)])
    on, other = np.array(left, np.int64) - start[where], np.array(right, np.int64) - start[where + 1]
    count = np.bincount(where, minlength=storeys.size)
    if alone and np.array_equal(on, other) and len({*zip(at, left, strict=True)}) == len(at):
        width = np.where(count[:-1] > 0, _padded(np.minimum(storeys[:-1], storeys[1:])), 0)
        first_link = np.concatenate(([0], np.cumsum(width)))
        link_places, links_per_side = first_link[where] + on, 0
    else:
        width = _padded(count[:-1]) if alone else count[:-1]
        first_link = np.concatenate(([0], np.cumsum(width)))
        order = np.argsort(where, kind="stable")
        link_places = np.empty(where.size, np.int64)
        link_places[order] = first_link[where[order]] + np.concatenate([np.arange(n) for n in count])
        links_per_side = max((int(np.bincount(ends).max()) for ends in (left, right) if ends), default=0)
    first_link[-1] = _padded(first_link[-1])
    whole = (np.ascontiguousarray(table, np.int64) for table in (first, first_link, slot_places, link_places))
    return Row(storeys.size, slot_places.size, len(at), links_per_side, *whole)


def _padded(count):
    """The next multiple of eight."""
    return -(-count // LANES) * LANES


def carries_tangent(arrays: Arrays) -> bool:
    """Whether a run that is asked for its tangent carries it: it is known, and the row is one island."""
    return is_known(arrays) and not solved_in_islands(arrays)


def takes_programs(arrays: Arrays) -> bool:
    """Whether the scene needs the larger of the two kernels (`kernels.taylor.build`)."""
    return arrays.written or arrays.flows or bool(arrays.columns)


class _Laid(NamedTuple):
    """The kernel for scenes with the same arrays, what it is given of them, and the scratch that it needs: doubles and
    integers."""

    kernel: Callable[..., tuple[int, int, int, int, float]]
    row: Row
    points: Points
    springs: Springs
    doubles: int
    integers: int
    inelastic: bool
    use_islands: bool
    events_at_instant: int


@functools.lru_cache(maxsize=64)  # the same for every motion
def _laid_out(arrays: Arrays, all_effects: bool, carried: bool) -> _Laid:
    from pounding_cli.kernels import scratch, taylor

    row, points, springs = places_of(arrays)
    registers = arrays.links.registers if arrays.flows or arrays.written else 0
    doubles, integers = scratch.memory_needed(
        row.first_slot[-1], row.first_link[-1], row.links_per_side, row.number, registers, springs.size,
        arrays.flows, carried,
    )  # fmt: skip
    # A collapse ends the run of all buildings at one time, so they are solved together.
    use_islands = not all_effects and not arrays.collapses and _allows_islands(row)
    return _Laid(
        taylor.build(takes_programs(arrays)), row, points, springs, doubles, integers, all_effects or arrays.yields,
        use_islands, max_events_at_instant(arrays.begins[-1], arrays.links.number),
    )  # fmt: skip


def prepare(
    scene: Scene,
    arrays: Arrays,
    state,
    accuracy: float,
    bounds: tuple[int, int],
    all_effects: bool = False,
    booked: bool = True,
    carried: bool = False,
) -> Callable[..., tuple[int, int, int, int, float]]:
    """The kernel for a scene that starts from `state`: a function of (state, peaks, ledger, starts, slopes, dt), the
    last three as in `ground.segments`, and a history to enter (`kernels.history`); see `kernels.taylor.build`. It does
    what the scene needs, or looks for everything there is; energies are `booked`, or left out; the tangent of the
    motion is `carried` along, which `peaks` then tell."""
    laid, tolerance = _laid_out(arrays, all_effects, carried), local_tolerance(accuracy)
    settings: tuple[Any, ...] = (
        laid.inelastic, laid.use_islands, arrays.collapses, booked,
        1.0 / (scene.motion.acceleration.size - 1) if carried else 0.0, tolerance,
        least_acceleration_scale(scene, arrays, state), max_order(tolerance), *bounds, laid.events_at_instant,
    )  # fmt: skip

    def run(state, peaks, ledger, starts: np.ndarray, slopes: np.ndarray, dt: float, history: History = NO_HISTORY):
        return laid.kernel(
            arrays.slots, laid.points, laid.springs, arrays.links, laid.row, state, peaks, ledger, history,
            *gauss_rules(MAX_POINTS), *_scratch(laid.doubles, laid.integers), starts, slopes, dt, *settings,
        )  # fmt: skip

    return run


_last = threading.local()
"""The scratch of every thread's last run."""


def _scratch(doubles: int, integers: int) -> tuple[np.ndarray, np.ndarray]:
    """Zeros for a run: those of the last run in this thread where they are as many."""
    kept: tuple[np.ndarray, np.ndarray] | None = getattr(_last, "scratch", None)
    if kept is None or (kept[0].size, kept[1].size) != (doubles, integers):
        kept = _last.scratch = aligned(doubles), np.zeros(integers, np.int64)
    for numbers in kept:
        numbers.fill(0)
    return kept


def integrate(
    scene: Scene, arrays: Arrays, state, peaks, ledger, accuracy: float, bounds: tuple[int, int], **how: bool
) -> tuple[int, int, int, int, float]:
    """Run the kernel over the whole motion and its tail; `how` as in `prepare`."""
    return prepare(scene, arrays, state, accuracy, bounds, **how)(state, peaks, ledger, *segments(scene))


TAYLOR = Integrator(integrate)

ALL_EFFECTS = Integrator(functools.partial(integrate, all_effects=True))
"""Looks for every effect, whether or not the scene calls for it."""

WITH_TANGENT = Integrator(functools.partial(integrate, carried=True))
"""Carries the tangent along, a fifth more time (`solve.tangent`)."""

WITHOUT_LEDGER = Integrator(functools.partial(integrate, booked=False), keeps_ledger=False)
"""Leaves the energies out, a sixth of the time: for runs that others are judged by."""
