"""Two small buildings, a solver whose answers are known, and their motions: for tests of commands and pages."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from pounding_cli.laws.connector import Connector
from pounding_cli.solve.response import BuildingResponse, LinkResponse, Response

STUDY = """\
title: Two small buildings
records:
  use: [{file: weak.txt}, {file: strong.txt}]
  duration: whole
  scale: 1.0
buildings:
  stiff: {storeys: 3, period: 0.3 s, mass: 200 t, height: 3 m,
          yield: {code: UBC-1991, zone: 0.4, soil: 1.2, Rw: 12}}
  soft: {like: stiff, storeys: 2, period: 0.5 s}
group: [stiff, soft]
impact: {stiffness: 20 x stiffest storey, restitution: 0.5}
cases:
  touching: {link: pounding, gap: 0 cm}
  gap: {link: pounding, gap: 1 cm}
analyses: [elastic, inelastic]
"""

FOUR_CASES = STUDY.replace("records:", "claims: fig6\nrecords:", 1).replace(
    "analyses:",
    """\
  infill: {link: infill, gap: 1 cm, stiffness: 1/5 mean storey of stiff}
  connected: {link: connector, gap: 1 cm, floors: [2], stiffness: 1/5 mean storey of stiff}
analyses:""",
)
"""The same with the four cases of the paper's figures."""


def known(scene, accuracy=1e-6, method="taylor", **_):
    """V/V0 is 2 in the top storey of a linked building and 1.25 below it; mu/mu0 likewise."""
    found = []
    for building in scene.buildings:
        factor = np.full(building.storeys, 1.25 if scene.links else 1.0)
        factor[-1] = 2.0 if scene.links else 1.0
        one = scene.motion.pga * factor
        found.append(BuildingResponse(1e6 * one, 0.01 * one, one, one, one, -one, 0 * one))
    n = np.ones(len(scene.links))
    flags = ("a sentence to know",) if scene.links and scene.links[0].gap else ()
    return Response(tuple(found), LinkResponse(n, n, n, n, n), "done", "", "taylor", accuracy, 1, 1, 1e-4, flags=flags)


def fails(scene, accuracy=1e-6, method="taylor", **_):
    response = known(scene, accuracy, method)
    if scene.links and scene.links[0].gap and scene.analysis == "elastic":
        return replace(response, status="event bound reached", advice="check the links' stiffness")
    return response


def strikes(scene, accuracy=1e-6, method="taylor", **_):
    """Links across a gap are connectors that the strong motion closes entirely, where nothing yields."""
    response = known(scene, accuracy, method)
    if scene.links and scene.links[0].gap and scene.motion.pga > 2 and scene.analysis == "elastic":
        return replace(response, flags=(f"{Connector.beyond_gap}: stiff | soft, floor 2, by 3 mm",))
    return replace(response, flags=())


def write_motions(folder: Path) -> None:
    """The motions weak.txt and strong.txt, of half a second, in g."""
    t = np.arange(0.0, 0.5, 0.01)
    for name, peak in (("weak", 0.1), ("strong", 0.4)):
        np.savetxt(folder / f"{name}.txt", np.column_stack([t, peak * np.sin(12 * t)]))
