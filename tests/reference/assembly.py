"""Coordinates and constant matrices of a scene, assembled from the paper's equations (1)-(4)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from pounding_cli import Scene
from pounding_cli.model.wall import Wall


@dataclass(frozen=True)
class Coordinates:
    """Where each displacement stands in q, and what it takes to get drifts and closings from q.

    What resists is a storey of a building whose floors do not twist, and a storey of a frame line of one whose floors
    do.

    floors : per building, indices of u_1 .. u_n in q
    turns : per building, indices of theta_1 .. theta_n in q, none where its floors do not twist
    drift : of all that resists from all coordinates, shape (resisting, N)
    storey : what resists every storey along the row, 0 or 1, shape (storeys, resisting)
    travel : drift of every storey at the centres of mass of its floors, shape (storeys, N)
    edges : drift of every storey at the low edge of its floors, then of every one at the high edge, shape (edges, N)
    laws : law of all that resists
    closing : u_left - u_right of every link, of an inclined one times the cosine of its angle, shape (links, N)
    cosine : of the angle of every link, (links,)
    mass, damping : M (diagonal entries, (N,)) and C of buildings and foundations without the links, (N, N)
    springs : foundation springs, elastic lines across the row, and the weights that lean on the columns (P-Delta),
        (N, N)
    loaded : -a_g loaded is the force of the ground, (N,)
    stiffness, yield_drift, hardening : of all that resists, in the order of `drift`
    """

    floors: list[np.ndarray]
    turns: list[np.ndarray]
    drift: np.ndarray
    storey: np.ndarray
    travel: np.ndarray
    edges: np.ndarray
    laws: list[Any]
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
    """q = for each building u_1 .. u_n, then u_b if it sways, phi_b if it rocks, theta_1 .. theta_n if it twists; those
    of a scene that is written by hand are its own (tests/hard/by_hand.py)."""
    if hasattr(scene, "coordinates"):
        return scene.coordinates
    total = 0
    floors, bases, feet, turns = [], [], [], []
    for b in scene.buildings:
        floors.append(np.arange(total, total + b.storeys))
        total += b.storeys
        sways = b.foundation is not None and b.foundation.sways
        rocks = b.foundation is not None and b.foundation.rocks
        bases.append(total if sways else None)
        total += int(sways)
        feet.append(total if rocks else None)
        total += int(rocks)
        turns.append(np.arange(total, total + (b.storeys if b.plan is not None else 0)))
        total += turns[-1].size

    mass, loaded = np.zeros(total), np.zeros(total)
    springs, damping = np.zeros((total, total)), np.zeros((total, total))
    resisting, travels, edges = [], [], []
    for b, at, base, foot, turn in zip(scene.buildings, floors, bases, feet, turns, strict=True):
        mass[at] = loaded[at] = b.mass
        if isinstance(b, Wall) and not b.moves:
            mass[at], loaded[at] = np.inf, 0.0
        deformation = np.zeros((b.storeys, total))  # delta_j = u_j - u_b - h_j phi_b, eq. (1)
        deformation[np.arange(b.storeys), at] = 1.0
        if base is not None:
            f = b.foundation
            mass[base] = loaded[base] = f.mass
            springs[base, base], damping[base, base] = f.sway_stiffness, f.sway_damping
            deformation[:, base] = -1.0
        if foot is not None:
            f = b.foundation
            mass[foot] = f.inertia
            springs[foot, foot], damping[foot, foot] = f.rocking_stiffness, f.rocking_damping
            deformation[:, foot] = -np.cumsum(b.height)
        travel = np.diff(deformation, axis=0, prepend=0.0)
        travels.append(travel)
        if b.gravity_load is not None:
            above = np.eye(total)[at]
            below = np.vstack((np.zeros(total) if base is None else np.eye(total)[base], above[:-1]))
            for load, h, lean in zip(b.gravity_load, b.height, above - below, strict=True):
                springs -= load / h * np.outer(lean, lean)  # the top of a column is lower by lean^2 / (2 h)
        damping += b.alpha * deformation.T @ np.diag(b.mass) @ deformation  # eq. (4), on the deformations of eq. (2)
        if b.plan is None:
            found = [_Resisting(*each, j) for j, each in enumerate(zip(travel, b.laws, strict=True))]
        else:
            twist = np.diff(np.eye(total)[turn], axis=0, prepend=0.0)
            mass[turn] = b.plan.inertia
            damping[turn, turn] += b.alpha * b.plan.inertia
            for j, row in enumerate(twist):
                springs += b.plan.torsional_stiffness[j] * np.outer(row, row)
                damping += b.beta * b.plan.torsional_stiffness[j] * np.outer(row, row)
                if b.gravity_load is not None:  # a column r from the centre of mass leans by r times the twist
                    square = b.plan.inertia[j:].sum() / b.mass[j:].sum()
                    springs -= b.gravity_load[j] * square / b.height[j] * np.outer(row, row)
            found = _frame_lines(b, travel, twist)
            edges.append([travel - b.plan.low * twist, travel - b.plan.high * twist])
        for each in found:
            damping += b.beta * each.law.stiffness * np.outer(each.drift, each.drift)
        resisting.append(found)

    closing = np.zeros((len(scene.links), total))
    for e, link in enumerate(scene.links):
        for place, floor, at, sign in (
            (link.left, link.left_floor, link.left_at, 1.0),
            (link.left + 1, link.right_floor, link.right_at, -1.0),
        ):
            if isinstance(scene.buildings[place], Wall):
                floor = 1  # every floor meets it
            closing[e] += sign * _column(
                scene.buildings[place], floors[place], bases[place], feet[place], floor, at, total
            )
            y = link.left_arm if sign > 0 else link.right_arm
            closing[e] -= sign * y * _twist_of_column(turns[place], floor, at, total)
    cosine = np.array([link.cosine for link in scene.links])
    everything = [each for found in resisting for each in found]
    return Coordinates(
        floors,
        turns,
        np.array([each.drift for each in everything]),
        _sums_of_storeys(resisting, [b.storeys for b in scene.buildings]),
        np.vstack(travels),
        np.vstack([rows for side in zip(*edges, strict=True) for rows in side]) if edges else np.zeros((0, total)),
        [each.law for each in everything],
        closing * cosine[:, None],
        cosine,
        mass,
        damping,
        springs,
        loaded,
        np.array([each.law.stiffness for each in everything]),
        np.array([each.law.yield_shear / each.law.stiffness for each in everything]),
        np.array([each.law.hardening for each in everything]),
    )


class _Resisting(NamedTuple):
    """What resists a storey: its drift from all coordinates, its law, the storey from 0, and whether along the row."""

    drift: np.ndarray
    law: Any
    storey: int
    along: bool = True


def _frame_lines(building, travel: np.ndarray, twist: np.ndarray) -> list[_Resisting]:
    """Return the storeys of the lines of a building, line by line, those across the row behind those along it."""
    made = []
    for line in building.plan.lines:
        laws = building.laws_of_line(line)
        made += [_Resisting(travel[j] - line.arm * twist[j], law, j) for j, law in enumerate(laws)]
    for line in building.plan.lines_across:
        laws = building.laws_of_line(line)
        made += [_Resisting(line.arm * twist[j], law, j, along=False) for j, law in enumerate(laws)]
    return made


def _sums_of_storeys(resisting: list[list[_Resisting]], storeys: list[int]) -> np.ndarray:
    """Return what resists every storey along the row, 0 or 1, shape (storeys, resisting)."""
    sums = np.zeros((sum(storeys), sum(len(found) for found in resisting)))
    first, column = 0, 0
    for found, count in zip(resisting, storeys, strict=True):
        for each in found:
            sums[first + each.storey, column] = float(each.along)
            column += 1
        first += count
    return sums


def _twist_of_column(turns, floor, x, total) -> np.ndarray:
    """The row that gives the rotation about the vertical axis at the part x of the height of the columns below a
    floor, which turn as `_column` moves."""
    row = np.zeros(total)
    if turns.size and floor > 0:
        row[turns[floor - 1]] = x * x * (3 - 2 * x)
        if floor > 1:
            row[turns[floor - 2]] = 1 - x * x * (3 - 2 * x)
    return row


def _column(building, at, base, foot, floor, x, total) -> np.ndarray:
    """The row that gives the displacement of the columns below a floor at the part x of their height: a beam whose ends
    move as the floors and turn as the base (cubic Hermite shapes)."""
    row = np.zeros(total)
    if floor == 0:
        row[base] = 1.0
        return row
    row[at[floor - 1]] = x * x * (3 - 2 * x)
    if floor > 1:
        row[at[floor - 2]] = 1 - x * x * (3 - 2 * x)
    elif base is not None:
        row[base] = 1 - x * x * (3 - 2 * x)
    if foot is not None:
        row[foot] = building.height[floor - 1] * (x * (1 - x) ** 2 - x * x * (1 - x))
    return row


def start(scene: Scene, c: Coordinates, initial) -> tuple[np.ndarray, np.ndarray]:
    """Displacements and velocities q, q' at t = 0; `initial` as in `solve`, None is rest."""
    q, rate = np.zeros(c.mass.size), np.zeros(c.mass.size)
    if initial is not None:
        for at, u, v in zip(c.floors, *initial, strict=True):
            q[at], rate[at] = u, v
    return q, rate


def reduced_mass(scene: Scene, e: int) -> float:
    """m1 m2 / (m1 + m2) of link e [kg]; its inverse where eq. (7) is taken as printed. A link that is inclined, ends
    on columns or beside the centre of mass of a floor that twists moves the mass 1 / sum(weight^2 / mass)."""
    link = scene.links[e]
    c = coordinates(scene)
    reduced = float(1.0 / np.sum(c.closing[e] ** 2 / c.mass))
    return 1 / reduced if str(getattr(link.law, "dashpot", "")) == "printed" else reduced


def ground(scene: Scene) -> list[tuple[float, float, float, float]]:
    """(t0, t1, acceleration at t0, slope) of every straight piece of the motion, then the still tail."""
    a, dt = scene.motion.acceleration, scene.motion.dt
    pieces = [(i * dt, (i + 1) * dt, a[i], (a[i + 1] - a[i]) / dt) for i in range(a.size - 1)]
    if scene.tail > 0:
        pieces.append((pieces[-1][1], pieces[-1][1] + scene.tail, 0.0, 0.0))
    return pieces
