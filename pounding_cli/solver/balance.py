"""The energies of scenes at the end of their runs, and whether they balance."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pounding_cli.model.scene import Scene
from pounding_cli.solver.layout import Layout
from pounding_cli.solver.records import Data


def balance_energies(layout: Layout, data: Data, scenes: Sequence[Scene], before: float = 0.0) -> dict[str, np.ndarray]:
    """Return the energy balances of scenes by entry [J].

    `residual` is what is missing over the largest entry [-], or over what storeys held at their peaks if that is more:
    a run may have given back what it took in.

    input : work of the ground, plus what the scene held at the start (`before`)
    kinetic, stored, links_stored : held at the end
    damping, hysteresis, links : dissipated by structural and foundation dashpots, by yielding storeys, by the links
    """
    dofs = data.dofs
    runs = data.run
    storeys = data.elements[:, : layout.number]
    drags = data.elements[:, layout.number : layout.of_lines.start]
    lines = data.elements[:, layout.of_lines]
    links = data.elements[:, layout.of_links]
    stored, yielding = compute_energy_of_storeys(layout, storeys["v1"], compute_forces(storeys), dofs["u0"])
    in_lines, in_yielding_lines = compute_energy_of_lines(layout, lines["v1"], compute_forces(lines))
    in_links = _compute_energy_of_links(scenes, links)
    entries = {
        "input": runs["input"] + before,
        "kinetic": 0.5 * (dofs["mass"] * dofs["w"][..., 0] ** 2).sum(axis=1),
        "stored": stored + in_lines,
        "links_stored": in_links,
        "damping": runs["drag"] + runs["dashpots"] + drags["work"].sum(axis=1),
        "hysteresis": storeys["work"].sum(axis=1) - yielding + lines["work"].sum(axis=1) - in_yielding_lines,
        "links": links["work"].sum(axis=1) - in_links,
    }
    values = np.array(list(entries.values()))
    held = _compute_energy_at_peaks(storeys) + _compute_energy_at_peaks(lines)
    scale = np.maximum(held, np.abs(values).max(axis=0))
    missing = values[0] - values[1:].sum(axis=0)
    return entries | {"residual": np.where(scale > 0, missing / scale, 0.0)}


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
    for number, building in enumerate(layout.buildings if yields.any() else ()):
        floors = layout.floors[number]
        laws = {floors.start + j: building.laws[j] for j in np.flatnonzero(yields[floors]).tolist()}
        if building.isolators is not None:
            laws[layout.bases[number]] = building.isolators
        for place, law in laws.items():
            stored[..., place] = law.stored_energy(deformation[..., place], force[..., place])
    total = stored.sum(axis=-1)
    if elements["load"].any():
        below = np.concatenate((np.zeros((*u.shape[:-1], 1)), u[..., :-1]), axis=-1)
        total = total - 0.5 * np.sum(elements["load"] * (u - layout.dofs["below"] * below) ** 2, axis=-1)
    return total, stored[..., yields].sum(axis=-1)


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
        number, storey, line_number = layout.lines[place]
        building = layout.buildings[number]
        assert building.plan is not None
        law = building.laws_of_line(building.plan.all_lines[line_number])[storey]
        stored[..., place] = law.stored_energy(deformation[..., place], force[..., place])
    return stored.sum(axis=-1), stored[..., yields].sum(axis=-1)


def _compute_energy_of_links(scenes: Sequence[Scene], elements: np.ndarray) -> np.ndarray:
    """Return the energy in the links of scenes at the end of their runs [J]; a link that is open holds none."""
    total = np.zeros(len(scenes))
    for number, place in np.argwhere(elements["closed"]).tolist():
        element = elements[number, place]
        force = element["h"][0] if element["relaxation"] > 0 else element["k"] * element["v1"] + element["f0"]
        law = scenes[number].links[place].law
        total[number] += law.stored_energy(float(element["v1"] + element["offset"]), float(force))
    return total


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
