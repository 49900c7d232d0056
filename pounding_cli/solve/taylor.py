"""The default method: the event-located Taylor integrator of `kernels.taylor`."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable

import numpy as np

from pounding_cli.kernels.layout import Feet, Row
from pounding_cli.kernels.ledger import MOST_POINTS
from pounding_cli.model.effects import effects_of
from pounding_cli.model.scene import Scene
from pounding_cli.solve.arrays import LANES, Arrays, aligned, drift_of
from pounding_cli.solve.ground import segments
from pounding_cli.solve.method import Integrator, real_slots

SAFETY = 0.5
"""Local tolerance (relative, of acceleration) over the accuracy asked. Ordinary scenes come out hundreds of times
better than asked; this is for the hard ones, where thousands of contacts hand errors on (tests/hard)."""


QUIET = 1e-3
"""Part of the ground's peak below which accelerations are not resolved: isolated floors may feel as little."""


COARSEST = 1e-4
"""No series is cut shorter than this, whatever is asked: events would be found where there are none, to save little."""


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
    return min(max(accuracy * SAFETY, 1e-16), COARSEST)


def most_order(tolerance: float) -> int:
    """Highest order worth computing before the step is cut: near the optimum of Jorba & Zou, -ln(tol) / 2 + 1, and
    above it, because most steps end at a record sample."""
    return min(30, max(10, math.ceil(-0.75 * math.log(tolerance)) + 4))


def quiet_acceleration(scene: Scene, arrays: Arrays, state) -> float:
    """Acceleration [m/s2] below which nothing is resolved: a part of the ground's peak, or on still ground that of
    the start.

    The start's is the largest spring force per mass, or what would turn its largest velocity within a second.
    """
    if scene.motion.pga > 0:
        return QUIET * scene.motion.pga
    pulls = arrays.slots.stiffness * np.abs(drift_of(arrays, state)) * arrays.slots.inverse_mass
    return max(float(pulls.max()), float(np.abs(state.v).max()))


def most_standing(slots: int, links: int) -> int:
    """Events in a row without time going on that are too many."""
    return 20 + 4 * (slots + links)


FEW = 3
"""Buildings that are always solved as one island: to solve fewer at a time saves less than steps of their own cost."""

ROOM = 2
"""Places that buildings may take to stand alone, over those that they take one behind the other [-]: where buildings of
one or two storeys would leave most of every eight places empty, the row stays one island."""


def lined_up(scene: Scene, arrays: Arrays) -> tuple[Row, Feet]:
    """The buildings by place (`layout.Row`), and the foundations likewise."""
    begins = tuple(base if base >= 0 else span.start for base, span in zip(arrays.bases, arrays.floors, strict=True))
    count = arrays.links.number
    left, right = arrays.links.left[:count].tolist(), arrays.links.right[:count].tolist()
    row = _row((*begins, arrays.floors[-1].stop), tuple(link.left for link in scene.links), tuple(left), tuple(right))
    feet = arrays.feet
    if feet.number:
        base = np.where(feet.base >= 0, row.spots[feet.base], -1)
        feet = feet._replace(first=row.spots[feet.first], stop=row.spots[feet.stop - 1] + 1, base=base)
    return row, feet


def solved_in_islands(scene: Scene, arrays: Arrays) -> bool:
    """Whether buildings that do not touch take steps of their own."""
    return _stand_alone(*lined_up(scene, arrays))


def _stand_alone(row: Row, feet: Feet) -> bool:
    """Rocking bases have places of their own, so that a row with foundations stays one island."""
    return row.number > FEW and not feet.number and bool(np.all(row.first % LANES == 0))


@functools.lru_cache(maxsize=256)
def _row(begins: tuple[int, ...], at: tuple[int, ...], left: tuple[int, ...], right: tuple[int, ...]) -> Row:
    """Buildings that begin at the slots `begins` (and where the last ends), links between neighbours from the building
    `at` to the next, from slot `left` to slot `right`."""
    start, where = np.array(begins), np.array(at, np.int64)
    storeys = np.diff(start)
    closely = -(-start[-1] // LANES) * LANES
    first = np.concatenate(([0], np.cumsum(_padded(storeys))))
    alone = first[-1] <= ROOM * closely if storeys.size > FEW else first[-1] == closely
    if not alone:  # no building is run by itself: as few places as can be
        first = np.append(start[:-1], closely)
    spots = np.concatenate([first[b] + np.arange(n) for b, n in enumerate(storeys)])
    on, other = np.array(left, np.int64) - start[where], np.array(right, np.int64) - start[where + 1]
    count = np.bincount(where, minlength=storeys.size)
    if alone and np.array_equal(on, other) and len({*zip(at, left, strict=True)}) == len(at):
        width = np.where(count[:-1] > 0, _padded(np.minimum(storeys[:-1], storeys[1:])), 0)
        joints = np.concatenate(([0], np.cumsum(width)))
        seats, rounds = joints[where] + on, 0
    else:
        width = _padded(count[:-1]) if alone else count[:-1]
        joints = np.concatenate(([0], np.cumsum(width)))
        order = np.argsort(where, kind="stable")
        seats = np.empty(where.size, np.int64)
        seats[order] = joints[where[order]] + np.concatenate([np.arange(n) for n in count])
        rounds = max((int(np.bincount(ends).max()) for ends in (left, right) if ends), default=0)
    joints[-1] = _padded(joints[-1])
    whole = (np.ascontiguousarray(table, np.int64) for table in (first, joints, spots, seats))
    return Row(storeys.size, spots.size, len(at), rounds, *whole)


def _padded(count):
    """The next multiple of eight."""
    return -(-count // LANES) * LANES


def prepare(
    scene: Scene, arrays: Arrays, state, accuracy: float, bounds: tuple[int, int], everything: bool = False
) -> Callable[..., tuple[int, int, int, int, float]]:
    """The kernel for a scene that starts from `state`: a function of (state, peaks, ledger, starts, slopes, dt), the
    last three as in `ground.segments`. Called again it goes on from the state it left; see `kernels.taylor.build`.
    It does what the scene needs, or looks for everything there is."""
    from pounding_cli.kernels import taylor

    tolerance = local_tolerance(accuracy)
    row, feet = lined_up(scene, arrays)
    programs = any(link.law.general for link in scene.links)
    registers = arrays.links.registers if programs else 0
    needed = row.first[-1], arrays.feet.number, row.joints[-1], row.rounds, row.number, registers
    doubles, whole = taylor.room_needed(*needed)
    room, integers = aligned(doubles), np.zeros(whole, np.int64)
    kernel, rules = taylor.build(programs), gauss_rules(MOST_POINTS)
    inelastic = everything or effects_of(scene).yielding
    apart = not everything and _stand_alone(row, feet)  # fault: stands-apart
    quiet = quiet_acceleration(scene, arrays, state)
    standing = most_standing(real_slots(arrays), arrays.links.number)
    settings = inelastic, apart, tolerance, quiet, most_order(tolerance), *bounds, standing

    def run(state, peaks, ledger, starts: np.ndarray, slopes: np.ndarray, dt: float):
        room.fill(0.0)
        integers.fill(0)
        return kernel(
            arrays.slots, feet, arrays.links, row, state, peaks, ledger, *rules, room, integers, starts, slopes,
            dt, *settings,
        )  # fmt: skip

    return run


def integrate(
    scene: Scene, arrays: Arrays, state, peaks, ledger, accuracy: float, bounds: tuple[int, int]
) -> tuple[int, int, int, int, float]:
    """Run the kernel over the whole motion and its tail."""
    return prepare(scene, arrays, state, accuracy, bounds)(state, peaks, ledger, *segments(scene))


def integrate_everything(
    scene: Scene, arrays: Arrays, state, peaks, ledger, accuracy: float, bounds: tuple[int, int]
) -> tuple[int, int, int, int, float]:
    """The same looking for every effect, whether or not the scene calls for it."""
    return prepare(scene, arrays, state, accuracy, bounds, everything=True)(state, peaks, ledger, *segments(scene))


TAYLOR = Integrator(integrate)
WITH_EVERYTHING = Integrator(integrate_everything)
