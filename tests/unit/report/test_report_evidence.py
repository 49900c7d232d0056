"""The evidence a report rests on: means, roles of the cases, points of the sweep, labels of the motions."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from pounding_cli.report.evidence import motion_label, motion_sentence, points, split
from tests.helpers.report_tables import CASES, RECORDS, make


def test_mean_over_motions_is_the_mean_of_the_ratios():
    evidence = points(make())[0]
    means = evidence.means("touching", "elastic", "stiff", "V_ratio")
    assert list(means.index) == [1, 2, 3, 4, 5]
    # Level 1.4 x (1 + 0.02 (s - 3)); the factors of the motions have the mean 1.
    np.testing.assert_allclose(means, 1.4 * (1 + 0.02 * (np.arange(1, 6) - 3)), rtol=1e-14)


def test_a_failed_run_is_left_out_of_the_mean():
    results = make()
    frame = results.storey()
    frame.loc[frame["record"] == "parkfield", "V_ratio"] = np.nan
    means = points(results)[0].means("touching", "elastic", "stiff", "V_ratio")
    # Without the last motion the factors are 0.92, 0.96, 0.98, 1.02: mean 0.97.
    assert means[3] == pytest.approx(1.4 * 0.97, rel=1e-14)


def test_accelerations_against_another_case_are_formed_motion_by_motion():
    results = make()
    frame = results.floor()
    first = (frame["record"] == RECORDS[0]) & (frame["case"] == "infill")
    frame.loc[first, "acceleration"] *= 4
    ratio = points(results)[0].against("infill", "touching", "elastic", "stiff")
    # 2/12 for every motion, four times that for one of five.
    np.testing.assert_allclose(ratio, 2 / 12 * (1 + 1 + 1 + 1 + 4) / 5, rtol=1e-14)


def test_stiffer_building_is_the_one_with_the_shortest_period():
    evidence = points(make(group=("soft-1", "stiff", "soft-2")))[0]
    assert evidence.stiffer == "stiff"
    assert evidence.others == ["soft-1", "soft-2"]


def test_roles_fall_back_on_the_links_where_cases_have_other_names():
    results = make(cases=("touching", "gap", "infill", "connected"))
    renamed = {"touching": "in contact", "gap": "five", "infill": "filled", "connected": "tied"}
    for frame in (results.storey(), results.floor(), results.link(), results.scene()):
        frame["case"] = frame["case"].map(renamed)
    evidence = points(results)[0]
    assert {role: evidence.case_of(role) for role in renamed} == renamed
    assert evidence.case_of("infill_1_10") is None


def test_every_point_of_a_sweep_has_its_own_evidence():
    results = make(axis=("impact.restitution", [0.4, 0.5, 0.65]))
    low, _, high = points(results)
    assert low.point == {"impact.restitution": 0.4}
    assert low.label == "impact.restitution = 0.4"
    assert "impact.restitution" not in low.storey
    assert len(low.storey) * 3 == len(results.storey())
    middle = [e.means("gap", "elastic", "stiff", "V_ratio")[3] for e in (low, high)]
    np.testing.assert_allclose(middle, [1.2, 1.2 * 1.2], rtol=1e-14)


def test_a_table_without_the_swept_column_is_the_same_at_every_point():
    evidences = points(make(axis=("impact.restitution", [0.4, 0.5])))
    assert [len(e.records) for e in evidences] == [5, 5]


def test_a_table_with_the_swept_column_is_cut_to_the_point():
    results = make(axis=("records.scale", ["{arias: elcentro}", "table1"]))
    both = [results.records().assign(**{"records.scale": value}) for value in ("{arias: elcentro}", "table1")]
    both[1]["scale"] *= 2
    results.records = lambda: pd.concat(both)
    assert [evidence.records["scale"][1] for evidence in points(results)] == [1.75, 3.5]


@pytest.mark.parametrize(
    ("sources", "label", "sentence"),
    [
        ({}, "stand-in motions", "All are stand-in motions."),
        (
            {"taft": "real", "elcentro": "real"},
            "real: elcentro, taft; stand-in: eureka, olympia, parkfield",
            "Motions: real: elcentro, taft; stand-in: eureka, olympia, parkfield.",
        ),
        (
            dict.fromkeys(RECORDS, "user"),
            "user: " + ", ".join(RECORDS),
            "Motions: user: " + ", ".join(RECORDS) + ".",
        ),
    ],
)
def test_motions_are_labelled_by_where_they_come_from(sources, label, sentence):
    records = make(sources=sources).records()
    assert motion_label(records) == label
    assert motion_sentence(records) == sentence


def test_cases_keep_the_order_of_the_file():
    assert points(make(cases=tuple(CASES)))[0].cases == list(CASES)


def test_a_motion_of_an_unknown_kind_comes_last():
    """As another program, or someone who changes a file, may call it. Fails with a fault of the program."""
    records = pd.DataFrame({"record": ["a", "taft", "b"], "source": ["measured", "real", "user"]})
    assert motion_label(records) == "real: taft; user: b; measured: a"


def test_a_sentence_may_begin_like_a_list():
    assert split("[1\n second ") == ["[1", "second"]
