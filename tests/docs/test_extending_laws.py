"""The recipes for laws of one's own, followed from outside the package in the files that docs/extending.md shows."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from pages import ROOT, blocks

PAGE = ROOT / "docs" / "extending.md"

CONE = "class Cone"
ISOTROPIC = "class Isotropic"

POUND = "import sys; from pounding_cli.cli.main import main; sys.exit(main())"

CHECK = """
import json, math
import numpy as np
from bumper import Bumper
from pounding_cli import solve
from pounding_cli.model.building import Building
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Analysis, Scene
from pounding_cli.records import Motion
from pounding_cli.solve.histories import history
from pounding_cli.study import expand, load_study

def free(mass):
    return Building("free", [mass], [3.0], [1e-3], [math.inf], [0.0], 0.0, 0.0)

def blow(v0, ratio, method="taylor", **more):
    law = Bumper(gap=0.03, stiffness=1e8, impact_stiffness=2e9, damping_ratio=ratio, pad=0.01)
    scene = Scene((free(2e5), free(3e5)), (Link(0, 1, 1, law),), Motion("still", 0.01, np.zeros(61)), Analysis.ELASTIC)
    run = solve(scene, 1e-11 if method == "taylor" else 1e-6, method, initial=([[0.0], [0.0]], [[v0], [0.0]]), **more)
    (_, (left,)), (_, (right,)) = run.final
    return {
        "status": run.status, "closing": float(run.links.max_closing[0]), "force": float(run.links.peak_force[0]),
        "blows": int(run.links.impacts[0]), "rebound": float(right - left), "steps": run.steps,
        "residual": run.energy["residual"] if run.energy else 0.0, "stored": run.energy.get("links_stored", 0.0),
    }

plan = expand(load_study("bumper.yaml"))
scene = next(s for s in plan.scenes.values() if s.links and s.links[0].kind == "bumper")
fixed = {m: blow(0.8, 0.2, m, time_step=2e-5) for m in
         ("rk4-events", "rk4", "central-difference", "newmark", "hht-alpha", "generalized-alpha")}
kept = history(scene, 1e-9, 0.001)
print(json.dumps({
    "soft": blow(0.1, 0.0), "hard": blow(0.8, 0.0), "damped": blow(0.8, 0.2), "fixed": fixed,
    "run": {m: list(map(float, solve(scene, 1e-9, m).links.peak_force)) for m in ("taylor",)},
    "events": list(map(float, solve(scene, 1e-9, "rk4-events", time_step=1e-4).links.peak_force)),
    "kept": list(map(float, np.abs(kept.link_force).max(axis=0))),
}))
"""


@pytest.fixture(scope="module")
def outside(tmp_path_factory):
    """A folder with the page's two files, installed as far as Python is concerned, and its study; runs Python there."""
    folder = tmp_path_factory.mktemp("bumper")
    law, project, study = (next(b.text for b in blocks(PAGE) if b.word == word) for word in ("python", "toml", "yaml"))
    (folder / "bumper.py").write_text(law)
    (folder / "cone.py").write_text(next(b.text for b in blocks(PAGE) if CONE in b.text))
    (folder / "isotropic.py").write_text(next(b.text for b in blocks(PAGE) if ISOTROPIC in b.text))
    (folder / "bumper.yaml").write_text(study)
    project += 'isotropic = "isotropic:Isotropic"\n'
    told = tomllib.loads(project)["project"]
    info = folder / f"{told['name']}-{told['version']}.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {told['name']}\nVersion: {told['version']}\n")
    ((group, entries),) = told["entry-points"].items()
    lines = "".join(f"{name} = {value}\n" for name, value in entries.items())
    (info / "entry_points.txt").write_text(f"[{group}]\n{lines}")
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join((str(folder), str(ROOT)))}

    def python(*arguments: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, *arguments], cwd=folder, env=environment, capture_output=True, text=True, timeout=240
        )

    return python, folder


@pytest.fixture(scope="module")
def found(outside):
    python, _ = outside
    done = python("-c", CHECK)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_energy_gives_the_compression(found):
    """m' v0^2 / 2 is the work of the pad, or of pad and floor; nothing is lost. Fails if the offset of a branch, or the
    closing at which the law begins, is left out."""
    reduced, pad, k, s = 2e5 * 3e5 / 5e5, 0.01, 1e8, 2e9
    soft = 0.02 + (reduced * 0.1**2 / k) ** 0.5
    assert found["soft"]["closing"] == pytest.approx(soft, rel=1e-9)
    assert found["soft"]["closing"] < 0.03
    left = reduced * 0.8**2 / 2 - k * pad**2 / 2  # s x^2 / 2 + k pad x of it is the floor's
    x = (-k * pad + ((k * pad) ** 2 + 2 * s * left) ** 0.5) / s
    assert found["hard"]["closing"] == pytest.approx(0.03 + x, rel=1e-9)
    assert found["hard"]["force"] == pytest.approx(k * pad + s * x, rel=1e-9)
    for name, v0 in (("soft", 0.1), ("hard", 0.8)):
        assert found[name]["rebound"] == pytest.approx(v0, rel=1e-9)
        assert found[name]["blows"] == 1
        assert abs(found[name]["residual"]) < 1e-10


def test_every_method_runs_it(found):
    """Against the located Taylor run; methods that do not locate events are of first order there."""
    expected = found["damped"]
    assert expected["rebound"] < 0.8 * 0.9
    assert abs(expected["residual"]) < 1e-9
    for method, one in found["fixed"].items():
        rel = 1e-8 if method == "rk4-events" else 5e-3
        assert one["status"] == "done"
        assert one["closing"] == pytest.approx(expected["closing"], rel=rel), method
        assert one["rebound"] == pytest.approx(expected["rebound"], rel=rel), method


def test_a_scene_with_it_agrees_by_two_methods_and_over_time(found):
    """Fails if histories take the force of another branch."""
    taylor = found["run"]["taylor"]
    assert max(taylor) > 1e6
    assert found["events"] == pytest.approx(taylor, rel=1e-5)
    assert max(found["kept"]) == pytest.approx(max(taylor), rel=0.05)


def test_the_program_runs_a_study_with_it(outside):
    """Commands as a user types them. Fails if a process that solves scenes does not know the law."""
    python, folder = outside
    done = python("-c", POUND, "run", "bumper.yaml", "--workers", "2", "-o", "bumper.h5")
    assert done.returncode == 0, done.stderr
    assert "padded" in done.stdout
    shown = python("-c", POUND, "show", "bumper.h5", "link", "--case", "padded")
    assert "bumper" in shown.stdout
    study = Path(folder / "bumper.yaml")
    wrong = Path(folder / "wrong.yaml")
    wrong.write_text(study.read_text().replace("pad: 1 cm, ", ""))
    refused = python("-c", POUND, "check", "wrong.yaml")
    assert refused.returncode == 2
    assert "'pad' is missing" in refused.stderr
    wrong.write_text(study.read_text().replace("link: pounding, gap", "link: pounding, pad: 1 cm, gap"))
    refused = python("-c", POUND, "check", "wrong.yaml")
    assert "'pad' does not apply to link: pounding" in refused.stderr
    wrong.write_text(study.read_text().replace("pad: 1 cm", "pad: 1 kg"))
    refused = python("-c", POUND, "check", "wrong.yaml")
    assert "expected m" in refused.stderr


CONE_CHECK = """
import json, math
import numpy as np
from cone import Cone
from pounding_cli import solve
from pounding_cli.model.building import Building
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Analysis, Scene
from pounding_cli.records import Motion
from pounding_cli.solve.histories import history

def free(mass):
    return Building("free", [mass], [3.0], [1e-6], [math.inf], [0.0], 0.0, 0.0)

def blow(delay, method="taylor", **more):
    link = Link(0, 1, 1, Cone(gap=0.03, cone_stiffness=1e12, delay=delay))
    scene = Scene((free(2e5), free(3e5)), (link,), Motion("still", 0.01, np.zeros(61)), Analysis.ELASTIC)
    run = solve(scene, 1e-11 if method == "taylor" else 1e-6, method, initial=([[0.0], [0.0]], [[0.8], [0.0]]), **more)
    (_, (left,)), (_, (right,)) = run.final
    return [float(run.links.max_closing[0]), float(right - left), run.energy.get("residual", 0.0)]

print(json.dumps({
    "free": blow(0.0), "damped": blow(0.004),
    "fixed": {m: blow(0.004, m, time_step=2e-5) for m in ("rk4-events", "rk4", "newmark")},
}))
"""


def test_a_force_as_an_expression_is_run_by_every_method(outside):
    """Without damping, m' v0^2 / 2 = k v^3.5 / 3.5; with it, methods that share nothing agree. Fails if the step takes
    another power of the closing, or if a product of the expression is left out."""
    python, _ = outside
    done = python("-c", CONE_CHECK)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    reduced = 2e5 * 3e5 / 5e5
    closing, rebound, residual = found["free"]
    assert closing == pytest.approx(0.03 + (reduced * 0.8**2 / 2 * 3.5 / 1e12) ** (1 / 3.5), rel=1e-9)
    assert rebound == pytest.approx(0.8, rel=1e-9)
    assert abs(residual) < 1e-10
    closing, rebound, residual = found["damped"]
    assert rebound < 0.75
    assert abs(residual) < 1e-10
    for method, (other, back, _) in found["fixed"].items():
        rel = 1e-7 if method == "rk4-events" else 5e-3
        assert other == pytest.approx(closing, rel=rel), method
        assert back == pytest.approx(rebound, rel=rel), method


ISOTROPIC_CHECK = """
import json
import numpy as np
from isotropic import Isotropic
from pounding_cli import solve
from pounding_cli.model.building import Building
from pounding_cli.model.scene import Analysis, Scene
from pounding_cli.records import Motion

M, K, VY, A, V0 = 2e5, 2e7, 3e5, 0.1, 0.5
STEPS = {m: dict(time_step=1e-4) for m in
         ("rk4-events", "rk4", "central-difference", "newmark", "hht-alpha", "generalized-alpha")}

def storeys(number, law={}):
    ones = np.ones(number)
    return Building("b", M * ones, 3.0 * ones, K * ones, VY * ones, A * ones, 0.1, 0.0, **law)

def isotropic(growth):
    return dict(storey_law=Isotropic, law_parameters=(("growth", growth),))

def throw(method="taylor", **more):
    import dataclasses
    building = dataclasses.replace(storeys(1, isotropic(1.0)), alpha=0.0)
    scene = Scene((building,), (), Motion("still", 0.02, np.zeros(101)), Analysis.INELASTIC)
    run = solve(scene, 1e-11 if method == "taylor" else 1e-6, method, initial=([[0.0]], [[V0]]), **more)
    b = run.buildings[0]
    energy = run.energy or {"hysteresis": 0.0, "residual": 0.0}
    return [run.status, float(b.displacement_max[0]), float(b.displacement_min[0]), float(b.residual_drift[0]),
            float(energy["hysteresis"]), float(energy["residual"])]

def shaken(law={}):
    motion = Motion("pulse", 0.02, 4.0 * np.sin(np.linspace(0.0, 25.0, 201)))
    run = solve(Scene((storeys(3, law),), (), motion, Analysis.INELASTIC), 1e-10)
    return [run.buildings[0].drift.tolist(), run.buildings[0].ductility.tolist(), run.events]

print(json.dumps({"taylor": throw(), "fixed": {m: throw(m, **more) for m, more in STEPS.items()},
                  "kinematic": shaken(isotropic(0.0)), "bilinear": shaken(), "isotropic": shaken(isotropic(1.0))}))
"""


def test_a_storey_law_is_run_by_every_method(outside):
    """Thrown once beyond the yield it swings between the reversal D and D - 2 F / k for ever: its elastic range is as
    wide as what it has stored takes it. Without growth it is the bilinear storey. Fails if the far yield line, or the
    end of the elastic range, is not remembered."""
    python, _ = outside
    done = python("-c", ISOTROPIC_CHECK)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    m, k, vy, a, v0 = 2e5, 2e7, 3e5, 0.1, 0.5
    dy, plateau, energy = vy / k, 0.9 * vy, 0.5 * m * v0**2
    rest = energy - 0.5 * vy * dy + plateau * dy + 0.5 * a * k * dy**2
    largest = (-plateau + (plateau**2 + 2 * a * k * rest) ** 0.5) / (a * k)
    shear = plateau + a * k * largest
    status, top, bottom, _, lost, residual = found["taylor"]
    assert status == "done"
    assert top == pytest.approx(largest, rel=1e-10)
    assert min(bottom, 0.0) == pytest.approx(min(largest - 2 * shear / k, 0.0), abs=1e-9 * largest)
    assert lost == pytest.approx(energy - shear**2 / (2 * k), rel=1e-9)
    assert abs(residual) < 1e-10
    for method, (status, top, *_) in found["fixed"].items():
        assert status == "done", method
        assert top == pytest.approx(largest, rel=1e-9 if method == "rk4-events" else 1e-4), method
    assert found["kinematic"][2] == found["bilinear"][2] > 20
    assert found["kinematic"][0] == pytest.approx(found["bilinear"][0], rel=1e-9)
    assert found["isotropic"][0] != pytest.approx(found["bilinear"][0], rel=1e-2)


def test_the_program_runs_a_study_with_a_storey_law(outside):
    """Keys and refusals of a building. Fails if a parameter of the law is no key, or is taken for another law."""
    python, folder = outside
    text = (
        Path(folder / "bumper.yaml")
        .read_text()
        .replace("period: 0.5 s}", "period: 0.5 s, storey_law: isotropic, growth: 0.5}")
    )
    study = Path(folder / "isotropic.yaml")
    study.write_text(text)
    done = python("-c", POUND, "run", "isotropic.yaml", "--workers", "2", "-o", "isotropic.h5")
    assert done.returncode == 0, done.stderr
    for old, new, words in (
        (", growth: 0.5", "", "'growth' is missing"),
        ("growth: 0.5", "growth: 1.5", "growth is 1.5"),
        ("isotropic, growth", "bilinear, growth", "'growth' does not apply to storey_law: bilinear"),
        ("storey_law: isotropic, growth: 0.5", "storey_law: isotropy", "'bouc-wen' or 'isotropic'"),
    ):
        study.write_text(text.replace(old, new))
        refused = python("-c", POUND, "check", "isotropic.yaml")
        assert refused.returncode == 2, new
        assert "isotropic.yaml:2:" in refused.stderr
        assert words in refused.stderr, refused.stderr
