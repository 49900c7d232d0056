"""Elastic blows of spheres beside the figures of a benchmark and the closed form of Hertz."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from comparison import Entry, Row, compare
from scipy.special import beta


def find_hertz_blow(mass: float, stiffness: float, speed: float) -> tuple[float, float]:
    """Return the largest force [N] and the duration [s] of a blow on a contact F = k_h v^1.5 without damping.

    Source: the energy (1/2) m v0^2 = (2/5) k_h v_max^2.5; the duration is the integral of dv / v' over the blow.
    """
    closing = (1.25 * mass * speed**2 / stiffness) ** 0.4
    return stiffness * closing**1.5, 0.8 * beta(0.4, 0.5) * closing / speed


BLOWS = (
    ("two spheres of glass", 5.864306e-3, 2.357023e9, 20.0, 10.70, 40.5),
    ("a sphere of aluminium on a plane", 11.305545, 3.243367e10, 0.2, 11.36, 726.6),
)
"""What strikes, its mass [kg], stiffness k_h [N/m^1.5] and speed [m/s]; force [kN] and duration [us] of the figures."""


def compare_hertz_impact(solved: Any) -> Iterator[Row]:
    """Yield the largest force and the duration of each blow."""
    blows = solved.table("link").set_index("impact.hertz_stiffness")
    why = "read off a figure; Hertz's closed form gives {:{}}"
    for what, mass, stiffness, speed, force, duration in BLOWS:
        exact_force, exact_duration = find_hertz_blow(mass, stiffness, speed)
        ours = blows.loc[stiffness]
        reason = why.format(1e-3 * exact_force, ".3f")
        yield compare(f"largest force, {what} [kN]", force, 1e-3 * ours["peak_force"], ".2f", reason)
        reason = why.format(1e6 * exact_duration, ".2f")
        yield compare(f"duration, {what} [us]", duration, 1e6 * ours["contact_time"], ".1f", reason)


ENTRY = Entry(compare_hertz_impact)
