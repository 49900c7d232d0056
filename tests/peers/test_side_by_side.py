"""The table of docs/published.md of pairs by `pound` and by OpenSees: its shape, its numbers and how they differ."""

from __future__ import annotations

from functools import cache

import pytest

from tests.peers.side_by_side import BEGIN, END, HEAD, PAGE, PAIRS, STEPS, UNITS, list_rows, solve_pair

BY_BLOWS = "contact force", "rotation"
"""What short blows alone decide, which fixed steps find less well."""
BOUNDS = 4e-3, 4e-4
"""Largest differences allowed of these, and of all others: about twice what was measured [-]."""
STEP_ERROR = 4e-3
"""Most that the last halving of the step of OpenSees may change [-]."""


@cache
def read_page() -> dict[str, list[list[str]]]:
    """Return the cells of the rows of every pair on the page."""
    block = PAGE.read_text(encoding="utf-8").partition(BEGIN)[2].partition(END)[0]
    found: dict[str, list[list[str]]] = {}
    for line in block.splitlines():
        if line.startswith("**"):
            found[line.split("**")[1].lower()] = rows = []
        elif line.startswith("|") and not line.startswith("|---"):
            rows.append([cell.strip() for cell in line.strip("|").split("|")])
    return found


def peak_rows(name: str) -> list[list[str]]:
    """Return the rows of peaks of a pair on the page, without the heading, times and steps."""
    return read_page()[name][1:-2]


@pytest.fixture(scope="module", params=PAIRS)
def pair(request) -> tuple[str, dict[str, float]]:
    """A pair by its name, and its peaks by `pound`."""
    return request.param, solve_pair(request.param)


def test_the_page_has_what_the_script_writes(pair):
    """Without OpenSees. Fails if a peak is added or renamed, or the program's numbers change, and the page does not."""
    name, peaks = pair
    head, *_, time, halved = read_page()[name]
    assert head == [cell.strip() for cell in HEAD.split("|")]
    assert [time[0], halved[0]] == ["time", "steps without a root, halved"]
    expected = list_rows(peaks, [peaks] * len(STEPS))
    found = peak_rows(name)
    assert [row[:2] for row in found] == [row[:2] for row in expected]
    assert {len(row) for row in found} == {len(head)}


@pytest.mark.parametrize("name", PAIRS)
def test_both_programs_agree(name):
    """Every peak of the page within its bound, and as many contacts. Fails if either has another dashpot or law."""
    for label, *cells in peak_rows(name):
        if label == "contacts":
            assert float(cells[0]) > 9
            assert set(cells[:-2]) == {cells[0]}
            continue
        ours, *_, theirs = map(float, cells[: 1 + len(STEPS)])
        bound = BOUNDS[0] if any(word in label for word in BY_BLOWS) else BOUNDS[1]
        assert float(cells[-2]) < bound, label
        assert float(cells[-2]) == pytest.approx(abs(theirs / ours - 1), abs=2e-4), label  # five digits are shown
        assert float(cells[-1]) < STEP_ERROR, label


def test_differences_of_a_row():
    """By hand. Fails if the difference is not that of the shortest step, or the step error that of the last halving."""
    rows = list_rows({"a, drift of storey 1": 0.02, "contacts": 3}, [
        {"a, drift of storey 1": 0.021, "contacts": 5}, {"a, drift of storey 1": 0.0198, "contacts": 4},
        {"a, drift of storey 1": 0.022, "contacts": 4},
    ])  # fmt: skip
    assert rows == [
        ["a, drift of storey 1 [mm]", "20", "21", "19.8", "22", "1.0e-1", "1.0e-1"],
        ["contacts", "3", "5", "4", "4", "1", ""],
    ]
    assert UNITS["drift"] == ("mm", 1e3)


def test_programs_with_other_peaks_are_refused():
    with pytest.raises(ValueError, match="not the same"):
        list_rows({"contacts": 1.0}, [{"closings": 1.0}])


@pytest.mark.parametrize("name", PAIRS)
def test_opensees_finds_the_numbers_of_the_page(name):
    """At its longest step. Fails if the script's dashpot lacks its 2."""
    pairs = pytest.importorskip("opensees_pairs", reason="openseespy is not installed (pip install -e .[peers])")
    found = pairs.march(name, STEPS[0])
    shown = list_rows(found.peaks, [found.peaks])
    by_label = {row[0]: row[2] for row in peak_rows(name)}
    assert {row[0]: row[1] for row in shown} == by_label
    assert found.halved == int(read_page()[name][-1][2])


def test_a_step_without_a_root_is_halved():
    """Of the elastic pair at 5 ms. Fails if time is lost or gained where a step is halved: peaks would be others."""
    pairs = pytest.importorskip("opensees_pairs", reason="openseespy is not installed (pip install -e .[peers])")
    found = pairs.march("elastic", 5e-3)
    assert found.halved > 0
    assert found.peaks["left, base shear"] == pytest.approx(solve_pair("elastic")["left, base shear"], rel=0.05)
