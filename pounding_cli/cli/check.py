"""`pound check`: validate a study file and nothing else."""

from __future__ import annotations

from pathlib import Path

import click

from pounding_cli.words import counted


@click.command("check")
@click.argument("study", type=click.Path(path_type=Path))
def command(study: Path) -> None:
    """Validate STUDY: every problem in one go, as file:line:column, what is wrong, what to write instead.

    Studies of `pound run`, `pound connector` and `pound wall` alike. Nothing is computed or written.
    Exit code 0 when the study is sound, 2 when it was refused.

    Example: pound check configs/fig6.yaml
    """
    from pounding_cli.study import expand, load_study
    from pounding_cli.study.kinds import kind_of_file

    if (kind := kind_of_file(study)) != "run":
        click.echo(f"OK: {study}: a study of `pound {kind}`, {_points(study, kind)} to compute")
        return
    read = load_study(study)
    plan = expand(read)
    for warning in read.warnings:
        click.echo(f"warning: {warning}", err=True)
    points = len({row.point for row in plan.rows})
    factors = [
        counted(len(plan.cases), "case"),
        counted(len(plan.analyses), "analysis", "analyses"),
        counted(len(plan.records), "record"),
        *([counted(points, "sweep point")] if plan.axes else []),
    ]
    click.echo(
        f"OK: {study}: {' x '.join(factors)} = {counted(len(plan.rows), 'row')} "
        f"from {counted(len(plan.scenes), 'scene')}"
    )


def _points(study: Path, kind: str) -> str:
    """How many points a study of another system has, once it is found sound."""
    if kind == "connector":
        from pounding_cli.study.connector_study import load_connector_study

        count = len(load_connector_study(study).points)
    else:
        from pounding_cli.study.wall_study import load_wall_study

        count = len(load_wall_study(study).points)
    return counted(count, "point")
