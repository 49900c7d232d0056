"""Histories: their largest values are the peaks of the ordinary run, whatever the output step."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from pounding_cli.errors import InputError
from pounding_cli.records.motion import Motion
from pounding_cli.solve import solve
from pounding_cli.solve.histories import history
from tests.helpers.small_scenes import SCENES, small

EVERY = 2.5e-4
"""Fine enough for contacts of 5 ms to show their largest force."""


@pytest.fixture(scope="module", params=SCENES)
def both(request):
    scene = SCENES[request.param]
    return scene, solve(scene, 1e-9), history(scene, 1e-9, EVERY)


def largest(values):
    return np.nanmax(np.abs(values), axis=0)


def test_the_largest_values_are_the_peaks(both):
    """Fails if a storey on its yield line is taken for elastic, or a link's dashpot is left out."""
    _, response, found = both
    for place, building in enumerate(response.buildings):
        for values, peak, reach in (
            (found.shear, building.shear, 0.999),
            (found.drift, building.drift, 0.999),
            (found.displacement, np.maximum(building.displacement_max, -building.displacement_min), 0.999),
            (found.total_acceleration, building.acceleration, 0.9),
        ):
            share = largest(values[:, place, : peak.size]) / peak
            assert (share <= 1 + 1e-8).all()
            assert (share >= reach).all()
        assert largest(found.sway[:, place]) == pytest.approx(building.sway, rel=1e-3)
        assert largest(found.rocking[:, place]) == pytest.approx(building.rocking, rel=1e-3)
    force = response.links.peak_force
    if force.size == 0:
        return
    assert force.max() > 0  # the floors do meet
    share = largest(found.link_force) / np.where(force > 0, force, 1)
    assert (share <= 1 + 1e-7).all()
    assert (share >= np.where(force > 0, 0.9, 0)).all()


def test_links_push_as_long_and_as_much_as_they_did(both):
    """Sums over samples, so to a per cent. Fails if an open link pulls."""
    _, response, found = both
    impulse = found.link_force.sum(axis=0) * EVERY
    assert impulse == pytest.approx(response.links.impulse, rel=0.02, abs=0.002 * response.links.impulse.max(initial=0))
    lasted = (found.link_force != 0).sum(axis=0) * EVERY
    most = EVERY * (1 + response.links.impacts)
    assert (np.abs(lasted - response.links.contact_time) <= most).all()


def test_energy_put_in_is_energy_held_and_lost(both):
    _, response, found = both
    given = found.energy["input"]
    off = 2 * given - sum(found.energy.values())
    assert np.abs(off).max() < 1e-8 * given.max()
    for name in ("input", "kinetic", "stored", "damping", "hysteresis"):
        last = response.energy[name]
        assert found.energy[name][-1] == pytest.approx(last, rel=1e-6, abs=1e-9 * given.max())


def test_the_end_is_where_the_ordinary_run_ends(both):
    _, response, found = both
    for place, (displacement, _) in enumerate(response.final):
        n = displacement.size
        assert found.displacement[-1, place, :n] == pytest.approx(displacement, rel=1e-7, abs=1e-12)
        assert found.drift[-1, place, :n] == pytest.approx(
            response.buildings[place].residual_drift, rel=1e-6, abs=1e-12
        )
        assert np.isnan(found.displacement[:, place, n:]).all()


def test_the_output_step_need_not_divide_the_motions():
    """7 ms against samples every 20 ms. Fails if a piece of ground takes the wrong sample's slope."""
    scene = SCENES["yielding"]
    coarse, fine = history(scene, 1e-10, 7e-3), history(scene, 1e-10, 1e-3)
    assert coarse.time[-1] == pytest.approx(0.994)
    np.testing.assert_allclose(coarse.time, fine.time[::7][: coarse.time.size], atol=1e-12)
    for name in ("ground_acceleration", "ground_displacement", "displacement", "shear"):
        one, other = getattr(coarse, name), getattr(fine, name)[::7]
        np.testing.assert_allclose(one, other[: one.shape[0]], rtol=0, atol=1e-7 * np.nanmax(np.abs(other)))


def test_displacement_and_acceleration_belong_together():
    """Second differences of the displacement are the acceleration less the ground's, where nothing is abrupt."""
    found = history(SCENES["alone"], 1e-12, 1e-3)
    bend = np.diff(found.displacement, 2, axis=0) / 1e-6
    relative = found.total_acceleration - found.ground_acceleration[:, None, None]
    np.testing.assert_allclose(bend, relative[1:-1], rtol=0, atol=2e-3 * np.nanmax(np.abs(relative)))


def test_ground_under_a_ramp_moves_by_its_cube():
    motion = Motion("ramp", 0.02, 3.0 * 0.02 * np.arange(51))
    found = history(dataclasses.replace(small("none"), motion=motion), 1e-6, 0.003)
    assert found.ground_acceleration == pytest.approx(3.0 * found.time, rel=1e-12)
    assert found.ground_displacement == pytest.approx(3.0 * found.time**3 / 6, rel=1e-12)


def test_the_tail_belongs_to_it():
    scene = dataclasses.replace(SCENES["alone"], tail=0.3)
    found = history(scene, 1e-6, 0.01)
    assert found.time[-1] == pytest.approx(scene.motion.duration + 0.3)
    assert (found.ground_acceleration[found.time > scene.motion.duration + 0.001] == 0).all()


def test_no_step_is_refused():
    with pytest.raises(InputError, match="must be above zero"):
        history(SCENES["alone"], 1e-6, 0.0)
