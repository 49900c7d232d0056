"""The commands that solve a study: `pound run`, the questions, the two models beside scenes, `pound accuracy`."""

from __future__ import annotations

import math
import os
import shlex
import signal
import sys
import threading
from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import click

from pounding_cli.cli.options import FILE, output_option, quiet_option, seconds, study_argument, together
from pounding_cli.errors import InputError, Problem
from pounding_cli.numbers import format_duration, pluralize
from pounding_cli.questions import TITLES

if TYPE_CHECKING:
    from pounding_cli.api.running import RunOutcome
    from pounding_cli.batch.progress import JsonLines
    from pounding_cli.questions.optimise.optimum import Optimise
    from pounding_cli.solver.work_precision import Subject
    from pounding_cli.study import Study

solving_options = together(
    quiet_option,
    click.option(
        "--workers", type=click.IntRange(min=1), metavar="N",
        help="Number of time histories solved in parallel. Default: all cores.",
    ),
    click.option(
        "--engine", type=click.Choice(("threads", "processes", "dask", "serial")), default="threads",
        show_default=True,
        help="How time histories are solved; the results are the same. Small studies are always solved serially.",
    ),
    click.option(
        "--scheduler", metavar="ADDRESS",
        help="Dask scheduler for --engine dask, e.g. tcp://node:8786. Default: a cluster on this machine.",
    ),
    click.option(
        "--replace", is_flag=True,
        help="Replace the results of another study; forget what STUDY no longer has.",
    ),
    click.option("--log-json", is_flag=True, help="Print progress and outcome as JSON lines only."),
)  # fmt: skip
"""Options of solving; keyword arguments of `solve_study`."""

_FURTHER_OPTIONS: dict[str, tuple[Callable[..., Any], ...]] = {
    "optimise": (
        click.option(
            "--write",
            type=FILE,
            metavar="FILE.yaml",
            help="Write STUDY with the best values, its comments kept; replaced only with --replace.",
        ),
    ),
}
"""Options of single questions, besides those of all."""

_HELP = """{title}{about}

Time histories of earlier runs are reused, also after changes of the study. After Ctrl-C, a crash or a full disk, run
the same command again to resume. Exit code 0: all done; 1: some failed; 2: the study or the output was refused.

\b
Example:
  pound {name} study.yaml
"""


def build_question_command(name: str) -> click.Command:
    """Return the command of a question."""
    about = "" if name == "run" else f" The section `{name}:` of STUDY says what is asked (docs/how-to/{name}.md)."

    @click.command(name, help=_HELP.format(title=TITLES[name], about=about, name=name))
    @study_argument
    @output_option("results/STUDY.h5" if name == "run" else f"results/STUDY-{name}.h5")
    @together(*_FURTHER_OPTIONS.get(name, ()), solving_options, click.pass_context)
    def command(ctx: click.Context, **options: Any) -> None:
        if not solve_study(name, **options):
            ctx.exit(1)

    return command


def solve_study(
    name: str, study: Path, output: Path | None, quiet: bool, log_json: bool, write: Path | None = None, **how: Any
) -> bool:
    """Load a study, ask the question of that name, write the results file and print what came out.

    write : where the study with the best values goes
    how : keyword arguments of `api.running.run_study`

    Returns whether every scene was solved and everything was written.
    """
    # Linear algebra in one thread: scenes are solved side by side, and their matrices are small.
    for library in ("OPENBLAS", "OMP", "MKL", "NUMEXPR", "VECLIB_MAXIMUM"):
        os.environ.setdefault(f"{library}_NUM_THREADS", "1")
    if threading.current_thread() is threading.main_thread():  # batch systems send SIGTERM when time is up
        signal.signal(signal.SIGTERM, signal.default_int_handler)
    from pounding_cli.api.running import ask_question, run_study, summarize
    from pounding_cli.api.studies import default_output, load_study
    from pounding_cli.batch.progress import JsonLines, choose_progress

    log = JsonLines() if log_json else None
    loaded = load_study(study)
    for warning in loaded.warnings:
        if log:
            log.write_event("warning", text=str(warning))
        elif not quiet:
            click.echo(f"warning: {warning}", err=True)
    asked = ask_question(name, loaded)
    if write is not None:
        _check_best(cast("Optimise", asked), write, how["replace"])
    outcome = run_study(asked, output or default_output(study, name), progress=log or choose_progress(quiet), **how)
    if log:
        _log_outcome(log, outcome)
    else:
        if not quiet:
            summarize(outcome).print()
        _print_outcome(outcome, quiet)
    is_written = write is None or _write_best(cast("Optimise", asked), outcome, write)
    if not is_written:
        click.echo(f"{write} is not written: there is no optimum", err=True)
    elif write is not None and not (quiet or log):
        click.echo(f"Best study: {write}; simulate it with: pound run {write}")
    return is_written and not outcome.failures


def _print_outcome(outcome: RunOutcome, quiet: bool) -> None:
    """Print counts and times, unless `quiet`, and every scene that failed."""
    if not quiet:
        side = f", {outcome.workers} side by side" if outcome.workers > 1 else ""
        click.echo(
            f"Time histories: {outcome.done} solved, {outcome.reused} reused, {outcome.failed} failed{side}; "
            f"solver {format_duration(outcome.solver_seconds)}, in all {format_duration(outcome.wall_seconds)}\n"
            f"Results: {outcome.path}"
        )
    _print_failures(outcome.failures)


def _print_failures(failures: Iterable[tuple[str, str, str]]) -> None:
    """Print for every failure its place, what happened, and what to do about it."""
    for place, status, advice in failures:
        click.echo(f"failed: {place}: {status}" + (f"\n    {advice}" if advice else ""), err=True)


def _log_outcome(log: JsonLines, outcome: RunOutcome) -> None:
    """Write the outcome as JSON lines."""
    for failure in outcome.failures:
        log.write_event("failed", scene=failure.place, status=failure.status, advice=failure.advice)
    log.write_event(
        "end", done=outcome.done, failed=outcome.failed, reused=outcome.reused, results=str(outcome.path),
        engine=outcome.engine, workers=outcome.workers, solver_seconds=round(outcome.solver_seconds, 3),
        wall_seconds=round(outcome.wall_seconds, 3),
    )  # fmt: skip


def _check_best(asked: Optimise, write: Path, replace: bool) -> None:
    """Make sure, before anything is solved, that the best study can be written.  Raises `InputError`."""
    from pounding_cli.outputs import check_output

    study = asked.study.path
    if write.suffix not in (".yaml", ".yml"):
        raise InputError(Problem("a study file ends in .yaml", f"write --write {write}.yaml", str(write)))
    if write.parent.resolve() != study.parent.resolve():
        hint = "write it beside the study: motions are sought there"
        raise InputError(Problem("the study would not run from another folder", hint, str(write)))
    check_output(write, [study], lambda *_: True, "--write")
    if write.exists() and not replace:
        raise InputError(Problem("is there already", "choose another name, or add --replace to replace it", str(write)))
    asked.format_study(asked.middle)  # refused where the text does not take other values


def _write_best(asked: Optimise, outcome: RunOutcome, write: Path) -> bool:
    """Write the study with the best values that the results have; return whether there are such."""
    from pounding_cli.api.studies import open_results
    from pounding_cli.questions.optimise.optimum import NOTHING
    from pounding_cli.questions.optimise.tables import OPTIMUM

    results = outcome.results or open_results(outcome.path)
    table = results.answer(OPTIMUM).frame
    if table["outcome"].iloc[0] == NOTHING:
        return False
    write.write_text(asked.format_study(tuple(table["place"].tolist())), encoding="utf-8", newline="")
    return True


def _points(name: str, about: str, example: str) -> click.Command:
    """The command of a model beside scenes: the points of a study one after the other."""

    @click.command(name, help=f"{about}\n\n\b\nExample:\n  pound {name} {example}\n")
    @study_argument
    @output_option("results/STUDY.h5", "Results file; tables, figures and page stand in a folder of its name.")
    @quiet_option
    @click.pass_context
    def command(ctx: click.Context, study: Path, output: Path | None, quiet: bool) -> None:
        from pounding_cli.outputs import check_folder, check_output
        from pounding_cli.paper.points import build_dataset, build_report, is_written_by, load_sweep, solve_point
        from pounding_cli.results.arrays import ResultArrays
        from pounding_cli.results.file import write_results
        from pounding_cli.solver.response import DONE

        sweep = load_sweep(study, name)
        for warning in sweep.warnings:
            click.echo(f"warning: {warning}", err=True)
        file = output or Path("results", f"{study.stem}.h5")
        file = file if file.suffix else file.with_suffix(".h5")
        check_output(file, [study], lambda place, _: is_written_by(name, place))
        check_folder(file.with_suffix(""))
        with click.progressbar(sweep.points, file=sys.stderr, hidden=quiet or not sys.stderr.isatty()) as waiting:
            sweep = replace(sweep, points=tuple(solve_point(sweep, point) for point in waiting))
        write_results(file, ResultArrays.from_dataset(build_dataset(sweep)))
        found, failed = build_report(sweep), [point for point in sweep.points if point.status != DONE]
        (*_, page) = found.save(file.with_suffix(""))
        if not quiet:
            found.print()
            click.echo(f"Points: {len(sweep.points) - len(failed)} solved, {len(failed)} failed")
            click.echo(f"Results: {file}\nPage, with all numbers: {page}")
        _print_failures((point.label or "the study", point.status, point.advice) for point in failed)
        if failed:
            ctx.exit(1)

    return command


connector = _points(
    "connector",
    "Compute how a spring and a dashpot between two oscillators change their largest displacements.",
    "configs/fig5.yaml",
)
wall = _points(
    "wall",
    "Compute the impact of a floor on the bumper wall of a concrete building: force, separation, stresses.",
    "configs/fig8.yaml",
)


def _names(ctx: click.Context, param: click.Parameter, text: str) -> list[str]:
    return [name.strip() for name in text.split(",") if name.strip()]


@click.command()
@study_argument
@click.option("--methods", metavar="NAME,...", default="", callback=_names, help="Methods to compare. Default: all.")
@click.option("--cases", metavar="NAME,...", default="", callback=_names, help="Cases to run. Default: all.")
@click.option("--records", metavar="NAME,...", default="", callback=_names, help="Motions to use. Default: all.")
@click.option("--budget", type=seconds, default="60 s", show_default=True, help="Time for the runs, uncompiled.")
@click.option("-o", "--output", type=FILE, metavar="DIR", help="Folder. Default: results/STUDY-accuracy.")
@click.option("-q", "--quiet", is_flag=True, help="Print only what to use.")
def accuracy(
    study: Path, methods: list[str], cases: list[str], records: list[str], budget: float, output: Path | None,
    quiet: bool,
) -> None:  # fmt: skip
    """Measure what accuracy costs by every method on time histories of STUDY, at the first point of its sweep. Write a
    page, a table of all runs and diagrams (docs/accuracy.md).

    \b
    Example:
      pound accuracy configs/fig6.yaml --methods taylor,dop853,newmark --budget 90s
    """
    from pounding_cli.api.studies import load_study
    from pounding_cli.outputs import check_folder
    from pounding_cli.questions.accuracy.report import accuracy_report
    from pounding_cli.solver.work_precision import chosen, measure

    names = chosen(methods)
    loaded = load_study(study)
    subjects = _subjects(loaded, cases, records)
    folder = output or Path("results") / f"{study.stem}-accuracy"
    check_folder(folder)
    tell = (lambda text: None) if quiet else (lambda text: click.echo(f"  {text}", err=True))
    repeat = shlex.join(["pound", *sys.argv[1:]])
    report = accuracy_report(measure(subjects, names, budget, tell), loaded.title, repeat)
    files = report.save(folder)
    if quiet:
        click.echo("\n".join(report.answer.sentences))
    else:
        report.print()
        click.echo(f"Wrote {files[-1]}: {pluralize(len(files), 'file')}")


def _subjects(study: Study, cases: list[str], records: list[str]) -> list[Subject]:
    """The linked scenes of the study's first point, each once.  Raises `InputError` for names that it does not have."""
    from pounding_cli.study import make_plan

    plan = make_plan(study)
    for what, wanted, known in (("case", cases, plan.cases), ("record", records, plan.records)):
        for name in set(wanted) - set(known):
            raise InputError(Problem(f"the study has no {what} {name}", f"write one of {', '.join(known)}"))
    return [
        ({"case": row.case, "analysis": row.analysis, "record": row.record}, plan.scene(row.scene))
        for row in map(plan.row, range(math.prod(plan.shape[-3:])))
        if row.case in (cases or plan.cases) and row.record in (records or plan.records)
    ]
