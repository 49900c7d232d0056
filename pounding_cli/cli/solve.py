"""The commands that solve time histories of a study: `pound run` and the questions."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import click

from pounding_cli.cli.options import (
    CHANGES_HELP,
    FILE,
    output_option,
    print_failures,
    quiet_option,
    study_argument,
    together,
)
from pounding_cli.cli.taken import describe_taken_files
from pounding_cli.errors import InputError, Issue
from pounding_cli.numbers import format_duration, pluralize
from pounding_cli.questions import TITLES
from pounding_cli.texts import escape_controls

if TYPE_CHECKING:
    from pounding_cli.api.running import RunOutcome
    from pounding_cli.batch.progress import JsonLines
    from pounding_cli.questions.optimise.question import Optimise
    from pounding_cli.questions.question import StudyQuestion
    from pounding_cli.study.vary.changes import Change

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

{changes}

Time histories of earlier runs are reused, also after changes of the study. After Ctrl-C, a crash or a full disk, run
the same command again to resume. Exit code 0: all done; 1: some failed; 2: the study or the output was refused.

\b
Example:
  pound {name} study.yaml
"""


def build_question_command(name: str) -> click.Command:
    """Return the command of a question."""
    about = "" if name == "run" else f" The section `{name}:` of STUDY says what is asked (docs/how-to/{name}.md)."

    @click.command(name, help=_HELP.format(title=TITLES[name], about=about, name=name, changes=CHANGES_HELP))
    @study_argument
    @output_option("results/STUDY.h5" if name == "run" else f"results/STUDY-{name}.h5")
    @together(*_FURTHER_OPTIONS.get(name, ()), solving_options, click.pass_context)
    def command(ctx: click.Context, **options: Any) -> None:
        if not solve_study(name, **options):
            ctx.exit(1)

    return command


def solve_study(
    name: str,
    study: Path,
    changes: tuple[Change, ...],
    output: Path | None,
    quiet: bool,
    log_json: bool,
    write: Path | None = None,
    **how: Any,
) -> bool:
    """Load a study, ask the question of that name, write the results file and print what came out.

    changes : values in place of those of the study
    write : where the study with the best values goes
    how : keyword arguments of `api.running.run_study`

    Returns whether every scene was solved and everything was written.
    """
    from pounding_cli.api.studies import default_output, load_study
    from pounding_cli.batch.progress import JsonLines
    from pounding_cli.questions import load_question

    log = JsonLines() if log_json else None
    loaded = load_study(study, changes)
    for warning in loaded.warnings:
        if log:
            log.write_event("warning", text=str(warning))
        elif not quiet:
            click.echo(f"warning: {warning}", err=True)
    print_taken(describe_taken_files(loaded), quiet, log)
    asked = load_question(name).ask(loaded)
    print_taken(asked.taken, quiet, log)
    if write is not None:
        _check_best(cast("Optimise", asked), write, how["replace"])
    path = output or default_output(study, name, changes)
    outcome = _run_question(asked, path, quiet, log, **how)
    is_written = write is None or _write_best(cast("Optimise", asked), outcome, write)
    if not is_written:
        click.echo(f"{write} is not written: there is no optimum", err=True)
    elif write is not None and not (quiet or log):
        click.echo(f"Best study: {write}; simulate it with: pound run {write}")
    return is_written and not outcome.failures


def print_taken(taken: Iterable[str], quiet: bool, log: JsonLines | None) -> None:
    """Print or log what was taken of files, a sentence each."""
    for sentence in taken:
        if log:
            log.write_event("note", text=sentence)
        elif not quiet:
            click.echo(escape_controls(sentence), err=True)


def answer_question(asked: StudyQuestion, path: Path, quiet: bool, log_json: bool, **how: Any) -> bool:
    """Answer a question, write the results file and print what came out.

    how : keyword arguments of `api.running.run_study`

    Returns whether every scene was solved.
    """
    from pounding_cli.batch.progress import JsonLines

    return not _run_question(asked, path, quiet, JsonLines() if log_json else None, **how).failures


def _run_question(asked: StudyQuestion, path: Path, quiet: bool, log: JsonLines | None, **how: Any) -> RunOutcome:
    """Answer a question, write the results file and print or log what came out; return the outcome."""
    from pounding_cli.api.running import run_study, summarize
    from pounding_cli.batch.progress import choose_progress

    outcome = run_study(asked, path, progress=log or choose_progress(quiet), **how)
    if log:
        _log_outcome(log, outcome)
    else:
        if not quiet:
            summarize(outcome).print()
        _print_outcome(outcome, quiet)
    return outcome


def _print_outcome(outcome: RunOutcome, quiet: bool) -> None:
    """Print counts and times, unless `quiet`, and every scene that failed."""
    if not quiet:
        side = f", {outcome.workers} side by side" if outcome.workers > 1 else ""
        by_parts = ""
        if outcome.divided:
            parts = f" ({pluralize(outcome.parts, 'part')} solved)" if outcome.parts else ""
            by_parts = f", {outcome.divided} of them by parts that nothing links{parts}"
        click.echo(
            f"Time histories: {outcome.done} solved{by_parts}, {outcome.reused} reused, {outcome.failed} failed{side}; "
            f"solver {format_duration(outcome.solver_seconds)}, in all {format_duration(outcome.wall_seconds)}\n"
            f"Results: {outcome.path}"
        )
    print_failures(outcome.failures)


def _log_outcome(log: JsonLines, outcome: RunOutcome) -> None:
    """Write the outcome as JSON lines."""
    for failure in outcome.failures:
        log.write_event("failed", scene=failure.place, status=failure.status, advice=failure.advice)
    log.write_event(
        "end", done=outcome.done, failed=outcome.failed, reused=outcome.reused, results=str(outcome.path),
        divided=outcome.divided, parts=outcome.parts,
        engine=outcome.engine, workers=outcome.workers, solver_seconds=round(outcome.solver_seconds, 3),
        wall_seconds=round(outcome.wall_seconds, 3),
    )  # fmt: skip


def _check_best(asked: Optimise, write: Path, replace: bool) -> None:
    """Make sure, before anything is solved, that the best study can be written.  Raises `InputError`."""
    from pounding_cli.outputs import check_output

    study = asked.study.path
    if write.suffix not in (".yaml", ".yml"):
        raise InputError(Issue((), "a study file ends in .yaml", f"write --write {write}.yaml", file=str(write)))
    if write.parent.resolve() != study.parent.resolve():
        hint = "write it beside the study: motions are sought there"
        raise InputError(Issue((), "the study would not run from another folder", hint, file=str(write)))
    check_output(write, [study], lambda *_: True, "--write")
    if write.exists() and not replace:
        raise InputError(
            Issue((), "is there already", "choose another name, or add --replace to replace it", file=str(write))
        )
    asked.format_study(asked.middle)  # refused where the text does not take other values


def _write_best(asked: Optimise, outcome: RunOutcome, write: Path) -> bool:
    """Write the study with the best values that the results have; return whether there are such."""
    from pounding_cli.api.studies import open_results
    from pounding_cli.questions.optimise.question import NO_OPTIMUM
    from pounding_cli.questions.optimise.tables import OPTIMUM

    results = outcome.results or open_results(outcome.path)
    table = results.answer(OPTIMUM).frame
    if table["outcome"].iloc[0] in NO_OPTIMUM:
        return False
    write.write_text(asked.format_study(tuple(table["place"].tolist())), encoding="utf-8", newline="")
    return True
