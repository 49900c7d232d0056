"""What an error estimate promises, on a few of the random scenes; all of them: `python -m tests.hard.estimates`."""

from __future__ import annotations

from .estimates import look_at

HARD = (12,)


def test_estimates_are_not_far_below_the_truth():
    """Fails if an estimate is more than ten times below a true error above a tenth of the accuracy asked, or if a scene
    misses the accuracy by its own estimate without a word."""
    tally = look_at((*HARD, *range(100, 125)))
    assert tally.done >= 20
    assert tally.mattered >= 1
    assert tally.broken == []
    assert tally.missed == tally.flagged
