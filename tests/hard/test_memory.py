"""A run leaves nothing behind in memory, however many there are."""

from __future__ import annotations

import sys

import pytest

from tests.adapter import Scene, solver
from tests.physics.cases import shake

PAIR = ({"storeys": 2, "period": "0.3 s"}, {"storeys": 2, "period": "0.5 s"})


@pytest.mark.parametrize(
    ("link", "settings"),
    [
        ({"link": "pounding"}, {}),
        ({"link": "hertz", "hertz_stiffness": 1e9}, {}),
        ({"link": "pounding"}, {"method": "newmark", "time_step": 1e-3}),
    ],
    ids=["taylor", "dop853", "newmark"],
)
def test_a_kernel_holds_no_array_of_a_run_that_ended(link, settings):
    """numba holds an array by a reference of Python; one that it forgets to give back would keep the array for ever."""
    prepared = solver.prepare_run([Scene(PAIR, shake(1.0), 0.02, {**link, "gap": 0.0}).built], **settings)
    arrays = [each for each in prepared.data if hasattr(each, "dtype")]
    assert len(arrays) >= 6
    before = [sys.getrefcount(each) for each in arrays]
    prepared.integrate()
    assert prepared.build_responses()[0].status == "done"
    assert [sys.getrefcount(each) for each in arrays] == before
