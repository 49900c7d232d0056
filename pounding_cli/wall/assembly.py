"""Stiffness, mass and contact vectors of wall and frame together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from pounding_cli.wall.frame import edge_stress_rows, local_stiffness, rotation
from pounding_cli.wall.mesh import WallMesh
from pounding_cli.wall.model import Concrete, Over, WallModel


@dataclass(frozen=True, eq=False)
class System:
    """Equations of motion K u + M u'' = p F over the free freedoms: wall nodes first, then column nodes.

    K : stiffness [N/m], sparse (n, n); M : lumped masses [kg], shape (n,), zero for massless freedoms;
    p : shares of the contact force [-], shape (n,): p.u is the displacement that works with the force;
    spread : from the free freedoms to all of the wall's nodal displacements, sparse (2 nodes, n);
    members : from the free freedoms to the edge stresses of beams and columns [N/m3], sparse (4 members, n);
    beams : how many members, the first ones, are beams
    """

    K: sp.csc_matrix
    M: np.ndarray
    p: np.ndarray
    spread: sp.csr_matrix
    members: sp.csr_matrix
    beams: int


def plane_stress(concrete: Concrete) -> np.ndarray:
    """Plane-stress matrix from (e_x, e_y, gamma_xy) to (s_x, s_y, t_xy) [N/m2], shape (3, 3)."""
    nu = concrete.poisson
    return concrete.young / (1 - nu**2) * np.array([[1, nu, 0], [nu, 1, 0], [0, 0, (1 - nu) / 2]])


def wall_stiffness(wall: WallMesh, concrete: Concrete) -> sp.csr_matrix:
    """Stiffness of the wall over all its nodal displacements [N/m], sparse (2 n, 2 n)."""
    b, area = wall.gradients(wall.basis)
    d = sp.kron(sp.diags_array(area * wall.thickness), plane_stress(concrete), format="csr")
    return (b.T @ d @ b).tocsr()


def wall_end(wall: WallMesh, y: float, x_end: float, columns: int) -> sp.csr_matrix:
    """Motion (u, v, theta) of a beam's end at the wall from the floor line's nodes, sparse (3, columns).

    The weighted mean of the line: it carries the beam's end force and moment into the whole line without
    stiffening it (a distributing coupling), so it has a limit as the mesh is refined.
    """
    nodes, share = wall.on_line(y)
    x = wall.nodes[0, nodes]
    arm = x - share @ x
    tilt = share * arm / (share @ arm**2)
    rows = np.zeros((3, columns))
    rows[0, 2 * nodes] = share
    rows[2, 2 * nodes + 1] = tilt
    rows[1, 2 * nodes + 1] = share + tilt * (x_end - share @ x)
    return sp.csr_matrix(rows)


def assemble(model: WallModel, wall: WallMesh) -> System:
    """Couple the plane-stress wall and the frame at the floors; base fixed."""
    frame, young = model.frame, model.concrete.young
    wall_dofs = 2 * wall.nodes.shape[1]
    lines = len(frame.bays)
    total = wall_dofs + 3 * lines * frame.storeys

    def column_node(line: int, floor: int) -> sp.csr_matrix:
        start = wall_dofs + 3 * (line + lines * (floor - 1))
        if floor == 0:
            return sp.csr_matrix((3, total))
        return sp.csr_matrix((np.ones(3), (np.arange(3), start + np.arange(3))), shape=(3, total))

    mass = np.zeros(total)
    mass[:wall_dofs] = np.repeat(model.concrete.density * wall.volume(), 2)
    stress_rows = []
    pieces = []

    def member(ends, motions, section):
        turn, length = rotation(*ends)
        motion = sp.vstack(motions, format="csr")
        pieces.append(motion.T @ sp.csr_matrix(turn.T @ local_stiffness(young, section, length) @ turn) @ motion)
        stress_rows.append(sp.csr_matrix(edge_stress_rows(young, section, length) @ turn) @ motion)

    x = model.length + np.concatenate([[0.0], frame.columns])
    # Every point of a floor belongs to the nearer end of its beam; the wall's own length to the wall.
    tributary = np.convolve(np.diff(x), [0.5, 0.5])
    tributary[0] += model.length
    share = tributary / x[-1]
    for floor, y in enumerate(frame.floors, 1):
        motions = [wall_end(wall, y, model.length, total), *(column_node(i, floor) for i in range(lines))]
        for i in range(lines):
            member(((x[i], y), (x[i + 1], y)), (motions[i], motions[i + 1]), frame.beam)
        nodes, weight = wall.on_line(y)
        for axis in (0, 1):
            mass[2 * nodes + axis] += frame.floor_mass * share[0] * weight
            for i in range(lines):
                mass[wall_dofs + 3 * (i + lines * (floor - 1)) + axis] += frame.floor_mass * share[i + 1]
    beams = len(pieces)
    for floor, y in enumerate(frame.floors, 1):
        for i in range(lines):
            ends = ((x[i + 1], y - frame.storey_height), (x[i + 1], y))
            member(ends, (column_node(i, floor - 1), column_node(i, floor)), frame.column)
    whole = wall_stiffness(wall, model.concrete)
    whole.resize((total, total))
    stiffness = sum(pieces, start=whole)

    push = np.zeros(total)
    push[:wall_dofs:2] = _contact_shares(model, wall)
    _free_of_mass(mass, wall, push)
    fixed = np.flatnonzero(np.abs(wall.nodes[1]) < 1e-9)
    free = np.setdiff1d(np.arange(total), np.concatenate([2 * fixed, 2 * fixed + 1]))
    pick = sp.eye_array(total, format="csr")[:, free]
    return System(
        K=(pick.T @ stiffness @ pick).tocsc(),
        M=mass[free],
        p=push[free],
        spread=pick[:wall_dofs].tocsr(),
        members=(sp.vstack(stress_rows) @ pick).tocsr(),
        beams=beams,
    )


def _free_of_mass(mass: np.ndarray, wall: WallMesh, push: np.ndarray) -> None:
    """Hand the horizontal mass of the struck nodes to their neighbours, in place.

    A struck node with mass would have to change its speed at once: the contact force would ring at every step
    and the energy would not close (Khenous, Laborde and Renard 2008). What is moved vanishes with the mesh.
    """
    dofs = wall.basis.element_dofs
    struck = np.flatnonzero(push[: 2 * wall.nodes.shape[1] : 2])
    around = np.setdiff1d(dofs[:, np.isin(dofs, struck).any(axis=0)], struck)
    mass[2 * around] += mass[2 * struck].sum() / around.size
    mass[2 * struck] = 0.0


def _contact_shares(model: WallModel, wall: WallMesh) -> np.ndarray:
    """Shares of the contact force over the wall's nodes [-], shape (n,)."""
    low, high = model.patch
    if model.contact.over is Over.PATCH:
        return wall.pressure(low, high)
    distance = np.hypot(wall.nodes[0], wall.nodes[1] - model.striker.height)
    shares = np.zeros(wall.nodes.shape[1])
    shares[np.argmin(distance)] = 1.0
    return shares
