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
from pounding_cli.solve.law_tables import LANES
from pounding_cli.solve.response import BuildingResponse, LinkResponse

_BY_SLOT = Slots._fields[1:11]
"""What is given of every slot (`layout.Slots`)."""


@dataclass(frozen=True, eq=False)
class Arrays:
    """A scene as the kernels see it; `floors[b]` is the slice of slots of building b's floors, `bases[b]` its base
    slot or -1."""

    slots: Slots
    foundations: Foundations
    links: Links
    floors: tuple[slice, ...]
    bases: tuple[int, ...]
    foundation_of: tuple[int, ...]  # by building: place among the foundations, or -1
    laws: tuple[StoreyLaw | None, ...]  # by slot: what yields; None where nothing does
    memory_at_rest: np.ndarray  # of the laws, shape (MEMORIES slots,)

    @property
    def padded(self) -> int:
        """Number of slots, padding included."""
        return self.slots.size


def aligned(count: int) -> np.ndarray:
    """Zeros that begin at a cache line, so that no vector lies across two."""
    memory = np.zeros(count + LANES)
    skip = (-memory.__array_interface__["data"][0] // 8) % LANES
    return memory[skip : skip + count]


def rows(names: Iterable[str], count: int) -> dict[str, np.ndarray]:
    """Rows of zeros by name, each from a cache line on; `count` is a multiple of LANES. One piece of memory for all:
    forty pieces took as long as all else about a scene."""
    names = tuple(names)
    return dict(zip(names, aligned(len(names) * count).reshape(len(names), count), strict=True))


def pack(scene: Scene) -> Arrays:
    """Lay a scene out in slots (see `kernels.layout`). Scenes share what they have in common: the buildings, the links
    or all of it; nothing writes to these arrays."""
    return _packed(scene.buildings, scene.links, scene.analysis)


@functools.lru_cache(maxsize=8)
def _packed(buildings: tuple[Building, ...], links: tuple[Link, ...], analysis: Analysis) -> Arrays:
    alone, storeys = _without_links(buildings, analysis)
    packed = law_tables.pack_links(buildings, links, alone.floors)
    tables, branch = law_tables.with_storeys(packed, *storeys)
    own = dict(zip(("branches", "guards", "operations"), tables, strict=True))
    return dataclasses.replace(alone, slots=alone.slots._replace(branch=branch, **own), links=packed._replace(**own))


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
    memory = np.zeros((MEMORIES, slots.size))
    for i, law in enumerate(laws):
        begin = law.memories_at_rest if law else ()
        memory[: len(begin), i] = begin
    none = law_tables.pack_links(buildings, (), floors)
    arrays = Arrays(
        slots, _foundations(buildings, floors, bases), none, tuple(floors), tuple(bases), tuple(foundation_of),
        tuple(laws), memory.ravel(),
    )  # fmt: skip
    return arrays, law_tables.storey_rows(laws)


def _slots(buildings: tuple[Building, ...], floors: list[slice], bases: list[int], count: int) -> Slots:
    """`count` slots and the padding, without their laws."""
    padded = -(-count // LANES) * LANES
    nothing = np.zeros(0)
    slots = Slots(
        padded, **rows(_BY_SLOT, padded), branch=np.zeros(padded, np.int64), branches=nothing, guards=nothing,
        operations=nothing,
    )  # fmt: skip
    slots.real[:count] = 1.0  # fault: ground-pushes-floors
    for building, span, base in zip(buildings, floors, bases, strict=True):
        foundation = building.foundation
        slots.couple[span] = 1.0
        slots.stiffness[span] = building.stiffness
        slots.dashpot[span] = building.beta * building.stiffness  # fault: stiffness-damping
        slots.mass[span] = building.mass
        slots.elevation[span] = building.elevation
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
    padded, foundations = arrays.padded, arrays.foundations.number
    branch, known, at = law_tables.at_rest(arrays.links)
    return State(
        **rows(("u", "v"), padded),
        storey_branch=arrays.slots.branch.copy(),
        storey_memory=arrays.memory_at_rest.copy(),
        pinned_storey=np.zeros(padded, np.int64),
        link_branch=branch,
        pinned_link=known,
        pinned_closing=at,
        link_memory=np.zeros(at.size),
        phi=np.zeros(foundations),
        phi_v=np.zeros(foundations),
    )


def no_peaks(arrays: Arrays, watched: int = 0) -> Peaks:
    """Peaks before the first step; `watched` is the number of segments at whose ends displacements are wanted."""
    padded, foundations, count = arrays.padded, arrays.foundations.number, arrays.links.size
    by_slot = rows(("drift", "shear", "acceleration", "displacement_max", "displacement_min"), padded)
    by_link = {n: np.zeros(count) for n in ("force", "impulse", "contact_time")}
    return Peaks(
        watched=int(watched > 0), **by_slot, rocking=np.zeros(foundations), closing=np.full(count, -1e300), **by_link,
        samples=aligned(watched * padded).reshape(watched, padded), impacts=np.zeros(count, np.int64),
    )  # fmt: skip


def empty_ledger(arrays: Arrays) -> Ledger:
    """Energies before the first step."""
    by_slot = rows(Ledger._fields[:5], arrays.padded)
    return Ledger(**by_slot, links=aligned(arrays.links.size), foundations=np.zeros(arrays.foundations.number))


def unpack(
    scene: Scene, arrays: Arrays, state: State, peaks: Peaks
) -> tuple[tuple[BuildingResponse, ...], LinkResponse]:
    """Peaks by slot and link as responses by building and link."""
    buildings = []
    drift_now = drift_of(arrays, state)
    yielding = effects_of(scene).yielding  # elsewhere the kernels track drifts alone
    for b, building in enumerate(scene.buildings):
        span, base, foundation = arrays.floors[b], arrays.bases[b], arrays.foundation_of[b]
        drift = peaks.drift[span].copy()
        buildings.append(
            BuildingResponse(
                shear=peaks.shear[span].copy() if yielding else building.stiffness * drift,
                drift=drift,
                ductility=drift / building.yield_drift,
                acceleration=peaks.acceleration[span].copy(),
                displacement_max=peaks.displacement_max[span].copy(),
                displacement_min=peaks.displacement_min[span].copy(),
                residual_drift=drift_now[span].copy(),
                sway=float(max(peaks.displacement_max[base], -peaks.displacement_min[base])) if base >= 0 else 0.0,
                rocking=float(peaks.rocking[foundation]) if foundation >= 0 else 0.0,
            )
        )
    count = arrays.links.number
    links = LinkResponse(
        impacts=peaks.impacts[:count].copy(),
        peak_force=peaks.force[:count].copy(),
        max_closing=peaks.closing[:count].copy(),
        impulse=peaks.impulse[:count].copy(),
        contact_time=peaks.contact_time[:count].copy(),
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
