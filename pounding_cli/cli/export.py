"""`pound export`: tables of a results file for other programs."""

from __future__ import annotations

from pathlib import Path

import click

from pounding_cli.cli.show import TABLES


@click.command("export", short_help="Write tables as CSV, Parquet, Excel or netCDF.")
@click.argument("file", type=click.Path(path_type=Path), metavar="FILE.h5")
@click.argument("tables", nargs=-1, type=click.Choice(TABLES), metavar="[TABLE]...")
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    metavar="PATH",
    help="A folder, or a file whose extension gives the format.",
)
@click.option(
    "--format",
    "form",
    type=click.Choice(("csv", "parquet", "excel", "netcdf")),
    help="Format, if PATH does not give it. Default: csv.",
)
def command(file: Path, tables: tuple[str, ...], output: Path | None, form: str | None) -> None:
    """Write tables of a results file for other programs, in SI with all digits: all tables, or those named.

    CSV and Parquet have one file per table in a folder, with columns.csv, which describes every column, or a single
    file for one table. Excel has one sheet per table. netCDF has the whole file, for programs such as xarray and
    ncview. Tables: storey, floor, link, scene, flagged, accuracy, summary, records, buildings.

    \b
    Example:
      pound export results/fig6.h5
      pound export results/fig6.h5 -o fig6.xlsx
      pound export results/fig6.h5 storey -o storey.parquet
      pound export results/fig6.h5 --format netcdf
    """
    from pounding_cli.api.studies import open_results
    from pounding_cli.results.export import export

    for path in export(open_results(file), output, form, tables):
        click.echo(f"wrote {path}")
