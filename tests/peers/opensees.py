"""The same scene in OpenSees (openseespy): zero-length storeys and links, marched at a fixed step.

Storeys: `Elastic`, `Steel01` (bilinear, kinematic) or `BoucWen`. Rayleigh damping by region, alpha M + beta K0.
Pounding: `ViscoelasticGap`, a Kelvin-Voigt element across a gap that may pull at the end of a contact, as eq. (6)
does. Connectors: `Elastic` with a dashpot. Peaks are those at the steps: OpenSees looks at nothing between.
"""

from __future__ import annotations

import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import openseespy.opensees as ops

from pounding_cli import Scene

IMPLICIT = "Newmark"
EXPLICIT = {"NewmarkExplicit": (0.5,), "KRAlphaExplicit": (1.0,), "CentralDifferenceAlternative": ()}
"""Explicit integrators that are right across a gap, with their parameters."""

SERIES = 1e10
"""Spring in series with a viscous damper [N/m]: with 1e12 OpenSees gives up."""


@dataclass(frozen=True, eq=False)
class Peaks:
    """Largest |restoring force| [N] and |drift| [m] of every storey, largest |force| of every link [N], buildings
    left to right; final displacements [m] of all floors; seconds on the core spent stepping."""

    shear: np.ndarray
    drift: np.ndarray
    link_force: np.ndarray
    displacement: np.ndarray
    seconds: float


def march(scene: Scene, dt: float, integrator: str = IMPLICIT) -> Peaks:
    """Run a scene of buildings on fixed bases at the step dt [s], which should divide the motion's.

    `integrator` : IMPLICIT (average acceleration, Newton) or one of EXPLICIT. With `CentralDifference` the dashpot of
    `ViscoelasticGap` pumps energy in, with `CentralDifferenceNoDamping` there is none; OpenSees reports success.

    Raises
    ------
    RuntimeError : OpenSees gives up
    """
    ops.wipe()
    ops.model("basic", "-ndm", 1, "-ndf", 1)
    try:
        with tempfile.TemporaryDirectory() as folder:
            ops.logFile(str(Path(folder) / "log"), "-noEcho")
            return _march(scene, dt, integrator, Path(folder))
    finally:
        ops.wipe()


def _march(scene: Scene, dt: float, integrator: str, folder: Path) -> Peaks:
    nodes, storeys = _buildings(scene)
    links = _links(scene, nodes, first=len(storeys) + 1)
    motion = scene.motion
    ops.timeSeries("Path", 1, "-dt", motion.dt, "-values", *motion.acceleration.tolist(), "-useLast")
    ops.pattern("UniformExcitation", 1, 1, "-accel", 1)
    for quantity in ("stress", "strain"):
        elements = [*storeys, *links]
        output = ("-file", str(folder / quantity), "-precision", 16)
        ops.recorder("EnvelopeElement", *output, "-ele", *elements, "material", 1, quantity)
    ops.constraints("Plain")
    ops.numberer("Plain")
    ops.system("ProfileSPD")
    if integrator in EXPLICIT:
        ops.integrator(integrator, *EXPLICIT[integrator])
        ops.algorithm("Linear")
    else:
        ops.test("NormUnbalance", 1e-3, 50, 0)
        ops.integrator(IMPLICIT, 0.5, 0.25)
        ops.algorithm("Newton")
    ops.analysis("Transient")
    begin = time.process_time()
    failed = ops.analyze(round(motion.duration / dt), dt)
    seconds = time.process_time() - begin
    if failed:
        raise RuntimeError(f"OpenSees gave up at {ops.getTime():g} s with code {failed}")
    end = np.array([ops.nodeDisp(node, 1) for floors in nodes for node in floors])
    ops.remove("recorders")
    stress, strain = (np.atleast_2d(np.loadtxt(folder / name))[2] for name in ("stress", "strain"))
    count = len(storeys)
    return Peaks(stress[:count], strain[:count], stress[count:], end, seconds)


def _buildings(scene: Scene) -> tuple[list[list[int]], list[int]]:
    """Nodes of the floors of every building; elements of all storeys."""
    nodes: list[list[int]] = []
    storeys: list[int] = []
    node = 0
    for place, building in enumerate(scene.buildings):
        assert building.foundation is None, "only fixed bases here"
        node += 1
        ops.node(node, 0.0)
        ops.fix(node, 1)
        floors, elements = [], []
        for j in range(building.storeys):
            node += 1
            ops.node(node, 0.0)
            ops.mass(node, float(building.mass[j]))
            tag = len(storeys) + 1
            if scene.analysis == "inelastic":
                _yielding(tag, building.laws[j])
            else:
                ops.uniaxialMaterial("Elastic", tag, float(building.stiffness[j]))
            ops.element("zeroLength", tag, node - 1, node, "-mat", tag, "-dir", 1, "-doRayleigh", 1)
            floors.append(node)
            elements.append(tag)
            storeys.append(tag)
        factors = (building.alpha, 0.0, building.beta, 0.0)
        ops.region(2 * place + 1, "-node", *floors, "-rayleigh", *factors)
        ops.region(2 * place + 2, "-ele", *elements, "-rayleigh", *factors)
        nodes.append(floors)
    return nodes, storeys


def _yielding(tag: int, law: Any) -> None:
    """Storeys; z of `BoucWen` is a drift, Dy times ours."""
    k, vy, a = law.stiffness, law.yield_shear, law.hardening
    if law.name == "bouc-wen":
        n, gamma = law.wen_exponent, law.wen_gamma
        scale = float(law.yield_drift**-n)
        shape = a, k, n, gamma * scale, (1 - gamma) * scale, 1.0, 0.0, 0.0, 0.0
        ops.uniaxialMaterial("BoucWen", tag, *(float(value) for value in shape), 1e-14, 100)
    else:
        ops.uniaxialMaterial("Steel01", tag, vy, k, a)


def _damper(tag: int, law: Any) -> None:
    """`ViscousDamper` has a spring in series, here SERIES, that nothing turns off."""
    if law.name == "maxwell":
        ops.uniaxialMaterial("Maxwell", tag, law.stiffness, law.damping_coefficient, 1.0, 1.0)
    elif law.name == "friction":
        ops.uniaxialMaterial("Steel01", tag, law.slip_force, law.stiffness, 0.0)
    else:
        ops.uniaxialMaterial("ViscousDamper", tag, SERIES, law.force_at_1_m_s, law.exponent)


def _contact(tag: int, law: Any, masses: tuple[float, float]) -> None:
    """Contacts that are not Kelvin and Voigt's; `ImpactMaterial` is the bilinear one of Muthukumar and DesRoches."""
    if law.name == "bilinear":
        k1, k2 = law.stiffnesses
        ops.uniaxialMaterial("ImpactMaterial", tag, k1, k2, -law.element_parameters(1.0, 1.0)[2], -law.gap)
    elif law.name == "jankowski":
        mass = masses[0] * masses[1] / sum(masses)
        ops.uniaxialMaterial("JankowskiImpact", tag, law.hertz_stiffness, law.damping_ratio, mass, -law.gap)
    else:
        zeta = 0.0 if law.name == "hertz" else law.damping_factor
        ops.uniaxialMaterial("Hertzdamp", tag, law.hertz_stiffness, zeta, -law.gap)


def _links(scene: Scene, nodes: list[list[int]], first: int) -> list[int]:
    tags = []
    for e, link in enumerate(scene.links):
        assert link.law.name == "hertz-damp" or not getattr(link.law, "tension_cut", False), "ViscoelasticGap pulls"
        tag = first + e
        ends = nodes[link.left][link.left_floor - 1], nodes[link.left + 1][link.right_floor - 1]
        masses = (
            scene.buildings[link.left].mass[link.left_floor - 1],
            scene.buildings[link.left + 1].mass[link.right_floor - 1],
        )
        if link.kind in ("maxwell", "friction", "viscous"):
            _damper(tag, link.law)
            ops.element("zeroLength", tag, *ends, "-mat", tag, "-dir", 1)
            tags.append(tag)
            continue
        if link.kind in ("hertz", "hertz-damp", "jankowski", "bilinear"):
            _contact(tag, link.law, masses)
            ops.element("zeroLength", tag, *ends, "-mat", tag, "-dir", 1)
            tags.append(tag)
            continue
        # Eqs (6), (7), (10) anew: c = 2 xi sqrt(s m1 m2 / (m1 + m2)).
        dashpot = 2 * link.law.damping_ratio * float(np.sqrt(link.law.stiffness * masses[0] * masses[1] / sum(masses)))
        if link.kind == "pounding":
            ops.uniaxialMaterial("ViscoelasticGap", tag, link.law.stiffness, dashpot, -link.gap)
        elif link.kind == "connector":
            ops.uniaxialMaterial("Elastic", tag, link.law.stiffness, dashpot)
        else:
            raise AssertionError("OpenSees has no such infill")
        ops.element("zeroLength", tag, *ends, "-mat", tag, "-dir", 1)
        tags.append(tag)
    return tags
