"""`pound run`: run a study, reusing scenes solved before, and print its summary."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from pounding_cli.cli import streams
from pounding_cli.words import counted

if TYPE_CHECKING:
    import numpy as np

    from pounding_cli.batch import Outcome
    from pounding_cli.batch.progress import JsonLines
    from pounding_cli.store import Overview
    from pounding_cli.store.overview import Trust

FEW_POINTS = 8
"""Points of a sweep that are printed one by one; of more, the range is."""

MEANINGLESS = "!"
"""Stands beside every number that means nothing, because a scene behind it left the range of its model."""


@click.command("run", short_help="Run a study and print its summary.")
@click.argument("study", type=click.Path(path_type=Path))
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    metavar="FILE.h5",
    help="Results file; results/<study>.h5 in the current folder unless given.",
)
@click.option("-q", "--quiet", is_flag=True, help="Print nothing but scenes that failed.")
@click.option(
    "--workers",
    type=click.IntRange(min=1),
    metavar="N",
    help="Scenes solved side by side; all cores unless given.",
)
@click.option(
    "--engine",
    type=click.Choice(("serial", "threads", "processes", "dask")),
    default="processes",
    show_default=True,
    help="Where scenes are solved, with the same results; small studies are solved serially whatever it is.",
)
@click.option(
    "--scheduler",
    metavar="ADDRESS",
    help="Dask scheduler, e.g. tcp://node:8786, for --engine dask; a cluster on this machine unless given.",
)
@click.option("--all-effects", is_flag=True, help="Simulate what cannot matter too: a check of the pruning, slower.")
@click.option(
    "--replace",
    is_flag=True,
    help="Replace results of another study; leave out scenes and histories that STUDY does not have any more.",
)
@click.option("--log-json", is_flag=True, help="Print progress and outcome as JSON lines, and nothing else.")
@click.pass_context
def command(
    ctx: click.Context,
    study: Path,
    output: Path | None,
    quiet: bool,
    workers: int | None,
    engine: str,
    scheduler: str | None,
    all_effects: bool,
    replace: bool,
    log_json: bool,
) -> None:
    """Run STUDY, write one results file, print a summary.

    Scenes that an earlier run solved are reused, also after the study was changed, and the count is printed.
    A file that holds another study is refused unless --replace is said.
    After Ctrl-C, a crash or a full disk the same command continues from what was solved.
    Exit code 0: all scenes done; 1: some failed (they are listed); 2: the study or the output was refused.

    \b
    Example:
      pound run configs/fig6.yaml
      pound run configs/fig6.yaml -o results/fig6.h5 --workers 4
      pound run sweep.yaml --engine dask --scheduler tcp://node:8786
    """
    import dataclasses
    import gc

    _alone_on_its_core()
    gc.disable()  # what is imported stays: looking for garbage in it takes a fifteenth of a short run
    ctx.call_on_close(gc.enable)
    from pounding_cli.api import default_output, load_study
    from pounding_cli.batch.progress import JsonLines, chosen
    from pounding_cli.study import expand

    quiet = quiet or log_json
    log = JsonLines() if log_json else None
    loaded = load_study(study)
    for warning in loaded.warnings:
        if log:
            log.tell("warning", text=str(warning))
        elif not quiet:
            click.echo(f"warning: {warning}", err=True)
    plan = dataclasses.replace(expand(loaded), all_effects=all_effects)
    _numba_without_blas()  # only now: a study that is refused needs no numba
    from pounding_cli.batch import run_plan

    path = output or default_output(study)
    gc.freeze()
    gc.enable()
    outcome = run_plan(
        plan, path, progress=log or chosen(quiet), workers=workers, engine_name=engine, scheduler=scheduler,
        replace=replace,
    )  # fmt: skip
    if log:
        _log(log, outcome)
    elif not quiet:
        from pounding_cli.store import overview

        _print(overview(path), outcome)
    for failure in () if log else outcome.failures:
        click.echo(f"failed: {failure.place}: {failure.status}", err=True)
        if failure.advice:
            click.echo(f"    {failure.advice}", err=True)
    if outcome.failures:
        ctx.exit(1)


def _numba_without_blas() -> None:
    """Numba asks SciPy for its linear algebra when it starts, a tenth of a second for what no kernel uses. It is told
    that there is none, in this process alone; all others who ask SciPy get it. Where SciPy's is there already, nothing
    would be gained."""
    import sys

    name = "scipy.linalg.cython_blas"
    if name not in sys.modules and "numba" not in sys.modules:
        sys.modules[name] = None  # type: ignore[assignment]
        try:
            import numba.np.arraymath  # noqa: F401
        finally:
            del sys.modules[name]


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


def _print(found: Overview, outcome: Outcome) -> None:
    """The summary: mean ratios, motions, flags, counts, times."""
    from rich import box
    from rich.table import Table

    click.echo(found.title)
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("case", no_wrap=True)
    table.add_column("building", no_wrap=True)
    for analysis, ratio in found.ratios.items():
        table.add_column(f"{analysis}\n{ratio} at roof", justify="right")
        table.add_column("\nlargest (storey)", justify="right")
        if found.trust.assessed:
            table.add_column("\n± numerical", justify="right")
            table.add_column("\nsensitivity", justify="right")
    for case in dict.fromkeys(line.case for line in found.lines):
        lines = [line for line in found.lines if line.case == case]
        for place, building in enumerate(found.buildings):
            cells = []
            for line in lines:
                cells += [
                    _number(line.roof[place], line.meaningless),
                    _number(line.largest[place], line.meaningless, line.at[place]),
                ]
                if found.trust.assessed:
                    cells += [_worth(line.error[place], ".0e"), _worth(line.sensitivity[place], ".2g")]
            marked = f"{case} {MEANINGLESS}" if any(line.meaningless.any() for line in lines) else case
            table.add_row("" if place else marked, building, *cells, end_section=len(found.points) > 1)
    streams.echo_table(table)
    count = len(found.points)
    many = f" at {count} points of the sweep" if count > 1 else ""
    for number, point in enumerate(found.points if 1 < count <= FEW_POINTS else (), start=1):
        click.echo(f"Line {number}, {point}")
    motions = "; ".join(f"{source}: {', '.join(names)}" for source, names in found.motions.items())
    click.echo(f"Means over {counted(found.records, 'motion')}{many}.\nMotions, {motions}")
    _print_trust(found.trust)
    for sentence in found.unknown:
        click.echo(sentence)
    for group in found.flags:
        click.echo(f"{f'Meaningless ({MEANINGLESS})' if group.meaningless else 'Note'}: {group}")
    if found.spared:
        which = "scene, whose gaps never close" if found.spared == 1 else "scenes, whose gaps never close"
        click.echo(f"Not simulated: {found.spared} {which}; the buildings alone, or smaller groups, give the results")
    side = f", {outcome.workers} side by side" if outcome.workers > 1 else ""
    worthless = f", {counted(found.meaningless, 'row')} meaningless ({MEANINGLESS})" if found.meaningless else ""
    click.echo(
        f"Scenes: {outcome.done} solved, {outcome.reused} reused, {outcome.failed} failed{worthless}{side}; "
        f"solver {_time(outcome.solver_seconds)}, in all {_time(outcome.wall_seconds)}"
    )
    click.echo(f"Results: {outcome.path}")


def _print_trust(trust: Trust) -> None:
    """The error and the sensitivity of the numbers above, in words."""
    if trust.residual == trust.residual:
        click.echo(f"Energy closes to {trust.residual:.0e} of the input in every scene.")
    if not trust.assessed:
        click.echo("Errors and sensitivities were not estimated (estimate: none).")
        return
    of = "all" if trust.assessed == trust.scenes else f"{trust.assessed} of {trust.scenes}"
    click.echo(
        f"No peak has a numerical error above {trust.error:.0e} ({of} scenes assessed) or a sensitivity above "
        f"{trust.sensitivity:.2g} ({trust.where}).\nSensitivity 4: a motion that grows by 1 % on its way moves a peak "
        "by 4 %."
    )


def _worth(value: float, form: str) -> str:
    return f"{value:{form}}" if value == value else "-"


def _number(values: np.ndarray, meaningless: np.ndarray, at: np.ndarray | None = None) -> str:
    """One number a point of the sweep, or its range where there are many; those that mean nothing are marked."""
    shown = [
        (f"{value:.3f}" + (f" ({storey})" if at is not None else "") if value == value else "-")
        + (f" {MEANINGLESS}" if worthless else "")
        for value, storey, worthless in zip(values, values if at is None else at, meaningless, strict=True)
    ]
    if len(shown) <= FEW_POINTS:
        return "\n".join(shown)
    known = values[values == values]
    mark = f" {MEANINGLESS}" if meaningless.any() else ""
    return f"{known.min():.3f} to {known.max():.3f}{mark}" if known.size else "-"


def _time(seconds: float) -> str:
    if seconds < 1:
        return f"{1000 * seconds:.0f} ms"
    return f"{seconds:.1f} s" if seconds < 120 else f"{seconds / 60:.1f} min"
