"""The ground motion as the kernels take it: a straight line in every segment."""

from __future__ import annotations

import functools

import numpy as np

from pounding_cli.model.scene import Scene
from pounding_cli.records.motion import Motion


def segments_of(scene: Scene) -> int:
    """Number of segments of the ground motion, tail included."""
    return scene.motion.acceleration.size - 1 + _still(scene)


def _still(scene: Scene) -> int:
    return int(np.ceil(scene.tail / scene.motion.dt - 1e-9)) if scene.tail > 0 else 0


def segments(scene: Scene) -> tuple[np.ndarray, np.ndarray, float]:
    """(acceleration at each segment's start [m/s2], its slope [m/s3], length of a segment [s]); a tail is still
    ground. Scenes of one motion share the arrays; nothing writes to them."""
    return (*_segments(scene.motion, _still(scene)), scene.motion.dt)


@functools.lru_cache(maxsize=16)
def _segments(motion: Motion, still: int) -> tuple[np.ndarray, np.ndarray]:
    """(starts, slopes) of a motion and of so many segments of still ground."""
    starts, slopes = motion.acceleration[:-1], np.diff(motion.acceleration) / motion.dt
    tail = np.zeros(still)
    return np.concatenate((starts, tail)), np.concatenate((slopes, tail))
