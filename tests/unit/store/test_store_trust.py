"""Error and sensitivity of means over records."""

from __future__ import annotations

import numpy as np
import pytest

from pounding_cli.store.statistics import trust_of_means


def test_errors_add_up_and_sensitivities_are_weighted():
    """Two ratios 1 and 3 with errors 1e-6 and 1e-8: the mean, 2, is off by at most (1e-6 + 3e-8) / 2; where the motion
    moves them by factors 2 and 10, their sum moves by (1 * 2 + 3 * 10) / 4 times the change."""
    values = np.array([[1.0], [3.0]])
    found = trust_of_means(values, np.array([[1e-6], [1e-8]]), np.array([[2.0], [10.0]]), axis=0)
    assert found["error"] == pytest.approx([0.515e-6])
    assert found["sensitivity"] == pytest.approx([8.0])


def test_what_was_not_assessed_is_left_out():
    values = np.array([[1.0, 2.0], [np.nan, 2.0], [3.0, 2.0]])
    errors = np.array([[1e-6, np.nan], [1e-6, np.nan], [np.nan, np.nan]])
    found = trust_of_means(values, errors, errors, axis=0)
    assert found["error"][0] == pytest.approx(1e-6)
    assert np.isnan(found["error"][1])
    assert np.isnan(found["sensitivity"][1])
