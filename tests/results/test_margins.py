"""Margins of comparisons, worked by hand over numbers of two buildings of one storey under two motions."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pounding_cli.questions.expressions import EVERY, compare_values, find_spread
from pounding_cli.solver.response import COLLAPSED, DONE
from pounding_cli.study.expressions.comparison import parse_comparison
from pounding_cli.study.expressions.expression import Scope

SCOPE = Scope(("soft", "stiff"), ("near",), ("elastic",), ("taft", "elcentro"), ("pounding",))


def make_values(drift: np.ndarray, share: float = 0.1) -> dict[str, np.ndarray]:
    """The variables of one case and analysis: drifts, shape (motions, buildings) [m]; NaN where a run failed.

    share : numerical error of all numbers, over the number
    """
    drift = np.asarray(drift, float)[None, None, :, :, None]
    status = np.where(np.isnan(drift).any(axis=(-2, -1)), COLLAPSED, DONE)
    error = np.full(status.shape, share)
    return {"status": status, "drift": drift, "mu": drift / 0.01, "error_estimate": error, "sensitivity": error}


@pytest.mark.parametrize(
    ("text", "drift", "margin"),
    [
        ("drift in soft > 1 cm", [[0.02, 0.05], [0.04, 0.05]], 0.02),
        ("1 cm < drift in soft", [[0.02, 0.05], [0.04, 0.05]], 0.02),
        ("0 < drift in soft / drift in stiff < 1", [[0.02, 0.05], [0.04, 0.05]], 0.4),
        ("drift in soft > 1 cm", [[0.02, 0.05], [np.nan, 0.05]], math.nan),  # what failed is no part of a mean
        ("0 cm < drift in soft < drift in stiff", [[0.02, np.nan], [0.04, np.nan]], math.nan),
        ("drift > 1 cm", [[0.02, 0.05], [0.04, np.nan]], math.nan),  # nor is a building whose run ended
    ],
)
def test_a_margin_of_a_mean_of_motions(text, drift, margin):
    compared = compare_values(parse_comparison(text, SCOPE), make_values(drift), "mean")
    assert compared.margin.ravel() == pytest.approx([margin], nan_ok=True)
    assert compared.held.ravel() == pytest.approx([math.nan if math.isnan(margin) else 1.0], nan_ok=True)


def test_the_margins_of_each_motion():
    """A building whose run ended takes the number of the whole group with it."""
    values = make_values([[0.02, 0.05], [0.04, np.nan]])
    margins = compare_values(parse_comparison("drift > 1 cm", SCOPE), values, EVERY).margin
    assert margins.ravel() == pytest.approx([0.04, math.nan], nan_ok=True)


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("drift in soft > 1 cm", 0.003),
        ("2 * drift in soft > 1 cm", 0.006),
        ("drift in soft + drift in stiff > 1 cm", 0.008),  # both at their worst
        ("drift in soft / drift in stiff < 1", (0.06 + 0.6 * (1 / 0.9 - 1 / 1.1) / 2)),
        ("drift in soft > drift in stiff", 0.008),
    ],
)
def test_the_error_of_a_margin_is_that_of_its_numbers(text, error):
    comparison = parse_comparison(text, SCOPE)
    found = find_spread(
        comparison.quantities, comparison.margin, make_values([[0.02, 0.05], [0.04, 0.05]]), "mean", "error"
    )
    assert found.ravel() == pytest.approx([error])


@pytest.mark.parametrize(("text", "below"), [("mu > 4", True), ("4 < mu", True), ("mu < 4", False), ("4 > mu", False)])
def test_a_comparison_bounds_its_number_from_below_or_above(text, below):
    assert parse_comparison(text, SCOPE).bounds_below == below
