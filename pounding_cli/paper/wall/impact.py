"""One impact on the bumper wall: the plane-stress wall, the frame behind it, contact in time, what comes of it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise, product
from typing import Any

import numpy as np
import scipy.sparse as sp
from scipy.integrate import cumulative_trapezoid
from scipy.sparse.linalg import SuperLU, splu
from skfem import Basis, BilinearForm, FacetBasis, LinearForm, MeshQuad
from skfem.element import ElementQuad0, ElementQuad1, ElementQuad2, ElementVector
from skfem.models.elasticity import linear_elasticity

from pounding_cli.errors import InputError
from pounding_cli.paper.points import MESH, PointAnswer, build_variable
from pounding_cli.paper.wall.study import SectionSpec, WallStudySpec

MAX_ELEMENTS = 250_000
"""Elements of the mesh of the wall."""

MAX_WALL_STEPS = 200_000
"""Time steps of one impact."""

HISTORIES = {
    "time": ("s", "time"),
    "force": ("N", "contact force"),
    "position": ("m", "displacement of the striker"),
    "velocity": ("m/s", "velocity of the striker"),
    "indentation": ("m", "displacement of the wall under the striker"),
    "striker_energy": ("J", "kinetic energy of the striker"),
    "kinetic_energy": ("J", "kinetic energy of wall and frame"),
    "strain_energy": ("J", "strain energy of wall and frame"),
}
"""Quantities known at every instant: unit and meaning."""


def solve_impact(study: WallStudySpec) -> PointAnswer:
    """Return the answer of one impact: numbers, histories, stresses at the struck face and on the mesh of the wall.

    Raises InputError where it would take too many steps or gave a number that is not finite, with what to change.
    """
    system = build_system(study)
    end = study.time.end
    wished = find_time_step(system, study) if isinstance(study.time.step, str) else study.time.step
    if end / wished > MAX_WALL_STEPS:
        hint = f"give an earlier `time.end`, e.g. {MAX_WALL_STEPS / 10 * wished:.1g} s, or a heavier striker"
        raise InputError(f"an impact this short needs {end / wished:.0f} time steps", hint)
    steps = max(10, math.ceil(end / wished - 1e-9))
    history = list[tuple[float, ...]]()
    largest = dict[str, Any]()
    then = dict[str, Any]()
    at_peak = 0.0
    for instant, u in integrate_impact(system, study, steps):
        now = {name: each @ u for name, each in system.read.items()}
        now |= {name: compute_von_mises(now[name]) for name in ("elements", "cells")}
        if not history or now["elements"].max() > then["elements"].max():
            then = now
            at_peak = instant[0]
        largest = {name: np.maximum(np.abs(values), largest.get(name, 0.0)) for name, values in now.items()}
        history.append(instant)
    run = dict(zip(HISTORIES, np.array(history).T, strict=True))
    time = run["time"]
    force = run["force"]
    energy = run["striker_energy"] + run["kinetic_energy"] + run["strain_energy"]
    if not (np.isfinite(energy).all() and energy[0] > 0 and force.max() > 0):
        hint = "give speeds, masses and stiffnesses that differ by fewer powers of ten"
        raise InputError("the response is not finite, or too small to compute with", hint)
    off = float(np.abs(energy / energy[0] - 1).max())
    low, high = study.patch
    notes = []
    if study.contact.over == "patch" and high - low < study.contact.patch * (1 - 1e-9):
        notes.append(f"the patch ends with the wall: {high - low:.3g} m of {study.contact.patch:.3g} m touch")
    if force[-1] > 0 and study.contact.bond == "unilateral":
        notes.append(f"still in contact at {time[-1]:.3g} s: give a later `time.end`")
    if off > 5e-3:
        notes.append("the energy balance is open by more than 0.5 %: give a smaller `time.step`")
    averaged = largest["cells"]
    shear, moment = largest["rows"].reshape(-1, 2).max(axis=0)
    distance = np.abs(system.cell_height - 0.5 * (low + high))
    numbers = {
        "peak_force": force.max(),
        "peak_time": time[np.argmax(force)],
        "separation": find_separation_time(time, force),
        "last_contact": time[np.flatnonzero(force > 0)[-1]],
        "impulse": np.trapezoid(force, time),
        "energy_residual": off,
        "wall_stress": largest["elements"].max(),
        "averaged_stress": averaged.max(),
    }
    for name, members in (("beam", slice(system.beams)), ("column", slice(system.beams, None))):
        numbers[f"{name}_stress"] = largest["members"][members].max()
        numbers[f"{name}_stress_then"] = np.abs(then["members"][members]).max()
    numbers |= {
        "wall_shear": shear,
        "wall_moment": moment,
        "reach": interpolate_stress_reach(distance, averaged),
        "step": end / steps,
        "freedoms": system.M.size,
        "time_of_peak": at_peak,
    }
    corners = system.mesh.p.T[system.mesh.t.T]
    text = "largest von Mises stress of the mean stress in a cell"
    arrays = {
        "cell_height": build_variable("m", "height of a cell at the struck face", system.cell_height, "cell"),
        "cell_stress": build_variable("N/m2", text, averaged, "cell"),
        "outline": build_variable("m", "corners of every element", corners, *MESH),
    }
    for name, text, values in (
        ("stress_peak", "von Mises stress of every element at the peak", then["elements"]),
        ("stress_envelope", "largest von Mises stress of every element", largest["elements"]),
    ):
        arrays[name] = build_variable("N/m2", text, values, "element")
    arrays |= {name: build_variable(*HISTORIES[name], values, "instant") for name, values in run.items()}
    return PointAnswer({name: float(number) for name, number in numbers.items()}, arrays, notes)


def compute_von_mises(stress: np.ndarray) -> np.ndarray:
    """Return the von Mises stress in plane stress [N/m2], shape (n,).

    stress : (s_x, s_y, t_xy) in turns [N/m2], shape (3 n,)
    """
    sx, sy, t = stress.reshape(-1, 3).T
    return np.sqrt(sx**2 - sx * sy + sy**2 + 3 * t**2)


def interpolate_stress_reach(distance: np.ndarray, stress: np.ndarray) -> float:
    """Return the farthest distance at which the stress is half its largest [m], on straight lines between the cells."""
    half = 0.5 * stress.max()
    ends = [float(distance[stress >= half].max())]
    for i in np.flatnonzero((stress[1:] >= half) != (stress[:-1] >= half)):
        share = (half - stress[i]) / (stress[i + 1] - stress[i])
        ends.append(float(distance[i] + share * (distance[i + 1] - distance[i])))
    return max(ends)


def find_separation_time(time: np.ndarray, force: np.ndarray) -> float:
    """Return the first time at which the force is positive no more [s]; NaN if it stays positive.

    It lies on a straight line between two steps.
    """
    pushed = np.flatnonzero(force > 0)
    free = np.flatnonzero(force[pushed[0] :] <= 0) if pushed.size else pushed
    if free.size == 0:
        return math.nan
    n = pushed[0] + free[0]
    before = force[n - 1]
    after = force[n]
    # Cut off at zero, the force goes on falling as in the step before, but not beyond the step.
    fall = before - after if after < 0 else max(force[n - 2] - before, before)
    return float(time[n - 1] + (time[n] - time[n - 1]) * before / fall)


def factorize(matrix: sp.csc_matrix) -> SuperLU:
    """Return the factors of a symmetric positive definite matrix.  Raises InputError: it is singular to rounding."""
    options = {"SymmetricMode": True}
    try:
        return splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)
    except RuntimeError:
        hint = "give lengths, masses and stiffnesses that differ by fewer powers of ten"
        raise InputError("the stiffness matrix is singular", hint) from None


def find_time_step(system: System, study: WallStudySpec) -> float:
    """Return a time step that leaves force and energy with errors below 1e-3 [s].

    A 100th of the striker's half period on the wall, pi / s, at most 0.1 ms; s^2 = 1 / (m C(s)) with the
    compliance C(s) = p (K + s^2 M)^-1 p, since a light striker feels floors too heavy to follow it. Where the
    wall has mass of its own, waves cross no more than half an element in a step.
    docs/wall.md has the errors against the step.
    """
    s = 0.0
    concrete = study.concrete
    for _ in range(3):
        give = float(system.p @ factorize(system.K + sp.diags_array(s**2 * system.M)).solve(system.p))
        s = 1 / math.sqrt(study.striker.mass * give)
    step = min(1e-4, math.pi / s / 100)
    if concrete.density > 0:
        speed = math.sqrt(concrete.young / concrete.density / (1 - concrete.poisson**2))
        step = min(step, 0.5 * study.mesh.size / speed)
    return step


def integrate_impact(
    system: System, study: WallStudySpec, steps: int
) -> Iterator[tuple[tuple[float, ...], np.ndarray]]:
    """Yield the values of HISTORIES and the displacements at the beginning and after every step.

    Wood-Bossak-Zienkiewicz alpha method (1980); forces balance at the end of each step:
    alpha_m = (rho - 1) / (rho + 1), gamma = 1/2 - alpha_m, beta = (1 - alpha_m)^2 / 4; rho = 1 is Newmark's
    average acceleration. Second order; freedoms without mass are in static equilibrium at every step.
    The striker is the last freedom, a mass without stiffness. With g.u = x - p.u the closing, the contact force
    enters as -g F, so a step is that without contact plus F times one fixed vector, and

        F >= 0, gap >= 0, F gap = 0   (unilateral)        or        gap = 0   (glued)

    is one scalar equation: no state to switch, no second factorisation. The struck freedoms carry no mass,
    so the force begins at zero and nothing is lost when the contact closes.
    """
    h = study.time.end / steps
    am = (study.time.rho - 1) / (study.time.rho + 1)
    gamma = 0.5 - am
    beta = 0.25 * (1 - am) ** 2
    inertia = (1 - am) / (beta * h**2)
    stiffness = sp.block_diag([system.K, [[0.0]]], format="csc")
    mass = np.append(system.M, study.striker.mass)
    closing = np.append(-system.p, 1.0)
    force = 0.0
    factor = factorize(stiffness + sp.diags_array(inertia * mass))
    answer = factor.solve(closing)
    u, v, a = (np.zeros(mass.size) for _ in range(3))
    v[-1] = study.striker.speed
    for n in range(steps + 1):
        if n > 0:
            guess = u + h * v + (0.5 - beta) * h**2 * a
            u = factor.solve(mass * (inertia * guess - am * a))
            force = float(closing @ u / (closing @ answer))
            if study.contact.bond == "unilateral":
                force = max(force, 0.0)
            u -= force * answer
            before = a
            a = (u - guess) / (beta * h**2)
            v = v + h * ((1 - gamma) * before + gamma * a)
        kinetic = 0.5 * mass * v**2
        energies = kinetic[-1], kinetic[:-1].sum(), 0.5 * float(u @ (stiffness @ u))
        yield (n * h, force, u[-1], v[-1], float(system.p @ u[:-1]), *energies), u[:-1]


# The equations of motion


@dataclass(frozen=True, eq=False)
class System:
    """Equations of motion K u + M u'' = p F over the n free displacements and rotations, and what is read from u.

    K : stiffness [N/m], sparse (n, n); M : lumped masses [kg], shape (n,), zero where there is none
    p : shares of the contact force [-], shape (n,): p.u is the displacement that works with the force
    beams : how many of the edge stresses below are of beams; cell_height : of the centres of cells [m]
    read : sparse (..., n), by name:
        members : edge stresses of beams, then of columns [N/m3], four a member
        elements : mean (s_x, s_y, t_xy) of each element [N/m3], rows grouped by three
        cells : the same of square cells at the struck face, of side `averaging_length`
        rows : shear force and moment of each row of elements, mean over its height
    """

    mesh: MeshQuad
    K: sp.csc_matrix
    M: np.ndarray
    p: np.ndarray
    beams: int
    cell_height: np.ndarray
    read: dict[str, sp.csr_matrix]


def build_system(study: WallStudySpec) -> System:
    """Return the plane-stress wall and the frame coupled at the floors; the base is fixed.

    Raises InputError where there are too many elements.
    """
    low, high = study.patch
    floors = study.frame.floors
    breaks = sorted({0.0, *floors, low, high})
    breaks = [y for place, y in enumerate(breaks) if place == 0 or y - breaks[place - 1] > 1e-9]
    x = _build_grid_lines([0.0, study.wall.length], study, (0.0, 0.0))
    y = _build_grid_lines(breaks, study, (low, high))
    if x.size * y.size > MAX_ELEMENTS:
        raise InputError(f"a mesh of more than {MAX_ELEMENTS} elements", "give a larger `mesh.size`, or `growth: 0.2`")
    mesh = MeshQuad.init_tensor(x, y)
    linear = study.mesh.element == "linear"
    basis = Basis(mesh, ElementVector(ElementQuad1() if linear else ElementQuad2()), intorder=2 if linear else 4)
    wall = basis.N
    thickness = study.wall.thickness
    young = study.concrete.young
    nu = study.concrete.poisson
    # Plane stress has the Lame parameters E nu / (1 - nu^2) and E / (2 (1 + nu)).
    elasticity = linear_elasticity(young * nu / (1 - nu**2), young / (2 * (1 + nu)))
    frame, members, mass = _build_frame(study, basis)
    total = mass.size
    stiffness = frame + sp.block_diag([thickness * elasticity.assemble(basis), sp.csr_matrix((total - wall,) * 2)])
    mass[:wall] += study.concrete.density * thickness * LinearForm(lambda v, _: v[0] + v[1]).assemble(basis)
    push = np.zeros(total)
    push[:wall] = _build_contact(study, basis, mass[:wall])
    elements, rows = _build_stresses(study, basis, y)
    height, share = _build_cells(study, mesh)
    free = np.setdiff1d(np.arange(total), basis.get_dofs(lambda at: np.abs(at[1]) < 1e-9).all())
    pick = sp.eye_array(total, format="csr")[:, free]
    read = {"elements": elements, "cells": sp.kron(share, sp.eye_array(3)) @ elements, "rows": rows}
    read = {name: (each @ pick[:wall]).tocsr() for name, each in read.items()} | {"members": (members @ pick).tocsr()}
    beams = 4 * len(study.frame.bays) * study.frame.storeys
    return System(mesh, (pick.T @ stiffness @ pick).tocsc(), mass[free], push[free], beams, height, read)


def _build_grid_lines(breaks: list[float], study: WallStudySpec, centre: tuple[float, float]) -> np.ndarray:
    """Return the positions of mesh lines [m]: every break is one; between two, intervals of at most the wished size.

    The wished size at a distance r from the interval `centre` is size + growth * r [m].
    """
    lines = [breaks[0]]
    for low, high in pairwise(breaks):
        fine = np.linspace(low, high, 400)
        distance = np.maximum(np.maximum(centre[0] - fine, fine - centre[1]), 0.0)
        density = 1.0 / (study.mesh.size + study.mesh.growth * distance)
        count = cumulative_trapezoid(density, fine, initial=0.0)
        pieces = max(1, int(np.ceil(min(count[-1], MAX_ELEMENTS) - 1e-9)))  # of more the mesh is refused
        lines.extend(np.interp(np.linspace(0, count[-1], pieces + 1)[1:-1], count, fine))
        lines.append(high)
    return np.array(lines)


def _integrate_edges(basis: Basis, left: float, low: float, high: float, part: int = 0) -> np.ndarray:
    """Return the integrals of the displacements over the edges with middles at x < `left` between two heights [m].

    part : 0 for displacements in x, 1 in y
    """
    x, y = basis.mesh.p[:, basis.mesh.facets].mean(axis=1)
    facets = np.flatnonzero((x < left) & (y > low) & (y < high))
    return LinearForm(lambda v, _: v[part]).assemble(FacetBasis(basis.mesh, basis.elem, facets=facets))


def _build_contact(study: WallStudySpec, basis: Basis, mass: np.ndarray) -> np.ndarray:
    """Return the shares of the contact force over the wall's displacements [-]: one node, or a uniform pressure; sum 1.

    The horizontal mass of the struck nodes is handed to their neighbours, in place: a struck node with mass would have
    to change its speed at once, the contact force would ring at every step and the energy would not close (Khenous,
    Laborde and Renard 2008). What is moved vanishes with the mesh.
    """
    low, high = study.patch
    horizontal = basis.get_dofs(elements=np.arange(basis.mesh.nelements)).all(["u^1"])
    if study.contact.over == "node":
        nodes = basis.get_dofs(lambda at: at[0] < 1e-9).all(["u^1"])
        shares = np.zeros(basis.N)
        shares[nodes[np.argmin(np.abs(basis.doflocs[1, nodes] - study.height))]] = 1.0
    else:
        shares = _integrate_edges(basis, 1e-9, low, high) / (high - low)
    struck = np.flatnonzero(shares)
    beside = basis.element_dofs[:, np.isin(basis.element_dofs, struck).any(axis=0)]
    around = np.setdiff1d(np.intersect1d(beside, horizontal), struck)
    mass[around] += mass[struck].sum() / around.size
    mass[struck] = 0.0
    return shares


def _build_frame(study: WallStudySpec, basis: Basis) -> tuple[sp.csr_matrix, sp.csr_matrix, np.ndarray]:
    """Return the stiffness of the frame, the edge stresses of its members, and the masses of the floors.

    All are over all displacements: the wall's come first, then (u, v, theta) of every column at every floor. A beam's
    end at the wall follows the weighted mean of the floor line (a distributing coupling): it carries force and moment
    into the whole line without stiffening it, so it has a limit as the mesh is refined.
    """
    frame = study.frame
    length = study.wall.length
    lines = len(study.frame.bays)
    x = length + np.concatenate([[0.0], np.cumsum(frame.bays)])
    y = np.append(0.0, frame.floors)
    # Every point of a floor belongs to the nearer end of its beam; the wall's own length to the wall.
    tributary = np.convolve(np.diff(x), [0.5, 0.5])
    tributary[0] += length
    floor_mass = frame.floor_mass * tributary / x[-1]
    total = basis.N + 3 * lines * frame.storeys
    stiffness = sp.csr_matrix((total, total))
    stresses = []
    mass = np.zeros(total)
    # Motions (u, v, theta) of joints from all displacements, by floor and line: line 0 is the wall's, floor 0 is fixed.
    joints = {(0, line): sp.csr_matrix((3, total)) for line in range(1, lines + 1)}
    for floor in range(1, frame.storeys + 1):
        across, up = (_integrate_edges(basis, np.inf, y[floor] - 1e-9, y[floor] + 1e-9, part) for part in (0, 1))
        across = across / across.sum()
        up = up / up.sum()
        at = basis.doflocs[0]
        mass[: basis.N] += floor_mass[0] * (across + up)
        tilt = up * (at - up @ at) / (up @ (at - up @ at) ** 2)
        motion = np.array([across, up + tilt * (length - up @ at), tilt])
        joints[floor, 0] = sp.csr_matrix(np.pad(motion, ((0, 0), (0, total - basis.N))))
        for line in range(1, lines + 1):
            start = basis.N + 3 * (line - 1 + lines * (floor - 1))
            joints[floor, line] = sp.eye_array(3, total, k=start, format="csr")
            mass[start : start + 2] += floor_mass[line]
    floors = range(1, frame.storeys + 1)
    beams = [((floor, line), (floor, line + 1), frame.beam) for floor, line in product(floors, range(lines))]
    columns = [((floor - 1, line), (floor, line), frame.column) for floor, line in product(floors, range(1, lines + 1))]
    for one, other, section in beams + columns:
        along = np.array([x[other[1]] - x[one[1]], y[other[0]] - y[one[0]]])
        deformation, resistance = _build_member(study.concrete.young, section, along)
        deformed = sp.csr_matrix(deformation) @ sp.vstack([joints[one], joints[other]], format="csr")
        stiffness = stiffness + deformed.T @ sp.csr_matrix(resistance) @ deformed
        # Edge stresses N/A +- M/W at both ends: the moment of a member loaded at its ends alone is linear.
        area = section.width * section.depth
        modulus = section.width * section.depth**2 / 6
        axial, *moments = resistance / [[area], [modulus], [modulus]]
        edges = [axial + sign * moment for moment in moments for sign in (1, -1)]
        stresses.append(sp.csr_matrix(np.array(edges)) @ deformed)
    return stiffness, sp.vstack(stresses, format="csr"), mass


def _build_member(young: float, section: SectionSpec, along: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the deformations of an Euler-Bernoulli member and the forces that resist them.

    The first are elongation and rotations of its ends against the chord, from their displacements (u, v, theta), shape
    (3, 6); the second axial force and end moments from those, shape (3, 3).

    along : from one end to the other [m]
    """
    length = float(np.hypot(*along))
    area = section.width * section.depth
    inertia = section.width * section.depth**3 / 12
    c, s = along / length
    chord = np.array([s, -c, 0.0, -s, c, 0.0]) / length
    deformation = np.vstack([[-c, -s, 0.0, c, s, 0.0], np.eye(6)[[2, 5]] - chord])
    resistance = [[area, 0.0, 0.0], [0.0, 4 * inertia, 2 * inertia], [0.0, 2 * inertia, 4 * inertia]]
    return deformation, young / length * np.array(resistance)


def _build_stresses(study: WallStudySpec, basis: Basis, y_lines: np.ndarray) -> tuple[sp.csr_matrix, sp.csr_matrix]:
    """Return the mean stresses of elements and the resultants of the rows of elements: as in `System`.

    The mean of an element's stress, not a corner's extrapolation, is what is reported: for four nodes it is the stress
    at the centre, which NASTRAN's CQUAD4 prints.
    """
    young = study.concrete.young
    nu = study.concrete.poisson
    factor = young / (1 - nu**2)
    shear = young / (2 * (1 + nu))
    each = basis.with_element(ElementQuad0())

    def integrate(stress) -> sp.csr_matrix:
        """Return the integral of a stress over each element."""
        return BilinearForm(lambda u, v, w: stress(u.grad, w.x) * v).assemble(basis, each)

    sx = integrate(lambda g, x: factor * (g[0, 0] + nu * g[1, 1]))
    sy = integrate(lambda g, x: factor * (g[1, 1] + nu * g[0, 0]))
    txy = integrate(lambda g, x: shear * (g[0, 1] + g[1, 0]))
    bending = integrate(lambda g, x: factor * (g[1, 1] + nu * g[0, 0]) * (study.wall.length / 2 - x[0]))
    area = LinearForm(lambda v, _: v).assemble(each)

    def group_rows(parts: list[sp.csr_matrix]) -> sp.csr_matrix:
        rows = np.arange(len(parts) * parts[0].shape[0]).reshape(len(parts), -1).T.ravel()
        return sp.vstack(parts, format="csr")[rows]

    elements = sp.kron(sp.diags_array(1 / area), sp.eye_array(3)) @ group_rows([sx, sy, txy])
    middle = basis.mesh.p[1, basis.mesh.t].mean(axis=0)
    row = np.searchsorted(y_lines, middle) - 1
    count = middle.size
    depth = study.wall.thickness / np.diff(y_lines)[row]
    gather = sp.csr_matrix((depth, (row, np.arange(count))), shape=(y_lines.size - 1, count))
    # Shear that pushes the part above away from the striker, moment that compresses the inner edge.
    return elements, group_rows([gather @ txy, gather @ bending])


def _build_cells(study: WallStudySpec, mesh: MeshQuad) -> tuple[np.ndarray, sp.csr_matrix]:
    """Return the heights of cells [m], and the share of each cell's area that lies in each element [-].

    Cells are squares every quarter side up the face, one of them centred on the contact where there is room; the
    heights are those of their centres, the shares sparse (cells, elements).
    """
    side = study.averaging_length
    top = study.frame.height
    centre = np.clip(0.5 * sum(study.patch), side / 2, top - side / 2)
    below = np.arange(centre, side / 2 - 1e-9, -side / 4)[::-1]
    height = np.concatenate([below, np.arange(centre, top - side / 2 + 1e-9, side / 4)[1:]])
    near = np.flatnonzero(mesh.p[0, mesh.t].min(axis=0) < side)
    corners = mesh.p[:, mesh.t[:, near]]
    x0, y0 = corners.min(axis=1)
    x1, y1 = corners.max(axis=1)
    tall = np.minimum(y1, (height + side / 2)[:, None]) - np.maximum(y0, (height - side / 2)[:, None])
    share = (np.minimum(x1, side) - x0) * np.clip(tall, 0, None)
    pick = sp.eye_array(mesh.t.shape[1], format="csr")[near]
    return height, sp.csr_matrix(share / share.sum(axis=1, keepdims=True)) @ pick
