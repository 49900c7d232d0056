"""`pound accuracy`: error against time of every method on the scenes of a study."""

from __future__ import annotations

import math
import shlex
from pathlib import Path
from typing import TYPE_CHECKING

import click

from pounding_cli.numbers import counted

if TYPE_CHECKING:
    from pounding_cli.solver.work_precision import Subject
    from pounding_cli.study import Study


@click.command("accuracy", short_help="Measure error and time of every method on a study.")
@click.argument("study", type=click.Path(path_type=Path))
@click.option("--methods", metavar="NAME,...", default="", help="Methods to compare. Default: all.")
@click.option("--cases", metavar="NAME,...", default="", help="Cases to run. Default: all.")
@click.option("--records", metavar="NAME,...", default="", help="Motions to use. Default: all.")
@click.option("--budget", default="60 s", show_default=True, metavar="TIME", help="Time for the runs, uncompiled.")
@click.option("-o", "--output", type=click.Path(path_type=Path), metavar="DIR",
              help="Folder. Default: results/STUDY-accuracy.")  # fmt: skip
@click.option("-q", "--quiet", is_flag=True, help="Print the result only.")
def command(study: Path, methods: str, cases: str, records: str, budget: str, output: Path | None, quiet: bool) -> None:
    """Measure what accuracy costs on the scenes of STUDY.

    Every method runs every scene that it can solve, at several settings. Two methods give the reference; the command
    prints their difference. Times exclude compilation and are the least of several repeats. The command writes
    report.html (the page), tables/accuracy.csv (every run) and the diagrams. It runs only the first point of a sweep.

    \b
    Example:
      pound accuracy configs/fig6.yaml
      pound accuracy configs/fig6.yaml --methods taylor,dop853,newmark --budget 90s
    """
    from pounding_cli.api.studies import load_study
    from pounding_cli.outputs import check_folder
    from pounding_cli.report.accuracy import accuracy_report
    from pounding_cli.solver.work_precision import chosen, measure

    allowed, names = seconds_of(budget), chosen(_listed(methods))
    folder = output or Path("results") / f"{study.stem}-accuracy"
    check_folder(folder)
    loaded = load_study(study)
    subjects = _subjects(loaded, _listed(cases), _listed(records))
    tell = (lambda text: None) if quiet else (lambda text: click.echo(f"  {text}", err=True))
    words = ["pound", "accuracy", str(study)]
    for option, value in (("--methods", methods), ("--cases", cases), ("--records", records), ("--budget", budget)):
        words += [option, value] if value else []
    report = accuracy_report(measure(subjects, names, allowed, tell), loaded.title, shlex.join(words))
    files = report.save(folder, ("png", "svg"))
    if quiet:
        click.echo("\n".join(report.answer.sentences))
    else:
        report.print()
        click.echo(f"Wrote {files[-1]}: {counted(len(files), 'file')}")


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
        Subject(row.case, row.analysis, row.record, plan.scene(row.scene))
        for row in map(plan.row, range(math.prod(plan.shape[-3:])))
        if row.case in (cases or plan.cases) and row.record in (records or plan.records)
    ]
