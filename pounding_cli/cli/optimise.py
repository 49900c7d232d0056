"""`pound optimise`: what is best."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import click

from pounding_cli.cli.answering import print_answer
from pounding_cli.cli.solving import Solving, output_option, solve_study, solving_options
from pounding_cli.errors import InputError, Problem
from pounding_cli.outputs import check_output
from pounding_cli.workflows import TITLES


@click.command("optimise", short_help=TITLES["optimise"])
@click.argument("study", type=click.Path(path_type=Path))
@output_option("results/<study>-optimise.h5")
@click.option(
    "--write",
    type=click.Path(path_type=Path),
    metavar="FILE.yaml",
    help="Write STUDY with the best values, its comments kept. A file that is there is replaced only with --replace.",
)
@solving_options
@click.pass_context
def command(ctx: click.Context, study: Path, output: Path | None, write: Path | None, **options: Any) -> None:
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
    how = Solving(**options)
    if write is not None:
        _check(study, write, how.replace)

    def after(path: Path) -> None:
        if write is not None:
            _write(ctx, study, path, write, not (how.quiet or how.log_json))

    solve_study(ctx, "optimise", study, output, how, print_answer, after)


def _check(study: Path, write: Path, replace: bool) -> None:
    """Make sure, before anything is solved, that the best study can be written.  Raises `InputError`."""
    from pounding_cli.study import load_study
    from pounding_cli.workflows.optimise_question import check_written

    if write.suffix not in (".yaml", ".yml"):
        raise InputError(Problem("a study file ends in .yaml", f"write --write {write}.yaml", str(write)))
    loaded = load_study(study)
    check_output(write, [study], lambda *_: True, "--write")
    if os.path.exists(write) and not replace:
        raise InputError(Problem("is there already", "choose another name, or add --replace to replace it", str(write)))
    check_written(loaded, write)


def _write(ctx: click.Context, study: Path, path: Path, write: Path, says: bool) -> None:
    """Write the study with the best values that a results file has."""
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
        click.echo(f"{write} is not written: there is no optimum", err=True)
        ctx.exit(1)
    text = question_of(loaded).text(tuple(table["place"].tolist()))
    try:
        write.write_text(text, encoding="utf-8", newline="")
    except OSError as error:
        hint = "choose a place that can be written, and run the command again"
        raise InputError(Problem(f"cannot be written: {error.strerror or error}", hint, str(write))) from None
    if says:
        click.echo(f"Best study: {write}; simulate it with: pound run {write}")
