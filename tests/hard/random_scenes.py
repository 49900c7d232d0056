"""Random scenes by number: the same one every time, on every machine."""

from __future__ import annotations

from typing import Any

import numpy as np

from tests.adapter import Scene

ACCURACIES = (1e-3, 1e-6, 1e-9)


def random_scene(number: int) -> tuple[Scene, float]:
    """A row of one to six buildings, from tame to hostile, and the accuracy asked of it [-]."""
    random = np.random.default_rng(number)
    buildings = [_building(random) for _ in range(random.choice([1, 2, 2, 2, 3, 4, 6]))]
    case, impact = _case(random)
    dt = float(random.choice([0.001, 0.005, 0.01, 0.02, 0.05]))
    samples = min(round(random.uniform(1.0, 8.0) / dt), 800)
    noise = np.convolve(random.normal(size=samples + 8), np.hanning(9)[1:-1], "valid")
    noise[0] = 0.0
    ground = noise * random.uniform(0.5, 20.0) / np.abs(noise).max()
    analysis = str(random.choice(["elastic", "inelastic"]))
    tail = float(random.choice([0.0, 0.0, 0.5]))
    return Scene(buildings, ground, dt, case, analysis, {"impact": impact}, tail), float(random.choice(ACCURACIES))


def _building(random: np.random.Generator) -> dict[str, Any]:
    storeys = int(random.integers(1, 7))
    mass = random.uniform(5e4, 5e5, storeys)
    strength = np.cumsum(mass[::-1])[::-1] * 9.81 * random.uniform(0.02, 0.5)
    period = 0.1 * storeys * random.uniform(0.3, 3.0)
    building = {
        "storeys": storeys, "mass": mass.tolist(), "period": period, "taper": random.uniform(0.1, 1.0),
        "damping": float(random.choice([0.0, 0.02, 0.05, 0.05, 0.2, 0.99])), "yield_shear": strength.tolist(),
        "hardening": float(random.choice([0.0, 0.02, 0.05, 0.3])), "collapse": "never",
    }  # fmt: skip
    if random.random() < 0.25:
        stiffness = mass.sum() * (2 * np.pi / period) ** 2 * storeys
        sway, rock = stiffness * 10 ** random.uniform(-1, 3), stiffness * 10 ** random.uniform(1, 5)
        building["foundation"] = {
            "mass": mass[0], "sway_stiffness": sway, "sway_damping": 0.01 * sway, "inertia": 1e7,
            "rocking_stiffness": rock, "rocking_damping": 0.01 * rock,
        }  # fmt: skip
    return building


def _case(random: np.random.Generator) -> tuple[dict[str, Any], dict[str, Any]]:
    """One law on all floors, or another on the first, and the impact element."""
    gap = float(random.choice([0.0, 0.0, 1e-9, 1e-5, 0.002, 0.01, 0.03, 0.1]))
    impact = {
        "stiffness": f"{10 ** random.uniform(0.3, 3):.6g} x stiffest storey",
        "restitution": float(random.choice([0.01, 0.3, 0.5, 0.5, 0.8, 1.0])),
        "tension_cut": bool(random.random() < 0.5),
    }
    case = _link(random, gap)
    if random.random() < 0.3:
        case = {"links": [case | {"floors": {"except": [1]}}, _link(random, gap) | {"floors": 1}]}
    return case, impact


def _link(random: np.random.Generator, gap: float) -> dict[str, Any]:
    kind = str(random.choice(["pounding", "infill", "connector"], p=[0.6, 0.2, 0.2]))
    stiffness = f"{10 ** random.uniform(-2, 0):.6g} x stiffest storey"
    link = {"link": kind, "gap": max(gap, 1e-3) if kind == "infill" else gap}
    return link if kind == "pounding" else link | {"stiffness": stiffness}


def random_cut_infill(number: int) -> tuple[Scene, float]:
    """Return two or three buildings with infills as eq. (9) is printed that do not pull, and the accuracy asked [-]."""
    random = np.random.default_rng([number, 9])
    buildings = [_building(random) for _ in range(random.choice([2, 2, 3]))]
    thickness = float(random.choice([1e-6, 1e-4, 1e-3, 1e-3, 1e-2, 0.03]))
    infill = {"link": "infill", "law": "printed", "stiffness": f"{10 ** random.uniform(-2, 0.3):.6g} x mean storey"}
    links = [infill, {"link": "pounding"}] if random.random() < 0.2 else [infill]
    impact = {
        "stiffness": f"{10 ** random.uniform(0.7, 2.5):.6g} x stiffest storey",
        "restitution": float(random.choice([0.001, 0.01, 0.1, 0.3, 0.5])),
        "tension_cut": True,
    }
    dt = float(random.choice([0.01, 0.02, 0.1, 0.5]))
    samples = min(round(random.uniform(1.0, 4.0) / dt), 300) + 2
    ground = random.normal(size=samples) * random.uniform(0.3, 6.0)
    ground[0] = 0.0
    case = {"gap": thickness, "links": links}
    return Scene(buildings, ground, dt, case, "elastic", {"impact": impact}), float(random.choice(ACCURACIES[1:]))


def random_touch(number: int) -> tuple[Scene, float]:
    """Return two buildings that move nearly alike, in touch by a law without a series, and an accuracy of 1e-9 [-]."""
    random = np.random.default_rng([number, 264])
    one = _building(random) | {"damping": 0.0, "storey_law": "bouc-wen", "hardening": 0.05}
    one.pop("foundation", None)
    other = one | {"period": one["period"] * (1.0 + 10 ** random.uniform(-7, -2))}
    contact = {"link": "hertz-damp", "hertz_stiffness": 10 ** random.uniform(9, 11), "restitution": 0.3}
    joint = {"link": "connector", "stiffness": "0.1 x mean storey"}
    links = [contact, joint] if random.random() < 0.5 else [contact]
    ground = random.normal(size=60) * random.uniform(0.5, 5.0)
    ground[0] = 0.0
    return Scene([one, other], ground, 0.02, {"gap": 0.0, "links": links}, "inelastic"), 1e-9
