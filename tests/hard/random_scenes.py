"""Random scenes by number: the same one every time, on every machine."""

from __future__ import annotations

import numpy as np

from pounding_cli.laws.connector import Connector
from pounding_cli.laws.dashpot import damping_ratio
from pounding_cli.laws.infill import Infill
from pounding_cli.laws.law import LinkLaw
from pounding_cli.laws.pounding import Pounding
from pounding_cli.model.building import Building
from pounding_cli.model.foundation import Foundation
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Analysis, Scene
from pounding_cli.model.stiffness import rayleigh_factors, stiffness_for_period
from pounding_cli.records.motion import Motion

ACCURACIES = (1e-3, 1e-6, 1e-9)


def random_scene(number: int) -> tuple[Scene, float]:
    """A row of one to six buildings, from tame to hostile, and the accuracy asked of it [-]."""
    random = np.random.default_rng(number)
    buildings = tuple(_building(random) for _ in range(random.choice([1, 2, 2, 2, 3, 4, 6])))
    links = tuple(link for left in range(len(buildings) - 1) for link in _links(random, buildings, left))
    dt = random.choice([0.001, 0.005, 0.01, 0.02, 0.05])
    samples = min(round(random.uniform(1.0, 8.0) / dt), 800)
    noise = np.convolve(random.normal(size=samples + 8), np.hanning(9)[1:-1], "valid")
    noise[0] = 0.0
    motion = Motion("noise", dt, noise * random.uniform(0.5, 20.0) / np.abs(noise).max())
    analysis = Analysis(random.choice(list(Analysis)))
    tail = float(random.choice([0.0, 0.0, 0.5]))
    return Scene(buildings, links, motion, analysis, tail), float(random.choice(ACCURACIES))


def _building(random: np.random.Generator) -> Building:
    storeys = random.integers(1, 7)
    mass, height = random.uniform(5e4, 5e5, storeys), np.full(storeys, 3.0)
    stiffness = stiffness_for_period(mass, 0.1 * storeys * random.uniform(0.3, 3.0), random.uniform(0.1, 1.0))
    strength = np.cumsum(mass[::-1])[::-1] * 9.81 * random.uniform(0.02, 0.5)
    factors = rayleigh_factors(mass, stiffness, random.choice([0.0, 0.02, 0.05, 0.05, 0.2, 0.99]))
    foundation = None
    if random.random() < 0.25:
        sway, rock = stiffness.max() * 10 ** random.uniform(-1, 3), stiffness.max() * 10 ** random.uniform(1, 5)
        foundation = Foundation(mass[0], sway, 0.01 * sway, 1e7, rock, 0.01 * rock)
    hardening = np.full(storeys, random.choice([0.0, 0.02, 0.05, 0.3]))
    return Building("random", mass, height, stiffness, strength, hardening, *factors, foundation)


def _links(random: np.random.Generator, buildings: tuple[Building, ...], left: int) -> list[Link]:
    """One law at every floor, or one of its own at each; floors of one height meet."""
    two = buildings[left : left + 2]
    floors = range(1, min(b.storeys for b in two) + 1)
    common = _law(random, two) if random.random() < 0.7 else None
    return [Link(left, j, j, common or _law(random, two)) for j in floors]


def _law(random: np.random.Generator, two: tuple[Building, ...]) -> LinkLaw:
    kind = str(random.choice(["pounding", "infill", "connector"], p=[0.6, 0.2, 0.2]))
    gap = float(random.choice([0.0, 0.0, 1e-9, 1e-5, 0.002, 0.01, 0.03, 0.1]))
    spring = max(float(b.stiffness.max()) for b in two)
    impact = spring * 10 ** random.uniform(0.3, 3)
    stiffness = impact if kind == "pounding" else spring * 10 ** random.uniform(-2, 0)
    xi = damping_ratio(random.choice([0.01, 0.3, 0.5, 0.5, 0.8, 1.0]))
    cut = bool(random.random() < 0.5)
    if kind == "connector":
        return Connector(gap, stiffness, xi)
    return Infill(max(gap, 1e-3), stiffness, impact, xi, cut) if kind == "infill" else Pounding(gap, stiffness, xi, cut)
