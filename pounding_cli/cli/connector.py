"""`pound connector`: Figs 4 and 5 in closed form."""

from __future__ import annotations

from pathlib import Path

import click


@click.command("connector", short_help="Solve two connected oscillators in closed form (Figs 4 and 5).")
@click.argument("study", type=click.Path(path_type=Path), metavar="STUDY")
@click.option("-o", "--output", type=click.Path(path_type=Path), metavar="FILE.h5", help="Results file.")
@click.option("--replace", is_flag=True, help="Replace the results of another study.")
@click.option("--no-figures", is_flag=True, help="Write the results file only.")
@click.option("-q", "--quiet", is_flag=True, help="Print nothing.")
def command(study: Path, output: Path | None, replace: bool, no_figures: bool, quiet: bool) -> None:
    """Compute how a spring (and dashpot) between two oscillators changes their largest displacements.

    The command prints the peak ratios with their frequencies, and writes FILE.h5 (default: results/STUDY.h5) and the
    figure.

    \b
    Example:
      pound connector configs/fig5.yaml -o results/fig5.h5
    """
    from pounding_cli.store import check_results
    from pounding_cli.store.connector_store import write_connector
    from pounding_cli.study.connector_study import load_connector_study

    loaded = load_connector_study(study)
    for warning in () if quiet else loaded.warnings:
        click.echo(f"warning: {warning}", err=True)
    path = output or Path("results") / f"{study.stem}.h5"
    check_results(path, loaded, "connector", replace)
    found = write_connector(loaded, path)
    files = [path]
    if not no_figures:
        from pounding_cli.report.connector_figures import draw_connector

        files += draw_connector(path, path.parent)
    if quiet:
        return
    click.echo(loaded.title)
    for point, result in zip(loaded.points, found, strict=True):
        low, high = result.frequencies
        if point.label:
            click.echo(point.label)
        click.echo(f"  |R1| at most {result.peak1:.3f} at Omega/omega10 = {result.at1:.3f}")
        click.echo(f"  |R2| at most {result.peak2:.3f} at Omega/omega10 = {result.at2:.3f}")
        click.echo(f"  coupled frequencies over omega10: {low:.4f}, {high:.4f} (alone: 1, {point.model.p:.4f})")
        bands = ", ".join(f"{a:.3f}-{b:.3f}" for a, b in result.both_above)
        click.echo(f"  both ratios exceed 1 in: {bands or 'nowhere'}")
    for file in files:
        click.echo(f"wrote {file}")
