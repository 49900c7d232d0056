"""The impact in time: one factorisation, one back-substitution a step, contact as one scalar condition."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_matrix, diags_array
from scipy.sparse.linalg import SuperLU, splu

from pounding_cli.wall.assembly import System
from pounding_cli.wall.model import Bond, Striker, WallModel


@dataclass(frozen=True, eq=False)
class Transient:
    """History of one impact; arrays have shape (steps + 1,).

    time [s]; force on the wall [N]; position [m] and velocity [m/s] of the striker;
    indentation : displacement of the wall under the striker [m];
    energies [J] : striker, kinetic (wall and frame), strain
    """

    time: np.ndarray
    force: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    indentation: np.ndarray
    striker_energy: np.ndarray
    kinetic_energy: np.ndarray
    strain_energy: np.ndarray


def factorise(matrix: csc_matrix) -> SuperLU:
    """Factors of a symmetric positive definite matrix."""
    options = {"SymmetricMode": True}
    return splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)


def natural_step(system: System, model: WallModel) -> float:
    """A time step that leaves force and energy with errors below 1e-3 [s].

    A 100th of the striker's half period on the wall, pi / s, at most 0.1 ms; s^2 = 1 / (m C(s)) with the
    compliance C(s) = p (K + s^2 M)^-1 p, since a light striker feels floors too heavy to follow it. Where the
    wall has mass of its own, waves cross no more than half an element in a step.
    docs/wall.md has the errors against the step.
    """
    s = 0.0
    for _ in range(3):
        give = float(system.p @ factorise(system.K + diags_array(s**2 * system.M)).solve(system.p))
        s = 1 / math.sqrt(model.striker.mass * give)
    step = min(1e-4, math.pi / s / 100)
    if model.concrete.density > 0:
        speed = math.sqrt(model.concrete.young / model.concrete.density / (1 - model.concrete.poisson**2))
        step = min(step, 0.5 * model.mesh.size / speed)
    return step


def integrate(
    system: System,
    striker: Striker,
    bond: Bond,
    end: float,
    step: float,
    rho: float,
    each: Callable[[int, np.ndarray], None] | None = None,
) -> Transient:
    """Wood-Bossak-Zienkiewicz alpha method (1980); forces balance at the end of each step.

    alpha_m = (rho - 1) / (rho + 1), gamma = 1/2 - alpha_m, beta = (1 - alpha_m)^2 / 4; rho = 1 is Newmark's
    average acceleration. Second order; freedoms without mass are in static equilibrium at every step.
    The contact force enters as p F, so a step is that without contact plus F times one fixed vector, and

        F >= 0, gap >= 0, F gap = 0   (unilateral)        or        gap = 0   (glued)

    is one scalar equation: no state to switch, no second factorisation. The struck freedoms carry no mass,
    so the force begins at zero and nothing is lost when the contact closes.

    Parameters
    ----------
    each : called after every step with (step, displacements), to take what it wants from them
    """
    steps = round(end / step)
    h = end / steps
    am = (rho - 1) / (rho + 1)
    gamma, beta = 0.5 - am, 0.25 * (1 - am) ** 2
    inertia = (1 - am) / (beta * h**2)
    stiffness, mass, push = system.K, system.M, system.p
    factor = factorise(stiffness + diags_array(inertia * mass))
    answer = factor.solve(push)
    compliance = float(push @ answer) + 1 / (inertia * striker.mass)

    u, v, a = (np.zeros(mass.size) for _ in range(3))
    x, xv, xa = 0.0, striker.speed, 0.0
    out = np.zeros((8, steps + 1))
    out[:, 0] = (0, 0, x, xv, 0, 0.5 * striker.mass * xv**2, 0.5 * float(mass @ v**2), 0)
    for n in range(1, steps + 1):
        guess = u + h * v + (0.5 - beta) * h**2 * a
        u1 = factor.solve(mass * (inertia * guess - am * a))
        x_guess = x + h * xv + (0.5 - beta) * h**2 * xa
        x1 = x_guess - am / inertia * xa
        overlap = x1 - float(push @ u1)
        force = overlap / compliance
        if bond is Bond.UNILATERAL:
            force = max(force, 0.0)
        u1 += force * answer
        x1 -= force / (inertia * striker.mass)
        a1, xa1 = (u1 - guess) / (beta * h**2), (x1 - x_guess) / (beta * h**2)
        v = v + h * ((1 - gamma) * a + gamma * a1)
        xv = xv + h * ((1 - gamma) * xa + gamma * xa1)
        w1 = float(push @ u1)
        u, a, x, xa = u1, a1, x1, xa1
        strain = 0.5 * float(u @ (stiffness @ u))
        out[:, n] = (n * h, force, x, xv, w1, 0.5 * striker.mass * xv**2, 0.5 * float(mass @ v**2), strain)
        if each is not None:
            each(n, u)
    return Transient(*out)
