"""`pound check`: validate a study file and nothing else."""

from __future__ import annotations

import math
from pathlib import Path

import click

from pounding_cli.cli import streams
from pounding_cli.numbers import counted

MOST_ROWS = 50_000
"""Rows of a study whose combinations of swept values are looked at too."""


@click.command("check")
@click.argument("study", type=click.Path(path_type=Path))
def command(study: Path) -> None:
    """Validate STUDY and report every problem as file:line:column, what is wrong and what to write instead.

    The command accepts studies of all commands, including their sections for `pound fragility`, `pound sensitivity`
    and `pound optimise`. It computes and writes nothing.
    Exit code 0: the study is valid; 2: it was refused.

    Example: pound check configs/fig6.yaml
    """
    from pounding_cli.points import QUESTIONS, load
    from pounding_cli.reading import shortened
    from pounding_cli.study import expand, load_study
    from pounding_cli.study.kinds import kind_of_file
    from pounding_cli.workflows import WORKFLOWS

    name = shortened(study)
    kind = kind_of_file(study)
    if kind in QUESTIONS:
        sweep = load(study, kind)
        for warning in sweep.warnings:
            streams.echo_warning(warning)
        click.echo(f"OK: {name}: a study of `pound {kind}`, {counted(len(sweep.points), 'point')} to compute")
        return
    read = load_study(study)
    for each, workflow in WORKFLOWS.items():
        if workflow.question and read.root.get(each) is not None:
            workflow.part("question")(read)
    model = read.model
    points = math.prod(len(axis.values) for axis in read.axes)
    records = len(read.motions(read.base))
    rows = points * len(model.cases) * len(model.analyses) * records
    scenes = f" from {counted(len(expand(read).scenes), 'scene')}" if rows <= MOST_ROWS else ""
    for warning in read.warnings:
        streams.echo_warning(warning)
    factors = [
        counted(len(model.cases), "case"),
        counted(len(model.analyses), "analysis", "analyses"),
        counted(records, "record"),
        *([counted(points, "sweep point")] if read.axes else []),
    ]
    click.echo(f"OK: {name}: {' x '.join(factors)} = {counted(rows, 'row')}{scenes}")
    if not scenes:
        click.echo("Each value of the sweep was checked, but not their combinations; `pound run` checks them first.")
