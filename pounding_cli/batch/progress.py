"""Progress of a run: a bar on a terminal, plain lines or JSON lines elsewhere, nothing when asked to be quiet."""

from __future__ import annotations

import contextlib
import json
import sys
import time
from typing import Any, TextIO

from pounding_cli.numbers import counted, time_text


class Progress:
    """Counts what a run tells, and says nothing.

    done, failed, reused, left : scenes
    """

    def __init__(self) -> None:
        self.done = self.failed = self.reused = self.left = 0
        self._begun, self._before = 0.0, 0

    def start(self, total: int, reused: int) -> None:
        """So many scenes more are to be solved; `reused` of those that are wanted were found."""
        self.reused, self.left = reused, self.left + total
        self.show()

    def compiled(self) -> None:
        """What came so far was compiled meanwhile, and says nothing about the time that the rest takes."""
        self._begun, self._before = time.monotonic(), self.done + self.failed

    def step(self, done: int, failed: int) -> None:
        """So many scenes came back, with and without a result."""
        self.done, self.failed, self.left = self.done + done, self.failed + failed, self.left - done - failed
        self.show()

    def show(self) -> None:
        """The counts changed."""

    def say(self, sentence: str) -> None:
        """Something worth a line."""

    def stop(self) -> None:
        """No more scenes for now."""

    @property
    def seconds_left(self) -> float | None:
        """Time that the rest will take if it is like what came since kernels were compiled [s]; None before that."""
        come = self.done + self.failed - self._before
        return (time.monotonic() - self._begun) / come * self.left if self._begun and come else None

    @property
    def words(self) -> str:
        """The counts in a line."""
        found = f"{self.done} done, {self.failed} failed, {self.reused} reused, {self.left} left"
        seconds = self.seconds_left
        return found + (f", about {time_text(seconds)} to go" if seconds is not None and self.left else "")


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
        self.say(f"{counted(self.left, 'scene')} to solve{known}" if event == "start" else self.words)


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
        counts = {"done": self.done, "failed": self.failed, "reused": self.reused, "left": self.left}
        self.tell(event, **counts, seconds_left=self.seconds_left)


class Bar(Progress):
    """A bar on the terminal with the counts and the time left."""

    def __init__(self) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, TextColumn
        from rich.progress import Progress as Rich

        super().__init__()
        columns = (TextColumn("scenes"), BarColumn(), TextColumn("{task.description}"))
        self._rich = Rich(*columns, console=Console(stderr=True), transient=True)
        self._task = self._rich.add_task("", total=None)

    def show(self) -> None:
        come = self.done + self.failed
        self._rich.start()
        self._rich.update(self._task, total=come + self.left, completed=come, description=self.words)

    def say(self, sentence: str) -> None:
        self._rich.console.print(sentence, highlight=False, markup=False)

    def stop(self) -> None:
        self._rich.stop()


def chosen(quiet: bool) -> Progress:
    """The progress that fits where it is shown."""
    if quiet:
        return Progress()
    return Bar() if sys.stderr.isatty() else Lines()
