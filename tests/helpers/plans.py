"""Small plans made by hand, and a solver whose answers are known without solving anything."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np

from pounding_cli.digests import DigestTable, packed
from pounding_cli.errors import Problem
from pounding_cli.laws.pounding import Pounding
from pounding_cli.model.building import Building
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Analysis, Scene
from pounding_cli.numbers import Unit
from pounding_cli.records.motion import Motion
from pounding_cli.solve.response import BuildingResponse, LinkResponse, Response
from pounding_cli.study import Axis, MotionUse, Plan, Row
from pounding_cli.study.scenes import Expanded, Frame, LinkSets, Rows, seen


@dataclass(frozen=True)
class FakeStudy:
    """The part of a study that a results file quotes; no code sets a separation."""

    text: str = "title: two buildings  # µ as written\n"
    title: str = "two buildings"
    path: Path = Path("two.yaml")
    from_data: bool = False
    warnings: tuple[Problem, ...] = ()
    group: tuple[Building, ...] = ()
    swept: int = 0
    uses: dict[tuple[int, ...] | None, tuple[MotionUse, ...]] = field(default_factory=dict)
    facts: dict = field(default_factory=lambda: {"accuracy": 1e-6, "group": ["stiff", "soft"]})

    def assumed_heights(self):
        return ()

    def resolved(self) -> dict:
        return self.facts

    def spectrum_match(self) -> None:
        return None

    def unit(self, quantity: str) -> Unit:
        return {"gap": Unit("mm", 1e-3, "m"), "acceleration": Unit("g", 9.80665, "m/s2")}[quantity]

    def building(self, point, place) -> Building:
        return self.group[place]

    def touching(self, section, place=None) -> tuple[bool, ...]:
        return (True,) * self.swept

    def separations(self, point) -> np.ndarray:
        return np.full(2, np.nan)

    def motions(self, point) -> dict[str, SimpleNamespace]:
        return {use.name: SimpleNamespace(use=use) for use in self.uses.get(point, self.uses.get(None, ()))}


def building(name: str, storeys: int, stiffness: float = 1e8, yields: float = 1e6) -> Building:
    ones = np.ones(storeys)
    return Building(name, 2e5 * ones, 3 * ones, stiffness * ones, yields * ones, 0.05 * ones, alpha=0.1, beta=0.001)


def motion(name: str, pga: float) -> Motion:
    return Motion(name, 0.02, np.array([0.0, pga, -0.5 * pga, 0.0]), "stand-in")


def link(floor: int, gap: float, damping_ratio: float = 0.2) -> Link:
    return Link(0, floor, floor, Pounding(gap, 2e9, damping_ratio))


def small_plan(
    records=(("weak", 1.0), ("strong", 3.0)),
    axes: tuple[Axis, ...] = (),
    cases=(("touching", 0.0), ("gap", 0.05)),
    study: FakeStudy | None = None,
) -> Plan:
    """A 3-storey building left of a 2-storey one, linked at floors 1 and 2.

    A case whose gap is None has no link. The first swept key becomes the dashpot ratio of the links.
    """
    buildings = (building("stiff", 3), building("soft", 2, stiffness=3e7))
    motions = [motion(name, pga) for name, pga in records]
    scenes: dict[str, Scene] = {}
    rows = []
    for point in np.ndindex(*(len(axis.values) for axis in axes)):
        ratio = axes[0].values[point[0]][0] if axes else 0.2
        for case, gap in cases:
            for analysis in Analysis:
                for ground in motions:
                    links = () if gap is None else tuple(link(floor, gap, float(ratio)) for floor in (1, 2))
                    scene = Scene(buildings, links, ground, analysis)
                    alone = [scene.alone(place) for place in range(2)]
                    scenes |= {s.digest: s for s in (scene, *alone)}
                    rows.append(
                        Row(
                            tuple(int(i) for i in point),
                            case,
                            str(analysis),
                            ground.name,
                            scene.digest,
                            tuple(s.digest for s in alone),
                            seen(links),
                        )
                    )
    frame = Frame(
        (*(len(axis.values) for axis in axes), len(cases), 2, len(motions)),
        tuple(name for name, _ in cases),
        ("elastic", "inelastic"),
        tuple(each.name for each in motions),
    )
    uses = tuple(MotionUse(m.name, m.source, m.digest, 1.5, 0.06, m.pga, 0.01) for m in motions)
    study = study or FakeStudy()
    study.uses[None] = uses
    study = replace(study, group=buildings, swept=len(axes))
    return Plan(
        study,
        axes,
        tuple(name for name, _ in cases),
        ("elastic", "inelastic"),
        tuple(name for name, _ in records),
        tuple(b.name for b in buildings),
        scenes,
        rows_of(frame, rows),
        uses,
        accuracy=1e-6,
        method="taylor",
    )


def rows_of(frame: Frame, rows: list[Row]) -> Rows:
    """Rows as a plan has them, from rows as they are made by hand."""
    digests = list(dict.fromkeys(digest for row in rows for digest in (row.scene, *row.baselines)))
    number, sets = {digest: place for place, digest in enumerate(digests)}, LinkSets()
    scenes = np.array([[number[digest] for digest in (row.scene, *row.baselines)] for row in rows], np.int32)
    links = [sets.number(row.links) for row in rows[:: len(frame.analyses) * len(frame.records)]]
    return Rows(frame, Expanded(DigestTable(packed(digests)), scenes, np.arange(len(digests)), np.array(links), sets))


def known(scene: Scene, accuracy: float = 1e-6, method: str = "taylor", **_) -> Response:
    """Storey shears of a rigid building, half as large again with links; floor j moves at j times the peak.

    So V/V0 is 1.5 for every linked storey and 1 for every free one.
    """
    factor = 1.5 if scene.links else 1.0
    found = []
    for b in scene.buildings:
        shear = factor * scene.motion.pga * np.cumsum(b.mass[::-1])[::-1]
        drift = shear / b.stiffness
        floors = np.arange(1, b.storeys + 1)
        found.append(
            BuildingResponse(
                shear=shear,
                drift=drift,
                ductility=drift / b.yield_drift,
                acceleration=factor**2 * scene.motion.pga * floors,
                displacement_max=0.5 * np.cumsum(drift),
                displacement_min=-np.cumsum(drift),
                residual_drift=0 * drift,
            )
        )
    n = len(scene.links)
    links = LinkResponse(
        impacts=np.arange(1, n + 1),
        peak_force=1e6 * np.arange(1, n + 1),
        max_closing=np.array([each.gap + 0.001 for each in scene.links]),
        impulse=2e4 * np.ones(n),
        contact_time=0.01 * np.ones(n),
    )
    flags = ("first", "second") if scene.links and scene.links[0].gap == 0 else ()
    return Response(
        tuple(found),
        links,
        "done",
        "",
        method,
        accuracy,
        steps=10,
        events=n,
        seconds=0.5,
        energy={"input": 2.0, "residual": 1e-9},
        flags=flags,
        effects=("pounding",) if n else (),
        dropped=("infill: no case has one",),
        orders=120,
    )
