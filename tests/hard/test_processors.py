"""Other processors' arithmetic: what differs by more than the estimates of both runs tell is flagged in both."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.adapter import Run, difference
from tests.night import NIGHTLY

from .processors import PROCESSORS, solve_as, solve_here

NUMBERS = "shear", "drift", "acceleration", "peak_force", "max_closing"

LEAST = 1e-12
"""Rounding of a number that several steps carry on [-]."""

CHANCE = "less accurate", "ill-conditioned", "chance"
"""Words of the flags of scenes in which rounding decides."""


@pytest.fixture(scope="module")
def here() -> dict[str, Run]:
    """The runs of this processor."""
    return solve_here()


def is_of_chance(run: Run) -> bool:
    return any(word in flag for flag in run.flags for word in CHANCE)


@pytest.mark.xdist_group("processors")
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[] if name == "generic" else NIGHTLY) for name in PROCESSORS]
)
def test_another_processor_agrees_within_the_estimates(here: dict[str, Run], tmp_path: Path, name: str) -> None:
    """Fails if an estimate is below what another processor's last digits make of a scene, and no flag says so."""
    there = solve_as(PROCESSORS[name], tmp_path / "runs.pickle")
    assert here.keys() == there.keys()
    beyond = {}
    for scene, run in here.items():
        other = there[scene]
        assert run.status == other.status, scene
        allowed = run.error + other.error + LEAST
        found = difference(run, other, NUMBERS) if run.status == "done" else 0.0
        if found > allowed and not (is_of_chance(run) and is_of_chance(other)):
            beyond[scene] = found, allowed, run.flags, other.flags
    assert beyond == {}
