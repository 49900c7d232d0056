"""docs/extending.md: its laws, put into a copy of the package as the page says."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys

import pytest
from pages import ROOT, blocks

PAGE = ROOT / "docs" / "extending.md"
LAWS = ROOT / "docs" / "examples" / "laws"

M1, M2, V0, GAP = 2e5, 3e5, 0.8, 0.03
K1, K2, K3, V2, V3 = 1e8, 4e8, 2e9, 0.005, 0.01
M, K, VY, A, THROWN = 2e5, 2e7, 3e5, 0.1, 0.5

CHECK = f"""
import dataclasses, json, math
import numpy as np
import pounding_cli as pound
from pounding_cli.errors import InputError
from pounding_cli.laws.isotropic import Isotropic
from pounding_cli.laws.tri_linear import TriLinear
from pounding_cli.model.building import Building
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Analysis, Scene
from pounding_cli.records import Motion
from pounding_cli.solver.solve import solve

def free(mass):
    return Building("free", [mass], [3.0], [1e-3], [math.inf], [0.0], 0.0, 0.0)

def blow(v0):
    law = TriLinear(gap={GAP}, stiffness={K1}, second_stiffness={K2}, third_stiffness={K3},
                    second_closing={V2}, third_closing={V3})
    still = Motion("still", 0.01, np.zeros(81))
    scene = Scene((free({M1}), free({M2})), (Link(0, 1, 1, law),), still, Analysis.ELASTIC)
    run = solve(scene, 1e-11, initial=([[0.0], [0.0]], [[v0], [0.0]]))
    (_, (left,)), (_, (right,)) = run.final
    closing, force = float(run.links.max_closing[0]), float(run.links.peak_force[0])
    return [closing, force, float(right - left), int(run.links.impacts[0]), run.energy["residual"],
            law.stored_energy(closing, force)]

def storeys(number, **law):
    ones = np.ones(number)
    return Building("b", {M} * ones, 3.0 * ones, {K} * ones, {VY} * ones, {A} * ones, 0.1, 0.0, **law)

def isotropic(growth):
    return dict(storey_law=Isotropic, law_parameters=(("growth", growth),))

def throw():
    building = dataclasses.replace(storeys(1, **isotropic(1.0)), alpha=0.0)
    scene = Scene((building,), (), Motion("still", 0.02, np.zeros(101)), Analysis.INELASTIC)
    run = solve(scene, 1e-11, initial=([[0.0]], [[{THROWN}]]))
    b = run.buildings[0]
    return [run.status, float(b.displacement_max[0]), float(b.displacement_min[0]), float(run.energy["hysteresis"]),
            float(run.energy["residual"])]

def shaken(**law):
    motion = Motion("pulse", 0.02, 4.0 * np.sin(np.linspace(0.0, 25.0, 201)))
    run = solve(Scene((storeys(3, **law),), (), motion, Analysis.INELASTIC), 1e-10)
    return [run.buildings[0].drift.tolist(), run.events]

def refused(old, new):
    text = open("study.yaml").read()
    assert old in text
    open("wrong.yaml", "w").write(text.replace(old, new))
    try:
        pound.load_study("wrong.yaml")
    except InputError as error:
        return str(error)

results = pound.run("study.yaml", output="study.h5", engine="serial")
links = results.table("link")
print("RESULT" + json.dumps({{
    "blows": [blow(v0) for v0 in (0.05, 0.3, {V0})],
    "throw": throw(),
    "kinematic": shaken(**isotropic(0.0)),
    "bilinear": shaken(),
    "isotropic": shaken(**isotropic(1.0)),
    "study": links[links["case"] == "padded"]["peak_force"].max(),
    "refused": [
        refused("    second_closing: 5 mm\\n", ""),
        refused("link: pounding,", "link: pounding, third_closing: 1 cm,"),
        refused("second_closing: 5 mm", "second_closing: 5 kg"),
        refused("third_closing: 1 cm", "third_closing: 4 mm"),
        refused("growth: 0.5", "growth: 1.5"),
        refused("isotropic, growth", "bilinear, growth"),
    ],
}}, default=float))
"""


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """What the page's laws do in a copy of the package that has them; its study, whose soft building has the page's
    storey law."""
    if "POUND_NIGHTLY" not in os.environ:
        pytest.skip("a copy of the solver is compiled for it: make reference runs it every night")
    folder = tmp_path_factory.mktemp("copy")
    laws = folder / "pounding_cli" / "laws"
    shutil.copytree(ROOT / "pounding_cli", laws.parent, ignore=shutil.ignore_patterns("__pycache__"))
    (folder / "records").symlink_to(ROOT / "records")
    lines, study = (
        next(block.text for block in blocks(PAGE) if mark in block.text)
        for mark in ("import TriLinear", "link: tri-linear")
    )
    for path in LAWS.glob("*.py"):
        shutil.copy(path, laws)
    imported, listed = lines.split("\n", 1)
    text = (laws / "__init__.py").read_text()
    for old, new in (
        ("\nBUILT_IN", f"\n{imported}\nfrom pounding_cli.laws.isotropic import Isotropic\n\nBUILT_IN"),
        ("    Sway,\n", f"{listed}    Isotropic,\n    Sway,\n"),
    ):
        assert text.count(old) == 1
        text = text.replace(old, new)
    (laws / "__init__.py").write_text(text)
    (folder / "study.yaml").write_text(
        study.replace("period: 0.5 s}", "period: 0.5 s, storey_law: isotropic, growth: 0.5}") + "estimate: none\n"
    )
    (folder / "check.py").write_text(CHECK)
    done = subprocess.run(
        [sys.executable, "check.py"],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(folder), "NUMBA_CACHE_DIR": str(folder)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.split("RESULT")[1])


def test_the_file_of_a_law_is_short():
    """Parameters, branches and energy of the contact fit into sixty lines."""
    assert (LAWS / "tri_linear.py").read_text(encoding="utf-8").count("\n") <= 60


def test_energy_gives_the_largest_closing(found):
    """m' v0^2 / 2 is the area under the lines up to the largest closing: of one line, two, and three. Fails if the
    force of a branch, or the closing where it ends, is wrong."""
    reduced = M1 * M2 / (M1 + M2)
    reached = []
    for v0, (closing, force, rebound, impacts, residual, stored) in zip((0.05, 0.3, V0), found["blows"], strict=True):
        x = closing - GAP
        more, most = max(x - V2, 0.0), max(x - V3, 0.0)
        reached.append((x > V2) + (x > V3))
        area = 0.5 * (K1 * x**2 + (K2 - K1) * more**2 + (K3 - K2) * most**2)
        assert area == pytest.approx(reduced * v0**2 / 2, rel=1e-8)
        assert stored == pytest.approx(area, rel=1e-12)
        assert force == pytest.approx(K1 * x + (K2 - K1) * more + (K3 - K2) * most, rel=1e-9)
        assert rebound == pytest.approx(v0, rel=1e-8)
        assert impacts == 1
        assert abs(residual) < 1e-9
    assert reached == [0, 1, 2]


def test_a_storey_that_hardens_isotropically(found):
    """Thrown once beyond the yield it swings between the reversal D and D - 2 F / k for ever: its elastic range is as
    wide as what it has stored takes it. Without growth it is the bilinear storey. Fails if the far yield line, or the
    end of the elastic range, is not remembered."""
    dy, plateau, energy = VY / K, (1 - A) * VY, 0.5 * M * THROWN**2
    rest = energy - 0.5 * VY * dy + plateau * dy + 0.5 * A * K * dy**2
    largest = (-plateau + (plateau**2 + 2 * A * K * rest) ** 0.5) / (A * K)
    shear = plateau + A * K * largest
    status, top, bottom, lost, residual = found["throw"]
    assert status == "done"
    assert top == pytest.approx(largest, rel=1e-9)
    assert min(bottom, 0.0) == pytest.approx(min(largest - 2 * shear / K, 0.0), abs=1e-9 * largest)
    assert lost == pytest.approx(energy - shear**2 / (2 * K), rel=1e-9)
    assert abs(residual) < 1e-10
    assert found["kinematic"][1] == found["bilinear"][1] > 20
    assert found["kinematic"][0] == pytest.approx(found["bilinear"][0], rel=1e-9)
    assert found["isotropic"][0] != pytest.approx(found["bilinear"][0], rel=1e-2)


def test_a_study_has_their_keys(found):
    """Fails if a parameter of a law is no key, or is taken for one of another law."""
    assert found["study"] > 0
    for words, message in zip(
        (
            "'second_closing' is missing",
            "'third_closing' does not apply to link: pounding",
            "expected m",
            "third_closing must be above second_closing",
            "growth is 1.5",
            "'growth' does not apply to storey_law: bilinear",
        ),
        found["refused"],
        strict=True,
    ):
        assert words in message
