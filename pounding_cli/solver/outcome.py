"""What a run has left: its response, its energy balance, and flags of what the user should know about it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from operator import attrgetter

import numpy as np

from pounding_cli.laws import link_laws
from pounding_cli.laws.formula import WrittenJoint
from pounding_cli.laws.law import LinkLaw
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Scene
from pounding_cli.model.wall import Wall
from pounding_cli.solver import records
from pounding_cli.solver.assemble import Layout
from pounding_cli.solver.records import Data
from pounding_cli.solver.response import (
    COLLAPSED,
    DONE,
    OUTCOMES,
    BuildingResponse,
    ColumnResponse,
    LinkResponse,
    nothing,
)

_floors = attrgetter("left", "left_floor", "right_floor")

Outcome = tuple[str, str]
"""How a run ended, in words, and what to do about it."""

ENDS: tuple[Outcome, ...] = (
    (DONE, ""),
    (COLLAPSED, ""),
    ("step bound reached", "a part of the scene is far stiffer than the rest: check stiffnesses and masses"),
    ("event bound reached", "the floors strike too often: check the stiffness and damping of the links"),
    ("stalled", "events repeat without advancing in time: check for links whose force jumps"),
    ("not finite", "the numbers exceed the range of double precision: check masses and stiffnesses"),
    (
        "no root",
        "Newton's method found no root at any step, because a force jumps: use a method with events, e.g. taylor",
    ),
    ("unstable step", "the solution would grow without bound: use a shorter time step, or taylor"),
)
"""What the user reads of every status of a kernel (`records.DONE`...)."""

LEAST_RESIDUAL = 1e-8
"""Energy residual over the input that is always allowed; a run asked for less accuracy may leave as much open as
that."""

OPEN_BALANCE: Outcome = (
    "energy does not close",
    "the error of the series exceeds the accuracy asked: set a finer accuracy, or reduce extreme stiffnesses",
)


def outcome_of(data: Data, accuracy: float, residual: float) -> Outcome:
    """How a run ended: none with numbers that are not finite, or an energy balance that does not close, is done."""
    end = ENDS[int(data.run["status"][0])]
    if end[0] not in OUTCOMES:
        return end
    sums = [data.dofs[name].sum() for name in ("u_max", "u_min", "a_max", "u0")]
    sums += [data.elements[name].sum() for name in ("peak_v", "peak_f", "impulse", "time")]
    if not np.isfinite(sums).all():
        return ENDS[records.NOT_FINITE]
    return end if abs(residual) <= max(accuracy, LEAST_RESIDUAL) else OPEN_BALANCE


def buildings_of(layout: Layout, data: Data) -> tuple[BuildingResponse, ...]:
    """The peaks of every building; a wall does not yield, and one that moves as the ground does has none."""
    reach, found = np.maximum(data.dofs["u_max"], -data.dofs["u_min"]), []
    for b, building in enumerate(layout.buildings):
        storeys, floors = data.elements[layout.floors[b]], data.dofs[layout.floors[b]]
        drift = storeys["peak_v"].copy()
        shear = np.where(storeys["yields"] > 0, storeys["peak_f"], building.stiffness * drift)
        sway, rocking = (float(reach[at[b]]) if at[b] >= 0 else 0.0 for at in (layout.bases, layout.feet))
        isolated = building.foundation is not None and building.foundation.isolation is not None
        peaks = BuildingResponse(
            shear, drift, drift / building.yield_drift, floors["a_max"].copy(), floors["u_max"].copy(),
            floors["u_min"].copy(), storeys["v1"].copy(), sway, rocking, sway if isolated else np.nan,
        )  # fmt: skip
        if isinstance(building, Wall):
            peaks = replace(peaks, ductility=np.full(1, np.nan)) if building.moves else nothing([1], 0)[0][0]
        found.append(peaks)
    return tuple(found)


def links_of(layout: Layout, data: Data, links: Sequence[Link]) -> LinkResponse:
    """The peaks of every link."""
    found = data.elements[layout.of_links]
    time = np.where([link.law.can_close for link in links], found["time"], 0.0)
    closing = found["peak_v"] + found["offset"]
    return LinkResponse(found["hits"].copy(), found["peak_f"].copy(), closing, found["impulse"].copy(), time)


def columns_of(layout: Layout, data: Data) -> ColumnResponse:
    """The shears of struck columns, one entry for each link that asks for them."""
    struck = layout.struck
    if not struck:
        return ColumnResponse()
    below, above = data.columns["peak"].reshape(-1, 2).T.copy()
    strength = [each.share * layout.buildings[each.building].yield_shear[each.storey - 1] for each in struck]
    demand = np.maximum(below, above) / np.array(strength, float)
    demand[np.isinf(strength)] = np.nan
    return ColumnResponse(np.array([each.link for each in struck], np.int64), below, above, demand)


def stored_in_storeys(
    layout: Layout, deformation: np.ndarray, force: np.ndarray, u: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """(energy in storeys and foundations [J], of them in storeys that yield) at deformations [m], forces without
    dashpots [N] and displacements [m], shape (..., n) each. What the weights have lost in height by P-Delta counts as
    less than nothing."""
    elements = layout.elements[: layout.number]
    yields = elements["yields"] > 0
    stored = np.where(yields, 0.0, 0.5 * elements["p"][:, 0] * deformation**2)
    for b, building in enumerate(layout.buildings if yields.any() else ()):
        first = layout.floors[b].start
        laws = {first + j: building.laws[j] for j in np.flatnonzero(yields[layout.floors[b]]).tolist()}
        if building.isolators is not None:
            laws[layout.bases[b]] = building.isolators
        for place, law in laws.items():
            stored[..., place] = law.stored(deformation[..., place], force[..., place])
    total = stored.sum(axis=-1)
    if elements["load"].any():
        below = np.concatenate((np.zeros((*u.shape[:-1], 1)), u[..., :-1]), axis=-1)
        total = total - 0.5 * np.sum(elements["load"] * (u - layout.dofs["below"] * below) ** 2, axis=-1)
    return total, stored[..., yields].sum(axis=-1)


def balance(layout: Layout, data: Data, links: Sequence[Link], before: float = 0.0) -> dict[str, float]:
    """The energy balance [J]; `residual` is what is missing over the largest entry [-], or over what storeys held at
    their peaks if that is more: a run may have given back what it took in.

    input : work of the ground, plus what the scene held at the start (`before`)
    kinetic, stored, links_stored : held at the end
    damping, hysteresis, links : dissipated by structural and foundation dashpots, by yielding storeys, by the links
    """
    dofs, elements, r, n = data.dofs, data.elements, data.run[0], layout.number
    storeys, of_links = elements[:n], elements[layout.of_links]
    stored, yielding = stored_in_storeys(layout, storeys["v1"], _forces_now(storeys), dofs["u0"])
    in_links = _stored_in_links(links, of_links)
    entries = {
        "input": float(r["input"]) + before,
        "kinetic": 0.5 * float(dofs["mass"] @ dofs["w"][:, 0] ** 2),
        "stored": float(stored),
        "links_stored": in_links,
        "damping": float(r["drag"] + r["dashpots"] + elements["work"][n : layout.of_links.start].sum()),
        "hysteresis": float(storeys["work"].sum() - yielding),
        "links": float(of_links["work"].sum()) - in_links,
    }
    values, stiffness = list(entries.values()), storeys["p"][:, 0]
    peaks = np.where(storeys["yields"] > 0, storeys["peak_f"], stiffness * storeys["peak_v"])
    held = 0.5 * float(np.sum(peaks**2 / np.where(stiffness > 0, stiffness, np.inf)))
    scale = max(held, *map(abs, values))
    missing = values[0] - sum(values[1:])
    return entries | {"residual": missing / scale if scale > 0 else 0.0}


def _forces_now(storeys: np.ndarray) -> np.ndarray:
    """Forces of storeys at the end of a run, without dashpots [N]."""
    p, z = storeys["p"], storeys["h"][:, 0]
    smooth = (1.0 - p[:, 2]) * p[:, 0] * p[:, 1] * z  # of Bouc-Wen, the one law of storeys that is smooth
    return storeys["k"] * storeys["v1"] + storeys["f0"] + np.where(storeys["smooth"] > 0, smooth, 0.0)


def _stored_in_links(links: Sequence[Link], elements: np.ndarray) -> float:
    """Energy in all links at the end of a run [J]; one that is open holds none."""
    total = 0.0
    for place in np.flatnonzero(elements["closed"]).tolist():
        e = elements[place]
        force = e["h"][0] if e["relaxation"] > 0 else e["k"] * e["v1"] + e["f0"]
        total += links[place].law.stored(float(e["v1"] + e["offset"]), float(force))
    return total


def collapse_of(layout: Layout, data: Data) -> tuple[int, int]:
    """(building from 0, storey from 1) of the storey that has drifted furthest of what it stands."""
    storeys = data.elements[: layout.number]
    parts = [storeys["peak_v"][span] / storeys["collapse"][span] for span in layout.floors]
    building = int(np.argmax([part.max() for part in parts]))
    return building, int(np.argmax(parts[building])) + 1


def flags_of(scene: Scene, buildings: Sequence[BuildingResponse], links: LinkResponse) -> tuple[str, ...]:
    """One sentence for each base that moved further than its isolators can, and for each link compressed beyond its
    thickness or its gap (paper, after eqs 9 and 10): what is flagged, a colon, where and by how much. Where another
    link lets the floors strike, nothing is left out."""
    said = []
    for building, peaks in zip(scene.buildings, buildings, strict=True):
        isolation = None if building.foundation is None else building.foundation.isolation
        if isolation is not None and peaks.sway > isolation.capacity:
            beyond = 1000 * (peaks.sway - isolation.capacity)
            said.append(f"isolators moved beyond their capacity: {building.name}, by {beyond:.3g} mm")
    for link, closing in zip(scene.links, links.max_closing.tolist(), strict=True):
        if not (closing > link.gap and link.law.beyond_gap):
            continue
        strikes = any(each.law.subtracts_gap and _floors(each) == _floors(link) for each in scene.links)
        if not (link.law.meaningless and strikes):
            left, right = scene.buildings[link.left].name, scene.buildings[link.left + 1].name
            beyond = 1000 * (closing - link.gap)
            said.append(f"{link.law.beyond_gap}: {left} | {right}, floor {link.left_floor}, by {beyond:.3g} mm")
    return tuple(said)


def is_meaningless(flag: str) -> bool:
    """Whether a flag takes the meaning from all numbers of its scene."""
    laws: tuple[type[LinkLaw], ...] = (*link_laws().values(), WrittenJoint)
    return flag.startswith(tuple(law.beyond_gap for law in laws if law.meaningless))
