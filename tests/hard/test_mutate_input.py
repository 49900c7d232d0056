"""A few mutations of studies and motion files in every test run; `make fuzz` makes a thousand of each."""

from __future__ import annotations

import faulthandler
import os
import signal

import pytest

from .guarded import guarded
from .mutate_input import hunt


@pytest.mark.parametrize("sort", ["studies", "motions"])
def test_mutations_are_accepted_or_refused(sort):
    found = hunt(sort, 15, 0)
    assert found["done"] + found["refused"] == 15
    assert found["refused"] > 0


def test_a_fault_is_told():
    """A traceback, a hang and a crash are each known as such: a hunt that saw none would prove nothing."""

    def spin() -> None:
        while True:
            pass

    def crash() -> None:
        faulthandler.disable()
        os.kill(os.getpid(), signal.SIGSEGV)

    assert guarded(lambda: 1 / 0).startswith("traceback: ZeroDivisionError")
    assert guarded(lambda: bytearray(10**9), megabytes=100).startswith("traceback: MemoryError")
    assert guarded(spin, seconds=1) == "hang"
    assert guarded(crash) == "crash: signal 11"
