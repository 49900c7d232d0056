"""One impact on the bumper wall: contact in time, force, separation, energy, stresses in wall, beams and columns."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr
from scipy.sparse import csc_matrix, diags_array
from scipy.sparse.linalg import SuperLU, splu

from pounding_cli.errors import InputError, Problem
from pounding_cli.points import value
from pounding_cli.wall.elements import System, build
from pounding_cli.wall.study import MOST_STEPS, Study

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
"""What is known at every instant: unit and meaning."""


def solve(study: Study) -> xr.Dataset:
    """Solve one impact: numbers, histories, stresses at the struck face and on the mesh of the wall.

    Raises InputError where it would take too many steps or gave a number that is not finite, with what to change.
    """
    system, end = build(study), study.time.end
    wished = natural_step(system, study) if isinstance(study.time.step, str) else study.time.step
    if end / wished > MOST_STEPS:
        hint = f"give an earlier `time.end`, e.g. {MOST_STEPS / 10 * wished:.1g} s, or a heavier striker"
        raise InputError(Problem(f"an impact this short needs {end / wished:.0f} time steps", hint))
    steps = max(10, math.ceil(end / wished - 1e-9))
    history, largest, then, at_peak = list[tuple[float, ...]](), dict[str, Any](), dict[str, Any](), 0.0
    for instant, u in integrate(system, study, steps):
        now = {
            "elements": von_mises(system.elements @ u),
            "cells": von_mises(system.cells @ u),
            "rows": np.abs(system.resultants @ u).reshape(-1, 2),
            "members": np.abs(system.members @ u),
        }
        if not history or now["elements"].max() > then["elements"].max():
            then, at_peak = {**now, "corners": (system.corners @ u).reshape(-1, 2)}, instant[0]
        largest = {name: np.maximum(values, largest.get(name, values)) for name, values in now.items()}
        history.append(instant)
    run = dict(zip(HISTORIES, np.array(history).T, strict=True))
    time, force = run["time"], run["force"]
    energy = run["striker_energy"] + run["kinetic_energy"] + run["strain_energy"]
    if not np.isfinite(energy).all():
        hint = "masses and stiffnesses differ by too many powers of ten"
        raise InputError(Problem("the response is not finite", hint))
    off, (low, high) = float(np.abs(energy / energy[0] - 1).max()), study.patch
    notes = []
    if study.contact.over == "patch" and high - low < study.contact.patch * (1 - 1e-9):
        notes.append(f"the patch ends with the wall: {high - low:.3g} m of {study.contact.patch:.3g} m touch")
    if force[-1] > 0 and study.contact.bond == "unilateral":
        notes.append(f"still in contact at {time[-1]:.3g} s: give a later `time.end`")
    if off > 5e-3:
        notes.append("the energy balance is open by more than 0.5 %: give a smaller `time.step`")
    averaged, (shear, moment) = largest["cells"], largest["rows"].max(axis=0)
    distance = np.abs(system.cell_height - 0.5 * (low + high))
    found = {
        "peak_force": value("N", "largest contact force", force.max()),
        "peak_time": value("s", "time of the largest contact force", time[np.argmax(force)]),
        "separation": value("s", "first time the striker leaves the wall", separation(time, force)),
        "last_contact": value("s", "last time the striker pushes", time[np.flatnonzero(force > 0)[-1]]),
        "impulse": value("N s", "impulse of the contact force", float(np.trapezoid(force, time))),
        "energy_residual": value("1", "largest open part of the energy balance, over the first energy", off),
        "wall_stress": value("N/m2", "largest von Mises stress of an element", largest["elements"].max()),
        "averaged_stress": value("N/m2", "largest von Mises stress, averaged over the length stated", averaged.max()),
    }
    for name, members in (("beam", slice(system.beams)), ("column", slice(system.beams, None))):
        text = f"largest edge stress of the {name}s"
        found[f"{name}_stress"] = value("N/m2", text, largest["members"][members].max())
        text = f"{text} at the instant of the wall's peak"
        found[f"{name}_stress_then"] = value("N/m2", text, then["members"][members].max())
    found |= {
        "wall_shear": value("N", "largest shear force in a cross-section of the wall", shear),
        "wall_moment": value("N m", "largest bending moment in a cross-section of the wall", moment),
        "reach": value("m", "farthest from the contact that the averaged stress exceeds half its largest",
                       reach(distance, averaged)),
        "step": value("s", "time step", end / steps),
        "freedoms": value("1", "degrees of freedom", float(system.M.size)),
        "time_of_peak": value("s", "instant of the largest stress of an element", at_peak),
        "cell_height": value("m", "height of a cell at the struck face", system.cell_height, "cell"),
        "cell_stress": value("N/m2", "largest von Mises stress of the mean stress in a cell", averaged, "cell"),
        "corners": value("m", "corners of the mesh", system.mesh.p.T, "corner", "axis"),
        "quads": value("1", "corners of every element", system.mesh.t.T, "element", "side"),
        "displacement": value("m", "displacement of the corners at the peak", then["corners"], "corner", "axis"),
        "stress_peak": value("N/m2", "von Mises stress of every element at the peak", then["elements"], "element"),
        "stress_envelope": value("N/m2", "largest von Mises stress of every element", largest["elements"], "element"),
    }  # fmt: skip
    found |= {name: value(*HISTORIES[name], values, "instant") for name, values in run.items()}
    return xr.Dataset(found, attrs={"notes": notes})


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


def natural_step(system: System, study: Study) -> float:
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


def integrate(system: System, study: Study, steps: int) -> Iterator[tuple[tuple[float, ...], np.ndarray]]:
    """Values of HISTORIES and displacements at the beginning and after every step.

    Wood-Bossak-Zienkiewicz alpha method (1980); forces balance at the end of each step:
    alpha_m = (rho - 1) / (rho + 1), gamma = 1/2 - alpha_m, beta = (1 - alpha_m)^2 / 4; rho = 1 is Newmark's
    average acceleration. Second order; freedoms without mass are in static equilibrium at every step.
    The contact force enters as p F, so a step is that without contact plus F times one fixed vector, and

        F >= 0, gap >= 0, F gap = 0   (unilateral)        or        gap = 0   (glued)

    is one scalar equation: no state to switch, no second factorisation. The struck freedoms carry no mass,
    so the force begins at zero and nothing is lost when the contact closes.
    """
    striker, h, am = study.striker, study.time.end / steps, (study.time.rho - 1) / (study.time.rho + 1)
    gamma, beta = 0.5 - am, 0.25 * (1 - am) ** 2
    inertia = (1 - am) / (beta * h**2)
    stiffness, mass, push = system.K, system.M, system.p
    factor = factorise(stiffness + diags_array(inertia * mass))
    answer = factor.solve(push)
    compliance = float(push @ answer) + 1 / (inertia * striker.mass)
    u, v, a = (np.zeros(mass.size) for _ in range(3))
    x, xv, xa, force = 0.0, striker.speed, 0.0, 0.0
    for n in range(steps + 1):
        if n > 0:
            guess, x_guess = u + h * v + (0.5 - beta) * h**2 * a, x + h * xv + (0.5 - beta) * h**2 * xa
            u, x = factor.solve(mass * (inertia * guess - am * a)), x_guess - am / inertia * xa
            force = (x - float(push @ u)) / compliance
            if study.contact.bond == "unilateral":
                force = max(force, 0.0)
            u += force * answer
            x -= force / (inertia * striker.mass)
            before, x_before, a, xa = a, xa, (u - guess) / (beta * h**2), (x - x_guess) / (beta * h**2)
            v = v + h * ((1 - gamma) * before + gamma * a)
            xv = xv + h * ((1 - gamma) * x_before + gamma * xa)
        energies = 0.5 * striker.mass * xv**2, 0.5 * float(mass @ v**2), 0.5 * float(u @ (stiffness @ u))
        yield (n * h, force, x, xv, float(push @ u), *energies), u
