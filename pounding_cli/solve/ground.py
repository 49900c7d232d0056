"""The ground motion as the kernels take it: a straight line in every segment."""

from __future__ import annotations

import numpy as np

from pounding_cli.model.scene import Scene


def segments_of(scene: Scene) -> int:
    """Number of segments of the ground motion, tail included."""
    return scene.motion.acceleration.size - 1 + _still(scene)


def _still(scene: Scene) -> int:
    return int(np.ceil(scene.tail / scene.motion.dt - 1e-9)) if scene.tail > 0 else 0


def segments(scene: Scene) -> tuple[np.ndarray, np.ndarray, float]:
    """(acceleration at each segment's start [m/s2], its slope [m/s3], length of a segment [s]); a tail is still
    ground."""
    motion = scene.motion
    starts = motion.acceleration[:-1].copy()
    slopes = np.diff(motion.acceleration) / motion.dt
    if scene.tail > 0:
        still = np.zeros(_still(scene))
        starts, slopes = np.concatenate((starts, still)), np.concatenate((slopes, still))  # fault: ground-in-tail
    return starts, slopes, motion.dt
