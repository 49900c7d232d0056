"""The speed at which an oscillator under a harmonic motion strikes a wall, over the stiffness of the contact, for
docs/contact.md: `python docs/figures/impact_oscillator.py` makes the table.

x'' + x = cos(w t), with a wall at x = s that sends it back with the part r of its speed (Shaw & Holmes 1983). A blow
without duration gives the closed form of the motion that strikes once in a period of the force, `speed_of_rigid_blow`.
"""

from __future__ import annotations

from math import cos, pi, sin, sqrt
from pathlib import Path

import numpy as np

import pounding_cli as pound
from pounding_cli.model.wall import Wall

FREQUENCY, RESTITUTION, WALL = 2.0, 0.5, 0.1
"""w [rad/s], r [-], s [m]."""

STIFFNESSES = (5.0, 100.0, 1e3, 1e4, 1e5, 1e6)
"""Of the contact over that of the oscillator [-]."""

PERIODS = (60, 90)
"""Between these numbers of periods of the force the blows are counted: the motion is steady."""

SAMPLES = 200
"""Of a period of the force."""

PAGE = Path(__file__).parents[1] / "contact.md"


def speed_of_rigid_blow() -> float:
    """Return the speed of a blow without duration [m/s], of a motion that strikes once in a period T of the force.

    After a blow at t = 0 with the speed v, x = a cos t + b sin t + p cos(w t + phase) with p = 1 / (1 - w^2), where
    x(0) = x(T) = s, x'(0) = -r v and x'(T) = v.
    """
    w, r = FREQUENCY, RESTITUTION
    period, p = 2 * pi / w, 1 / (1 - w**2)
    c, d = cos(period), sin(period)
    # of x(0) = x(T): a (c - 1) + b d = 0, and of x'(T) - x'(0): -a d + b (c - 1) = (1 + r) v
    a, b = np.linalg.solve([[c - 1, d], [-d, c - 1]], [0.0, 1 + r])  # for v = 1
    # p cos(phase) = s - a v, and -p w sin(phase) = -(r + b) v: the squares add up to p^2
    second, first, zeroth = a**2 + ((r + b) / w) ** 2, -2 * a * WALL, WALL**2 - p**2
    return float((-first + sqrt(first**2 - 4 * second * zeroth)) / (2 * second))


def speed_of_blow(stiffness: float) -> float:
    """Return the speed of the blows [m/s] from a contact of this stiffness [N/m]: impulse over (1 + r) m."""
    building = pound.building("oscillator", storeys=1, mass=1.0, stiffness=[1.0], yield_shear="never", damping=0.0)
    wall = Wall.build("wall", height=float(building.height[0]))
    impulses, impacts = [], []
    for periods in PERIODS:
        step = 2 * pi / FREQUENCY / SAMPLES
        times = step * np.arange(periods * SAMPLES + 1)
        ground = pound.motion(-np.cos(FREQUENCY * times), dt=step)
        impact = {"stiffness": stiffness, "restitution": RESTITUTION}
        scene = pound.scene([building, wall], ground, impact=impact, link="pounding", gap=WALL)
        links = pound.solve(scene, accuracy=1e-8).links
        impulses.append(float(links.impulse[0]))
        impacts.append(int(links.impacts[0]))
    return (impulses[1] - impulses[0]) / (impacts[1] - impacts[0]) / (1 + RESTITUTION)


def table() -> list[str]:
    """Return the lines of the table."""
    exact = speed_of_rigid_blow()
    lines = ["| contact over oscillator stiffness | speed of the blows [m/s] | off by |", "|---|---|---|"]
    for stiffness in STIFFNESSES:
        speed = speed_of_blow(stiffness)
        lines.append(f"| {stiffness:,.0f} | {speed:.5f} | {100 * (speed / exact - 1):+.2f} % |")
    return [*lines, f"| a blow without duration | {exact:.6f} | |"]


if __name__ == "__main__":
    text = PAGE.read_text(encoding="utf-8")
    begin, end = "<!-- oscillator: begin (python docs/figures/impact_oscillator.py) -->", "<!-- oscillator: end -->"
    before, rest = text.split(begin)
    _, after = rest.split(end)
    PAGE.write_text("\n".join([before + begin, "", *table(), "", end + after]), encoding="utf-8")
