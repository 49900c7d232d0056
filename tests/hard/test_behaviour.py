"""What single hard scenes must show beyond being finite, closed and accurate."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml

from pounding_cli.errors import InputError
from pounding_cli.solve import solve
from pounding_cli.study import expand, load_study

from .catalogue import SCENES
from .fuzz import FOUND
from .make_motions import FOLDER, MOTIONS, text_of
from .test_catalogue import distance, peaks
from .verdict import closes_to, scenes_of


def written(tmp_path: Path, name: str, **changes) -> Path:
    """A copy of a catalogued study with top-level keys replaced (None: left out)."""
    study = yaml.safe_load((SCENES / f"{name}.yaml").read_text(encoding="utf-8")) | changes
    for record in study["records"]["use"]:
        record["file"] = str((SCENES / record["file"]).resolve())
    path = tmp_path / f"{name}.yaml"
    path.write_text(yaml.safe_dump({k: v for k, v in study.items() if v is not None}, sort_keys=False))
    return path


@pytest.mark.parametrize("name", MOTIONS)
def test_motions_are_as_made(name):
    """Fails if a motion file was changed by hand."""
    assert (FOLDER / f"{name}.txt").read_text(encoding="utf-8") == text_of(name)


@pytest.mark.parametrize("case", ["touching", "cut"])
def test_leaning_without_chatter(case):
    """Under a push that stays the floors lean for seconds. Fails if a resting contact opens and closes for ever."""
    for where, scene, accuracy in scenes_of(SCENES / "leaning.yaml"):
        if where.startswith(f"{case}, e"):
            links = solve(scene, accuracy).links
            assert links.contact_time.min() > 0.9 * scene.motion.duration
            assert links.impacts.max() <= 2


@pytest.mark.parametrize("accuracy", [1e-3, 1e-6, 1e-9, 1e-12])
def test_rest_without_strength(accuracy):
    """Fails if a storey at rest turns round for ever, or is asked no more and so carried along a line it has left."""
    for where, scene, _ in scenes_of(FOUND / "without-strength.yaml"):
        found = solve(scene, accuracy, bounds=(1000, 1000))
        assert found.status == "done", where
        assert abs(found.energy["residual"]) <= closes_to(accuracy), where


def test_nothing_is_lost_at_restitution_one():
    """e = 1 and no damping. Fails if a link, a dashpot or the ledger takes anything."""
    for where, scene, accuracy in scenes_of(SCENES / "restitution-one.yaml"):
        energy = solve(scene, accuracy).energy
        for sink in ("links", "damping", "hysteresis"):
            assert abs(energy[sink]) <= 1e-10 * energy["input"], (where, sink)


def test_events_at_one_instant():
    """Two equal pairs stay equal to the last digits. Fails if one of two events at the same time is lost or late."""
    for where, scene, accuracy in scenes_of(SCENES / "simultaneous.yaml"):
        if not scene.links:
            continue
        response = solve(scene, accuracy)
        for i in (0, 1):
            for name in ("shear", "drift", "acceleration"):
                one, twin = (getattr(response.buildings[i + j], name) for j in (0, 2))
                assert one == pytest.approx(twin, rel=1e-9), (where, name)
        half = len(scene.links) // 2
        assert response.links.impacts[:half].tolist() == response.links.impacts[half:].tolist(), where


@pytest.mark.parametrize("beyond", [0.0, 1e-15, 1e-12, -1e-12, -1e-9])
def test_contact_exactly_at_grazing(tmp_path, beyond):
    """A gap equal to the largest closing, and a hair to either side: a graze moves no peak.

    Fails if a contact of no depth gives a blow, or none of depth 1e-9 of the gap is found.
    """
    apart = written(tmp_path, "one-storey", cases={"apart": {"link": "pounding", "gap": 1.0}}, analyses=["elastic"])
    (_, scene, _), *_ = scenes_of(apart)
    alone = solve(scene, 1e-13)
    reach = float(alone.links.max_closing[0])
    close = written(
        tmp_path, "one-storey", cases={"graze": {"link": "pounding", "gap": reach * (1 + beyond)}}, analyses=["elastic"]
    )
    (_, scene, accuracy), *_ = scenes_of(close)
    graze = solve(scene, 1e-13)
    assert graze.status == "done"
    assert graze.links.impacts[0] <= 1
    if beyond == -1e-9:
        assert graze.links.impacts[0] == 1
    assert distance(graze, alone) <= accuracy
    assert abs(graze.energy["residual"]) <= 1e-8


def test_rigid_springs_come_to_a_fixed_base(tmp_path):
    """Springs 1e9 times the storeys' move peaks by less than 1e-6. Fails if stiff foundations lose digits."""
    scenes = [scene for _, scene, _ in scenes_of(SCENES / "foundation-springs.yaml") if scene.links]
    stiffest = max(scenes, key=lambda s: s.buildings[0].foundation.sway_stiffness if s.buildings[0].foundation else 0.0)
    study = yaml.safe_load((SCENES / "foundation-springs.yaml").read_text(encoding="utf-8"))
    study["buildings"]["stiff"]["foundation"] = "fixed"
    fixed = written(tmp_path, "foundation-springs", buildings=study["buildings"], sweep=None)
    (_, scene, _), *_ = scenes_of(fixed)
    assert scene.analysis == stiffest.analysis == "elastic"
    assert peaks(solve(stiffest, all_effects=True)) == pytest.approx(peaks(solve(scene)), rel=1e-6)


def test_out_of_reach_is_a_named_outcome(tmp_path):
    """Springs 1e7 times the storeys' over a millionth of a floor: told so at the bound asked for.

    Fails if such a scene hangs, or shows the numbers of an unfinished run.
    """
    foundation = {"mass": 0.2, "sway_stiffness": 2e15, "inertia": 2.0, "rocking_stiffness": 1e17}
    stiff = {"storeys": 2, "stiffness": [2e8, 1.5e8], "foundation": foundation}
    path = written(tmp_path, "foundation-tiny", buildings={"stiff": stiff, "soft": {"like": "stiff", "period": 0.6}})
    for where, scene, accuracy in scenes_of(path):
        response = solve(scene, accuracy, bounds=(2000, 2000))
        assert response.status == "step bound reached", where
        assert "stiff" in response.advice, where
        assert np.isnan(peaks(response)).all(), where


def test_zero_record_is_refused_with_its_reason(tmp_path):
    """Fails if a motion of zeros is taken as if it were one."""
    path = written(tmp_path, "one-storey", records={"use": [{"file": str(FOLDER / "zero.txt")}], "duration": "whole"})
    with pytest.raises(InputError) as refused:
        load_study(path)
    assert any("every sample is zero" in problem.message and problem.hint for problem in refused.value.problems)


def test_ratio_to_nothing_is_refused(tmp_path):
    """The still beginning of a record: V0 = 0. Fails if the ratio is NaN without a word."""
    from pounding_cli.api import open_results, run

    records = {"use": [{"file": "../motions/spikes.txt"}], "duration": 0.05}
    path = written(tmp_path, "one-storey", records=records)
    assert expand(load_study(path)).motions[0].pga == 0
    run(path, tmp_path / "zero.h5")
    results = open_results(tmp_path / "zero.h5")
    assert (results.storey()["V0"] == 0).all()
    assert results.scene()["flags"].str.contains("V0 = 0: ratio refused").all()
    assert np.isfinite(results.scene()["energy_residual"]).all()


def test_a_base_with_next_to_no_inertia_ends_with_a_named_outcome(tmp_path):
    """Its dashpots turn it within 1e-19 s, so that powers of that overflow. Fails if a series that overflows is taken
    for one that has converged."""
    path = tmp_path / "base.yaml"
    path.write_text(
        f"""
        records: {{use: [{{file: '{(FOLDER / "shake.txt").resolve()}'}}]}}
        buildings:
          a: {{storeys: 2, mass: 200 t, period: 1 s, foundation: {{inertia: 1e-12 kg m2, rocking_stiffness: 3e10 N m}}}}
          b: {{storeys: 1, mass: 200 t, period: 0.6 s}}
        group: [a, b]
        cases: {{touching: {{link: pounding, gap: 0}}}}
        accuracy: 1e-12
        """
    )
    outcomes = set()
    for _, scene, accuracy in scenes_of(path):
        found = solve(scene, accuracy, "taylor", bounds=(2_000, 2_000))
        outcomes.add(found.status)
        assert found.status == "done" or found.advice
    assert "step bound reached" in outcomes
    assert "not finite" not in outcomes
