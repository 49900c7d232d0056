"""The commands that solve a study: `pound run`, the questions, and the two models beside scenes."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pounding_cli.errors import InputError, Problem

if TYPE_CHECKING:
    from pounding_cli.api.running import Outcome
    from pounding_cli.batch.progress import JsonLines


def study_argument(command: Callable[..., Any]) -> Callable[..., Any]:
    """STUDY."""
    return click.argument("study", type=click.Path(path_type=Path))(command)


def output_option(default: str, text: str = "Results file.") -> Callable[..., Any]:
    """`-o FILE.h5`."""
    kind = click.Path(path_type=Path)
    return click.option("-o", "--output", type=kind, metavar="FILE.h5", help=f"{text} Default: {default}.")


def solving_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """How scenes are solved; keyword arguments of `solve_study`."""
    for option in (
        click.option("--log-json", is_flag=True, help="Print progress and outcome as JSON lines only."),
        click.option(
            "--replace", is_flag=True,
            help="Replace the results of another study; forget scenes and histories that STUDY no longer has.",
        ),
        click.option(
            "--scheduler", metavar="ADDRESS",
            help="Dask scheduler for --engine dask, e.g. tcp://node:8786. Default: a cluster on this machine.",
        ),
        click.option(
            "--engine", type=click.Choice(("threads", "processes", "dask", "serial")), default="threads",
            show_default=True,
            help="How scenes are solved; the results are the same. Small studies are always solved serially.",
        ),
        click.option(
            "--workers", type=click.IntRange(min=1), metavar="N",
            help="Number of scenes solved in parallel. Default: all cores.",
        ),
        click.option("-q", "--quiet", is_flag=True, help="Print only scenes that failed."),
        click.pass_context,
    ):  # fmt: skip
        command = option(command)
    return command


@click.command()
@study_argument
@output_option("results/<study>.h5 in the current folder")
@solving_options
def run(ctx: click.Context, **options: Any) -> None:
    """Run STUDY, write one results file and print a summary.

    The command reuses scenes of earlier runs, also after changes of the study, and prints their number. It refuses a
    file with the results of another study unless --replace is given. After Ctrl-C, a crash or a full disk, run the
    same command again to resume. Exit code 0: all scenes done; 1: some failed (they are listed);
    2: the study or the output was refused.

    \b
    Example:
      pound run configs/fig6.yaml
      pound run configs/fig6.yaml -o results/fig6.h5 --workers 4
      pound run sweep.yaml --engine dask --scheduler tcp://node:8786
    """
    solve_study(ctx, "run", **options)


@click.command()
@study_argument
@output_option("results/<study>-gap.h5 in the current folder")
@solving_options
def gap(ctx: click.Context, **options: Any) -> None:
    """Compute how wide the gap of STUDY must be, so that its buildings do not touch.

    Each building moves alone under every motion. The largest closing of two floors that face each other is the gap
    that this motion requires. The command prints statistics over the motions, the gap for a given probability of
    contact, and the gaps by the rules ABS, SRSS, DDC and those of codes. The section `gap:` of the study selects them;
    the default is mean, largest, 84th percentile and 10 % probability of contact.

    It then says for each case whether its gap is enough, by each rule and for how many motions, and how far each
    building moves to either side, which is its distance to a property line. The buildings move alone: links do not
    change what is required.

    After Ctrl-C, a crash or a full disk, run the same command again to resume.

    \b
    Example:
      pound gap study.yaml
      pound show results/study-gap.h5 gap_cases
      pound show results/study-gap.h5 property_line
      pound report results/study-gap.h5
    """
    solve_study(ctx, "gap", **options)


@click.command()
@study_argument
@output_option("results/<study>-fragility.h5 in the current folder")
@solving_options
def fragility(ctx: click.Context, **options: Any) -> None:
    """Compute how likely the limits of STUDY are passed over an intensity, for each building alone and
    with pounding.

    The section `fragility:` of the study has the limits (`mu > 4`, `drift > 2 %`, `acceleration > 1 g`,
    `shear_demand > 1`, `contact`, `collapse`), the section `sweep:` the intensities (`records.scale.pga`, `.sa`, `.pgv`
    or `records.scale`). By default each motion is scaled until it passes, and only the intensities needed for this are
    solved. The curves are lognormal, fitted by maximum likelihood, with bootstrap intervals over the motions.

    After Ctrl-C, a crash or a full disk, run the same command again to resume.
    Exit code 0: all scenes done; 1: some failed (they are listed); 2: the study or the output was refused.

    \b
    Example:
      pound fragility study.yaml
      pound show results/study-fragility.h5 fragility
      pound report results/study-fragility.h5
    """
    solve_study(ctx, "fragility", **options)


@click.command()
@study_argument
@output_option("results/<study>-sensitivity.h5 in the current folder")
@solving_options
def sensitivity(ctx: click.Context, **options: Any) -> None:
    """Compute how much each uncertain key of STUDY contributes to the variance of its results.

    The section `uncertain:` has the keys with their distributions; `motion: any` varies the motion too. The section
    `sensitivity:` has the outputs, e.g. `outputs: [largest mu in soft]`, or `claims: all` for the probability of the
    paper's statements. Quasi-random samples are solved like a sweep. Sobol indices give the part of the variance that
    each key explains; Morris indices screen many keys at low cost.

    A failed scene is solved again with a hundred times finer accuracy. If it fails again, its outputs get no index.
    After Ctrl-C, a crash or a full disk, run the same command again to resume.
    Exit code 0: all scenes done; 1: some failed (they are listed); 2: the study or the output was refused.

    \b
    Example:
      pound sensitivity study.yaml
      pound show results/study-sensitivity.h5 sensitivity
      pound report results/study-sensitivity.h5
    """
    solve_study(ctx, "sensitivity", **options)


@click.command()
@study_argument
@output_option("results/<study>-optimise.h5 in the current folder")
@click.option(
    "--write",
    type=click.Path(path_type=Path),
    metavar="FILE.yaml",
    help="Write STUDY with the best values, its comments kept. A file that is there is replaced only with --replace.",
)
@solving_options
def optimise(ctx: click.Context, study: Path, write: Path | None, **options: Any) -> None:
    """Minimise or maximise a number over chosen keys of STUDY.

    The section `optimise:` of the study has the number as an expression over the tables (`least:` or `most:`), and the
    keys with their ranges (`over:`). Differential evolution and the simplex method find the optimum. The command then
    solves points around it, to show how far each key may be from its best value, and says what the buildings do at the
    optimum and with the study as written: contacts, flags, shears, ductilities, drifts, accelerations.

    After Ctrl-C, a crash or a full disk, run the same command again to resume.
    Exit code 0: all scenes done; 1: some failed (they are listed), or no optimum was found to write; 2: the study or
    the output was refused.

    \b
    Example:
      pound optimise study.yaml --write best.yaml
      pound run best.yaml
      pound show results/study-optimise.h5 optimise
      pound report results/study-optimise.h5
    """
    if write is not None:
        _check_best(study, write, options["replace"])
    outcome = solve_study(ctx, "optimise", study=study, **options, ends=write is None)
    if write is not None:
        if not _write_best(study, outcome.path, write):
            click.echo(f"{write} is not written: there is no optimum", err=True)
            ctx.exit(1)
        if not (options["quiet"] or options["log_json"]):
            click.echo(f"Best study: {write}; simulate it with: pound run {write}")
        ctx.exit(1 if outcome.failures else 0)


def _check_best(study: Path, write: Path, replace: bool) -> None:
    """Make sure, before anything is solved, that the best study can be written.  Raises `InputError`."""
    from pounding_cli.outputs import check_output
    from pounding_cli.study import load_study
    from pounding_cli.workflows.optimise_question import check_written

    if write.suffix not in (".yaml", ".yml"):
        raise InputError(Problem("a study file ends in .yaml", f"write --write {write}.yaml", str(write)))
    loaded = load_study(study)
    check_output(write, [study], lambda *_: True, "--write")
    if os.path.exists(write) and not replace:
        raise InputError(Problem("is there already", "choose another name, or add --replace to replace it", str(write)))
    check_written(loaded, write)


def _write_best(study: Path, path: Path, write: Path) -> bool:
    """Write the study with the best values that a results file has; whether there are such.  Raises `InputError`."""
    from pounding_cli.api.studies import open_results
    from pounding_cli.study import load_study
    from pounding_cli.workflows.optimise import NOTHING, OPTIMUM
    from pounding_cli.workflows.optimise_question import question_of

    results = open_results(path)
    table, loaded = results.answer(OPTIMUM).frame, load_study(study)
    if loaded.text != results.study_text:
        hint = "run the command again"
        raise InputError(Problem("has changed while it was optimised: the best study is not written", hint, str(study)))
    if table["outcome"].iloc[0] == NOTHING:
        return False
    text = question_of(loaded).text(tuple(table["place"].tolist()))
    try:
        write.write_text(text, encoding="utf-8", newline="")
    except OSError as error:
        hint = "choose a place that can be written, and run the command again"
        raise InputError(Problem(f"cannot be written: {error.strerror or error}", hint, str(write))) from None
    return True


def solve_study(
    ctx: click.Context,
    workflow: str,
    study: Path,
    output: Path | None,
    quiet: bool,
    workers: int | None,
    engine: str,
    scheduler: str | None,
    replace: bool,
    log_json: bool,
    ends: bool = True,
) -> Outcome:
    """Load a study, solve what its workflow asks for, write the results file and print what came out.

    ends : whether failed scenes, which are listed, end the command with exit code 1
    """
    _alone_on_its_core()
    from pounding_cli.api.running import question, run_study
    from pounding_cli.api.studies import default_output
    from pounding_cli.batch.progress import JsonLines, chosen
    from pounding_cli.study import load_study

    log = JsonLines() if log_json else None
    loaded = load_study(study)
    for warning in loaded.warnings:
        if log:
            log.tell("warning", text=str(warning))
        elif not quiet:
            click.echo(f"warning: {warning}", err=True)
    outcome = run_study(
        loaded, question(workflow), output or default_output(study, workflow), progress=log or chosen(quiet),
        workers=workers, engine=engine, scheduler=scheduler, replace=replace,
    )  # fmt: skip
    if log:
        _log(log, outcome)
    elif not quiet:
        _print(outcome)
    for failure in () if log else outcome.failures:
        click.echo(f"failed: {failure.place}: {failure.status}", err=True)
        if failure.advice:
            click.echo(f"    {failure.advice}", err=True)
    if outcome.failures and ends:
        ctx.exit(1)
    return outcome


def _alone_on_its_core() -> None:
    """Linear algebra in one thread: scenes are solved side by side, and their matrices are small. SIGTERM, which batch
    systems send when time is up, stops a run as Ctrl-C does."""
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
    seconds = {"solver_seconds": round(outcome.solver_seconds, 3), "wall_seconds": round(outcome.wall_seconds, 3)}
    log.tell(
        "end", done=outcome.done, failed=outcome.failed, reused=outcome.reused, results=str(outcome.path),
        engine=outcome.engine, workers=outcome.workers, **seconds,
    )  # fmt: skip


def _print(outcome: Outcome) -> None:
    """What the results file says, and what it took."""
    from pounding_cli.api.studies import open_results
    from pounding_cli.report import report

    report(open_results(outcome.path)).print()
    side = f", {outcome.workers} side by side" if outcome.workers > 1 else ""
    click.echo(
        f"Scenes: {outcome.done} solved, {outcome.reused} reused, {outcome.failed} failed{side}; "
        f"solver {time_text(outcome.solver_seconds)}, in all {time_text(outcome.wall_seconds)}\nResults: {outcome.path}"
    )


def time_text(seconds: float) -> str:
    """A time [s] for people: "12 ms", "3.4 s", "5.0 min"."""
    if seconds < 1:
        return f"{1000 * seconds:.0f} ms"
    return f"{seconds:.1f} s" if seconds < 120 else f"{seconds / 60:.1f} min"


def points_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """What `pound connector` and `pound wall` take; keyword arguments of `solve_points`."""
    text = "Results file; tables, figures and page stand in a folder of its name."
    quiet = click.option("-q", "--quiet", is_flag=True, help="Print only points that failed.")
    return study_argument(output_option("results/<study>.h5", text)(quiet(click.pass_context(command))))


@click.command()
@points_options
def connector(ctx: click.Context, **options: Any) -> None:
    """Compute how a spring (and dashpot) between two oscillators changes their largest displacements.

    The command prints the peak ratios with their frequencies, and writes FILE.h5 and a folder with tables, figure and
    page.

    \b
    Example:
      pound connector configs/fig5.yaml -o results/fig5.h5
    """
    solve_points(ctx, "connector", **options)


@click.command()
@points_options
def wall(ctx: click.Context, **options: Any) -> None:
    """Compute the impact of a floor on the bumper wall of a concrete building: force, separation, stresses.

    The command prints peak force and stresses, and writes FILE.h5 and a folder with tables, figures and page.

    \b
    Example:
      pound wall configs/fig8.yaml -o results/fig8.h5
    """
    solve_points(ctx, "wall", **options)


def solve_points(ctx: click.Context, name: str, study: Path, output: Path | None, quiet: bool) -> None:
    """Solve the points of a study one after the other, write results, tables and page, and print what came out."""
    from pounding_cli.outputs import check_folder, check_output
    from pounding_cli.points import load, solved, write

    sweep = load(study, name)
    file = output or Path("results", f"{study.stem}.h5")
    file = file if file.suffix else file.with_suffix(".h5")
    check_output(file, mine=lambda _, head: head.startswith(b"\x89HDF"))
    check_folder(file.with_suffix(""))
    for warning in sweep.warnings:
        click.echo(f"warning: {warning}", err=True)
    with click.progressbar(sweep.points, file=sys.stderr, hidden=quiet or not sys.stderr.isatty()) as waiting:
        points = [solved(sweep, point) for point in waiting]
    report, files = write(sweep, points, file)
    failed = [point for point in points if point.data["status"] != "done"]
    if not quiet:
        report.print()
        click.echo(f"Points: {len(points) - len(failed)} solved, {len(failed)} failed")
        click.echo(f"Results: {files[0]}\nPage: {files[-1]}")
    for point in failed:
        status, (hint, *_) = point.data["status"].item(), point.data.attrs["notes"]
        click.echo(f"failed: {point.label or 'the study'}: {status}: {hint}", err=True)
    if failed:
        ctx.exit(1)
