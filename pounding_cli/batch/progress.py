"""Progress of a run: a bar on a terminal, plain lines elsewhere, nothing when asked to be quiet."""

from __future__ import annotations

import sys
import time
from typing import Protocol, TextIO


class Progress(Protocol):
    """What a run tells while it goes on."""

    def start(self, total: int, reused: int) -> None:
        """`total` scenes are to be solved; `reused` were found solved."""
        ...

    def step(self, failed: bool) -> None:
        """One scene came back."""
        ...

    def say(self, sentence: str) -> None:
        """Something worth a line."""
        ...

    def stop(self) -> None:
        """No more scenes."""
        ...


class Quiet:
    """Says nothing."""

    def start(self, total: int, reused: int) -> None: ...

    def step(self, failed: bool) -> None: ...

    def say(self, sentence: str) -> None: ...

    def stop(self) -> None: ...


class Lines:
    """Plain lines for logs and pipes: at the start, then at most one every `every` seconds."""

    def __init__(self, stream: TextIO | None = None, every: float = 5.0) -> None:
        self.stream = stream or sys.stderr
        self.every = every
        self.total = self.count = self.failed = 0
        self._last = time.monotonic()

    def start(self, total: int, reused: int) -> None:
        self.total = total
        found = f" ({reused} already solved)" if reused else ""
        self.say(f"{total} scenes to solve{found}")

    def step(self, failed: bool) -> None:
        self.count += 1
        self.failed += failed
        if time.monotonic() - self._last > self.every:
            self._last = time.monotonic()
            wrong = f", {self.failed} failed" if self.failed else ""
            self.say(f"{self.count} of {self.total} scenes{wrong}")

    def say(self, sentence: str) -> None:
        print(sentence, file=self.stream, flush=True)

    def stop(self) -> None: ...


class Bar:
    """A bar on the terminal with count, rate and time left."""

    def __init__(self) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeRemainingColumn
        from rich.progress import Progress as Rich

        columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
        # Drawn from `step`, not from a thread: a worker's fork must not copy the locks of a running thread.
        self._rich = Rich(*columns, console=Console(stderr=True), auto_refresh=False, transient=True)
        self._task = self._rich.add_task("scenes", total=None)
        self._failed = 0
        self._last = 0.0

    def start(self, total: int, reused: int) -> None:
        if reused:
            self.say(f"{reused} scenes already solved")
        self._rich.update(self._task, total=total)
        self._rich.start()
        self._rich.refresh()

    def step(self, failed: bool) -> None:
        self._failed += failed
        wrong = f"scenes, {self._failed} failed" if self._failed else "scenes"
        self._rich.update(self._task, advance=1, description=wrong)
        if time.monotonic() - self._last > 0.1:
            self._last = time.monotonic()
            self._rich.refresh()

    def say(self, sentence: str) -> None:
        self._rich.console.print(sentence, highlight=False, markup=False)

    def stop(self) -> None:
        self._rich.stop()


def chosen(quiet: bool) -> Progress:
    """The progress that fits where it is shown."""
    if quiet:
        return Quiet()
    return Bar() if sys.stderr.isatty() else Lines()
