"""The three pairs of `pairs/*.yaml` in OpenSees, from masses, stiffnesses and strengths written here by hand.

Nothing of `pounding_cli` is used: Rayleigh factors, dashpots and reduced masses follow from formulas of this file.
Shear storeys and frame lines are `zeroLength` elements with `Elastic` or `Steel01`, contacts those with
`ViscoelasticGap`; floors that twist are `rigidDiaphragm`s. Newmark's average acceleration, Newton's method; a step for
which Newton's method finds no root is halved until it does. Peaks are those at the steps.
"""

from __future__ import annotations

import math
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import openseespy.opensees as ops

from tests.peers.diaphragms import PENALTY, Diaphragms

MOTION = Path(__file__).parents[2] / "records" / "elcentro.txt"
MOTION_STEP, DURATION, G = 0.01, 10.0, 9.80665
"""Of the motion, which is in g: its step [s]; how much of it is used [s]; standard gravity [m/s2]."""

MOST_HALVINGS = 12


@dataclass(frozen=True)
class Found:
    """What OpenSees found of a pair.

    peaks : largest values by the names of rows of the table [m], [rad], [N], and the number of contacts
    seconds : time on the core spent stepping
    halved : steps without a root, which were halved
    """

    peaks: dict[str, float]
    seconds: float
    halved: int


@dataclass
class Model:
    """What is watched of a model.

    shears : elements whose forces add up to a storey shear, by the name of its row
    drifts, contacts : elements by the name of a row; elements of all contacts
    nodes : node and direction by the name of a row
    gap : of all contacts [m]
    """

    gap: float
    shears: dict[str, list[int]] = field(default_factory=dict)
    drifts: dict[str, int] = field(default_factory=dict)
    contacts: list[int] = field(default_factory=list)
    nodes: dict[str, tuple[int, int]] = field(default_factory=dict)


def find_rayleigh(masses: list[float], stiffnesses: list[float], ratio: float) -> tuple[float, float]:
    """Return alpha [1/s] and beta [s] that give a damping ratio in the first two modes of a shear building."""
    k = np.append(stiffnesses, 0.0)
    matrix = np.diag(k[:-1] + k[1:]) - np.diag(k[1:-1], 1) - np.diag(k[1:-1], -1)
    root = np.sqrt(masses)
    one, two = np.sqrt(np.linalg.eigvalsh(matrix / np.outer(root, root))[:2])
    return 2 * ratio * one * two / (one + two), 2 * ratio / (one + two)


def find_dashpot(stiffness: float, restitution: float, inverse_mass: float) -> float:
    """Return c = 2 xi sqrt(k m') [N s/m] of a contact; inverse_mass: 1 / m' of what it moves [1/kg]."""
    xi = -math.log(restitution) / math.hypot(math.pi, math.log(restitution))
    return 2 * xi * math.sqrt(stiffness / inverse_mass)


def make_elastic() -> Model:
    """Make the elastic pair."""
    left = [220e3, 220e3, 220e3, 180e3], [420e6, 380e6, 320e6, 240e6]
    right = [160e3, 160e3, 120e3], [110e6, 95e6, 70e6]
    model = Model(gap=0.015)
    _begin(model, 1)
    _add_stick(model, "left", 0, *left, find_rayleigh(*left, 0.05))
    _add_stick(model, "right", 100, *right, find_rayleigh(*right, 0.04))
    for floor in (1, 2, 3):
        moved = 1 / left[0][floor - 1] + 1 / right[0][floor - 1]
        _add_contact(model, floor, 100 + floor, 5e9, find_dashpot(5e9, 0.6, moved))
    return model


def make_yielding() -> Model:
    """Make the yielding pair."""
    left = [250e3, 240e3, 200e3], [360e6, 300e6, 210e6]
    right = [180e3, 170e3, 130e3], [95e6, 85e6, 60e6]
    model = Model(gap=0.01)
    _begin(model, 1)
    _add_stick(model, "left", 0, *left, find_rayleigh(*left, 0.05), [2.2e6, 1.8e6, 1.1e6], 0.04)
    _add_stick(model, "right", 100, *right, find_rayleigh(*right, 0.05), [9e5, 7.5e5, 4.5e5], 0.03)
    for floor in (1, 2, 3):
        moved = 1 / left[0][floor - 1] + 1 / right[0][floor - 1]
        _add_contact(model, floor, 100 + floor, 6e9, find_dashpot(6e9, 0.65, moved))
    return model


def make_twisting() -> Model:
    """Make the twisting pair: the right building stands 5 m along the street, contacts at -2 m and 9 m."""
    masses = [240e3, 200e3], [160e3, 130e3]
    inertias = [11.9e6, 9.9e6], [5.33e6, 4.33e6]
    model = Model(gap=0.01)
    _begin(model, 3)
    made = Diaphragms()
    left = _add_floors(
        model, made, "left", masses[0], inertias[0], [9e9, 7e9],
        [(-7.5, [90e6, 70e6], [800e3, 520e3]), (8.0, [160e6, 120e6], [1300e3, 800e3])], 0.04, (0.5, 0.002),
    )  # fmt: skip
    made.centre = 5.0
    right = _add_floors(
        model, made, "right", masses[1], inertias[1], [1.6e9, 1.2e9],
        [(-7.0, [26e6, 20e6], [330e3, 210e3]), (6.0, [34e6, 25e6], [420e3, 260e3])], 0.02, (0.4, 0.003),
    )  # fmt: skip
    for j in (0, 1):
        for street in (-2.0, 9.0):
            made.centre = 0.0
            one = made.place(left[j], street)
            made.centre = 5.0
            two = made.place(right[j], street - 5.0)
            moved = 1 / masses[0][j] + street**2 / inertias[0][j]
            moved += 1 / masses[1][j] + (street - 5.0) ** 2 / inertias[1][j]
            material = made.next()
            ops.uniaxialMaterial("ViscoelasticGap", material, 1e9, find_dashpot(1e9, 0.6, moved), -model.gap)
            model.contacts.append(made.join(one, two, 1, rayleigh=False))
    return model


PAIRS: dict[str, Callable[[], Model]] = {
    "elastic": make_elastic,
    "yielding": make_yielding,
    "twisting": make_twisting,
}


def march(name: str, dt: float) -> Found:
    """Run a pair at the step dt [s], which divides that of the motion.

    Raises
    ------
    RuntimeError : Newton's method finds no root, however short the step
    """
    try:
        with tempfile.TemporaryDirectory() as folder:
            ops.wipe()
            ops.logFile(str(Path(folder) / "log"), "-noEcho")
            model = PAIRS[name]()
            return _march(model, dt, Path(folder))
    finally:
        ops.wipe()


def _begin(model: Model, dimensions: int) -> None:
    ops.model("basic", "-ndm", dimensions, "-ndf", 1 if dimensions == 1 else 6)


def _add_stick(
    model: Model,
    name: str,
    base: int,
    masses: list[float],
    stiffnesses: list[float],
    rayleigh: tuple[float, float],
    strengths: list[float] | None = None,
    hardening: float = 0.0,
) -> None:
    """Add a shear building whose nodes are numbered from its fixed base on."""
    ops.node(base, 0.0)
    ops.fix(base, 1)
    tags = [base + j for j in range(1, len(masses) + 1)]
    for j, tag in enumerate(tags):
        ops.node(tag, 0.0)
        ops.mass(tag, masses[j])
        if strengths is None:
            ops.uniaxialMaterial("Elastic", tag, stiffnesses[j])
        else:
            ops.uniaxialMaterial("Steel01", tag, strengths[j], stiffnesses[j], hardening)
        ops.element("zeroLength", tag, tag - 1, tag, "-mat", tag, "-dir", 1, "-doRayleigh", 1)
        model.drifts[f"{name}, drift of storey {j + 1}"] = tag
    model.shears[f"{name}, base shear"] = tags[:1]
    model.nodes[f"{name}, displacement of the roof"] = (tags[-1], 1)
    factors = "-rayleigh", rayleigh[0], 0.0, rayleigh[1], 0.0
    ops.region(base + 1, "-node", *tags, *factors)
    ops.region(base + 2, "-ele", *tags, *factors)


def _add_contact(model: Model, left: int, right: int, stiffness: float, dashpot: float) -> None:
    tag = 1000 + left
    ops.uniaxialMaterial("ViscoelasticGap", tag, stiffness, dashpot, -model.gap)
    ops.element("zeroLength", tag, left, right, "-mat", tag, "-dir", 1)
    model.contacts.append(tag)


def _add_floors(
    model: Model,
    made: Diaphragms,
    name: str,
    masses: list[float],
    inertias: list[float],
    torsional: list[float],
    lines: list[tuple[float, list[float], list[float]]],
    hardening: float,
    rayleigh: tuple[float, float],
) -> list[int]:
    """Add a building whose floors twist; return their nodes.

    lines : place from the centre of mass [m], stiffnesses [N/m] and strengths [N] by storey
    """
    floors = [made.floor(*each) for each in zip(masses, inertias, strict=True)]
    elements = []
    for number, (y, stiffnesses, strengths) in enumerate(lines, 1):
        below = made.ground(y)
        for j, floor in enumerate(floors):
            above = made.place(floor, y)
            ops.uniaxialMaterial("Steel01", made.next(), strengths[j], stiffnesses[j], hardening)
            elements.append(made.join(below, above, 1, rayleigh=True))
            model.drifts[f"{name}, drift of line {number}, storey {j + 1}"] = elements[-1]
            if j == 0:
                model.shears.setdefault(f"{name}, base shear", []).append(elements[-1])
            below = above
    below = made.ground(0.0)
    for j, floor in enumerate(floors):
        ops.uniaxialMaterial("Elastic", made.next(), torsional[j])
        elements.append(made.join(below, floor, 6, rayleigh=True))
        below = floor
    factors = "-rayleigh", rayleigh[0], 0.0, rayleigh[1], 0.0
    ops.region(floors[0], "-node", *floors, *factors)
    ops.region(floors[0] + 1, "-ele", *elements, *factors)
    model.nodes[f"{name}, displacement of the roof"] = (floors[-1], 1)
    model.nodes[f"{name}, rotation of the roof"] = (floors[-1], 6)
    return floors


def _march(model: Model, dt: float, folder: Path) -> Found:
    ground = np.loadtxt(MOTION) * G
    ops.timeSeries("Path", 1, "-dt", MOTION_STEP, "-values", *ground.tolist(), "-useLast")
    ops.pattern("UniformExcitation", 1, 1, "-accel", 1)
    shears = [element for elements in model.shears.values() for element in elements]
    drifts = list(model.drifts.values())
    for name, elements, what in (
        ("shears", shears, "stress"), ("drifts", drifts, "strain"),
        ("forces", model.contacts, "stress"), ("closings", model.contacts, "strain"),
    ):  # fmt: skip
        ops.recorder("Element", "-binary", str(folder / name), "-ele", *elements, "material", 1, what)
    for number, (node, direction) in enumerate(model.nodes.values()):
        ops.recorder("Node", "-binary", str(folder / f"node{number}"), "-node", node, "-dof", direction, "disp")
    twists = ops.getNDM()[0] == 3
    ops.constraints(*(("Penalty", PENALTY, PENALTY) if twists else ("Plain",)))
    ops.numberer("RCM")
    ops.system("BandGeneral")
    ops.test("NormDispIncr", 1e-11, 50, 0)
    ops.algorithm("Newton")
    ops.integrator("Newmark", 0.5, 0.25)
    ops.analysis("Transient")
    begin = time.process_time()
    halved = step_to(DURATION, dt)
    seconds = time.process_time() - begin
    ops.remove("recorders")

    def read(name: str, columns: int) -> np.ndarray:
        """Rows of a file of OpenSees, each of which ends with a byte."""
        row = np.dtype([("values", "<f8", (columns,)), ("end", "S1")])
        return np.fromfile(folder / name, row)["values"]

    peaks = {}
    for number, name in enumerate(model.nodes):
        peaks[name] = float(np.abs(read(f"node{number}", 1)).max())
    for name, column in zip(model.drifts, np.abs(read("drifts", len(drifts))).max(axis=0), strict=True):
        peaks[name] = float(column)
    values, first = read("shears", len(shears)), 0
    for name, elements in model.shears.items():
        peaks[name] = float(np.abs(values[:, first : first + len(elements)].sum(axis=1)).max())
        first += len(elements)
    peaks["largest contact force"] = float(np.abs(read("forces", len(model.contacts))).max())
    closed = -read("closings", len(model.contacts)) > model.gap
    peaks["contacts"] = float(closed[0].sum() + (closed[1:] & ~closed[:-1]).sum())
    return Found(peaks, seconds, halved)


def step_to(end: float, dt: float) -> int:
    """Step to an end at dt [s]; return how many steps had no root and were halved, once or more often."""
    halved = 0
    count = round(end / dt)
    done = 0
    while done < count:
        if ops.analyze(count - done, dt) == 0:
            break
        done = round(ops.getTime() / dt) + 1
        halved += 1
        for power in range(1, MOST_HALVINGS + 1):
            part = dt / 2**power
            if ops.analyze(round((done * dt - ops.getTime()) / part), part) == 0:
                break
        else:
            raise RuntimeError(f"OpenSees failed at {ops.getTime():g} s")
    return halved
