"""From a scene to the flat arrays of the kernels."""

from __future__ import annotations

import functools
import threading
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from pounding_cli.kernels.layout import Links, Peaks, Points, Slots, Springs, State
from pounding_cli.kernels.ledger import Ledger
from pounding_cli.laws.program import MEMORIES
from pounding_cli.laws.storey import StoreyLaw
from pounding_cli.model.building import Building
from pounding_cli.model.links import Link, LinkEnd
from pounding_cli.model.scene import Analysis, Scene
from pounding_cli.solve import law_tables
from pounding_cli.solve.blank import LANES, Blank, aligned
from pounding_cli.solve.places import (
    Columns,
    Places,
    Struck,
    places_of,
    points_of,
    shears_of,
    springs_of,
    struck_between_floors,
    struck_columns,
)

_BY_SLOT = Slots._fields[1:11]
"""What is given of every slot (`layout.Slots`)."""

Masses = tuple[float, float]
"""On both sides of a link [kg]."""


@dataclass(frozen=True, eq=False)
class Arrays:
    """A scene as the kernels see it; building b has the slots from `begins[b]` to before the next one's, `floors[b]` is
    the slice of its floors, `bases[b]` and `rocks[b]` are the slots of its base and its rocking, or -1."""

    slots: Slots
    points: Points
    springs: Springs
    links: Links
    links_at_rest: law_tables.AtRest
    begins: tuple[int, ...]
    floors: tuple[slice, ...]
    bases: tuple[int, ...]
    rocks: tuple[int, ...]
    laws: tuple[StoreyLaw | None, ...]  # by slot: what yields; None where nothing does
    columns: tuple[Columns, ...]  # whose shear is asked for
    memory_at_rest: np.ndarray  # of the laws, shape (MEMORIES slots,)
    left_of_links: tuple[int, ...]  # by link, the building to its left
    empty_below: tuple[float, ...]  # by link (`LinkLaw.empty_below`)
    yield_drift: np.ndarray  # by slot [m]; inf where there is no storey
    yields: bool  # whether some storey can
    leans: bool  # whether some storey carries P-Delta of its own
    collapses: bool  # whether a drift is looked for at which a storey counts as collapsed
    flows: bool  # whether what a storey remembers changes between events too
    written: bool  # whether the force of some link is written as operations

    @property
    def padded(self) -> int:
        """Number of slots, padding included."""
        return self.slots.size

    def between(self, **of_links: Any) -> Arrays:
        """With what links change. `dataclasses.replace` takes longer than all else about links that differ in gap."""
        found = object.__new__(Arrays)
        found.__dict__.update(self.__dict__, **of_links)
        return found


def rows(names: Iterable[str], count: int) -> dict[str, np.ndarray]:
    """Rows of zeros by name, each from a cache line on; `count` is a multiple of LANES. One piece of memory for all:
    forty pieces took as long as all else about a scene."""
    names = tuple(names)
    return dict(zip(names, aligned(len(names) * count).reshape(len(names), count), strict=True))


def pack(scene: Scene) -> Arrays:
    """Lay a scene out in slots (see `kernels.layout`). Scenes share what they have in common: the buildings, the links
    or all of it; nothing writes to these arrays."""
    return _packed(scene.buildings, scene.links, scene.analysis)


@functools.lru_cache(maxsize=512)
def _packed(buildings: tuple[Building, ...], links: tuple[Link, ...], analysis: Analysis) -> Arrays:
    of_links = _of_links(links)
    given = buildings, analysis, of_links.struck, of_links.columns
    alone, _, storeys = _without_links(*given)
    flow = law_tables.flow_of(alone.laws) if alone.flows else 0
    packed, links_at_rest = law_tables.pack_links(links, *_ends(*given, of_links.ends), flow)
    tables, branch = storeys.after(packed)
    own = dict(zip(("branches", "guards", "operations"), tables, strict=True))
    slots = alone.slots._replace(branch=branch, **own)
    return alone.between(
        slots=slots, links=packed._replace(**own), links_at_rest=links_at_rest, left_of_links=of_links.left,
        empty_below=of_links.empty_below, written=of_links.written,
    )  # fmt: skip


class _OfLinks(NamedTuple):
    """What is asked of links whatever they stand between: places between floors, struck columns, ends, the buildings to
    their left, closings up to which they hold no energy [m], and whether a force is written as operations."""

    struck: tuple[Struck, ...]
    columns: tuple[Columns, ...]
    ends: tuple[tuple[LinkEnd, LinkEnd], ...]
    left: tuple[int, ...]
    empty_below: tuple[float, ...]
    written: bool


@functools.lru_cache(maxsize=512)
def _of_links(links: tuple[Link, ...]) -> _OfLinks:
    return _OfLinks(
        struck_between_floors(links), struck_columns(links), tuple([link.ends for link in links]),
        tuple([link.left for link in links]), tuple([link.law.empty_below for link in links]),
        any([link.law.general for link in links]),
    )  # fmt: skip


@functools.lru_cache(maxsize=64)  # the same for every gap and stiffness of a sweep
def _ends(
    buildings: tuple[Building, ...],
    analysis: Analysis,
    struck: tuple[Struck, ...],
    columns: tuple[Columns, ...],
    links: tuple[tuple[LinkEnd, LinkEnd], ...],
) -> tuple[tuple[tuple[int, int], ...], tuple[Masses, ...]]:
    """Slots that links with these ends join, and the masses that their forces move [kg]."""
    alone, places, _ = _without_links(buildings, analysis, struck, columns)
    mass = alone.slots.mass.copy()
    number = alone.points.number
    mass[alone.points.slot[:number]] = alone.points.mass[:number]
    slots = []
    for ends in links:
        one, other = (places.struck[end] if end[2] != 1.0 else places.floor(*end[:2]) for end in ends)
        slots.append((one, other))
    return tuple(slots), tuple((float(mass[one]), float(mass[other])) for one, other in slots)


@functools.lru_cache(maxsize=64)
def _without_links(
    buildings: tuple[Building, ...], analysis: Analysis, struck: tuple[Struck, ...], columns: tuple[Columns, ...]
) -> tuple[Arrays, Places, law_tables.Storeys]:
    """The arrays of buildings alone, with the points that links need; where all stands; the rows of their storeys'
    laws."""
    arrays, places = _elastic(buildings, struck, columns)
    if analysis == Analysis.INELASTIC:
        arrays = _inelastic(arrays, buildings)
    return arrays, places, law_tables.storeys_of(arrays.laws)


def _inelastic(elastic: Arrays, buildings: tuple[Building, ...]) -> Arrays:
    """The arrays of buildings alone whose storeys may yield, from those of storeys that do not."""
    laws: list[StoreyLaw | None] = [None] * elastic.padded
    collapse = elastic.slots.collapse.copy()
    for building, span in zip(buildings, elastic.floors, strict=True):
        laws[span] = (law if law.can_yield else None for law in building.laws)
        collapse[span] = building.collapse_drift
    memory = np.zeros((MEMORIES, elastic.padded))
    for i, law in enumerate(laws):
        begin = law.memories_at_rest if law else ()
        memory[: len(begin), i] = begin
    return elastic.between(
        slots=elastic.slots._replace(collapse=collapse, memories=law_tables.memories_of(laws)), laws=tuple(laws),
        memory_at_rest=memory.ravel(), yields=any(law is not None for law in laws),
        collapses=bool(np.isfinite(collapse).any()), flows=any([building.memory_flows for building in buildings]),
    )  # fmt: skip


@functools.lru_cache(maxsize=64)
def _elastic(
    buildings: tuple[Building, ...], struck: tuple[Struck, ...], columns: tuple[Columns, ...]
) -> tuple[Arrays, Places]:
    """As `_without_links`, of storeys that do not yield."""
    places = places_of(buildings, struck, columns)
    slots = _slots(buildings, places)
    yield_drift = np.full(slots.size, np.inf)
    for building, span in zip(buildings, places.floors, strict=True):
        yield_drift[span] = building.yield_drift
    points = points_of(places, slots.mass)._replace(shears=shears_of(places, columns))
    arrays = Arrays(
        slots, points, springs_of(buildings, places), *law_tables.pack_links((), (), ()),
        tuple(places.begins), tuple(places.floors), tuple(places.bases), tuple(places.rocks), (None,) * slots.size,
        columns, np.zeros(MEMORIES * slots.size), left_of_links=(), empty_below=(), yield_drift=yield_drift,
        yields=False, leans=bool(slots.geometric.any()), collapses=False, flows=False, written=False,
    )  # fmt: skip
    return arrays, places


def _slots(buildings: tuple[Building, ...], places: Places) -> Slots:
    """The slots and their padding, without the storeys' laws."""
    count = places.begins[-1]
    padded = -(-count // LANES) * LANES
    nothing = np.zeros(0)
    slots = Slots(
        padded, **rows(_BY_SLOT, padded), branch=np.zeros(padded, np.int64), memories=0, branches=nothing,
        guards=nothing, operations=nothing,
    )  # fmt: skip
    slots.collapse[:] = np.inf
    for building, span, base, rock in zip(buildings, places.floors, places.bases, places.rocks, strict=True):
        foundation = building.foundation
        slots.couple[span] = 1.0
        slots.stiffness[span] = building.stiffness
        slots.dashpot[span] = building.beta * building.stiffness
        slots.mass[span] = building.mass
        slots.loaded[span] = 1.0
        if building.gravity_load is not None and rock < 0:
            slots.geometric[span] = building.gravity_load / building.height
        if foundation is None:
            slots.alpha[span] = building.alpha
        if foundation is not None and foundation.sway is not None:
            slots.mass[base], slots.stiffness[base], slots.dashpot[base] = foundation.sway.numbers
            slots.loaded[base] = 1.0
        elif rock < 0:
            slots.couple[span.start] = 0.0
        if foundation is not None and foundation.rocking is not None:
            by_angle = np.array(foundation.rocking.numbers)
            slots.mass[rock], slots.stiffness[rock], slots.dashpot[rock] = by_angle / float(building.elevation[-1]) ** 2
    slots.couple_right[:-1] = slots.couple[1:]
    slots.inverse_mass[slots.mass > 0.0] = 1.0 / slots.mass[slots.mass > 0.0]
    return slots


class Begun(NamedTuple):
    """What a run fills, before its first step; `memory` is where all three stand, one behind the other."""

    state: State
    peaks: Peaks
    ledger: Ledger
    memory: np.ndarray


def memory_at_rest(arrays: Arrays) -> np.ndarray:
    """The memory of a run (`Begun`) before the motion: at rest, touching links exactly at v = 0, no peaks, no
    energies."""
    blank = _blank(arrays.padded, arrays.links.size)
    memory = blank.copy()
    whole = memory.view(np.int64)
    at = blank.places
    whole[at["storey_branch"]], memory[at["storey_memory"]] = arrays.slots.branch, arrays.memory_at_rest
    whole[at["link_branch"]], whole[at["pinned_link"]], memory[at["pinned_closing"]] = arrays.links_at_rest
    return memory


def at_rest(arrays: Arrays) -> Begun:
    """What a run from rest fills, before its first step."""
    return _begun(arrays.padded, arrays.links.size, memory_at_rest(arrays))


def _begun(padded: int, links: int, memory: np.ndarray) -> Begun:
    state, peaks, ledger = _blank(padded, links).tuples(memory)
    return Begun(state, peaks, ledger, memory)


def begun_in_turn(arrays: Arrays, memory: np.ndarray) -> Begun:
    """What a run fills that starts from such a memory (`Begun`): in place of what the last run of this size in this
    thread has filled."""
    begun = _in_turn(arrays.padded, arrays.links.size, threading.get_ident())
    begun.memory[:] = memory
    return begun


@functools.lru_cache(maxsize=64)
def _in_turn(padded: int, links: int, thread: int) -> Begun:
    return _begun(padded, links, _blank(padded, links).copy())


NO_SAMPLES = np.zeros((0, 0))
"""Of a run that is not watched."""


def watched(peaks: Peaks, segments: int) -> Peaks:
    """The peaks, with room for the displacements at the ends of so many segments."""
    padded = peaks.drift.size
    return peaks._replace(watched=1, samples=aligned(segments * padded).reshape(segments, padded))


def peaks_in(arrays: Arrays, memory: np.ndarray) -> Peaks:
    """The peaks in such a memory (`Begun`)."""
    return _blank(arrays.padded, arrays.links.size).tuples(memory, 2)[1]


class Ended(NamedTuple):
    """What runs that are laid out alike have left: state and peaks with a row for each run, their ledgers summed over
    slots and links [J], shape (runs,) each, and which of them have left finite peaks."""

    state: State
    peaks: Peaks
    ledger: Ledger
    finite: np.ndarray


def ended(arrays: Arrays, runs: Sequence[np.ndarray]) -> Ended:
    """What runs have left in their memories (`Begun`); `arrays` are those of one of them, the others are laid out
    alike."""
    blank = _blank(arrays.padded, arrays.links.size)
    memory = np.array(runs)
    state, peaks = blank.tuples(memory, 2)
    booked = memory[:, blank.spans[2]]
    of_slots = booked[:, : booked.shape[1] - arrays.links.size].reshape(len(runs), -1, arrays.padded)
    sums = np.add.reduce(of_slots, axis=2).T
    ledger = Ledger._make([*sums, np.add.reduce(booked[:, booked.shape[1] - arrays.links.size :], axis=1)])
    return Ended(state, peaks, ledger, np.isfinite(memory[:, blank.spans[1]]).all(axis=1))


@functools.lru_cache(maxsize=64)
def _blank(padded: int, links: int) -> Blank:
    """State, peaks and ledger of a scene of this size before its first step, but for branches and memories."""
    slot, link = np.zeros(padded), np.zeros(links)
    storey, which = np.zeros(padded, np.int64), np.zeros(links, np.int64)
    state = State(
        u=slot, v=slot, storey_branch=storey, storey_memory=np.zeros(MEMORIES * padded), pinned_storey=storey,
        link_branch=which, pinned_link=which, pinned_closing=link, link_memory=link,
    )  # fmt: skip
    peaks = Peaks(
        watched=0, drift=slot, shear=slot, acceleration=slot, displacement_max=slot, displacement_min=slot,
        closing=link - 1e300, force=link, impulse=link, contact_time=link,
        tangent=np.zeros(4 * (padded + links)), samples=np.zeros((0, padded)), impacts=which,
    )  # fmt: skip
    return Blank(state, peaks, Ledger(**dict.fromkeys(Ledger._fields[:5], slot), links=link))


def with_points(arrays: Arrays, u: np.ndarray) -> np.ndarray:
    """Displacements [m] by slot (the last dimension) with those of the points, from those of the degrees of freedom."""
    points = arrays.points
    if not points.number:
        return u
    whole = u.copy()
    moved = np.sum(points.weight * u[..., points.freedom], axis=-2)
    whole[..., points.slot[: points.number]] = moved[..., : points.number]
    return whole


def drift_of(arrays: Arrays, u: np.ndarray) -> np.ndarray:
    """Storey drifts (and displacements of bases) [m] by slot (the last dimension), from displacements by slot."""
    drift = with_points(arrays, u).copy()
    drift[..., 1:] -= arrays.slots.couple[1:] * drift[..., :-1]
    return drift
