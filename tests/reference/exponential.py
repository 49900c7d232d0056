"""Exact stepping of linear scenes (no pounding, no infill, no yield) by the matrix exponential."""

from __future__ import annotations

import numpy as np
from scipy.linalg import expm

from pounding_cli import Scene
from tests.reference.assembly import coordinates, ground, reduced_mass, start


def march(scene: Scene, initial=None) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times (k,) [s], floor and foundation displacements (k, N) and velocities (k, N) at the ground motion's
    samples.

    The force is a straight line between samples, so with z = (q, q', a_g, a_g') the motion is z' = A z: exact
    to rounding.
    """
    c = coordinates(scene)
    stiffness = c.springs + c.drift.T @ (c.stiffness[:, None] * c.drift)
    damping = c.damping.copy()
    for e, link in enumerate(scene.links):
        assert link.kind == "connector", "only connectors are linear"
        pair = np.outer(c.closing[e], c.closing[e])
        stiffness += link.law.stiffness * pair
        damping += 2 * link.law.damping_ratio * np.sqrt(link.law.stiffness * reduced_mass(scene, e)) * pair
    n = c.mass.size
    a = np.zeros((2 * n + 2, 2 * n + 2))
    a[:n, n : 2 * n] = np.eye(n)
    a[n : 2 * n, :n] = -stiffness / c.mass[:, None]
    a[n : 2 * n, n : 2 * n] = -damping / c.mass[:, None]
    a[n : 2 * n, 2 * n] = -c.loaded / c.mass
    a[2 * n, 2 * n + 1] = 1.0

    q, rate = start(scene, c, initial)
    times, state = [0.0], [np.concatenate((q, rate))]
    step, length = None, None
    for t0, t1, acceleration, slope in ground(scene):
        if length is None or abs(t1 - t0 - length) > 1e-12:
            step, length = expm(a * (t1 - t0)), t1 - t0
        z = step @ np.concatenate((state[-1], [acceleration, slope]))
        times.append(t1)
        state.append(z[: 2 * n])
    array = np.array(state)
    return np.array(times), array[:, :n], array[:, n:]
