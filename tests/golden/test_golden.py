"""Every number of the golden studies is the stored one, to ten times the accuracy of the study."""

from __future__ import annotations

import pytest

from tests.golden.tables import STUDIES, differences, solved


@pytest.mark.parametrize("name", STUDIES)
def test_the_tables_of_a_study(name, tmp_path):
    assert differences(name, solved(name, tmp_path)) == []
