"""What all commands that solve scenes share: their options, and one way to run a plan with them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pounding_cli.cli import streams

if TYPE_CHECKING:
    from pounding_cli.api.running import Outcome
    from pounding_cli.batch.progress import JsonLines

_OPTIONS = (
    click.option("-q", "--quiet", is_flag=True, help="Print only scenes that failed."),
    click.option(
        "--workers",
        type=click.IntRange(min=1),
        metavar="N",
        help="Number of scenes solved in parallel. Default: all cores.",
    ),
    click.option(
        "--engine",
        "engine_name",
        type=click.Choice(("threads", "processes", "dask", "serial")),
        default="threads",
        show_default=True,
        help="How scenes are solved; the results are the same. Small studies are always solved serially.",
    ),
    click.option(
        "--scheduler",
        metavar="ADDRESS",
        help="Dask scheduler for --engine dask, e.g. tcp://node:8786. Default: a cluster on this machine.",
    ),
    click.option(
        "--replace",
        is_flag=True,
        help="Replace the results of another study; forget scenes and histories that STUDY no longer has.",
    ),
    click.option("--log-json", is_flag=True, help="Print progress and outcome as JSON lines only."),
)


@dataclass(frozen=True)
class Solving:
    """How scenes are to be solved, as the options say."""

    quiet: bool
    workers: int | None
    engine_name: str
    scheduler: str | None
    replace: bool
    log_json: bool


def output_option(default: str) -> Callable[..., Any]:
    """`-o FILE.h5`."""
    return click.option(
        "-o",
        "--output",
        type=click.Path(path_type=Path),
        metavar="FILE.h5",
        help=f"Results file. Default: {default} in the current folder.",
    )


def solving_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Adds the options of `Solving`, which the command gets as keyword arguments."""
    for option in reversed(_OPTIONS):
        command = option(command)
    return command


def solve_study(
    ctx: click.Context,
    workflow: str,
    study: Path,
    output: Path | None,
    how: Solving,
    summarise: Callable[[Path, Outcome], None],
    after: Callable[[Path], None] | None = None,
) -> None:
    """Load a study, solve what its workflow asks for, write the results file and tell what came out.

    summarise : prints what was found in the results file; not called where nothing is to be printed
    after : called with the results file in any case

    Failed scenes are listed and make the exit code 1.
    """
    _alone_on_its_core()
    from pounding_cli.api.running import question, run_study
    from pounding_cli.api.studies import default_output
    from pounding_cli.batch.progress import JsonLines, chosen
    from pounding_cli.study import load_study

    log = JsonLines() if how.log_json else None
    loaded = load_study(study)
    for warning in loaded.warnings:
        if log:
            log.tell("warning", text=str(warning))
        elif not how.quiet:
            streams.echo_warning(warning)
    path = output or default_output(study, workflow)
    outcome = run_study(
        loaded, question(workflow), path, progress=log or chosen(how.quiet), workers=how.workers,
        engine=how.engine_name, scheduler=how.scheduler, replace=how.replace,
    )  # fmt: skip
    if log:
        _log(log, outcome)
    elif not how.quiet:
        summarise(path, outcome)
    if after is not None:
        after(path)
    for failure in () if log else outcome.failures:
        click.echo(f"failed: {failure.place}: {failure.status}", err=True)
        if failure.advice:
            click.echo(f"    {failure.advice}", err=True)
    if outcome.failures:
        ctx.exit(1)


def _alone_on_its_core() -> None:
    """Linear algebra in one thread: scenes are solved side by side, and their matrices are small. SIGTERM, which batch
    systems send when time is up, stops a run as Ctrl-C does."""
    import os
    import signal
    import threading

    for name in ("OPENBLAS", "OMP", "MKL", "NUMEXPR", "VECLIB_MAXIMUM"):
        os.environ.setdefault(f"{name}_NUM_THREADS", "1")
    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGTERM, signal.default_int_handler)


def _log(log: JsonLines, outcome: Outcome) -> None:
    """The failed scenes and the end of a run as JSON lines."""
    for failure in outcome.failures:
        log.tell("failed", scene=failure.place, status=failure.status, advice=failure.advice)
    log.tell(
        "end",
        done=outcome.done,
        failed=outcome.failed,
        reused=outcome.reused,
        results=str(outcome.path),
        engine=outcome.engine,
        workers=outcome.workers,
        solver_seconds=round(outcome.solver_seconds, 3),
        wall_seconds=round(outcome.wall_seconds, 3),
    )


def time_text(seconds: float) -> str:
    """A time [s] for people: "12 ms", "3.4 s", "5.0 min"."""
    if seconds < 1:
        return f"{1000 * seconds:.0f} ms"
    return f"{seconds:.1f} s" if seconds < 120 else f"{seconds / 60:.1f} min"
