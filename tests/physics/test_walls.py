"""A building beside a wall: blows in closed form, a base in its moat, walls on the soil behind them."""

from __future__ import annotations

import importlib.util
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

import pounding_cli as pound
from pounding_cli.cli.main import cli
from tests.adapter import Scene, difference, refused, solve
from tests.physics.cases import shake

MASS, PERIOD, SPRING, GAP, START = 960e3, 2.77, 5e8, 0.30, 0.40
STIFFNESS = MASS * (2 * math.pi / PERIOD) ** 2
FREE = {"rayleigh": {"alpha": 0.0, "beta": 0.0}, "yield_shear": "never"}
MOVING = {"wall": {"height": 20.0, "mass": 4e4, "stiffness": 1e8, "damping": 1e5}}


def isolated(mass: float = MASS) -> dict[str, Any]:
    """One mass on a spring, without damping."""
    return {"storeys": 1, "mass": mass, "stiffness": [STIFFNESS], **FREE}


def against(wall_first: bool, gap: float, start: float, seconds: float, **settings: Any) -> Any:
    """Released at a distance from rest [m] away from a fixed wall, no motion of the ground."""
    row = [{"wall": "fixed"}, isolated()] if wall_first else [isolated(), {"wall": "fixed"}]
    away = start if wall_first else -start
    first = [np.zeros(1), np.array([away])] if wall_first else [np.array([away]), np.zeros(1)]
    case = {"link": "pounding", "gap": gap, "stiffness": SPRING, "restitution": 1.0}
    scene = Scene(row, np.zeros(round(seconds / 0.01) + 1), 0.01, case, start=(first, [np.zeros(1)] * 2))
    return solve(scene, 1e-10, **settings)


@pytest.mark.parametrize("wall_first", [True, False], ids=["wall-left", "wall-right"])
@pytest.mark.parametrize("method", ["taylor", "dop853"])
def test_a_blow_on_a_wall(wall_first: bool, method: str) -> None:
    """Speed at contact, penetration, force and time in contact of an undamped mass, by hand."""
    run = against(wall_first, GAP, START, 1.5, method=method)
    w1, w2 = 2 * math.pi / PERIOD, math.sqrt((STIFFNESS + SPRING) / MASS)
    speed = w1 * math.sqrt(START**2 - GAP**2)
    assert speed == pytest.approx(0.60014, abs=5e-6)
    rest = STIFFNESS * GAP / (STIFFNESS + SPRING)  # the middle of the motion in contact lies before the wall's face
    size = math.hypot(rest, speed / w2)
    depth, turn = size - rest, math.atan2(speed / w2, rest)
    assert run.max_closing[0] - GAP == pytest.approx(depth, rel=1e-9)
    assert run.peak_force[0] == pytest.approx(SPRING * depth, rel=1e-9)
    assert run.contact_time[0] == pytest.approx(2 * turn / w2, rel=1e-8)
    assert (depth, SPRING * depth) == pytest.approx((23.397e-3, 11.699e6), rel=5e-5)
    assert run.contact_time[0] == pytest.approx(0.12724, abs=5e-6)
    assert abs(run.energy["residual"]) < 1e-12


def test_a_joint_beside_a_wall_is_level() -> None:
    """Whatever distance its ends have along the row: a wall is as high as the floor. Fails if its heights are asked."""
    tower = {"storeys": 3, "period": 0.5, "yield_shear": "never"}
    case = {"link": "connector", "gap": 0.05, "stiffness": 3e7}
    runs = [
        solve(Scene([tower, {"wall": "fixed"}], shake(1.0), 0.02, each), 1e-9)
        for each in (case, case | {"distance": 2.0})
    ]
    assert difference(*runs) == 0.0


def test_the_period_of_a_mass_in_touch_with_a_wall() -> None:
    """pi / w1 + pi / w2: half a swing on its spring, half against the wall too."""
    w1, w2 = 2 * math.pi / PERIOD, math.sqrt((STIFFNESS + SPRING) / MASS)
    period = math.pi / w1 + math.pi / w2
    run = against(False, 0.0, START, math.ceil(100 * period) / 100)
    at_end = run.end[0], run.end_velocity[0]
    left = math.ceil(100 * period) / 100 - period
    assert at_end == pytest.approx((-START * math.cos(w1 * left), START * w1 * math.sin(w1 * left)), rel=1e-8)


def test_a_wall_that_moves_as_the_ground_does() -> None:
    """It has no peaks, and is the limit of a wall on a stiff soil."""
    tower = {"storeys": 3, "period": 0.5, "yield_shear": "never"}
    case = {"link": "pounding", "gap": 0.005, "stiffness": 2e8, "restitution": 1.0}
    ground = shake(3.0)
    fixed = solve(Scene([tower, {"wall": "fixed"}], ground, 0.02, case), 1e-9)
    stiff = {"wall": {"mass": 1e3, "stiffness": 1e14}}
    moving = solve(Scene([tower, stiff], ground, 0.02, case), 1e-9)
    assert (fixed.impacts > 0).all()
    assert np.isnan(fixed.shear[3])
    assert np.isnan(fixed.acceleration[3])
    np.testing.assert_allclose(fixed.shear[:3], moving.shear[:3], rtol=1e-4)
    np.testing.assert_allclose(fixed.peak_force, moving.peak_force, rtol=1e-4)
    steps = solve(Scene([tower, {"wall": "fixed"}], ground, 0.02, case), method="newmark", time_step=2e-5)
    np.testing.assert_allclose(fixed.shear[:3], steps.shear[:3], rtol=1e-2)


def test_a_wall_on_the_soil_is_a_building_of_one_storey() -> None:
    tower = {"storeys": 1, "mass": 2e5, "stiffness": [4e7], "height": 4.0, **FREE}
    same = {
        "storeys": 1, "mass": 4e4, "stiffness": [1e8], "height": 4.0, "yield_shear": "never",
        "rayleigh": {"alpha": 0.0, "beta": 1e5 / 1e8},
    }  # fmt: skip
    case = {"link": "pounding", "gap": 0.005, "stiffness": 2e8, "restitution": 0.6}
    one, other = (solve(Scene([tower, each], shake(3.0), 0.02, case), 1e-9) for each in (MOVING, same))
    assert one.impacts[0] > 0
    assert difference(one, other, ("shear", "drift", "acceleration", "peak_force", "impulse")) < 1e-12


def test_a_base_strikes_the_wall_of_its_moat() -> None:
    """Two methods, and the base stays within gap and penetration of both walls."""
    base = {"mass": 3e5, "isolation": {"radius": 3.1, "friction": 0.06}}
    house = {"storeys": 2, "mass": 2e5, "stiffness": [1e8, 1e8], **FREE, "foundation": base}
    moat = {"wall": {"height": 0.0}}
    case = {"link": "pounding", "gap": 0.04, "floors": "base", "stiffness": 5e8, "restitution": 0.5}
    scene = Scene([moat, house, moat], shake(4.0), 0.02, case)
    run, other = solve(scene, 1e-9), solve(scene, 1e-9, method="dop853")
    assert (run.impacts > 0).all()
    assert difference(run, other) < 1e-7
    assert 0.04 < run.sway[1] == pytest.approx(run.max_closing.max(), rel=1e-12)
    assert abs(run.energy["residual"]) < 1e-9


def test_a_check_tells_walls_and_isolators(tmp_path: Path) -> None:
    (tmp_path / "moat.yaml").write_text(
        "records: {use: [elcentro]}\nbuildings:\n  moat: {wall: {height: 4 m}}\n  rigid: {wall: fixed}\n"
        "  house: {storeys: 3, period: 0.3 s, foundation: {mass: 200 t, isolation: {radius: 3.122 m, friction: 6.59 %,"
        " capacity: 32.258 cm}}}\ngroup: [moat, house, rigid]\ncases: {near: {link: pounding, gap: 5 cm}}\n"
    )
    said = CliRunner().invoke(cli, ["check", str(tmp_path / "moat.yaml")]).output
    assert "moat|house  the wall meets base, floor 1\n" in said
    assert "house|rigid  the wall meets base, floor 1, floor 2, floor 3\n" in said
    assert "period 2.77 s, damping 24.8 %" in said


STUDY = """\
records: {use: [elcentro]}
buildings:
  A: {storeys: 2, period: 0.3 s}
  W: WALL
group: [A, W]
cases: {near: LINK}
"""


@pytest.mark.parametrize(
    ("wall", "link", "line", "word"),
    [
        ("{wall: {stiffness: 1e8 N/m}}", "{link: pounding, gap: 1 cm}", 4, "mass"),
        ("{wall: {mass: 40 t}}", "{link: pounding, gap: 1 cm}", 4, "no effect"),
        ("{wall: fixed, storeys: 2}", "{link: pounding, gap: 1 cm}", 4, "does not apply to a wall"),
        ("{wall: {height: 4 m}}", "{link: pounding, gap: 1 cm, floors: 2}", 6, "no common floor 2"),
        ("{wall: fixed}", "{link: pounding, gap: 1 cm, floors: base}", 6, "no common floor base"),
        ("{wall: {height: 0 m}}", "{link: pounding, gap: 1 cm}", 5, "no floor meets the wall"),
    ],
)
def test_walls_that_are_refused(wall: str, link: str, line: int, word: str) -> None:
    problems = refused(STUDY.replace("WALL", wall).replace("LINK", link))
    assert {each for each, _, _ in problems} == {line}, problems
    assert any(word in words for _, _, words in problems), problems


def test_the_gap_to_a_wall_is_how_far_the_building_moves(tmp_path: Path) -> None:
    """By `pound gap`: at a floor the displacement to that side, at a base its sway, which codes do not know."""
    study = {
        "records": {"use": ["elcentro", "taft"], "duration": 8.0},
        "buildings": {
            "moat": {"wall": {"height": 4.0}},
            "house": {
                "storeys": 2, "period": 0.3,
                "foundation": {"mass": 2e5, "isolation": {"radius": 3.1, "friction": 0.06}},
            },
        },
        "group": ["moat", "house"], "analyses": ["elastic"],
        "cases": {"near": {"link": "pounding", "gap": 0.01}},
    }  # fmt: skip
    results = pound.run(study, tmp_path / "gap.h5", workflow="gap")
    found = results.answer("gap").frame
    exact, codes = found[found["rule"] == "exact"], found[found["rule"] == "UBC-1991"]
    assert list(exact["floor"]) == [0, 1]
    assert list(codes["floor"]) == [1]
    moved = results.data["displacement_min"].sel(building="house", floor=1).values
    assert exact["largest"].iloc[1] == pytest.approx(-moved.min(), rel=1e-9)
    sway = results.data["sway"].sel(building="house").values
    assert exact["largest"].iloc[0] <= sway.max() * (1 + 1e-9)


def test_a_stiff_contact_converges_with_the_square_root_of_its_stiffness() -> None:
    """An oscillator under a harmonic motion against a wall, as docs/contact.md has it (`impact_oscillator.py`)."""
    path = Path(__file__).parents[2] / "docs/figures/impact_oscillator.py"
    spec = importlib.util.spec_from_file_location("impact_oscillator", path)
    assert spec is not None
    assert spec.loader is not None
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    exact = script.speed_of_rigid_blow()
    assert exact == pytest.approx(2 * np.pi * 0.404864, rel=1e-5)
    errors = [1 - script.speed_of_blow(stiffness) / exact for stiffness in (1e3, 1e5)]
    assert errors == pytest.approx([0.130, 0.0103], rel=0.01)
