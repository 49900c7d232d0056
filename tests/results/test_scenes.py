"""Scenes by hand: the same as those of a study, and refused at their keys."""

from __future__ import annotations

import numpy as np
import pytest

import pounding_cli as pound

STUDY = {
    "records": {"use": ["elcentro"], "duration": "3 s", "scale": {"pga": "0.4 g"}},
    "buildings": {
        "stiff": {"storeys": 5, "period": "0.36 s", "yield": {"code": "UBC-1994", "soil": 1.5}},
        "soft": {"storeys": 3, "period": 0.6, "mass": ["150 t", "150 t", "100 t"], "yield_shear": "never"},
    },
    "group": ["stiff", "soft"],
    "cases": {
        "gap": {"link": "pounding", "gap": "2 cm", "restitution": 0.4, "floors": [1, 3]},
        "filled": {"gap": "2 cm", "links": [{"link": "infill", "floors": "rest"}, {"link": "connector", "floors": 2}]},
    },
    "analyses": ["inelastic"],
    "impact": {"stiffness": "10 x stiffest storey", "tension_cut": True},
    "tail": "2 s",
}


def pieces():
    stiff = pound.building("stiff", storeys=5, period="0.36 s", yield_={"code": "UBC-1994", "soil": 1.5})
    masses = np.array([150e3, 150e3, 100e3])
    soft = pound.building("soft", storeys=3, period="0.6 s", mass=masses, yield_shear="never")
    return [stiff, soft], pound.motion("elcentro", duration=3.0, pga="0.4 g")


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    return pound.run(STUDY, tmp_path_factory.mktemp("scenes") / "r.h5", engine="serial")


@pytest.mark.parametrize("case", ["gap", "filled"])
def test_it_is_the_scene_of_the_study(results, case):
    """By its peaks: masses, yield shears, links, motion, tail. Fails if one key is dropped on the way."""
    buildings, motion = pieces()
    ours = pound.solve(pound.scene(buildings, motion, impact=STUDY["impact"], tail="2 s", **STUDY["cases"][case]))
    storey = results.storey().query(f"case == '{case}'")
    for name, response in zip(("stiff", "soft"), ours.buildings, strict=True):
        wanted = storey.query(f"building == '{name}'")
        assert response.shear == pytest.approx(wanted["V"].to_numpy(), rel=1e-12)
    assert ours.steps == int(results.scene().query(f"case == '{case}'")["steps"].iloc[0])
    forces = results.link().query(f"case == '{case}'")["peak_force"].to_numpy()
    assert ours.links.peak_force == pytest.approx(forces, rel=1e-12)


def test_links_by_hand_and_none():
    buildings, motion = pieces()
    one = pound.scene(buildings, motion, gap="1 cm").links[0]
    assert pound.scene(buildings, motion, links=[one]).links == (one,)
    assert pound.scene(buildings, motion, link="none").links == ()
    assert pound.scene(buildings[:1], motion).links == ()
    twice = pound.scene([buildings[0], buildings[0]], motion, gap=0.0)
    assert [building.name for building in twice.buildings] == ["stiff-1", "stiff-2"]


def test_motions_from_arrays_and_files(tmp_path):
    time = np.arange(0, 2, 0.01)
    wave = 0.3 * np.sin(9 * time)
    np.savetxt(tmp_path / "wave.txt", np.column_stack([time, wave]))
    ours = pound.motion(wave, dt="10 ms", unit="g", name="wave")
    theirs = pound.motion(tmp_path / "wave.txt", unit="g", time=1)
    assert (ours.name, ours.dt) == (theirs.name, theirs.dt)
    assert ours.acceleration == pytest.approx(theirs.acceleration, rel=1e-12)
    assert pound.motion(list(wave), dt=0.01, scale=2.0).pga == pytest.approx(2 * np.abs(wave).max())
    assert pound.motion(wave, dt=0.01, duration="1 s").duration == pytest.approx(1.0)


REFUSED = [
    (lambda: pound.building("x", storeys=5, period="0.3 m"), "period: '0.3 m' is no period: expected s"),
    (lambda: pound.building("x", storeys=5, perid=0.3), "perid: unknown key 'perid'\n    did you mean 'period'"),
    (lambda: pound.building("x", storeys=2, period=1, mass=[1e5]), "mass: mass has 1 value for 2 storeys"),
    (lambda: pound.scene(*pieces()), "'gap' is missing"),
    (lambda: pound.scene(*pieces(), gap="2 kg"), "gap: '2 kg' is no gap"),
    (lambda: pound.scene(*pieces(), gap=0, floors=[5]), "no common floor 5"),
    (lambda: pound.scene(*pieces(), gap=0, impact={"restitution": 2}), "impact.restitution: the coefficient of rest"),
    (lambda: pound.scene(*pieces(), gap=0, links=[]), "'links' leaves no place for gap"),
    (lambda: pound.scene(*pieces(), gap=0, analysis="plastic"), "analysis: the analysis 'plastic' is not known"),
    (lambda: pound.scene(*pieces(), gap=0, tail="-1 s"), "tail: the tail is -1 s"),
    (lambda: pound.scene([], pieces()[1]), "no buildings"),
    (lambda: pound.motion([0.1, 0.2]), "does not say its time step"),
    (lambda: pound.motion([0.1], dt=0.1), "at least two samples"),
    (lambda: pound.motion([0.1, 0.2], dt=0.1, unit="m"), "unknown unit 'm'"),
    (lambda: pound.motion("elcentroo"), "did you mean 'elcentro'"),
    (lambda: pound.motion("nowhere/x.at2"), "o such file"),
    (lambda: pound.motion("elcentro", dt=0.01), "its time step and unit are fixed"),
    (lambda: pound.motion("elcentro", scale=2, pga=1), "both 'scale' and 'pga'"),
]


@pytest.mark.parametrize(("wrong", "message"), REFUSED, ids=[message[:30] for _, message in REFUSED])
def test_what_is_wrong_is_told(wrong, message):
    with pytest.raises(pound.InputError) as refused:
        wrong()
    assert message in str(refused.value)


def test_neighbours_without_a_common_floor():
    low, high = pound.building("low", storeys=2, period=0.2), pound.building("high", storeys=2, period=0.2, height=3.5)
    with pytest.raises(pound.InputError, match="low and high have no floor at one elevation"):
        pound.scene([low, high], pieces()[1], gap=0)


def test_everything_shows_itself_in_a_line():
    buildings, motion = pieces()
    scene = pound.scene(buildings, motion, gap="2 cm")
    assert repr(buildings[0]) == "Building('stiff', 5 storeys, T = 0.36 s)"
    assert repr(motion) == "Motion('elcentro', 3 s every 10 ms, peak 3.923 m/s2, stand-in)"
    assert repr(scene) == "Scene(stiff | soft; 3 links; elcentro; inelastic)"
    assert repr(pound.solve(scene)).startswith("Response(done; taylor; largest storey shears ")
