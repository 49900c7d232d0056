"""`pound wall`: the bumper wall of Fig. 8."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from pounding_cli.study.system_study import Point
    from pounding_cli.wall.analysis import WallResponse
    from pounding_cli.wall.model import WallModel


@click.command("wall", short_help="Solve an impact on a bumper wall (Fig. 8).")
@click.argument("study", type=click.Path(path_type=Path), metavar="STUDY")
@click.option("-o", "--output", type=click.Path(path_type=Path), metavar="FILE.h5", help="Results file.")
@click.option("--replace", is_flag=True, help="Replace the results of another study.")
@click.option(
    "--workers",
    type=click.IntRange(min=1),
    metavar="N",
    help="Number of points solved in parallel. Default: all cores.",
)
@click.option("--no-figures", is_flag=True, help="Write the results file only.")
@click.option("-q", "--quiet", is_flag=True, help="Print nothing.")
def command(
    study: Path, output: Path | None, replace: bool, workers: int | None, no_figures: bool, quiet: bool
) -> None:
    """Compute the impact of a floor on the bumper wall of a concrete building: force, separation, stresses.

    The command prints peak force and stresses, and writes FILE.h5 (default: results/STUDY.h5), the figures, and the
    fields for ParaView in a folder of the same name.
    After Ctrl-C, a crash or a full disk, run the same command again to resume.

    \b
    Example:
      pound wall configs/fig8.yaml -o results/fig8.h5
    """
    from pounding_cli.batch.points import kept_points
    from pounding_cli.store import check_results
    from pounding_cli.store.wall_store import write_wall
    from pounding_cli.study.wall_study import load_wall_study
    from pounding_cli.wall.analysis import WallResponse

    loaded = load_wall_study(study)
    for warning in () if quiet else loaded.warnings:
        click.echo(f"warning: {warning}", err=True)
    path = output or Path("results") / f"{study.stem}.h5"
    check_results(path, loaded, "wall", replace)
    if not quiet:
        click.echo(loaded.title)
    with kept_points(path, WallResponse, ("wall",), workers) as solve:
        write_wall(loaded, path, None if quiet else _summary, solve)
    files = [path]
    if not no_figures:
        from pounding_cli.report.wall_figures import draw_wall

        files += draw_wall(path, path.parent)
    if not quiet:
        click.echo(f"wrote {path}" + (f" and {len(files) - 1} figures and fields" if len(files) > 1 else ""))


def _summary(point: Point[WallModel], response: WallResponse) -> None:
    if point.label:
        click.echo(point.label)
    left = f"{1e3 * response.separation:.1f} ms" if math.isfinite(response.separation) else "not reached"
    click.echo(
        f"  peak force {response.peak_force / 1e6:.2f} MN at {1e3 * response.peak_time:.1f} ms, "
        f"separation {left}, impulse {response.impulse / 1e3:.1f} kN s"
    )
    click.echo(
        f"  peak stress {response.wall_stress / 1e6:.1f} N/mm2 in an element, "
        f"{response.averaged_stress / 1e6:.1f} N/mm2 over {point.model.averaging_length:g} m; "
        f"beams {response.beam_stress / 1e6:.1f}, columns {response.column_stress / 1e6:.1f} N/mm2"
    )
    click.echo(
        f"  in the wall's cross-sections: shear up to {response.wall_shear / 1e6:.2f} MN, "
        f"moment up to {response.wall_moment / 1e6:.2f} MN m"
    )
    click.echo(
        f"  energy balance open by {response.energy_residual:.1e}; {response.freedoms} freedoms, "
        f"step {1e3 * response.step:.3g} ms, {response.seconds:.2f} s"
    )
    for flag in response.flags:
        click.echo(f"  note: {flag}")
