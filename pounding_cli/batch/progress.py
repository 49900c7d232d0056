"""Progress of a run: a bar on a terminal, plain lines or JSON lines elsewhere, nothing when asked to be quiet."""

from __future__ import annotations

import contextlib
import json
import math
import os
import sys
import time
from dataclasses import dataclass
from typing import Any, Protocol, TextIO

from pounding_cli.numbers import counted


class Progress(Protocol):
    """What a run tells while it goes on."""

    def start(self, total: int, reused: int, ahead: int = 0) -> None:
        """`total` scenes are to be solved; `reused` were found solved. In a later round: so many more.

        ahead : scenes that rounds to come ask for at most, as far as that is known"""
        ...

    def compiled(self) -> None:
        """Kernels are compiled: what came so far took far longer than the rest will, and says nothing about it."""
        ...

    def step(self, done: int, failed: int) -> None:
        """So many scenes more came back, with and without a result."""
        ...

    def say(self, sentence: str) -> None:
        """Something worth a line."""
        ...

    def stop(self) -> None:
        """No more scenes."""
        ...


@dataclass
class Counts:
    """Scenes done, failed, reused and left, those that rounds to come may ask for, and the time they take."""

    total: int = 0
    reused: int = 0
    done: int = 0
    failed: int = 0
    ahead: int = 0
    begun: float = math.inf
    come_before: int = 0

    def start(self, total: int, reused: int, ahead: int = 0) -> None:
        self.reused = reused - self.come  # in later rounds those of this run are found solved too
        self.total = self.come + total
        self.ahead = ahead

    @property
    def come(self) -> int:
        """Scenes that came back."""
        return self.done + self.failed

    def compiled(self) -> None:
        self.begun, self.come_before = time.monotonic(), self.come

    def step(self, done: int, failed: int) -> None:
        self.done += done
        self.failed += failed

    @property
    def left(self) -> int:
        return self.total - self.come

    @property
    def seconds_left(self) -> float | None:
        """Time the rest will take if it is like what came since kernels were compiled [s]; None before anything did."""
        return self._seconds(self.left)

    @property
    def seconds_ahead(self) -> float | None:
        """Time that rounds to come will take at most, likewise [s]."""
        return self._seconds(self.ahead)

    def _seconds(self, scenes: int) -> float | None:
        come = self.come - self.come_before if self.begun < math.inf else 0
        return (time.monotonic() - self.begun) / come * scenes if come else None

    @property
    def words(self) -> str:
        """The counts in a line."""
        parts = [f"{self.done} done", f"{self.failed} failed", f"{self.reused} reused", f"{self.left} left"]
        words, seconds = ", ".join(parts), self.seconds_left
        if seconds is not None and self.left:
            words += f", about {span(seconds)} to go"
        if self.ahead:
            words += f"; rounds to come: at most {self.ahead} more"
            seconds = self.seconds_ahead
            words += "" if seconds is None else f", {span(seconds)}"
        return words


def span(seconds: float) -> str:
    """A time in words."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    minutes = round(seconds / 60)
    return f"{minutes} min" if minutes < 90 else f"{minutes // 60} h {minutes % 60} min"


class Quiet:
    """Says nothing."""

    def start(self, total: int, reused: int, ahead: int = 0) -> None: ...

    def compiled(self) -> None: ...

    def step(self, done: int, failed: int) -> None: ...

    def say(self, sentence: str) -> None: ...

    def stop(self) -> None: ...


def _write(line: str, stream: TextIO) -> None:
    """Write a line at once. A run continues when its output has no reader."""
    with contextlib.suppress(OSError, ValueError):
        try:
            print(line, file=stream, flush=True)
        except BrokenPipeError:  # what stands in its buffer would end the run when it is flushed
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, stream.fileno())
            os.close(nowhere)


class Lines:
    """Plain lines for logs and pipes: at the start, then at most one every `every` seconds, and at the end."""

    def __init__(self, stream: TextIO | None = None, every: float = 5.0) -> None:
        self.stream = stream or sys.stderr
        self.every = every
        self.counts = Counts()
        self._last = time.monotonic()

    def start(self, total: int, reused: int, ahead: int = 0) -> None:
        later = self.counts.come > 0
        self.counts.start(total, reused, ahead)
        if later:  # rounds may be many, and each a moment
            self.step(0, 0)
            return
        found = f" ({reused} already solved)" if reused else ""
        self.say(f"{counted(total, 'scene')} to solve{found}")

    def compiled(self) -> None:
        self.counts.compiled()

    def step(self, done: int, failed: int) -> None:
        self.counts.step(done, failed)
        if time.monotonic() - self._last > self.every:
            self._last = time.monotonic()
            self.say(self.counts.words)

    def say(self, sentence: str) -> None:
        _write(sentence, self.stream)

    def stop(self) -> None:
        self.counts.ahead = 0
        self.say(self.counts.words)


class JsonLines:
    """One JSON object a line, each with `event`: start, progress (at most every `every` seconds), note, stop."""

    def __init__(self, stream: TextIO | None = None, every: float = 1.0) -> None:
        self.stream = stream or sys.stdout
        self.every = every
        self.counts = Counts()
        self._last = 0.0

    def start(self, total: int, reused: int, ahead: int = 0) -> None:
        self.counts.start(total, reused, ahead)
        self._progress("start")

    def compiled(self) -> None:
        self.counts.compiled()

    def step(self, done: int, failed: int) -> None:
        self.counts.step(done, failed)
        if time.monotonic() - self._last > self.every:
            self._progress("progress")

    def say(self, sentence: str) -> None:
        self.tell("note", text=sentence)

    def stop(self) -> None:
        self.counts.ahead = 0
        self._progress("stop")

    def tell(self, event: str, **facts: Any) -> None:
        """Any line."""
        line = {"event": event, "time": round(time.time(), 3), **facts}
        _write(json.dumps(line), self.stream)

    def _progress(self, event: str) -> None:
        self._last = time.monotonic()
        facts: dict[str, Any] = {name: getattr(self.counts, name) for name in ("done", "failed", "reused", "left")}
        times = ["seconds_left"]
        if self.counts.ahead:
            facts["ahead"] = self.counts.ahead
            times.append("seconds_ahead")
        for name in times:
            seconds = getattr(self.counts, name)
            facts[name] = None if seconds is None else round(seconds, 1)
        self.tell(event, **facts)


class Bar:
    """A bar on the terminal with the counts and the time left."""

    def __init__(self) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, TextColumn
        from rich.progress import Progress as Rich

        columns = (TextColumn("scenes"), BarColumn(), TextColumn("{task.description}"))
        # Drawn from `step`, not from a thread: a worker's fork must not copy the locks of a running thread.
        self._rich = Rich(*columns, console=Console(stderr=True), auto_refresh=False, transient=True)
        self._task = self._rich.add_task("", total=None)
        self.counts = Counts()

    def start(self, total: int, reused: int, ahead: int = 0) -> None:
        self.counts.start(total, reused, ahead)
        self._rich.update(self._task, total=self.counts.total, description=self.counts.words)
        self._rich.start()
        self._rich.refresh()

    def compiled(self) -> None:
        self.counts.compiled()

    def step(self, done: int, failed: int) -> None:
        self.counts.step(done, failed)
        self._rich.update(self._task, advance=done + failed, description=self.counts.words)
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
