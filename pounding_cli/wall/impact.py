"""One impact on the bumper wall: contact in time, force, separation, energy, stresses in wall, beams and columns."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.sparse import csc_matrix, diags_array
from scipy.sparse.linalg import SuperLU, splu

from pounding_cli.errors import InputError, Problem
from pounding_cli.wall.elements import System, build
from pounding_cli.wall.study import WallStudy

MOST_STEPS = 200_000


def strike(study: WallStudy) -> dict[str, Any]:
    """Solve one impact; the values of every name in `report.VARIABLES`, in SI, and `flags`, `fields` for figures.

    Raises InputError where it would take too many steps or gave a number that is not finite, with what to change.
    """
    system = build(study)
    wished = natural_step(system, study) if isinstance(study.time.step, str) else study.time.step
    if study.time.end / wished > MOST_STEPS:
        hint = f"give an earlier `time.end`, e.g. {MOST_STEPS / 10 * wished:.1g} s, or a heavier striker"
        raise InputError(Problem(f"an impact this short needs {study.time.end / wished:.0f} time steps", hint))
    step = study.time.end / max(10, math.ceil(study.time.end / wished - 1e-9))
    largest = {
        "elements": np.zeros(system.area.size),
        "cells": np.zeros(system.cell_height.size),
        "rows": np.zeros((system.row_height.size, 3)),
        "members": np.zeros(system.members.shape[0]),
    }
    then: dict[str, Any] = {"peak": -1.0}

    def each(time: float, u: np.ndarray) -> None:
        stress = von_mises(system.elements @ u)
        found = {
            "elements": stress,
            "cells": von_mises(system.cells @ u),
            "rows": np.abs(system.resultants @ u).reshape(-1, 3),
            "members": np.abs(system.members @ u),
        }
        for name, values in found.items():
            np.maximum(largest[name], values, out=largest[name])
        if stress.max() > then["peak"]:
            then.update(found, peak=stress.max(), time=time, corners=system.corners @ u)

    run = integrate(system, study, step, each)
    if not (np.isfinite(run["force"]).all() and np.isfinite(run["strain_energy"]).all()):
        hint = "masses and stiffnesses differ by too many powers of ten"
        raise InputError(Problem("the response is not finite", hint))
    time, force = run["time"], run["force"]
    impulse = float(np.trapezoid(force, time))
    energy = run["striker_energy"] + run["kinetic_energy"] + run["strain_energy"]
    off = float(np.abs(energy / energy[0] - 1).max())
    averaged, (beams, columns) = float(largest["cells"].max()), np.split(largest["members"], [system.beams])
    normal, shear, moment = largest["rows"].T
    low, high = study.patch
    flags = []
    if study.contact.over == "patch" and high - low < study.contact.patch * (1 - 1e-9):
        flags.append(f"the patch ends with the wall: {high - low:.3g} m of {study.contact.patch:.3g} m touch")
    if force[-1] > 0 and study.contact.bond == "unilateral":
        flags.append(f"still in contact at {time[-1]:.3g} s: give a later `time.end`")
    if off > 5e-3:
        flags.append("the energy balance is open by more than 0.5 %: give a smaller `time.step`")
    return {
        **run,
        "step": step,
        "freedoms": float(system.M.size),
        "peak_force": float(force.max()),
        "peak_time": float(time[np.argmax(force)]),
        "separation": separation(time, force),
        "last_contact": float(time[np.flatnonzero(force > 0)[-1]]),
        "impulse": impulse,
        "momentum_residual": impulse / (study.striker.mass * study.striker.speed)
        - (1 - float(run["velocity"][-1]) / study.striker.speed),
        "energy_residual": off,
        "wall_stress": float(largest["elements"].max()),
        "averaged_stress": averaged,
        "beam_stress": float(beams.max()),
        "column_stress": float(columns.max()),
        "beam_stress_then": float(then["members"][: system.beams].max()),
        "column_stress_then": float(then["members"][system.beams :].max()),
        "wall_shear": float(shear.max()),
        "wall_moment": float(moment.max()),
        "reach": reach(np.abs(system.cell_height - 0.5 * (low + high)), largest["cells"]),
        "stressed_share": float(system.area[largest["elements"] > 0.1 * averaged].sum() / system.area.sum()),
        "averaged_over": study.averaging_length,
        "wall_length": study.wall.length,
        "time_of_peak": then["time"],
        "cell_height": system.cell_height,
        "cell_stress": largest["cells"],
        "row_height": system.row_height,
        "normal": normal,
        "shear": shear,
        "moment": moment,
        "flags": flags,
        "fields": {
            "points": system.mesh.p.T,
            "quads": system.mesh.t.T,
            "displacement": then["corners"].reshape(-1, 2),
            "stress_peak": then["elements"],
            "stress_envelope": largest["elements"],
        },
    }


def von_mises(stress: np.ndarray) -> np.ndarray:
    """Von Mises stress in plane stress [N/m2] from (s_x, s_y, t_xy) in turns: shape (3 n,) to (n,)."""
    sx, sy, t = stress.reshape(-1, 3).T
    return np.sqrt(sx**2 - sx * sy + sy**2 + 3 * t**2)


def reach(distance: np.ndarray, stress: np.ndarray) -> float:
    """Farthest distance at which the stress is half its largest [m], on straight lines between the cells."""
    half = 0.5 * stress.max()
    ends = [float(distance[stress >= half].max())]
    for i in np.flatnonzero((stress[1:] >= half) != (stress[:-1] >= half)):
        share = (half - stress[i]) / (stress[i + 1] - stress[i])
        ends.append(float(distance[i] + share * (distance[i + 1] - distance[i])))
    return max(ends)


def separation(time: np.ndarray, force: np.ndarray) -> float:
    """First time the force is positive no more [s], on a straight line between steps; NaN if it stays so."""
    pushed = np.flatnonzero(force > 0)
    free = np.flatnonzero(force[pushed[0] :] <= 0) if pushed.size else pushed
    if free.size == 0:
        return math.nan
    n = pushed[0] + free[0]
    before, after = force[n - 1], force[n]
    # Cut off at zero, the force goes on falling as in the step before, but not beyond the step.
    fall = before - after if after < 0 else max(force[n - 2] - before, before)
    return float(time[n - 1] + (time[n] - time[n - 1]) * before / fall)


def factorise(matrix: csc_matrix) -> SuperLU:
    """Factors of a symmetric positive definite matrix."""
    options = {"SymmetricMode": True}
    return splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)


def natural_step(system: System, study: WallStudy) -> float:
    """A time step that leaves force and energy with errors below 1e-3 [s].

    A 100th of the striker's half period on the wall, pi / s, at most 0.1 ms; s^2 = 1 / (m C(s)) with the
    compliance C(s) = p (K + s^2 M)^-1 p, since a light striker feels floors too heavy to follow it. Where the
    wall has mass of its own, waves cross no more than half an element in a step.
    docs/wall.md has the errors against the step.
    """
    s, concrete = 0.0, study.concrete
    for _ in range(3):
        give = float(system.p @ factorise(system.K + diags_array(s**2 * system.M)).solve(system.p))
        s = 1 / math.sqrt(study.striker.mass * give)
    step = min(1e-4, math.pi / s / 100)
    if concrete.density > 0:
        speed = math.sqrt(concrete.young / concrete.density / (1 - concrete.poisson**2))
        step = min(step, 0.5 * study.mesh.size / speed)
    return step


def integrate(
    system: System, study: WallStudy, step: float, each: Callable[[float, np.ndarray], None]
) -> dict[str, np.ndarray]:
    """Wood-Bossak-Zienkiewicz alpha method (1980); forces balance at the end of each step.

    alpha_m = (rho - 1) / (rho + 1), gamma = 1/2 - alpha_m, beta = (1 - alpha_m)^2 / 4; rho = 1 is Newmark's
    average acceleration. Second order; freedoms without mass are in static equilibrium at every step.
    The contact force enters as p F, so a step is that without contact plus F times one fixed vector, and

        F >= 0, gap >= 0, F gap = 0   (unilateral)        or        gap = 0   (glued)

    is one scalar equation: no state to switch, no second factorisation. The struck freedoms carry no mass,
    so the force begins at zero and nothing is lost when the contact closes.

    each : called after every step with time [s] and displacements, to take what it wants from them
    """
    striker, steps = study.striker, round(study.time.end / step)
    h, am = study.time.end / steps, (study.time.rho - 1) / (study.time.rho + 1)
    gamma, beta = 0.5 - am, 0.25 * (1 - am) ** 2
    inertia = (1 - am) / (beta * h**2)
    stiffness, mass, push = system.K, system.M, system.p
    factor = factorise(stiffness + diags_array(inertia * mass))
    answer = factor.solve(push)
    compliance = float(push @ answer) + 1 / (inertia * striker.mass)

    u, v, a = (np.zeros(mass.size) for _ in range(3))
    x, xv, xa = 0.0, striker.speed, 0.0
    out = np.zeros((8, steps + 1))
    out[:, 0] = (0, 0, x, xv, 0, 0.5 * striker.mass * xv**2, 0, 0)
    for n in range(1, steps + 1):
        guess, x_guess = u + h * v + (0.5 - beta) * h**2 * a, x + h * xv + (0.5 - beta) * h**2 * xa
        u1, x1 = factor.solve(mass * (inertia * guess - am * a)), x_guess - am / inertia * xa
        force = (x1 - float(push @ u1)) / compliance
        if study.contact.bond == "unilateral":
            force = max(force, 0.0)
        u1 += force * answer
        x1 -= force / (inertia * striker.mass)
        a1, xa1 = (u1 - guess) / (beta * h**2), (x1 - x_guess) / (beta * h**2)
        v = v + h * ((1 - gamma) * a + gamma * a1)
        xv = xv + h * ((1 - gamma) * xa + gamma * xa1)
        u, a, x, xa = u1, a1, x1, xa1
        energies = 0.5 * striker.mass * xv**2, 0.5 * float(mass @ v**2), 0.5 * float(u @ (stiffness @ u))
        out[:, n] = (n * h, force, x, xv, float(push @ u), *energies)
        each(n * h, u)
    names = "time", "force", "position", "velocity", "indentation", "striker_energy", "kinetic_energy", "strain_energy"
    return dict(zip(names, out, strict=True))
