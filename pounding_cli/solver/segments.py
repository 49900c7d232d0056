"""The ground motion of a scene as segments: between two samples the acceleration is linear, in a tail it is zero."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence

import numpy as np

from pounding_cli.model.scene import Scene
from pounding_cli.records.motion import Motion

WHOLE = 1e-9
"""Part of a time step of the motion [-] by which a tail may miss whole time steps and still have them."""

Segments = tuple[np.ndarray, np.ndarray]
"""Acceleration at the start of every segment of a motion [m/s2], and its slope [m/s3]."""


def build_segments(scene: Scene) -> Segments:
    """Return the segments of a scene's motion and tail.

    Scenes of one motion share the arrays; nothing writes to them.
    """
    return _split_motion(scene.motion, _count_tail_segments(scene))


@functools.lru_cache(maxsize=16)
def _split_motion(motion: Motion, tail_segments: int) -> Segments:
    """Return the segments of a motion with so many of still ground behind it."""
    still = np.zeros(tail_segments)
    starts = np.concatenate((motion.acceleration[:-1], still))
    slopes = np.concatenate((np.diff(motion.acceleration) / motion.dt, still))
    return starts, slopes


def _count_tail_segments(scene: Scene) -> int:
    """Return the number of segments of a scene's tail; the last may be shorter than a time step of its motion."""
    return math.ceil(scene.tail / scene.motion.dt - WHOLE)


def find_last_segment(scene: Scene) -> float:
    """Return the length of a scene's last segment [s]: a tail ends where it is asked to."""
    dt = scene.motion.dt
    count = _count_tail_segments(scene)
    if count == 0 or abs(scene.tail - count * dt) <= WHOLE * dt:
        return dt
    return scene.tail - (count - 1) * dt


def find_run_time(scene: Scene) -> float:
    """Return the time that a run of a scene covers, its motion and its tail [s]."""
    starts, _ = build_segments(scene)
    return (starts.size - 1) * scene.motion.dt + find_last_segment(scene)


def join_segments(segments: Sequence[Segments]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the segments of scenes one after the other, and of every scene where its own end, shape (scenes,)."""
    starts, slopes = zip(*segments, strict=True)
    ends = np.cumsum([each.size for each in starts])
    return np.concatenate(starts), np.concatenate(slopes), ends
