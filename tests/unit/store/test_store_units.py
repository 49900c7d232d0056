"""Swept values are stored in SI and shown in the unit the study wrote; buildings say their V/W."""

from __future__ import annotations

import dataclasses

import h5py
import numpy as np
import pytest

from pounding_cli.numbers import Unit
from pounding_cli.store import open_results, overview
from pounding_cli.store.write import write_results
from pounding_cli.study import Axis
from tests.helpers.plans import building, known, small_plan

GRAVITY = 9.80665
AXES = (
    Axis(("records.scale.pga",), ((0.07 * GRAVITY,), (0.09 * GRAVITY,)), (Unit("g", GRAVITY, "m/s2"),)),
    Axis(("cases.gap.gap", "impact.label"), ((0.05, "low"), (0.075, "high")), (Unit("cm", 0.01, "m"), Unit())),
)


def written(plan, path):
    write_results(path, plan, {digest: known(scene) for digest, scene in plan.scenes.items()})
    return path


def test_swept_values_are_si_in_tables_and_as_written_for_people(tmp_path):
    path = written(small_plan(axes=AXES), tmp_path / "swept.h5")
    results = open_results(path)
    assert results.axes["records.scale.pga"] == [0.07 * GRAVITY, 0.09 * GRAVITY]
    assert results.axis_label("records.scale.pga") == "records.scale.pga [g]"
    assert results.axis_label("impact.label") == "impact.label"
    assert [results.value_label("records.scale.pga", value) for value in results.axes["records.scale.pga"]] == [
        "0.07 g",
        "0.09 g",
    ]
    assert results.value_label("cases.gap.gap", results.axes["cases.gap.gap"][1]) == "7.5 cm"
    assert results.value_label("impact.label", "low") == "low"
    assert overview(path).points[1] == "records.scale.pga = 0.07 g, cases.gap.gap = 7.5 cm, impact.label = high"
    with h5py.File(path) as file:
        assert file["records.scale.pga"].attrs["units"] == "m/s2"
        assert "units" not in file["impact.label"].attrs


def test_base_shear_ratio_is_the_lowest_yield_shear_over_the_weight(tmp_path):
    plan = small_plan()
    strong = dataclasses.replace(building("soft", 2), yield_shear=np.array([np.inf, 1e6]))
    group = (plan.study.group[0], strong)
    plan = dataclasses.replace(plan, study=dataclasses.replace(plan.study, group=group))
    table = open_results(written(plan, tmp_path / "plain.h5")).buildings
    stiff = table[table.building == "stiff"]
    assert stiff.base_shear_ratio.to_numpy() == pytest.approx(1e6 / (3 * 2e5 * GRAVITY), rel=1e-15)
    assert np.isinf(table[table.building == "soft"].base_shear_ratio).all()
