"""SIGKILL at random moments loses nothing; `python -m tests.batch.kills` is the long form of this."""

from __future__ import annotations

from tests.batch.kills import hunt


def test_a_study_killed_at_random_moments_ends_with_the_same_tables():
    trials = hunt(kills=5, seed=7, gaps=12, pause=0.005)
    assert any(trial.kept > 0 for trial in trials)
