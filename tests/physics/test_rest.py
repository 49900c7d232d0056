"""Residual drifts: those at rest, long after the motion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pounding_cli as pound
from tests.adapter import Run, Scene, solve, solve_whole
from tests.physics.cases import CAPPED, IMPACT, PINCHED, shake

STOREYS = (2, 3)

CASES: dict[str, dict[str, Any]] = {
    "apart": {},
    "pounding": {"link": "pounding", "gap": 0.02},
    "touching": {"link": "pounding", "gap": 0.0},
    "hertz": {"link": "hertz", "gap": 0.01, "hertz_stiffness": 2e9},
    "infill": {"link": "infill", "gap": 0.05, "stiffness": 2e6},
    "connector": {"link": "connector", "gap": 0.5, "stiffness": 2e6},
    "friction": {"link": "friction", "gap": 0.5, "slip_force": 1e5},
    "maxwell": {"link": "maxwell", "gap": 0.5, "damping_coefficient": 2e5, "stiffness": 1e7},
}

LAWS: dict[str, dict[str, Any]] = {
    "bilinear": {},
    "peak-oriented": {"storey_law": "peak-oriented"},
    "imk": {"storey_law": "imk-peak-oriented", **CAPPED},
    "pinching": {"storey_law": "imk-pinching", **CAPPED, **PINCHED},
    "bouc-wen": {"storey_law": "bouc-wen"},
    "p-delta": {"p_delta": True},
    "light damping": {"damping": 0.02},
    "isolated": {"foundation": {"mass": 1e5, "isolation": {"radius": 2.0, "friction": 0.06}}},
}


def house(period: float, storeys: int, strength: float, **keys: Any) -> dict[str, Any]:
    """A building of floors of 100 t whose lowest storey yields at `strength` of the weight of a floor a storey."""
    shears = [strength * 1e6 * (storeys - storey) ** 0.7 for storey in range(storeys)]
    usual = {"storeys": storeys, "mass": 1e5, "period": period, "height": 3.0, "yield_shear": shears}
    return usual | {"hardening": 0.03, "damping": 0.05} | keys


def neighbours(case: Mapping[str, Any], tail: float = 0.0, analysis: str = "inelastic", **keys: Any) -> Scene:
    """Two buildings under 5 s of a motion that ends at its strongest."""
    both = house(0.5, STOREYS[0], 0.15, **keys), house(1.0, STOREYS[1], 0.10, **keys)
    return Scene(both, shake(5.0, 3.0, seed=3), 0.02, case, analysis, {"impact": IMPACT}, tail)


def drifts_at_end(run: Run) -> np.ndarray:
    """Drifts of all storeys at the end of a run [m], on bases that stand still or do not move."""
    floors = np.split(run.end, np.cumsum(STOREYS)[:-1])
    return np.concatenate([np.diff(np.concatenate(([0.0], each))) for each in floors])


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_elastic_storeys_have_none(case: Mapping[str, Any]) -> None:
    run = solve(neighbours(case, analysis="elastic"))
    if case.get("link") != "friction":  # which holds the floors where it stopped to slip
        assert (run.residual_drift == 0.0).all()
    assert np.abs(drifts_at_end(run)).max() > 0.1 * run.drift.max()


def agrees_with_a_tail(case: Mapping[str, Any], **keys: Any) -> None:
    """Compare the residual drifts with the drifts after 60 s of free vibration, to 1 %."""
    run, late = solve(neighbours(case, **keys)), solve(neighbours(case, 60.0, **keys))
    expected = drifts_at_end(late)
    if "foundation" in keys:  # the base has come to rest away from the middle
        expected[[0, STOREYS[0]]] = late.residual_drift[[0, STOREYS[0]]]
    assert run.status == late.status == "done"
    assert np.abs(expected).max() > 0.0
    np.testing.assert_allclose(run.residual_drift, expected, rtol=0.01, atol=1e-4 * run.drift.max())
    np.testing.assert_allclose(late.residual_drift, expected, rtol=0.01, atol=1e-4 * run.drift.max())


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_yielding_storeys_have_those_of_a_long_tail(case: Mapping[str, Any]) -> None:
    agrees_with_a_tail(case)


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_every_law_of_storeys_has_those_of_a_long_tail(law: Mapping[str, Any]) -> None:
    agrees_with_a_tail(CASES["pounding"], **law)
    agrees_with_a_tail(CASES["apart"], **law)


@pytest.mark.parametrize("law", ["peak-oriented", "imk", "pinching"])
def test_a_building_at_rest_has_no_events(law: str) -> None:
    """Fails if turning points of the last digits of its drifts count: alone, and for a minute, they have no end."""
    both = neighbours({}, **LAWS[law]).buildings
    for building in both:
        alone = [
            solve(Scene((building,), shake(5.0, 3.0, seed=3), 0.02, {}, "inelastic", {}, tail)) for tail in (30.0, 60.0)
        ]
        assert [run.status for run in alone] == ["done", "done"]
        assert alone[0].events == alone[1].events


@pytest.mark.parametrize(("method", "settings"), [("dop853", {}), ("newmark", {"time_step": 1e-3})])
def test_other_methods_have_the_same(method: str, settings: Mapping[str, float]) -> None:
    one, other = solve(neighbours({})), solve(neighbours({}), method=method, **settings)
    np.testing.assert_allclose(other.residual_drift, one.residual_drift, rtol=1e-2, atol=1e-2 * one.drift.max())


def test_peaks_and_blows_are_those_of_the_motion() -> None:
    """Fails if the free vibration by which the drift at rest is found raises a peak or counts a blow."""
    scene = neighbours(CASES["touching"])
    run, history = solve(scene), pound.history(scene.built, every=0.001)
    largest = np.abs(history.drift).max(axis=0)
    found = np.concatenate([largest[place, :storeys] for place, storeys in enumerate(STOREYS)])
    np.testing.assert_allclose(run.drift, found, rtol=1e-3)
    assert (solve(neighbours({}, 60.0)).drift > 1.01 * solve(neighbours({})).drift).any()


@pytest.mark.parametrize(
    ("keys", "reason"),
    [({"damping": 0.0}, "nothing damps"), ({"damping": 1e-5}, "not at rest 600 s after")],
)
def test_none_without_rest(keys: Mapping[str, Any], reason: str) -> None:
    run = solve(neighbours({}, **keys))
    assert np.isnan(run.residual_drift).all()
    assert np.isfinite(run.drift).all()
    assert any(str(flag).startswith("no residual drift") and reason in str(flag) for flag in run.flags)


def test_none_where_a_storey_collapses_later() -> None:
    """A motion that ends as it has pushed a storey to where its weight overturns it, and one a little weaker."""
    weak = house(1.0, 1, 0.1, hardening=0.0, p_delta=True)
    for peak, stands in ((1.0, True), (4.0, False)):
        push = np.array([0.0, -peak, -peak, 0.0])
        run = solve(Scene((weak,), push, 0.1, {}, "inelastic"))
        assert run.status == "done"
        assert np.isfinite(run.residual_drift).all() == stands
        assert any("collapses in free vibration" in flag for flag in run.flags) != stands


def test_a_gap_that_closes_after_the_motion(tmp_path: Path) -> None:
    """In a batch, where neighbours with nothing between them answer scenes whose gaps stay open. Fails if that is seen
    up to the end of the motion alone."""
    study = {
        "records": {"use": ["elcentro"], "duration": "3 s", "scale": {"pga": "0.5 g"}},
        "buildings": {
            "A": {"storeys": 2, "period": "0.5 s", "yield": {"overstrength": 1.0}},
            "B": {"storeys": 2, "period": "1.1 s", "yield": {"overstrength": 1.0}},
        },
        "group": ["A", "B"], "analyses": ["inelastic"], "residual_drift": True,
        "cases": {"far": {"link": "pounding", "gap": "1 m"}, "near": {"link": "pounding", "gap": "2 cm"}},
    }  # fmt: skip
    storey = pound.run(study, tmp_path / "r.h5", engine="serial").storey()
    far, near = (storey[storey["case"] == case] for case in ("far", "near"))
    buildings = [pound.building(name, **keys) for name, keys in study["buildings"].items()]
    motion = pound.motion("elcentro", duration=3.0, pga="0.5 g")
    scene = pound.scene(buildings, motion, link="pounding", gap="2 cm", analysis="inelastic")
    alone = np.concatenate([building.residual_drift for building in pound.solve(scene).buildings])
    assert (near["V"].to_numpy() == far["V"].to_numpy()).all()
    np.testing.assert_allclose(near["residual_drift"], alone, rtol=1e-9)
    assert np.abs(near["residual_drift"].to_numpy() - far["residual_drift"].to_numpy()).max() > 1e-3


def test_a_building_that_falls_without_end() -> None:
    """Under its weight, with a collapse that is never looked for, it moves beyond what numbers hold; a link with a
    curved force falls with it. Fails if that is an error of the program."""
    storey = {"storeys": 1, "mass": 2e5, "stiffness": [2e7], "height": 3.0, "yield_shear": [3e5], "hardening": 0.02}
    storey |= {"p_delta": [6e6], "collapse": "never", "rayleigh": {"alpha": 0.0, "beta": 0.0}}
    case = {"link": "viscous", "gap": 9.0, "force_at_1_m_s": 1e4, "exponent": 0.5, "straight_below": 1e-3}
    start = [[0.0], [0.0]], [[2.0], [1.5]]
    run = solve(Scene((storey, storey), np.zeros(1501), 0.02, case, "inelastic", start=start))
    assert run.status == "done"
    assert "no residual drift: the free vibration after the motion could not be solved" in run.flags


@pytest.mark.parametrize("damping", [0.05, 0.005])
@pytest.mark.parametrize("law", ["peak-oriented", "imk", "pinching", "bouc-wen"])
def test_a_neighbour_that_is_never_touched_moves_no_drift_at_rest(law: str, damping: float) -> None:
    """The same building beside three others, which come to rest sooner or later, 2 m away. Fails if its drifts at rest
    hang on when the other is at rest, by more than the error tells."""
    first = house(0.5, 2, 0.15, **LAWS[law] | {"damping": damping})
    others = house(0.9, 3, 0.12, damping=0.05), house(1.7, 3, 0.05, damping=0.05), house(0.3, 1, 0.3, damping=0.05)
    found, errors = [], []
    for other in others:
        keys = {"analysis": "inelastic", "more": {"impact": IMPACT}}
        scene = Scene((first, other), shake(5.0, 3.0, seed=3), 0.02, {"link": "pounding", "gap": 2.0}, **keys)
        run = solve_whole(scene)
        found.append(run.buildings[0].residual_drift / run.buildings[0].drift)
        errors.append(run.rest_error)
    spread = float(np.ptp(found, axis=0).max())
    assert 0.0 < max(errors) <= 1e-6
    assert spread <= 2.0 * max(errors)


def test_the_error_covers_drifts_that_have_not_settled() -> None:
    """A Bouc-Wen storey that is hardly damped, after its motion and after 100 s more, at an accuracy that its drift at
    rest does not reach. Fails if the estimates pass over what both have not waited for."""
    tower = house(0.5, 2, 0.15, storey_law="bouc-wen", damping=0.005)
    scene = Scene((tower,), shake(5.0, 3.0, seed=3), 0.02, analysis="inelastic")
    first, second = (solve(each, 1e-9, estimate=True) for each in (scene, replace(scene, tail=100.0)))
    change = np.abs((first.residual_drift - second.residual_drift) / first.drift).max()
    assert 1e-8 < change <= first.error + second.error
    for run in (first, second):
        assert any("less accurate than asked" in flag for flag in run.flags)
