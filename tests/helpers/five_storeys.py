"""Two 5-storey buildings and a short motion, for tests of the solver."""

from __future__ import annotations

import numpy as np

from pounding_cli.laws.dashpot import damping_ratio
from pounding_cli.laws.pounding import Pounding
from pounding_cli.model.building import Building
from pounding_cli.model.code_design import UbcDesign
from pounding_cli.model.links import Link
from pounding_cli.model.stiffness import rayleigh_factors, stiffness_for_period
from pounding_cli.records import Motion


def building(name: str, period: float, storeys: int = 5) -> Building:
    """200 t, 3 m, taper 1/3, 5 % damping, UBC 1991 yield shears, hardening 0.05."""
    mass, height = np.full(storeys, 200e3), np.full(storeys, 3.0)
    stiffness = stiffness_for_period(mass, period, 1 / 3)
    alpha, beta = rayleigh_factors(mass, stiffness, 0.05)
    design = UbcDesign(1991, zone=0.4, soil=1.2, importance=1.0, rw=12.0)
    shear = design.yield_shears(mass, height, period)
    return Building(name, mass, height, stiffness, shear, np.full(storeys, 0.05), alpha, beta)


def pair() -> tuple[Building, Building]:
    return building("stiff", 0.36), building("soft", 0.60)


def pounding(buildings: tuple[Building, ...], gap: float, **more) -> tuple[Link, ...]:
    stiffness = 20 * max(float(b.stiffness.max()) for b in buildings)
    floors = range(1, min(b.storeys for b in buildings) + 1)
    return tuple(
        Link(left, floor, floor, Pounding(gap, stiffness, damping_ratio(0.5), **more))
        for left in range(len(buildings) - 1)
        for floor in floors
    )


def motion(duration: float = 3.0, dt: float = 0.01) -> Motion:
    """Two sines under a half-sine envelope, 0.4 g."""
    t = np.arange(round(duration / dt) + 1) * dt
    shape = np.sin(np.pi * t / duration) * (np.sin(2 * np.pi * 2.1 * t) + 0.6 * np.sin(2 * np.pi * 3.7 * t))
    return Motion("two sines", dt, 4.0 * shape / np.abs(shape).max())
