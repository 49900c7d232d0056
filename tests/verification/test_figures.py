"""Figs 6 and 7 themselves: the accuracy asked is kept, and central difference, which shares no code, gives the same."""

from __future__ import annotations

import os

import numpy as np
import pytest

from pounding_cli.solve import assess, solve
from pounding_cli.solve.assess import change
from pounding_cli.solve.tangent import ILL_CONDITIONED
from pounding_cli.study import expand, load_study

STUDIES = ("configs/fig6.yaml", "configs/fig7.yaml")
ALL = os.environ.get("ALL_SCENES") == "1"


@pytest.fixture(autouse=True)
def _stand_ins(monkeypatch, tmp_path):
    monkeypatch.delenv("POUND_RECORDS", raising=False)
    monkeypatch.setenv("POUND_HOME", str(tmp_path))


@pytest.mark.parametrize("study", STUDIES)
def test_accuracy_keeps_its_word(study):
    """Every scene at 1e-6 against 1e-12: peak V, drift (so mu) and floor acceleration; the energy closes.

    Fails if the local tolerance is a thousand times looser, or peaks are taken at the ends of steps only.
    """
    plan = expand(load_study(study))
    assert len(plan.rows) == 60
    for scene in plan.scenes.values():
        rough, fine = solve(scene, 1e-6), solve(scene, 1e-12)
        assert abs(rough.energy["residual"]) < 1e-8
        if assess(scene, rough, 1e-6).sensitivity > ILL_CONDITIONED:
            continue
        assert change(rough, fine) < 1e-6
        for a, b in zip(rough.buildings, fine.buildings, strict=True):
            assert np.max(np.abs(a.acceleration / b.acceleration - 1)) < 1e-6


@pytest.mark.parametrize("study", STUDIES)
def test_central_difference_converges_to_the_same(study):
    """At steps of 1e-4 and 1e-5 s; the motion of El Centro unless ALL_SCENES=1 asks for all five (some minutes).

    Fails if Taylor misses a contact or unloads with the wrong stiffness.
    """
    plan = expand(load_study(study))
    rows = [row for row in plan.rows if ALL or row.record == "elcentro"]
    assert len(rows) == (60 if ALL else 12)
    for row in rows:
        scene = plan.scenes[row.scene]
        taylor = solve(scene, 1e-9)
        coarse, fine = (
            change(solve(scene, method="central-difference", time_step=step), taylor) for step in (1e-4, 1e-5)
        )
        if assess(scene, taylor, 1e-9).sensitivity <= ILL_CONDITIONED:
            assert fine < coarse, row
            assert fine < 1e-3, row
