"""`pound accuracy`: error against time of every method on the scenes of a study."""

from __future__ import annotations

import math
import shlex
from pathlib import Path
from typing import TYPE_CHECKING

import click

from pounding_cli.cli.options import FILE, Time, study_argument
from pounding_cli.errors import InputError, Problem
from pounding_cli.numbers import counted

if TYPE_CHECKING:
    from pounding_cli.solver.work_precision import Subject
    from pounding_cli.study import Study


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
