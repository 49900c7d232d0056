"""Scenes of buildings whose floors twist: one row for each law of lines and links, foundation and neighbour, and random
ones. `make reference` keeps what the independent integrator makes of them."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from pounding_cli.laws import storey_laws
from pounding_cli.laws.bilinear_contact import BilinearContact
from pounding_cli.laws.hertz import Hertz, HertzDamp, Jankowski
from pounding_cli.laws.infill import Infill
from pounding_cli.laws.joints import Connector, Damper, Friction, Maxwell, Viscous
from pounding_cli.laws.law import LinkLaw
from pounding_cli.laws.pounding import DashpotLaw, Pounding, damping_ratio
from pounding_cli.model.building import Building, Foundation
from pounding_cli.model.links import Link
from pounding_cli.model.plan import FloorPlan, FrameLine
from pounding_cli.model.scene import Analysis, Scene
from pounding_cli.model.wall import Wall
from pounding_cli.records.motion import Motion
from tests.physics.cases import LOST, PINCHED, shake

DT = 0.02
"""Time step of the motions [s]."""


def line(name: str, place: float, stiffness: Any, yield_shear: Any = np.inf, storeys: int = 2) -> FrameLine:
    """Return a line with lists by storey, or one number for all of them."""
    return FrameLine(name, place, np.full(storeys, 1.0) * stiffness, np.full(storeys, 1.0) * yield_shear)


def building(name: str, mass: np.ndarray, plan: FloorPlan, hardening: float = 0.02, **more: Any) -> Building:
    """Return a building with a plan, storeys 3 m high, and more of its fields."""
    storeys = mass.size
    keys = {"alpha": 0.3, "beta": 1e-3} | more
    return Building(
        name, mass, np.full(storeys, 3.0), plan.stiffness, plan.yield_shear, np.full(storeys, hardening), plan=plan,
        **keys,
    )  # fmt: skip


def stiff(yields: float, storeys: int = 2, **more: Any) -> Building:
    """Return a stiff building of 20 m by 14 m, with a strong line at its far edge.

    yields : strength of its lines over that of the weaker one, inf for lines that cannot yield
    """
    mass = np.array([2.4e5, 2.0e5, 1.7e5])[:storeys]
    strength = yields * np.array([1.0, 0.7, 0.45])[:storeys]
    lines = (
        line("1", -7.5, 0.9e8, 5.0e5 * strength, storeys),
        line("2", 8.0, 1.6e8, 7.5e5 * strength, storeys),
    )
    plan = FloorPlan(mass * (20.0**2 + 14.0**2) / 12, lines, np.full(storeys, 9e9), low=-10.0, high=10.0)
    return building("stiff", mass, plan, **more)


def soft(yields: float, storeys: int = 2, **more: Any) -> Building:
    """Return a soft building of 16 m by 12 m with three lines; parameters as of `stiff`."""
    mass = np.array([1.6e5, 1.5e5, 1.1e5])[:storeys]
    strength = yields * np.array([1.0, 0.75, 0.5])[:storeys]
    lines = (
        line("1", -7.0, 2.6e7, 1.9e5 * strength, storeys),
        line("2", -1.0, 1.5e7, 1.2e5 * strength, storeys),
        line("3", 7.0, 1.9e7, 1.3e5 * strength, storeys),
    )
    plan = FloorPlan(mass * (16.0**2 + 12.0**2) / 12, lines, np.full(storeys, 1.6e9), low=-8.0, high=8.0)
    return building("soft", mass, plan, **more)


def contact(floor: int, left_y: float, right_y: float, gap: float = 0.004, left: int = 0, **more: Any) -> Link:
    """Return the contact of two floors at a place, half as stiff as that of whole edges."""
    return Link(left, floor, floor, Pounding(gap, 1e9, damping_ratio(0.5)), left_y=left_y, right_y=right_y, **more)


def edges_meet(storeys: int = 2, left: int = 0) -> tuple[Link, ...]:
    """Return the contacts at both ends of the edge that a stiff and a soft building share, set off by 5 m."""
    return tuple(contact(j, *ys, left=left) for j in range(1, storeys + 1) for ys in ((-3.0, -8.0), (10.0, 5.0)))


@dataclass(frozen=True)
class Twisting:
    """Two buildings whose floors twist, and what one row changes of them.

    both : fields of both buildings
    links : between them
    yields : strength of the lines
    neighbours : right of the first building; None: the soft building
    change : of the first building's plan
    duration, peak : of the motion [s], [m/s2]
    """

    both: Mapping[str, Any] = field(default_factory=dict)
    links: tuple[Link, ...] = field(default_factory=edges_meet)
    yields: float = 1.0
    neighbours: Callable[[], tuple[Building, ...]] | None = None
    change: Callable[[FloorPlan], FloorPlan] | None = None
    duration: float = 2.0
    peak: float = 5.0
    first: Mapping[str, Any] = field(default_factory=dict)

    def scene(self) -> Scene:
        """Return the scene of this row."""
        left = stiff(self.yields, **{**self.both, **self.first})
        if self.change is not None:
            plan = self.change(left.plan)
            left = replace(left, plan=plan, stiffness=plan.stiffness, yield_shear=plan.yield_shear)
        right = (soft(self.yields, **self.both),) if self.neighbours is None else self.neighbours()
        motion = Motion("shake", DT, shake(self.duration, self.peak))
        analysis = Analysis.INELASTIC if np.isfinite(self.yields) else Analysis.ELASTIC
        return Scene((left, *right), self.links, motion, analysis, residual_drift=False)


def of_law(name: str, **parameters: float) -> dict[str, Any]:
    """Return the fields of a building whose lines have this storey law."""
    values = {key: value for key, value in parameters.items() if key != "collapse"}
    return {"storey_law": storey_laws()[name], "law_parameters": tuple(values.items()), "collapse": np.inf}


def with_yielding_lines_across(plan: FloorPlan) -> FloorPlan:
    """Return a plan whose lines across the row yield."""
    across = (line("a", -6.0, 0.9e8, 1.6e5), line("b", 6.5, 0.7e8, 1.1e5))
    return replace(plan, torsional_stiffness=np.full(2, 2e9), lines_across=across)


SWAY = Foundation(mass=2e5, sway_stiffness=1e9, sway_damping=1e7, rocks=False)
BOTH = Foundation(2e5, 1e9, 1e7, 1e7, 1e11, 1e8)
HEAVY = {"gravity_load": np.array([8e6, 4e6]), "collapse": np.inf}
"""Weights of P-Delta some times those of the floors, so that they matter [N]."""


def three_in_a_row() -> tuple[Building, ...]:
    """Return a soft building and a plain one to the right of it, without a plan."""
    plain = Building(
        "plain", np.full(2, 2e5), np.full(2, 3.0), np.full(2, 1.2e8), np.full(2, 6e5), np.full(2, 0.02), 0.3, 1e-3
    )  # fmt: skip
    return soft(1.0), plain


def at(law: LinkLaw) -> Link:
    """Return a link with this law between the tops, at a place of its own."""
    return Link(0, 2, 2, law, left_y=4.0, right_y=-1.5)


def without_tension(link: Link) -> Link:
    """Return a link whose force never pulls."""
    return replace(link, law=replace(link.law, tension_cut=True))


def behind(wall: Wall) -> Callable[[], tuple[Building, ...]]:
    """Return the neighbours of a row whose first building stands beside this wall."""
    return lambda: (wall,)


WALLED = tuple(contact(j, y, 0.0) for j in (1, 2) for y in (-3.0, 10.0))
INFILL = Infill(5e-4, 1.5e8, 1e9, damping_ratio(0.5))
TRIPLE = (*edges_meet(), contact(1, 6.0, 0.0, left=1), contact(2, -8.0, 0.0, left=1), contact(2, 6.0, 0.0, left=1))
PLACED_ON_COLUMNS = (
    *edges_meet(),
    Link(0, 2, 1, Pounding(0.001, 1e9, damping_ratio(0.6)), left_at=0.4, left_y=7.0, right_y=2.0, columns=0.3),
)
CAPPED = LOST | {"residual_strength": 0.3}

ROWS: Mapping[str, Twisting] = {
    "elastic": Twisting(yields=np.inf),
    "bilinear": Twisting(),
    "bilinear, alone": Twisting(links=(), neighbours=tuple),
    "elastoplastic": Twisting({"hardening": 0.0}),
    "peak-oriented": Twisting(of_law("peak-oriented")),
    "imk": Twisting(of_law("imk-peak-oriented", **CAPPED)),
    "imk, pinched": Twisting(of_law("imk-pinching", **CAPPED, **PINCHED)),
    "bouc-wen": Twisting(of_law("bouc-wen", wen_exponent=2.0, wen_gamma=0.5)),
    "bouc-wen, n = 1": Twisting(of_law("bouc-wen", wen_exponent=1.0, wen_gamma=0.9)),
    "lines across that yield": Twisting(change=with_yielding_lines_across),
    "p-delta": Twisting(HEAVY),
    "sway": Twisting({"foundation": SWAY}),
    "sway and rocking": Twisting({"foundation": BOTH}),
    "p-delta on a foundation": Twisting(HEAVY, first={"foundation": BOTH}),
    "three buildings": Twisting(links=TRIPLE, neighbours=three_in_a_row),
    "wall": Twisting(links=WALLED, neighbours=behind(Wall.build("wall"))),
    "wall on soil": Twisting(links=WALLED, neighbours=behind(Wall.build("wall", 6.0, 3e5, 2e8, 3e6))),
    "struck columns": Twisting(links=PLACED_ON_COLUMNS, both={"columns": 0.3}),
    "tension cut": Twisting(links=tuple(without_tension(link) for link in edges_meet())),
    "printed": Twisting(links=(contact(2, -3.0, -8.0), at(Pounding(0.004, 1e9, 0.1, dashpot=DashpotLaw.PRINTED)))),
    "hertz": Twisting(links=(at(Hertz(0.004, 2e10)),)),
    "hertz-damp": Twisting(links=(at(HertzDamp(0.004, 2e10, 0.5)),)),
    "jankowski": Twisting(links=(at(Jankowski(0.004, 2e10, 0.5)),)),
    "bilinear contact": Twisting(links=(at(BilinearContact(0.004, 2e10, 2e-3, 0.5)),)),
    "infill": Twisting(links=(at(INFILL),)),
    "connector": Twisting(links=(*edges_meet(), at(Connector(0.004, 3e7, 0.1)))),
    "damper": Twisting(links=(*edges_meet(), at(Damper(0.004, 2e6)))),
    "viscous": Twisting(links=(*edges_meet(), at(Viscous(0.004, 1e5, 0.8, 1e-9))), duration=0.6),
    "maxwell": Twisting(links=(*edges_meet(), at(Maxwell(0.004, 1e8, 2e6)))),
    "friction": Twisting(links=(*edges_meet(), at(Friction(0.004, 1e8, 1e5)))),
}  # fmt: skip
"""A row for each law, by its name."""


def random_scene(seed: int, kind: str) -> Scene:
    """Return a random scene of three storeys whose numbers differ by storey and line.

    kind : "elastic" or "yielding" pair, or a yielding building "alone"
    """
    rng = np.random.default_rng([seed, len(kind)])
    yields = kind != "elastic"
    buildings = [_random_building(rng, name, yields) for name in ("A", "B")[: 1 if kind == "alone" else 2]]
    links = []
    if kind != "alone":
        stiffness, restitution, gap = rng.uniform(3e8, 3e9), rng.uniform(0.3, 0.95), rng.uniform(0.0, 0.006)
        for floor in sorted(rng.choice((1, 2, 3), rng.integers(1, 4), replace=False)):
            for ends in rng.uniform(-9.0, 9.0, (rng.integers(1, 3), 2)):
                links.append(
                    Link(
                        0,
                        int(floor),
                        int(floor),
                        Pounding(gap, stiffness, damping_ratio(restitution)),
                        left_y=float(ends[0]),
                        right_y=float(ends[1]),
                    )
                )
    motion = Motion("shake", DT, shake(2.0, rng.uniform(3.0, 6.0), seed))
    analysis = Analysis.INELASTIC if yields else Analysis.ELASTIC
    return Scene(tuple(buildings), tuple(links), motion, analysis, residual_drift=False)


def _random_building(rng: np.random.Generator, name: str, yields: bool) -> Building:
    mass = rng.uniform(1e5, 3e5, 3)
    inertia = mass * rng.uniform(20.0, 80.0, 3)
    count = int(rng.integers(1, 5))
    places = np.sort(rng.uniform(-9.0, 9.0, count))
    total = rng.uniform(3e7, 3e8) * np.array([1.0, 0.85, 0.6]) * rng.uniform(0.8, 1.2, 3)
    shares = rng.dirichlet(np.full(count, 3.0), 3).T
    strength = 9.81 * mass.sum() * rng.uniform(0.1, 0.35) * np.array([1.0, 0.8, 0.5])
    lines = tuple(
        line(
            str(number),
            float(place),
            share * total,
            share * strength * rng.uniform(0.7, 1.4, 3) if yields else np.inf,
            3,
        )
        for number, (place, share) in enumerate(zip(places, shares, strict=True))
    )
    torsional = total * inertia.sum() / mass.sum() * rng.uniform(0.6, 2.0, 3)
    plan = FloorPlan(inertia, lines, torsional, low=-10.0, high=10.0)
    factors = {"alpha": rng.uniform(0.0, 0.6), "beta": rng.uniform(0.0, 3e-3)}
    return building(name, mass, plan, hardening=rng.uniform(0.0, 0.1), **factors)


SHIFT = 5.0
"""How far the soft building stands along the street from the stiff one [m]."""


def pair_of_three(contacts: bool) -> Scene:
    """Return two buildings of three storeys with two yielding lines each, apart or with elastic contacts at places."""
    left, right = stiff(1.0, 3), soft(1.0, 3)
    lines = right.plan.lines[::2]
    plan = replace(right.plan, lines=lines)
    right = replace(right, plan=plan, stiffness=plan.stiffness, yield_shear=plan.yield_shear)
    law = Pounding(0.004, 1e9, 0.0)
    places = ((2, -3.0), (3, -3.0), (3, 10.0))
    links = tuple(Link(0, j, j, law, left_y=y, right_y=y - SHIFT) for j, y in places)
    motion = Motion("shake", DT, shake(2.0, 5.0))
    return Scene((left, right), links if contacts else (), motion, Analysis.INELASTIC, residual_drift=False)


KINDS = "elastic", "yielding", "alone"
SEEDS = range(12)


def referenced_scenes() -> dict[str, Callable[[], Scene]]:
    """Return every scene that the independent integrator runs, by its name."""
    scenes: dict[str, Callable[[], Scene]] = {name: row.scene for name, row in ROWS.items()}
    for kind in KINDS:
        for seed in SEEDS:
            scenes[f"{kind} {seed}"] = functools.partial(random_scene, seed, kind)
    return scenes
