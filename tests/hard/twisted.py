"""Random plans for the floors of a scene, and random places for its links: the same ones for one seed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

import pounding_cli as pound
from tests.adapter import Building, FloorPlan, FrameLine, Link, is_wall

SHARE_OF_PLANS = 0.8
"""Part of the buildings that get a plan, and of the links that get places of their own [-]."""


def twist_scene(scene: pound.Scene, seed: int) -> pound.Scene:
    """Return a scene whose floors twist, at least in part; the same motion, storeys and laws.

    Raises
    ------
    ValueError : P-Delta turns the floors of a storey from rest
    """
    random = np.random.default_rng([seed, 55])
    buildings = [add_plan(building, random) for building in scene.buildings]
    links = [part for link in scene.links for part in _place_link(link, buildings, random)]
    return replace(scene, buildings=tuple(buildings), links=tuple(dict.fromkeys(links)))


def add_plan(building: Building, random: np.random.Generator) -> Building:
    """Return a building with a plan; a wall, and one in five others, as it is."""
    if is_wall(building) or random.random() > SHARE_OF_PLANS:
        return building
    width, depth = random.uniform(8.0, 40.0), random.uniform(8.0, 40.0)
    inertia = building.mass * (width**2 + depth**2) / 12.0 * 10 ** random.uniform(-0.7, 0.7)
    low = -width * random.uniform(0.3, 0.7)
    high = low + width
    is_symmetric = random.random() < 0.15
    count = 2 if is_symmetric else int(random.integers(1, 5))
    places = [0.5 * low, -0.5 * low] if is_symmetric else random.uniform(low, high, count).tolist()
    shares = _shares(random, count, building.storeys, is_symmetric)
    strengths = _shares(random, count, building.storeys, is_symmetric)
    lines = tuple(
        FrameLine(str(number), place, share * building.stiffness, strength * building.yield_shear)
        for number, (place, share, strength) in enumerate(zip(places, shares, strengths, strict=True))
    )
    arms = np.array(places)[:, None]
    about_centre = np.sum(shares * building.stiffness * arms**2, axis=0) + building.stiffness * 4.0
    torsional = about_centre * 10 ** random.uniform(-1.5, 1.0)
    across = _lines_across(building, torsional, depth, random) if random.random() < 0.35 else ()
    plan = FloorPlan(inertia, lines, torsional, across, low=low, high=high, twists_always=True)
    return replace(building, plan=plan, stiffness=plan.stiffness, yield_shear=plan.yield_shear)


def _shares(random: np.random.Generator, count: int, storeys: int, is_symmetric: bool) -> np.ndarray:
    """Return the parts of a storey that its lines have [-], shape (count, storeys); they add up to 1."""
    if is_symmetric:
        return np.full((count, storeys), 1.0 / count)
    sizes = 10 ** random.uniform(-1.0, 1.0, (count, storeys if random.random() < 0.5 else 1))
    shares = sizes / sizes.sum(axis=0)
    return np.broadcast_to(shares, (count, storeys))


def _lines_across(
    building: Building, torsional: np.ndarray, depth: float, random: np.random.Generator
) -> tuple[FrameLine, ...]:
    """Return one or two lines across the row that yield where the storeys do."""
    lines = []
    for number in range(int(random.integers(1, 3))):
        place = depth * float(random.choice([1.0, 0.5, 0.1, 1.0 / depth])) * float(random.choice([-1.0, 1.0]))
        stiffness = torsional / place**2 * random.uniform(0.2, 5.0)
        strength = building.yield_shear * random.uniform(0.2, 2.0)
        lines.append(FrameLine(f"across {number}", place, stiffness, strength))
    return tuple(lines)


def _place_link(link: Link, buildings: Sequence[Building], random: np.random.Generator) -> list[Link]:
    """Return a link at one place or two of the floors that it joins, or as it is."""
    if random.random() > SHARE_OF_PLANS:
        return [link]
    left, right = buildings[link.left : link.left + 2]
    placed = []
    for _ in range(int(random.integers(1, 3))):
        left_arm, right_arm = (_draw_place(building, random) for building in (left, right))
        placed.append(replace(link, left_arm=left_arm, right_arm=right_arm))
    return placed


def _draw_place(building: Building, random: np.random.Generator) -> float:
    """Return a place across the row on the floors of a building, often an edge [m]."""
    if building.plan is None:
        return 0.0
    low, high = building.plan.low, building.plan.high
    return float(random.choice([low, high, random.uniform(low, high), 0.0]))
