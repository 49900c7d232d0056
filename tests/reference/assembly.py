"""Coordinates and constant matrices of a scene, assembled from the paper's equations (1)-(4)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pounding_cli import Scene


@dataclass(frozen=True)
class Coordinates:
    """Where each displacement stands in q, and what it takes to get drifts and closings from q.

    floors : per building, indices of u_1 .. u_n in q
    drift : all storeys of all buildings from all coordinates, shape (storeys, N)
    closing : u_left - u_right of every link, of an inclined one times the cosine of its angle, shape (links, N)
    cosine : of the angle of every link, (links,)
    mass, damping : M (diagonal entries, (N,)) and C of buildings and foundations without the links, (N, N)
    springs : foundation springs, and the weights that lean on the columns (P-Delta), (N, N)
    loaded : -a_g loaded is the force of the ground, (N,)
    stiffness, yield_drift, hardening : of every storey, in the order of `drift`
    """

    floors: list[np.ndarray]
    drift: np.ndarray
    closing: np.ndarray
    cosine: np.ndarray
    mass: np.ndarray
    damping: np.ndarray
    springs: np.ndarray
    loaded: np.ndarray
    stiffness: np.ndarray
    yield_drift: np.ndarray
    hardening: np.ndarray


def coordinates(scene: Scene) -> Coordinates:
    """q = for each building u_1 .. u_n, then u_b if it sways, then phi_b if it rocks."""
    total = 0
    floors, bases, turns = [], [], []
    for b in scene.buildings:
        floors.append(np.arange(total, total + b.storeys))
        total += b.storeys
        sways = b.foundation is not None and b.foundation.sways
        rocks = b.foundation is not None and b.foundation.rocks
        bases.append(total if sways else None)
        total += int(sways)
        turns.append(total if rocks else None)
        total += int(rocks)

    mass, loaded = np.zeros(total), np.zeros(total)
    springs, damping = np.zeros((total, total)), np.zeros((total, total))
    rows = []
    for b, at, base, turn in zip(scene.buildings, floors, bases, turns, strict=True):
        mass[at] = loaded[at] = b.mass
        deformation = np.zeros((b.storeys, total))  # delta_j = u_j - u_b - h_j phi_b, eq. (1)
        deformation[np.arange(b.storeys), at] = 1.0
        if base is not None:
            f = b.foundation
            mass[base] = loaded[base] = f.mass
            springs[base, base], damping[base, base] = f.sway_stiffness, f.sway_damping
            deformation[:, base] = -1.0
        if turn is not None:
            f = b.foundation
            mass[turn] = f.inertia
            springs[turn, turn], damping[turn, turn] = f.rocking_stiffness, f.rocking_damping
            deformation[:, turn] = -np.cumsum(b.height)
        storeys = deformation.copy()
        storeys[1:] -= deformation[:-1]
        rows.append(storeys)
        if b.gravity_load is not None:
            above = np.eye(total)[at]
            below = np.vstack((np.zeros(total) if base is None else np.eye(total)[base], above[:-1]))
            for load, h, lean in zip(b.gravity_load, b.height, above - below, strict=True):
                springs -= load / h * np.outer(lean, lean)  # the top of a column is lower by lean^2 / (2 h)
        fixed = sum(k * np.outer(r, r) for k, r in zip(b.stiffness, storeys[:, at], strict=True))
        rayleigh = b.alpha * np.diag(b.mass) + b.beta * fixed  # eq. (4), on the deformations of eq. (2)
        damping += deformation.T @ rayleigh @ deformation

    closing = np.zeros((len(scene.links), total))
    for e, link in enumerate(scene.links):
        for place, floor, at, sign in (
            (link.left, link.left_floor, link.left_at, 1.0),
            (link.left + 1, link.right_floor, link.right_at, -1.0),
        ):
            closing[e] += sign * _column(
                scene.buildings[place], floors[place], bases[place], turns[place], floor, at, total
            )
    cosine = np.array([link.cosine for link in scene.links])
    return Coordinates(
        floors,
        np.vstack(rows),
        closing * cosine[:, None],
        cosine,
        mass,
        damping,
        springs,
        loaded,
        np.concatenate([b.stiffness for b in scene.buildings]),
        np.concatenate([b.yield_shear / b.stiffness for b in scene.buildings]),
        np.concatenate([b.hardening for b in scene.buildings]),
    )


def _column(building, at, base, turn, floor, x, total) -> np.ndarray:
    """The row that gives the displacement of the columns below a floor at the part x of their height: a beam whose ends
    move as the floors and turn as the base (cubic Hermite shapes)."""
    row = np.zeros(total)
    row[at[floor - 1]] = x * x * (3 - 2 * x)
    if floor > 1:
        row[at[floor - 2]] = 1 - x * x * (3 - 2 * x)
    elif base is not None:
        row[base] = 1 - x * x * (3 - 2 * x)
    if turn is not None:
        row[turn] = building.height[floor - 1] * (x * (1 - x) ** 2 - x * x * (1 - x))
    return row


def start(scene: Scene, c: Coordinates, initial) -> tuple[np.ndarray, np.ndarray]:
    """Displacements and velocities q, q' at t = 0; `initial` as in `solve`, None is rest."""
    q, rate = np.zeros(c.mass.size), np.zeros(c.mass.size)
    if initial is not None:
        for at, u, v in zip(c.floors, *initial, strict=True):
            q[at], rate[at] = u, v
    return q, rate


def reduced_mass(scene: Scene, e: int) -> float:
    """m1 m2 / (m1 + m2) of link e [kg]; its inverse where eq. (7) is taken as printed. A link that is inclined or ends
    on columns moves the mass 1 / sum(weight^2 / mass)."""
    link = scene.links[e]
    if (link.left_at, link.right_at, link.cosine) != (1.0, 1.0, 1.0):
        c = coordinates(scene)
        return float(1.0 / np.sum(c.closing[e] ** 2 / c.mass))
    m1 = scene.buildings[link.left].mass[link.left_floor - 1]
    m2 = scene.buildings[link.left + 1].mass[link.right_floor - 1]
    return (m1 + m2) / (m1 * m2) if str(getattr(link.law, "dashpot", "")) == "printed" else m1 * m2 / (m1 + m2)


def ground(scene: Scene) -> list[tuple[float, float, float, float]]:
    """(t0, t1, acceleration at t0, slope) of every straight piece of the motion, then the still tail."""
    a, dt = scene.motion.acceleration, scene.motion.dt
    pieces = [(i * dt, (i + 1) * dt, a[i], (a[i + 1] - a[i]) / dt) for i in range(a.size - 1)]
    if scene.tail > 0:
        pieces.append((pieces[-1][1], pieces[-1][1] + scene.tail, 0.0, 0.0))
    return pieces
