"""The commands that solve points by the models of the paper: `pound connector` and `pound wall`."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from pounding_cli.cli.options import CHANGES_HELP, output_option, print_failures, quiet_option, study_argument

if TYPE_CHECKING:
    from pounding_cli.study.vary.changes import Change


def _point_command(name: str, about: str, example: str) -> click.Command:
    """Return the command that solves the points of a study one after the other."""

    @click.command(name, help=f"{about}\n\n{CHANGES_HELP}\n\n\b\nExample:\n  pound {name} {example}\n")
    @study_argument
    @output_option("results/STUDY.h5", "Results file; tables, figures and page stand in a folder of its name.")
    @quiet_option
    @click.pass_context
    def command(
        ctx: click.Context, study: Path, changes: tuple[Change, ...], output: Path | None, quiet: bool
    ) -> None:  # fmt: skip
        if not solve_points(name, study, changes, output, quiet):
            ctx.exit(1)

    return command


connector = _point_command(
    "connector",
    "Compute how a spring and a dashpot between two oscillators change their largest displacements.",
    "configs/fig5.yaml",
)
wall = _point_command(
    "wall",
    "Compute the impact of a floor on the bumper wall of a concrete building: force, separation, stresses.",
    "configs/fig8.yaml",
)


def solve_points(
    name: str, study: Path, changes: tuple[Change, ...], output: Path | None, quiet: bool
) -> bool:  # fmt: skip
    """Solve all points of a study, write the results file and the report beside it, and print the answer.

    changes : values in place of those of the study

    Returns whether every point was solved.
    """
    from pounding_cli.api.studies import default_output
    from pounding_cli.outputs import check_folder, check_output
    from pounding_cli.paper.points import (
        build_dataset,
        build_report,
        is_written_by,
        iter_failures,
        load_sweep,
        solve_point,
    )
    from pounding_cli.results.arrays import ResultArrays
    from pounding_cli.results.file import write_results

    sweep = load_sweep(study, name, changes)
    for warning in sweep.warnings:
        click.echo(f"warning: {warning}", err=True)
    file = output or default_output(study, changes=changes)
    file = file if file.suffix else file.with_suffix(".h5")
    check_output(file, [study], lambda place, _: is_written_by(name, place))
    check_folder(file.with_suffix(""))
    with click.progressbar(sweep.points, file=sys.stderr, hidden=quiet or not sys.stderr.isatty()) as waiting:
        sweep = replace(sweep, points=tuple(solve_point(sweep, point) for point in waiting))
    write_results(file, ResultArrays.from_dataset(build_dataset(sweep)))
    report = build_report(sweep)
    (*_, page) = report.save(file.with_suffix(""))
    if not quiet:
        report.print()
        click.echo(f"Points: {len(sweep.solved_points)} solved, {len(sweep.failed_points)} failed")
        click.echo(f"Results: {file}\nPage, with all numbers: {page}")
    print_failures(iter_failures(sweep))
    return not sweep.failed_points
