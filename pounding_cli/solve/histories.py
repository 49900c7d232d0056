"""Histories: what a scene does over time, at a uniform step that has nothing to do with the solver's own steps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class History:
    """A scene over time; n buildings of up to s storeys, m links, t times. NaN pads buildings with fewer storeys.

    time : (t,) from 0 in equal steps [s]
    ground_acceleration : (t,) [m/s2]
    ground_displacement : (t,) the acceleration integrated twice from rest, without a baseline correction [m]
    displacement : (t, n, s) of floors, relative to the ground [m]
    total_acceleration : (t, n, s) of floors, ground included [m/s2]
    drift : (t, n, s) of storeys, without what sway and rocking of the foundation add [m]
    shear : (t, n, s) restoring force of storeys, without damping force [N]
    sway, rocking : (t, n) displacement [m] and rotation [rad] of the foundation, 0 on a fixed base
    link_force : (t, m) [N]; pulling is negative; NaN where the scene has no such link
    buildings, links : names, left to right; `left|right floor j`
    """

    time: np.ndarray
    ground_acceleration: np.ndarray
    ground_displacement: np.ndarray
    displacement: np.ndarray
    total_acceleration: np.ndarray
    drift: np.ndarray
    shear: np.ndarray
    sway: np.ndarray
    rocking: np.ndarray
    link_force: np.ndarray
    buildings: tuple[str, ...]
    links: tuple[str, ...]
