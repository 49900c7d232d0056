"""A building alone by scipy and numpy: modes of a Rayleigh-damped shear building under a ground of straight lines.

All three are exact at the samples they step to; peaks between them are not looked for, so finer samples are what
accuracy costs here. `prepare` returns the march alone, without eigenvalues and discretization.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy.linalg
import scipy.signal

from pounding_cli.model.scene import Scene

March = Callable[[], tuple[np.ndarray, np.ndarray]]
"""Peak storey shears [N] and peak total floor accelerations [m/s2]."""


class Modes:
    """The modes of the one building of a scene, and its ground cut into `parts` a sample."""

    def __init__(self, scene: Scene, parts: int) -> None:
        (building,) = scene.buildings
        assert scene.analysis == "elastic"
        assert building.foundation is None
        squares, self.shapes = scipy.linalg.eigh(building.stiffness_matrix, np.diag(building.mass))
        self.squares = squares
        self.damping = building.alpha + building.beta * squares  # 2 xi omega of each mode
        self.shares = self.shapes.T @ building.mass
        drift = self.shapes - np.vstack((np.zeros(len(squares)), self.shapes[:-1]))
        self.to_shear = building.stiffness[:, None] * drift
        coarse = scene.motion.acceleration
        self.dt = scene.motion.dt / parts
        at = np.arange((coarse.size - 1) * parts + 1) / parts
        self.ground = np.interp(at, np.arange(coarse.size), coarse)

    def peaks(self, q: np.ndarray, pull: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """From modal coordinates and modal spring and damper pulls, shape (modes, samples)."""
        return np.abs(self.to_shear @ q).max(axis=1), np.abs(self.shapes @ pull).max(axis=1)


def filtered(scene: Scene, parts: int) -> March:
    """`scipy.signal.lfilter`, two recursive filters a mode, from a first-order hold."""
    modes = Modes(scene, parts)
    filters = []
    for square, damping, share in zip(modes.squares, modes.damping, modes.shares, strict=True):
        for numerator in ([share], [damping * share, square * share]):
            b, a, _ = scipy.signal.cont2discrete((numerator, [1.0, damping, square]), modes.dt, "foh")
            filters.append((b.ravel(), a))

    def march() -> tuple[np.ndarray, np.ndarray]:
        out = np.array([scipy.signal.lfilter(b, a, modes.ground) for b, a in filters])
        return modes.peaks(out[0::2], out[1::2])

    return march


def simulated(scene: Scene, parts: int) -> March:
    """`scipy.signal.lsim`, all modes in one system."""
    modes = Modes(scene, parts)
    n = len(modes.squares)
    a = np.block([[np.zeros((n, n)), np.eye(n)], [-np.diag(modes.squares), -np.diag(modes.damping)]])
    b = np.concatenate((np.zeros(n), modes.shares))[:, None]
    c = np.block([[np.eye(n), np.zeros((n, n))], [np.diag(modes.squares), np.diag(modes.damping)]])
    system, at = (a, b, c, np.zeros((2 * n, 1))), np.arange(modes.ground.size) * modes.dt

    def march() -> tuple[np.ndarray, np.ndarray]:
        _, out, _ = scipy.signal.lsim(system, modes.ground, at)
        return modes.peaks(out[:, :n].T, out[:, n:].T)

    return march


def stepped(scene: Scene, parts: int) -> March:
    """An exact step of all modes at once in numpy, sample after sample."""
    modes = Modes(scene, parts)
    n = len(modes.squares)
    whole = np.zeros((n, 4, 4))
    whole[:, 0, 1], whole[:, 2, 3] = 1.0, 1.0
    whole[:, 1, 0], whole[:, 1, 1], whole[:, 1, 2] = -modes.squares, -modes.damping, modes.shares
    step = scipy.linalg.expm(whole * modes.dt)
    later = step[:, :2, 3] / modes.dt  # of the ground's next sample; what is left goes with this one
    here, next_ = step[:, :2, 2] - later, later
    drive = modes.ground[:-1, None, None] * here + modes.ground[1:, None, None] * next_
    own, rate = np.ascontiguousarray(step[:, :2, 0]), np.ascontiguousarray(step[:, :2, 1])

    def march() -> tuple[np.ndarray, np.ndarray]:
        z = np.zeros((modes.ground.size, n, 2))
        for j, push in enumerate(drive):
            z[j + 1] = own * z[j, :, :1] + rate * z[j, :, 1:] + push
        pull = modes.squares * z[..., 0] + modes.damping * z[..., 1]
        return modes.peaks(z[..., 0].T, pull.T)

    return march
