"""A blow off the centre of a floor beside linear and angular momentum."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from comparison import Entry, Row, compare


def compare_eccentric_blow(solved: Any) -> Iterator[Row]:
    """Yield impulse, spin, speed and loss of the plate."""
    mass, speed, y, e = 2e5, 0.5, 10.0, 0.5
    inertia = mass * (30.0**2 + 20.0**2) / 12
    effective = 1 / (1 / mass + y**2 / inertia)
    impulse = (1 + e) * effective * speed
    links = solved.table("link")
    floors = solved.table("floor").sort_values("records.duration")
    lapse = floors["records.duration"].diff().iloc[-1]
    lost = solved.table("scene")["energy_links"].iloc[-1]
    why = "the contact lasts 23 ms; the storey resists with 1 N/m"
    yield compare("impulse [kN s]", 1e-3 * impulse, 1e-3 * links["impulse"].iloc[-1], ".3f", why)
    turning = floors["twist"].diff().iloc[-1] / lapse
    yield compare("rate of the twist after it [rad/s]", impulse * y / inertia, turning, ".5f", why)
    after = -floors["displacement_min"].diff().iloc[-1] / lapse
    yield compare("speed of the centre after it [m/s]", speed - impulse / mass, after, ".4f", why)
    yield compare("energy lost [kJ]", 5e-4 * effective * speed**2 * (1 - e**2), 1e-3 * lost, ".4f", why)


ENTRY = Entry(compare_eccentric_blow)
