"""What the rows of single blows read from a history: when two floors meet and part, where one is, and how fast."""

from __future__ import annotations

from typing import Any

import numpy as np


class Meeting:
    """The history of a scene with one link.

    history : of `Results.history`
    gap : of the link [m]
    building : whose highest floor is asked about
    """

    def __init__(self, history: Any, gap: float, building: str) -> None:
        data = history.dataset
        self.times = data["time"].values
        self.closing = data["closing"].values[:, 0].astype(float) - gap
        self.force = data["link_force"].values[:, 0].astype(float)
        floors = data["displacement"].sel(building=building).values.astype(float)
        self.floor = floors[:, np.isfinite(floors[0])][:, -1]

    def find_contacts(self) -> np.ndarray:
        """Return the times at which the floors meet, between the samples [s]."""
        return self._cross(self.closing)

    def find_partings(self) -> np.ndarray:
        """Return the times at which they part [s]."""
        return self._cross(-self.closing)

    def find_peaks(self) -> np.ndarray:
        """Return the time of the largest force of every contact that has ended [s]."""
        spans = zip(self.find_contacts(), self.find_partings(), strict=False)
        inside = [np.flatnonzero((self.times >= start) & (self.times <= end)) for start, end in spans]
        return np.array([self.times[at[np.argmax(self.force[at])]] for at in inside])

    def displacement(self, time: float) -> float:
        """Return the displacement of the floor relative to the ground at a time [m]."""
        return float(np.interp(time, self.times, self.floor))

    def speed(self, time: float) -> float:
        """Return the speed of the floor relative to the ground at a time, from two samples [m/s]."""
        return float(np.interp(time, self.times, np.gradient(self.floor, self.times)))

    def _cross(self, values: np.ndarray) -> np.ndarray:
        """Return the times at which values rise through zero [s]."""
        before = np.flatnonzero((values[:-1] < 0) & (values[1:] >= 0))
        part = values[before] / (values[before] - values[before + 1])
        return self.times[before] + part * np.diff(self.times)[before]
