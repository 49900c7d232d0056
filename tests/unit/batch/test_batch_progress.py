"""What a run tells while it goes on."""

from __future__ import annotations

import io
import json

import pytest

from pounding_cli.batch import progress
from pounding_cli.batch.progress import Bar, Counts, JsonLines, Lines, Quiet, chosen, span


@pytest.fixture
def clock(monkeypatch):
    """A clock that goes on when told."""

    class Clock:
        now = 100.0

        def monotonic(self):
            return self.now

        def time(self):
            return 1e9 + self.now

    clock = Clock()
    monkeypatch.setattr(progress, "time", clock)
    return clock


def test_counts_say_what_is_left_and_for_how_long(clock):
    counts = Counts()
    counts.start(100, 7)
    assert counts.seconds_left is None
    counts.compiled()
    assert counts.seconds_left is None
    clock.now += 10
    counts.step(18, 2)
    assert counts.words == "18 done, 2 failed, 7 reused, 80 left, about 40 s to go"
    counts.step(80, 0)
    assert counts.words == "98 done, 2 failed, 7 reused, 0 left"


def test_rounds_to_come_are_told_with_the_time_they_take_at_most(clock):
    """Fails if the scenes of rounds to come count among those of this one, or are told after the last."""
    stream = io.StringIO()
    lines = Lines(stream, every=5.0)
    lines.start(10, 0, ahead=90)
    lines.compiled()
    clock.now += 10
    lines.step(5, 0)
    assert lines.counts.words == (
        "5 done, 0 failed, 0 reused, 5 left, about 10 s to go; rounds to come: at most 90 more, 3 min"
    )
    lines.step(5, 0)
    lines.start(10, 10)
    lines.step(10, 0)
    lines.stop()
    assert stream.getvalue().splitlines()[-1] == "20 done, 0 failed, 0 reused, 0 left"


def test_json_tells_rounds_to_come(clock):
    stream = io.StringIO()
    log = JsonLines(stream)
    log.start(10, 0, ahead=20)
    log.compiled()
    clock.now += 10
    log.step(5, 0)
    found = json.loads(stream.getvalue().splitlines()[-1])
    assert (found["left"], found["seconds_left"], found["ahead"], found["seconds_ahead"]) == (5, 10.0, 20, 40.0)


def test_compiling_says_nothing_about_the_rest(clock):
    """Two scenes that came in half a minute, most of it compiling, and eight in four seconds. Fails if the half minute
    counts: a first run said 22 minutes of half a second."""
    counts = Counts()
    counts.start(30, 0)
    for _ in range(2):
        clock.now += 15
        counts.step(1, 0)
        assert counts.words.endswith("left")
    counts.compiled()
    clock.now += 4
    counts.step(8, 0)
    assert counts.seconds_left == 10.0


@pytest.mark.parametrize(("seconds", "words"), [(3.2, "3 s"), (600, "10 min"), (7300, "2 h 2 min")])
def test_times_in_words(seconds, words):
    assert span(seconds) == words


def test_plain_lines_come_at_intervals(clock):
    stream = io.StringIO()
    lines = Lines(stream, every=5.0)
    lines.start(10, 0)
    lines.compiled()
    for _ in range(4):
        clock.now += 3
        lines.step(1, 0)
    lines.stop()
    assert stream.getvalue().splitlines() == [
        "10 scenes to solve",
        "2 done, 0 failed, 0 reused, 8 left, about 24 s to go",
        "4 done, 0 failed, 0 reused, 6 left, about 18 s to go",
        "4 done, 0 failed, 0 reused, 6 left, about 18 s to go",
    ]


def test_json_lines_are_json_with_the_counts(clock):
    stream = io.StringIO()
    lines = JsonLines(stream)
    lines.start(10, 3)
    lines.compiled()
    clock.now += 2
    lines.step(4, 1)
    lines.step(1, 0)
    lines.say("a sentence")
    lines.stop()
    found = [json.loads(line) for line in stream.getvalue().splitlines()]
    assert [line["event"] for line in found] == ["start", "progress", "note", "stop"]
    assert found[1] == {
        "event": "progress", "time": 1e9 + 102, "done": 4, "failed": 1, "reused": 3, "left": 5, "seconds_left": 2.0,
    }  # fmt: skip
    assert found[2]["text"] == "a sentence"
    assert (found[3]["done"], found[3]["left"]) == (5, 4)


def test_a_bar_shows_the_counts(monkeypatch):
    from rich.console import Console

    stream = io.StringIO()
    monkeypatch.setattr("rich.console.Console", lambda **_: Console(file=stream, force_terminal=True, width=120))
    bar = Bar()
    bar.start(10, 2)
    bar.step(3, 1)
    bar.say("a sentence")
    bar.stop()
    assert "3 done, 1 failed, 2 reused, 6 left" in stream.getvalue()
    assert "a sentence" in stream.getvalue()


def test_the_choice_follows_where_it_is_shown(monkeypatch):
    assert isinstance(chosen(quiet=True), Quiet)
    monkeypatch.setattr("sys.stderr", io.StringIO())
    assert isinstance(chosen(quiet=False), Lines)


def test_rounds_are_counted_together(clock):
    """The second round finds the 20 scenes of the first solved, and 5 that a former run left. Rounds may be many: they
    are told together."""
    stream = io.StringIO()
    lines = Lines(stream)
    for total, found in ((20, 3), (40, 28)):
        lines.start(total, found)
        lines.step(total, 0)
    lines.stop()
    assert stream.getvalue().splitlines() == [
        "20 scenes to solve (3 already solved)",
        "60 done, 0 failed, 8 reused, 0 left",
    ]
