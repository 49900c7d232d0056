"""Samples of the unit cube: drawn here or in a process of their own, they are the same."""

import subprocess
import sys

import numpy as np
import pytest

from pounding_cli.study import samples


@pytest.mark.parametrize("method", ["sobol", "morris"])
def test_many_are_drawn_elsewhere_and_are_the_same(monkeypatch, method):
    def drawn(many):
        monkeypatch.setattr(samples, "MANY", many)
        samples.grid.cache_clear()
        return samples.grid(method, 3, 16, 4, 7)

    here, programs = drawn(10**9), []
    run = subprocess.run
    monkeypatch.setattr(subprocess, "run", lambda words, **more: programs.append(words) or run(words, **more))
    assert np.array_equal(drawn(1), here)
    assert len(programs) == 1
    monkeypatch.setattr(sys, "executable", None)  # a program without an interpreter of its own
    assert np.array_equal(drawn(1), here)


def test_a_run_of_many_samples_does_not_hold_salib():
    program = "import sys; from pounding_cli.study.samples import grid, MANY; grid('sobol', 3, 8192, 4, 7)"
    held = "print([name for name in ('SALib', 'pandas', 'scipy.stats') if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", f"{program}; {held}"], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"
