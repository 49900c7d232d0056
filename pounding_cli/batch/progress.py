"""Show the progress of a run: a bar on a terminal, plain or JSON lines elsewhere, nothing in a quiet run."""

from __future__ import annotations

import contextlib
import json
import sys
import time
from typing import Any, TextIO

from pounding_cli.numbers import count_histories, round_roughly


class Progress:
    """Counts the time histories of a run, and shows nothing.

    done_count, failed_count, reused_count, left_count : time histories
    expected_count : time histories of a whole question that solves them part by part, about; 0 where all are known at
        once
    """

    def __init__(self) -> None:
        self.done_count = 0
        self.failed_count = 0
        self.reused_count = 0
        self.left_count = 0
        self.expected_count = 0

    def add_histories(self, count: int, reused_count: int) -> None:
        """Take in that so many more are to be solved.

        reused_count : those of the whole run that were found solved
        """
        self.reused_count = reused_count
        self.left_count += count
        self.show_counts()

    def count_solved(self, done: int, failed: int) -> None:
        """Take in that so many came back, with and without a result."""
        self.done_count += done
        self.failed_count += failed
        self.left_count -= done + failed
        self.show_counts()

    @property
    def remaining_count(self) -> int:
        """Time histories that are left of the whole question; about so many where it solves them part by part."""
        finished_count = self.done_count + self.failed_count + self.reused_count
        return max(self.left_count, self.expected_count - finished_count)

    def format_counts(self) -> str:
        """Return the counts in a line."""
        left = str(self.left_count)
        if self.remaining_count > self.left_count:
            left = f"about {round_roughly(self.remaining_count)}"
        return f"{self.done_count} done, {self.failed_count} failed, {self.reused_count} reused, {left} left"

    def show_counts(self) -> None:
        """Show the counts, which changed."""

    def write_note(self, sentence: str) -> None:
        """Show a sentence."""

    def stop_display(self) -> None:
        """Take in that there are no more time histories for now."""


class Lines(Progress):
    """Plain lines for logs and pipes: at the start, then at most one every `interval` seconds."""

    def __init__(self, stream: TextIO | None = None, interval: float = 5.0) -> None:
        super().__init__()
        self.stream = stream or sys.stderr
        self.interval = interval
        self._last_time = time.monotonic()

    def show_counts(self) -> None:
        if not self.done_count + self.failed_count:
            self.write_counts("start")
        elif time.monotonic() - self._last_time > self.interval:
            self._last_time = time.monotonic()
            self.write_counts("progress")

    def write_note(self, sentence: str) -> None:
        """Write a line at once; a run continues when its output has no reader."""
        with contextlib.suppress(OSError, ValueError):
            print(sentence, file=self.stream, flush=True)

    def write_counts(self, event: str) -> None:
        """Write the counts.

        event : "start" or "progress"
        """
        if event == "progress":
            self.write_note(self.format_counts())
            return
        left = count_histories(self.left_count)
        if self.remaining_count > self.left_count:
            left = f"about {count_histories(round_roughly(self.remaining_count))}"
        reused = f" ({self.reused_count} already solved)" if self.reused_count else ""
        self.write_note(f"{left} to solve{reused}")


class JsonLines(Lines):
    """One JSON object a line, each with `event`: start, progress (at most every `interval` seconds), note."""

    def __init__(self, stream: TextIO | None = None, interval: float = 1.0) -> None:
        super().__init__(stream or sys.stdout, interval)

    def write_event(self, event: str, **facts: Any) -> None:
        """Write the line of an event, with its time [s since 1970]."""
        super().write_note(json.dumps({"event": event, "time": round(time.time(), 3), **facts}))

    def write_note(self, sentence: str) -> None:
        self.write_event("note", text=sentence)

    def write_counts(self, event: str) -> None:
        self.write_event(
            event,
            done=self.done_count,
            failed=self.failed_count,
            reused=self.reused_count,
            left=self.remaining_count,
        )


class Bar(Progress):
    """A bar on the terminal with the counts and the time left."""

    def __init__(self) -> None:
        from rich import progress
        from rich.console import Console

        super().__init__()
        columns = ("time histories", progress.BarColumn(), "{task.description}", progress.TimeRemainingColumn())
        self._rich = progress.Progress(*columns, console=Console(stderr=True), transient=True)
        self._task = self._rich.add_task("", total=None)

    def show_counts(self) -> None:
        solved_count = self.done_count + self.failed_count
        total = solved_count + self.remaining_count
        self._rich.start()
        self._rich.update(self._task, total=total, completed=solved_count, description=self.format_counts())

    def write_note(self, sentence: str) -> None:
        self._rich.console.print(sentence, highlight=False, markup=False)

    def stop_display(self) -> None:
        self._rich.stop()


def choose_progress(quiet: bool) -> Progress:
    """Return the progress that fits where it is shown."""
    if quiet:
        return Progress()
    return Bar() if sys.stderr.isatty() else Lines()
