"""Methods of fixed time steps, as most programs have them: for what accuracy costs, and as an independent check.

They step over contacts and yields, and see peaks at the ends of steps alone.

Sources: Newmark (1959), with beta = 1/4 and gamma = 1/2; central difference with half-step velocities, Bathe, Finite
Element Procedures (1996), section 9.2.1."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numba import njit

from pounding_cli.laws.guards import FASTER, HIGH, LOW, SIGN_CHANGE, SLOWER
from pounding_cli.model.links import Link
from pounding_cli.solver.dispatch import compute_force, compute_line_force, compute_smooth_force, next_branch
from pounding_cli.solver.layout import Layout, build_term_matrix
from pounding_cli.solver.options import CALLED, KERNEL, PART
from pounding_cli.solver.records import COLLAPSED, DONE, NO_ROOT, NOT_FINITE
from pounding_cli.solver.run import begin_run
from pounding_cli.solver.series import push, push_by_storey
from pounding_cli.solver.step_end import deform_elements

MAX_BRANCHES = 8
"""Branches that an element passes in a step, at most."""

MAX_ITERATIONS = 25
"""Of Newton's method in a step."""

CONVERGED = 1e-11
"""Part of the forces that Newton's method may leave [-]."""

MIN_PART = 1.0 / 1024.0
"""Part of a step into which one without a root is cut, at least."""

FIXED = ("central-difference", "newmark")
"""The methods of this file: `march` calls each by its place here."""

HEAVY = 1e200
"""Mass of what does not move [kg]."""

SLOPE_STEP = 1e-7
"""Part of a rate and of a deformation by which slopes of a force are taken."""


@njit(**CALLED)
def _settle(el, formula):
    """Let an element pass the guards that lie between its branch and its state at the end of the step."""
    for _ in range(MAX_BRANCHES):
        guard = -1
        if el.v1 < el.low:
            guard = LOW
        elif el.v1 > el.high:
            guard = HIGH
        elif el.r1 < el.slow:
            guard = SLOWER
        elif el.r1 > el.fast:
            guard = FASTER
        elif el.cuts:
            f = compute_force(el, el.v1, el.r1, formula)
            if (f < 0.0 and el.acts) or (f > 0.0 and not el.acts):
                guard = SIGN_CHANGE
        if guard < 0:
            return
        was_open = el.closed == 0
        next_branch(el, guard)
        if was_open and el.closed:
            el.hits += 1


@njit(**CALLED)
def add_forces(dofs, elements, terms, run, room, ground):
    """Add the forces of all elements at the end of a step to `push` of the degrees of freedom: a = -push / mass.

    The displacements u1 and velocities v1 deform the elements first, and put them on the branches that they have
    reached.
    """
    deform_elements(dofs, elements, terms, run)
    for i in range(run.n):
        dof = dofs[i]
        dof.push = dof.mass * (dof.loaded * ground + dof.drag * dof.v1)
    for e in range(run.m):
        el = elements[e]
        formula = room.formulas[el.formula]
        _settle(el, formula)
        if e < run.n:
            push_by_storey(dofs, el, e, compute_line_force(el, el.v1, el.r1), run.has_lean)
        elif el.closed and el.acts:
            push(dofs, terms, el, compute_force(el, el.v1, el.r1, formula))


@njit(**CALLED)
def _end_step(dofs, elements, terms, run, columns, room, h):
    """Enter a step into the largest values, and into the forces of links and struck columns."""
    run.steps += 1
    for i in range(run.n):
        dof = dofs[i]
        dof.u_max = max(dof.u_max, dof.u1)
        dof.u_min = min(dof.u_min, dof.u1)
        dof.a_max = max(dof.a_max, abs(dof.a1))
        if not abs(dof.u1) < 1e300:
            run.status = NOT_FINITE
        dof.u0 = dof.u1
        dof.w[0] = dof.v1
        dof.a0 = dof.a1
    for e in range(run.m):
        el = elements[e]
        el.peak_v = max(el.peak_v, abs(el.v1) if el.drifts else el.v1)
        if el.drifts:
            el.peak_f = max(el.peak_f, abs(el.k * el.v1 + el.f0))
            if abs(el.v1) > el.collapse:
                run.status = COLLAPSED
        elif el.closed and el.acts:
            f = compute_force(el, el.v1, el.r1, room.formulas[el.formula])
            el.peak_f = max(el.peak_f, abs(f))
            el.impulse += f * h
            el.time += h
        el.v0 = el.v1
        el.r0 = el.r1
    for c in range(run.columns):
        column = columns[c]
        el = elements[column.storey]
        if column.is_sum:
            twist = elements[el.mate].v1
            column.peak_low = max(column.peak_low, abs(el.v1 + column.low * twist))
            column.peak_high = max(column.peak_high, abs(el.v1 + column.high * twist))
        f = column.share * (el.k * el.v1 + el.f0)
        for x in range(column.first, column.last):
            link = elements[terms[x].dof]
            if link.closed and link.acts:
                dashpot = link.c * link.r1 if link.drifts else 0.0  # shears of lines are without damping forces
                f += terms[x].weight * (compute_force(link, link.v1, link.r1, room.formulas[link.formula]) - dashpot)
        column.peak = max(column.peak, abs(f))


@njit(**PART)
def _step_by_central_difference(dofs, elements, terms, run, room, half, h, ground, is_first):
    """Take a step by central difference; return True, since it always finds an end.

    u' half a step later follows from u'' now, and u a step later from that. Damping forces take the velocity
    extrapolated from two half steps, so that nothing is solved for.

    half : velocities half a step before, and then half a step later
    """
    for i in range(run.n):
        dof = dofs[i]
        acceleration = dof.a0 - dof.loaded * run.g0
        before = dof.w[0] if is_first else half[i]
        half[i] = before + (0.5 * h if is_first else h) * acceleration
        dof.u1 = dof.u0 + h * half[i]
        dof.v1 = 1.5 * half[i] - 0.5 * before
    add_forces(dofs, elements, terms, run, room, ground)
    for i in range(run.n):
        dof = dofs[i]
        dof.a1 = -dof.push * dof.inv_mass + dof.loaded * ground
    return True


@njit(**PART)
def _find_slopes(el, formula):
    """Return dF/dv [N/m] and dF/dv' [N s/m] of an element at the end of the step."""
    k = el.k - el.load
    c = el.c
    if el.cubic != 0.0:
        root = math.sqrt(el.k + 3.0 * el.cubic * el.v1 * el.v1)
        k += 3.0 * el.cubic * el.v1 * el.v1 + el.root * 3.0 * el.cubic * el.v1 * el.r1 / root
        c += el.root * root
    if el.smooth:
        f = compute_smooth_force(el, el.v1, el.r1, formula)
        dv = SLOPE_STEP * max(abs(el.v1), SLOPE_STEP)
        dr = SLOPE_STEP * max(abs(el.r1), SLOPE_STEP)
        k += (compute_smooth_force(el, el.v1 + dv, el.r1, formula) - f) / dv
        c += (compute_smooth_force(el, el.v1, el.r1 + dr, formula) - f) / dr
    return k, c


@njit(**CALLED)
def _build_matrix(dofs, elements, run, room, h, shape):
    """Return M + h/2 C + h^2/4 K at the end of the step [kg], shape (n, n).

    shape : of the deformation of every element from the displacements, as of `build_term_matrix`
    """
    size = np.zeros(run.m)
    for e in range(run.m):
        el = elements[e]
        k, c = _find_slopes(el, room.formulas[el.formula])
        size[e] = el.acts * (0.25 * h * h * k + 0.5 * h * c)
    rows = np.dot(shape.T * size, shape)
    for i in range(run.n):
        dof = dofs[i]
        rows[i, i] += dof.mass * (1.0 + 0.5 * h * dof.drag) if dof.inv_mass > 0.0 else HEAVY
    return rows


@njit(**PART)
def _step_by_newmark(dofs, elements, terms, run, room, memory, shape, h, ground):
    """Take a step of average acceleration by Newton's method; return whether it found a root.

    memory : the elements as plain numbers, to begin every try from the branches of the step's start
    shape : as of `_build_matrix`
    """
    n = run.n
    residual = np.zeros(run.n)
    memory_at_start = memory.copy()
    for i in range(n):  # as a first guess the acceleration stays
        dofs[i].a1 = dofs[i].a0 - dofs[i].loaded * (run.g0 - ground)
    for _ in range(MAX_ITERATIONS):
        for i in range(n):
            dof = dofs[i]
            sum_of_accelerations = dof.a0 - dof.loaded * run.g0 + dof.a1 - dof.loaded * ground
            dof.u1 = dof.u0 + h * dof.w[0] + 0.25 * h * h * sum_of_accelerations
            dof.v1 = dof.w[0] + 0.5 * h * sum_of_accelerations
        memory[:] = memory_at_start
        add_forces(dofs, elements, terms, run, room, ground)
        largest_residual = largest_force = 0.0
        for i in range(n):
            dof = dofs[i]
            inertia = dof.mass * (dof.a1 - dof.loaded * ground)
            residual[i] = -(inertia + dof.push) if dof.inv_mass > 0.0 else 0.0
            largest_residual = max(largest_residual, abs(residual[i]))
            largest_force = max(largest_force, max(abs(inertia), abs(dof.push)))
        if largest_residual <= CONVERGED * largest_force:
            return True
        if not largest_force < 1e300:
            break
        correction = np.linalg.solve(_build_matrix(dofs, elements, run, room, h, shape), residual)
        for i in range(n):
            dofs[i].a1 += correction[i]
    memory[:] = memory_at_start
    return False


@njit(**KERNEL)
def march(dofs, elements, terms, runs, series, columns, room, ground, slopes, memory, shape, parts, method, stop):
    """Run a scene in `parts` equal steps a sample of the motion, by a method of `FIXED`.

    memory : the elements as plain numbers
    shape : the deformation of every element from the displacements
    stop : flag (`stopping`); where it is raised, the kernel returns and the scene is not done

    Raises
    ------
    LinAlgError : the matrix of Newton's method is singular
    """
    run = runs[0]
    if not run.resumes:
        begin_run(dofs, elements, terms, run, series)
    half = np.zeros(run.n)
    run.g0 = ground[0]
    add_forces(dofs, elements, terms, run, room, run.g0)
    for i in range(run.n):
        dofs[i].a0 = -dofs[i].push * dofs[i].inv_mass + dofs[i].loaded * run.g0
    whole = run.dt / parts
    is_first = True
    for segment in range(ground.size):
        elapsed = 0.0
        h = whole
        length = run.rest if segment + 1 == ground.size else run.dt
        while run.status == DONE and elapsed < length * (1.0 - 1e-12):
            if stop[0]:
                return
            h = min(h, length - elapsed)
            if abs(h - whole) < 1e-9 * whole:
                h = whole
            run.g0 = ground[segment] + slopes[segment] * elapsed
            g1 = ground[segment] + slopes[segment] * (elapsed + h)
            if method == 0:
                has_root = _step_by_central_difference(dofs, elements, terms, run, room, half, h, g1, is_first)
            else:
                has_root = _step_by_newmark(dofs, elements, terms, run, room, memory, shape, h, g1)
            if not has_root:
                run.trials += 1
                h *= 0.5
                if h < MIN_PART * whole:
                    run.status = NO_ROOT
                continue
            is_first = False
            _end_step(dofs, elements, terms, run, columns, room, h)
            elapsed += h
            run.time = segment * run.dt + elapsed
            h = whole
        if run.status != DONE:
            break


def find_longest_stable_step(layout: Layout, elements: np.ndarray, links: Sequence[Link]) -> float:
    """Return the longest stable time step of central difference with extrapolated damping forces [s].

    Every link counts as closed where its law is stiffest; modal coupling by damping is left out. In every mode the
    limit is 2 (sqrt(1 + 4 xi^2) - 2 xi) / omega; 2 / omega without damping. With u_n and the half-step velocity
    alternating in sign (amplification -1) the scheme gives (h omega)^2 + 8 xi h omega = 4.
    """
    rows = build_term_matrix(layout)
    mass = layout.dofs["mass"]
    n = layout.number
    k = np.zeros(len(rows))
    c = np.zeros(len(rows))
    k[:n] = elements["p"][:n, 0]
    c[:n] = elements["c"][:n]
    drags = slice(n, layout.of_lines.start)
    lines = layout.of_lines
    c[drags] = elements["p"][drags, 1]
    k[lines] = elements["p"][lines, 0]
    c[lines] = elements["c"][lines]
    for place, link in enumerate(links, layout.of_links.start):
        k[place], c[place] = link.law.max_slopes
        c[place] = max(c[place], elements["p"][place, 1] if link.law.joins else 0.0)
    stiffness = rows.T @ (k[:, None] * rows)
    damping = rows.T @ (c[:, None] * rows)
    damping[np.diag_indices(n)] += layout.dofs["drag"] * mass
    inverse = np.sqrt(layout.dofs["inv_mass"])
    squares, shapes = np.linalg.eigh(stiffness * np.outer(inverse, inverse))
    shapes *= inverse[:, None]
    omega = np.sqrt(np.maximum(squares, 0.0))
    moving = omega > 1e-9
    ratio = np.einsum("ij,ik,kj->j", shapes, damping, shapes)[moving] / (2 * omega[moving])
    return float(np.min(2 * (np.sqrt(1 + 4 * ratio**2) - 2 * ratio) / omega[moving]))
