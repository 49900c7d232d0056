"""From a scene to the flat arrays of the kernels, and back from the kernels' peaks to a response."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from pounding_cli.kernels.layout import Foundations, Links, Peaks, Slots, State
from pounding_cli.kernels.ledger import Ledger
from pounding_cli.laws.program import MEMORIES
from pounding_cli.laws.storey import StoreyLaw
from pounding_cli.model.building import Building
from pounding_cli.model.effects import effects_of
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Analysis, Scene
from pounding_cli.solve import law_tables
from pounding_cli.solve.blank import LANES, Blank, aligned
from pounding_cli.solve.response import BuildingResponse, LinkResponse

_BY_SLOT = Slots._fields[1:13]
"""What is given of every slot (`layout.Slots`)."""


@dataclass(frozen=True, eq=False)
class Arrays:
    """A scene as the kernels see it; `floors[b]` is the slice of slots of building b's floors, `bases[b]` its base
    slot or -1."""

    slots: Slots
    foundations: Foundations
    links: Links
    links_at_rest: law_tables.AtRest
    floors: tuple[slice, ...]
    bases: tuple[int, ...]
    foundation_of: tuple[int, ...]  # by building: place among the foundations, or -1
    laws: tuple[StoreyLaw | None, ...]  # by slot: what yields; None where nothing does
    memory_at_rest: np.ndarray  # of the laws, shape (MEMORIES slots,)

    @property
    def padded(self) -> int:
        """Number of slots, padding included."""
        return self.slots.size


def rows(names: Iterable[str], count: int) -> dict[str, np.ndarray]:
    """Rows of zeros by name, each from a cache line on; `count` is a multiple of LANES. One piece of memory for all:
    forty pieces took as long as all else about a scene."""
    names = tuple(names)
    return dict(zip(names, aligned(len(names) * count).reshape(len(names), count), strict=True))


def pack(scene: Scene) -> Arrays:
    """Lay a scene out in slots (see `kernels.layout`). Scenes share what they have in common: the buildings, the links
    or all of it; nothing writes to these arrays."""
    return _packed(scene.buildings, scene.links, scene.analysis)


@functools.lru_cache(maxsize=1024)
def _packed(buildings: tuple[Building, ...], links: tuple[Link, ...], analysis: Analysis) -> Arrays:
    alone, storeys = _without_links(buildings, analysis)
    packed, links_at_rest = law_tables.pack_links(buildings, links, alone.floors)
    tables, branch = law_tables.with_storeys(packed, *storeys)
    own = dict(zip(("branches", "guards", "operations"), tables, strict=True))
    slots = alone.slots._replace(branch=branch, **own)
    return dataclasses.replace(alone, slots=slots, links=packed._replace(**own), links_at_rest=links_at_rest)


@functools.lru_cache(maxsize=64)
def _without_links(
    buildings: tuple[Building, ...], analysis: Analysis
) -> tuple[Arrays, tuple[law_tables.Rows | None, np.ndarray]]:
    """The arrays of buildings alone; the rows of their storeys' laws, and by slot the first of them, -1 for none."""
    floors, bases, foundation_of = [], [], []
    place = 0
    founded = 0
    for building in buildings:
        foundation = building.foundation
        sways = foundation is not None and foundation.sways
        bases.append(place if sways else -1)
        place += int(sways)
        floors.append(slice(place, place + building.storeys))
        place += building.storeys
        foundation_of.append(founded if foundation is not None else -1)
        founded += int(foundation is not None)
    slots = _slots(buildings, floors, bases, place)
    laws: list[StoreyLaw | None] = [None] * slots.size
    if analysis == Analysis.INELASTIC:  # fault: elastic-never-yields
        for building, span in zip(buildings, floors, strict=True):
            laws[span] = (law if law.can_yield else None for law in building.laws)
        for building, span in zip(buildings, floors, strict=True):
            slots.collapse[span] = building.collapse_drift
    slots = slots._replace(memories=law_tables.memories_of(laws))
    memory = np.zeros((MEMORIES, slots.size))
    for i, law in enumerate(laws):
        begin = law.memories_at_rest if law else ()
        memory[: len(begin), i] = begin
    arrays = Arrays(
        slots, _foundations(buildings, floors, bases), *law_tables.pack_links(buildings, (), floors), tuple(floors),
        tuple(bases), tuple(foundation_of), tuple(laws), memory.ravel(),
    )  # fmt: skip
    return arrays, law_tables.storey_rows(laws)


def _slots(buildings: tuple[Building, ...], floors: list[slice], bases: list[int], count: int) -> Slots:
    """`count` slots and the padding, without their laws."""
    padded = -(-count // LANES) * LANES
    nothing = np.zeros(0)
    slots = Slots(
        padded, **rows(_BY_SLOT, padded), branch=np.zeros(padded, np.int64), memories=0, branches=nothing,
        guards=nothing, operations=nothing,
    )  # fmt: skip
    slots.collapse[:] = np.inf
    slots.real[:count] = 1.0  # fault: ground-pushes-floors
    for building, span, base in zip(buildings, floors, bases, strict=True):
        foundation = building.foundation
        slots.couple[span] = 1.0
        slots.stiffness[span] = building.stiffness
        slots.dashpot[span] = building.beta * building.stiffness  # fault: stiffness-damping
        slots.mass[span] = building.mass
        slots.elevation[span] = building.elevation
        if building.gravity_load is not None:
            slots.geometric[span] = building.gravity_load / building.height
        if foundation is None:
            slots.alpha[span] = building.alpha  # fault: mass-damping
        elif foundation.rocks:
            slots.rise[span] = building.height
        if foundation is not None and base >= 0:
            slots.stiffness[base] = foundation.sway_stiffness
            slots.dashpot[base] = foundation.sway_damping
            slots.mass[base] = foundation.mass
        else:
            slots.couple[span.start] = 0.0
    slots.couple_right[:-1] = slots.couple[1:]
    slots.inverse_mass[:count] = 1.0 / slots.mass[:count]
    return slots


def _foundations(buildings: tuple[Building, ...], floors: list[slice], bases: list[int]) -> Foundations:
    """The foundations of the buildings that have one."""
    placed = zip(floors, bases, buildings, strict=True)
    grounds = [(span, base, b, b.foundation) for span, base, b in placed if b.foundation is not None]
    return Foundations(
        number=len(grounds),
        first=np.array([span.start for span, *_ in grounds], np.int64),
        stop=np.array([span.stop for span, *_ in grounds], np.int64),
        base=np.array([base for _, base, *_ in grounds], np.int64),
        inertia=np.array([f.inertia if f.rocks else np.inf for *_, f in grounds], float),
        stiffness=np.array([f.rocking_stiffness if f.rocks else 0.0 for *_, f in grounds], float),
        dashpot=np.array([f.rocking_damping if f.rocks else 0.0 for *_, f in grounds], float),
        alpha=np.array([b.alpha for _, _, b, _ in grounds], float),
    )


def at_rest(arrays: Arrays) -> State:
    """The state before the motion: at rest, touching links exactly at v = 0."""
    state = _blanks(arrays.padded, arrays.foundations.number, arrays.links.size)[0].copy()
    state.storey_branch[:], state.storey_memory[:] = arrays.slots.branch, arrays.memory_at_rest
    state.link_branch[:], state.pinned_link[:], state.pinned_closing[:] = arrays.links_at_rest
    return state


def no_peaks(arrays: Arrays, watched: int = 0) -> Peaks:
    """Peaks before the first step; `watched` is the number of segments at whose ends displacements are wanted."""
    peaks = _blanks(arrays.padded, arrays.foundations.number, arrays.links.size)[1].copy()
    samples = aligned(watched * arrays.padded).reshape(watched, arrays.padded)
    return peaks._replace(watched=int(watched > 0), samples=samples)


def empty_ledger(arrays: Arrays) -> Ledger:
    """Energies before the first step."""
    return _blanks(arrays.padded, arrays.foundations.number, arrays.links.size)[2].copy()


@functools.lru_cache(maxsize=64)
def _blanks(padded: int, foundations: int, links: int) -> tuple[Blank, Blank, Blank]:
    """State, peaks and ledger of a scene of this size before its first step, but for branches and memories."""
    slot, base, link = np.zeros(padded), np.zeros(foundations), np.zeros(links)
    storey, which = np.zeros(padded, np.int64), np.zeros(links, np.int64)
    state = State(
        u=slot, v=slot, storey_branch=storey, storey_memory=np.zeros(MEMORIES * padded), pinned_storey=storey,
        link_branch=which, pinned_link=which, pinned_closing=link, link_memory=link, phi=base, phi_v=base,
    )  # fmt: skip
    peaks = Peaks(
        watched=0, drift=slot, shear=slot, acceleration=slot, displacement_max=slot, displacement_min=slot,
        rocking=base, closing=link - 1e300, force=link, impulse=link, contact_time=link, samples=slot[:0],
        impacts=which,
    )  # fmt: skip
    ledger = Ledger(**dict.fromkeys(Ledger._fields[:5], slot), links=link, foundations=base)
    return Blank(state), Blank(peaks), Blank(ledger)


def unpack(
    scene: Scene, arrays: Arrays, state: State, peaks: Peaks
) -> tuple[tuple[BuildingResponse, ...], LinkResponse]:
    """Peaks by slot and link as responses by building and link, which share their memory."""
    buildings = []
    drift_now = drift_of(arrays, state)
    yielding = effects_of(scene).yielding  # elsewhere the kernels track drifts alone
    for b, building in enumerate(scene.buildings):
        span, base, foundation = arrays.floors[b], arrays.bases[b], arrays.foundation_of[b]
        drift = peaks.drift[span]
        buildings.append(
            BuildingResponse(
                shear=peaks.shear[span] if yielding else building.stiffness * drift,
                drift=drift,
                ductility=drift / building.yield_drift,
                acceleration=peaks.acceleration[span],
                displacement_max=peaks.displacement_max[span],
                displacement_min=peaks.displacement_min[span],
                residual_drift=drift_now[span],
                sway=float(max(peaks.displacement_max[base], -peaks.displacement_min[base])) if base >= 0 else 0.0,
                rocking=float(peaks.rocking[foundation]) if foundation >= 0 else 0.0,
            )
        )
    count = arrays.links.number
    links = LinkResponse(
        impacts=peaks.impacts[:count],
        peak_force=peaks.force[:count],
        max_closing=peaks.closing[:count],
        impulse=peaks.impulse[:count],
        contact_time=peaks.contact_time[:count],
    )
    return tuple(buildings), links


def drift_of(arrays: Arrays, state: State) -> np.ndarray:
    """Storey drifts (and sway of bases) of a state [m], by slot."""
    before = np.concatenate(([0.0], state.u[:-1]))
    drift = state.u - arrays.slots.couple * before
    for f in range(arrays.foundations.number):
        span = slice(arrays.foundations.first[f], arrays.foundations.stop[f])
        drift[span] -= arrays.slots.rise[span] * state.phi[f]
    return drift
