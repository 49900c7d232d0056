"""The wall that a floor strikes, and two oscillators that a connector joins, by `pound wall` and `pound connector`."""

from __future__ import annotations

import copy
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
import yaml
from skfem import Basis
from skfem.element import ElementQuad1, ElementQuad2, ElementVector

from pounding_cli.paper.wall.impact import build_system
from pounding_cli.paper.wall.study import WallStudySpec
from tests.adapter import system


def results(folder: Path, command: str, study: dict[str, Any]) -> xr.Dataset:
    """What a command finds for a study."""
    (folder / "study.yaml").write_text(yaml.safe_dump({"title": "one"} | study))
    return system(command, folder / "study.yaml")


THIN = {"width": "1 mm", "depth": "1 mm"}
LENGTH, THICKNESS, HEIGHT, YOUNG, POISSON, MASS, SPEED = 1.0, 0.25, 15.0, 30e9, 0.2, 2e5, 0.5
ALONE = {
    "wall": {"length": LENGTH, "thickness": THICKNESS},
    "frame": {"storeys": 5, "storey_height": 3.0, "bays": [5.0], "beam": THIN, "column": THIN, "floor_mass": 1.0},
    "concrete": {"young": YOUNG, "poisson": POISSON, "density": 0.0},
    "striker": {"mass": MASS, "speed": SPEED, "height": HEIGHT},
    "contact": {"over": "node", "bond": "glued"},
    "mesh": {"size": 0.25, "growth": 0, "element": "quadratic"},
    "time": {"end": 1.0, "step": "1 ms", "rho": 0.5},
}
"""A wall with next to no frame, and without mass, glued to the striker at its top."""


def changed(study: dict[str, Any], **sections: dict[str, Any]) -> dict[str, Any]:
    """The study with some keys of its sections replaced."""
    new = copy.deepcopy(study)
    for name, keys in sections.items():
        new.setdefault(name, {}).update(keys)
    return new


def test_wall_alone_is_a_timoshenko_cantilever(tmp_path: Path) -> None:
    """A striker on a spring: force v0 sqrt(K m), 1 / K = h^3 / 3 E I + h / (k G A), at a quarter of its period. Fails
    if an element is too stiff in bending, or the wall's thickness counts twice."""
    data = results(tmp_path, "wall", ALONE)
    inertia, shear = THICKNESS * LENGTH**3 / 12, YOUNG / (2 * (1 + POISSON))
    give = HEIGHT**3 / (3 * YOUNG * inertia) + HEIGHT / (5 / 6 * shear * THICKNESS * LENGTH)
    assert float(data["peak_force"]) == pytest.approx(SPEED * math.sqrt(MASS / give), rel=5e-3)
    quarter = 0.5 * math.pi * math.sqrt(MASS * give)
    assert float(data["time_of_peak"]) == pytest.approx(quarter, rel=5e-3)
    assert float(data["wall_moment"]) == pytest.approx(HEIGHT * float(data["peak_force"]), rel=2e-2)
    assert float(data["wall_shear"]) == pytest.approx(float(data["peak_force"]), rel=2e-2)


FIG8 = {
    "contact": {"over": "patch", "bond": "unilateral", "patch": "20 cm"},
    "mesh": {"size": 0.5, "growth": 0, "element": "linear"}, "time": {"end": "20 ms"},
}  # fmt: skip


def test_impulse_is_the_change_of_momentum(tmp_path: Path) -> None:
    """And a contact that may part never pulls. Fails if force and motion belong to different instants."""
    data = results(tmp_path, "wall", FIG8)
    force, time, velocity = (data[name].to_numpy() for name in ("force", "time", "velocity"))
    assert np.trapezoid(force, time) == pytest.approx(MASS * (SPEED - velocity[-1]), rel=1e-3)
    assert force.min() >= -1e-9 * force.max()
    assert force.max() == pytest.approx(float(data["peak_force"]), rel=1e-12)


def test_wall_force_is_proportional_to_the_speed(tmp_path: Path) -> None:
    slow, fast = (results(tmp_path, "wall", changed(FIG8, striker={"speed": v})) for v in (0.01, 5.0))
    for name in ("peak_force", "averaged_stress"):
        assert float(fast[name]) == pytest.approx(500 * float(slow[name]), rel=1e-8), name
    assert float(fast["time_of_peak"]) == float(slow["time_of_peak"])


def test_meshes_of_the_wall(tmp_path: Path) -> None:
    """Over a patch force and averaged stress settle as the mesh is refined; under one node the stress grows without
    bound. Fails if a patch is loaded as a node."""

    def at(size: float, over: str) -> xr.Dataset:
        sections = {"mesh": {"size": size}, "contact": {"over": over}, "time": {"end": "12 ms"}}
        return results(tmp_path, "wall", changed(FIG8, **sections))

    nodes = [float(at(size, "node")["wall_stress"]) for size in (0.5, 0.25, 0.125)]
    patches = [at(size, "patch") for size in (0.5, 0.25, 0.125)]
    assert nodes[1] > 1.5 * nodes[0]
    assert nodes[2] > 1.5 * nodes[1]
    forces, stresses = ([float(each[name]) for each in patches] for name in ("peak_force", "averaged_stress"))
    assert abs(forces[2] / forces[1] - 1) < 0.05
    assert abs(stresses[2] / stresses[1] - 1) < 0.08
    assert stresses[2] / 1e6 == pytest.approx(33, rel=0.1)


@pytest.mark.parametrize("element", ["linear", "quadratic"])
def test_stresses_of_the_wall(tmp_path: Path, element: str) -> None:
    """Of any displacements: each component of an element's stress is its mean over the element, by quadrature, and that
    of a cell the mean over its area, here of whole elements. Fails if components of two places are mixed."""
    mesh = {"size": 0.25, "growth": 0, "element": element}
    study = WallStudySpec.model_validate(
        {"title": "one", "mesh": mesh, "striker": {"height": 10.5}, "contact": {"patch": 0.5}}
    )
    read = build_system(study)
    kind = ElementVector(ElementQuad1() if element == "linear" else ElementQuad2())
    basis = Basis(read.mesh, kind, intorder=6)
    fixed = basis.get_dofs(lambda at: at[1] < 1e-9).all()
    free = np.setdiff1d(np.arange(basis.N), fixed)
    u = np.random.default_rng(1).normal(size=read.M.size)
    moved = np.zeros(basis.N)
    moved[free] = u[: free.size]
    (xx, xy), (yx, yy) = basis.interpolate(moved).grad
    factor = YOUNG / (1 - POISSON**2)
    strains = xx + POISSON * yy, yy + POISSON * xx, (1 - POISSON) / 2 * (xy + yx)
    area = basis.dx.sum(axis=1)
    mean = np.array([factor * (each * basis.dx).sum(axis=1) / area for each in strains]).T
    np.testing.assert_allclose((read.read["elements"] @ u).reshape(-1, 3), mean, atol=1e-9 * np.abs(mean).max())
    x, y = read.mesh.p[:, read.mesh.t].mean(axis=1)
    stress = (read.read["cells"] @ u).reshape(-1, 3)
    for height in (10.5, 11.0):
        (cell,) = np.flatnonzero(np.abs(read.cell_height - height) < 1e-9)
        inside = (x < 0.5) & (np.abs(y - height) < 0.25)
        assert inside.sum() == 4
        assert stress[cell] == pytest.approx(mean[inside].mean(axis=0), rel=1e-9)


PAIR = {
    "first": {"mass": "200 t", "period": "0.5 s"},
    "second": {"mass": "300 t", "frequency_ratio": 0.6},
    "connector": {"stiffness": "0.2 k1", "damping_ratio": "10 %"},
    "damping": "5 %",
    "frequencies": {"low": 0.2, "high": 1.6, "points": 141},
}


def test_two_oscillators_under_a_harmonic_motion(tmp_path: Path) -> None:
    """Largest displacements with the connector over those without, frequency by frequency, by a linear solver; the
    coupled frequencies by their determinant. Fails if the connector's dashpot lacks its 2, or takes another mass."""
    data = results(tmp_path, "connector", PAIR)
    m1, m2 = 2e5, 3e5
    w1 = 2 * math.pi / 0.5
    k1, k2 = m1 * w1**2, m2 * (0.6 * w1) ** 2
    c1, c2 = 2 * 0.05 * math.sqrt(k1 * m1), 2 * 0.05 * math.sqrt(k2 * m2)
    s = 0.2 * k1
    c = 2 * 0.1 * math.sqrt(s * m1 * m2 / (m1 + m2))
    for place, ratio in enumerate(data["frequency"].to_numpy()):
        w = ratio * w1
        a1, a2, join = k1 - m1 * w**2 + 1j * w * c1, k2 - m2 * w**2 + 1j * w * c2, s + 1j * w * c
        u = np.linalg.solve(np.array([[a1 + join, -join], [-join, a2 + join]]), [-m1, -m2])
        for name, found, alone in (("R1", u[0], -m1 / a1), ("R2", u[1], -m2 / a2)):
            assert float(data[name][place]) == pytest.approx(abs(found / alone), rel=1e-9)
    found = float(data["frequency_low"]), float(data["frequency_high"])
    squares = np.linalg.eigvals(np.array([[(k1 + s) / m1, -s / m1], [-s / m2, (k2 + s) / m2]]))
    assert found == pytest.approx(tuple(np.sort(np.sqrt(squares.real)) / w1), rel=1e-9)
