"""The commands that solve a study: `pound run`, the questions, the two models beside scenes, `pound accuracy`."""

from __future__ import annotations

import math
import os
import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pounding_cli.cli.options import FILE, Time, output_option, quiet_option, study_argument, together
from pounding_cli.errors import InputError, Problem
from pounding_cli.numbers import counted, time_text

if TYPE_CHECKING:
    from pounding_cli.api.running import Outcome
    from pounding_cli.batch.progress import JsonLines
    from pounding_cli.solver.work_precision import Subject
    from pounding_cli.study import Study

solving_options = together(
    quiet_option,
    click.option(
        "--workers", type=click.IntRange(min=1), metavar="N",
        help="Number of scenes solved in parallel. Default: all cores.",
    ),
    click.option(
        "--engine", type=click.Choice(("threads", "processes", "dask", "serial")), default="threads",
        show_default=True,
        help="How scenes are solved; the results are the same. Small studies are always solved serially.",
    ),
    click.option(
        "--scheduler", metavar="ADDRESS",
        help="Dask scheduler for --engine dask, e.g. tcp://node:8786. Default: a cluster on this machine.",
    ),
    click.option(
        "--replace", is_flag=True,
        help="Replace the results of another study; forget scenes and histories that STUDY no longer has.",
    ),
    click.option("--log-json", is_flag=True, help="Print progress and outcome as JSON lines only."),
    click.pass_context,
)  # fmt: skip
"""How scenes are solved; keyword arguments of `solve_study`."""

_HELP = {
    "run": "Run STUDY, write one results file and print a summary.",
    "gap": "Compute how wide the gap of STUDY must be, so that its buildings do not touch; its section `gap:` has the "
    "rules. Each building moves alone under every motion. See docs/how-to/gap.md.",
    "fragility": "Compute how likely the limits of STUDY are passed over an intensity, for each building alone and "
    "with pounding; its section `fragility:` has the limits. See docs/how-to/fragility.md.",
    "sensitivity": "Compute how much each uncertain key of STUDY contributes to the variance of its results, or how "
    "likely statements hold; its sections `uncertain:` and `sensitivity:` have keys and outputs. See "
    "docs/how-to/sensitivity.md.",
    "optimise": "Minimise or maximise a number over chosen keys of STUDY; its section `optimise:` has both. See "
    "docs/how-to/optimise.md.",
}

_ENDS = """\


Scenes of earlier runs are reused, also after changes of the study. A file with the results of another study is refused
unless --replace is given. After Ctrl-C, a crash or a full disk, run the same command again to resume.
Exit code 0: all scenes done; 1: some failed (they are listed); 2: the study or the output was refused.

\b
Example:
  pound {command} study.yaml
  pound report {results}
"""


def _question(name: str) -> click.Command:
    """The command of a question."""
    results = "results/study.h5" if name == "run" else f"results/study-{name}.h5"

    @click.command(name, help=_HELP[name] + _ENDS.format(command=name, results=results))
    @study_argument
    @output_option(results.replace("study", "STUDY"))
    @solving_options
    def command(ctx: click.Context, **options: Any) -> None:
        if solve_study(ctx, name, **options).failures:
            ctx.exit(1)

    return command


run, gap, fragility, sensitivity = map(_question, ("run", "gap", "fragility", "sensitivity"))


@click.command(
    help=_HELP["optimise"]
    + _ENDS.format(command="optimise", results="results/study-optimise.h5")
    + "  pound optimise study.yaml --write best.yaml\n"
)
@study_argument
@output_option("results/STUDY-optimise.h5")
@click.option(
    "--write", type=FILE, metavar="FILE.yaml",
    help="Write STUDY with the best values, its comments kept. A file that is there is replaced only with --replace.",
)  # fmt: skip
@solving_options
def optimise(ctx: click.Context, study: Path, write: Path | None, **options: Any) -> None:  # fmt: skip
    if write is not None:
        _check_best(study, write, options["replace"])
    outcome = solve_study(ctx, "optimise", study=study, **options)
    if write is not None:
        if not _write_best(study, outcome.path, write):
            click.echo(f"{write} is not written: there is no optimum", err=True)
            ctx.exit(1)
        if not (options["quiet"] or options["log_json"]):
            click.echo(f"Best study: {write}; simulate it with: pound run {write}")
    if outcome.failures:
        ctx.exit(1)


def _check_best(study: Path, write: Path, replace: bool) -> None:
    """Make sure, before anything is solved, that the best study can be written.  Raises `InputError`."""
    from pounding_cli.outputs import check_output
    from pounding_cli.study import load_study
    from pounding_cli.workflows.optimise import check_written

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
    from pounding_cli.workflows.optimise import NOTHING, OPTIMUM, question_of

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
    ctx: click.Context, workflow: str, study: Path, output: Path | None, quiet: bool, workers: int | None, engine: str,
    scheduler: str | None, replace: bool, log_json: bool,
) -> Outcome:  # fmt: skip
    """Load a study, solve what its workflow asks for, write the results file and print what came out."""
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
        return outcome
    if not quiet:
        _print(outcome)
    for failure in outcome.failures:
        click.echo(f"failed: {failure.place}: {failure.status}", err=True)
        if failure.advice:
            click.echo(f"    {failure.advice}", err=True)
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


points_options = together(
    study_argument,
    output_option("results/STUDY.h5", "Results file; tables, figures and page stand in a folder of its name."),
    quiet_option,
    click.pass_context,
)
"""What `pound connector` and `pound wall` take; keyword arguments of `solve_points`."""


@click.command()
@points_options
def connector(ctx: click.Context, **options: Any) -> None:
    """Compute how a spring (and dashpot) between two oscillators changes their largest displacements.

    \b
    Example:
      pound connector configs/fig5.yaml -o results/fig5.h5
    """
    solve_points(ctx, "connector", **options)


@click.command()
@points_options
def wall(ctx: click.Context, **options: Any) -> None:
    """Compute the impact of a floor on the bumper wall of a concrete building: force, separation, stresses.

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


def _names(ctx: click.Context, param: click.Parameter, text: str) -> list[str]:
    return [name.strip() for name in text.split(",") if name.strip()]


@click.command()
@study_argument
@click.option("--methods", metavar="NAME,...", default="", callback=_names, help="Methods to compare. Default: all.")
@click.option("--cases", metavar="NAME,...", default="", callback=_names, help="Cases to run. Default: all.")
@click.option("--records", metavar="NAME,...", default="", callback=_names, help="Motions to use. Default: all.")
@click.option("--budget", type=Time(), default="60 s", show_default=True, help="Time for the runs, uncompiled.")
@click.option("-o", "--output", type=FILE, metavar="DIR",
              help="Folder. Default: results/STUDY-accuracy.")  # fmt: skip
@click.option("-q", "--quiet", is_flag=True, help="Print the result only.")
def accuracy(
    study: Path, methods: list[str], cases: list[str], records: list[str], budget: float, output: Path | None,
    quiet: bool,
) -> None:  # fmt: skip
    """Measure what accuracy costs on the scenes of STUDY.

    Every method runs every scene of the first point of the sweep at several settings, and is compared with a reference.
    The command writes report.html, tables/accuracy.csv (every run) and the diagrams. See docs/accuracy.md.

    \b
    Example:
      pound accuracy configs/fig6.yaml
      pound accuracy configs/fig6.yaml --methods taylor,dop853,newmark --budget 90s
    """
    from pounding_cli.api.studies import load_study
    from pounding_cli.outputs import check_folder
    from pounding_cli.report.accuracy import accuracy_report
    from pounding_cli.solver.work_precision import chosen, measure

    names = chosen(methods)
    folder = output or Path("results") / f"{study.stem}-accuracy"
    check_folder(folder)
    loaded = load_study(study)
    subjects = _subjects(loaded, cases, records)
    tell = (lambda text: None) if quiet else (lambda text: click.echo(f"  {text}", err=True))
    words = ["pound", "accuracy", str(study), "--budget", f"{budget:g} s"]
    for option, values in (("--methods", methods), ("--cases", cases), ("--records", records)):
        words += [option, ",".join(values)] if values else []
    report = accuracy_report(measure(subjects, names, budget, tell), loaded.title, shlex.join(words))
    files = report.save(folder, ("png", "svg"))
    if quiet:
        click.echo("\n".join(report.answer.sentences))
    else:
        report.print()
        click.echo(f"Wrote {files[-1]}: {counted(len(files), 'file')}")


def _subjects(study: Study, cases: list[str], records: list[str]) -> list[Subject]:
    """The linked scenes of the study's first point, each once.  Raises `InputError` for names that it does not have."""
    from pounding_cli.study import expand

    plan = expand(study)
    problems = [
        Problem(f"the study has no {what} {name}", f"write one of {', '.join(known)}")
        for what, wanted, known in (("case", cases, plan.cases), ("record", records, plan.records))
        for name in wanted
        if name not in known
    ]
    if problems:
        raise InputError(problems)
    return [
        ({"case": row.case, "analysis": row.analysis, "record": row.record}, plan.scene(row.scene))
        for row in map(plan.row, range(math.prod(plan.shape[-3:])))
        if row.case in (cases or plan.cases) and row.record in (records or plan.records)
    ]
