"""The impact in time: one factorisation, one back-substitution a step, contact as one scalar condition."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.sparse import diags_array
from scipy.sparse.linalg import splu

from pounding_cli.wall.assembly import System
from pounding_cli.wall.model import Bond, Striker, Time


@dataclass(frozen=True, eq=False)
class Transient:
    """History of one impact; arrays have shape (steps + 1,).

    time [s]; force on the wall [N]; position [m] and velocity [m/s] of the striker;
    indentation : displacement of the wall under the striker [m];
    energies [J] : striker, kinetic (wall and frame), strain;
    first_blow : impulse exchanged at t = 0 between the striker and the mass it touches [N s];
    blow_loss : energy lost in it [J];
    steps_lost : energy lost where the contact opens or closes within a step [J]
    """

    time: np.ndarray
    force: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    indentation: np.ndarray
    striker_energy: np.ndarray
    kinetic_energy: np.ndarray
    strain_energy: np.ndarray
    first_blow: float
    blow_loss: float
    steps_lost: float


def integrate(
    system: System,
    striker: Striker,
    bond: Bond,
    time: Time,
    each: Callable[[int, float, np.ndarray], None] | None = None,
) -> Transient:
    """Wood-Bossak-Zienkiewicz alpha method (1980): stiffness and contact in equilibrium at each step's end.

    alpha_m = (rho - 1) / (rho + 1), gamma = 1/2 - alpha_m, beta = (1 - alpha_m)^2 / 4; rho = 1 is Newmark's
    average acceleration. Second order; freedoms without mass are in static equilibrium at every step.
    The contact force enters as p F, so the step is the step without contact plus F times one fixed vector, and

        F >= 0, gap >= 0, F gap = 0   (unilateral)        or        gap = 0   (glued)

    is one scalar equation: no state to switch, no second factorisation.

    Parameters
    ----------
    each : called after every step with (step, force [N], displacements), to take what it wants from them
    """
    h, steps = time.step, round(time.end / time.step)
    am = (time.rho - 1) / (time.rho + 1)
    gamma, beta = 0.5 - am, 0.25 * (1 - am) ** 2
    inertia = (1 - am) / (beta * h**2)
    stiffness, mass, push = system.K, system.M, system.p
    factor = splu(
        (stiffness + diags_array(inertia * mass)).tocsc(),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    answer = factor.solve(push)
    compliance = float(push @ answer) + 1 / (inertia * striker.mass)
    touched = np.flatnonzero(push)

    u, v, a = (np.zeros(mass.size) for _ in range(3))
    x, xv, xa = 0.0, striker.speed, 0.0
    # A striker that touches only mass shares its momentum with it at once; massless freedoms give way.
    blow = blow_loss = 0.0
    if mass[touched].min() > 0:
        blow = xv / (1 / striker.mass + float(push[touched] ** 2 @ (1 / mass[touched])))
        before = 0.5 * striker.mass * xv**2
        v[touched] = blow * push[touched] / mass[touched]
        xv -= blow / striker.mass
        blow_loss = before - 0.5 * striker.mass * xv**2 - 0.5 * float(mass @ v**2)

    out = np.zeros((8, steps + 1))
    out[:, 0] = (0, 0, x, xv, 0, 0.5 * striker.mass * xv**2, 0.5 * float(mass @ v**2), 0)
    lost = 0.0
    force = 0.0
    for n in range(1, steps + 1):
        guess = u + h * v + (0.5 - beta) * h**2 * a
        u1 = factor.solve(mass * (inertia * guess - am * a))
        x_guess = x + h * xv + (0.5 - beta) * h**2 * xa
        x1 = x_guess - am / inertia * xa
        overlap = x1 - float(push @ u1)
        new_force = overlap / compliance
        if bond is Bond.UNILATERAL:
            new_force = max(new_force, 0.0)
        u1 += new_force * answer
        x1 -= new_force / (inertia * striker.mass)
        a1, xa1 = (u1 - guess) / (beta * h**2), (x1 - x_guess) / (beta * h**2)
        v = v + h * ((1 - gamma) * a + gamma * a1)
        xv = xv + h * ((1 - gamma) * xa + gamma * xa1)
        w1 = float(push @ u1)
        lost += 0.5 * (force + new_force) * ((x1 - x) - (w1 - out[4, n - 1]))
        u, a, x, xa, force = u1, a1, x1, xa1, new_force
        strain = 0.5 * float(u @ (stiffness @ u))
        out[:, n] = (n * h, force, x, xv, w1, 0.5 * striker.mass * xv**2, 0.5 * float(mass @ v**2), strain)
        if each is not None:
            each(n, force, u)
    t, f, xs, vs, w, e1, e2, e3 = out
    return Transient(t, f, xs, vs, w, e1, e2, e3, first_blow=blow, blow_loss=blow_loss, steps_lost=lost)
