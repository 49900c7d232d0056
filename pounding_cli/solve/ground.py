"""The ground motion as the kernels take it: a straight line in every segment."""

from __future__ import annotations

import numpy as np

from pounding_cli.model.scene import Scene


def segments(scene: Scene) -> tuple[np.ndarray, np.ndarray, float]:
    """(acceleration at each segment's start [m/s2], its slope [m/s3], length of a segment [s]); a tail is still
    ground."""
    motion = scene.motion
    starts = motion.acceleration[:-1].copy()
    slopes = np.diff(motion.acceleration) / motion.dt
    if scene.tail > 0:
        still = np.zeros(int(np.ceil(scene.tail / motion.dt - 1e-9)))
        starts, slopes = np.concatenate((starts, still)), np.concatenate((slopes, still))
    return starts, slopes, motion.dt
