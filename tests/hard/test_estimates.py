"""What an error estimate promises, on a few of the random scenes; all of them: `python -m tests.hard.estimates`."""

from __future__ import annotations

from itertools import islice

from .estimates import look_at, random_scenes, touching_scenes

HARD = (12, 723, 857, 1038, 1058, 1167, 1203, 1290, 1550, 1701, 2331, 3328, 3863, 5758, 6036)
"""The worst of 8000 scenes, and those whose infill or pounding floors press again after a force that was cut off."""


def test_estimates_are_not_far_below_the_truth():
    """Fails if an estimate is more than ten times below a true error above a tenth of the accuracy asked, or if a scene
    misses the accuracy by its own estimate without a word."""
    tally = look_at(random_scenes((*HARD, *range(100, 120))))
    assert tally.done >= 20
    assert tally.mattered >= 5
    assert tally.broken == []
    assert tally.missed == tally.flagged


def test_bounds_of_buildings_in_touch_are_not_below_the_truth():
    """Every twelfth row of the sweep. Fails if the duration of contacts that hardly begin does not move a bound."""
    tally = look_at(islice(touching_scenes(), 0, None, 12))
    assert tally.bounded >= 25
    assert tally.broken == []
    assert tally.missed == tally.flagged


def test_scenes_whose_infill_presses_again_meet_the_accuracy():
    """Fails if their errors do not fall with the accuracy: no finer run then meets 1e-9, and they are flagged."""
    tally = look_at(random_scenes((1038, 1167)))
    assert (tally.done, tally.missed, tally.mattered) == (2, 0, 0)
