"""Progress of a run: a bar on a terminal, plain lines or JSON lines elsewhere, nothing when asked to be quiet."""

from __future__ import annotations

import contextlib
import json
import sys
import time
from typing import Any, TextIO

from pounding_cli.numbers import count_histories, round_roughly


class Progress:
    """Counts what a run tells, and says nothing.

    done, failed, reused, left : time histories
    expected : those of the whole question where it asks for them part by part, about; 0 where all are known at once
    """

    def __init__(self) -> None:
        self.done = self.failed = self.reused = self.left = self.expected = 0

    def start(self, total: int, reused: int) -> None:
        """Take in that so many more are to be solved; `reused` of those that are wanted were found."""
        self.reused = reused
        self.left += total
        self.show()

    @property
    def to_come(self) -> int:
        """Time histories that are left of the whole question; of one that asks part by part about so many."""
        return max(self.left, self.expected - self.done - self.failed - self.reused)

    def step(self, done: int, failed: int) -> None:
        """Take in that so many came back, with and without a result."""
        self.done, self.failed, self.left = self.done + done, self.failed + failed, self.left - done - failed
        self.show()

    def show(self) -> None:
        """The counts changed."""

    def say(self, sentence: str) -> None:
        """Something worth a line."""

    def stop(self) -> None:
        """Take in that there are no more for now."""

    @property
    def words(self) -> str:
        """The counts in a line."""
        left = f"about {round_roughly(self.to_come)}" if self.to_come > self.left else str(self.left)
        return f"{self.done} done, {self.failed} failed, {self.reused} reused, {left} left"


class Lines(Progress):
    """Plain lines for logs and pipes: at the start, then at most one every `every` seconds."""

    def __init__(self, stream: TextIO | None = None, every: float = 5.0) -> None:
        super().__init__()
        self.stream, self.every, self._last = stream or sys.stderr, every, time.monotonic()

    def show(self) -> None:
        if not self.done + self.failed:
            self.report("start")
        elif time.monotonic() - self._last > self.every:
            self._last = time.monotonic()
            self.report("progress")

    def say(self, sentence: str) -> None:
        """Write a line at once. A run continues when its output has no reader."""
        with contextlib.suppress(OSError, ValueError):
            print(sentence, file=self.stream, flush=True)

    def report(self, event: str) -> None:
        """The counts, at the start or as they are."""
        known = f" ({self.reused} already solved)" if self.reused else ""
        left = count_histories(self.left)
        if self.to_come > self.left:
            left = f"about {count_histories(round_roughly(self.to_come))}"
        self.say(f"{left} to solve{known}" if event == "start" else self.words)


class JsonLines(Lines):
    """One JSON object a line, each with `event`: start, progress (at most every `every` seconds), note."""

    def __init__(self, stream: TextIO | None = None, every: float = 1.0) -> None:
        super().__init__(stream or sys.stdout, every)

    def say(self, sentence: str) -> None:
        self.tell("note", text=sentence)

    def tell(self, event: str, **facts: Any) -> None:
        """Any line."""
        super().say(json.dumps({"event": event, "time": round(time.time(), 3), **facts}))

    def report(self, event: str) -> None:
        self.tell(event, done=self.done, failed=self.failed, reused=self.reused, left=self.to_come)


class Bar(Progress):
    """A bar on the terminal with the counts and the time left."""

    def __init__(self) -> None:
        from rich import progress
        from rich.console import Console

        super().__init__()
        columns = "time histories", progress.BarColumn(), "{task.description}", progress.TimeRemainingColumn()
        self._rich = progress.Progress(*columns, console=Console(stderr=True), transient=True)
        self._task = self._rich.add_task("", total=None)

    def show(self) -> None:
        come = self.done + self.failed
        self._rich.start()
        self._rich.update(self._task, total=come + self.to_come, completed=come, description=self.words)

    def say(self, sentence: str) -> None:
        self._rich.console.print(sentence, highlight=False, markup=False)

    def stop(self) -> None:
        self._rich.stop()


def chosen(quiet: bool) -> Progress:
    """The progress that fits where it is shown."""
    if quiet:
        return Progress()
    return Bar() if sys.stderr.isatty() else Lines()
