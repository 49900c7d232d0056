"""`pound wall` and `pound connector`: the points of a study, one after the other."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from pounding_cli.cli import streams

MOST_POINTS = 50
"""Points that are printed, some lines each; the table has all."""


def _command(name: str, short: str, text: str) -> click.Command:
    @click.command(name, short_help=short, help=text)
    @click.argument("study", type=click.Path(path_type=Path))
    @click.option(
        "-o",
        "--output",
        type=click.Path(path_type=Path),
        metavar="FILE.h5",
        help="Results file; table, figures and page stand in a folder of its name. Default: results/<study>.h5.",
    )
    @click.option("-q", "--quiet", is_flag=True, help="Print only points that failed.")
    def command(study: Path, output: Path | None, quiet: bool) -> None:
        from pounding_cli.points import load, places, solved, write

        sweep, say = load(study, name), (lambda line: None) if quiet else click.echo
        file, folder = places(output or Path("results", f"{study.stem}.h5"))
        for warning in sweep.warnings:
            streams.echo_warning(warning)
        points, failed = [], 0
        say(sweep.title)
        for number, point in enumerate(sweep.points):
            points.append(point := solved(sweep, point))
            values = point.found
            if values["status"] != "done":
                failed += 1
                click.echo(f"failed: {point.label or 'the study'}: {values['status']}: {values['flags'][0]}", err=True)
            elif number < MOST_POINTS:
                lines = [*sweep.asked.lines(values), *(f"note: {flag}" for flag in values["flags"])]
                say("\n".join([*([point.label] if point.label else []), *(f"  {line}" for line in lines)]))
        files = write(sweep, points, file, folder)
        say(f"Points: {len(points) - failed} solved, {failed} failed\nResults: {files[0]}\nPage: {files[-1]}")
        if failed:
            sys.exit(1)

    return command


connector = _command(
    "connector",
    "Solve two connected oscillators in closed form (Figs 4 and 5).",
    """Compute how a spring (and dashpot) between two oscillators changes their largest displacements.

    The command prints the peak ratios with their frequencies, and writes FILE.h5 and a folder with table, figure and
    page.

    \b
    Example:
      pound connector configs/fig5.yaml -o results/fig5.h5
    """,
)
wall = _command(
    "wall",
    "Solve an impact on a bumper wall (Fig. 8).",
    """Compute the impact of a floor on the bumper wall of a concrete building: force, separation, stresses.

    The command prints peak force and stresses, and writes FILE.h5 and a folder with table, figures, page and the fields
    for ParaView.

    \b
    Example:
      pound wall configs/fig8.yaml -o results/fig8.h5
    """,
)
