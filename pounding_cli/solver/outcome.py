"""Outcomes of runs of one layout: peaks, energy balances, and flags of what the user should know about them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pounding_cli.laws import link_laws
from pounding_cli.laws.formula import WrittenJoint
from pounding_cli.laws.law import LinkLaw
from pounding_cli.model.meetings import face_each_other
from pounding_cli.model.scene import Scene
from pounding_cli.model.wall import Wall
from pounding_cli.solver import records
from pounding_cli.solver.layout import Layout
from pounding_cli.solver.records import Data
from pounding_cli.solver.response import COLLAPSED, DONE, OUTCOMES, STOREYS, Flag, peaks_type

Outcome = tuple[str, str]
"""How a run ended, in words, and what to do about it."""

ENDS: tuple[Outcome, ...] = (
    (DONE, ""),
    (COLLAPSED, ""),
    ("step bound reached", "a part of the scene is far stiffer than the rest: check stiffnesses and masses"),
    ("event bound reached", "the floors strike too often: check the stiffness and damping of the links"),
    ("stalled", "events repeat without advancing in time: check for links whose force jumps"),
    ("not finite", "the numbers exceed the range of double precision: check masses and stiffnesses"),
    ("no root", "Newton's method found no root, because a force jumps: use a method with events, e.g. taylor"),
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


def find_outcomes(data: Data, accuracy: float, residuals: np.ndarray) -> list[Outcome]:
    """Return how runs ended: none is done with numbers that are not finite, or an energy balance that does not close.

    residuals : of the energy balances [-], shape (runs,)
    """
    sums = [data.dofs[name].sum(axis=1) for name in ("u_max", "u_min", "a_max", "u0")]
    sums += [data.elements[name].sum(axis=1) for name in ("peak_v", "peak_f", "impulse", "time")]
    are_finite = np.isfinite(np.array(sums)).all(axis=0)
    are_closed = np.abs(residuals) <= max(accuracy, LEAST_RESIDUAL)
    ends = list[Outcome]()
    for status, is_finite, is_closed in zip(data.run["status"].tolist(), are_finite, are_closed, strict=True):
        end = ENDS[status]
        if end[0] in OUTCOMES and not is_finite:
            end = ENDS[records.NOT_FINITE]
        elif end[0] in OUTCOMES and not is_closed:
            end = OPEN_BALANCE
        ends.append(end)
    return ends


def build_peaks(layout: Layout, data: Data, scenes: Sequence[Scene], drift_at_rest: np.ndarray) -> np.ndarray:
    """Return the peaks of scenes, records of `peaks_type`, shape (scenes,).

    drift_at_rest : as of `rest.Rest`
    """
    storeys = [building.storeys for building in layout.buildings]
    lines = layout.most_lines
    peaks = np.full(len(scenes), np.nan, peaks_type(len(storeys), max(storeys), len(scenes[0].links), lines))
    for b in range(len(storeys)):
        _put_building(peaks, b, layout, data, drift_at_rest)
    _put_lines(peaks, layout, data, drift_at_rest)
    peaks["collapse_storey"] = 0.0
    links = data.elements[:, layout.of_links]
    peaks["impacts"] = links["hits"]
    peaks["peak_force"] = links["peak_f"]
    peaks["impulse"] = links["impulse"]
    peaks["max_closing"] = to_closings(layout, links["peak_v"], links["offset"])
    closes = [[link.law.can_act for link in scene.links] for scene in scenes]
    peaks["contact_time"] = np.where(closes, links["time"], 0.0)
    for k, struck in enumerate(layout.struck):
        below = data.columns["peak"][:, 2 * k]
        above = data.columns["peak"][:, 2 * k + 1]
        strength = struck.share * layout.buildings[struck.building].yield_shear[struck.storey - 1]
        peaks["shear_below"][:, struck.link] = below
        peaks["shear_above"][:, struck.link] = above
        if np.isfinite(strength):
            peaks["demand"][:, struck.link] = np.maximum(below, above) / strength
    return peaks


def to_closings(layout: Layout, deformation: np.ndarray, offset: np.ndarray) -> np.ndarray:
    """Return the closings u_left - u_right of the ends of links [m].

    deformation, offset : of their elements [m], shape (..., links)
    """
    return (deformation + offset) / layout.cosines


def _put_building(peaks: np.ndarray, b: int, layout: Layout, data: Data, drift_at_rest: np.ndarray) -> None:
    """Enter the peaks of a building; a wall does not yield, and one that moves as the ground does has none."""
    building = layout.buildings[b]
    reach = np.maximum(data.dofs["u_max"], -data.dofs["u_min"])
    for name, place in (("sway", layout.bases[b]), ("rocking", layout.feet[b])):
        peaks[name][:, b] = reach[:, place] if place >= 0 else 0.0
    if building.foundation is not None and building.foundation.isolation is not None:
        peaks["isolator_displacement"][:, b] = peaks["sway"][:, b]
    if isinstance(building, Wall) and not building.moves:
        return
    storeys = data.elements[:, layout.floors[b]]
    floors = data.dofs[:, layout.floors[b]]
    drift = storeys["peak_v"]
    found = (
        np.where(storeys["yields"] > 0, storeys["peak_f"], building.stiffness * drift), drift,
        np.nan if isinstance(building, Wall) else drift / building.yield_drift,
        floors["a_max"], floors["u_max"], floors["u_min"], drift_at_rest[:, layout.floors[b]],
    )  # fmt: skip
    for name, values in zip(STOREYS, found, strict=True):
        peaks[name][:, b, : building.storeys] = values


def _put_lines(peaks: np.ndarray, layout: Layout, data: Data, drift_at_rest: np.ndarray) -> None:
    """Enter the peaks of frame lines, of storeys that are sums over them, and of the rotations of floors.

    The ductility of a storey is that of its line along the row with the largest: the line whose demand governs.
    """
    elements = data.elements[:, layout.of_lines]
    for b in layout.sums:
        peaks["ductility"][:, b, : layout.buildings[b].storeys] = 0.0
    for place, (b, storey, number) in enumerate(layout.lines):
        plan = layout.buildings[b].plan
        e = elements[:, place]
        assert plan is not None
        line = plan.all_lines[number]
        elastic = line.stiffness[storey] * e["peak_v"]
        peaks["line_shear"][:, b, storey, number] = np.where(e["yields"] > 0, e["peak_f"], elastic)
        peaks["line_drift"][:, b, storey, number] = e["peak_v"]
        yield_drift = line.yield_shear[storey] / line.stiffness[storey]
        ductility = e["peak_v"] / yield_drift
        peaks["line_ductility"][:, b, storey, number] = ductility
        peaks["line_residual_drift"][:, b, storey, number] = drift_at_rest[:, layout.of_lines.start + place]
        if number < len(plan.lines):
            peaks["ductility"][:, b, storey] = np.maximum(peaks["ductility"][:, b, storey], ductility)
    first = 2 * len(layout.struck)
    for b in layout.sums:
        storeys = layout.buildings[b].storeys
        sums = data.columns[:, first : first + storeys]
        peaks["shear"][:, b, :storeys] = sums["peak"]
        peaks["edge_drift_low"][:, b, :storeys] = sums["peak_low"]
        peaks["edge_drift_high"][:, b, :storeys] = sums["peak_high"]
        turns = data.dofs[:, layout.turns[b]]
        peaks["twist"][:, b, :storeys] = np.maximum(turns["u_max"], -turns["u_min"])
        first += storeys


def compute_energy_of_lines(
    layout: Layout, deformation: np.ndarray, force: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the energy in frame lines, and of them in those that yield [J].

    deformation, force : drifts [m] and forces without dashpots [N], shape (..., lines)
    """
    elements = layout.elements[layout.of_lines]
    yields = elements["yields"] > 0
    stored = np.where(yields, 0.0, 0.5 * elements["p"][:, 0] * deformation**2)
    for place in np.flatnonzero(yields).tolist():
        b, storey, number = layout.lines[place]
        building = layout.buildings[b]
        assert building.plan is not None
        law = building.laws_of_line(building.plan.all_lines[number])[storey]
        stored[..., place] = law.stored_energy(deformation[..., place], force[..., place])
    return stored.sum(axis=-1), stored[..., yields].sum(axis=-1)


def compute_energy_of_storeys(
    layout: Layout, deformation: np.ndarray, force: np.ndarray, u: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the energy in storeys and foundations, and of them in storeys that yield [J].

    Potential energy that the weights have lost by P-Delta counts as negative.

    deformation, force, u : deformations [m], forces without dashpots [N] and displacements [m], shape (..., n)
    """
    elements = layout.elements[: layout.number]
    yields = elements["yields"] > 0
    stored = np.where(yields, 0.0, 0.5 * elements["p"][:, 0] * deformation**2)
    for b, building in enumerate(layout.buildings if yields.any() else ()):
        first = layout.floors[b].start
        laws = {first + j: building.laws[j] for j in np.flatnonzero(yields[layout.floors[b]]).tolist()}
        if building.isolators is not None:
            laws[layout.bases[b]] = building.isolators
        for place, law in laws.items():
            stored[..., place] = law.stored_energy(deformation[..., place], force[..., place])
    total = stored.sum(axis=-1)
    if elements["load"].any():
        below = np.concatenate((np.zeros((*u.shape[:-1], 1)), u[..., :-1]), axis=-1)
        total = total - 0.5 * np.sum(elements["load"] * (u - layout.dofs["below"] * below) ** 2, axis=-1)
    return total, stored[..., yields].sum(axis=-1)


def balance_energies(layout: Layout, data: Data, scenes: Sequence[Scene], before: float = 0.0) -> dict[str, np.ndarray]:
    """Return the energy balances of scenes by entry [J].

    `residual` is what is missing over the largest entry [-], or over what storeys held at their peaks if that is more:
    a run may have given back what it took in.

    input : work of the ground, plus what the scene held at the start (`before`)
    kinetic, stored, links_stored : held at the end
    damping, hysteresis, links : dissipated by structural and foundation dashpots, by yielding storeys, by the links
    """
    dofs = data.dofs
    elements = data.elements
    r = data.run
    n = layout.number
    storeys = elements[:, :n]
    of_links = elements[:, layout.of_links]
    stored, yielding = compute_energy_of_storeys(layout, storeys["v1"], compute_forces(storeys), dofs["u0"])
    lines = elements[:, layout.of_lines]
    in_lines, in_yielding_lines = compute_energy_of_lines(layout, lines["v1"], compute_forces(lines))
    in_links = _compute_energy_of_links(scenes, of_links)
    drags = elements["work"][:, n : layout.of_lines.start]
    entries = {
        "input": r["input"] + before,
        "kinetic": 0.5 * (dofs["mass"] * dofs["w"][..., 0] ** 2).sum(axis=1),
        "stored": stored + in_lines,
        "links_stored": in_links,
        "damping": r["drag"] + r["dashpots"] + drags.sum(axis=1),
        "hysteresis": storeys["work"].sum(axis=1) - yielding + lines["work"].sum(axis=1) - in_yielding_lines,
        "links": of_links["work"].sum(axis=1) - in_links,
    }
    values = np.array(list(entries.values()))
    held = _compute_energy_at_peaks(storeys) + _compute_energy_at_peaks(lines)
    scale = np.maximum(held, np.abs(values).max(axis=0))
    missing = values[0] - values[1:].sum(axis=0)
    return entries | {"residual": np.where(scale > 0, missing / scale, 0.0)}


def _compute_energy_at_peaks(storeys: np.ndarray) -> np.ndarray:
    """Return the elastic energies of storeys or frame lines at their largest forces [J], summed over each scene."""
    stiffness = storeys["p"][..., 0]
    peaks = np.where(storeys["yields"] > 0, storeys["peak_f"], stiffness * storeys["peak_v"])
    return np.asarray(0.5 * np.sum(peaks**2 / np.where(stiffness > 0, stiffness, np.inf), axis=1))


def compute_forces(storeys: np.ndarray) -> np.ndarray:
    """Return the forces of storeys at the end of a run, without dashpots [N]."""
    p = storeys["p"]
    z = storeys["h"][..., 0]
    smooth = (1.0 - p[..., 2]) * p[..., 0] * p[..., 1] * z  # of Bouc-Wen, the one law of storeys that is smooth
    return storeys["k"] * storeys["v1"] + storeys["f0"] + np.where(storeys["smooth"] > 0, smooth, 0.0)


def _compute_energy_of_links(scenes: Sequence[Scene], elements: np.ndarray) -> np.ndarray:
    """Return the energy in the links of scenes at the end of their runs [J]; a link that is open holds none."""
    total = np.zeros(len(scenes))
    for number, place in np.argwhere(elements["closed"]).tolist():
        e = elements[number, place]
        force = e["h"][0] if e["relaxation"] > 0 else e["k"] * e["v1"] + e["f0"]
        law = scenes[number].links[place].law
        total[number] += law.stored_energy(float(e["v1"] + e["offset"]), float(force))
    return total


def find_collapse(layout: Layout, elements: np.ndarray) -> tuple[int, int]:
    """Return building from 0 and storey from 1 of the storey that has drifted furthest over its collapse drift.

    Where floors twist the drift is that of one of its lines.
    """
    shares = elements["peak_v"] / elements["collapse"]
    parts = [shares[span].copy() for span in layout.floors]
    for (b, storey, _), share in zip(layout.lines, shares[layout.of_lines].tolist(), strict=True):
        parts[b][storey] = max(parts[b][storey], share)
    building = int(np.argmax([part.max() for part in parts]))
    return building, int(np.argmax(parts[building])) + 1


def put_collapse(peaks: np.void, layout: Layout, building: int, storey: int, time: float) -> None:
    """Enter into the peaks of a scene that a storey of a building collapsed, which ended all of it.

    building, storey, time : place from 0, storey from 1, and time [s]
    """
    peaks["collapse_storey"][building] = storey
    ends = [not isinstance(each, Wall) or each.moves for each in layout.buildings]
    peaks["collapse_time"][ends] = time


def build_collapse_flag(building: str, storey: int, time: float) -> Flag:
    """Return the flag of a storey of a building that collapsed, counted from 1, at a time [s]."""
    return Flag(COLLAPSED, f"{building} storey {storey}, at {time:.4g} s", severity=-time)  # the earlier, the worse


def list_flags(scene: Scene, peaks: np.void) -> tuple[Flag, ...]:
    """Return a flag for each base and each link that moved further than it can, and for floors that pass through.

    A base moves further than its isolators can, and a link is compressed beyond its thickness or its gap (paper, after
    eqs 9 and 10); the severity of the flag is how far beyond [m]. Where another link lets the floors strike, nothing is
    left out. The ends of a joint that are not as high as each other have no gap between them: there it is enough that
    links let these neighbours strike where they face each other.
    """
    flags = list[Flag]()
    for building, sway in zip(scene.buildings, peaks["sway"].tolist(), strict=True):
        isolation = None if building.foundation is None else building.foundation.isolation
        if isolation is not None and sway > isolation.capacity:
            beyond = sway - isolation.capacity
            detail = f"{building.name}, by {1000 * beyond:.3g} mm"
            flags.append(Flag("isolators moved beyond their capacity", detail, beyond))
    striking = [link for link in scene.links if link.law.subtracts_gap]
    striking_ends = {link.ends for link in striking}
    striking_pairs = {link.left for link in striking}
    for link, closing in zip(scene.links, peaks["max_closing"].tolist(), strict=True):
        if not (closing > link.gap and link.law.beyond_gap):
            continue
        left, right = scene.buildings[link.left : link.left + 2]
        lets_strike = link.ends in striking_ends
        if link.left in striking_pairs and not face_each_other(link, left, right):
            lets_strike = True
        if not (link.law.invalidates and lets_strike):
            beyond = closing - link.gap
            detail = f"{left.name} | {right.name}, floor {link.left_floor}, by {1000 * beyond:.3g} mm"
            flags.append(Flag(link.law.beyond_gap, detail, beyond))
    return (*flags, *list_passing_floors(scene, peaks))


PASSING_SHARE = 0.1
"""Part of a storey height by which floors may press into each other before they count as passing through [-]."""

PASSING = "floors pass through each other by more than a tenth of a storey height, as no contact does"
"""The flag of a scene where they do."""


def list_passing_floors(scene: Scene, peaks: np.void) -> list[Flag]:
    """Return a flag for each contact that closed its gap by more than `PASSING_SHARE` of a storey height.

    Parameters
    ----------
    peaks : record of `peaks_type` with the largest closing of every link [m]
    """
    flags = []
    for link, closing in zip(scene.links, peaks["max_closing"].tolist(), strict=True):
        if not link.law.subtracts_gap:
            continue
        left = scene.buildings[link.left]
        right = scene.buildings[link.left + 1]
        ends = ((left, link.left_floor), (right, link.right_floor))
        frames = [(building, floor) for building, floor in ends if not isinstance(building, Wall)]
        heights = [float(building.height[max(floor - 1, 0)]) for building, floor in frames]
        beyond = closing - link.gap
        if heights and beyond > PASSING_SHARE * min(heights):
            place = f"{left.name} | {right.name}, floor {link.left_floor}"
            flags.append(Flag(PASSING, f"{place}, by {1000 * beyond:.3g} mm", beyond))
    return flags


def is_meaningless(flag: str) -> bool:
    """Return whether a flag takes the meaning from all numbers of its scene."""
    laws: tuple[type[LinkLaw], ...] = (*link_laws().values(), WrittenJoint)
    return flag.startswith(tuple(law.beyond_gap for law in laws if law.invalidates))
