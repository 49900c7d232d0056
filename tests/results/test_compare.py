"""`pound compare`: every difference of two files is found, told with its direction and place, and nothing else is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

import pounding_cli
from pounding_cli.cli.main import cli
from pounding_cli.cli.results import _iter_changes
from pounding_cli.results.arrays import ResultArrays
from pounding_cli.results.compare import compare
from pounding_cli.results.results import ResultTables

STUDY = """\
title: Small
records: {use: [elcentro, taft], duration: 3 s}
buildings:
  stiff: {storeys: 3, period: 0.3 s, mass: 200 t}
  soft: {like: stiff, storeys: 2, period: 0.5 s}
group: [stiff, soft]
cases: {gap: {link: pounding, gap: 5 mm}, touching: {link: pounding, gap: 0 cm}}
sweep:
  - {impact.restitution: [0.4, 0.4, 0.6], impact.stiffness: [1 MN/mm, 2 MN/mm, 2 MN/mm]}
accuracy: 1e-6
"""


@pytest.fixture(scope="module")
def results(tmp_path_factory) -> ResultTables:
    path = tmp_path_factory.mktemp("compare") / "study.yaml"
    path.write_text(STUDY)
    return pounding_cli.run(path, path.with_suffix(".h5"), engine="serial")


@pytest.fixture(scope="module")
def change(results) -> Callable[..., ResultTables]:
    """`change(name, place, value)`: the results with another value at a place of a variable, or a factor on it."""

    def make(name: str, place: tuple, value: object = None, factor: float = 1.0) -> ResultTables:
        array = results.arrays[name]
        values = array.values.copy()
        if value is not None and values.dtype.kind == "i" and value != value:
            values = values.astype(float)
        values[place] = values[place] * factor if value is None else value
        data = {**results.arrays.data, name: replace(array, data=values)}
        return ResultTables(results.path, ResultArrays(data, results.arrays.coordinates, results.arrays.attrs))

    return make


PLACE = (1, 1, 0, 1, 0, 2)
"""Second point, touching, elastic, taft, stiff, storey or floor 3."""
IN_WORDS = "impact.restitution = 0.4, impact.stiffness = 2000000000.0, touching, elastic, taft"


def test_a_file_agrees_with_itself(results):
    found = compare(results, results)
    assert found.has_same_numbers
    assert found.is_same
    assert found.compared > 3 * 2 * 2 * 2 * 5 * 6
    assert (found.removed, found.added, found.outcomes, found.keys, found.software) == ([], [], [], [], [])


@pytest.mark.parametrize("name", ["V", "V0", "mu", "residual_drift", "acceleration", "peak_force", "impacts"])
def test_a_value_that_only_one_file_has_is_a_change(results, change, name):
    """NaN against a number, in either file. Fails if such values are left out, as a comparison with NaN is false."""
    place = PLACE if name not in ("peak_force", "impacts") else (*PLACE[:4], 0)
    lost = change(name, place, np.nan)
    for first, second in ((results, lost), (lost, results)):
        found = compare(first, second)
        assert not found.has_same_numbers
        (row,) = found.changes.to_dict("records")
        assert row["column"] == name
        assert row["place"].startswith(IN_WORDS)
        assert row["difference"] == np.inf
        assert np.isnan(row["before"]) == (first is lost)
        assert np.isnan(row["after"]) == (second is lost)
        assert found.compared == compare(results, results).compared
    for first, second, side in ((results, lost, "first"), (lost, results, "second")):
        found = compare(first, second)
        table, place = found.changes[["table", "place"]].iloc[0]
        told = list(_iter_changes(found, everything=False))
        assert told[-1] == f"  {table} {name}: 1 only in the {side} file: {place}"
        listed = list(_iter_changes(found, everything=True))
        assert listed[-1] == f"  {table} {name}: 1 only in the {side} file:\n    {place}"
    both = compare(lost, lost)
    assert both.has_same_numbers
    assert both.compared == compare(results, results).compared - 1


def test_a_change_is_told_with_its_place_and_direction(results, change):
    """Fails if before and after are exchanged, or it is told of another row, building, storey or unit."""
    other = change("V", PLACE, factor=1.5)
    shear = float(results.arrays["V"].values[PLACE])
    (row,) = compare(results, other).changes.to_dict("records")
    assert (row["table"], row["column"]) == ("storey", "V")
    assert row["place"] == f"{IN_WORDS}, stiff, storey 3"
    assert (row["before"], row["after"]) == pytest.approx((shear, 1.5 * shear))
    assert row["difference"] == pytest.approx(1 / 3)
    lines = list(_iter_changes(compare(results, other), everything=False))
    assert lines[-2:] == [
        "  storey V: 1 differs, most:",
        f"    {row['place']}: {shear / 1e3:.6g} kN -> {1.5 * shear / 1e3:.6g} kN, by 3.3e-01; "
        f"carried {row['carried']:.1e}",
    ]
    assert any(line.startswith("Numbers: 1 of ") and " differs beyond" in line for line in lines)


@pytest.mark.parametrize(
    ("name", "scale", "of"),
    [
        ("V", "V", lambda estimate, accuracy: 2 * estimate),
        ("V0", "V0", lambda estimate, accuracy: 2 * max(estimate, accuracy)),
        ("residual_drift", "drift", lambda estimate, accuracy: 2 * max(estimate, accuracy)),
        ("acceleration", "acceleration", lambda estimate, accuracy: 2 * max(estimate, accuracy)),
    ],
)
def test_a_number_changes_beyond_the_errors_of_both_files(results, change, name, scale, of):
    """Just below the limit it does not. Fails if one of the errors is left out, or another scale is taken."""
    row = PLACE[:4]
    limit = of(results.arrays["error_estimate"].values[row], 1e-6)
    value = float(results.arrays[name].values[PLACE])
    size = abs(value) if name == scale else float(np.nanmax(np.abs(results.arrays[scale].values[row])))
    if name == "acceleration":
        size = float(np.nanmax(np.abs(results.arrays[scale].values[row])))
    for share, is_change in ((0.8, False), (1.3, True)):
        assert compare(results, change(name, PLACE, value + share * limit * size)).has_same_numbers != is_change


def test_counts_are_compared_exactly(results, change):
    place = (*PLACE[:4], 0)
    found = compare(results, change("impacts", place, results.arrays["impacts"].values[place] + 1))
    assert found.changes["column"].tolist() == ["impacts"]
    assert found.changes["place"].tolist() == [f"{IN_WORDS}, {results.names('link')[0]}"]


def test_rows_and_outcomes_are_told_by_what_happened(results, change):
    """Fails if removed and added rows, or statuses before and after, are exchanged."""
    fewer = change("status", PLACE[:4], "")
    assert (compare(results, fewer).removed, compare(results, fewer).added) == ([IN_WORDS], [])
    assert (compare(fewer, results).removed, compare(fewer, results).added) == ([], [IN_WORDS])
    failed = change("status", PLACE[:4], "unstable step")
    assert compare(results, failed).outcomes == [(IN_WORDS, "done", "unstable step")]
    assert compare(failed, results).outcomes == [(IN_WORDS, "unstable step", "done")]
    lines = list(_iter_changes(compare(results, fewer), everything=False))
    assert "Rows: 1 removed, 0 added, 0 with another outcome." in lines
    assert f"  - {IN_WORDS}" in lines


def test_files_without_a_common_row_are_compared(results, change):
    none = change("status", ..., "")
    found = compare(results, none)
    assert (len(found.removed), found.added, found.compared, len(found.changes)) == (24, [], 0, 0)
    assert compare(none, none).has_same_numbers


def test_rows_without_an_estimate_are_counted(results, change):
    missing = change("error_estimate", PLACE[:4], np.nan)
    assert compare(results, missing).unestimated == 1
    assert "  1 row carries no error estimate: the accuracy asked or rounding is used instead." in list(
        _iter_changes(compare(missing, results), everything=False)
    )


def test_buildings_are_compared_by_name(results, tmp_path):
    """The same buildings in another order. Fails if they are compared by their place in the arrays."""
    study = STUDY.replace("group: [stiff, soft]", "group: [soft, stiff]")
    (tmp_path / "other.yaml").write_text(study)
    pounding_cli.run(tmp_path / "other.yaml", tmp_path / "other.h5", engine="serial")
    found = compare(results, pounding_cli.open_results(tmp_path / "other.h5"))
    alone = found.changes[found.changes["column"].isin(["V0", "mu0", "drift0", "acceleration0"])]
    assert alone.empty
    assert [key for key, *_ in found.keys] == ["group"]


def test_it_is_told_on_the_screen_with_its_exit_code(results):
    done = CliRunner().invoke(cli, ["compare", str(results.path), str(results.path)])
    assert done.exit_code == 0
    assert done.output.splitlines()[:3] == [
        "Study: the same.", "Versions: the same.", "Rows: 0 removed, 0 added, 0 with another outcome.",
    ]  # fmt: skip
    assert " differ beyond the errors of both files." in done.output
