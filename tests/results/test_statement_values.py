"""Numbers of statements as people read them."""

from __future__ import annotations

import pytest

from pounding_cli.questions.statements import format_value


@pytest.mark.parametrize(
    ("value", "unit", "written", "text"),
    [
        (1.4612, "m/s2", "g", "0.1490 g"),  # of acceleration, not a gram
        (0.02, "kg", "g", "20.00 g"),
        (0.1229, "m", "mm", "122.9 mm"),
        (0.15, "", "%", "15.00 %"),
        (1.37, "", "", "1.370"),
        (4448.2216152605, "N", "kip", "1.000 kip"),
    ],
)
def test_a_number_is_shown_in_the_unit_that_the_study_writes(value, unit, written, text):
    assert format_value(value, unit, written) == text
