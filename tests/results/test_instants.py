"""Numbers at an instant of histories that are worked by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pounding_cli.questions.instants import Instants, find_at_instant
from pounding_cli.results.arrays import Array, ResultArrays
from pounding_cli.study.expressions.comparison import parse_comparison
from pounding_cli.study.expressions.expression import Scope

SCOPE = Scope(("soft", "stiff"), ("near",), ("elastic",), ("taft",), ("pounding",))
TIMES = np.arange(7.0)
GAPS = np.array([2.0, 1.0, 1.0])
CLOSING = np.array([
    [0.0, 0.0, np.nan], [1.0, 0.5, np.nan], [1.0, 2.0, np.nan], [4.0, 0.0, np.nan],
    [0.0, 0.0, np.nan], [3.0, 0.0, np.nan], [0.0, 0.0, np.nan],
])  # fmt: skip
"""Of three links, the last of which the case does not have: the second one meets first, at 1 + 1/3 s; the first one
does so at 2 + 1/3 s, before the second one parts at 2.5 s, and parts at 3.5 s."""
DISPLACEMENT = np.stack([TIMES**2, np.where(TIMES == 4, -60.0, 3 * TIMES)], axis=1)[:, None, :] * [[1.0], [0.5]]
"""Of two buildings of two storeys: t², and 3 t but for -60 at 4 s; half of that in the second building."""
HISTORY = ResultArrays(
    {
        "closing": Array(("time", "link"), CLOSING, {}),
        "displacement": Array(("time", "building", "floor"), DISPLACEMENT, {}),
    },
    {"time": Array(("time",), TIMES, {})},
    {},
)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("time [contact 1]", 1 + 1 / 3),
        ("time [contact 2]", 4 + 2 / 3),
        ("time [release 1]", 3.5),
        ("time [release -1]", 5 + 1 / 3),
        ("time [0.5 s after release 1]", 4.0),
        ("time [largest closing]", 3.0),
        ("time [0.5 s before largest closing]", 2.5),
        ("closing [0.5 s after largest closing]", 2.0),
        ("time [largest closing after release 1]", 5.0),
        ("displacement in soft floor 1 [3 s]", 9.0),
        ("displacement in stiff floor 1 [3 s]", 4.5),
        ("displacement in soft floor 2 [3 s]", 9.0),
        ("displacement in soft [4 s]", -60.0),  # of the floors that are not told apart the one that moves most
        ("displacement in soft [2 s]", 6.0),
        ("velocity in soft floor 1 [3 s]", 6.0),
        ("velocity in stiff floor 1 [3 s]", 3.0),
        ("time in soft floor 2 [smallest displacement]", 4.0),
        ("time [contact 3]", math.nan),
        ("time [contact -3]", math.nan),
        ("displacement in soft floor 1 [7 s]", math.nan),  # after its end
        ("time [5 s after largest closing]", math.nan),
    ],
)
def test_a_number_at_an_instant(text, expected):
    (quantity,) = parse_comparison(f"{text} > {'1 m' if text.startswith(('d', 'c')) else unit(text)}", SCOPE).quantities
    assert find_at_instant(HISTORY, quantity, GAPS) == pytest.approx(expected, rel=1e-12, nan_ok=True)


def unit(text: str) -> str:
    """A value with the unit of a number."""
    return "1 s" if text.startswith("time") else "1 m/s"


def test_links_that_meet_and_part_between_the_same_samples():
    """The first one to meet tells when, and the last one to part, which is the same of the reversed history."""
    gaps = np.array([0.5, 0.4, 1.0])  # met at 0.5 s and at 0.8 s
    backwards = ResultArrays(
        {"closing": Array(("time", "link"), CLOSING[::-1], {})}, {"time": Array(("time",), TIMES, {})}, {}
    )
    for history, text, expected in ((HISTORY, "time [contact 1]", 0.5), (backwards, "time [release -1]", 5.5)):
        (quantity,) = parse_comparison(f"{text} > 1 s", SCOPE).quantities
        assert find_at_instant(history, quantity, gaps) == pytest.approx(expected, rel=1e-12)


def test_a_row_has_the_number_of_its_own_history_and_gap():
    (quantity,) = parse_comparison("time [contact 1] > 1 s", SCOPE).quantities
    gaps = np.stack([GAPS, np.full(3, 3.5)])[:, None]  # shape (points of the sweep, cases, links)
    found = Instants((2, 1, 1, 2), [((0, 0, 0, 1), HISTORY), ((1, 0, 0, 1), HISTORY)], gaps)(quantity)
    expected = [[np.nan, 1 + 1 / 3], [np.nan, 2 + 2.5 / 3]]  # the first motion is not kept
    assert found[:, 0, 0] == pytest.approx(np.array(expected), rel=1e-12, nan_ok=True)
