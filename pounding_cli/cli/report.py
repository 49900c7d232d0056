"""`pound report`: figures, tables and the paper's claims from results files."""

from __future__ import annotations

from pathlib import Path

import click

from pounding_cli.cli.places import at_option, points_at
from pounding_cli.numbers import counted


@click.command("report", short_help="Draw the figures and write the tables and the claims.")
@click.argument("files", nargs=-1, required=True, type=click.Path(path_type=Path), metavar="FILE.h5...")
@click.option("-o", "--output", type=click.Path(path_type=Path), metavar="DIR", help="Folder of the report.")
@click.option(
    "--format",
    "formats",
    multiple=True,
    type=click.Choice(("png", "svg", "pdf")),
    help="Formats of the figures; may be given more than once. All three unless given.",
)
@click.option("--no-figures", is_flag=True, help="Write tables and claims only (much faster).")
@click.option("--no-page", is_flag=True, help="Write no report.html, the whole report in one file.")
@click.option("--quantity", "quantities", multiple=True, metavar="NAME", help="Draw it over the sweep, e.g. drift.")
@click.option("--case", help="Of the sweep's figures: only this case; `worst`: the worst of all.")
@click.option("--analysis", help="Of the sweep's figures: only this analysis.")
@click.option("--record", help="Of the sweep's figures: only this motion; their mean unless given.")
@click.option("--building", help="Of the sweep's figures: only this building; `worst`: the worst of all.")
@click.option("--storey", type=int, help="Of the sweep's figures: only this storey; the worst unless given.")
@click.option("--floor", type=int, help="Of the sweep's figures: only this floor; the worst unless given.")
@click.option("--link", help="Of the sweep's figures: only this link; the worst unless given.")
@at_option
@click.option("-q", "--quiet", is_flag=True, help="Print nothing.")
def command(
    files: tuple[Path, ...],
    output: Path | None,
    formats: tuple[str, ...],
    no_figures: bool,
    no_page: bool,
    quantities: tuple[str, ...],
    case: str | None,
    analysis: str | None,
    record: str | None,
    building: str | None,
    storey: int | None,
    floor: int | None,
    link: str | None,
    at: tuple[str, ...],
    quiet: bool,
) -> None:
    """Draw the figures of results files, write their tables as CSV, and judge the paper's claims.

    Files of `pound run`, `pound connector` and `pound wall` alike.

    The report goes to DIR, or to a folder beside the results file, named like it: report.html (everything in one
    page, to open in a browser or to send), the figures, tables/. Of several files each gets its own folder in DIR;
    comparison.md sets their claims side by side.

    A sweep is drawn too: one swept key as curves, two as maps, of more the two with most values; --at fixes one.
    Unless said otherwise they show the largest V/V0 (elastic) and mu/mu0 (inelastic) of every building; --quantity
    takes any number of the tables storey, floor, link and scene.

    \b
    Example:
      pound report results/fig6.h5 -o report
      pound report results/fig6.h5 results/fig7.h5 --no-figures
      pound report results/sweep.h5 --quantity mu_ratio --case touching --building soft --storey 3
    """
    from pounding_cli.report.build import FORMATS, write_comparison, write_report
    from pounding_cli.report.claims import judge
    from pounding_cli.report.evidence import points
    from pounding_cli.report.quantity import Choice
    from pounding_cli.report.sweep import Asked
    from pounding_cli.store import open_results
    from pounding_cli.store.files import kind_of
    from pounding_cli.workflows import WORKFLOWS

    chosen = () if no_figures else formats or FORMATS
    systems = [path for path in files if kind_of(path)]
    opened = {path: open_results(path) for path in files if path not in systems}
    choice = Choice("", case, analysis, building, storey, floor, link, record)
    asked = {path: Asked(quantities, choice, points_at(results, at)) for path, results in opened.items()}
    folders = _folders(files, output)
    for path in systems:
        written = WORKFLOWS[kind_of(path)].part("report")(path, folders[path], chosen, not no_page)
        if not quiet:
            click.echo(f"{written[-1]}: {counted(len(written), 'file')}")
    for path, results in opened.items():
        written = write_report(results, folders[path], chosen, not no_page, asked[path])
        if quiet:
            continue
        click.echo(f"{written[-1]}: {counted(len(written), 'file')}")
        evidences = points(results)
        if len(evidences) == 1:
            for judgement in judge(evidences[0]):
                click.echo(f"  {judgement.claim.key:22} {judgement.verdict}")
    if len(opened) > 1:
        folder = output or Path("comparison")
        page, _ = write_comparison({folders[path].name: results for path, results in opened.items()}, folder)
        if not quiet:
            click.echo(str(page))


def _folders(files: tuple[Path, ...], output: Path | None) -> dict[Path, Path]:
    """Where each report goes; files of one name are told apart by a number."""
    if output is not None and len(files) == 1:
        return {files[0]: output}
    folders: dict[Path, Path] = {}
    for path in files:
        base = output / path.stem if output is not None else path.with_suffix("")
        folder, number = base, 2
        while folder in folders.values():
            folder, number = base.with_name(f"{base.name}-{number}"), number + 1
        folders[path] = folder
    return folders
