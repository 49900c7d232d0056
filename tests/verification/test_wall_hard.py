"""Hard impacts: each finite with its energy balance closed, or refused with a reason."""

from __future__ import annotations

import numpy as np
import pytest

from pounding_cli.errors import InputError
from pounding_cli.wall.analysis import strike
from pounding_cli.wall.mesh import build_mesh
from pounding_cli.wall.model import Bond, Concrete, Contact, Frame, Mesh, Over, Striker, Time, WallModel

MESH = Mesh(0.25, 0.2)
CASES = {
    "poisson": dict(concrete=Concrete(poisson=0.49)),
    "light": dict(striker=Striker(mass=1e3), time=Time(0.01)),
    "heavy": dict(striker=Striker(mass=1e7), time=Time(0.5)),
    "one element": dict(mesh=Mesh(2.0)),
    "thin patch": dict(contact=Contact(patch=0.01)),
    "floor": dict(striker=Striker(height=12.0)),
    "floor, node": dict(striker=Striker(height=12.0), contact=Contact(over=Over.NODE)),
    "floor, node, glued": dict(striker=Striker(height=12.0), contact=Contact(Over.NODE, Bond.GLUED)),
    "top": dict(striker=Striker(height=15.0)),
    "top, node": dict(striker=Striker(height=15.0), contact=Contact(over=Over.NODE)),
    "base": dict(striker=Striker(height=0.0)),
    "wall with mass": dict(concrete=Concrete(density=2500.0), time=Time(0.03)),
    "one storey, one bay": dict(frame=Frame(storeys=1, bays=(5.0,)), striker=Striker(height=1.5)),
}


@pytest.mark.parametrize("case", CASES)
def test_finite_and_closed(case):
    found = strike(WallModel(**{"mesh": MESH, **CASES[case]}))
    numbers = (found.peak_force, found.wall_stress, found.averaged_stress, found.beam_stress, found.reach)
    assert np.isfinite(numbers).all()
    assert found.peak_force > 0
    assert found.energy_residual < 1e-3
    assert abs(found.momentum_residual) < 1e-5


def test_light_striker_bounces_and_heavy_one_pushes_on():
    light = strike(WallModel(mesh=MESH, **CASES["light"]))
    assert light.transient.velocity[-1] < -0.4
    heavy = strike(WallModel(mesh=MESH, striker=Striker(mass=1e7), time=Time(0.06)))
    assert heavy.transient.velocity[-1] > 0.4
    assert any("still in contact" in flag for flag in heavy.flags)


def test_force_is_proportional_to_the_speed():
    slow, fast = (strike(WallModel(mesh=MESH, striker=Striker(speed=v))) for v in (0.01, 5.0))
    assert fast.peak_force == pytest.approx(500 * slow.peak_force, rel=1e-9)


def test_patch_at_the_top_is_cut_and_said_so():
    found = strike(WallModel(mesh=MESH, striker=Striker(height=15.0)))
    assert any("0.1 m of 0.2 m" in flag for flag in found.flags)


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        (dict(striker=Striker(height=0.0), contact=Contact(over=Over.NODE)), "fixed node at the base"),
        (dict(striker=Striker(height=16.0)), "beside the wall"),
        (dict(concrete=Concrete(poisson=0.5)), "Poisson"),
        (dict(thickness=0.0), "thickness"),
        (dict(striker=Striker(mass=float("nan"))), "striker mass"),
        (dict(mesh=Mesh(1e-4)), "elements"),
        (dict(mesh=Mesh(1e-3, 1e-4)), "elements"),
        (dict(time=Time(0.06, 0.03)), "fewer than 10 steps"),
        (dict(averaging_length=3.0), "averaging length"),
        (dict(frame=Frame(bays=())), "no bay"),
        (dict(contact=Contact(patch=20.0)), "patch"),
    ],
)
def test_refused_with_a_reason(keys, words):
    with pytest.raises(InputError, match=words) as refused:
        WallModel(**keys)
    assert all(problem.hint for problem in refused.value.problems)


def test_an_impact_too_short_for_its_time_is_refused():
    with pytest.raises(InputError, match="time steps") as refused:
        strike(WallModel(mesh=MESH, striker=Striker(mass=1e-6)))
    assert "time.end" in refused.value.problems[0].hint


def test_count_of_elements_is_about_that_of_the_mesh():
    for mesh in (Mesh(0.3), Mesh(0.1, 0.2), Mesh(0.02, 0.5)):
        model = WallModel(mesh=mesh)
        lines = mesh.lines(model.length), mesh.lines(13.5) + mesh.lines(1.5)
        built = build_mesh(model)
        assert built.x_lines.size == pytest.approx(lines[0], abs=2.5)
        # Floors and the edges of the patch are lines too, and the patch is finest throughout.
        assert -1 < built.y_lines.size - lines[1] < 10 + 0.2 / mesh.size
