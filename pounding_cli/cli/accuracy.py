"""`pound accuracy`: error against time of every method on the scenes of a study."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING

import click

from pounding_cli.cli import streams
from pounding_cli.numbers import counted

if TYPE_CHECKING:
    from pounding_cli.solver.work_precision import Subject, WorkPrecision
    from pounding_cli.study import Study

BUDGET = "60 s"


@click.command("accuracy", short_help="Measure error and time of every method on a study.")
@click.argument("study", type=click.Path(path_type=Path))
@click.option(
    "--methods",
    metavar="NAME,...",
    default="",
    help="Methods to compare, separated by commas. Default: all.",
)
@click.option("--cases", metavar="NAME,...", default="", help="Cases to run, separated by commas. Default: all.")
@click.option("--records", metavar="NAME,...", default="", help="Motions to use, separated by commas. Default: all.")
@click.option(
    "--budget", default=BUDGET, show_default=True, metavar="TIME", help="Time for the runs, without compilation."
)
@click.option(
    "-o", "--output", type=click.Path(path_type=Path), metavar="DIR", help="Folder. Default: results/STUDY-accuracy."
)
@click.option("-q", "--quiet", is_flag=True, help="Print the result only.")
def command(study: Path, methods: str, cases: str, records: str, budget: str, output: Path | None, quiet: bool) -> None:
    """Measure what accuracy costs on the scenes of STUDY.

    Every method runs every scene that it can solve, at several settings. Two methods give the reference; the command
    prints their difference. Times exclude compilation and are the least of several repeats. The command writes
    accuracy.md (the page), accuracy.csv (every run) and the diagrams. It runs only the first point of a sweep.

    \b
    Example:
      pound accuracy configs/fig6.yaml
      pound accuracy configs/fig6.yaml --methods taylor,dop853,newmark --budget 90s
    """
    from pounding_cli.api import load_study
    from pounding_cli.outputs import check_folder
    from pounding_cli.report.accuracy_figures import draw_accuracy
    from pounding_cli.report.accuracy_page import in_words, write
    from pounding_cli.solver.work_precision import chosen, measure

    allowed = seconds_of(budget)
    names = chosen(_listed(methods))
    folder = output or Path("results") / f"{study.stem}-accuracy"
    check_folder(folder)
    loaded = load_study(study)
    subjects = _subjects(loaded, _listed(cases), _listed(records))
    if not quiet:
        click.echo(loaded.title)
    tell = (lambda text: None) if quiet else (lambda text: click.echo(f"  {text}", err=True))
    found = measure(subjects, names, allowed, tell)
    drawn = draw_accuracy(found, folder)
    files = write(found, loaded.title, drawn, _again(study, methods, cases, records, budget), folder)
    if not quiet:
        _print(found)
    for text in in_words(found):
        click.echo(text)
    if not quiet:
        click.echo(f"Wrote {files[1]}, {files[0].name} and {counted(len(drawn), 'figure')}")


def seconds_of(text: str) -> float:
    """A budget in seconds.

    Raises
    ------
    InputError : no time, or not above zero
    """
    from pydantic_core import PydanticCustomError

    from pounding_cli.errors import InputError, Problem
    from pounding_cli.study.quantity import TIME

    try:
        return float(TIME.but(name="budget", example="60 s").read(text))
    except PydanticCustomError as refused:
        said = refused.context or {}
        raise InputError(Problem(f"--budget: {said.get('message', refused)}", said.get("hint", ""))) from refused


def _listed(text: str) -> list[str]:
    return [name.strip() for name in text.split(",") if name.strip()]


def _subjects(study: Study, cases: list[str], records: list[str]) -> list[Subject]:
    """The linked scenes of the study's first point, each once."""
    from pounding_cli.errors import InputError, Problem
    from pounding_cli.solver.work_precision import Subject
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
        Subject(row.case, row.analysis, row.record, plan.scenes[row.scene])
        for row in plan.rows
        if not any(row.point) and row.case in (cases or plan.cases) and row.record in (records or plan.records)
    ]


def _again(study: Path, methods: str, cases: str, records: str, budget: str) -> str:
    """The command that repeats the page."""
    words = ["pound", "accuracy", str(study)]
    for option, value in (("--methods", methods), ("--cases", cases), ("--records", records)):
        words += [option, value] if value else []
    return shlex.join([*words, "--budget", budget])


def _print(found: WorkPrecision) -> None:
    """The table and what did not end."""
    from rich import box
    from rich.table import Table

    from pounding_cli.report.accuracy_page import (
        aborted_in_words,
        left_out_in_words,
        lines_frame,
        reference_in_words,
        without_reference_in_words,
    )

    frame = lines_frame(found)
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for column in frame.columns:
        left = column in ("method", "setting")
        table.add_column("ms a scene" if column == "ms" else column, justify="left" if left else "right")
    before = ""
    for row in frame.itertuples(index=False):
        if before not in ("", str(row.method)):
            table.add_section()
        before = str(row.method)
        table.add_row(*(_cell(value) for value in row))
    streams.echo_table(table)
    click.echo("Errors: worst over the scenes, relative. miscounted: scenes with other impacts than the reference.")
    click.echo(reference_in_words(found))
    for text in aborted_in_words(found):
        click.echo(f"Did not end, {text}")
    for text in (*without_reference_in_words(found), *left_out_in_words(found)):
        click.echo(text)
    click.echo(f"Runs took {found.spent:.2g} s, compiling before them {found.compiling:.2g} s.")


def _cell(value: object) -> str:
    if not isinstance(value, float):
        return str(value)
    if value != value:
        return "-"
    return f"{value:.3g}" if value >= 0.01 else f"{value:.0e}"
