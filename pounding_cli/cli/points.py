"""`pound wall` and `pound connector`: the points of a study, one after the other."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from pounding_cli.cli import streams


def _command(name: str, short: str, text: str) -> click.Command:
    @click.command(name, short_help=short, help=text)
    @click.argument("study", type=click.Path(path_type=Path))
    @click.option(
        "-o",
        "--output",
        type=click.Path(path_type=Path),
        metavar="FILE.h5",
        help="Results file; tables, figures and page stand in a folder of its name. Default: results/<study>.h5.",
    )
    @click.option("-q", "--quiet", is_flag=True, help="Print only points that failed.")
    def command(study: Path, output: Path | None, quiet: bool) -> None:
        from pounding_cli.outputs import check_folder, check_output
        from pounding_cli.points import load, solved, write

        sweep = load(study, name)
        file = output or Path("results", f"{study.stem}.h5")
        file = file if file.suffix else file.with_suffix(".h5")
        check_output(file, mine=lambda _, head: head.startswith(b"\x89HDF"))
        check_folder(file.with_suffix(""))
        for warning in sweep.warnings:
            streams.echo_warning(warning)
        with click.progressbar(sweep.points, file=sys.stderr, hidden=quiet or not sys.stderr.isatty()) as waiting:
            points = [solved(sweep, point) for point in waiting]
        report, files = write(sweep, points, file)
        failed = [point for point in points if point.data["status"] != "done"]
        if not quiet:
            report.print()
            click.echo(f"Points: {len(points) - len(failed)} solved, {len(failed)} failed")
            click.echo(f"Results: {files[0]}\nPage: {files[-1]}")
        for point in failed:
            status, (hint, *_) = point.data["status"].item(), point.data.attrs["notes"]
            click.echo(f"failed: {point.label or 'the study'}: {status}: {hint}", err=True)
        if failed:
            sys.exit(1)

    return command


connector = _command(
    "connector",
    "Solve two connected oscillators in closed form (Figs 4 and 5).",
    """Compute how a spring (and dashpot) between two oscillators changes their largest displacements.

    The command prints the peak ratios with their frequencies, and writes FILE.h5 and a folder with tables, figure and
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

    The command prints peak force and stresses, and writes FILE.h5 and a folder with tables, figures, page and the
    fields for ParaView.

    \b
    Example:
      pound wall configs/fig8.yaml -o results/fig8.h5
    """,
)
