"""Every hard scene: finite, energy closed, as accurate as asked, at bounded cost; and what single ones must show."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import yaml

import pounding_cli as pound
from tests.adapter import difference, refused, scenes, solve
from tests.physics.references import read

from .catalogue import SCENES, HardStudy, studies
from .fuzz import FOUND
from .make_motions import FOLDER, MOTIONS, text_of
from .verdict import closes_to, fault_of

STUDIES = studies()
ALL = pytest.mark.parametrize("study", STUDIES, ids=lambda study: study.name)
PEAKS = "shear", "drift", "acceleration"
TIGHTER = 1e-5
"""The finer run's accuracy over the one asked, not below 1e-13."""

STOPS = 200


def linked(study: HardStudy) -> list[tuple[str, pound.Scene, float]]:
    return [each for each in scenes(study.path) if each[1].links]


@ALL
def test_scene(study: HardStudy) -> None:
    """Fails if a peak is off by more than asked, energy leaks, the steps multiply, or the blow never comes."""
    expect = study.expect
    for where, scene, accuracy in scenes(study.path):
        run = solve(scene, accuracy, bounds=(expect.steps, expect.steps))
        assert run.status == "done", where
        assert fault_of(run, accuracy) == "", where
        assert abs(run.energy["residual"]) <= expect.residual, where
        finer = solve(scene, max(accuracy * TIGHTER, 1e-13))
        assert difference(run, finer, PEAKS) <= max(accuracy, expect.sensitive), where
        assert run.impacts.sum() >= expect.impacts or not scene.links, where


@pytest.mark.parametrize("study", [s for s in STUDIES if s.expect.independent], ids=lambda s: s.name)
def test_independent_integrator(study: HardStudy) -> None:
    """Dormand-Prince 8 from event to event agrees. Fails if both accuracies of the solver share a wrong law."""
    for where, scene, accuracy in linked(study):
        expected, run = SimpleNamespace(**read(f"{study.name}; {where}")), solve(scene, accuracy)
        assert difference(run, expected, PEAKS) <= max(accuracy, study.expect.sensitive), where
        assert study.expect.sensitive or run.impacts.tolist() == expected.impacts.tolist(), where


@pytest.mark.parametrize("study", [s for s in STUDIES if s.expect.sensitive], ids=lambda s: s.name)
def test_what_is_called_sensitive_is(study: HardStudy) -> None:
    """A motion that grows by 1e-6 moves a peak by a tenth of the figure or more, and the run says that it is
    ill-conditioned. Fails if the figure is an excuse, or the flag is missing."""
    moved, flags = 0.0, ""
    for _, scene, accuracy in linked(study):
        samples = scene.motion.acceleration
        growing = pound.motion(samples * (1.0 + 1e-6 * np.linspace(0.0, 1.0, samples.size)), dt=scene.motion.dt)
        nudged = replace(scene, motion=growing)
        moved = max(moved, difference(solve(nudged, 1e-12), solve(scene, 1e-12), PEAKS))
        flags += "; ".join(solve(scene, accuracy, estimate=True).flags)
    assert moved >= 0.1 * study.expect.sensitive
    assert "ill-conditioned" in flags


@ALL
def test_history(study: HardStudy) -> None:
    """The first linked scene, its history stopped two hundred times: the same peaks and the same end. Fails if a
    stopped run forgets a branch, or an event met at the stop."""
    scene = linked(study)[0][1]
    run, kept = solve(scene, 1e-9), pound.history(scene, every=scene.motion.duration / STOPS, accuracy=1e-9)
    allowed = max(1e-7, study.expect.sensitive)
    exists = ~np.isnan(kept.shear[0])
    for over_time, peaks in ((kept.shear, run.shear), (kept.total_acceleration, run.acceleration)):
        assert (np.abs(over_time[:, exists]).max(axis=0) <= peaks * (1 + allowed)).all()
    size = np.maximum(run.displacement_max, -run.displacement_min).max()
    np.testing.assert_allclose(kept.displacement[-1, exists], run.end, rtol=0, atol=max(allowed, 1e-6) * size)
    off = 2 * kept.energy["input"] - sum(kept.energy.values())
    assert np.abs(off).max() <= study.expect.residual * max(np.abs(each).max() for each in kept.energy.values())


@pytest.mark.parametrize("name", MOTIONS)
def test_motions_are_as_made(name: str) -> None:
    """Fails if a motion file was changed by hand."""
    assert (FOLDER / f"{name}.txt").read_text(encoding="utf-8") == text_of(name)


@pytest.mark.parametrize("case", ["touching", "cut"])
def test_leaning_without_chatter(case: str) -> None:
    """Under a push that stays the floors lean for seconds. Fails if a resting contact opens and closes for ever."""
    for where, scene, accuracy in scenes(SCENES / "leaning.yaml"):
        if where.startswith(f"{case}, e"):
            run = solve(scene, accuracy)
            assert run.contact_time.min() > 0.9 * scene.motion.duration
            assert run.impacts.max() <= 2


@pytest.mark.parametrize("accuracy", [1e-3, 1e-6, 1e-9, 1e-12])
def test_rest_without_strength(accuracy: float) -> None:
    """Fails if a storey at rest turns round for ever, or is carried along a line it has left."""
    for where, scene, _ in scenes(FOUND / "without-strength.yaml"):
        run = solve(scene, accuracy, bounds=(1000, 1000))
        assert run.status == "done", where
        assert abs(run.energy["residual"]) <= closes_to(accuracy), where


def test_nothing_is_lost_at_restitution_one() -> None:
    """e = 1 and no damping. Fails if a link, a dashpot or the balance takes anything."""
    for where, scene, accuracy in scenes(SCENES / "restitution-one.yaml"):
        energy = solve(scene, accuracy).energy
        for sink in ("links", "damping", "hysteresis"):
            assert abs(energy[sink]) <= 1e-10 * energy["input"], (where, sink)


def test_events_at_one_instant() -> None:
    """Two equal pairs stay equal to the last digits. Fails if one of two events at the same time is lost or late."""
    for where, scene, accuracy in scenes(SCENES / "simultaneous.yaml"):
        if scene.links:
            run = solve(scene, accuracy)
            for name in PEAKS:
                halves = np.split(getattr(run, name), 2)
                assert halves[0] == pytest.approx(halves[1], rel=1e-9), (where, name)


def written(folder: Path, name: str, **changes) -> Path:
    """A copy of a catalogued study with top-level keys replaced."""
    study = yaml.safe_load((SCENES / f"{name}.yaml").read_text(encoding="utf-8")) | changes
    for record in study["records"]["use"]:
        record["file"] = str((SCENES / record["file"]).resolve())
    path = folder / f"{name}.yaml"
    path.write_text(yaml.safe_dump(study, sort_keys=False))
    return path


def test_out_of_reach_is_a_named_outcome(tmp_path: Path) -> None:
    """Springs 1e7 times the storeys' over a millionth of a floor: told so at the bound asked for. Fails if such a scene
    hangs, or shows the numbers of an unfinished run."""
    foundation = {"mass": 0.2, "sway_stiffness": 2e15, "inertia": 2.0, "rocking_stiffness": 1e17}
    stiff = {"storeys": 2, "stiffness": [2e8, 1.5e8], "foundation": foundation}
    path = written(tmp_path, "foundation-tiny", buildings={"stiff": stiff, "soft": {"like": "stiff", "period": 0.6}})
    for where, scene, accuracy in scenes(path):
        run = solve(scene, accuracy, bounds=(2000, 2000))
        assert run.status == "step bound reached", where
        assert "stiff" in run.advice, where
        assert np.isnan(run.shear).all(), where


def test_a_motion_of_zeros_is_refused() -> None:
    """Fails if it is taken as if it were one."""
    text = (SCENES / "one-storey.yaml").read_text(encoding="utf-8")
    study = yaml.safe_load(text)
    study["records"] = {"use": [{"file": str(FOLDER / "zero.txt")}], "duration": "whole"}
    (problem,) = refused(yaml.safe_dump(study, sort_keys=False))
    assert "every sample is zero" in problem[2]


def test_a_ratio_to_nothing_is_refused(tmp_path: Path) -> None:
    """The still beginning of a motion: V0 = 0. Fails if the ratio is a number, or missing without a word."""
    records = {"use": [{"file": "../motions/spikes.txt"}], "duration": 0.05}
    results = pound.run(written(tmp_path, "one-storey", records=records), tmp_path / "zero.h5", engine="serial")
    assert (results.storey()["V0"] == 0).all()
    assert results.scene()["flags"].str.contains("zero-baseline").all()
    assert results.scene()["flag_details"].str.contains("V0 = 0").all()
    assert np.isfinite(results.scene()["energy_residual"]).all()
