"""The command `pound accuracy`."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from pounding_cli.cli.options import FILE, seconds, study_argument
from pounding_cli.numbers import pluralize

if TYPE_CHECKING:
    from pounding_cli.study.vary.changes import Change


def _split_names(ctx: click.Context, param: click.Parameter, text: str) -> list[str]:
    return [name.strip() for name in text.split(",") if name.strip()]


@click.command()
@study_argument
@click.option(
    "--methods", metavar="NAME,...", default="", callback=_split_names, help="Methods to compare. Default: all."
)
@click.option("--cases", metavar="NAME,...", default="", callback=_split_names, help="Cases to run. Default: all.")
@click.option("--records", metavar="NAME,...", default="", callback=_split_names, help="Motions to use. Default: all.")
@click.option("--budget", type=seconds, default="60 s", show_default=True, help="Time for the runs, uncompiled.")
@click.option("-o", "--output", type=FILE, metavar="DIR", help="Folder. Default: results/STUDY-accuracy.")
@click.option("-q", "--quiet", is_flag=True, help="Print only what to use.")
def accuracy(
    study: Path,
    changes: tuple[Change, ...],
    methods: list[str],
    cases: list[str],
    records: list[str],
    budget: float,
    output: Path | None,
    quiet: bool,
) -> None:
    """Measure what accuracy costs by every method on time histories of STUDY, at the first point of its sweep. Write a
    page, a table of all runs and diagrams (docs/accuracy.md).

    KEY=VALUE puts a value in place of that of STUDY (docs/how-to/change.md).

    \b
    Example:
      pound accuracy configs/fig6.yaml --methods taylor,dop853,newmark --budget 90s
    """
    from pounding_cli.api.studies import format_stem, load_study
    from pounding_cli.outputs import check_folder
    from pounding_cli.questions.accuracy import build_report, list_subjects, measure_accuracy
    from pounding_cli.solver.work_precision import resolve_methods

    resolve_methods(methods)  # names that are not there are refused before anything is looked at
    loaded = load_study(study, changes)
    list_subjects(loaded, cases, records)
    folder = output or Path("results") / format_stem(study, "accuracy", changes)
    check_folder(folder)

    def tell(text: str) -> None:
        if not quiet:
            click.echo(f"  {text}", err=True)

    command = shlex.join(["pound", *sys.argv[1:]])
    report = build_report(measure_accuracy(loaded, methods, cases, records, budget, command, tell))
    files = report.save(folder)
    if quiet:
        click.echo("\n".join(report.answer.sentences))
    else:
        report.print()
        click.echo(f"Wrote {files[-1]}: {pluralize(len(files), 'file')}")
